#include "converters/import/volume_slices.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "sdk/core/srgb.h"

namespace mesocell {
namespace {

Error bad_slices(std::string message) { return Error{ErrorCode::kInvalidInput, std::move(message)}; }

Error no_memory() {
  return Error{ErrorCode::kLimit, "there is not enough memory for the volume; make it smaller"};
}

/// Calls `voxel` with the first sample of each pixel, in the order of voxels: the lowest row first.
template <typename Voxel>
void for_each_pixel(const PageHeader& header, PageSamples samples, const Voxel& voxel) {
  const std::size_t channels = header.channels.size();
  for (std::uint32_t y = 0; y < header.height; ++y) {
    const std::uint32_t row = header.height - 1 - y;
    for (std::uint32_t x = 0; x < header.width; ++x)
      voxel(&samples[(std::size_t{row} * header.width + x) * channels], x, row);
  }
}

/// Channels that are neither gray nor color.
void note_other_channels(const PageHeader& header, const ColorChannels& channels, ReadNotes& notes) {
  for (std::size_t c = 0; c < header.channels.size(); ++c)
    if (std::find(channels.index.begin(), channels.index.end(), c) == channels.index.end())
      notes.lose(header.channels[c] == "A" ? "alpha" : "channel " + header.channels[c]);
}

/// What a picture says a label is, for messages.
std::string kind(const PageHeader& header, bool gray, std::uint32_t bits) {
  return std::string(gray ? "gray" : "colors") +
         (header.is_float ? " in floats" : " of " + std::to_string(bits) + " bits");
}

}  // namespace

std::optional<ColorChannels> color_channels(const PageHeader& header) {
  std::vector<std::size_t> not_alpha;
  for (std::size_t c = 0; c < header.channels.size(); ++c)
    if (header.channels[c] != "A") not_alpha.push_back(c);
  if (not_alpha.size() == 1) return ColorChannels{true, {not_alpha[0], not_alpha[0], not_alpha[0]}};
  ColorChannels found;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto at = std::find(header.channels.begin(), header.channels.end(), std::string(1, "RGB"[k]));
    if (at == header.channels.end()) return std::nullopt;
    found.index[k] = std::size_t(at - header.channels.begin());
  }
  return found;
}

std::uint8_t srgb8_of_sample(const PageHeader& header, std::uint32_t sample) {
  if (header.is_float) return linear_to_srgb8(double{float_sample(sample)});
  const std::uint64_t white = (std::uint64_t{1} << header.bits) - 1;
  if (header.encoding != ImageEncoding::kSrgb) return linear_to_srgb8(double(sample) / double(white));
  return std::uint8_t((sample * std::uint64_t{255} + white / 2) / white);
}

Status LabelSlices::begin(const Index3& resolution) try {
  volume.resolution = resolution;
  volume.labels.reserve(volume.voxel_count());
  return {};
} catch (const std::bad_alloc&) {
  return no_memory();
}

Status LabelSlices::check(const PageHeader& header, std::uint32_t stored_bits) {
  const std::optional<ColorChannels> channels = color_channels(header);
  if (!channels) return bad_slices("it is neither gray nor RGB; labels are read from such pictures alone");
  if (!header.exact)
    return bad_slices(
        "its compression or kind does not keep values exactly, as labels must be; save it as PNG or TIFF");
  if (!channels->gray && (header.is_float || header.bits != 8))
    return bad_slices(
        "its colors have no 8 bits a channel; labels are read from colors of 8 bits or from gray values");
  const std::uint32_t bits = header.is_float                      ? 32
                             : channels->gray && stored_bits != 0 ? stored_bits
                                                                  : header.bits;
  // The same color or value must be the same label everywhere, and programs that save a slice with few values
  // may choose fewer bits or gray, in which its values are others.
  if (bits_ != 0 &&
      (bits != bits_ || channels->gray != channels_.gray || header.is_float != header_.is_float))
    return bad_slices("it has " + kind(header, channels->gray, bits) + ", the first slice " +
                      kind(header_, channels_.gray, bits_) + "; save all alike");
  header_ = header;
  channels_ = *channels;
  bits_ = bits;
  return {};
}

void LabelSlices::note_losses(const PageHeader& header, ReadNotes& notes) const {
  note_other_channels(header, channels_, notes);
}

Status LabelSlices::append(PageSamples samples) {
  const auto [r, g, b] = channels_.index;
  if (!channels_.gray) {
    for_each_pixel(header_, samples, [&](const std::uint32_t* pixel, std::uint32_t, std::uint32_t) {
      volume.labels.push_back(pixel[r] | pixel[g] << 8 | pixel[b] << 16);
    });
    return {};
  }
  if (!header_.is_float) {
    // The library scales values of less than 8 bits up to 8; their upper bits are what was stored.
    const std::uint32_t shift = header_.bits - std::min(bits_, header_.bits);
    for_each_pixel(header_, samples, [&](const std::uint32_t* pixel, std::uint32_t, std::uint32_t) {
      volume.labels.push_back(pixel[r] >> shift);
    });
    return {};
  }
  Status status;
  for_each_pixel(header_, samples, [&](const std::uint32_t* pixel, std::uint32_t x, std::uint32_t row) {
    const float value = float_sample(pixel[r]);
    // Above, floats are whole by their nature, whatever was meant.
    const bool whole = value >= 0 && value <= 16777216.0f && value == std::floor(value);
    if (!whole && status)
      status = bad_slices("the pixel in column " + std::to_string(x) + ", row " + std::to_string(row) +
                          " has the value " + std::to_string(value) +
                          "; labels are whole numbers from 0, in floats up to 16777216");
    volume.labels.push_back(whole ? std::uint32_t(value) : 0);
  });
  return status;
}

Status ColorSlices::begin(const Index3& resolution) try {
  map.resolution = resolution;
  map.voxels.reserve(std::size_t{resolution[0]} * resolution[1] * resolution[2]);
  return {};
} catch (const std::bad_alloc&) {
  return no_memory();
}

Status ColorSlices::check(const PageHeader& header, std::uint32_t) {
  const std::optional<ColorChannels> channels = color_channels(header);
  if (!channels) return bad_slices("it is neither gray nor RGB; colors are read from such pictures alone");
  header_ = header;
  channels_ = *channels;
  return {};
}

void ColorSlices::note_losses(const PageHeader& header, ReadNotes& notes) const {
  note_other_channels(header, channels_, notes);
  if (header.is_float || header.bits > 8) notes.lose("precision of colors beyond 8 bits");
}

Status ColorSlices::append(PageSamples samples) {
  for_each_pixel(header_, samples, [&](const std::uint32_t* pixel, std::uint32_t, std::uint32_t) {
    Rgb8 color{};
    for (std::size_t k = 0; k < 3; ++k) color[k] = srgb8_of_sample(header_, pixel[channels_.index[k]]);
    map.voxels.push_back(color);
  });
  return {};
}

Status ScalarSlices::begin(const Index3& size) try {
  resolution = size;
  values.reserve(std::size_t{size[0]} * size[1] * size[2]);
  return {};
} catch (const std::bad_alloc&) {
  return no_memory();
}

Status ScalarSlices::check(const PageHeader& header, std::uint32_t) {
  header_ = header;
  return {};
}

void ScalarSlices::note_losses(const PageHeader& header, ReadNotes& notes) const {
  for (std::size_t c = 1; c < header.channels.size(); ++c) notes.lose("channel " + header.channels[c]);
}

Status ScalarSlices::append(PageSamples samples) {
  for_each_pixel(header_, samples, [&](const std::uint32_t* pixel, std::uint32_t, std::uint32_t) {
    values.push_back(float_sample(pixel[0]));
  });
  return {};
}

}  // namespace mesocell
