#include <algorithm>
#include <cmath>
#include <cstdio>

#include "converters/cli/comparison.h"
#include "converters/cli/representations.h"
#include "converters/import/mesh_file.h"
#include "sdk/measure/surface_distance.h"
#include "sdk/membership/diagnose.h"

namespace mesocell {
namespace {

using Json = nlohmann::ordered_json;

Json direction_json(const SurfaceDistance& distance, const DistanceFigures& figures) {
  return {{"max", figures.max},
          {"mean", figures.mean},
          {"rms", figures.rms},
          {"max_percent", distance.percent(figures.max)},
          {"mean_percent", distance.percent(figures.mean)},
          {"rms_percent", distance.percent(figures.rms)},
          {"samples", figures.samples}};
}

std::string direction_text(const char* name, const SurfaceDistance& distance,
                           const DistanceFigures& figures) {
  char text[256];
  std::snprintf(text, sizeof text,
                "  %s: max %.6g m (%.4g %%), mean %.6g m (%.4g %%), RMS %.6g m (%.4g %%), %llu samples\n",
                name, figures.max, distance.percent(figures.max), figures.mean,
                distance.percent(figures.mean), figures.rms, distance.percent(figures.rms),
                static_cast<unsigned long long>(figures.samples));
  return text;
}

/// Metres³; nothing if the mesh is open.
std::optional<double> volume_of(const TriangleMesh& mesh) {
  const double volume = std::abs(signed_volume(mesh));
  return volume > 0 && diagnose(mesh).closed() ? std::optional(volume) : std::nullopt;
}

}  // namespace

std::optional<Failure> compare_with_mesh(const CompareCommand& command, const Progress& progress,
                                         Comparison& result) {
  if (command.tolerance && !(*command.tolerance >= 0 && std::isfinite(*command.tolerance)))
    return usage("--tolerance", "it must be a finite number of per cent from 0");
  const Result<AssetFile> asset = read_asset_file(command.a);
  if (!asset) return Failure{asset.error(), command.a};
  const Result<TriangleMesh> mesh = read_mesh_file(command.b, {}, nullptr, &progress);
  if (!mesh) return Failure{mesh.error(), command.b};
  SurfaceDistanceOptions options;
  options.samples = command.samples.value_or(options.samples);
  options.seed = command.seed.value_or(options.seed);
  options.threads = command.common.threads;
  const Result<SurfaceDistance> distance = asset->first().surface_distance(*mesh, options, progress);
  if (!distance) return Failure{distance.error(), command.a + ", " + command.b};

  const double rms = distance->percent(std::max(distance->asset_to_mesh.rms, distance->mesh_to_asset.rms));
  const bool within = !command.tolerance || rms <= *command.tolerance;
  const double volume = asset->first().volume();
  const std::optional<double> mesh_volume = volume_of(*mesh);
  Json& json = result.json;
  json = {{"kind", "asset-and-mesh"}, {"equal", within}, {"differences", Json::array()}};
  if (!within) json["differences"].push_back("surface");
  json["tolerance"] = command.tolerance ? Json(*command.tolerance) : Json(nullptr);
  json["surface_distance"] = {{"asset_to_mesh", direction_json(*distance, distance->asset_to_mesh)},
                              {"mesh_to_asset", direction_json(*distance, distance->mesh_to_asset)},
                              {"samples", options.samples},
                              {"seed", options.seed},
                              {"diagonal", distance->diagonal}};
  json["volume"] = {{"asset", volume},
                    {"mesh", mesh_volume ? Json(*mesh_volume) : Json(nullptr)},
                    {"percent", mesh_volume ? Json(100 * volume / *mesh_volume) : Json(nullptr)}};

  char text[256];
  std::snprintf(text, sizeof text, "distances, in per cent of the mesh's diagonal of %.6g m, seed %llu\n",
                distance->diagonal, static_cast<unsigned long long>(options.seed));
  result.text = text + direction_text("asset to mesh", *distance, distance->asset_to_mesh) +
                direction_text("mesh to asset", *distance, distance->mesh_to_asset);
  if (mesh_volume) {
    std::snprintf(text, sizeof text, "  volume: %.4g %% of the mesh's\n", 100 * volume / *mesh_volume);
    result.text += text;
  }
  if (command.tolerance) {
    std::snprintf(text, sizeof text, "  RMS %.4g %%: %s the tolerance of %g %%\n", rms,
                  within ? "within" : "over", *command.tolerance);
    result.text += text;
  }
  return std::nullopt;
}

}  // namespace mesocell
