#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sdk/surface/vertex_fans.h"

namespace mesocell {

using LatticePoint = std::array<std::int32_t, 3>;

/// A box of voxels, a byte each, 1 where solid, with two layers around it that belong to what is beyond.
class PaddedVoxels {
 public:
  static constexpr std::int32_t kPad = 2;

  /// All empty.
  void reset(const LatticePoint& size) {
    size_ = size;
    row_ = size[0] + 2 * kPad;
    layer_ = row_ * (size[1] + 2 * kPad);
    solid_.assign(std::size_t(layer_ * (size[2] + 2 * kPad)), 0);
  }
  [[nodiscard]] const LatticePoint& size() const { return size_; }
  /// Coordinates from -kPad to below the size + kPad.
  [[nodiscard]] std::uint8_t& at(const LatticePoint& v) { return solid_[index(v)]; }
  [[nodiscard]] const std::uint8_t* from(const LatticePoint& v) const { return solid_.data() + index(v); }
  [[nodiscard]] std::array<std::ptrdiff_t, 3> strides() const { return {1, row_, layer_}; }

  /// Of the point at the minimum corner of voxel `v`; coordinates from -1 to the size + 1.
  [[nodiscard]] std::uint8_t configuration(const LatticePoint& v) const {
    const std::uint8_t* const p = from(v);
    return std::uint8_t(p[-1 - row_ - layer_] | p[-row_ - layer_] << 1 | p[-1 - layer_] << 2 |
                        p[-layer_] << 3 | p[-1 - row_] << 4 | p[-row_] << 5 | p[-1] << 6 | p[0] << 7);
  }
  /// The fans there; coordinates from 0 to the size.
  [[nodiscard]] VertexFans fans(const LatticePoint& v) const;

 private:
  [[nodiscard]] std::size_t index(const LatticePoint& v) const {
    return std::size_t(v[0] + kPad + row_ * (v[1] + kPad) + layer_ * (v[2] + kPad));
  }

  LatticePoint size_{};
  std::int64_t row_ = 0, layer_ = 0;
  std::vector<std::uint8_t> solid_;
};

/// The faces of the solid voxels of a box as squares whose corners are vertices of fans.
class VoxelMesher {
 public:
  /// Calls vertex(point, number of fans) for each point of the lattice on the surface, up to the size of the
  /// box, z slowest; `vertex` returns the number of the first fan's vertex. Calls square(corners, face) for
  /// each face of a voxel in the box: numbers of its vertices, counter-clockwise from outside, of which the
  /// first is nearest to the minimum corner; the face is 2 · axis, + 1 if its normal points up the axis.
  template <typename Vertex, typename Square>
  void mesh(const PaddedVoxels& box, const Vertex& vertex, const Square& square);

  /// As mesh(), for the points that are given and no faces.
  template <typename Vertex>
  static void each_vertex(const PaddedVoxels& box, const LatticePoint& end, const Vertex& vertex);

 private:
  struct Plane {
    std::vector<std::uint32_t> first;  ///< vertex of each point
    std::vector<std::uint8_t> plain;
  };

  template <typename Square>
  void add_squares(const PaddedVoxels& box, std::int32_t z, const Square& square);

  [[nodiscard]] std::uint32_t corner(const PaddedVoxels& box, const LatticePoint& point, std::size_t upper,
                                     std::size_t face) const {
    const std::size_t at = std::size_t(point[0] + row_ * point[1]);
    const Plane& plane = planes_[upper];
    return plane.first[at] + (plane.plain[at] ? 0 : box.fans(point).of_face[face]);
  }

  std::int64_t row_ = 0;
  std::array<Plane, 2> planes_;  ///< below and above a layer of voxels
};

template <typename Vertex>
void VoxelMesher::each_vertex(const PaddedVoxels& box, const LatticePoint& end, const Vertex& vertex) {
  const FanTable& table = fan_table();
  const auto strides = box.strides();
  LatticePoint p{};
  for (p[2] = 0; p[2] < end[2]; ++p[2])
    for (p[1] = 0; p[1] < end[1]; ++p[1]) {
      p[0] = 0;
      const std::uint8_t* above = box.from(p);
      // Of the four voxels beside a point on the same side in x: those of the point before are half of it.
      const auto column = [&](std::ptrdiff_t x) {
        const std::uint8_t* const q = above + x;
        return unsigned(q[-strides[1] - strides[2]] | q[-strides[2]] << 2 | q[-strides[1]] << 4 | q[0] << 6);
      };
      unsigned before = column(-1);
      for (; p[0] < end[0]; ++p[0]) {
        const unsigned here = column(p[0]);
        const unsigned c = before | here << 1;
        before = here;
        if (c == 0 || c == 255) continue;
        vertex(p, table.plain[c] ? 1u : unsigned(box.fans(p).count), bool(table.plain[c]));
      }
    }
}

template <typename Vertex, typename Square>
void VoxelMesher::mesh(const PaddedVoxels& box, const Vertex& vertex, const Square& square) {
  const LatticePoint& size = box.size();
  row_ = std::int64_t{size[0]} + 1;
  const std::size_t points = std::size_t(row_ * (std::int64_t{size[1]} + 1));
  for (Plane& plane : planes_) {
    plane.first.resize(points);
    plane.plain.resize(points);
  }
  std::int32_t z = 0;
  const auto finish_plane = [&] {
    if (z > 0) add_squares(box, z - 1, square);
    std::swap(planes_[0], planes_[1]);
    ++z;
  };
  each_vertex(box, {size[0] + 1, size[1] + 1, size[2] + 1},
              [&](const LatticePoint& p, unsigned fans, bool plain) {
                while (z < p[2]) finish_plane();
                const std::size_t at = std::size_t(p[0] + row_ * p[1]);
                planes_[1].first[at] = vertex(p, fans);
                planes_[1].plain[at] = plain;
              });
  while (z <= size[2]) finish_plane();
}

template <typename Square>
void VoxelMesher::add_squares(const PaddedVoxels& box, std::int32_t z, const Square& square) {
  const auto strides = box.strides();
  LatticePoint v{0, 0, z};
  for (; v[1] < box.size()[1]; ++v[1]) {
    v[0] = 0;
    const std::uint8_t* const row = box.from(v);
    for (; v[0] < box.size()[0]; ++v[0]) {
      if (!row[v[0]]) continue;
      for (std::size_t face = 0; face < 6; ++face) {
        const std::size_t axis = face / 2, up = face % 2;
        if (row[v[0] + (up ? strides[axis] : -strides[axis])]) continue;
        const std::size_t u = (axis + 1) % 3, w = (axis + 2) % 3;
        constexpr std::size_t kUp[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        std::array<std::uint32_t, 4> corners{};
        for (std::size_t k = 0; k < 4; ++k) {
          const auto& [du, dw] = kUp[k];
          LatticePoint p = v;
          std::array<std::size_t, 3> d{};
          d[axis] = up;
          d[u] = du;
          d[w] = dw;
          for (std::size_t a = 0; a < 3; ++a) p[a] += std::int32_t(d[a]);
          corners[up ? k : (4 - k) % 4] = corner(box, p, d[2], fan_face(axis, 1 - du, 1 - dw));
        }
        square(corners, face);
      }
    }
  }
}

}  // namespace mesocell
