#include "sdk/membership/diagnose.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "sdk/membership/mesh_topology.h"
#include "sdk/membership/nesting.h"
#include "sdk/membership/self_intersections.h"
#include "sdk/membership/triangle_triangle.h"

namespace mesocell {
namespace {

class Diagnostician {
 public:
  Diagnostician(const TriangleMesh& mesh, MeshDiagnosis& diagnosis)
      : vertices_(mesh.vertices), triangles_(merge_corners(mesh)), edges_(triangles_), d_(diagnosis) {
    d_.triangles = mesh.triangles.size();
  }

  void count_edges() {
    for (const Triangle& t : triangles_)
      if (has_repeated_vertex(t))
        count(d_.degenerate_triangles, MeshDefect::kRepeatedVertex, vertices_[t[0]]);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const std::span<const EdgeUse> uses = edges_[e];
      const bool balanced = balance(uses) == 0;
      const Vec3 middle = (vertices_[uses[0].low] + vertices_[uses[0].high]) * 0.5;
      if (uses.size() == 1) count(d_.boundary_edges, MeshDefect::kBoundaryEdge, middle);
      if (uses.size() == 2 && !balanced) count(d_.misoriented_edges, MeshDefect::kMisorientedEdge, middle);
      if (uses.size() > 2) count(d_.non_manifold_edges, MeshDefect::kNonManifoldEdge, middle);
      if (!balanced) count(d_.unbalanced_edges, MeshDefect::kUnbalancedEdge, middle);
    }
    d_.example = d_.examples[std::size_t(MeshDefect::kUnbalancedEdge)];
  }

  void count_triangles() {
    for (const Triangle& t : triangles_)
      if (!has_repeated_vertex(t) && collinear(vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]))
        count(d_.zero_area_triangles, MeshDefect::kZeroArea, centroid(t));
    for (const CoincidentTriangles& set : coincident_triangles(triangles_)) {
      const auto with = std::size_t(std::count(set.signs.begin(), set.signs.end(), 1));
      const std::size_t against = set.signs.size() - with;
      const std::size_t again = with - 1 + (against > 0 ? against - 1 : 0);
      const Vec3 place = centroid(triangles_[set.triangles[0]]);
      count(d_.duplicate_triangles, MeshDefect::kDuplicate, place, again);
      count(d_.opposite_duplicates, MeshDefect::kOppositeDuplicate, place, std::min(with, against));
    }
  }

  void count_vertices() {
    // Corners about a vertex hang together by the edges at it; each set of them is a fan.
    DisjointSets corners(triangles_.size() * 3);
    const auto corner = [&](const EdgeUse& use, std::uint32_t vertex) {
      const Triangle& t = triangles_[use.triangle];
      return 3 * use.triangle + (t[0] == vertex ? 0u : t[1] == vertex ? 1u : 2u);
    };
    for (std::size_t e = 0; e < edges_.size(); ++e)
      for (const EdgeUse& use : edges_[e].subspan(1))
        for (const std::uint32_t v : {use.low, use.high})
          corners.join(corner(edges_[e][0], v), corner(use, v));
    std::vector<std::uint32_t> fans(vertices_.size(), 0);
    std::vector<bool> used(vertices_.size(), false);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k) {
        used[triangles_[t][k]] = true;
        if (!has_repeated_vertex(triangles_[t]) && corners.find(3 * t + k) == 3 * t + k)
          ++fans[triangles_[t][k]];
      }
    const std::vector<std::uint32_t> merged = merge_identical_vertices(vertices_);
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
      if (fans[v] > 1) count(d_.non_manifold_vertices, MeshDefect::kNonManifoldVertex, vertices_[v]);
      if (merged[v] == v && !used[v])
        count(d_.unreferenced_vertices, MeshDefect::kUnreferencedVertex, vertices_[v]);
    }
  }

  /// Components, and what is inside what if asked for.
  void count_components(bool nesting) {
    Components components = edge_components(triangles_, edges_);
    d_.components = components.count;
    std::vector<bool> closed(components.count, true);
    for (std::size_t e = 0; e < edges_.size(); ++e)
      if (balance(edges_[e]) != 0) closed[components.of_triangle[edges_[e][0].triangle]] = false;
    std::vector<std::uint32_t> shell_of(components.count, kNoComponent);
    std::uint32_t shells = 0;
    for (std::uint32_t c = 0; c < components.count; ++c)
      if (closed[c]) shell_of[c] = shells++;
    d_.closed_components = shells;
    for (std::uint32_t& c : components.of_triangle)
      if (c != kNoComponent) c = shell_of[c];
    for (const Shell& shell :
         measure_shells(vertices_, triangles_, components.of_triangle, shells, nesting)) {
      if (shell.containers > 0) {
        count(d_.nested_components, MeshDefect::kNested, shell.lowest);
        if (shell.winding == (shell.volume < 0 ? 1 : -1)) ++d_.cavities;
      } else if (shell.volume < 0) {
        count(d_.inside_out_components, MeshDefect::kInsideOut, shell.lowest);
      }
    }
  }

  void count_self_intersections(const DiagnoseOptions& options, const Progress* progress) {
    SelfIntersectionLimits limits;
    limits.max_pairs = options.max_self_intersections;
    const SelfIntersections found =
        find_self_intersections(vertices_, triangles_, limits, options.threads, progress);
    d_.self_intersections = found.pairs;
    d_.self_intersections_at_least = found.at_least;
    d_.examples[std::size_t(MeshDefect::kSelfIntersection)] = found.example;
  }

 private:
  void count(std::uint64_t& counter, MeshDefect defect, Vec3 place, std::uint64_t by = 1) {
    if (by == 0) return;
    if (counter == 0) d_.examples[std::size_t(defect)] = place;
    counter += by;
  }

  [[nodiscard]] Vec3 centroid(const Triangle& t) const {
    return (vertices_[t[0]] + vertices_[t[1]] + vertices_[t[2]]) / 3;
  }

  const std::vector<Vec3>& vertices_;
  const std::vector<Triangle> triangles_;
  const EdgeTable edges_;
  MeshDiagnosis& d_;
};

}  // namespace

MeshDiagnosis diagnose(const TriangleMesh& mesh, const DiagnoseOptions& options, const Progress* progress) {
  MeshDiagnosis diagnosis;
  diagnosis.depth = options.depth;
  Diagnostician diagnostician(mesh, diagnosis);
  diagnostician.count_edges();
  if (options.depth == DiagnosisDepth::kEdges) return diagnosis;
  diagnostician.count_triangles();
  diagnostician.count_vertices();
  diagnostician.count_components(options.depth == DiagnosisDepth::kGeometry);
  if (options.depth == DiagnosisDepth::kGeometry) diagnostician.count_self_intersections(options, progress);
  return diagnosis;
}

}  // namespace mesocell
