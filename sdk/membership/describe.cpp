#include <cstdio>

#include "sdk/membership/diagnose.h"

namespace mesocell {
namespace {

struct DefectText {
  const char* id;
  std::uint64_t MeshDiagnosis::*count;
  const char *one, *many;
};

/// By MeshDefect.
constexpr DefectText kTexts[kMeshDefectCount] = {
    {"degenerate-triangles", &MeshDiagnosis::degenerate_triangles, "triangle with a repeated vertex",
     "triangles with a repeated vertex"},
    {"zero-area-triangles", &MeshDiagnosis::zero_area_triangles, "triangle of area zero",
     "triangles of area zero"},
    {"boundary-edges", &MeshDiagnosis::boundary_edges, "boundary edge", "boundary edges"},
    {"non-manifold-edges", &MeshDiagnosis::non_manifold_edges, "non-manifold edge", "non-manifold edges"},
    {"misoriented-edges", &MeshDiagnosis::misoriented_edges, "edge between triangles of opposite orientation",
     "edges between triangles of opposite orientation"},
    {"unbalanced-edges", &MeshDiagnosis::unbalanced_edges,
     "edge not run along equally often in both directions",
     "edges not run along equally often in both directions"},
    {"non-manifold-vertices", &MeshDiagnosis::non_manifold_vertices, "non-manifold vertex",
     "non-manifold vertices"},
    {"duplicate-triangles", &MeshDiagnosis::duplicate_triangles, "duplicate triangle", "duplicate triangles"},
    {"opposite-duplicates", &MeshDiagnosis::opposite_duplicates,
     "pair of coincident triangles of opposite orientation",
     "pairs of coincident triangles of opposite orientation"},
    {"unreferenced-vertices", &MeshDiagnosis::unreferenced_vertices, "vertex that no triangle uses",
     "vertices that no triangle uses"},
    {"inside-out-components", &MeshDiagnosis::inside_out_components, "closed component turned inside out",
     "closed components turned inside out"},
    {"nested-components", &MeshDiagnosis::nested_components, "closed component inside another",
     "closed components inside others"},
    {"self-intersections", &MeshDiagnosis::self_intersections, "pair of triangles that intersect",
     "pairs of triangles that intersect"},
};

std::string counted(const DefectText& text, std::uint64_t count) {
  return std::to_string(count) + " " + (count == 1 ? text.one : text.many);
}

std::string near(const Vec3& place) {
  char text[128];
  std::snprintf(text, sizeof text, ", the first near (%.6g, %.6g, %.6g)", place.x, place.y, place.z);
  return text;
}

}  // namespace

std::vector<MeshFinding> findings(const MeshDiagnosis& d) {
  std::vector<MeshFinding> found;
  for (std::size_t k = 0; k < kMeshDefectCount; ++k) {
    const MeshDefect defect = MeshDefect(k);
    const bool at_least = defect == MeshDefect::kSelfIntersection && d.self_intersections_at_least;
    if (const std::uint64_t count = d.*kTexts[k].count)
      found.push_back({defect, kTexts[k].id, count, at_least, d.examples[k]});
  }
  return found;
}

std::string describe(const MeshFinding& finding) {
  std::string text = finding.at_least ? "at least " : "";
  text += counted(kTexts[std::size_t(finding.defect)], finding.count);
  if (finding.example) text += near(*finding.example);
  return text;
}

std::string describe(const MeshDiagnosis& d) {
  if (d.triangles == d.degenerate_triangles)
    return d.triangles == 0 ? "the mesh has no triangles" : "all triangles of the mesh are degenerate";
  if (d.closed()) return "the mesh is closed";
  std::string text = "the mesh is not closed:";
  for (const MeshDefect defect : {MeshDefect::kBoundaryEdge, MeshDefect::kNonManifoldEdge,
                                  MeshDefect::kMisorientedEdge, MeshDefect::kRepeatedVertex}) {
    const DefectText& t = kTexts[std::size_t(defect)];
    if (d.*t.count > 0) text += (text.back() == ':' ? " " : ", ") + counted(t, d.*t.count);
  }
  if (d.example) text += near(*d.example);
  return text;
}

}  // namespace mesocell
