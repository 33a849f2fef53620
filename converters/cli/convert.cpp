#include <sys/resource.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "converters/cli/cell_object_asset.h"
#include "converters/cli/commands.h"
#include "converters/cli/interrupt.h"
#include "converters/cli/progress_bar.h"
#include "converters/cli/representations.h"
#include "converters/cli/values.h"
#include "converters/import/mesh_file.h"
#include "format/cell_object_io.h"
#include "format/file.h"
#include "sdk/author/cell_object.h"
#include "sdk/surface/color.h"
#include "sdk/surface/normals.h"
#include "sdk/tiles/tile_spec.h"

namespace mesocell {
namespace {

class Stopwatch {
 public:
  /// Seconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }
  [[nodiscard]] double total() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_ = start_;
};

struct Seconds {
  double read = 0, tile = 0, voxelize = 0, surface = 0, write = 0, total = 0;
};

/// The most memory that the process has held so far, bytes.
std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) * 1024;
}

/// What the words of the command line mean.
struct Plan {
  Recipe tile;
  std::optional<Recipe> color;
  AuthorOptions author;
};

struct Failure {
  Error error;
  std::string subject;
};

Failure usage(std::string subject, std::string message) {
  return {Error{ErrorCode::kUsage, std::move(message)}, std::move(subject)};
}

/// Checks all that can be checked before work is done.
std::optional<Failure> make_plan(const ConvertCommand& command, Plan& plan) {
  if (has_extension(command.input, ".meso"))
    return usage(command.input, "converting from .meso is not available; the input must be a mesh: " +
                                    std::string(kMeshExtensions));
  if (!has_extension(command.output, ".meso"))
    return usage(command.output, "a mesh can be converted to .meso alone; give the output that extension");
  if (same_file(command.input, command.output))
    return usage(command.output, "input and output are the same file; name another output");
  Result<Recipe> spec = parse_recipe(command.tile);
  if (!spec) return Failure{spec.error(), "--tile"};
  plan.tile = std::move(*spec);
  if (command.color) {
    Result<Recipe> color = parse_recipe(*command.color);
    if (!color) return Failure{color.error(), "--color"};
    plan.color = std::move(*color);
  }
  const std::optional<MembershipRule> rule = find_rule(command.rule);
  if (!rule) return usage("--rule", "unknown rule '" + command.rule + "'; there are: " + rule_names());
  plan.author.rule = *rule;
  plan.author.threads = command.common.threads;
  if (command.tiles <= 0) return usage("--tiles", "there must be at least one tile; give a number from 1");
  if (command.tile_size && !(*command.tile_size > 0 && std::isfinite(*command.tile_size)))
    return usage("--tile-size", "it must be a finite number of metres above 0; give the edge of a tile");
  if (command.tiles > 0xffff'ffff)
    return Failure{Error{ErrorCode::kLimit, "so many tiles are more than can be counted; use fewer"},
                   "--tiles"};
  plan.author.grid.tiles = std::uint32_t(command.tiles);
  plan.author.grid.tile_size = command.tile_size;
  if (!command.box.empty()) {
    const Result<std::array<double, 6>> box = parse_numbers<6>(command.box);
    if (!box) return Failure{box.error(), "--box"};
    const std::array<double, 6>& b = *box;
    if (!(b[0] < b[3] && b[1] < b[4] && b[2] < b[5]))
      return usage("--box", "the box has no room; write its lesser corner first: x0,y0,z0,x1,y1,z1");
    plan.author.grid.box = Box3{};
    plan.author.grid.box->add({b[0], b[1], b[2]});
    plan.author.grid.box->add({b[3], b[4], b[5]});
  }
  if (Status status = check_output(command.output, command.no_clobber); !status)
    return Failure{status.error(), command.output};
  return std::nullopt;
}

struct Outcome {
  AssetFile file;
  AuthorReport report;
  Seconds seconds;
};

/// Everything on the surface of the object; the metadata says what it was made of.
std::optional<Failure> add_surface(const ConvertCommand& command, const Plan& plan, Colors colors,
                                   const TriangleMesh& mesh, const Progress& progress, CellObject& object) {
  object.metadata.clear();
  if (plan.color) object.metadata.emplace_back("color", to_text(*plan.color));
  object.metadata.emplace_back("tile", to_text(plan.tile));
  if (Status status = apply_colors(std::move(colors), mesh, object, plan.author.threads, &progress); !status)
    return Failure{status.error(), command.input};
  if (!command.normals) return std::nullopt;
  object.normals = make_normal_map(object.tile, plan.author.threads, &progress);
  if (!object.normals) return Failure{Error{ErrorCode::kCancelled, "interrupted"}, {}};
  return std::nullopt;
}

/// Reads, makes the tile, authors, writes, and reads back what was written.
std::optional<Failure> convert(const ConvertCommand& command, const Progress& progress, Outcome& outcome) {
  Stopwatch watch;
  Plan plan;
  if (std::optional<Failure> failure = make_plan(command, plan)) return failure;

  watch.lap();
  MeshReadReport read_report;
  Result<TriangleMesh> mesh = read_mesh_file(command.input, {}, &read_report, &progress);
  if (!mesh) return Failure{mesh.error(), command.input};
  outcome.seconds.read = watch.lap();

  TileReport tile_report;
  Result<TileMap> tile = make_tile(plan.tile, plan.author.threads, &tile_report, &progress);
  if (!tile) return Failure{tile.error(), "--tile"};
  outcome.seconds.tile = watch.lap();

  // Before the longest part of the work, as the recipe may be wrong.
  Colors colors;
  if (plan.color) {
    Result<Colors> made = make_colors(*plan.color, tile->cell_count, *mesh);
    if (!made) return Failure{made.error(), "--color"};
    colors = std::move(*made);
  }
  const double color_seconds = watch.lap();

  Result<CellObject> object =
      author_cell_object(*mesh, std::move(*tile), plan.author, &outcome.report, &progress);
  if (!object) return Failure{object.error(), command.input};
  outcome.seconds.voxelize = outcome.report.voxelize_seconds;
  watch.lap();
  if (auto failure = add_surface(command, plan, std::move(colors), *mesh, progress, *object)) return failure;
  outcome.seconds.surface = outcome.report.surface_seconds + color_seconds + watch.lap();
  if (read_report.dropped_faces > 0)
    outcome.report.warnings.push_back(
        {"faces-dropped", std::to_string(read_report.dropped_faces) +
                              " triangles with two equal corners were left out; they enclose nothing"});
  if (tile_report.dropped_cells > 0)
    outcome.report.warnings.push_back(
        {"cells-dropped",
         std::to_string(tile_report.dropped_cells) +
             " cells of the tile got no voxel and were left out; use fewer cells or a higher "
             "resolution"});

  watch.lap();
  const Result<std::vector<std::byte>> bytes = encode_cell_object(*object);
  if (!bytes) return Failure{bytes.error(), command.output};
  if (progress.cancelled()) return Failure{Error{ErrorCode::kCancelled, "interrupted"}, {}};
  if (Status status = write_file(command.output, *bytes, command.no_clobber); !status)
    return Failure{status.error(), command.output};
  outcome.seconds.write = watch.lap();

  Result<AssetFile> file = read_asset(*bytes);
  if (!file) return Failure{file.error(), command.output};
  outcome.file = std::move(*file);
  outcome.seconds.total = watch.total();
  return std::nullopt;
}

nlohmann::ordered_json outcome_json(const Outcome& outcome) {
  nlohmann::ordered_json json = describe_asset(outcome.file);
  json["seconds"]["read"] = outcome.seconds.read;
  json["seconds"]["tile"] = outcome.seconds.tile;
  json["seconds"]["voxelize"] = outcome.seconds.voxelize;
  json["seconds"]["surface"] = outcome.seconds.surface;
  json["seconds"]["write"] = outcome.seconds.write;
  json["seconds"]["total"] = outcome.seconds.total;
  json["peak_bytes"] = peak_bytes();
  json["warnings"] = nlohmann::ordered_json::array();
  for (const Warning& warning : outcome.report.warnings)
    json["warnings"].push_back({{"id", warning.id}, {"text", warning.text}});
  json["volume"]["mesh"] = outcome.report.mesh_volume;
  json["volume"]["inside"] = outcome.report.inside_volume;
  return json;
}

std::string outcome_text(const Outcome& outcome, const std::string& output) {
  const nlohmann::ordered_json info = describe_asset(outcome.file);
  const double share =
      outcome.report.mesh_volume > 0 ? 100 * outcome.report.inside_volume / outcome.report.mesh_volume : 0;
  char text[256];
  std::snprintf(
      text, sizeof text, ": %.2f MB in %.1f s (peak memory %.0f MB), %.2f %% of the mesh's volume inside\n",
      double(outcome.file.file_bytes) * 1e-6, outcome.seconds.total, double(peak_bytes()) * 1e-6, share);
  return printable(output) + text;
}

}  // namespace

int run_convert(const ConvertCommand& command) {
  const Console console(command.common);
  ProgressBar bar(!console.quiet());
  Outcome outcome;
  const std::optional<Failure> failure = convert(command, bar.progress(), outcome);
  bar.finish();
  if (failure) return console.fail(failure->error, failure->subject);
  for (const Warning& warning : outcome.report.warnings) console.warn(command.input, warning.text);
  if (console.json()) return console.finish(json_text(outcome_json(outcome)));
  return console.quiet() ? int{kExitDone} : console.finish(outcome_text(outcome, command.output));
}

}  // namespace mesocell
