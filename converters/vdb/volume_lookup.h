#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "converters/vdb/sparse_volume.h"
#include "sdk/core/vec.h"

namespace mesocell {

/// A table from places to numbers, both untrusted.
class PlaceTable {
 public:
  static constexpr std::uint32_t kNone = 0xffff'ffff;

  /// Room for `count` places.
  explicit PlaceTable(std::size_t count = 0);
  /// Sets what stands at a place; less than kNone.
  void set(const VoxelCoord& place, std::uint32_t number);
  /// The number at a place, or kNone.
  [[nodiscard]] std::uint32_t find(const VoxelCoord& place) const;

 private:
  struct Slot {
    VoxelCoord place{};
    std::uint32_t number = kNone;
  };
  [[nodiscard]] std::size_t slot_of(const VoxelCoord& place) const;
  std::vector<Slot> slots_;  ///< a power of two of them, at most half are used
};

/// Values of a volume at any place, and interpolated between them. Keeps the volume by reference. Thread
/// safety: const.
class VolumeLookup {
 public:
  explicit VolumeLookup(const SparseVolume& volume);

  /// The first number at a sample; of a mask 1 or 0.
  [[nodiscard]] double value(const VoxelCoord& at) const { return numbers(at)[0]; }
  /// All numbers of a sample.
  [[nodiscard]] VolumeValue numbers(const VoxelCoord& at) const;

  /// Between samples, by trilinear interpolation: along x, then y, then z, in doubles. `at`: in samples;
  /// beyond the reach of volumes it is held to it.
  [[nodiscard]] double interpolate(Vec3 at) const;
  [[nodiscard]] VolumeValue interpolate_numbers(Vec3 at) const;
  /// The value of the nearest sample; half-way is up.
  [[nodiscard]] double nearest(Vec3 at) const;

  struct Range {
    double low, high;
  };
  /// The least range that is sure to hold the first numbers of all samples from `low` to `high`, by leaves
  /// and tiles; it ends early, with what it has, when it is beyond `enough` on both sides.
  [[nodiscard]] Range range(const VoxelCoord& low, const VoxelCoord& high, const Range& enough) const;
  /// The range of what is interpolated in a box, in samples, but for rounding; none if the box spans more
  /// than kFine cells along an axis, or leaves the reach of volumes. Between 8 samples that is trilinear, so
  /// its extremes in a box are at the box's corners.
  static constexpr std::int32_t kFine = 4;
  [[nodiscard]] std::optional<Range> fine_range(const Box3& box, const Range& enough) const;
  /// The range of a leaf's values.
  [[nodiscard]] const Range& leaf_range(std::size_t leaf) const { return leaf_ranges_[leaf]; }

 private:
  /// A cube of 128³ voxels in which something stands.
  struct Node {
    VoxelCoord origin{};
    Range range{};
    std::uint32_t parts = 0;  ///< leaves and smallest tiles
  };
  /// Where a leaf's numbers begin, or none; `other` is then the value.
  [[nodiscard]] std::uint32_t find_leaf(const VoxelCoord& at) const;
  [[nodiscard]] const VolumeValue& beyond_leaves(const VoxelCoord& at) const;
  [[nodiscard]] VolumeValue leaf_numbers(std::uint32_t leaf, const VoxelCoord& at) const;
  void add_range(const Node& node, const VoxelCoord& low, const VoxelCoord& high, const Range& enough,
                 Range& found) const;

  const SparseVolume& volume_;
  PlaceTable leaves_, small_tiles_, tiles_, roots_, nodes_;
  bool has_tiles_ = false;
  std::vector<Range> leaf_ranges_;
  std::vector<Node> node_list_;
};

}  // namespace mesocell
