#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <initializer_list>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "converters/cli/batch.h"
#include "converters/cli/batch_plan.h"
#include "converters/cli/color_source.h"
#include "converters/cli/commands.h"
#include "converters/cli/convert_plan.h"
#include "converters/cli/export.h"
#include "converters/cli/progress_bar.h"
#include "converters/cli/repack.h"
#include "converters/cli/repair_report.h"
#include "converters/cli/representations.h"
#include "converters/cli/restore.h"
#include "converters/cli/shape_source.h"
#include "converters/export/basic_mesh.h"
#include "format/cell_object_io.h"
#include "format/file.h"
#include "sdk/surface/normals.h"

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

struct Made {
  AssetFile file;
  AuthorReport report;
  ReadNotes notes;
  Seconds seconds;
};

/// Everything on the surface of the object; the metadata says what it was made of.
std::optional<Failure> add_surface(const ConvertCommand& command, const ConvertPlan& plan, SourcedTile& tile,
                                   const ShapeSource& shape, const AuthorReport& report,
                                   const Progress& progress, CellObject& object) {
  object.metadata = shape.metadata();
  if (!tile.color_recipe.empty()) object.metadata.emplace_back("color", tile.color_recipe);
  if (report.repair.rung != RepairRung::kNone)
    object.metadata.emplace_back("repair", repair_text(report.repair));
  if (plan.author.solid != SolidRule::kNonzero && !shape.surface().triangles.empty())
    object.metadata.emplace_back("solid", *command.solid);
  object.metadata.emplace_back("tile", tile.recipe);
  object.metadata.insert(object.metadata.end(), plan.metadata.begin(), plan.metadata.end());
  std::sort(object.metadata.begin(), object.metadata.end());
  if (Status status = apply_colors(std::move(tile.colors), object, plan.author.threads, &progress); !status)
    return Failure{status.error(), command.input};
  object.normals = std::move(tile.normals);
  if (!command.normals || object.normals) return std::nullopt;
  object.normals = make_normal_map(object.tile, plan.author.threads, &progress);
  if (!object.normals) return Failure{Error{ErrorCode::kCancelled, "interrupted"}, {}};
  return std::nullopt;
}

/// Options of repair that were given though there is no mesh to be repaired; tiles have their own words.
void find_unused_repair(const ConvertCommand& command, const ShapeSource& shape,
                        std::vector<Warning>& warnings) {
  if (!shape.surface().triangles.empty() || tile_of_input(command.input)) return;
  for (const auto& [given, option] : std::initializer_list<std::pair<bool, const char*>>{
           {command.repair.has_value(), "--repair"},
           {command.solid.has_value(), "--solid"},
           {command.stitch.has_value(), "--stitch"},
           {command.thicken.has_value(), "--thicken"},
           {command.wrap_alpha.has_value(), "--wrap-alpha"},
           {command.wrap_offset.has_value(), "--wrap-offset"}})
    if (given)
      warnings.push_back({"option-unused", std::string(option) + " has no effect where there is no mesh"});
}

/// Keeps the mesh in the asset if that is wanted.
std::optional<Failure> keep_mesh(const ConvertCommand& command, const ShapeSource& shape, CellObject& object,
                                 std::vector<Warning>& warnings) {
  if (!command.keep_mesh) return std::nullopt;
  if (shape.surface().triangles.empty()) {
    warnings.push_back({"option-unused", "--keep-mesh has no effect where there is no mesh"});
    return std::nullopt;
  }
  Result<BasicMesh> mesh = compress_basic_mesh(shape.surface());
  if (!mesh) return Failure{mesh.error(), command.input};
  object.basic_mesh = std::move(*mesh);
  return std::nullopt;
}

/// Reads the shape, makes the tile, authors, writes, and reads back what was written.
std::optional<Failure> convert(const ConvertCommand& command, const Progress& progress, Made& outcome) {
  Stopwatch watch;
  ConvertPlan plan;
  if (auto failure = make_convert_plan(command, plan)) return failure;
  std::vector<Warning> warnings = std::move(plan.warnings);

  watch.lap();
  std::unique_ptr<ShapeSource> shape;
  if (auto failure = read_shape(command, progress, shape, warnings, outcome.notes)) return failure;
  find_unused_repair(command, *shape, warnings);
  outcome.seconds.read = watch.lap();

  SourcedTile tile;
  if (auto failure = make_sourced_tile(plan.tile, plan.tile_options, progress, tile)) return failure;
  warnings.insert(warnings.end(), tile.warnings.begin(), tile.warnings.end());
  outcome.notes.add(tile.notes);
  outcome.seconds.tile = watch.lap();

  // Before the longest part of the work, as the recipe may be wrong.
  if (plan.color) {
    if (auto failure = make_sourced_colors(*plan.color, tile.tile.cell_count, *shape, progress, tile.colors,
                                           warnings, outcome.notes))
      return failure;
    tile.color_recipe = to_text(without_folders(*plan.color));
  }
  const double color_seconds = watch.lap();

  Result<CellObject> object = shape->fill(std::move(tile.tile), plan.author, outcome.report, progress);
  if (!object) return Failure{object.error(), command.input};
  outcome.seconds.voxelize = outcome.report.voxelize_seconds;
  watch.lap();
  if (auto failure = add_surface(command, plan, tile, *shape, outcome.report, progress, *object))
    return failure;
  if (auto failure = keep_mesh(command, *shape, *object, warnings)) return failure;
  outcome.seconds.surface = outcome.report.surface_seconds + color_seconds + watch.lap();
  outcome.report.warnings.insert(outcome.report.warnings.begin(), warnings.begin(), warnings.end());

  watch.lap();
  const Result<std::vector<std::byte>> bytes = encode_cell_object(*object, plan.write);
  if (!bytes) return Failure{bytes.error(), command.output};
  if (progress.cancelled()) return Failure{Error{ErrorCode::kCancelled, "interrupted"}, {}};
  if (Status status = write_file(command.output, *bytes, command.no_clobber); !status)
    return Failure{status.error(), command.output};
  outcome.seconds.write = watch.lap();

  Result<AssetFile> file = read_assets(*bytes);
  if (!file) return Failure{file.error(), command.output};
  outcome.file = std::move(*file);
  outcome.seconds.total = watch.total();
  return std::nullopt;
}

/// Assets into an asset: nothing is authored.
std::optional<Failure> convert_assets(const ConvertCommand& command, const Progress& progress,
                                      Made& outcome) {
  Stopwatch watch;
  if (auto failure = is_repack(command) ? repack(command, progress, outcome.file)
                                        : restore(command, progress, outcome.file))
    return failure;
  const bool given = command.tiles || command.tile_size || !command.box.empty() || command.tile ||
                     command.rule || command.percolating || command.repair || command.solid ||
                     command.stitch || command.thicken || command.wrap_alpha || command.wrap_offset ||
                     command.color || command.normals;
  if (given)
    outcome.report.warnings.push_back(
        {"option-unused",
         "only --codec, --meta, --target-version and --no-clobber have an effect on assets"});
  outcome.seconds.total = watch.total();
  return std::nullopt;
}

nlohmann::ordered_json outcome_json(const Made& outcome) {
  nlohmann::ordered_json json = describe_assets(outcome.file);
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
  json["files"] = outcome.notes.files;
  json["losses"] = outcome.notes.losses;
  // Where there is no mesh there is nothing to diagnose.
  if (outcome.report.diagnosis.triangles > 0) {
    json["diagnosis"] = diagnosis_json(outcome.report.diagnosis);
    json["repair"] = repair_json(outcome.report.repair);
  }
  json["volume"]["mesh"] = outcome.report.mesh_volume;
  json["volume"]["inside"] = outcome.report.inside_volume;
  return json;
}

std::string outcome_text(const Made& outcome, const std::string& output) {
  char text[128], share[64] = "";
  if (outcome.report.mesh_volume > 0)
    std::snprintf(share, sizeof share, ", %.2f %% of the mesh's volume inside",
                  100 * outcome.report.inside_volume / outcome.report.mesh_volume);
  std::snprintf(text, sizeof text, ": %.2f MB in %.1f s (peak memory %.0f MB)",
                double(outcome.file.file_bytes) * 1e-6, outcome.seconds.total, double(peak_bytes()) * 1e-6);
  std::string lines = printable(output) + text + share + "\n";
  for (const std::string& loss : outcome.notes.losses) lines += "  not kept: " + printable(loss) + "\n";
  return lines;
}

}  // namespace

int run_convert(const ConvertCommand& command) {
  end_with_batch();
  if (is_batch(command)) return run_batch(command);
  if (is_export(command)) return run_export(command);
  const Console console(command.common);
  ProgressBar bar(!console.quiet());
  Made outcome;
  const std::optional<Failure> failure = is_repack(command) || is_restore(command)
                                             ? convert_assets(command, bar.progress(), outcome)
                                             : convert(command, bar.progress(), outcome);
  bar.finish();
  const MeshDiagnosis& diagnosis = outcome.report.diagnosis;
  if (failure && diagnosis.triangles > 0)
    return console.fail_with(*failure, {{"diagnosis", diagnosis_json(diagnosis)}});
  if (failure) return console.fail(*failure);
  if (outcome.report.repair.rung != RepairRung::kNone)
    for (const MeshFinding& finding : findings(diagnosis)) console.warn(command.input, describe(finding));
  for (const Warning& warning : outcome.report.warnings) console.warn(command.input, warning.text);
  if (console.json()) return console.finish(json_text(outcome_json(outcome)));
  return console.quiet() ? int{kExitDone} : console.finish(outcome_text(outcome, command.output));
}

}  // namespace mesocell
