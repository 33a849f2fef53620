#pragma once

#include <cstdint>
#include <optional>

#include "converters/image/page_reader.h"
#include "converters/import/read_notes.h"
#include "format/cell_object.h"
#include "sdk/tiles/labels.h"

namespace mesocell {

/// Takes the slices of a volume, z upwards, and makes voxels of them. The top row of a picture is the largest
/// y.
class VolumeSlices {
 public:
  virtual ~VolumeSlices() = default;
  /// Fewest voxels along each axis, and what they are for: "a tile".
  [[nodiscard]] virtual std::uint32_t least_side() const = 0;
  /// Called once, first, with a size that was checked. Errors: kLimit (no memory).
  [[nodiscard]] virtual Status begin(const Index3& resolution) = 0;
  /// Whether slices like this can be used. `stored_bits` of a gray picture of integers, 0 where not known.
  [[nodiscard]] virtual Status check(const PageHeader& header, std::uint32_t stored_bits) = 0;
  /// Whether integers, too, are wanted as floats of the same value, see PageSink.
  [[nodiscard]] virtual bool as_floats() const { return false; }
  /// What of slices like this is passed over.
  virtual void note_losses(const PageHeader& header, ReadNotes& notes) const = 0;
  /// Appends the next slice, which is like the last that was checked. Errors: kInvalidInput.
  [[nodiscard]] virtual Status append(PageSamples samples) = 0;
};

/// Which channels of a picture are its gray value or its color; alpha is neither.
struct ColorChannels {
  bool gray = false;
  std::array<std::size_t, 3> index{};  ///< of R, G and B, or of gray three times
};
[[nodiscard]] std::optional<ColorChannels> color_channels(const PageHeader& header);

/// A sample of such a channel in 8-bit sRGB: rounded, and turned from linear light where it is in that.
[[nodiscard]] std::uint8_t srgb8_of_sample(const PageHeader& header, std::uint32_t sample);

/// Labels: gray values as they are, or r + 256 g + 65536 b of 8-bit colors.
class LabelSlices final : public VolumeSlices {
 public:
  [[nodiscard]] std::uint32_t least_side() const override { return 4; }
  [[nodiscard]] Status begin(const Index3& resolution) override;
  [[nodiscard]] Status check(const PageHeader& header, std::uint32_t stored_bits) override;
  void note_losses(const PageHeader& header, ReadNotes& notes) const override;
  [[nodiscard]] Status append(PageSamples samples) override;

  LabelVolume volume;

 private:
  PageHeader header_;
  ColorChannels channels_;
  std::uint32_t bits_ = 0;  ///< as stored, 0 before the first slice
};

/// Colors: 8-bit sRGB.
class ColorSlices final : public VolumeSlices {
 public:
  [[nodiscard]] std::uint32_t least_side() const override { return 1; }
  [[nodiscard]] Status begin(const Index3& resolution) override;
  [[nodiscard]] Status check(const PageHeader& header, std::uint32_t stored_bits) override;
  void note_losses(const PageHeader& header, ReadNotes& notes) const override;
  [[nodiscard]] Status append(PageSamples samples) override;

  ColorMap map;

 private:
  PageHeader header_;
  ColorChannels channels_;
};

/// Numbers: gray values, or the first channel of another picture, as they are stored.
class ScalarSlices final : public VolumeSlices {
 public:
  [[nodiscard]] std::uint32_t least_side() const override { return 2; }
  [[nodiscard]] Status begin(const Index3& resolution) override;
  [[nodiscard]] Status check(const PageHeader& header, std::uint32_t stored_bits) override;
  void note_losses(const PageHeader& header, ReadNotes& notes) const override;
  [[nodiscard]] Status append(PageSamples samples) override;

  [[nodiscard]] bool as_floats() const override { return true; }

  Index3 resolution{};
  std::vector<float> values;  ///< x fastest

 private:
  PageHeader header_;
};

}  // namespace mesocell
