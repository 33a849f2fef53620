#include "converters/stability/measure.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "sdk/core/parallel.h"
#include "sdk/membership/diagnose.h"

namespace mesocell {
namespace {

constexpr double kNear = 2;        ///< voxels
constexpr double kMaxExtent = 12;  ///< voxels; larger triangles are cut, lest their boxes be mostly empty

/// Squared distance from a triangle. [Ericson 2005, 5.1.5]
double squared_distance(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const auto squared = [&](Vec3 q) { return dot(p - q, p - q); };
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return squared(a);
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return squared(b);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return squared(d1 > d3 ? a + ab * (d1 / (d1 - d3)) : a);
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return squared(c);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return squared(d2 > d6 ? a + ac * (d2 / (d2 - d6)) : a);
  const double va = d3 * d6 - d5 * d4, u = d4 - d3, w = d5 - d6;
  if (va <= 0 && u >= 0 && w >= 0) return squared(u + w > 0 ? b + (c - b) * (u / (u + w)) : b);
  const double sum = va + vb + vc;
  return squared(a + ab * (vb / sum) + ac * (vc / sum));
}

/// Marks voxels near a triangle within the slices [z_begin, z_end).
void mark_near(BitGrid& near, Vec3 a, Vec3 b, Vec3 c, std::uint32_t z_begin, std::uint32_t z_end) {
  Box3 box;
  for (const Vec3& p : {a, b, c}) box.add(p);
  if (box.max.z + kNear < z_begin || box.min.z - kNear > z_end) return;
  const Vec3 extent = box.extent();
  if (std::max({extent.x, extent.y, extent.z}) > kMaxExtent) {
    const Vec3 ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
    mark_near(near, a, ab, ca, z_begin, z_end);
    mark_near(near, ab, b, bc, z_begin, z_end);
    mark_near(near, ca, bc, c, z_begin, z_end);
    mark_near(near, ab, bc, ca, z_begin, z_end);
    return;
  }
  const auto first = [&](double low, double from) {
    return std::uint32_t(std::max(std::ceil(low - kNear - 0.5), from));
  };
  const auto end = [&](double high, double to) {
    return std::uint32_t(std::clamp(std::floor(high + kNear - 0.5) + 1, 0.0, to));
  };
  const Index3& size = near.size();
  for (std::uint32_t z = first(box.min.z, z_begin); z < end(box.max.z, z_end); ++z)
    for (std::uint32_t y = first(box.min.y, 0); y < end(box.max.y, size[1]); ++y)
      for (std::uint32_t x = first(box.min.x, 0); x < end(box.max.x, size[0]); ++x)
        if (!near.get(x, y, z) && squared_distance({x + 0.5, y + 0.5, z + 0.5}, a, b, c) <= kNear * kNear)
          near.set(x, y, z);
}

void mark_near(BitGrid& near, const TriangleMesh& mesh, unsigned threads) {
  constexpr std::uint32_t kSlices = 16;
  const std::uint32_t depth = near.size()[2];
  parallel_for((depth + kSlices - 1) / kSlices, threads, [&](std::size_t slab, unsigned) {
    const std::uint32_t begin = std::uint32_t(slab) * kSlices, end = std::min(begin + kSlices, depth);
    for (const Triangle& t : mesh.triangles)
      mark_near(near, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], begin, end);
  });
}

/// The last of several runs, with the median of their times and the most memory. One that is not done is the
/// last.
Result<IsolatedRun> run_repeatedly(const Voxelizer& method, const TriangleMesh& mesh, BitGrid& found,
                                   const MeasureOptions& options, const Progress* progress) {
  std::vector<double> seconds, cpu_seconds;
  std::uint64_t memory_bytes = 0;
  for (;;) {
    Result<IsolatedRun> run =
        run_isolated(method, mesh, found, options.threads, options.max_seconds, progress);
    if (!run || run->outcome != RunOutcome::kDone) return run;
    seconds.push_back(run->seconds);
    cpu_seconds.push_back(run->cpu_seconds);
    memory_bytes = std::max(memory_bytes, run->memory_bytes);
    if (seconds.size() < options.repeat) continue;
    const auto median = [](std::vector<double>& values) {
      std::ranges::sort(values);
      return values[values.size() / 2];
    };
    run->seconds = median(seconds);
    run->cpu_seconds = median(cpu_seconds);
    run->memory_bytes = memory_bytes;
    return run;
  }
}

}  // namespace

WrongVoxels& WrongVoxels::operator+=(const WrongVoxels& other) {
  wrong += other.wrong;
  wrong_far += other.wrong_far;
  inside += other.inside;
  far += other.far;
  voxels += other.voxels;
  return *this;
}

Result<Truth> find_truth(const TriangleMesh& sound, const Index3& size, unsigned threads) {
  if (const MeshDiagnosis diagnosis = diagnose(sound); !diagnosis.closed())
    return Error{ErrorCode::kInvalidInput,
                 "what is truly inside is not known: " + describe(diagnosis) + "; give a closed mesh",
                 "mesh-not-closed"};
  Result<BitGrid> inside = BitGrid::create(size), near = BitGrid::create(size);
  if (!inside) return inside.error();
  if (!near) return near.error();
  // On a closed mesh ours is the definition.
  if (Status status = voxelize_ours(sound, *inside, threads); !status) return status.error();
  mark_near(*near, sound, threads);
  return Truth{std::move(inside).value(), std::move(near).value()};
}

WrongVoxels compare_with_truth(const BitGrid& found, const Truth& truth) {
  assert(found.size() == truth.inside.size());
  WrongVoxels out;
  const auto a = found.words(), b = truth.inside.words(), near = truth.near.words();
  std::uint64_t marked = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const std::uint64_t wrong = a[k] ^ b[k];
    out.wrong += std::uint64_t(std::popcount(wrong));
    out.wrong_far += std::uint64_t(std::popcount(wrong & ~near[k]));
    out.inside += std::uint64_t(std::popcount(b[k]));
    marked += std::uint64_t(std::popcount(near[k]));
  }
  out.voxels = found.voxels();
  out.far = out.voxels - marked;
  return out;
}

Result<std::vector<StabilityResult>> measure_stability(std::span<const StabilityCase> cases,
                                                       std::span<const Voxelizer* const> methods,
                                                       const MeasureOptions& options,
                                                       const Progress* progress) {
  std::vector<StabilityResult> results;
  const std::size_t all = cases.size() * methods.size();
  for (const StabilityCase& c : cases) {
    const Result<Truth> truth = find_truth(c.sound, c.size, options.threads);
    if (!truth) return truth.error();
    Result<BitGrid> found = BitGrid::create(c.size);
    if (!found) return found.error();
    for (const Voxelizer* method : methods) {
      const Result<IsolatedRun> run = run_repeatedly(*method, c.broken, *found, options, progress);
      if (!run) return run.error();
      if (run->outcome != RunOutcome::kDone) found->clear();
      WrongVoxels voxels = compare_with_truth(*found, *truth);
      if (run->outcome != RunOutcome::kDone) voxels.wrong = voxels.wrong_far = 0;
      results.push_back({c.group, c.name, c.strength, c.mesh, method->name, c.size, *run, voxels});
      if (progress && progress->report) progress->report("stability", double(results.size()) / double(all));
    }
  }
  return results;
}

}  // namespace mesocell
