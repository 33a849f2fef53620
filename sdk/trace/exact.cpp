#include "sdk/trace/exact.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "sdk/trace/cell_scene.h"
#include "sdk/trace/packets.h"
#include "sdk/trace/walk.h"

namespace mesocell {
namespace {

class CellObjectCaster final : public ExactCaster {
 public:
  explicit CellObjectCaster(const CellObject& object)
      : scene_(object), packets_(packets_supported() && scene_.packets(packet_scene_)) {}

  bool first_hit(const Ray& ray, Hit& hit) const override {
    std::uint64_t steps = 0;
    return walk(ray, hit, steps);
  }

  void first_hits(std::span<const Ray> rays, std::span<StreamHit> hits) const override {
    assert(rays.size() == hits.size());
    if (!packets_) return Caster::first_hits(rays, hits);
    trace(rays, hits, nullptr);
  }

  void any_hits(std::span<const Ray> rays, std::span<const double> ends,
                std::span<std::uint8_t> found) const override {
    assert(rays.size() == ends.size() && rays.size() == found.size());
    if (!packets_) return Caster::any_hits(rays, ends, found);
    std::array<StreamHit, kPacketRays> hits;
    for (std::size_t first = 0; first < rays.size(); first += kPacketRays) {
      const std::size_t count = std::min(kPacketRays, rays.size() - first);
      trace(rays.subspan(first, count), std::span(hits).first(count), nullptr);
      for (std::size_t k = 0; k < count; ++k)
        found[first + k] = hits[k].hit() && hits[k].t <= ends[first + k];
    }
  }

  void all_hits(const Ray& ray,
                const std::function<bool(const Hit& in, const Hit& out)>& visit) const override {
    WalkRay walk;
    WalkPlace place;
    if (!WalkRay::make(scene_.to_voxels(ray), walk) || !enter_grid(walk, scene_.size(), place)) return;
    Hit in, out;
    std::uint64_t steps = 0;
    while (pass_empty(walk, place, steps)) {
      place.entry_axis = entry_axis(walk, place.voxel);
      scene_.set_hit(walk, place, in);
      pass_solid(walk, place, out);
      if (!visit(in, out) || !scene_.in_grid(place.voxel)) return;
    }
  }

  std::uint64_t count_steps(std::span<const Ray> rays) const override {
    std::uint64_t steps = 0;
    std::array<StreamHit, kPacketRays> hits;
    for (std::size_t first = 0; first < rays.size(); first += kPacketRays) {
      const std::span<const Ray> some = rays.subspan(first, std::min(kPacketRays, rays.size() - first));
      if (packets_) {
        trace(some, std::span(hits).first(some.size()), &steps);
        continue;
      }
      Hit hit;
      for (const Ray& ray : some) walk(ray, hit, steps);
    }
    return steps;
  }

  bool first_exit(const Ray& ray, Hit& hit) const override {
    WalkRay walk;
    WalkPlace place;
    if (!WalkRay::make(scene_.to_voxels(ray), walk) || !enter_grid(walk, scene_.size(), place)) return false;
    if (place.entry_axis >= 0 || !scene_.inside(place.voxel)) return false;
    pass_solid(walk, place, hit);
    return true;
  }

  double empty_way(std::span<const Ray> rays) const override {
    if (!packets_ || rays.empty()) return 0;
    const Ray first = scene_.to_voxels(rays[0]);
    std::size_t k = 0;
    for (std::size_t a = 1; a < 3; ++a)
      if (std::abs(first.direction[a]) > std::abs(first.direction[k])) k = a;
    Beam beam;
    beam.axis = unsigned(k);
    for (std::size_t a = 0; a < 3; ++a) {
      double least = std::numeric_limits<double>::infinity(), most = -least;
      for (const Ray& ray : rays) {
        if (ray.origin != rays[0].origin) return 0;
        const double slope = ray.direction[a] / std::abs(ray.direction[k]);
        least = std::min(least, slope);
        most = std::max(most, slope);
      }
      // Also where something is no number.
      if (!(least >= 0 || most <= 0) || !(least > -16 && most < 16) || !(std::abs(first.origin[a]) < 0x1p40))
        return 0;
      const bool rises = most > 0;
      beam.octant |= unsigned{rises} << a;
      beam.low[a] = beam.high[a] = rises ? first.origin[a] : packet_scene_.size[a] - first.origin[a];
      beam.slope_low[a] = std::min(std::abs(least), std::abs(most));
      beam.slope_high[a] = std::max(std::abs(least), std::abs(most));
    }
    return empty_until(packet_scene_, beam) * scene_.voxel_edge();
  }

  Hit details(const Ray&, const StreamHit& hit) const override { return scene_.details(hit); }
  bool inside(Vec3 point) const override { return scene_.inside_point(point); }
  Vec3 shading_normal(const Hit& hit) const override { return scene_.shading_normal(hit); }
  Vec3 color(const Hit& hit, Vec3 point) const override { return scene_.color(hit, point); }
  double detail() const override { return scene_.voxel_edge(); }
  Box3 object_box() const override { return scene_.object_box(); }
  std::uint64_t memory_bytes() const override { return scene_.memory_bytes(); }

 private:
  bool walk(const Ray& ray, Hit& hit, std::uint64_t& steps) const {
    WalkRay walk;
    WalkPlace place;
    if (!WalkRay::make(scene_.to_voxels(ray), walk) || !enter_grid(walk, scene_.size(), place)) return false;
    if (!pass_empty(walk, place, steps)) return false;
    place.entry_axis = entry_axis(walk, place.voxel);
    scene_.set_hit(walk, place, hit);
    return true;
  }

  /// From a voxel of the grid on to the first that is INSIDE; false if there is none.
  bool pass_empty(const WalkRay& walk, WalkPlace& place, std::uint64_t& steps) const {
    Voxel low{}, high{};
    for (++steps; scene_.empty_box(place.voxel, walk.octant, low, high); ++steps) {
      leave_box(walk, low, high, place);
      if (!scene_.in_grid(place.voxel)) return false;
    }
    return true;
  }

  /// From an INSIDE voxel on to the first that is not, in the grid or beyond; tells how the last is left.
  void pass_solid(const WalkRay& walk, WalkPlace& place, Hit& out) const {
    Voxel low{}, high{};
    do {
      scene_.solid_box(place.voxel, walk.octant, low, high);
      leave_box(walk, low, high, place);
    } while (scene_.in_grid(place.voxel) && scene_.inside(place.voxel));
    // By which face an edge is left must not depend on the boxes: that of the voxel alone tells.
    const Voxel last = voxel_before(walk, place);
    WalkPlace exit;
    leave_box(walk, last, {last[0] + 1, last[1] + 1, last[2] + 1}, exit);
    exit.voxel = last;
    scene_.set_hit(walk, exit, out);
    out.face_normal = -out.face_normal;
  }

  void trace(std::span<const Ray> rays, std::span<StreamHit> hits, std::uint64_t* steps) const {
    for (std::size_t first = 0; first < rays.size(); first += kPacketRays) {
      const std::span<const Ray> some = rays.subspan(first, std::min(kPacketRays, rays.size() - first));
      std::uint64_t undecided = trace_packets(packet_scene_, some, hits.data() + first, steps);
      for (; undecided != 0; undecided &= undecided - 1) {
        const std::size_t k = std::size_t(std::countr_zero(undecided));
        Hit hit;
        hits[first + k] = first_hit(some[k], hit) ? to_stream_hit(hit) : StreamHit{};
      }
    }
  }

  CellScene scene_;
  PacketScene packet_scene_;
  bool packets_;
};

}  // namespace

std::unique_ptr<ExactCaster> ExactCaster::make(const CellObject& object) {
  return std::make_unique<CellObjectCaster>(object);
}

std::unique_ptr<Caster> make_exact_caster(const CellObject& object) { return ExactCaster::make(object); }

}  // namespace mesocell
