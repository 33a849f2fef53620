#include "sdk/membership/open_solid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <utility>

namespace mesocell {
namespace {

/// Where the cones contribute less than this, the nearest whole number is that of the closed mesh, with room
/// to tell which voxels are unsure.
constexpr double kPlain = 0.4;

/// An edge and how often the mesh's boundary runs along it, from a to b.
struct BoundaryEdge {
  std::uint32_t a, b;
  std::uint32_t times;
};

/// The boundary of a mesh as a chain: what is left when edges that are run along both ways cancel. At each
/// vertex as many edges end as begin. `merged`: as by merge_identical_vertices().
std::vector<BoundaryEdge> boundary_of(const TriangleMesh& mesh, const std::vector<std::uint32_t>& merged) {
  struct HalfEdge {
    std::uint32_t low, high;
    std::int32_t direction;
  };
  std::vector<HalfEdge> halves;
  halves.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t v[3] = {merged[t[0]], merged[t[1]], merged[t[2]]};
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    for (int e = 0; e < 3; ++e) {
      const std::uint32_t p = v[e], q = v[(e + 1) % 3];
      halves.push_back({std::min(p, q), std::max(p, q), p < q ? 1 : -1});
    }
  }
  std::sort(halves.begin(), halves.end(), [](const HalfEdge& p, const HalfEdge& q) {
    return std::pair(p.low, p.high) < std::pair(q.low, q.high);
  });
  std::vector<BoundaryEdge> edges;
  for (std::size_t k = 0; k < halves.size();) {
    std::int32_t sum = 0;
    const HalfEdge& first = halves[k];
    for (; k < halves.size() && halves[k].low == first.low && halves[k].high == first.high; ++k)
      sum += halves[k].direction;
    if (sum > 0) edges.push_back({first.low, first.high, std::uint32_t(sum)});
    if (sum < 0) edges.push_back({first.high, first.low, std::uint32_t(-sum)});
  }
  return edges;
}

/// For each edge the number of the connected part that it is of.
std::vector<std::uint32_t> parts_of(const std::vector<BoundaryEdge>& edges, std::size_t vertices,
                                    std::uint32_t& count) {
  std::vector<std::uint32_t> parents(vertices);
  for (std::uint32_t v = 0; v < vertices; ++v) parents[v] = v;
  const auto root = [&](std::uint32_t v) {
    while (parents[v] != v) v = parents[v] = parents[parents[v]];
    return v;
  };
  for (const BoundaryEdge& e : edges) {
    const std::uint32_t a = root(e.a), b = root(e.b);
    parents[std::max(a, b)] = std::min(a, b);
  }
  std::map<std::uint32_t, std::uint32_t> numbers;
  std::vector<std::uint32_t> parts;
  for (const BoundaryEdge& e : edges)
    parts.push_back(numbers.emplace(root(e.a), std::uint32_t(numbers.size())).first->second);
  count = std::uint32_t(numbers.size());
  return parts;
}

/// The mesh with a cone over each connected part of its boundary.
TriangleMesh close_by_cones(const TriangleMesh& mesh, const std::vector<BoundaryEdge>& edges) {
  TriangleMesh closed{mesh.vertices, mesh.triangles, {}};
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> parts = parts_of(edges, mesh.vertices.size(), count);
  std::vector<Vec3> sums(count);
  std::vector<double> ends(count, 0);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    sums[parts[k]] = sums[parts[k]] + mesh.vertices[edges[k].a] + mesh.vertices[edges[k].b];
    ends[parts[k]] += 2;
  }
  const std::uint32_t first = std::uint32_t(closed.vertices.size());
  // Off the middle by a crooked share of a voxel, lest voxel centres lie on edges between triangles of a
  // cone.
  for (std::uint32_t part = 0; part < count; ++part)
    closed.vertices.push_back(sums[part] / ends[part] + Vec3{0.0131071, 0.0217645, 0.0358979});
  for (std::size_t k = 0; k < edges.size(); ++k)
    for (std::uint32_t t = 0; t < edges[k].times; ++t)
      closed.triangles.push_back({edges[k].b, edges[k].a, first + parts[k]});
  return closed;
}

std::vector<std::array<Vec3, 3>> corners(const TriangleMesh& mesh, std::size_t from) {
  std::vector<std::array<Vec3, 3>> out;
  for (std::size_t t = from; t < mesh.triangles.size(); ++t) {
    const Triangle& v = mesh.triangles[t];
    out.push_back({mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]});
  }
  return out;
}

/// The first two corners of a cone's triangle are of the boundary.
std::vector<std::array<Vec3, 2>> rims(const TriangleMesh& mesh, std::size_t from) {
  std::vector<std::array<Vec3, 2>> out;
  for (std::size_t t = from; t < mesh.triangles.size(); ++t)
    out.push_back({mesh.vertices[mesh.triangles[t][0]], mesh.vertices[mesh.triangles[t][1]]});
  return out;
}

}  // namespace

OpenSolid::OpenSolid(const TriangleMesh& mesh, const Index3& size)
    : closed_(close_by_cones(mesh, boundary_of(mesh, merge_identical_vertices(mesh.vertices)))),
      mesh_triangles_(mesh.triangles.size()),
      segments_(closed_.triangles.size() - mesh_triangles_),
      cones_(corners(closed_, mesh_triangles_)),
      gradient_(rims(closed_, mesh_triangles_)) {
  if (segments_ == 0) return;
  const std::uint32_t longest = std::max({size[0], size[1], size[2], kBlock});
  find_blocks({0, 0, 0}, std::bit_ceil(longest), size);
  std::sort(blocks_.begin(), blocks_.end());
}

void OpenSolid::find_blocks(const std::array<std::uint32_t, 3>& low, std::uint32_t edge, const Index3& size) {
  Box3 box;  // of the voxels' centres
  for (std::size_t a = 0; a < 3; ++a) {
    if (low[a] >= size[a]) return;
    box.min[a] = low[a] + 0.5;
    box.max[a] = std::min(low[a] + edge, size[a]) - 0.5;
  }
  if (cones_.bound(box, kPlain) < kPlain) return;
  // Off the cones their share is as smooth as the winding number itself.
  if (cones_.clear_of(box)) {
    const Vec3 middle = (box.min + box.max) / 2;
    const WindingField::Value at = cones_.approximate(middle);
    const double most = std::abs(at.winding) + at.error + gradient_.bound(box) * length(box.extent()) / 2;
    if (most < kPlain) return;
  }
  if (edge == kBlock) {
    blocks_.push_back({low[2] / kBlock, low[1] / kBlock, low[0] / kBlock});
    return;
  }
  const std::uint32_t half = edge / 2;
  for (std::uint32_t child = 0; child < 8; ++child)
    find_blocks(
        {low[0] + (child & 1 ? half : 0), low[1] + (child & 2 ? half : 0), low[2] + (child & 4 ? half : 0)},
        half, size);
}

void OpenSolid::stretches(std::uint32_t y, std::uint32_t z, std::vector<RowStretch>& out) const {
  out.clear();
  const std::array<std::uint32_t, 3> row{z / kBlock, y / kBlock, 0};
  for (auto block = std::lower_bound(blocks_.begin(), blocks_.end(), row);
       block != blocks_.end() && (*block)[0] == row[0] && (*block)[1] == row[1]; ++block) {
    const std::uint32_t begin = (*block)[2] * kBlock;
    if (!out.empty() && out.back().end == begin)
      out.back().end += kBlock;
    else
      out.push_back({begin, begin + kBlock});
  }
}

}  // namespace mesocell
