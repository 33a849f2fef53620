#include "converters/bench/bench.h"

#include <atomic>
#include <string>

#include "converters/bench/bench_sets.h"
#include "converters/bench/bench_table.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',')
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

BenchCase make_case(const std::string& scene, const char* view, RaySet rays) {
  const Result<BenchView> parsed = parse_view(view);
  REQUIRE(parsed.ok());
  return {scene, *parsed, rays};
}

BenchOptions small(std::vector<std::string> methods) {
  BenchOptions options;
  options.methods = std::move(methods);
  options.size = {64, 48};
  options.timing.threads = {1, 2};
  options.timing.repeat = 1;
  options.oracle_rays = 200;
  return options;
}

BenchResult run(const std::vector<BenchCase>& cases, const BenchOptions& options,
                const std::optional<BenchObject>& object = std::nullopt) {
  Result<BenchResult> result = run_bench(cases, object, options, {});
  INFO((result ? "" : result.error().message));
  REQUIRE(result.ok());
  return std::move(*result);
}

}  // namespace

TEST_CASE("cases are measured with all methods and threads, and exact tracing is exact") {
  const char* const scene = "torus-voronoi-16x8";
  const BenchResult result =
      run({make_case(scene, "full", RaySet::kPrimary), make_case(scene, "full", RaySet::kDiffuse),
           make_case(scene, "grazing-10", RaySet::kPrimary)},
          small({"exact", "linear:1/8"}));
  CHECK(result.notes.empty());
  CHECK(result.exact_differs == 0);
  REQUIRE(result.rows.size() == 3 * 2 * 2);
  for (std::size_t k = 0; k < result.rows.size(); ++k) {
    const BenchRow& row = result.rows[k];
    INFO(k);
    CHECK(row.scene == scene);
    CHECK(row.shape == "torus");
    CHECK(row.tile == "voronoi");
    CHECK(row.tiles == 16);
    CHECK(row.resolution == 8);
    CHECK(row.camera == (k < 8 ? "full" : "grazing-10"));
    CHECK(row.rays == (k / 4 == 1 ? "diffuse" : "primary"));
    CHECK(row.figures.method == (k % 2 ? "linear:1/8" : "exact"));
    CHECK(row.figures.threads == (k % 4 < 2 ? 1 : 2));
    CHECK(row.figures.rays_per_second > 0);
    CHECK(row.figures.peak_bytes > 1000);
    CHECK(row.angle_degrees > (k < 8 ? 20 : 6));
    if (k >= 8) CHECK(row.angle_degrees < 14);
    CHECK(row.angle_degrees < 85);
    const TracingError& e = row.figures.error;
    if (row.figures.method == "exact") {
      CHECK(e.rays == 200);
      CHECK(e.missed + e.false_hits + e.wrong_cells + e.wrong_voxels == 0);
      CHECK(e.voxels > 10);
    } else {
      CHECK(e.rays == row.figures.ray_count);
      CHECK(e.missed + e.wrong_voxels > 0);
      CHECK(e.depth_mean > 0);
      CHECK(e.depth_p99 <= e.depth_max);
    }
  }
  CHECK(result.rows[0].figures.ray_count == 64 * 48);
}

TEST_CASE("an object of the user's is measured") {
  const CellObject blocks = make_blocks({5, 3, 4}, 4, [](auto x, auto, auto z) { return x == 2 || z == 1; });
  const BenchResult result =
      run({make_case("", "full", RaySet::kPrimary), make_case("", "inside", RaySet::kShadow)},
          small({"exact"}), BenchObject{"b,\"1\".meso", blocks});
  REQUIRE(result.rows.size() == 4);
  CHECK(result.exact_differs == 0);
  CHECK(result.rows[0].scene == "b,\"1\".meso");
  CHECK(result.rows[0].tiles == 5);
  CHECK(result.rows[0].resolution == 4);
  CHECK(bench_csv({}, result.rows).find("\n\"b,\"\"1\"\".meso\",file,,5,4,full,primary,exact,1,") !=
        std::string::npos);
}

TEST_CASE("what cannot be measured is told") {
  const CellObject nothing = make_blocks({2, 2, 2}, 4, [](auto...) { return false; });
  const CellObject solid = make_blocks({2, 2, 2}, 4, [](auto...) { return true; });
  const std::vector<BenchCase> cases = {
      make_case("", "close", RaySet::kPrimary), make_case("", "inside", RaySet::kPrimary),
      make_case("", "full", RaySet::kPrimary), make_case("", "full", RaySet::kDiffuse)};
  const BenchResult empty = run(cases, small({"exact"}), BenchObject{"empty", nothing});
  CHECK(empty.rows.size() == 2);  // all miss
  CHECK(empty.notes.size() == 3);
  const BenchResult full = run(cases, small({"exact"}), BenchObject{"full", solid});
  CHECK(full.rows.size() == 6);
  REQUIRE(full.notes.size() == 1);
  CHECK(full.notes[0].find("inside") != std::string::npos);

  BenchOptions options = small({"exact", "guess"});
  const std::vector<BenchCase> one = {make_case("", "full", RaySet::kPrimary)};
  const std::optional<BenchObject> object = BenchObject{"full", solid};
  const Result<BenchResult> refused = run_bench(one, object, options, {});
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().code == ErrorCode::kUsage);
  options.skip_missing = true;
  const BenchResult skipped = run(one, options, object);
  CHECK(skipped.rows.size() == 2);
  REQUIRE(skipped.notes.size() == 1);
  CHECK(skipped.notes[0].find("guess") != std::string::npos);
}

TEST_CASE("a benchmark ends when its time is up, or when it is told to") {
  const std::vector<BenchCase> cases(5, make_case("torus-voronoi-16x8", "full", RaySet::kPrimary));
  BenchOptions options = small({"exact"});
  options.max_seconds = 1e-9;
  const BenchResult result = run(cases, options);
  CHECK(result.rows.empty());
  REQUIRE(result.notes.size() == 1);
  CHECK(result.notes[0].find("5 of 5") != std::string::npos);
  const std::atomic<bool> stop{true};
  const Result<BenchResult> stopped = run_bench(cases, std::nullopt, small({"exact"}), Progress{{}, &stop});
  REQUIRE_FALSE(stopped.ok());
  CHECK(stopped.error().code == ErrorCode::kCancelled);
}

TEST_CASE("CSV has head lines, one line of names, and as many fields in every line") {
  BenchRow row;
  row.scene = "wavy-voronoi-64x32";
  row.camera = "full";
  row.rays = "primary";
  row.figures.method = "linear:1/512";
  row.figures.threads = 2;
  row.figures.rays_per_second = 1234567.89;
  row.figures.peak_bytes = 123456789012;
  row.figures.error = {.rays = 10, .hits = 4, .missed = 1, .false_hits = 3};
  row.figures.error.depth_max = 2.5;
  const std::vector<std::string> lines =
      lines_of(bench_csv({{"program", "mesocell"}, {"note", "two\nlines"}}, {&row, 1}));
  REQUIRE(lines.size() == 4);
  CHECK(lines[0] == "# program: mesocell");
  CHECK(lines[1] == "# note: two lines");
  CHECK(lines[2] ==
        "scene,shape,tile,tiles,tile_resolution,camera,rays,method,threads,ray_count,hit_rate,angle_degrees,"
        "repeats,rays_per_second,rays_per_second_min,rays_per_second_max,steps_per_ray,build_seconds,"
        "peak_bytes,miss_rate,false_hit_rate,depth_error_mean,depth_error_p99,depth_error_max,"
        "normal_angle_mean,wrong_cell_rate,wrong_voxel_rate");
  const std::vector<std::string> names = fields_of(lines[2]), fields = fields_of(lines[3]);
  REQUIRE(names.size() == fields.size());
  const auto field = [&](const char* name) {
    for (std::size_t k = 0; k < names.size(); ++k)
      if (names[k] == name) return fields[k];
    return std::string("?");
  };
  CHECK(field("method") == "linear:1/512");
  CHECK(field("rays_per_second") == "1.23457e+06");
  CHECK(field("steps_per_ray").empty());
  CHECK(field("peak_bytes") == "123456789012");
  CHECK(field("miss_rate") == "0.25");
  CHECK(field("false_hit_rate") == "0.5");
  CHECK(field("depth_error_max") == "2.5");
  CHECK(field("wrong_cell_rate").empty());
}

TEST_CASE("sets name scenes, cameras and methods that there are") {
  for (const char* name : {"quick", "default", "full"}) {
    INFO(name);
    const Result<BenchSet> set = find_bench_set(name);
    REQUIRE(set.ok());
    const Result<std::vector<BenchCase>> cases = bench_cases(*set);
    REQUIRE(cases.ok());
    CHECK(cases->front().scene ==
          (std::string(name) == "full" ? "wavy-voronoi-16x32" : "wavy-voronoi-64x32"));
    CHECK(std::ranges::find(set->methods, "exact") != set->methods.end());
    CHECK(std::ranges::find(set->methods, "embree-instanced") != set->methods.end());
  }
  // Six shapes, four tiles, three sizes, one of a fine tile; five cameras and four kinds of rays each.
  CHECK(bench_cases(*find_bench_set("full"))->size() == 73 * 20 + 6 * 5);
  CHECK_FALSE(find_bench_set("all").ok());
  BenchSet set = *find_bench_set("quick");
  set.views = {"above"};
  CHECK_FALSE(bench_cases(set).ok());
  set.scenes = {"above"};
  CHECK_FALSE(bench_cases(set).ok());
}
