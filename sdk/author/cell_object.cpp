#include "sdk/author/cell_object.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "sdk/membership/membership.h"

namespace mesocell {
namespace {

/// Beyond this the error bounds of voxelization would reach a voxel.
constexpr double kMaxVoxelCoordinate = 0x1p40;
/// Voxels along an axis; keeps every index in 32 bits.
constexpr double kMaxVoxels = 0x1p30;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

}  // namespace

Result<GridLayout> lay_grid(const Box3& mesh_box, const Index3& resolution, const GridOptions& options) {
  const auto usage = [](std::string text) { return Error{ErrorCode::kUsage, std::move(text)}; };
  const auto invalid = [](std::string text) { return Error{ErrorCode::kInvalidInput, std::move(text)}; };
  const Box3& box = options.box ? *options.box : mesh_box;
  if (options.box && (box.empty() || !is_finite(box.min) || !is_finite(box.max)))
    return usage("the box has no size; give its minimum corner, then its maximum corner");
  if (box.empty()) return invalid("the mesh has no triangles");
  const Vec3 extent = box.extent();
  std::size_t longest = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (extent[a] > extent[longest]) longest = a;
  const double side = extent[longest];
  if (!(side > 0))
    return invalid(
        "all vertices lie at one point, so there is no size to divide into tiles; check how the file was "
        "made");
  if (!std::isfinite(side) || !is_finite(box.min) || !is_finite(box.max))
    return invalid("its coordinates are too large for double precision; scale it down");

  GridLayout grid;
  if (options.tile_size) {
    if (!(*options.tile_size > 0) || !std::isfinite(*options.tile_size))
      return usage("the tile size is not a positive number of metres");
    grid.voxel_edge = *options.tile_size / resolution[longest];
  } else {
    if (options.tiles < 1) return usage("the number of tiles along the longest side is below 1");
    // A box that was given is covered exactly; a mesh gets a voxel of room on each side.
    const double voxels = double(options.tiles) * resolution[longest];
    grid.voxel_edge = side / (options.box ? voxels : voxels - 2);
  }
  double total = 1;
  std::array<double, 3> tiles{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double edge = grid.voxel_edge * resolution[a];
    // The longest axis has the number that was asked for, whatever rounding makes of the quotient.
    tiles[a] = !options.tile_size && a == longest ? double(options.tiles)
                                                  : std::max(1.0, std::ceil(extent[a] / edge * (1 - 1e-12)));
    total *= tiles[a];
    if (tiles[a] * resolution[a] > kMaxVoxels || total > double(options.max_tiles))
      return Error{ErrorCode::kLimit, "the grid would have more than " + std::to_string(options.max_tiles) +
                                          " tiles or 2^30 voxels along an axis; use fewer or larger tiles"};
  }
  Vec3 corner;
  for (std::size_t a = 0; a < 3; ++a) {
    grid.tiles[a] = std::uint32_t(tiles[a]);
    const double centre = box.min[a] + extent[a] / 2;
    grid.box_min[a] = centre - tiles[a] * resolution[a] * grid.voxel_edge / 2;
    corner[a] = grid.box_min[a] + tiles[a] * resolution[a] * grid.voxel_edge;
    const double largest = std::max(std::abs(grid.box_min[a]), std::abs(corner[a]));
    if (!(grid.voxel_edge > 4 * std::numeric_limits<double>::epsilon() * largest) ||
        grid.voxel_edge < std::numeric_limits<double>::min())
      return invalid("its voxels of " + number(grid.voxel_edge) + " m at coordinates of " + number(largest) +
                     " m are too small for double precision; move it to the origin or use fewer tiles");
  }
  if (!is_finite(corner)) return invalid("its coordinates are too large for double precision; scale it down");
  return grid;
}

namespace {

/// A grid, and what is inside of a mesh in it.
struct Voxelization {
  GridLayout grid;
  MembershipMap membership;
  MembershipReport report;
  bool has_cells = false;  ///< inside
};

Result<Voxelization> voxelize(const TriangleMesh& mesh, const TileMap& tile, const AuthorOptions& options,
                              const Progress* progress) {
  Voxelization out;
  const Box3 box = bounding_box(mesh);
  Result<GridLayout> grid = lay_grid(box, tile.resolution, options.grid);
  if (!grid) return grid.error();
  out.grid = *grid;
  const Vec3 extent = box.extent();
  if (!(extent.x > 0 && extent.y > 0 && extent.z > 0))
    return Error{ErrorCode::kInvalidInput, "the mesh is flat and encloses no volume; give it a thickness",
                 "mesh-flat"};

  TriangleMesh voxel_mesh;
  voxel_mesh.triangles = mesh.triangles;
  voxel_mesh.vertices.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices)
    voxel_mesh.vertices.push_back((v - to_vec3(grid->box_min)) / grid->voxel_edge);
  const Box3 voxel_box = bounding_box(voxel_mesh);
  for (std::size_t a = 0; a < 3; ++a)
    if (!(voxel_box.min[a] > -kMaxVoxelCoordinate && voxel_box.max[a] < kMaxVoxelCoordinate))
      return Error{
          ErrorCode::kInvalidInput,
          "the mesh reaches more than 2^40 voxels beyond the grid; use a larger box or larger tiles"};

  Result<MembershipMap> membership = compute_membership(
      voxel_mesh, grid->tiles, tile,
      {.rule = options.rule, .solid = options.solid, .threads = options.threads}, &out.report, progress);
  if (!membership) return membership.error();
  out.membership = std::move(*membership);
  out.has_cells = count_instances(out.membership).inside > 0;
  return out;
}

/// Repairs a mesh and finds what is inside, by the first rung that suffices if that is asked for.
Result<Voxelization> repair_and_voxelize(const TriangleMesh& given, const TileMap& tile,
                                         const AuthorOptions& options, AuthorReport& out,
                                         RepairedMesh& repaired, const Progress* progress) {
  const auto attempt = [&](Repair repair) -> Result<Voxelization> {
    RepairOptions repair_options = options.repair;
    repair_options.repair = repair;
    repair_options.threads = options.threads;
    Result<RepairedMesh> result = repair_mesh(given, repair_options, progress, &out.diagnosis);
    if (!result) return result.error();
    repaired = std::move(*result);
    // Pieces of a thickened mesh meet inside of it, where the rule would see surface.
    if (repaired.report.rung == RepairRung::kThicken && options.rule == MembershipRule::kConservative)
      return Error{ErrorCode::kUsage,
                   "a mesh that is given a thickness can be filled by the rule centre alone; use that"};
    return voxelize(repaired.mesh ? *repaired.mesh : given, tile, options, progress);
  };
  Result<Voxelization> found = attempt(options.repair.repair);
  // Nobody asked for this wrap, or for this winding number: without a cell it is no solid.
  const RepairRung rung = repaired.report.rung;
  const bool asked = rung == RepairRung::kWrap && options.repair.repair == Repair::kWrap;
  if (!found.ok() || found->has_cells || asked || (rung != RepairRung::kWinding && rung != RepairRung::kWrap))
    return found;
  if (rung == RepairRung::kWinding && options.repair.repair == Repair::kAuto && options.repair.wrapper) {
    Result<Voxelization> wrapped = attempt(Repair::kWrap);
    if (wrapped.ok() && wrapped->has_cells)
      repaired.warnings.push_back({"mesh-bounds-nothing",
                                   "no cell fits inside of what its winding number calls "
                                   "inside, so its wrap was taken"});
    if (wrapped.ok() ? wrapped->has_cells : wrapped.error().code == ErrorCode::kCancelled) return wrapped;
  }
  return Error{ErrorCode::kInvalidInput,
               "it is open, and no cell fits inside of what can be called its inside; give it a "
               "thickness (thicken), a wrap (repair wrap) or more tiles, or close it in a mesh editor",
               "mesh-bounds-nothing"};
}

Warning nothing_inside() {
  return {"no-inside-cells",
          "no cell fits inside the shape, so there is nothing to see; use more tiles, or a tile of more cells"};
}

}  // namespace

Result<CellObject> author_cell_object(const TriangleMesh& given, TileMap tile, const AuthorOptions& options,
                                      AuthorReport* report, const Progress* progress) {
  AuthorReport unused;
  AuthorReport& out = report ? *report : unused;
  out = {};
  const Clock::time_point start = Clock::now();
  RepairedMesh repaired;
  Result<Voxelization> found = repair_and_voxelize(given, tile, options, out, repaired, progress);
  if (!found) return found.error();
  out.voxelize_seconds = seconds_since(start);
  out.repair = repaired.report;
  out.warnings = std::move(repaired.warnings);
  out.repair.boundary_edges = found->report.boundary_edges;
  out.repair.unsure_voxels = found->report.unsure_voxels;

  CellObject object;
  object.grid = found->grid;
  object.tile = std::move(tile);
  object.membership = std::move(found->membership);
  // The volume of a thickened mesh is not that of its pieces, which overlap.
  const bool whole = out.repair.boundary_edges == 0 && out.repair.rung != RepairRung::kThicken;
  const double volume = whole ? signed_volume(repaired.mesh ? *repaired.mesh : given) : 0;
  out.mesh_volume = std::abs(volume);
  if (out.repair.boundary_edges > 0)
    out.warnings.push_back(
        {"mesh-open", "the mesh is open along " + std::to_string(out.repair.boundary_edges) +
                          " edges; what is inside was decided by its winding number, of " +
                          std::to_string(out.repair.unsure_voxels) + " voxels without certainty"});
  out.inside_volume = inside_volume(object);
  if (volume < 0)
    out.warnings.push_back({"mesh-inside-out", "the mesh is oriented inward; it was taken as a solid"});
  if (!found->has_cells) out.warnings.push_back(nothing_inside());
  return object;
}

Result<CellObject> author_cell_object(const SolidShape& shape, TileMap tile, const AuthorOptions& options,
                                      AuthorReport* report, const Progress* progress) {
  AuthorReport unused;
  AuthorReport& out = report ? *report : unused;
  out = {};
  const Clock::time_point start = Clock::now();
  const Box3 box = shape.box();
  if (box.empty())
    return Error{ErrorCode::kInvalidInput, "nothing is inside of it, so there is nothing to fill"};
  const Result<GridLayout> grid = lay_grid(box, tile.resolution, options.grid);
  if (!grid) return grid.error();
  Result<MembershipMap> membership = compute_membership(
      shape, *grid, tile, {.rule = options.rule, .threads = options.threads}, nullptr, progress);
  if (!membership) return membership.error();
  out.voxelize_seconds = seconds_since(start);

  CellObject object;
  object.grid = *grid;
  object.tile = std::move(tile);
  object.membership = std::move(*membership);
  out.inside_volume = inside_volume(object);
  if (count_instances(object.membership).inside == 0) out.warnings.push_back(nothing_inside());
  return object;
}

}  // namespace mesocell
