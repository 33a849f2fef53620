#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "converters/vdb/sparse_volume.h"
#include "converters/vdb/volume_lookup.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/membership/solid_shape.h"
#include "sdk/tiles/labels.h"

namespace mesocell {

/// What is solid of a volume:
/// - a level set: where its value, interpolated trilinearly between samples, is less than `iso`
/// - fog, and floats of unknown class: where it is `iso` or more
/// - a mask, labels: where the nearest sample is true, or not 0
/// Interpolation is done in doubles by VolumeLookup.
class VolumeShape final : public SolidShape {
 public:
  /// `iso`: for a level set 0 if not given, for fog half the greatest value. Errors: kUsage (an iso for a
  /// mask or labels), kInvalidInput (nothing is inside, or all of space is; values that are no shape).
  [[nodiscard]] static Result<std::unique_ptr<VolumeShape>> make(SparseVolume volume,
                                                                 std::optional<double> iso);

  [[nodiscard]] Box3 box() const override { return box_; }
  [[nodiscard]] bool inside(Vec3 point) const override;
  [[nodiscard]] BoxSide side(const Box3& box) const override;

  [[nodiscard]] const SparseVolume& volume() const { return volume_; }
  /// None of a mask or labels.
  [[nodiscard]] std::optional<double> iso() const { return iso_; }

 private:
  VolumeShape(SparseVolume volume, const Transform& world_to_index);
  /// Whether a sample with this value is inside.
  [[nodiscard]] bool solid(double value) const;
  [[nodiscard]] bool interpolates() const { return iso_.has_value(); }
  /// The side of all samples from `low` to `high`.
  [[nodiscard]] BoxSide side_of_samples(const VoxelCoord& low, const VoxelCoord& high) const;
  void find_box();

  SparseVolume volume_;
  VolumeLookup lookup_;
  Transform world_to_index_;
  std::optional<double> iso_;
  Box3 box_;
};

/// The colors of a volume of three floats, linear light, interpolated trilinearly. Keeps the volume. Thread
/// safety: const.
class VolumeColors {
 public:
  /// Errors: kInvalidInput (it is not of three floats).
  [[nodiscard]] static Result<std::shared_ptr<const VolumeColors>> make(SparseVolume volume);
  /// The color at a point, metres; channels are held to 0…1.
  [[nodiscard]] Rgb8 at(Vec3 point) const;

 private:
  VolumeColors(SparseVolume volume, const Transform& world_to_index);
  SparseVolume volume_;
  VolumeLookup lookup_;
  Transform world_to_index_;
};

/// The labels of a tile from a volume of whole numbers or a mask: the box of its active voxels, or that in
/// the metadata "mesocell:resolution" from (0,0,0), as our own files have it. Numbers stay as they are,
/// negative ones and 0 are empty space. Errors: kInvalidInput (of another type, nothing active), kLimit (more
/// than 1024 voxels along an axis, 2^28 in all).
[[nodiscard]] Result<LabelVolume> labels_of(const SparseVolume& volume);

}  // namespace mesocell
