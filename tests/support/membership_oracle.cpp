#include "tests/support/membership_oracle.h"

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "sdk/membership/predicates.h"

namespace mesocell::test {
namespace {

/// Side of (px + ε, py + ε²) of the line from a to b in the x-y plane; never 0 unless a and b project alike.
int side_2d(const Vec3& a, const Vec3& b, double px, double py) {
  if (const int s = orientation_2d(a.x, a.y, b.x, b.y, px, py)) return s;
  if (a.y != b.y) return a.y > b.y ? 1 : -1;  // the ε in x: -(b.y - a.y)
  return b.x > a.x ? 1 : b.x < a.x ? -1 : 0;  // the ε² in y
}

/// Side of p + (ε, ε², ε³) of the plane through a, b, c, which is not vertical.
int side_3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  if (const int s = orientation_3d(a, b, c, p)) return s;
  // The components of the normal, in the order of the powers of ε.
  if (const int s = orientation_2d(a.y, a.z, b.y, b.z, c.y, c.z)) return s;
  if (const int s = orientation_2d(a.z, a.x, b.z, b.x, c.z, c.x)) return s;
  return orientation_2d(a.x, a.y, b.x, b.y, c.x, c.y);
}

using Point = std::array<mpq_class, 3>;

/// The part of a convex polygon (or segment, or point) where sign · x[axis] ≥ sign · bound.
std::vector<Point> clip(const std::vector<Point>& polygon, std::size_t axis, int sign,
                        const mpq_class& bound) {
  std::vector<Point> kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const mpq_class a = sign * (p[axis] - bound), b = sign * (q[axis] - bound);
    if (a >= 0) kept.push_back(p);
    if ((a > 0 && b < 0) || (a < 0 && b > 0)) {
      Point crossing;
      for (std::size_t c = 0; c < 3; ++c) crossing[c] = p[c] + (q[c] - p[c]) * (a / (a - b));
      kept.push_back(crossing);
    }
  }
  return kept;
}

bool meets_voxel(const std::array<Vec3, 3>& triangle, const std::array<std::int64_t, 3>& voxel) {
  std::vector<Point> polygon;
  for (const Vec3& v : triangle) {
    bool within = true;
    for (std::size_t a = 0; a < 3; ++a)
      within = within && v[a] >= double(voxel[a]) && v[a] <= double(voxel[a] + 1);
    if (within) return true;
  }
  for (const Vec3& v : triangle) polygon.push_back({mpq_class(v.x), mpq_class(v.y), mpq_class(v.z)});
  for (std::size_t a = 0; a < 3 && !polygon.empty(); ++a) {
    polygon = clip(polygon, a, 1, mpq_class(long(voxel[a])));
    if (!polygon.empty()) polygon = clip(polygon, a, -1, mpq_class(long(voxel[a] + 1)));
  }
  return !polygon.empty();
}

/// Whether a voxel is farther from the triangle's plane than rounding can hide, so that it need not be looked
/// at.
class FarFromPlane {
 public:
  explicit FarFromPlane(const std::array<Vec3, 3>& t)
      : a_(t[0]),
        normal_(cross(t[1] - t[0], t[2] - t[0])),
        size_(length(t[1] - t[0]) * length(t[2] - t[0])) {}

  bool operator()(const std::array<std::int64_t, 3>& voxel) const {
    const Vec3 c = Vec3{double(voxel[0]) + 0.5, double(voxel[1]) + 0.5, double(voxel[2]) + 0.5} - a_;
    const double half = (std::abs(normal_.x) + std::abs(normal_.y) + std::abs(normal_.z)) / 2;
    return std::abs(dot(normal_, c)) > half + 1e-9 * size_ * (1 + length(a_) + length(c));
  }

 private:
  Vec3 a_, normal_;
  double size_;
};

Point exact(const Vec3& v) { return {mpq_class(v.x), mpq_class(v.y), mpq_class(v.z)}; }

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

mpq_class dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The part of a convex polygon where normal · (x - origin) ≥ 0.
std::vector<Point> clip(const std::vector<Point>& polygon, const Point& normal, const Point& origin) {
  std::vector<Point> kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const mpq_class a = dot(normal, minus(p, origin)), b = dot(normal, minus(q, origin));
    if (a >= 0) kept.push_back(p);
    if (a * b >= 0) continue;
    Point crossing;
    for (std::size_t c = 0; c < 3; ++c) crossing[c] = p[c] + (q[c] - p[c]) * (a / (a - b));
    kept.push_back(crossing);
  }
  return kept;
}

}  // namespace

bool triangles_intersect_by_definition(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  std::vector<Vec3> shared;
  for (const Vec3& v : a)
    if (std::find(b.begin(), b.end(), v) != b.end()) shared.push_back(v);
  if (shared.size() == 3) return false;
  const std::array<Point, 3> t{exact(b[0]), exact(b[1]), exact(b[2])};
  const Point normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  const Point opposite{-normal[0], -normal[1], -normal[2]};
  std::vector<Point> common{exact(a[0]), exact(a[1]), exact(a[2])};
  common = clip(clip(common, normal, t[0]), opposite, t[0]);
  for (std::size_t k = 0; k < 3; ++k) common = clip(common, cross(normal, minus(t[(k + 1) % 3], t[k])), t[k]);
  return std::any_of(common.begin(), common.end(), [&](const Point& p) {
    if (shared.empty()) return true;
    const Point v = exact(shared[0]);
    if (shared.size() == 1) return p != v;
    const Point off = cross(minus(exact(shared[1]), v), minus(p, v));
    return off[0] != 0 || off[1] != 0 || off[2] != 0;
  });
}

std::vector<bool> touched_by_definition(const TriangleMesh& mesh, const Index3& voxels) {
  std::vector<bool> touched(std::size_t{voxels[0]} * voxels[1] * voxels[2]);
  for (const Triangle& t : mesh.triangles) {
    const std::array<Vec3, 3> triangle{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    const FarFromPlane far(triangle);
    Box3 box;
    for (const Vec3& v : triangle) box.add(v);
    std::array<std::int64_t, 3> low{}, high{}, v{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::int64_t(std::clamp(std::floor(box.min[a]) - 1, 0.0, double(voxels[a])));
      high[a] = std::int64_t(std::clamp(std::floor(box.max[a]) + 2, 0.0, double(voxels[a])));
    }
    for (v[2] = low[2]; v[2] < high[2]; ++v[2])
      for (v[1] = low[1]; v[1] < high[1]; ++v[1])
        for (v[0] = low[0]; v[0] < high[0]; ++v[0]) {
          const std::size_t i =
              std::size_t(v[0]) +
              std::size_t{voxels[0]} * (std::size_t(v[1]) + std::size_t{voxels[1]} * std::size_t(v[2]));
          if (!touched[i] && !far(v)) touched[i] = meets_voxel(triangle, v);
        }
  }
  return touched;
}

std::vector<bool> inside_by_definition(const TriangleMesh& mesh, const Index3& voxels) {
  std::vector<bool> inside(std::size_t{voxels[0]} * voxels[1] * voxels[2]);
  // Only which triangles to look at is narrowed, by their boxes; what they do is computed for every voxel.
  std::vector<std::vector<std::uint32_t>> of_column(std::size_t{voxels[0]} * voxels[1]);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Box3 box;
    for (const std::uint32_t v : mesh.triangles[t]) box.add(mesh.vertices[v]);
    const auto clamp = [](double x, std::uint32_t n) { return std::uint32_t(std::clamp(x, 0.0, double(n))); };
    const std::uint32_t x1 = clamp(box.max.x + 1, voxels[0]), y1 = clamp(box.max.y + 1, voxels[1]);
    for (std::uint32_t y = clamp(box.min.y - 1, voxels[1]); y < y1; ++y)
      for (std::uint32_t x = clamp(box.min.x - 1, voxels[0]); x < x1; ++x)
        of_column[x + std::size_t{voxels[0]} * y].push_back(t);
  }
  for (std::uint32_t y = 0; y < voxels[1]; ++y)
    for (std::uint32_t x = 0; x < voxels[0]; ++x) {
      std::vector<std::pair<std::uint32_t, int>>
          pierced;  // triangles on the column's line, with their orientation
      const double px = x + 0.5, py = y + 0.5;
      for (const std::uint32_t t : of_column[x + std::size_t{voxels[0]} * y]) {
        const Triangle& v = mesh.triangles[t];
        const Vec3 &a = mesh.vertices[v[0]], &b = mesh.vertices[v[1]], &c = mesh.vertices[v[2]];
        const int s = orientation_2d(a.x, a.y, b.x, b.y, c.x, c.y);
        if (s != 0 && side_2d(a, b, px, py) == s && side_2d(b, c, px, py) == s && side_2d(c, a, px, py) == s)
          pierced.emplace_back(t, s);
      }
      for (std::uint32_t z = 0; z < voxels[2]; ++z) {
        int winding = 0;
        for (const auto& [t, s] : pierced) {
          const Triangle& v = mesh.triangles[t];
          const int side =
              side_3d(mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]], {px, py, z + 0.5});
          if (side * s < 0) winding += s;  // the triangle is above; a ray upward leaves where it faces up
        }
        inside[x + std::size_t{voxels[0]} * (y + std::size_t{voxels[1]} * z)] = winding != 0;
      }
    }
  return inside;
}

std::vector<Tag> tags_by_definition(const std::vector<bool>& inside, const Index3& tiles, const TileMap& tile,
                                    const std::vector<bool>& touched) {
  const std::int64_t n[3] = {tiles[0], tiles[1], tiles[2]};
  const std::int64_t r[3] = {tile.resolution[0], tile.resolution[1], tile.resolution[2]};
  std::vector<bool> any_inside(std::size_t(n[0] * n[1] * n[2]) * tile.cell_count),
      any_outside(any_inside.size());
  std::int64_t reach = 0;  // tiles beyond the grid in which instances at home in it may have voxels
  for (const Piece& p : tile.pieces)
    for (const std::int8_t h : p.home) reach = std::max<std::int64_t>(reach, std::abs(h));
  std::int64_t t[3], v[3];
  for (t[2] = -reach; t[2] < n[2] + reach; ++t[2])
    for (t[1] = -reach; t[1] < n[1] + reach; ++t[1])
      for (t[0] = -reach; t[0] < n[0] + reach; ++t[0]) {
        bool in_grid = true;
        for (int a = 0; a < 3; ++a) in_grid = in_grid && t[a] >= 0 && t[a] < n[a];
        for (v[2] = 0; v[2] < r[2]; ++v[2])
          for (v[1] = 0; v[1] < r[1]; ++v[1])
            for (v[0] = 0; v[0] < r[0]; ++v[0]) {
              const std::uint32_t id = tile.id(std::uint64_t(v[0] + r[0] * (v[1] + r[1] * v[2])));
              if (id == 0) continue;
              const Piece& p = tile.pieces[id - 1];
              std::int64_t h[3];
              bool home_in_grid = true;
              for (int a = 0; a < 3; ++a) {
                h[a] = t[a] + p.home[std::size_t(a)];
                home_in_grid = home_in_grid && h[a] >= 0 && h[a] < n[a];
              }
              if (!home_in_grid) continue;
              const std::size_t instance =
                  std::size_t(h[0] + n[0] * (h[1] + n[1] * h[2])) * tile.cell_count + p.cell - 1;
              const std::size_t voxel =
                  std::size_t(t[0] * r[0] + v[0] +
                              n[0] * r[0] * (t[1] * r[1] + v[1] + n[1] * r[1] * (t[2] * r[2] + v[2])));
              const bool in = in_grid && inside[voxel];
              const bool both = in_grid && !touched.empty() && touched[voxel];
              if (in || both) any_inside[instance] = true;
              if (!in || both) any_outside[instance] = true;
            }
      }
  std::vector<Tag> tags(any_inside.size());
  for (std::size_t k = 0; k < tags.size(); ++k)
    tags[k] = !any_outside[k] ? Tag::kInside : !any_inside[k] ? Tag::kOutside : Tag::kIntersected;
  return tags;
}

std::uint64_t wrong_tags(const MembershipMap& map, const std::vector<Tag>& expected) {
  std::uint64_t wrong = 0;
  for (std::uint64_t t = 0; t < map.entries.size(); ++t)
    for (std::uint32_t c = 1; c <= map.cell_count; ++c)
      wrong += map.tag(t, c) != expected[t * map.cell_count + c - 1];
  return wrong;
}

TileMap single_voxel_cells(const Index3& resolution) {
  TileMap tile;
  tile.resolution = resolution;
  tile.cell_count = std::uint32_t(tile.voxel_count());
  tile.id_bytes = TileMap::id_bytes_for(tile.cell_count);
  for (std::uint32_t cell = 1; cell <= tile.cell_count; ++cell) {
    tile.pieces.push_back({std::uint16_t(cell), {}});
    for (std::uint32_t b = 0; b < tile.id_bytes; ++b) tile.voxel_ids.push_back(std::uint8_t(cell >> (8 * b)));
  }
  return tile;
}

std::vector<bool> inside_voxels(const MembershipMap& map, const TileMap& tile) {
  const Index3 size = voxels_of(map.tiles, tile), r = tile.resolution;
  std::vector<bool> inside;
  inside.reserve(std::size_t{size[0]} * size[1] * size[2]);
  for (std::uint32_t z = 0; z < size[2]; ++z)
    for (std::uint32_t y = 0; y < size[1]; ++y)
      for (std::uint32_t x = 0; x < size[0]; ++x) {
        const std::uint64_t t =
            x / r[0] + std::uint64_t{map.tiles[0]} * (y / r[1] + std::uint64_t{map.tiles[1]} * (z / r[2]));
        const std::uint32_t cell = 1 + x % r[0] + r[0] * (y % r[1] + r[1] * (z % r[2]));
        inside.push_back(map.tag(t, cell) == Tag::kInside);
      }
  return inside;
}

Index3 voxels_of(const Index3& tiles, const TileMap& tile) {
  return {tiles[0] * tile.resolution[0], tiles[1] * tile.resolution[1], tiles[2] * tile.resolution[2]};
}

TriangleMesh in_voxels(const TriangleMesh& mesh, const GridLayout& grid) {
  TriangleMesh m = mesh;
  for (Vec3& v : m.vertices) v = (v - to_vec3(grid.box_min)) / grid.voxel_edge;
  return m;
}

}  // namespace mesocell::test
