#include "sdk/trace/lod.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "sdk/core/parallel.h"
#include "sdk/trace/exact.h"
#include "sdk/trace/packets.h"

namespace mesocell {

std::optional<CellObject> coarser(const CellObject& object, unsigned level) {
  const std::uint32_t factor = 1u << level;
  CellObject out = object;
  out.normals.reset();  // they are of the voxels that there were
  out.grid.voxel_edge *= factor;
  for (std::uint32_t& n : out.tile.resolution) {
    if (n % factor != 0 || n / factor < 4) return std::nullopt;
    n /= factor;
  }
  const TileMap& fine = object.tile;
  out.tile.voxel_ids.assign(out.tile.voxel_count() * out.tile.id_bytes, 0);
  parallel_for(out.tile.resolution[2], 0, [&](std::size_t z, unsigned) {
    std::vector<std::uint32_t> ids(std::size_t{factor} * factor * factor);
    for (std::uint32_t y = 0; y < out.tile.resolution[1]; ++y)
      for (std::uint32_t x = 0; x < out.tile.resolution[0]; ++x) {
        std::size_t n = 0;
        for (std::uint32_t k = 0; k < factor; ++k)
          for (std::uint32_t j = 0; j < factor; ++j)
            for (std::uint32_t i = 0; i < factor; ++i)
              ids[n++] =
                  fine.id(fine.voxel_index(x * factor + i, y * factor + j, std::uint32_t(z) * factor + k));
        std::sort(ids.begin(), ids.end());
        std::uint32_t best = 0;
        std::size_t most = 0;
        for (std::size_t begin = 0, end = 0; begin < n; begin = end) {
          while (end < n && ids[end] == ids[begin]) ++end;
          if (end - begin <= most) continue;
          most = end - begin;
          best = ids[begin];
        }
        std::uint8_t* const to =
            out.tile.voxel_ids.data() + out.tile.voxel_index(x, y, std::uint32_t(z)) * out.tile.id_bytes;
        for (std::uint32_t b = 0; b < out.tile.id_bytes; ++b) to[b] = std::uint8_t(best >> (8 * b));
      }
  });
  return out;
}

namespace {

/// Distance from a point to a box, 0 in it.
double distance_to(const Box3& box, Vec3 p) {
  return length(max(max(box.min - p, p - box.max), Vec3{0, 0, 0}));
}

class LodCaster final : public Caster {
 public:
  LodCaster(const CellObject& object, double pixels) : pixels_(pixels) {
    levels_.push_back(ExactCaster::make(object));
    for (unsigned level = 1; level < 8; ++level) {
      const std::optional<CellObject> next = coarser(object, level);
      if (!next) break;
      levels_.push_back(ExactCaster::make(*next));
    }
  }

  bool first_hit(const Ray& ray, Hit& hit) const override {
    const std::size_t level = level_at(distance_to(object_box(), ray.origin), kLodPixel);
    if (!levels_[level]->first_hit(ray, hit)) return false;
    hit.level = std::uint8_t(level);
    return true;
  }

  void first_hits(std::span<const Ray> rays, std::span<StreamHit> hits) const override {
    assert(rays.size() == hits.size());
    each_block(rays, [&](std::size_t first, std::span<const Ray> some, std::size_t level) {
      levels_[level]->first_hits(some, hits.subspan(first, some.size()));
      for (StreamHit& hit : hits.subspan(first, some.size())) hit.level = std::uint8_t(level);
    });
  }

  std::uint64_t count_steps(std::span<const Ray> rays) const override {
    std::uint64_t steps = 0;
    each_block(rays, [&](std::size_t, std::span<const Ray> some, std::size_t level) {
      steps += levels_[level]->count_steps(some);
    });
    return steps;
  }

  Hit details(const Ray& ray, const StreamHit& hit) const override {
    Hit out = levels_[hit.level]->details(ray, hit);
    out.level = hit.level;
    return out;
  }

  bool first_exit(const Ray& ray, Hit& hit) const override { return levels_[0]->first_exit(ray, hit); }
  bool inside(Vec3 point) const override { return levels_[0]->inside(point); }
  Vec3 shading_normal(const Hit& hit) const override { return levels_[hit.level]->shading_normal(hit); }
  Vec3 color(const Hit& hit, Vec3 point) const override { return levels_[hit.level]->color(hit, point); }
  double detail() const override { return levels_[0]->detail(); }
  Box3 object_box() const override { return levels_[0]->object_box(); }
  std::uint64_t memory_bytes() const override {
    std::uint64_t bytes = 0;
    for (const std::unique_ptr<ExactCaster>& level : levels_) bytes += level->memory_bytes();
    return bytes;
  }

 private:
  /// The coarsest level whose voxels are at most pixels_ large at a distance, metres.
  [[nodiscard]] std::size_t level_at(double distance, double pixel) const {
    const double wanted = distance * pixel * pixels_ / detail();
    std::size_t level = 0;
    while (level + 1 < levels_.size() && std::ldexp(1.0, int(level) + 1) <= wanted) ++level;
    return level;
  }

  template <class Visit>
  void each_block(std::span<const Ray> rays, const Visit& visit) const {
    for (std::size_t first = 0; first < rays.size(); first += kPacketRays) {
      const std::span<const Ray> some = rays.subspan(first, std::min(kPacketRays, rays.size() - first));
      visit(first, some, level_of(some));
    }
  }

  /// The level of rays that are traced together.
  [[nodiscard]] std::size_t level_of(std::span<const Ray> rays) const {
    const bool square =
        rays.size() == kPacketRays &&
        std::all_of(rays.begin(), rays.end(), [&](const Ray& r) { return r.origin == rays[0].origin; });
    double distance = std::numeric_limits<double>::infinity();
    if (!square) {
      for (const Ray& ray : rays) distance = std::min(distance, distance_to(object_box(), ray.origin));
      return level_at(distance, kLodPixel);
    }
    double pixel = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : {std::pair{0, 1}, {0, 8}, {62, 63}, {55, 63}})
      pixel = std::min(pixel, length(normalize(rays[std::size_t(a)].direction) -
                                     normalize(rays[std::size_t(b)].direction)));
    return level_at(std::max(distance_to(object_box(), rays[0].origin), levels_[0]->empty_way(rays)), pixel);
  }

  std::vector<std::unique_ptr<ExactCaster>> levels_;
  double pixels_;
};

}  // namespace

std::unique_ptr<Caster> make_lod_caster(const CellObject& object, double pixels) {
  assert(pixels > 0);
  return std::make_unique<LodCaster>(object, pixels);
}

}  // namespace mesocell
