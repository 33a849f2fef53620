#include "sdk/membership/open_solid.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sdk/core/parallel.h"
#include "sdk/membership/cap.h"

namespace mesocell {
namespace {

/// Where c is farther than this from the nearest whole number, the other side is nearly as likely.
constexpr double kSure = 0.4;
/// Blocks of this many voxels along an edge are shared out to threads.
constexpr std::uint32_t kTask = 128;
/// Parts of the caps that are this wrong suffice for a whole block.
constexpr double kBlockTolerance = 3e-3;

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
    : closed_{mesh.vertices, mesh.triangles, {}},
      size_(size),
      mesh_triangles_(mesh.triangles.size()),
      caps_({}),
      gradient_({}) {
  const std::vector<Cap> caps = cap_boundary(mesh.vertices, chain);
  const std::vector<CapGradient::Cap> placed = places(mesh.vertices, caps);
  std::vector<std::array<Vec3, 3>> triangles;
  for (std::size_t c = 0; c < caps.size(); ++c) {
    closed_.triangles.insert(closed_.triangles.end(), caps[c].triangles.begin(), caps[c].triangles.end());
    triangles.insert(triangles.end(), placed[c].triangles.begin(), placed[c].triangles.end());
  }
  caps_ = WindingField(triangles);
  gradient_ = CapGradient(placed);

  const std::uint32_t edge = std::bit_ceil(std::max({size[0], size[1], size[2], kTask}));
  std::vector<Block> tasks;
  find_blocks({0, 0, 0}, edge, kTask, tasks);
  std::vector<std::vector<Block>> found(tasks.size());
  const bool done = parallel_for(
      tasks.size(), threads,
      [&](std::size_t k, unsigned) {
        if (tasks[k].what.evaluate)
          find_blocks(tasks[k].low, tasks[k].edge, kBlock, found[k]);
        else
          found[k] = {tasks[k]};
      },
      progress, "close");
  if (done) lay_out(found);
}

void OpenSolid::find_blocks(const std::array<std::uint32_t, 3>& low, std::uint32_t edge,
                            std::uint32_t coarsest, std::vector<Block>& out) const {
  Box3 box;  // of the voxels' centres
  for (std::size_t a = 0; a < 3; ++a) {
    if (low[a] >= size_[a]) return;
    box.min[a] = low[a] + 0.5;
    box.max[a] = std::min(low[a] + edge, size_[a]) - 0.5;
  }
  if (caps_.bound(box, kSure) < kSure) return;
  const double gradient = gradient_.bound(box);
  const std::uint32_t end = std::min(low[0] + edge, size_[0]);
  const double reach = gradient * length(box.extent()) / 2;
  if (reach < 0.5 && caps_.clear_of(box)) {
    const WindingField::Value at = caps_.approximate((box.min + box.max) / 2, kBlockTolerance);
    const double whole = std::nearbyint(at.winding), off = at.winding - whole;
    if (std::abs(off) + at.error + reach < 0.5 && std::abs(whole) < 0x7fff) {
      const std::int8_t unsure = std::abs(off) <= kSure ? 0 : off > 0 ? 1 : -1;
      if (whole != 0 || unsure != 0)
        out.push_back({low, edge, {low[0], end, std::int16_t(whole), unsure, false, 0}});
      return;
    }
  }
  if (edge == coarsest) {
    out.push_back({low, edge, {low[0], end, 0, 0, true, float(gradient * 1.0001)}});
    return;
  }
  const std::uint32_t half = edge / 2;
  for (std::uint32_t child = 0; child < 8; ++child)
    find_blocks(
        {low[0] + (child & 1 ? half : 0), low[1] + (child & 2 ? half : 0), low[2] + (child & 4 ? half : 0)},
        half, coarsest, out);
}

void OpenSolid::lay_out(const std::vector<std::vector<Block>>& blocks) {
  const std::uint32_t rows_y = (size_[1] + kBlock - 1) / kBlock, rows_z = (size_[2] + kBlock - 1) / kBlock;
  const auto for_rows = [&](const Block& block, auto f) {
    const std::uint32_t y0 = block.low[1] / kBlock, z0 = block.low[2] / kBlock, n = block.edge / kBlock;
    for (std::uint32_t z = z0; z < std::min(z0 + n, rows_z); ++z)
      for (std::uint32_t y = y0; y < std::min(y0 + n, rows_y); ++y) f(y + std::size_t{rows_y} * z);
  };
  first_.assign(std::size_t{rows_y} * rows_z + 1, 0);
  for (const std::vector<Block>& task : blocks)
    for (const Block& block : task) for_rows(block, [&](std::size_t r) { ++first_[r + 1]; });
  for (std::size_t r = 1; r < first_.size(); ++r) first_[r] += first_[r - 1];
  stretches_.resize(first_.back());
  std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
  for (const std::vector<Block>& task : blocks)
    for (const Block& block : task)
      for_rows(block, [&](std::size_t r) { stretches_[next[r]++] = block.what; });
  for (std::size_t r = 0; r + 1 < first_.size(); ++r)
    std::sort(stretches_.begin() + std::ptrdiff_t(first_[r]),
              stretches_.begin() + std::ptrdiff_t(first_[r + 1]),
              [](const Stretch& a, const Stretch& b) { return a.begin < b.begin; });
}

std::span<const OpenSolid::Stretch> OpenSolid::stretches(std::uint32_t y, std::uint32_t z) const {
  if (first_.empty()) return {};
  const std::size_t r = y / kBlock + std::size_t{(size_[1] + kBlock - 1) / kBlock} * (z / kBlock);
  return {stretches_.data() + first_[r], stretches_.data() + first_[r + 1]};
}

}  // namespace mesocell
