#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/cell_object.h"

namespace mesocell {

/// What the voxels of a code belong to: image `shift` of a cell, that is, the cell moved by so many tiles.
struct CodeOwner {
  std::uint32_t cell = 0;  ///< 1…65535
  std::array<std::int32_t, 3> shift{};
  bool operator==(const CodeOwner&) const = default;
};

/// A number for each voxel, of as many bytes as needed.
class VoxelCodes {
 public:
  /// All voxels have code 0. `greatest`: the greatest code that will be set.
  VoxelCodes(std::uint64_t voxels, std::uint64_t greatest)
      : bytes_(TileMap::id_bytes_for(greatest)), codes_(voxels * bytes_) {}

  /// Different voxels may be set from different threads.
  void set(std::uint64_t i, std::uint32_t code) {
    for (std::uint32_t b = 0; b < bytes_; ++b) codes_[i * bytes_ + b] = std::uint8_t(code >> (8 * b));
  }
  [[nodiscard]] std::uint32_t get(std::uint64_t i) const {
    std::uint32_t v = 0;
    for (std::uint32_t b = 0; b < bytes_; ++b) v |= std::uint32_t{codes_[i * bytes_ + b]} << (8 * b);
    return v;
  }

 private:
  std::uint32_t bytes_;
  std::vector<std::uint8_t> codes_;
};

/// Makes a tile of the codes of its voxels: finds each instance's home tile, the pieces, and the narrowest
/// ids. Code k is owners[k - 1], 0 is empty; owners ascend by cell, then by shift (z, y, x). Cells without a
/// voxel are left out and the rest renumbered in order. At least one code must be set, and shifts of a cell
/// that are used must differ by less than 128 (asserted).
[[nodiscard]] TileMap assemble_tile(const Index3& resolution, const VoxelCodes& codes,
                                    std::span<const CodeOwner> owners, unsigned threads);

}  // namespace mesocell
