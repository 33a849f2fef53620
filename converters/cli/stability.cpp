#include "converters/cli/stability.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>

#include "converters/cli/commands.h"
#include "converters/cli/progress_bar.h"
#include "converters/cli/stability_output.h"
#include "converters/cli/values.h"
#include "converters/import/mesh_file.h"
#include "converters/stability/damage.h"
#include "converters/stability/report.h"
#include "sdk/membership/diagnose.h"

namespace mesocell {
namespace {

using Json = nlohmann::ordered_json;

/// Voxels along the longest side of a case of the catalogue: all of it takes about two minutes.
constexpr std::uint32_t kUsualResolution = 32;

std::optional<Failure> find_methods(const std::string& list, std::vector<const Voxelizer*>& methods) {
  for (const std::string& word : words_of(list)) {
    const Voxelizer* const method = find_voxelizer(word);
    if (!method)
      return usage("--methods", "there is no method '" + word + "'; there are " + voxelizer_names());
    methods.push_back(method);
  }
  if (methods.empty())
    for (const Voxelizer& v : voxelizers()) methods.push_back(&v);
  return std::nullopt;
}

/// "meshes/knot.off" gives "knot".
std::string mesh_name(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string file = slash == path.npos ? path : path.substr(slash + 1);
  return file.substr(0, file.rfind('.'));
}

std::optional<Failure> read_mesh(const std::string& path, const Progress& progress, TriangleMesh& mesh) {
  Result<TriangleMesh> read = read_mesh_file(path, {}, nullptr, &progress);
  if (!read) return Failure{read.error(), path};
  mesh = std::move(read).value();
  const Vec3 extent = bounding_box(mesh).extent();
  if (!(extent.x > 0 && extent.y > 0 && extent.z > 0 && length(extent) < 1e100))
    return Failure{
        Error{ErrorCode::kInvalidInput, "it is flat or too large; give a mesh that encloses something"},
        path};
  return std::nullopt;
}

/// The meshes that were named, else generated ones.
std::optional<Failure> read_meshes(const StabilityCommand& command, const Progress& progress,
                                   std::uint32_t detail, std::vector<NamedMesh>& meshes,
                                   std::vector<MeshPair>& pairs) {
  for (const std::string& path : command.meshes) {
    NamedMesh named{mesh_name(path), {}};
    if (auto failure = read_mesh(path, progress, named.mesh)) return failure;
    if (const MeshDiagnosis diagnosis = diagnose(named.mesh); !diagnosis.closed())
      return Failure{Error{ErrorCode::kInvalidInput,
                           "what is truly inside is not known: " + describe(diagnosis) +
                               "; give a closed mesh, or this one and a sound twin by --pair",
                           "mesh-not-closed"},
                     path};
    meshes.push_back(std::move(named));
  }
  for (std::size_t k = 0; k + 1 < command.pairs.size(); k += 2) {
    MeshPair pair{mesh_name(command.pairs[k]), {}, {}};
    if (auto failure = read_mesh(command.pairs[k], progress, pair.broken)) return failure;
    if (auto failure = read_mesh(command.pairs[k + 1], progress, pair.sound)) return failure;
    if (const MeshDiagnosis diagnosis = diagnose(pair.sound); !diagnosis.closed())
      return Failure{
          Error{ErrorCode::kInvalidInput, "the second mesh of a pair must be sound: " + describe(diagnosis),
                "mesh-not-closed"},
          command.pairs[k + 1]};
    pairs.push_back(std::move(pair));
  }
  if (meshes.empty() && (pairs.empty() || !command.benchmark)) meshes = clean_meshes(detail);
  return std::nullopt;
}

/// Whether a list of words, all if it is empty, names a case.
bool wanted(const std::vector<std::string>& words, const StabilityCase& c) {
  return words.empty() || std::ranges::any_of(words, [&](const std::string& word) {
           return c.row().starts_with(word) || c.group == word;
         });
}

std::optional<Failure> make_cases(const StabilityCommand& command, const Progress& progress,
                                  std::vector<StabilityCase>& cases) {
  std::vector<NamedMesh> meshes;
  std::vector<MeshPair> pairs;
  if (auto failure = read_meshes(command, progress, 1, meshes, pairs)) return failure;
  const std::uint32_t resolution = command.resolution.value_or(kUsualResolution);
  cases = damage_cases(meshes, resolution);
  if (command.meshes.empty()) std::ranges::move(geometry_cases(resolution), std::back_inserter(cases));
  for (const MeshPair& pair : pairs) cases.push_back(pair_case(pair, resolution));
  std::string names;
  for (const StabilityCase& c : cases)
    if (("," + names + ",").find("," + c.name + ",") == std::string::npos)
      names += (names.empty() ? "" : ",") + c.name;
  std::erase_if(cases,
                [words = words_of(command.cases)](const StabilityCase& c) { return !wanted(words, c); });
  if (cases.empty())
    return usage("--cases", "no case begins with '" + command.cases + "'; there are " + names +
                                ", and the groups clean, damage, geometry, pair");
  return std::nullopt;
}

Json cell_json(const StabilityTable::Cell& cell) {
  if (cell.failed || cell.too_long) return {{"outcome", cell.failed ? "failed" : "too-long"}};
  return {{"outcome", "done"},
          {"wrong", cell.voxels.wrong},
          {"wrong_far", cell.voxels.wrong_far},
          {"inside", cell.voxels.inside},
          {"far", cell.voxels.far},
          {"voxels", cell.voxels.voxels},
          {"wrong_percent", cell.voxels.wrong_percent()},
          {"wrong_far_percent", cell.voxels.wrong_far_percent()},
          {"seconds", cell.seconds}};
}

Json table_json(const StabilityTable& table) {
  Json json{{"kind", "voxelize"}, {"methods", table.methods}, {"cases", Json::array()}};
  for (const StabilityTable::Row& row : table.rows) {
    Json entry{{"group", row.group}, {"case", row.name}, {"results", Json::object()}};
    for (std::size_t m = 0; m < table.methods.size(); ++m)
      if (row.cells[m].measured) entry["results"][table.methods[m]] = cell_json(row.cells[m]);
    json["cases"].push_back(std::move(entry));
  }
  return json;
}

Json benchmark_json(std::span<const StabilityResult> results) {
  Json json{{"kind", "voxelize-benchmark"}, {"results", Json::array()}};
  for (const StabilityResult& r : results) {
    Json entry{{"mesh", r.mesh}, {"case", r.row()}, {"size", r.size}, {"method", r.method}};
    entry.update(cell_json({.measured = true,
                            .too_long = r.run.outcome == RunOutcome::kTooLong,
                            .failed = r.run.outcome == RunOutcome::kFailed,
                            .voxels = r.voxels,
                            .seconds = r.run.seconds}));
    entry["cpu_seconds"] = r.run.cpu_seconds;
    entry["memory_bytes"] = r.run.memory_bytes;
    json["results"].push_back(std::move(entry));
  }
  return json;
}

std::optional<Failure> check(const StabilityCommand& command) {
  if (command.pairs.size() % 2)
    return usage("--pair", "'" + command.pairs.back() +
                               "' is alone; give two files, the broken mesh and the sound one");
  if (command.benchmark && !command.picture.empty())
    return usage("--picture", "--benchmark has no heat map; leave one of them out");
  if (command.benchmark && command.resolution)
    return usage("--resolution", "--benchmark takes --sizes instead, such as --sizes 256,512");
  if (command.rays) return usage("--rays", "it is for --cast; leave it out");
  if (!command.benchmark && command.sizes)
    return usage("--sizes", "it is for --benchmark; the catalogue takes --resolution");
  return check_stability_outputs(command);
}

std::string caption_of(const StabilityCommand& command) {
  return std::to_string(command.resolution.value_or(kUsualResolution)) + " voxels along the longest side; " +
         (command.meshes.empty() ? "generated meshes" : "meshes given") +
         ", figures of several meshes are joined";
}

int run_catalogue(const StabilityCommand& command, const Console& console,
                  std::span<const Voxelizer* const> methods) {
  ProgressBar bar(!console.quiet());
  std::vector<StabilityCase> cases;
  if (const auto failure = make_cases(command, bar.progress(), cases)) return console.fail(*failure);
  const MeasureOptions options{.threads = command.common.threads,
                               .max_seconds = command.max_seconds.value_or(5)};
  const Result<std::vector<StabilityResult>> results =
      measure_stability(cases, methods, options, &bar.progress());
  bar.finish();
  if (!results) return console.fail(results.error(), "");
  const StabilityTable table = tabulate(*results);
  const std::string markdown = stability_markdown(table);
  if (const auto failure = write_stability(command, stability_csv(*results), markdown,
                                           stability_heat_map(table, caption_of(command))))
    return console.fail(*failure);
  if (console.json()) return console.finish(table_json(table).dump(2) + "\n");
  return console.finish(console.quiet() ? "" : markdown);
}

std::optional<Failure> parse_sizes(const StabilityCommand& command, std::vector<std::uint32_t>& sizes) {
  for (const std::string& word : words_of(command.sizes.value_or("256,512,1024"))) {
    std::uint32_t size = 0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), size);
    if (status != std::errc() || end != word.data() + word.size() || size < 16 || size > 2048)
      return usage("--sizes",
                   "'" + word + "' is no number from 16 to 2048; write for example --sizes 256,512");
    sizes.push_back(size);
  }
  if (sizes.empty()) return usage("--sizes", "it names no size; write for example --sizes 256,512");
  return std::nullopt;
}

int run_benchmark(const StabilityCommand& command, const Console& console,
                  std::vector<const Voxelizer*> methods) {
  if (command.methods.empty()) {
    methods.clear();
    for (const char* name : {"signed-count", "openvdb", "ours"}) methods.push_back(find_voxelizer(name));
  }
  std::vector<std::uint32_t> sizes;
  if (const auto failure = parse_sizes(command, sizes)) return console.fail(*failure);
  ProgressBar bar(!console.quiet());
  std::vector<NamedMesh> meshes;
  std::vector<MeshPair> pairs;
  if (const auto failure = read_meshes(command, bar.progress(), 4, meshes, pairs))
    return console.fail(*failure);
  std::vector<StabilityCase> cases;
  for (const std::uint32_t size : sizes) {
    std::ranges::move(benchmark_cases(meshes, size), std::back_inserter(cases));
    for (const MeshPair& pair : pairs) cases.push_back(pair_case(pair, size));
  }
  std::erase_if(cases,
                [words = words_of(command.cases)](const StabilityCase& c) { return !wanted(words, c); });
  if (cases.empty())
    return console.fail(
        usage("--cases", "no case of --benchmark begins so; there are clean, holes and pair"));
  const MeasureOptions options{.threads = command.common.threads,
                               .max_seconds = command.max_seconds.value_or(600),
                               .repeat = command.repeat};
  const Result<std::vector<StabilityResult>> results =
      measure_stability(cases, methods, options, &bar.progress());
  bar.finish();
  if (!results) return console.fail(results.error(), "");
  const std::string markdown = benchmark_markdown(*results);
  if (const auto failure = write_stability(command, stability_csv(*results), markdown, ""))
    return console.fail(*failure);
  if (console.json()) return console.finish(benchmark_json(*results).dump(2) + "\n");
  return console.finish(console.quiet() ? "" : markdown);
}

}  // namespace

std::string stability_methods_help() {
  return "Methods: of --voxelize " + voxelizer_names() + "; of --cast " + cast_method_names() + " [all]";
}

std::string stability_help() {
  std::string text = "Methods of --voxelize:\n";
  for (const Voxelizer& v : voxelizers()) text += "  " + std::string(v.name) + ": " + v.description + "\n";
  text += "\nDamage:\n";
  for (const Damage& d : damages())
    text += "  " + std::string(d.name) + ": " + d.description + "; strength in parts " + d.unit + "\n";
  return text + "\nMethods of --cast:\n" + cast_methods_help() +
         "\nWhat is truly inside is decided on the sound mesh: where its winding number is not 0, exactly. "
         "Each method "
         "runs in a process of its own; one that fails or takes too long is told as such.\n\n"
         "Keys of --json: kind, methods, cases [group, case, results {METHOD {outcome (done, failed, "
         "too-long), wrong, "
         "wrong_far (over two voxels from the true surface), inside, far, voxels (of the grid), "
         "wrong_percent (of "
         "inside), wrong_far_percent (of far), seconds}}]; of --benchmark: kind, results [mesh, case, size, "
         "method, "
         "cpu_seconds, memory_bytes and the same]; of --cast: kind, methods, holds (whether exact does), "
         "cases "
         "[group, case, results {METHOD {verdict (holds, fails, fails as the source predicts), rays, hits, "
         "missed, "
         "wrong_cell, off (a hit that is over 1/16 voxel from the true one), false_hits, wrong_percent (of "
         "rays), "
         "miss_rate (of hits), false_hit_rate (of the others), depth_error_mean, depth_error_p99, "
         "depth_error_max "
         "(voxels), steps (of all rays)}}]. --cast exits with 1 if exact does not hold.\n\n"
         "Example:\n  mesocell stability --voxelize --csv table.csv --markdown table.md --picture table.svg\n"
         "  mesocell stability --voxelize --mesh bunny.off --cases holes,clean --methods openvdb,ours\n"
         "  mesocell stability --voxelize --pair elephant-with-holes.off elephant.off --cases pair\n"
         "  mesocell stability --voxelize --benchmark --mesh bunny.off --sizes 256,512,1024\n"
         "  mesocell stability --cast --csv cast.csv --picture cast.svg\n";
}

int run_stability(const StabilityCommand& command) {
  const Console console(command.common);
  if (command.voxelize == command.cast)
    return console.fail(usage("stability", "say what to test: mesocell stability --voxelize or --cast"));
  if (command.cast) return run_cast_stability(command, console);
  if (const auto failure = check(command)) return console.fail(*failure);
  std::vector<const Voxelizer*> methods;
  if (const auto failure = find_methods(command.methods, methods)) return console.fail(*failure);
  return command.benchmark ? run_benchmark(command, console, methods)
                           : run_catalogue(command, console, methods);
}

}  // namespace mesocell
