#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/cell_object.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell {

/// A column of voxels meets a triangle.
struct Crossing {
  std::uint32_t u, v;   ///< the column
  std::uint32_t slice;  ///< voxels of the column before it: those whose centres are at a lower depth
  std::int8_t sign;     ///< +1 if the triangle's projection turns from u to v, else -1
};

/// Triangles rasterized along an axis as graphics hardware does it: at the centres of columns, each shared
/// edge giving a centre on it to one of its triangles, the depth interpolated. Double precision.
class CrossingFinder {
 public:
  /// `axis`: 0, 1 or 2, the depth's; u and v are the other two, ascending. The mesh is kept by reference.
  CrossingFinder(const TriangleMesh& mesh, std::size_t axis, const Index3& size);

  /// The columns are found in chunks of rows of v, any number of chunks at once.
  [[nodiscard]] std::size_t chunks() const { return first_.size() - 1; }
  [[nodiscard]] std::array<std::uint32_t, 2> rows(std::size_t chunk) const;
  /// `out`: the crossings of a chunk, in the order of triangles.
  void find(std::size_t chunk, std::vector<Crossing>& out) const;

 private:
  static constexpr std::uint32_t kRows = 16;

  const TriangleMesh& mesh_;
  std::size_t axis_, u_, v_;
  Index3 size_;
  // Chunk c has triangles_[first_[c]] … triangles_[first_[c + 1]].
  std::vector<std::uint64_t> first_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace mesocell
