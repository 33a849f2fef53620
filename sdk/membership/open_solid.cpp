#include "sdk/membership/open_solid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

#include "sdk/core/parallel.h"
#include "sdk/membership/cap.h"

namespace mesocell {
namespace {

/// Where c is farther than this from the nearest whole number, the other side is nearly as likely.
constexpr double kSure = 0.4;
/// Blocks of this many voxels along an edge, or of a 64th of the grid, are shared out to threads.
constexpr std::uint32_t kLeastTask = 32;
/// Parts of the caps that are this wrong suffice at first; then ever less, until the nearest whole number is
/// certain.
constexpr double kFirstTolerance = 1e-3, kTolerances[] = {1e-4, 1e-6, 1e-8};
/// What a centre on the boundary or on an edge of a cap is moved by, as if it were by (ε, ε², ε³).
constexpr Vec3 kMove{0x1p-20, 0x1p-30, 0x1p-40};
/// Errors of shares beyond this are of a centre on an edge.
constexpr double kOnEdge = 0.1;
/// Keeps codes in 16 bits; a winding number beyond it takes as many windings about one hole.
constexpr double kMostWhole = 4095;

/// The caps by the places of their vertices.
std::vector<CapGradient::Cap> places(const std::vector<Vec3>& vertices, const std::vector<Cap>& caps) {
  std::vector<CapGradient::Cap> out(caps.size());
  for (std::size_t c = 0; c < caps.size(); ++c) {
    for (const Triangle& t : caps[c].triangles)
      out[c].triangles.push_back({vertices[t[0]], vertices[t[1]], vertices[t[2]]});
    const std::vector<std::uint32_t>& loop = caps[c].loop;
    for (std::size_t k = 0; k < loop.size(); ++k)
      out[c].loop.push_back({vertices[loop[k]], vertices[loop[(k + 1) % loop.size()]]});
  }
  return out;
}

}  // namespace

OpenSolid::OpenSolid(const TriangleMesh& mesh, const std::vector<std::array<std::uint32_t, 2>>& chain,
                     const Index3& size, unsigned threads, const Progress* progress)
    : closed_{mesh.vertices, mesh.triangles, {}}, size_(size), caps_({}), gradient_({}) {
  const std::vector<Cap> caps = cap_boundary(mesh.vertices, chain);
  const std::vector<CapGradient::Cap> placed = places(mesh.vertices, caps);
  std::vector<std::array<Vec3, 3>> triangles;
  for (std::size_t c = 0; c < caps.size(); ++c) {
    closed_.triangles.insert(closed_.triangles.end(), caps[c].triangles.begin(), caps[c].triangles.end());
    triangles.insert(triangles.end(), placed[c].triangles.begin(), placed[c].triangles.end());
  }
  caps_ = WindingField(triangles);
  gradient_ = CapGradient(placed);

  const std::uint32_t edge = std::bit_ceil(std::max({size[0], size[1], size[2], kLeastTask}));
  Found tasks;
  tasks.progress = progress;
  find_blocks({0, 0, 0}, edge, std::max(kLeastTask, edge / 64), tasks);
  std::vector<Found> found(tasks.blocks.size());
  const bool done = parallel_for(
      found.size(), threads,
      [&](std::size_t k, unsigned) {
        const Block& task = tasks.blocks[k];
        found[k].progress = progress;
        if (task.part.codes == kAlike)
          found[k].blocks = {task};
        else
          find_blocks(task.low, task.edge, kBlock, found[k]);
        found[k].local = {};
      },
      progress, "close");
  if (done) lay_out(found);
}

void OpenSolid::find_blocks(const std::array<std::uint32_t, 3>& low, std::uint32_t edge,
                            std::uint32_t coarsest, Found& out) const {
  if (out.progress && out.progress->cancelled()) return;
  Box3 box;  // of the voxels' centres
  for (std::size_t a = 0; a < 3; ++a) {
    if (low[a] >= size_[a]) return;
    box.min[a] = low[a] + 0.5;
    box.max[a] = std::min(low[a] + edge, size_[a]) - 0.5;
  }
  if (caps_.bound(box, kSure) < kSure) return;
  const std::uint32_t end = std::min(low[0] + edge, size_[0]);
  const double reach = gradient_.bound(box) * length(box.extent()) / 2;
  if (reach < 0.5 && caps_.clear_of(box)) {
    const WindingField::Value at = caps_.approximate((box.min + box.max) / 2, kFirstTolerance);
    const double whole = std::nearbyint(at.winding), off = at.winding - whole;
    if (std::abs(off) + at.error + reach < 0.5 && std::abs(whole) <= kMostWhole) {
      const std::int8_t unsure = std::abs(off) <= kSure ? 0 : off > 0 ? 1 : -1;
      if (whole != 0 || unsure != 0)
        out.blocks.push_back({low, edge, {{low[0], end, std::int16_t(whole), unsure}, kAlike}});
      return;
    }
  }
  if (edge == coarsest) {
    out.blocks.push_back({low, edge, {{low[0], end, 0, 0}, out.codes.size()}});
    if (edge == kBlock) evaluate_block(low, box, out);
    return;
  }
  const std::uint32_t half = edge / 2;
  for (std::uint32_t child = 0; child < 8; ++child)
    find_blocks(
        {low[0] + (child & 1 ? half : 0), low[1] + (child & 2 ? half : 0), low[2] + (child & 4 ? half : 0)},
        half, coarsest, out);
}

void OpenSolid::evaluate_block(const std::array<std::uint32_t, 3>& low, const Box3& box, Found& out) const {
  caps_.localize(box, kFirstTolerance, out.local);
  for (std::uint32_t z = low[2]; z < low[2] + kBlock; ++z)
    for (std::uint32_t y = low[1]; y < low[1] + kBlock; ++y)
      for (std::uint32_t x = low[0]; x < low[0] + kBlock; ++x)
        out.codes.push_back(x < size_[0] && y < size_[1] && z < size_[2]
                                ? evaluate(out.local, {x + 0.5, y + 0.5, z + 0.5})
                                : std::int16_t{1});
}

std::int16_t OpenSolid::evaluate(const WindingField::Local& local, Vec3 centre) const {
  double whole = 0, off = 0, error = 0;
  const auto round = [&](const WindingField::Value& caps) {
    whole = std::nearbyint(caps.winding);
    off = caps.winding - whole;
    error = caps.error;
    return std::abs(off) + error < 0.5;
  };
  if (!round(caps_.at(local, centre)) &&
      std::none_of(std::begin(kTolerances), std::end(kTolerances),
                   [&](double tolerance) { return round(caps_.approximate(centre, tolerance)); }) &&
      !round(caps_.sum(centre))) {
    if (error > kOnEdge) round(caps_.sum(centre + kMove));
    // Half-way, as far as can be told.
    if (std::abs(off) + error >= 0.5 && whole * off < 0) {
      whole -= whole > 0 ? 1 : -1;
      off = -off;
    }
  }
  whole = std::clamp(whole, -kMostWhole, kMostWhole);
  return std::int16_t(4 * whole + (std::abs(off) <= kSure ? 1 : off > 0 ? 2 : 0));
}

void OpenSolid::lay_out(std::vector<Found>& found) {
  const std::uint32_t rows_y = (size_[1] + kBlock - 1) / kBlock, rows_z = (size_[2] + kBlock - 1) / kBlock;
  const auto for_rows = [&](const Block& block, auto f) {
    const std::uint32_t y0 = block.low[1] / kBlock, z0 = block.low[2] / kBlock, n = block.edge / kBlock;
    for (std::uint32_t z = z0; z < std::min(z0 + n, rows_z); ++z)
      for (std::uint32_t y = y0; y < std::min(y0 + n, rows_y); ++y) f(y + std::size_t{rows_y} * z);
  };
  first_.assign(std::size_t{rows_y} * rows_z + 1, 0);
  std::size_t codes = 0;
  for (const Found& task : found) {
    codes += task.codes.size();
    for (const Block& block : task.blocks) for_rows(block, [&](std::size_t r) { ++first_[r + 1]; });
  }
  for (std::size_t r = 1; r < first_.size(); ++r) first_[r] += first_[r - 1];
  parts_.resize(first_.back());
  codes_.reserve(codes);
  std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
  for (Found& task : found) {
    for (const Block& block : task.blocks) {
      Part part = block.part;
      if (part.codes != kAlike) part.codes += codes_.size();
      for_rows(block, [&](std::size_t r) { parts_[next[r]++] = part; });
    }
    codes_.insert(codes_.end(), task.codes.begin(), task.codes.end());
    task = {};
  }
  for (std::size_t r = 0; r + 1 < first_.size(); ++r)
    std::sort(parts_.begin() + std::ptrdiff_t(first_[r]), parts_.begin() + std::ptrdiff_t(first_[r + 1]),
              [](const Part& a, const Part& b) { return a.what.begin < b.what.begin; });
}

}  // namespace mesocell
