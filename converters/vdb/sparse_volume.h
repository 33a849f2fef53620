#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/result.h"
#include "sdk/core/transform.h"

namespace mesocell {

/// What a voxel of a volume holds.
enum class VolumeType : std::uint8_t {
  kFloat,   ///< one float
  kFloat3,  ///< three floats: a direction, a color
  kInt,     ///< a whole number: a label
  kInt3,    ///< three whole numbers
  kMask,    ///< true or false, kept as the active bits
};

/// What the values of a volume mean.
enum class VolumeClass : std::uint8_t {
  kUnknown,
  kLevelSet,  ///< signed distances, negative inside
  kFog,       ///< densities
};

/// A place in a volume, in voxels.
using VoxelCoord = std::array<std::int32_t, 3>;

/// A value of any type: numbers of floats are exact in doubles, as are whole numbers. One number is [0].
using VolumeValue = std::array<double, 3>;

/// A cube of voxels that are all the same.
struct VolumeTile {
  VoxelCoord origin{};         ///< its least voxel, a multiple of the edge
  std::uint8_t log2_edge = 3;  ///< 3, 7 or 12
  bool active = false;
  VolumeValue value{};
};

/// A cube of 8³ voxels; its values stand in the volume.
struct VolumeLeaf {
  VoxelCoord origin{};                    ///< its least voxel, a multiple of 8
  std::array<std::uint64_t, 8> active{};  ///< bit x + 8 y of word z; of a mask the values themselves
};

/// A sparse grid of samples at whole coordinates: leaves, else tiles, the smaller before the larger, else the
/// background.
struct SparseVolume {
  static constexpr std::int32_t kLeafEdge = 8;
  static constexpr std::size_t kLeafVoxels = 512;
  /// Coordinates are in [-kReach, kReach).
  static constexpr std::int32_t kReach = 1 << 23;

  std::string name;
  VolumeType type = VolumeType::kFloat;
  VolumeClass volume_class = VolumeClass::kUnknown;
  Transform index_to_world;  ///< of sample coordinates, metres; its linear part is not singular
  VolumeValue background{};
  std::vector<VolumeTile> tiles;
  std::vector<VolumeLeaf> leaves;
  /// kLeafVoxels × channels() numbers a leaf, x fastest, the channels of a voxel together; in `floats` or in
  /// `ints` as the type says, none of a mask.
  std::vector<float> floats;
  std::vector<std::int32_t> ints;
  std::vector<std::pair<std::string, std::string>> metadata;  ///< untrusted text, whatever a library had

  [[nodiscard]] std::size_t channels() const {
    return type == VolumeType::kFloat3 || type == VolumeType::kInt3 ? 3 : 1;
  }
  [[nodiscard]] bool has_floats() const { return type == VolumeType::kFloat || type == VolumeType::kFloat3; }
  [[nodiscard]] bool has_ints() const { return type == VolumeType::kInt || type == VolumeType::kInt3; }
  /// The numbers that `floats` or `ints` must hold.
  [[nodiscard]] std::size_t number_count() const { return leaves.size() * kLeafVoxels * channels(); }
};

/// Appends a volume in the form in which it goes between a worker and the command, which are of one build:
/// arrays are in the machine's byte order.
void write_volume(const SparseVolume& volume, ByteWriter& out);

/// Reads it back. Untrusted input: safe, memory is at most a small multiple of the bytes. What is returned is
/// sound: arrays of the sizes that they must have, origins aligned and in reach, numbers finite but for those
/// of floats in leaves, which become 0 where they are none or infinite; no two leaves or tiles of a size at
/// one place. Errors: kInvalidInput.
[[nodiscard]] Result<SparseVolume> read_volume(ByteReader& in);

/// Text with its length before it.
void write_text(std::string_view text, ByteWriter& out);
[[nodiscard]] std::string read_text(ByteReader& in);

void write_transform(const Transform& transform, ByteWriter& out);
[[nodiscard]] Transform read_transform(ByteReader& in);

/// Whether a map of space is finite and can be undone.
[[nodiscard]] bool is_sound(const Transform& transform);

/// The range of the active voxels, tiles included; false if there is none. Both ends are in it.
[[nodiscard]] bool active_range(const SparseVolume& volume, VoxelCoord& low, VoxelCoord& high);

/// The volume of a dense array of floats, whose background is the least of them; what is no number or
/// infinite becomes that.
/// - `values`: x fastest; sizes are at most kReach
[[nodiscard]] SparseVolume make_sparse(std::span<const float> values,
                                       const std::array<std::uint32_t, 3>& size);

}  // namespace mesocell
