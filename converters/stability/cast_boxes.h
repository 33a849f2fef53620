#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "format/cell_object.h"
#include "sdk/core/ray.h"

namespace mesocell {

/// Voxels [low, high) of a cell.
struct CellBox {
  std::array<std::int32_t, 3> low{}, high{};
  std::uint32_t cell = 0;  ///< from 1

  [[nodiscard]] bool holds(Vec3 p) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (!(p[a] >= low[a] && p[a] < high[a])) return false;
    return true;
  }
};

/// A cell object whose cells are boxes, so that what a ray hits is known in closed form.
struct BoxObject {
  CellObject object;
  std::vector<CellBox> boxes;  ///< those of INSIDE instances, in voxels of the grid
};

/// `cells[k]` is cell k + 1 of the tile, within it and overlapping no other; an instance is INSIDE where
/// `inside(x, y, z of the tile)` says. One metre a voxel, the corner at the origin.
[[nodiscard]] BoxObject make_box_object(
    const Index3& resolution, std::span<const CellBox> cells, const Index3& tiles,
    const std::function<bool(std::uint32_t, std::uint32_t, std::uint32_t)>& inside);

/// Where a ray meets boxes first.
struct BoxHit {
  double t = 0;
  std::uint32_t cell = 0;
};

/// The first box that a ray in voxel units visits: some t ≥ 0 has origin + t·direction in [low, high).
/// [spec 4.9] Exact where the quotients (plane - origin) / direction are, else to their rounding.
[[nodiscard]] std::optional<BoxHit> first_box(std::span<const CellBox> boxes, const Ray& ray);

}  // namespace mesocell
