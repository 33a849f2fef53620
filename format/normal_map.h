#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"

/// Which voxels have a normal, and how a normal stands in two bytes. [spec 4.8]
namespace mesocell MESOCELL_API {

/// One byte a voxel of the tile, in storage order: 1 for a boundary voxel, that is one which is not empty and
/// has one of 26 neighbours, around the torus, that is empty or of another instance; else 0. [spec 4.8]
/// Takes a valid tile: voxel_count() ids, each at most pieces.size(). One pass; besides the result it needs
/// seven bytes for each voxel of one slice.
[[nodiscard]] std::vector<std::uint8_t> boundary_voxels(const TileMap& tile);
/// How many they are, without the array.
[[nodiscard]] std::uint64_t count_boundary_voxels(const TileMap& tile);

/// Bytes of a code are in 0…kMaxNormalByte. [spec 4.8]
inline constexpr std::uint8_t kMaxNormalByte = 252;

/// The greatest angle between a unit vector and decode_normal(encode_normal()) of it, degrees. [spec 4.8]
inline constexpr double kNormalCodeErrorDegrees = 0.645;

/// The octahedral code of a unit vector. Only integers decide between codes, so all machines agree. A vector
/// of another length is taken for its direction as long as its components are in −1…1; one that is not finite
/// or is zero gives +z. No byte is above kMaxNormalByte.
[[nodiscard]] std::array<std::uint8_t, 2> encode_normal(std::array<double, 3> unit);

/// The unit vector of a code. A byte above kMaxNormalByte, which no valid file has, is taken for that.
[[nodiscard]] std::array<double, 3> decode_normal(std::array<std::uint8_t, 2> code);

}  // namespace mesocell
