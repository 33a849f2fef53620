#include "sdk/trace/caster.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace mesocell {

StreamHit to_stream_hit(const Hit& hit) {
  StreamHit out;
  out.t = hit.t;
  out.label = hit.label;
  out.level = hit.level;
  for (std::size_t a = 0; a < 3; ++a) {
    out.element[a] = std::int32_t(hit.element[a]);
    if (hit.face_normal[a] == 0) continue;
    const bool axial = hit.face_normal[a] == 1 || hit.face_normal[a] == -1;
    out.face = axial ? std::int8_t(2 * a + (hit.face_normal[a] > 0)) : StreamHit::kOther;
  }
  return out;
}

void Caster::first_hits(std::span<const Ray> rays, std::span<StreamHit> hits) const {
  assert(rays.size() == hits.size());
  for (std::size_t k = 0; k < rays.size(); ++k) {
    Hit hit;
    hits[k] = first_hit(rays[k], hit) ? to_stream_hit(hit) : StreamHit{};
  }
}

Hit Caster::details(const Ray& ray, const StreamHit& hit) const {
  Hit found;
  const bool same = first_hit(ray, found);
  assert(same && hit.hit());
  (void)same;
  (void)hit;
  return found;
}

bool Caster::any_hit(const Ray& ray, double end) const {
  Hit hit;
  return first_hit(ray, hit) && hit.t <= end;
}

void Caster::any_hits(std::span<const Ray> rays, std::span<const double> ends,
                      std::span<std::uint8_t> found) const {
  assert(rays.size() == ends.size() && rays.size() == found.size());
  for (std::size_t k = 0; k < rays.size(); ++k) found[k] = any_hit(rays[k], ends[k]);
}

void Caster::all_hits(const Ray& ray, const std::function<bool(const Hit& in, const Hit& out)>& visit) const {
  const double largest =
      std::max({std::abs(ray.direction.x), std::abs(ray.direction.y), std::abs(ray.direction.z)});
  // The square of a direction may be beyond the numbers.
  const double speed = largest * length(ray.direction / largest);
  const auto from = [&](double t) { return Ray{ray.origin + ray.direction * t, ray.direction}; };
  const auto behind = [&](double t) { return t + std::max(0x1p-10 * detail() / speed, 0x1p-48 * t); };
  Hit in, out, next_in, next_out;
  bool any = false;
  for (double t = 0; first_hit(from(t), next_in);) {
    const bool begins = next_in.t == 0 && next_in.face_normal == Vec3{};
    next_in.t += t;
    const double within = begins ? t : behind(next_in.t);
    const bool leaves = first_exit(from(within), next_out);
    next_out.t += within;
    const double next = behind(leaves ? next_out.t : next_in.t);
    if (!(next > t)) break;
    t = next;
    if (!leaves) continue;
    if (!any || !begins) {
      if (any && !visit(in, out)) return;
      in = next_in;
    }
    out = next_out;
    any = true;
  }
  if (any) visit(in, out);
}

std::uint64_t Caster::count_steps(std::span<const Ray>) const { return 0; }

}  // namespace mesocell
