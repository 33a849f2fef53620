#include "sdk/author/repair.h"

#include <utility>

#include "sdk/membership/diagnose.h"
#include "sdk/membership/orient.h"

namespace mesocell {

Result<RepairedMesh> repair_mesh(const TriangleMesh& mesh, const RepairOptions& options,
                                 const Progress* progress) {
  RepairedMesh out;
  const MeshDiagnosis diagnosis = diagnose(mesh);
  if (diagnosis.closed()) {
    if (diagnosis.degenerate_triangles > 0)
      out.warnings.push_back({"degenerate-triangles", std::to_string(diagnosis.degenerate_triangles) +
                                                          " triangles with a repeated vertex were left out"});
    return out;
  }
  const auto refused = [&](const char* remedy) {
    return Error{ErrorCode::kInvalidInput, describe(diagnosis) + remedy, "mesh-not-closed"};
  };
  if (options.repair == Repair::kStrict) return refused("; close it in a mesh editor, or let it be repaired");
  if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  OrientedMesh oriented = orient(mesh);
  if (oriented.mesh.triangles.empty())
    return Error{ErrorCode::kInvalidInput,
                 "all of its triangles enclose nothing; check how the file was made", "mesh-flat"};
  if (!oriented.closed && options.repair == Repair::kOrient)
    return refused(
        "; turning triangles does not close it: close it in a mesh editor, or let its winding number decide");
  out.report.rung = oriented.closed ? RepairRung::kOrient : RepairRung::kWinding;
  out.report.turned_triangles = oriented.turned;
  out.report.dropped_triangles = mesh.triangles.size() - oriented.mesh.triangles.size();
  if (oriented.turned + out.report.dropped_triangles > 0)
    out.warnings.push_back({"mesh-oriented", std::to_string(oriented.turned) + " triangles were turned and " +
                                                 std::to_string(out.report.dropped_triangles) +
                                                 " left out, so that they agree on what is outside"});
  out.mesh = std::move(oriented.mesh);
  return out;
}

}  // namespace mesocell
