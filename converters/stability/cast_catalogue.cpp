#include "converters/stability/cast_catalogue.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "converters/stability/cast_boxes.h"
#include "sdk/core/rng.h"

namespace mesocell {
namespace {

/// The source's finest tiles have so many voxels an edge: a step of 1/512 is half a voxel, one of 1/128 two.
constexpr std::uint32_t kTile = 256;

Vec3 unit_vector(Rng& rng) {
  for (;;) {
    const Vec3 v{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    if (const double l = length(v); l > 0.1 && l <= 1) return v / l;
  }
}

/// Odd multiples of 1/128: never on a plane between voxels, and exact in doubles.
double off_planes(Rng& rng, double low, double high) {
  return (std::floor(rng.uniform(low, high) * 64) + 0.5) / 64;
}

bool always(std::uint32_t, std::uint32_t, std::uint32_t) { return true; }

class Cases {
 public:
  explicit Cases(std::uint32_t rays) : rays_(rays) {}

  std::vector<CastCase> make() {
    walls();
    needles();
    checkerboards();
    gaps();
    sweep();
    far();
    along();
    critical_angle();
    mirrors();
    return std::move(cases_);
  }

 private:
  CastCase& add(const char* group, const char* name, std::string strength, const BoxObject& boxes,
                CastPrediction prediction = CastPrediction::kNone) {
    CastCase c;
    c.group = group;
    c.name = name;
    c.strength = std::move(strength);
    c.prediction = prediction;
    c.object = boxes.object;
    cases_.push_back(std::move(c));
    return cases_.back();
  }

  /// Asks for the first hits of rays that `make_ray` makes, in voxels.
  template <typename MakeRay>
  void ask(CastCase& c, const BoxObject& boxes, MakeRay make_ray, std::uint32_t rays) {
    Rng rng(cases_.size());
    for (std::uint32_t k = 0; k < rays; ++k) {
      const Ray ray = make_ray(rng);
      const auto hit = first_box(boxes.boxes, ray);
      c.probes.push_back({ray, hit.has_value(), hit ? hit->t : 0, hit ? hit->cell : 0, {}});
    }
  }

  /// A ray from well outside to a point of a box, up to `margin` voxels off it.
  static Ray ray_at(Rng& rng, const CellBox& box, double margin, Vec3 direction) {
    Vec3 target;
    for (std::size_t a = 0; a < 3; ++a)
      target[a] = off_planes(rng, box.low[a] - margin, box.high[a] + margin);
    return {target - direction * 700, direction};
  }

  void walls() {
    for (const int thickness : {1, 2, 4}) {
      const CellBox wall{{100, 0, 0}, {100 + thickness, 16, 16}, 1};
      const BoxObject boxes = make_box_object({kTile, 16, 16}, std::array{wall}, {3, 2, 2},
                                              [](auto x, auto, auto) { return x == 1; });
      CastCase& c = add("thin", "wall", voxels(thickness), boxes, CastPrediction::kThin);
      // Up to 63° from the wall's normal.
      const auto make_ray = [&](Rng& rng) {
        const CellBox all{{356, 0, 0}, {356 + thickness, 32, 32}, 1};
        const Vec3 d{rng.below(2) ? 1.0 : -1.0, rng.uniform(-1.4, 1.4), rng.uniform(-1.4, 1.4)};
        return ray_at(rng, all, 4, normalize(d));
      };
      ask(c, boxes, make_ray, rays_);
    }
  }

  void needles() {
    for (const int thickness : {1, 2, 4}) {
      const CellBox needle{{8, 8, 0}, {8 + thickness, 8 + thickness, std::int32_t(kTile)}, 1};
      const BoxObject boxes = make_box_object({16, 16, kTile}, std::array{needle}, {2, 2, 2}, always);
      CastCase& c = add("thin", "needle", voxels(thickness), boxes, CastPrediction::kThin);
      const auto make_ray = [&](Rng& rng) {
        return ray_at(rng, boxes.boxes[rng.below(std::uint32_t(boxes.boxes.size()))], 0.5, unit_vector(rng));
      };
      ask(c, boxes, make_ray, rays_);
    }
  }

  /// Cells of `edge`³ voxels and as much empty space in turn, along all axes.
  static BoxObject checkerboard(const Index3& resolution, int edge, const Index3& tiles) {
    std::vector<CellBox> cells;
    const std::array<int, 3> n{int(resolution[0]), int(resolution[1]), int(resolution[2])};
    for (int z = 0; z < n[2]; z += edge)
      for (int y = 0; y < n[1]; y += edge)
        for (int x = 0; x < n[0]; x += edge)
          if ((x + y + z) / edge % 2 == 0)
            cells.push_back({{x, y, z}, {x + edge, y + edge, z + edge}, std::uint32_t(cells.size() + 1)});
    return make_box_object(resolution, cells, tiles, always);
  }

  void checkerboards() {
    for (const int edge : {1, 2, 4}) {
      const BoxObject boxes = checkerboard({kTile, 8, 8}, edge, {1, 1, 1});
      CastCase& c = add("thin", "checkerboard", voxels(edge), boxes, CastPrediction::kThin);
      const CellBox all{{0, 0, 0}, {std::int32_t(kTile), 8, 8}, 1};
      const auto make_ray = [&](Rng& rng) { return ray_at(rng, all, 1, unit_vector(rng)); };
      ask(c, boxes, make_ray, edge == 1 ? std::max(1u, rays_ / 4) : rays_);
    }
  }

  void gaps() {
    for (const int width : {1, 2}) {
      const CellBox below{{0, 0, 0}, {std::int32_t(kTile), 16, 8}, 1},
          above{{0, 0, 8 + width}, {std::int32_t(kTile), 16, 16}, 2};
      const std::array cells{below, above};
      const BoxObject boxes = make_box_object({kTile, 16, 16}, cells, {2, 2, 1}, always);
      const CellBox gap{{0, 8, 8}, {std::int32_t(2 * kTile), 24, 8 + width}, 1};
      // Through the gap, or into one of its walls at up to a hundredth of a right angle.
      CastCase& through = add("gaps", "through a gap of", voxels(width), boxes, CastPrediction::kThin);
      const auto make_ray = [&](Rng& rng) {
        const double slope = rng.uniform(-1, 1) * std::ldexp(1.0, -6 - int(rng.below(16)));
        return ray_at(rng, gap, 0, normalize({rng.below(2) ? 1.0 : -1.0, rng.uniform(-0.01, 0.01), slope}));
      };
      ask(through, boxes, make_ray, rays_);

      CastCase& exit = add("gaps", "exit into a gap of", voxels(width), boxes, CastPrediction::kThin);
      exit.question = CastQuestion::kFirstExit;
      Rng rng(cases_.size());
      for (std::uint32_t k = 0; k < rays_; ++k) {
        const Vec3 o{off_planes(rng, 200, 300), off_planes(rng, 12, 20), off_planes(rng, 3, 7)};
        const Vec3 d = normalize({rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0.5, 1)});
        exit.probes.push_back({{o, d}, true, (8 - o.z) / d.z, 1, {}});
      }
    }
  }

  /// Slats of a voxel across the rays, one a tile, seen from above.
  void sweep() {
    // Sines of the angles.
    static constexpr std::array<std::pair<const char*, double>, 10> kAngles = {{
        {"0.01°", 1.7453292431333680e-4},
        {"0.03°", 5.2359875362127104e-4},
        {"0.1°", 1.7453283658983088e-3},
        {"0.3°", 5.2359638314195812e-3},
        {"1°", 1.7452406437283512e-2},
        {"3°", 5.2335956242943835e-2},
        {"10°", 0.17364817766693033},
        {"30°", 0.5},
        {"60°", 0.86602540378443860},
        {"90°", 1.0},
    }};
    const CellBox slat{{100, 0, 0}, {101, 8, 8}, 1};
    const BoxObject boxes = make_box_object({kTile, 8, 8}, std::array{slat}, {32, 1, 2},
                                            [](auto, auto, auto z) { return z == 0; });
    for (const auto& [text, sine] : kAngles) {
      CastCase& c = add("grazing", "slats at", text, boxes, CastPrediction::kGrazing);
      const double along = std::sqrt(1 - sine * sine);
      const auto make_ray = [&, s = sine](Rng& rng) {
        // Where it comes down to the slats: half of the rays on one or within 16 voxels before one.
        Vec3 entry{off_planes(rng, 8, 30 * 256), off_planes(rng, 2, 6), 8};
        if (rng.below(2)) entry.x = 256.0 * rng.below(30) + off_planes(rng, 84, 102);
        return Ray{entry - Vec3{along, 0, -s} * (0.5 / s), {along, 0, -s}};
      };
      ask(c, boxes, make_ray, rays_);
    }
  }

  void far() {
    const CellBox dot{{7, 7, 7}, {8, 8, 8}, 1}, block{{4, 4, 4}, {12, 12, 12}, 1};
    const BoxObject one = make_box_object({16, 16, 16}, std::array{dot}, {1, 1, 1}, always),
                    big = make_box_object({16, 16, 16}, std::array{block}, {1, 1, 1}, always);
    for (const auto& [text, tiles] : {std::pair("1e3 tiles away", 1e3), std::pair("1e6 tiles away", 1e6)})
      for (const bool tiny : {false, true}) {
        const BoxObject& boxes = tiny ? one : big;
        CastCase& c = add("far", tiny ? "one voxel" : "a block", text, boxes, CastPrediction::kThin);
        const auto make_ray = [&, distance = tiles * 16](Rng& rng) {
          Ray ray = ray_at(rng, boxes.boxes[0], 0.25, unit_vector(rng));
          return Ray{ray.origin - ray.direction * distance, ray.direction};
        };
        ask(c, boxes, make_ray, rays_);
      }
    // Voxels of a micrometre at a megametre: all numbers are multiples of 2^-27 below 2^21, so they are
    // exact.
    CastCase& c = add("far", "voxels of 2^-20 m", "at 2^20 m", big, CastPrediction::kThin);
    const auto make_ray = [&](Rng& rng) {
      Ray ray = ray_at(rng, big.boxes[0], 1, unit_vector(rng));
      for (std::size_t a = 0; a < 3; ++a) ray.origin[a] = std::floor(ray.origin[a] * 64) / 64 + 1.0 / 128;
      return ray;
    };
    ask(c, big, make_ray, rays_);
    constexpr double kEdge = 0x1p-20, kCorner = 0x1p20;
    c.object.grid.voxel_edge = kEdge;
    c.object.grid.box_min = {kCorner, -kCorner, kCorner};
    for (CastProbe& p : c.probes) {
      p.ray.origin = p.ray.origin * kEdge + Vec3{kCorner, -kCorner, kCorner};
      p.t *= kEdge;
    }
  }

  /// Rays whose numbers are integers: on planes, along edges, through corners, at cells that touch there.
  void along() {
    const BoxObject boxes = checkerboard({16, 16, 16}, 2, {2, 2, 2});
    const auto lattice = [](Rng& rng) {
      return Vec3{double(rng.below(33)), double(rng.below(33)), double(rng.below(33))};
    };
    const auto sign = [](Rng& rng) { return rng.below(2) ? 1.0 : -1.0; };
    const auto on_faces = [&](Rng& rng) {
      const std::size_t axis = rng.below(3), plane = (axis + 1 + rng.below(2)) % 3;
      Vec3 o, d;
      for (std::size_t a = 0; a < 3; ++a) o[a] = off_planes(rng, 0, 32);
      o[plane] = rng.below(33);
      d[axis] = sign(rng);
      o[axis] = d[axis] > 0 ? -4 : 36;
      return Ray{o, d};
    };
    const auto on_edges = [&](Rng& rng) {
      const std::size_t axis = rng.below(3);
      Vec3 o = lattice(rng), d;
      d[axis] = sign(rng);
      o[axis] = d[axis] > 0 ? -4 : 36;
      return Ray{o, d};
    };
    const auto through_edges = [&](Rng& rng) {
      Vec3 o = lattice(rng), d{sign(rng), sign(rng), sign(rng)};
      const std::size_t axis = rng.below(3);
      d[axis] = 0;
      o[axis] = off_planes(rng, 0, 32);
      return Ray{o - d * 40, d};
    };
    const auto through_corners = [&](Rng& rng) {
      const Vec3 o = lattice(rng), d{sign(rng), sign(rng), sign(rng)};
      return Ray{o - d * 40, d};
    };
    ask(add("along", "on faces", "", boxes, CastPrediction::kThin), boxes, on_faces, rays_);
    ask(add("along", "on edges", "", boxes, CastPrediction::kThin), boxes, on_edges, rays_);
    ask(add("along", "through edges", "", boxes, CastPrediction::kThin), boxes, through_edges, rays_);
    ask(add("along", "through corners", "", boxes, CastPrediction::kThin), boxes, through_corners, rays_);
  }

  void critical_angle() {
    const CellBox block{{2, 2, 2}, {62, 62, 40}, 1};
    const BoxObject boxes = make_box_object({64, 64, 64}, std::array{block}, {1, 1, 1}, always);
    // Offsets, and their sines.
    static constexpr std::array<std::pair<const char*, double>, 4> kOffsets = {{
        {"±1°", 1.7452406437283512e-2},
        {"±0.01°", 1.7453292431333680e-4},
        {"±1e-4°", 1.7453292519934435e-6},
        {"±1e-6°", 1.7453292519943295e-8},
    }};
    const double critical_sine = 1 / kCastIor, critical_cosine = std::sqrt(1 - critical_sine * critical_sine);
    for (const auto& [text, offset] : kOffsets) {
      CastCase& c = add("light", "critical angle", text, boxes);
      c.question = CastQuestion::kRefraction;
      Rng rng(cases_.size());
      for (std::uint32_t k = 0; k < rays_; ++k) {
        const bool leaves = rng.below(2);
        const double s = leaves ? -offset : offset, cosine = std::sqrt(1 - s * s);
        const double sine = critical_sine * cosine + critical_cosine * s;
        const Vec3 side = unit_vector(rng);
        const Vec3 flat = normalize({side.x, side.y + 1e-3, 0});
        const Vec3 d = normalize({flat.x * sine, flat.y * sine, std::sqrt(1 - sine * sine)});
        const Vec3 o{off_planes(rng, 24, 40), off_planes(rng, 24, 40), off_planes(rng, 30, 38)};
        c.probes.push_back({{o, d}, leaves, (40 - o.z) / d.z, 1, {}});
      }
    }
  }

  /// Two cells that face each other across 32 voxels.
  void mirrors() {
    const std::array cells{CellBox{{4, 0, 0}, {8, 64, 64}, 1}, CellBox{{40, 0, 0}, {44, 64, 64}, 2}};
    const BoxObject boxes = make_box_object({64, 64, 64}, cells, {1, 5, 1}, always);
    for (const std::uint32_t count : {2u, 8u, 32u}) {
      CastCase& c = add("light", "reflections", std::to_string(count) + " times", boxes);
      c.question = CastQuestion::kReflections;
      c.mirrors = count;
      // Each start is up to kCastStart off the mirror, so the path to the next one is as much shorter.
      c.slack = 2 * count * kCastStart;
      Rng rng(cases_.size());
      for (std::uint32_t k = 0; k < rays_; ++k) {
        const Vec3 o{off_planes(rng, 10, 38), off_planes(rng, 20, 28), off_planes(rng, 28, 36)};
        const double to_right = rng.below(2), first = to_right > 0 ? 40 - o.x : o.x - 8;
        const double way = first + 32.0 * (count - 1);
        const Vec3 slope{to_right > 0 ? 1.0 : -1.0, rng.uniform(0.05, 0.25), rng.uniform(-0.02, 0.02)};
        const bool last_right = (to_right > 0) == (count % 2 == 1);
        const Vec3 last{last_right ? 40.0 : 8.0, o.y + slope.y * way, o.z + slope.z * way};
        c.probes.push_back({{o, normalize(slope)}, true, 0, last_right ? 2u : 1u, last});
      }
    }
  }

  static std::string voxels(int n) { return std::to_string(n) + (n == 1 ? " voxel" : " voxels"); }

  std::uint32_t rays_;
  std::vector<CastCase> cases_;
};

}  // namespace

std::vector<CastCase> cast_cases(std::uint32_t rays) { return Cases(rays).make(); }

}  // namespace mesocell
