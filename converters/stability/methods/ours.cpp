// What `mesocell convert` does with a mesh by default: a closed one is taken as it is, any other is oriented
// first, and what stays open is decided by its winding number.
#include <algorithm>

#include "converters/stability/voxelizer.h"
#include "sdk/author/repair.h"
#include "sdk/core/parallel.h"
#include "sdk/membership/solid_scan.h"
#ifdef MESOCELL_WRAP
#include "sdk/wrap/alpha_wrap.h"
#endif

namespace mesocell {
namespace {

void voxelize_repaired(const TriangleMesh& mesh, BitGrid& out, unsigned threads) {
  const Index3& size = out.size();
  const Index3 resolution{64, 16, 16};
  Index3 tiles;
  for (std::size_t a = 0; a < 3; ++a) tiles[a] = (size[a] + resolution[a] - 1) / resolution[a];
  const SolidScan scan(mesh, resolution, tiles, SolidRule::kNonzero, threads);
  struct Worker {
    Scanline::Scratch scratch;
    RowIntervals intervals;
  };
  std::vector<Worker> workers(resolve_threads(threads));
  parallel_for(std::size_t{tiles[1]} * tiles[2], unsigned(workers.size()), [&](std::size_t b, unsigned w) {
    Worker& worker = workers[w];
    const std::uint32_t ty = std::uint32_t(b % tiles[1]), tz = std::uint32_t(b / tiles[1]);
    scan.bundle(ty, tz, worker.scratch, worker.intervals);
    for (std::uint32_t r = 0; r < resolution[1] * resolution[2]; ++r) {
      const std::uint32_t y = ty * resolution[1] + r % resolution[1],
                          z = tz * resolution[2] + r / resolution[1];
      if (y >= size[1] || z >= size[2]) continue;
      for (const Interval& i : worker.intervals.row(r))
        if (i.begin < size[0]) out.set_run(y, z, i.begin, std::min(i.end, size[0]));
    }
  });
}

bool any_inside(const BitGrid& grid) {
  return std::ranges::any_of(grid.words(), [](std::uint64_t word) { return word != 0; });
}

}  // namespace

Status voxelize_ours(const TriangleMesh& mesh, BitGrid& out, unsigned threads) {
  RepairOptions options;
#ifdef MESOCELL_WRAP
  options.wrapper = alpha_wrap;
#endif
  Result<RepairedMesh> repaired = repair_mesh(mesh, options);
  if (!repaired) return repaired.error();
  voxelize_repaired(repaired->mesh ? *repaired->mesh : mesh, out, threads);
  if (repaired->report.rung != RepairRung::kWinding || !options.wrapper || any_inside(out)) return {};
  options.repair = Repair::kWrap;
  repaired = repair_mesh(mesh, options);
  if (!repaired) return repaired.error();
  voxelize_repaired(repaired->mesh ? *repaired->mesh : mesh, out, threads);
  return {};
}

}  // namespace mesocell
