#include "converters/cli/bench.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "converters/bench/bench_sets.h"
#include "converters/bench/bench_table.h"
#include "converters/bench/machine.h"
#include "converters/cli/commands.h"
#include "converters/cli/progress_bar.h"
#include "converters/cli/representations.h"
#include "converters/cli/values.h"
#include "format/cell_object_io.h"
#include "format/file.h"
#include "sdk/core/parallel.h"
#include "sdk/core/shapes.h"

namespace mesocell {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kDefaultSet = "default";

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// The words of an option that was given; errors: kUsage if there are none.
std::optional<Failure> replace(const char* option, const std::optional<std::string>& list,
                               std::vector<std::string>& words) {
  if (!list) return std::nullopt;
  words = words_of(*list);
  if (words.empty()) return usage(option, "it names nothing; see mesocell bench --help");
  return std::nullopt;
}

/// The set with what the command line says put in its place.
std::optional<Failure> make_set(const BenchCommand& command, BenchSet& set) {
  Result<BenchSet> found = find_bench_set(command.set.value_or(kDefaultSet));
  if (!found) return Failure{found.error(), "--set"};
  set = std::move(*found);
  if (command.input && command.scenes)
    return usage("--scenes", "they are measured, or the --input is; leave one of them out");
  if (command.scenes || command.input || command.cameras) {
    set.more_scenes.clear();
    set.more_views.clear();
  }
  if (auto failure = replace("--scenes", command.scenes, set.scenes)) return failure;
  if (command.input) set.scenes = {""};
  if (auto failure = replace("--cameras", command.cameras, set.views)) return failure;
  if (auto failure = replace("--methods", command.methods, set.methods)) return failure;
  std::vector<std::string> rays;
  if (auto failure = replace("--rays", command.rays, rays)) return failure;
  if (rays.empty()) return std::nullopt;
  set.rays.clear();
  set.first_rays.clear();
  set.primary_only.clear();
  for (const std::string& word : rays) {
    const auto kind = find_ray_set(word);
    if (!kind)
      return usage("--rays",
                   "there are no rays '" + word + "'; there are primary, diffuse, reflection and shadow");
    set.rays.push_back(*kind);
  }
  return std::nullopt;
}

std::optional<Failure> parse_threads(const BenchCommand& command, std::vector<unsigned>& threads) {
  if (!command.threads) return std::nullopt;
  threads.clear();
  for (const std::string& word : words_of(*command.threads)) {
    unsigned n = 0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), n);
    if (status != std::errc() || end != word.data() + word.size() || n > 1024)
      return usage("--threads",
                   "'" + word + "' is no number from 0 to 1024; write for example --threads 1,2");
    threads.push_back(n);
  }
  if (threads.empty()) return usage("--threads", "it names no number; write for example --threads 1,2");
  return std::nullopt;
}

std::optional<Failure> read_object(const std::string& path, std::optional<BenchObject>& object) {
  CellObject read;
  if (auto failure = read_named_object(path, read)) return failure;
  object = BenchObject{path.substr(path.rfind('/') + 1), std::move(read)};
  return std::nullopt;
}

BenchHead make_head(const BenchCommand& command, const BenchOptions& options, const Machine& machine) {
  std::string threads;
  for (const unsigned t : options.timing.threads)
    threads += (threads.empty() ? "" : ", ") + std::to_string(resolve_threads(t));
  char memory[32];
  std::snprintf(memory, sizeof memory, "%.1f GB", double(machine.memory_bytes) * 1e-9);
  return {{"program", std::string("mesocell bench ") + MESOCELL_VERSION},
          {"date", date_now()},
          {"set", command.set.value_or(kDefaultSet)},
          {"processor", machine.processor},
          {"cores", std::to_string(machine.cores)},
          {"memory", memory},
          {"compiler", machine.compiler},
          {"threads", threads},
          {"size", std::to_string(options.size[0]) + "x" + std::to_string(options.size[1])},
          {"seed", std::to_string(options.seed)},
          {"errors", "of exact against brute force on " + std::to_string(options.oracle_rays) +
                         " rays of each case, of others against exact on all rays traced"}};
}

Json result_json(const BenchHead& head, const BenchResult& result) {
  Json json{{"head", Json::object()}, {"rows", Json::array()}, {"notes", result.notes}};
  for (const auto& [name, text] : head)
    if (name != "note") json["head"][name] = text;
  for (const BenchRow& row : result.rows) {
    Json entry = Json::object();
    for (const BenchColumn& c : bench_columns()) {
      const std::string text = c.text(row);
      // What is empty or infinite is no number of JSON.
      const Json value = c.is_text ? Json(text) : Json::parse(text, nullptr, false);
      entry[std::string(c.name)] = value.is_discarded() ? Json(nullptr) : value;
    }
    json["rows"].push_back(std::move(entry));
  }
  json["exact_differs"] = result.exact_differs;
  return json;
}

std::optional<Failure> make_options(const BenchCommand& command, const BenchSet& set, const Machine& machine,
                                    BenchOptions& options) {
  options.methods = set.methods;
  options.skip_missing = !command.methods;
  const Result<std::array<std::uint32_t, 2>> size = parse_size(command.size);
  if (!size) return Failure{size.error(), "--size"};
  options.size = *size;
  if (auto failure = parse_threads(command, options.timing.threads)) return failure;
  options.timing.repeat = command.repeat;
  options.timing.pass_seconds = set.pass_seconds;
  options.seed = command.seed;
  options.oracle_rays = command.oracle;
  options.max_seconds = command.max_seconds.value_or(set.max_seconds);
  options.max_peer_bytes = std::min(machine.memory_bytes / 3, set.max_peer_bytes);
  return std::nullopt;
}

}  // namespace

std::string bench_help() {
  std::string text =
      "Sets: quick, below a minute; default, below ten: every shape, every tile, several sizes; full: "
      "everything, hours. The other options replace what the set says.\n\n"
      "Scenes: SHAPE-TILE-TILESxRESOLUTION, both numbers from 4 to 256, such as wavy-voronoi-64x32; "
      "shapes:\n";
  for (const Shape& shape : shapes())
    text += "  " + std::string(shape.name) + ": " + std::string(shape.description) + "\n";
  text += "tiles:\n";
  for (const BenchTile& tile : bench_tiles())
    text += "  " + std::string(tile.name) + ": " + std::string(tile.recipe) + "\n";
  text +=
      "\nCameras: full, all of it; cover90, as near as nine tenths of the picture are covered; close, 1.5 "
      "tiles "
      "away; grazing, or grazing-A at A degrees; inside, from an empty place of its box.\n\n"
      "Rays: primary; diffuse, one from every first hit by the cosine; reflection; shadow, to a light.\n\n"
      "Methods: " +
      joined(bench_methods()) +
      "; steps S of linear:S are in tile edges. A set leaves out what is not there.\n\n"
      "Only tracing is timed, methods take turns, and the median of the passes is told. Every hit of every "
      "pass is compared with that of exact tracing, and a sample of that with brute force: if exact tracing "
      "is "
      "wrong anywhere the exit code is 1. A method that is too slow for all rays traces a part of them, "
      "evenly spread; ray_count tells.\n\n"
      "Columns of --csv, and keys of the rows of --json {head, rows, notes, exact_differs}:\n";
  for (const BenchColumn& c : bench_columns())
    text += (&c == bench_columns().data() ? "  " : ", ") + std::string(c.name);
  return text +
         "\nBytes are those of the scene and what speeds it up; depth errors are in voxels, over rays that "
         "both "
         "hit; miss_rate is of what exact tracing hits, false_hit_rate of what it misses; angles are in "
         "degrees, angle_degrees between rays and the surfaces they hit, of a grazing camera the plane that "
         "it grazes; what is not known is empty.\n\n"
         "Example:\n  mesocell bench --set quick --csv quick.csv\n"
         "  mesocell bench --scenes wavy-voronoi-16x32,wavy-voronoi-32x32,wavy-voronoi-64x32 --cameras full "
         "--rays primary --methods exact --threads 1,2\n"
         "  mesocell bench --input bunny.meso --cameras full,inside --methods exact,linear:1/256 --json\n";
}

int run_bench_command(const BenchCommand& command) {
  const Console console(command.common);
  const Machine machine = this_machine();
  BenchSet set;
  BenchOptions options;
  if (const auto failure = make_set(command, set)) return console.fail(*failure);
  if (const auto failure = make_options(command, set, machine, options)) return console.fail(*failure);
  const Result<std::vector<BenchCase>> cases = bench_cases(set);
  if (!cases) return console.fail(cases.error(), "");
  if (!options.skip_missing)
    for (const std::string& method : options.methods)
      if (const Status status = try_method(method); !status) return console.fail(status.error(), "--methods");
  if (!command.csv.empty())
    if (const Status status = check_output(command.csv, command.no_clobber); !status)
      return console.fail(status.error(), command.csv);
  std::optional<BenchObject> object;
  if (command.input)
    if (const auto failure = read_object(*command.input, object)) return console.fail(*failure);

  ProgressBar bar(!console.quiet());
  const Result<BenchResult> result = run_bench(*cases, object, options, bar.progress());
  bar.finish();
  if (!result) return console.fail(result.error(), "");
  BenchHead head = make_head(command, options, machine);
  head.emplace_back("exact differs", "for " + std::to_string(result->exact_differs) + " rays");
  for (const std::string& note : result->notes) head.emplace_back("note", note);
  if (!command.csv.empty()) {
    const std::string csv = bench_csv(head, result->rows);
    if (const Status status = write_file(command.csv, std::as_bytes(std::span(csv)), command.no_clobber);
        !status)
      return console.fail(status.error(), command.csv);
  }
  if (result->exact_differs > 0)
    console.warn("exact",
                 "of the rays that were checked it did not find what brute force finds, or not every "
                 "time, for " +
                     std::to_string(result->exact_differs));
  const int code = result->exact_differs > 0 ? kExitCheckFailed : kExitDone;
  if (console.json()) return console.finish(json_text(result_json(head, *result)), code);
  return console.finish(console.quiet() ? "" : bench_markdown(head, result->rows), code);
}

}  // namespace mesocell
