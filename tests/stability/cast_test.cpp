#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "converters/stability/cast_boxes.h"
#include "converters/stability/cast_report.h"
#include "sdk/core/rng.h"
#include "sdk/trace/cell_object_caster.h"
#include "tests/stability/occurrences.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

/// A caster that is wrong in ways that can be chosen.
class WrongCaster final : public Caster {
 public:
  enum class Fault : std::uint8_t { kMisses, kHitsAll, kDeep, kOtherCell };
  WrongCaster(const Caster& right, Fault fault) : right_(right), fault_(fault) {}

  bool first_hit(const Ray& ray, Hit& hit) const override {
    const bool found = right_.first_hit(ray, hit);
    if (fault_ == Fault::kMisses) return false;
    if (fault_ == Fault::kHitsAll) return true;
    hit.t += fault_ == Fault::kDeep ? 0.5 : 0;
    hit.label += fault_ == Fault::kOtherCell;
    return found;
  }
  bool first_exit(const Ray& ray, Hit& hit) const override { return right_.first_exit(ray, hit); }
  bool inside(Vec3 point) const override { return right_.inside(point); }
  Vec3 shading_normal(const Hit& hit) const override { return right_.shading_normal(hit); }
  Vec3 color(const Hit& hit, Vec3 point) const override { return right_.color(hit, point); }
  double detail() const override { return right_.detail(); }
  Box3 object_box() const override { return right_.object_box(); }
  std::uint64_t memory_bytes() const override { return 0; }

 private:
  const Caster& right_;
  Fault fault_;
};

const CastCase& find_case(const std::vector<CastCase>& cases, const std::string& row) {
  const auto found = std::ranges::find_if(cases, [&](const CastCase& c) { return c.row() == row; });
  REQUIRE(found != cases.end());
  return *found;
}

const CastResult& find_result(const std::vector<CastResult>& results, const std::string& row,
                              const std::string& method) {
  const auto found = std::ranges::find_if(
      results, [&](const CastResult& r) { return r.row() == row && r.method == method; });
  REQUIRE(found != results.end());
  return *found;
}

/// Methods of the registry that this build makes.
std::vector<CastMethod> known_methods(const CellObject& object) {
  std::vector<CastMethod> methods(cast_methods().begin(), cast_methods().end());
  std::erase_if(methods, [&](const CastMethod& m) { return !make_cell_object_caster(object, m.name).ok(); });
  return methods;
}

}  // namespace

TEST_CASE("the first of some boxes, half-open, is told in closed form") {
  const std::vector<CellBox> boxes{
      {{4, 4, 4}, {6, 6, 6}, 1}, {{8, 4, 4}, {9, 6, 6}, 2}, {{6, 6, 4}, {7, 7, 6}, 3}};
  const auto cell = [&](Vec3 o, Vec3 d) {
    const auto hit = first_box(boxes, {o, d});
    return hit ? int(hit->cell) : 0;
  };
  CHECK(cell({0, 5, 5}, {1, 0, 0}) == 1);
  CHECK(first_box(boxes, {{0, 5, 5}, {2, 0, 0}})->t == 2);
  CHECK(cell({12, 5, 5}, {-1, 0, 0}) == 2);
  CHECK(cell({7, 5, 5}, {1, 0, 0}) == 2);
  CHECK(cell({5, 5, 5}, {1, 0, 0}) == 1);
  CHECK(first_box(boxes, {{5, 5, 5}, {1, 0, 0}})->t == 0);
  CHECK(cell({10, 5, 5}, {1, 0, 0}) == 0);
  // On the lower faces, which belong to the boxes, and on the upper ones, which do not.
  CHECK(cell({0, 4, 4}, {1, 0, 0}) == 1);
  CHECK(cell({0, 6, 5}, {1, 0, 0}) == 3);
  CHECK(cell({0, 5, 6}, {1, 0, 0}) == 0);
  // Through the edge at which boxes 1 and 3 touch: in both directions one after the other.
  CHECK(cell({4, 4, 5}, {1, 1, 0}) == 1);
  CHECK(cell({10, 10, 5}, {-1, -1, 0}) == 3);
  // Across that edge, past both of them: (6, 6) itself is of box 3; going down in x it is met, at a point.
  CHECK(cell({5, 7, 5}, {1, -1, 0}) == 3);
  CHECK(cell({8, 4.5, 5}, {-1, 0.75, 0}) == 2);
}

TEST_CASE("objects of boxes are as their boxes say") {
  const std::vector<CellBox> cells{{{0, 0, 0}, {2, 3, 4}, 1}, {{2, 1, 1}, {4, 4, 2}, 2}};
  const BoxObject made = make_box_object({4, 4, 4}, cells, {3, 2, 2},
                                         [](auto x, auto y, auto z) { return (x + y + z) % 2 == 0; });
  const auto caster = *make_cell_object_caster(made.object, "exact");
  REQUIRE(made.boxes.size() == 12);
  for (int z = 0; z < 8; ++z)
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 12; ++x) {
        const Vec3 p{x + 0.5, y + 0.5, z + 0.5};
        const bool in = std::ranges::any_of(made.boxes, [&](const CellBox& b) { return b.holds(p); });
        REQUIRE(caster->inside(p) == in);
      }
}

TEST_CASE("exact answers all of the catalogue, the source's search fails where it is said to", "[slow]") {
  const std::vector<CastCase> cases = cast_cases(300);
  REQUIRE(cases.size() > 30);
  for (const CastCase& c : cases) {
    CAPTURE(c.row());
    CHECK(c.probes.size() >= 75);
    CHECK(std::ranges::any_of(c.probes, &CastProbe::hit));
  }
  const Result<std::vector<CastResult>> results =
      measure_cast_stability(cases, known_methods(cases[0].object), 0, nullptr);
  REQUIRE(results.ok());
  for (const CastResult& r : *results) {
    CAPTURE(r.row(), r.method);
    if (r.exact) CHECK(r.verdict == CastVerdict::kHolds);
    if (r.group != "light" && r.name != "exit into a gap of" && r.method != "lod:1px")
      CHECK(r.errors.false_hits == 0);
  }
  for (const char* row : {"wall 1 voxel", "needle 1 voxel", "checkerboard 1 voxel", "slats at 1°"})
    CHECK(find_result(*results, row, "linear:1/128").verdict == CastVerdict::kFailsAsPredicted);
  // At a grazing angle a fixed step misses most slats, one by the angle few.
  CHECK(find_result(*results, "slats at 0.1°", "linear:1/128").errors.wrong_percent() > 30);
  CHECK(find_result(*results, "slats at 0.1°", "linear:1/128:angle").errors.wrong_percent() < 5);
  CHECK(find_result(*results, "wall 1 voxel", "linear:1/512").errors.wrong() <
        find_result(*results, "wall 1 voxel", "linear:1/128").errors.wrong());
  CHECK(find_result(*results, "slats at 90°", "linear:1/512").verdict == CastVerdict::kHolds);
  CHECK(find_result(*results, "on faces", "distance").verdict == CastVerdict::kHolds);
}

TEST_CASE("each kind of wrong answer is told as such") {
  const std::vector<CastCase> cases = cast_cases(200);
  const CastCase& c = find_case(cases, "wall 4 voxels");
  const auto right = *make_cell_object_caster(c.object, "exact");
  const auto measure = [&](WrongCaster::Fault fault) {
    return measure_case(c, WrongCaster(*right, fault), false, 1);
  };
  const CastErrors none = measure_case(c, *right, true, 2);
  REQUIRE(none.hits > 20);
  REQUIRE(none.hits < none.rays);
  CHECK(none.wrong() == 0);
  CHECK(none.depth_max < 1e-9);
  const CastErrors missed = measure(WrongCaster::Fault::kMisses);
  CHECK(missed.missed == none.hits);
  CHECK(missed.miss_rate() == 1);
  CHECK(missed.wrong() == none.hits);
  const CastErrors all = measure(WrongCaster::Fault::kHitsAll);
  CHECK(all.false_hits == none.rays - none.hits);
  CHECK(all.false_hit_rate() == 1);
  CHECK(all.missed == 0);
  const CastErrors deep = measure(WrongCaster::Fault::kDeep);
  CHECK(deep.off == none.hits);
  CHECK(deep.depth_p99 == Approx(0.5));
  CHECK(deep.depth_mean == Approx(0.5));
  CHECK(measure(WrongCaster::Fault::kOtherCell).wrong_cell == none.hits);
  // Whether light leaves is asked too.
  const CastCase& glass = find_case(cases, "critical angle ±1e-6°");
  CHECK(measure_case(glass, **make_cell_object_caster(glass.object, "exact"), true, 1).wrong() == 0);
  CastCase turned = glass;
  for (CastProbe& p : turned.probes) p.hit = !p.hit;
  CHECK(measure_case(turned, **make_cell_object_caster(glass.object, "exact"), true, 1).wrong() ==
        glass.probes.size());
}

TEST_CASE("tables and the picture of casting have all cases and methods") {
  CastErrors some{.rays = 200, .hits = 100, .missed = 3, .wrong_cell = 1, .false_hits = 2};
  const std::vector<CastResult> results{
      {"thin", "wall", "1 voxel", "exact", {.rays = 200, .hits = 100}, CastVerdict::kHolds, true},
      {"thin", "wall", "1 voxel", "linear:1/8", some, CastVerdict::kFailsAsPredicted, false},
      {"light", "odd, name", "", "exact", {.rays = 200, .hits = 200}, CastVerdict::kHolds, true},
      {"light", "odd, name", "", "linear:1/8", some, CastVerdict::kFails, false}};
  const std::string csv = cast_csv(results);
  CHECK(occurrences(csv, "\n") == 5);
  CHECK(csv.find("thin,wall,1 voxel,linear:1/8,fails as the source predicts,200,100,3,1,0,2,3,0.03,0.02,") !=
        csv.npos);
  CHECK(csv.find("\"odd, name\"") != csv.npos);
  const std::string markdown = cast_markdown(results);
  CHECK(occurrences(markdown, "| wall 1 voxel |") == 2);
  CHECK(markdown.find("| holds | 3.0 % predicted |") != markdown.npos);
  CHECK(markdown.find("| holds | 3.0 % |") != markdown.npos);
  CHECK(markdown.find("3.0 / 2.0 / 0 / 0") != markdown.npos);
  const std::string svg = cast_heat_map(results, "a & b");
  CHECK(svg.starts_with("<svg "));
  CHECK(occurrences(svg, "<rect") == 1 + 4 + 7);
  CHECK(occurrences(svg, "<text") == occurrences(svg, "</text>"));
  CHECK(svg.find("a &amp; b") != svg.npos);
}
