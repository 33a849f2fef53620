#include "converters/bench/bench_sets.h"

#include <algorithm>

#include "converters/bench/scene.h"

namespace mesocell {
namespace {

constexpr std::string_view kReference = "wavy-voronoi-64x32";

/// Six that differ in what they ask of a caster.
const std::vector<std::string> kShapes = {"wavy", "torus", "knot", "slab", "needles", "sponge"};
const std::vector<std::string> kGrazing = {"grazing-1", "grazing-2", "grazing-10", "grazing-20",
                                           "grazing-45"};
const std::vector<std::string> kViews = {"full", "cover90", "close", "grazing", "inside"};
const std::vector<RaySet> kAllRays = {RaySet::kPrimary, RaySet::kDiffuse, RaySet::kReflection,
                                      RaySet::kShadow};

BenchSet quick_set() {
  return {.scenes = {std::string(kReference), "wavy-voronoi-16x32"},
          .views = {"full", "grazing"},
          .rays = {RaySet::kPrimary, RaySet::kDiffuse},
          .primary_only = {"grazing"},
          .methods = bench_methods(),
          .pass_seconds = 0.25,
          .max_seconds = 40};
}

/// Every shape with one tile, every tile with one shape, every size of those, and angles on the plate.
BenchSet default_set() {
  BenchSet set{.views = kViews,
               .rays = {RaySet::kPrimary, RaySet::kDiffuse},
               .first_rays = {RaySet::kReflection, RaySet::kShadow},
               .primary_only = {"cover90", "close", "grazing", "inside"},
               .more_scenes = {"slab-voronoi-64x32"},
               .more_views = kGrazing,
               .methods = bench_methods(),
               .pass_seconds = 0.1,
               .max_seconds = 450};  // a case that has begun is ended, and takes a minute at most
  // What matters most comes first, in case there is no time for all.
  set.scenes.emplace_back(kReference);
  for (const char* size : {"64x128", "16x32", "128x32"})
    set.scenes.push_back("wavy-voronoi-" + std::string(size));
  for (const std::string& shape : kShapes)
    if (shape != "wavy") set.scenes.push_back(shape + "-voronoi-64x32");
  for (const BenchTile& tile : bench_tiles())
    if (tile.name != "voronoi") set.scenes.push_back("wavy-" + std::string(tile.name) + "-64x32");
  return set;
}

BenchSet full_set() {
  BenchSet set{.views = kViews,
               .rays = kAllRays,
               .more_views = kGrazing,
               .methods = bench_methods(),
               .pass_seconds = 1,
               .max_seconds = 0,
               .max_peer_bytes = std::uint64_t{1} << 36};
  for (const std::string& shape : kShapes)
    for (const BenchTile& tile : bench_tiles())
      for (const char* tiles : {"16", "64", "128"})
        set.scenes.push_back(shape + "-" + std::string(tile.name) + "-" + tiles + "x32");
  set.scenes.emplace_back("wavy-voronoi-64x128");
  for (const std::string& shape : kShapes) set.more_scenes.push_back(shape + "-voronoi-64x32");
  return set;
}

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::ranges::find(words, word) != words.end();
}

}  // namespace

Result<BenchSet> find_bench_set(std::string_view name) {
  if (name == "quick") return quick_set();
  if (name == "default") return default_set();
  if (name == "full") return full_set();
  return Error{ErrorCode::kUsage,
               "there is no set '" + std::string(name) + "'; there are quick, default and full"};
}

Result<std::vector<BenchCase>> bench_cases(const BenchSet& set) {
  std::vector<BenchCase> cases;
  std::vector<std::string> scenes = set.scenes;
  for (const std::string& scene : set.more_scenes)
    if (!has(scenes, scene)) scenes.push_back(scene);
  for (const std::string& scene : scenes) {
    if (!scene.empty())
      if (const Result<SceneName> parsed = parse_scene_name(scene); !parsed) return parsed.error();
    std::vector<RaySet> rays_of_scene = set.rays;
    if (scene == scenes.front())
      rays_of_scene.insert(rays_of_scene.end(), set.first_rays.begin(), set.first_rays.end());
    const auto add = [&](const std::string& name, bool only_primary) -> Status {
      const Result<BenchView> view = parse_view(name);
      if (!view) return view.error();
      for (const RaySet rays : rays_of_scene)
        if (!only_primary || rays == RaySet::kPrimary) cases.push_back({scene, *view, rays});
      return {};
    };
    if (has(set.scenes, scene))
      for (const std::string& view : set.views)
        if (const Status status = add(view, has(set.primary_only, view)); !status) return status.error();
    if (has(set.more_scenes, scene))
      for (const std::string& view : set.more_views)
        if (const Status status = add(view, true); !status) return status.error();
  }
  return cases;
}

}  // namespace mesocell
