#include "sdk/membership/diagnose.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace mesocell {
namespace {

struct HalfEdge {
  std::uint32_t low, high;
  std::int32_t direction;  ///< +1 from low to high, -1 back
};

}  // namespace

MeshDiagnosis diagnose(const TriangleMesh& mesh) {
  MeshDiagnosis d;
  d.triangles = mesh.triangles.size();
  // Coordinates that are not finite would break the order that merging sorts by; readers refuse them.
  const std::vector<std::uint32_t> merged = merge_identical_vertices(mesh.vertices);
  std::vector<HalfEdge> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t v[3] = {merged[t[0]], merged[t[1]], merged[t[2]]};
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
      ++d.degenerate_triangles;
      continue;
    }
    for (int e = 0; e < 3; ++e) {
      const std::uint32_t p = v[e], q = v[(e + 1) % 3];
      edges.push_back({std::min(p, q), std::max(p, q), p < q ? 1 : -1});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return a.low != b.low ? a.low < b.low : a.high < b.high;
  });
  for (std::size_t k = 0; k < edges.size();) {
    std::size_t end = k;
    std::int64_t sum = 0;
    while (end < edges.size() && edges[end].low == edges[k].low && edges[end].high == edges[k].high)
      sum += edges[end++].direction;
    const std::size_t count = end - k;
    if (count == 1) ++d.boundary_edges;
    if (count == 2 && sum != 0) ++d.misoriented_edges;
    if (count > 2) ++d.non_manifold_edges;
    if (sum != 0) {
      ++d.unbalanced_edges;
      if (!d.example) d.example = (mesh.vertices[edges[k].low] + mesh.vertices[edges[k].high]) * 0.5;
    }
    k = end;
  }
  return d;
}

std::string describe(const MeshDiagnosis& d) {
  if (d.triangles == d.degenerate_triangles)
    return d.triangles == 0 ? "the mesh has no triangles" : "all triangles of the mesh are degenerate";
  if (d.closed()) return "the mesh is closed";
  std::string text = "the mesh is not closed:";
  const auto add = [&](std::uint64_t n, const char* one, const char* many) {
    if (n == 0) return;
    text += (text.back() == ':' ? " " : ", ") + std::to_string(n) + " " + (n == 1 ? one : many);
  };
  add(d.boundary_edges, "boundary edge", "boundary edges");
  add(d.non_manifold_edges, "non-manifold edge", "non-manifold edges");
  add(d.misoriented_edges, "edge between triangles of opposite orientation",
      "edges between triangles of opposite orientation");
  add(d.degenerate_triangles, "degenerate triangle", "degenerate triangles");
  if (d.example) {
    char place[128];
    std::snprintf(place, sizeof place, ", the first near (%.6g, %.6g, %.6g)", d.example->x, d.example->y,
                  d.example->z);
    text += place;
  }
  return text;
}

}  // namespace mesocell
