#include "sdk/trace/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

namespace mesocell {
namespace {

constexpr double kNoEnd = std::numeric_limits<double>::infinity();
/// Moves along a ray that are smaller than this share of a detail are rounding.
constexpr double kRounding = 1e-6;

struct Placed {
  const Caster* caster;
  Transform to_scene, to_asset;
  Box3 box;  ///< of the asset, in the scene

  [[nodiscard]] Ray ray(const Ray& r) const {
    return {to_asset.point(r.origin), to_asset.direction(r.direction)};
  }
  [[nodiscard]] Vec3 normal(Vec3 n) const { return normalize(to_asset.transposed(n)); }
};

/// t at which a ray enters a box, infinite if it does not.
double entry(const Ray& ray, const Box3& box) {
  double begin = 0, end = kNoEnd;
  for (std::size_t a = 0; a < 3; ++a) {
    if (ray.direction[a] == 0) {
      if (!(ray.origin[a] >= box.min[a] && ray.origin[a] <= box.max[a])) return kNoEnd;
      continue;
    }
    const double s = (box.min[a] - ray.origin[a]) / ray.direction[a];
    const double t = (box.max[a] - ray.origin[a]) / ray.direction[a];
    begin = std::max(begin, std::min(s, t));
    end = std::min(end, std::max(s, t));
  }
  return begin <= end ? begin : kNoEnd;
}

/// The box of a transformed box, enlarged by what rounding may take from it.
Box3 transformed(const Box3& box, const Transform& transform) {
  Box3 out;
  for (unsigned corner = 0; corner < 8; ++corner)
    out.add(transform.point({corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                             corner & 4 ? box.max.z : box.min.z}));
  for (std::size_t a = 0; a < 3; ++a) {
    const double pad = 1e-12 * (std::abs(out.min[a]) + std::abs(out.max[a]) + length(out.extent()));
    out.min[a] -= pad;
    out.max[a] += pad;
  }
  return out;
}

class SceneCaster final : public Caster {
 public:
  explicit SceneCaster(std::vector<Placed> placed) : placed_(std::move(placed)) {
    for (const Placed& p : placed_) {
      // The inverse's norm bounds how much the map can shrink a length.
      const auto& m = p.to_asset.rows;
      const double norm = std::sqrt(dot(m[0], m[0]) + dot(m[1], m[1]) + dot(m[2], m[2]));
      detail_ = std::min(detail_, p.caster->detail() / norm);
      box_.add(p.box.min);
      box_.add(p.box.max);
    }
  }

  [[nodiscard]] bool first_hit(const Ray& ray, Hit& hit) const override {
    double nearest = kNoEnd;
    for (std::size_t k = 0; k < placed_.size(); ++k) {
      Hit found;
      if (!(entry(ray, placed_[k].box) < nearest) ||
          !placed_[k].caster->first_hit(placed_[k].ray(ray), found) || !(found.t < nearest))
        continue;
      nearest = found.t;
      hit = in_scene(found, k);
    }
    return nearest < kNoEnd;
  }

  /// Leaves one asset after the other until a point right behind is inside none. So assets that touch are one
  /// solid, and gaps as thin as rounding are not seen.
  [[nodiscard]] bool first_exit(const Ray& ray, Hit& hit) const override {
    const double least = kRounding * detail_ / length(ray.direction);
    double from = 0;
    for (bool any = false;; any = true) {
      const Ray rest{ray.origin + ray.direction * from, ray.direction};
      double farthest = -1;
      for (std::size_t k = 0; k < placed_.size(); ++k) {
        Hit found;
        const Ray own = placed_[k].ray(rest);
        if (!placed_[k].caster->first_exit(own, found) || !(found.t > farthest)) continue;
        farthest = found.t;
        hit = in_scene(found, k);
        hit.t += from;
      }
      if (farthest < 0) return any;
      from = hit.t + least;
      if (!(from > hit.t)) return true;  // too far away for a step to count
    }
  }

  [[nodiscard]] bool inside(Vec3 point) const override {
    return std::any_of(placed_.begin(), placed_.end(),
                       [&](const Placed& p) { return p.caster->inside(p.to_asset.point(point)); });
  }

  [[nodiscard]] Vec3 shading_normal(const Hit& hit) const override {
    const Placed& p = placed_[hit.placement];
    Hit own = hit;
    own.face_normal = normalize(p.to_scene.transposed(hit.face_normal));
    return p.normal(p.caster->shading_normal(own));
  }

  [[nodiscard]] Vec3 color(const Hit& hit, Vec3 point) const override {
    const Placed& p = placed_[hit.placement];
    return p.caster->color(hit, p.to_asset.point(point));
  }

  [[nodiscard]] double detail() const override { return detail_; }
  [[nodiscard]] Box3 object_box() const override { return box_; }
  [[nodiscard]] std::uint64_t memory_bytes() const override {
    std::set<const Caster*> shared;
    for (const Placed& p : placed_) shared.insert(p.caster);
    std::uint64_t bytes = placed_.capacity() * sizeof(Placed);
    for (const Caster* c : shared) bytes += c->memory_bytes();
    return bytes;
  }

 private:
  [[nodiscard]] Hit in_scene(Hit hit, std::size_t placement) const {
    hit.placement = std::uint32_t(placement);
    hit.face_normal = placed_[placement].normal(hit.face_normal);
    return hit;
  }

  std::vector<Placed> placed_;
  double detail_ = kNoEnd;
  Box3 box_;
};

}  // namespace

Result<std::unique_ptr<Caster>> make_scene(std::vector<Placement> placements) {
  if (placements.empty()) return Error{ErrorCode::kUsage, "a scene needs at least one asset"};
  std::vector<Placed> placed;
  for (const Placement& p : placements) {
    const std::string name = "placement " + std::to_string(placed.size());
    if (!p.caster) return Error{ErrorCode::kUsage, name + " has no caster"};
    const std::optional<Transform> to_asset = p.to_scene.inverse();
    const Box3 box = transformed(p.caster->object_box(), p.to_scene);
    if (!to_asset || !is_finite(box.min) || !is_finite(box.max))
      return Error{ErrorCode::kUsage, "the transform of " + name + " cannot be inverted in double precision"};
    placed.push_back({p.caster, p.to_scene, *to_asset, box});
  }
  return std::unique_ptr<Caster>(std::make_unique<SceneCaster>(std::move(placed)));
}

}  // namespace mesocell
