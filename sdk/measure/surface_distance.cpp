#include "sdk/measure/surface_distance.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <vector>

#include "sdk/core/closest_point.h"
#include "sdk/core/parallel.h"
#include "sdk/core/rng.h"
#include "sdk/trace/cell_object_caster.h"
#include "sdk/trace/nearest_cell.h"

namespace mesocell {
namespace {

/// Samples that one thread takes at a time, with random numbers of their own.
constexpr std::uint64_t kChunk = 1024;
/// Lines that may be tried for each sample.
constexpr std::uint64_t kLinesPerSample = 1000;
/// Coordinates, in the asset's smallest detail, below which distances keep their precision.
constexpr double kMaxCoordinate = 0x1p40;

struct Sums {
  double max = 0, sum = 0, squares = 0;
  std::uint64_t samples = 0;

  void add(double distance) {
    max = std::max(max, distance);
    sum += distance;
    squares += distance * distance;
    ++samples;
  }
  void add(const Sums& other) {
    max = std::max(max, other.max);
    sum += other.sum;
    squares += other.squares;
    samples += other.samples;
  }
  /// Distances were in `unit` metres.
  [[nodiscard]] DistanceFigures figures(double unit) const {
    const double n = double(samples);
    return {max * unit, sum / n * unit, std::sqrt(squares / n) * unit, samples};
  }
};

/// Calls `sample(count, rng, sums)` for chunks of samples, in parallel, and adds up in their order. Nothing
/// if cancelled.
template <class Sample>
std::optional<Sums> sum_samples(const SurfaceDistanceOptions& options, std::uint64_t stream,
                                const Progress* progress, std::string_view stage, Sample&& sample) {
  std::vector<Sums> parts(std::size_t((options.samples + kChunk - 1) / kChunk));
  const bool done = parallel_for(
      parts.size(), options.threads,
      [&](std::size_t k, unsigned) {
        Rng of_stream(Rng(options.seed).next() + stream);
        Rng rng(of_stream.next() + Rng(k).next());
        sample(std::min(kChunk, options.samples - k * kChunk), rng, parts[k]);
      },
      progress, stage);
  if (!done) return std::nullopt;
  Sums sums;
  for (const Sums& part : parts) sums.add(part);
  return sums;
}

/// Uniform in direction.
Vec3 random_direction(Rng& rng) {
  for (;;) {
    const Vec3 p{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    // What is cut off about the centre keeps its direction sharp.
    if (const double squared = dot(p, p); squared > 1e-6 && squared <= 1) return normalize(p);
  }
}

/// A line through a sphere, all being equally likely, from before it.
Ray random_line(Rng& rng, Vec3 centre, double radius) {
  const Vec3 d = random_direction(rng);
  const Vec3 aside = std::abs(d.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalize(cross(d, aside)), v = cross(d, u);
  for (;;) {
    const double x = rng.uniform(-1, 1), y = rng.uniform(-1, 1);
    if (x * x + y * y <= 1) return {centre + radius * (x * u + y * v - d), d};
  }
}

/// Points on a mesh, uniform by area.
class MeshSampler {
 public:
  explicit MeshSampler(const TriangleMesh& mesh) : mesh_(mesh) {
    double sum = 0;
    area_before_.reserve(mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
      const Vec3 a = mesh.vertices[t[0]];
      sum += length(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a));
      area_before_.push_back(sum);
    }
  }
  /// Twice the area.
  [[nodiscard]] double total() const { return area_before_.empty() ? 0 : area_before_.back(); }

  [[nodiscard]] Vec3 sample(Rng& rng) const {
    const auto above = std::upper_bound(area_before_.begin(), area_before_.end(), rng.uniform() * total());
    // Rounding may yield the total itself.
    const std::size_t t = std::min(std::size_t(above - area_before_.begin()), area_before_.size() - 1);
    double u = rng.uniform(), v = rng.uniform();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const auto& [i, j, k] = mesh_.triangles[t];
    const Vec3 a = mesh_.vertices[i];
    return a + (mesh_.vertices[j] - a) * u + (mesh_.vertices[k] - a) * v;
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<double> area_before_;
};

}  // namespace

Result<SurfaceDistance> measure_surface_distance(const Caster& exact,
                                                 const std::function<double(Vec3)>& distance,
                                                 const TriangleMesh& mesh,
                                                 const SurfaceDistanceOptions& options,
                                                 const Progress* progress) {
  assert(options.samples > 0);
  if (mesh.triangles.empty()) return Error{ErrorCode::kInvalidInput, "the mesh has no triangles"};
  // In units of the asset's detail and from its corner: whatever the object's size, squares neither overflow
  // nor vanish.
  const double unit = exact.detail();
  const Vec3 corner = exact.object_box().min;
  const auto to_metres = [&](Vec3 p) { return corner + p * unit; };
  TriangleMesh scaled;
  scaled.triangles = mesh.triangles;
  scaled.vertices.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices) scaled.vertices.push_back((v - corner) / unit);
  const Box3 box = bounding_box(scaled);
  for (std::size_t a = 0; a < 3; ++a)
    if (!(box.min[a] > -kMaxCoordinate && box.max[a] < kMaxCoordinate))
      return Error{ErrorCode::kInvalidInput,
                   "the mesh reaches more than 2^40 voxels beyond the asset; take the one it was made of"};
  const MeshSampler on_mesh(scaled);
  if (!(on_mesh.total() > 0)) return Error{ErrorCode::kInvalidInput, "the mesh has no area"};

  const ClosestPoint closest(scaled, options.threads);
  const Vec3 half = (exact.object_box().max - corner) / unit * 0.5;
  // A little room, so that no line begins in a voxel.
  const double radius = length(half) * 1.001;
  const auto sample_asset = [&](std::uint64_t count, Rng& rng, Sums& sums) {
    for (std::uint64_t line = 0; line < count * kLinesPerSample && sums.samples < count; ++line) {
      Ray ray = random_line(rng, half, radius);
      for (int end = 0; end < 2 && sums.samples < count; ++end) {
        Hit hit;
        if (exact.first_hit({to_metres(ray.origin), ray.direction}, hit))
          sums.add(closest.query(ray.origin + ray.direction * (hit.t / unit)).distance);
        ray = {ray.origin + ray.direction * (2 * radius), -ray.direction};
      }
    }
  };
  const auto sample_mesh = [&](std::uint64_t count, Rng& rng, Sums& sums) {
    for (std::uint64_t k = 0; k < count; ++k) sums.add(distance(to_metres(on_mesh.sample(rng))) / unit);
  };

  const auto of_asset = sum_samples(options, 0, progress, "asset to mesh", sample_asset);
  const auto of_mesh =
      of_asset ? sum_samples(options, 1, progress, "mesh to asset", sample_mesh) : std::nullopt;
  if (!of_mesh) return Error{ErrorCode::kCancelled, "interrupted"};
  if (of_asset->samples == 0)
    return Error{ErrorCode::kInvalidInput, "nothing of the asset was found by " +
                                               std::to_string(options.samples * kLinesPerSample) +
                                               " random lines, so it has no surface to measure"};
  SurfaceDistance result;
  result.asset_to_mesh = of_asset->figures(unit);
  result.mesh_to_asset = of_mesh->figures(unit);
  result.diagonal = length(box.extent()) * unit;
  result.seed = options.seed;
  return result;
}

Result<SurfaceDistance> measure_surface_distance(const CellObject& object, const TriangleMesh& mesh,
                                                 const SurfaceDistanceOptions& options,
                                                 const Progress* progress) {
  const Result<NearestCell> nearest = NearestCell::make(object, options.threads);
  if (!nearest) return nearest.error();
  const Result<std::unique_ptr<Caster>> exact = make_cell_object_caster(object, "exact");
  if (!exact) return exact.error();
  return measure_surface_distance(
      **exact, [&](Vec3 p) { return nearest->distance(p); }, mesh, options, progress);
}

}  // namespace mesocell
