#include "sdk/membership/membership.h"

#include "sdk/membership/shape_rows.h"
#include "sdk/membership/solid_scan.h"
#include "sdk/membership/tag_instances.h"

namespace mesocell {
namespace {

class MeshRows final : public RowSource {
 public:
  MeshRows(const TriangleMesh& mesh, const SolidScan& scan) : mesh_(mesh), scan_(scan) {}
  void bundle(std::uint32_t ty, std::uint32_t tz, Scanline::Scratch& scratch,
              RowIntervals& out) const override {
    scan_.bundle(ty, tz, scratch, out);
  }
  void triangles(std::uint32_t ty, std::uint32_t tz,
                 const std::function<void(const std::array<Vec3, 3>&)>& visit) const override {
    for (const std::uint32_t t : scan_.triangles(ty, tz)) {
      if (t >= mesh_.triangles.size()) continue;  // a cap
      const Triangle& v = mesh_.triangles[t];
      visit({mesh_.vertices[v[0]], mesh_.vertices[v[1]], mesh_.vertices[v[2]]});
    }
  }

 private:
  const TriangleMesh& mesh_;
  const SolidScan& scan_;
};

}  // namespace

Result<MembershipMap> compute_membership(const TriangleMesh& mesh, const Index3& tiles, const TileMap& tile,
                                         const MembershipOptions& options, MembershipReport* report,
                                         const Progress* progress) {
  const SolidScan scan(mesh, tile.resolution, tiles, options.solid, options.threads, progress);
  if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  MembershipReport found{.boundary_edges = scan.boundary_edges()};
  Result<MembershipMap> map = tag_instances(MeshRows(mesh, scan), tiles, tile, options, found, progress);
  if (map && report) *report = found;
  return map;
}

Result<MembershipMap> compute_membership(const SolidShape& shape, const GridLayout& grid, const TileMap& tile,
                                         const MembershipOptions& options, MembershipReport* report,
                                         const Progress* progress) {
  if (options.rule != MembershipRule::kCentre)
    return Error{ErrorCode::kUsage,
                 "a shape without triangles can be filled by the rule centre alone; use that"};
  MembershipReport found;
  Result<MembershipMap> map =
      tag_instances(ShapeRows(shape, grid, tile.resolution), grid.tiles, tile, options, found, progress);
  if (map && report) *report = found;
  return map;
}

}  // namespace mesocell
