#include "sdk/author/repair.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "sdk/core/closest_point.h"
#include "sdk/membership/orient.h"
#include "sdk/membership/stitch.h"
#include "sdk/membership/thicken.h"

namespace mesocell {
namespace {

/// Of the diagonal, and of alpha; what the method's authors recommend [Portaneri 2022].
constexpr double kDefaultAlpha = 1.0 / 20, kDefaultOffset = 1.0 / 30;

std::string metres(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g m", x);
  return text;
}

double farthest_distance(const TriangleMesh& wrap, const TriangleMesh& mesh) {
  const ClosestPoint surface(mesh);
  double most = 0;
  for (const Vec3& v : wrap.vertices) most = std::max(most, surface.query(v).distance);
  for (const Triangle& t : wrap.triangles)
    most = std::max(
        most, surface.query((wrap.vertices[t[0]] + wrap.vertices[t[1]] + wrap.vertices[t[2]]) / 3).distance);
  return most;
}

Status add_thickness(const RepairOptions& options, const Progress* progress, TriangleMesh& mesh,
                     RepairedMesh& out) {
  Result<ThickenedMesh> thick = thicken(mesh, options.thickness, progress);
  if (!thick) return thick.error();
  out.report.rung = RepairRung::kThicken;
  out.report.thickness = options.thickness;
  out.report.thickened_triangles = thick->thickened_triangles;
  out.warnings.push_back({"mesh-thickened", std::to_string(thick->thickened_components) + " open parts of " +
                                                std::to_string(thick->thickened_triangles) +
                                                " triangles were given a thickness of " +
                                                metres(options.thickness)});
  mesh = std::move(thick->mesh);
  return {};
}

Status wrap(const RepairOptions& options, const Progress* progress, TriangleMesh& mesh, RepairedMesh& out) {
  if (!options.wrapper)
    return Error{ErrorCode::kUsage, "this program was built without wrapping; use another way of repair"};
  RepairReport& report = out.report;
  report.wrap_alpha =
      options.wrap_alpha > 0 ? options.wrap_alpha : kDefaultAlpha * length(bounding_box(mesh).extent());
  report.wrap_offset = options.wrap_offset > 0 ? options.wrap_offset : kDefaultOffset * report.wrap_alpha;
  Result<TriangleMesh> wrapped = options.wrapper(mesh, report.wrap_alpha, report.wrap_offset, progress);
  if (!wrapped) return wrapped.error();
  report.rung = RepairRung::kWrap;
  report.wrap_distance = farthest_distance(*wrapped, mesh);
  out.warnings.push_back({"mesh-wrapped", "it was replaced by its alpha wrap (alpha " +
                                              metres(report.wrap_alpha) + ", offset " +
                                              metres(report.wrap_offset) + "), which lies up to " +
                                              metres(report.wrap_distance) + " outside of its surface"});
  mesh = std::move(*wrapped);
  return {};
}

/// What stitching and turning did.
void add_report(const TriangleMesh& mesh, const StitchedMesh& stitched, const OrientedMesh& oriented,
                RepairedMesh& out) {
  RepairReport& report = out.report;
  report.stitched_edges = stitched.stitched_edges;
  report.inserted_vertices = stitched.inserted_vertices;
  report.stitch_tolerance = stitched.tolerance;
  report.largest_move = stitched.largest_move;
  report.turned_triangles = oriented.turned;
  report.dropped_triangles = oriented.degenerate_dropped + oriented.duplicates_dropped + oriented.cancelled;
  if (stitched.mesh.triangles.size() != mesh.triangles.size() || stitched.stitched_edges > 0)
    out.warnings.push_back({"mesh-stitched", std::to_string(stitched.stitched_edges) +
                                                 " boundary edges were stitched, " +
                                                 std::to_string(stitched.inserted_vertices) +
                                                 " vertices inserted, nothing moved farther than " +
                                                 metres(stitched.largest_move)});
  if (oriented.turned + report.dropped_triangles > 0)
    out.warnings.push_back({"mesh-oriented", std::to_string(oriented.turned) + " triangles were turned and " +
                                                 std::to_string(report.dropped_triangles) +
                                                 " left out, so that they agree on what is outside"});
}

Status check(const RepairOptions& options) {
  for (const double length :
       {options.stitch_tolerance, options.thickness, options.wrap_alpha, options.wrap_offset})
    if (!(length >= 0) || !std::isfinite(length))
      return Error{ErrorCode::kUsage, "a length of the repair is no finite number of metres from 0"};
  return {};
}

}  // namespace

const char* rung_name(RepairRung rung) {
  switch (rung) {
    case RepairRung::kNone:
      return "none";
    case RepairRung::kOrient:
      return "orient";
    case RepairRung::kWinding:
      return "winding";
    case RepairRung::kWrap:
      return "wrap";
    case RepairRung::kThicken:
      return "thicken";
  }
  return "none";
}

namespace {

/// Whether so many edges have three triangles or more that which of them bound what is anyone's guess: more than a
/// tenth. Orientation does not go across such edges, so a winding number would be noise.
bool tangled(const TriangleMesh& mesh) {
  return diagnose(mesh).non_manifold_edges * 10 > mesh.triangles.size() * 3 / 2;
}

}  // namespace

Result<RepairedMesh> repair_mesh(const TriangleMesh& mesh, const RepairOptions& options,
                                 const Progress* progress, MeshDiagnosis* found) {
  const Error cancelled{ErrorCode::kCancelled, "cancelled"};
  if (Status status = check(options); !status) return status.error();
  RepairedMesh out;
  MeshDiagnosis diagnosis = diagnose(mesh);
  const bool closed = diagnosis.closed();
  if (!closed) {
    DiagnoseOptions whole;
    whole.depth = DiagnosisDepth::kGeometry;
    whole.threads = options.threads;
    diagnosis = diagnose(mesh, whole, progress);
  }
  if (found) *found = diagnosis;
  if (progress && progress->cancelled()) return cancelled;
  const auto refused = [&](const char* remedy) {
    return Error{ErrorCode::kInvalidInput, describe(diagnosis) + remedy, "mesh-not-closed"};
  };
  if (!closed && options.repair == Repair::kStrict)
    return refused("; close it in a mesh editor, or let it be repaired");
  if (closed && diagnosis.degenerate_triangles > 0)
    out.warnings.push_back({"degenerate-triangles", std::to_string(diagnosis.degenerate_triangles) +
                                                        " triangles with a repeated vertex were left out"});
  if (closed && options.thickness == 0) return out;

  StitchedMesh stitched = stitch(mesh, {options.stitch_tolerance}, progress);
  if (stitched.interrupted) return cancelled;
  OrientedMesh oriented = orient(stitched.mesh, progress);
  if (oriented.interrupted) return cancelled;
  if (oriented.mesh.triangles.empty())
    return Error{ErrorCode::kInvalidInput,
                 "all of its triangles enclose nothing; check how the file was made", "mesh-flat"};
  if (options.thickness > 0 && oriented.closed)
    out.warnings.push_back({"option-unused", "a thickness has no effect on a mesh that is closed"});
  if (closed && oriented.closed) return out;
  add_report(mesh, stitched, oriented, out);
  out.report.rung = oriented.closed ? RepairRung::kOrient : RepairRung::kWinding;
  Status status;
  if (!oriented.closed && options.thickness > 0)
    status = add_thickness(options, progress, oriented.mesh, out);
  else if (!oriented.closed && options.repair == Repair::kOrient)
    return refused(
        "; stitching and turning triangles does not close it: close it in a mesh editor, or let its winding "
        "number or a wrap decide");
  else if (!oriented.closed && options.repair == Repair::kWrap)
    status = wrap(options, progress, oriented.mesh, out);
  else if (!oriented.closed && options.repair == Repair::kAuto && options.wrapper && tangled(oriented.mesh)) {
    // Where it can't be wrapped either, the winding number is asked all the same.
    TriangleMesh wrapped = oriented.mesh;
    RepairedMesh tried = out;
    status = wrap(options, progress, wrapped, tried);
    if (!status && status.error().code == ErrorCode::kCancelled) return status.error();
    if (status.ok()) {
      out = std::move(tried);
      oriented.mesh = std::move(wrapped);
      out.warnings.push_back({"mesh-tangled", "too many of its edges have three triangles or more to tell what "
                                              "they bound, so its wrap was taken"});
    }
    status = {};
  }
  if (!status) return status.error();
  out.mesh = std::move(oriented.mesh);
  return out;
}

}  // namespace mesocell
