#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>

#include "sdk/surface/explicit_surface.h"
#include "sdk/surface/normals.h"
#include "tests/support/objects.h"

/// Objects and sets of triangles that tests of exports compare.
namespace mesocell::test {

/// Cells of two colors and normals, in a grid that is nowhere near whole numbers.
[[nodiscard]] inline CellObject colored_object(std::uint64_t seed = 1) {
  Rng rng(seed);
  CellObject o = random_object(rng, "voronoi:cells=5,resolution=8,seed=3", {3, 4, 3}, 0.6);
  o.grid.box_min = {0.1, -7.3, 1e3 / 7};
  o.grid.voxel_edge = 0.0123;
  o.cell_colors = ColorList{{{255, 0, 0}, {0, 255, 0}, {0, 0, 1}, {1, 1, 1}, {0, 0, 0}}, 0};
  return o;
}

using LatticeTriangle = std::array<std::array<std::int32_t, 3>, 3>;

/// Beginning with its least corner, still turning the same way.
[[nodiscard]] inline LatticeTriangle turned(LatticeTriangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

/// Of a surface less a point.
[[nodiscard]] inline std::multiset<LatticeTriangle> triangles_of(
    const ExplicitSurface& s, const std::array<std::int32_t, 3>& less = {}) {
  std::multiset<LatticeTriangle> out;
  for (std::uint64_t k = 0; k < s.triangle_count(); ++k) {
    LatticeTriangle t;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t a = 0; a < 3; ++a) t[c][a] = s.vertices[s.triangle(k)[c]][a] - less[a];
    out.insert(turned(t));
  }
  return out;
}

/// The least of a surface's vertices, axis by axis.
[[nodiscard]] inline std::array<std::int32_t, 3> least_of(const ExplicitSurface& s) {
  std::array<std::int32_t, 3> least = s.vertices.at(0);
  for (const auto& v : s.vertices)
    for (std::size_t a = 0; a < 3; ++a) least[a] = std::min(least[a], v[a]);
  return least;
}

}  // namespace mesocell::test
