#include <algorithm>
#include <nlohmann/json.hpp>

#include "converters/cli/exit_codes.h"
#include "converters/cli/progress_bar.h"
#include "converters/cli/stability_output.h"
#include "converters/cli/values.h"
#include "converters/stability/cast_report.h"
#include "sdk/trace/cell_object_caster.h"

namespace mesocell {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kRays = 4096;

/// Options of --voxelize that --cast does not have.
std::optional<Failure> check_cast(const StabilityCommand& command) {
  const std::pair<const char*, bool> others[] = {
      {"--benchmark", command.benchmark},     {"--resolution", command.resolution.has_value()},
      {"--mesh", !command.meshes.empty()},    {"--pair", !command.pairs.empty()},
      {"--sizes", command.sizes.has_value()}, {"--max-seconds", command.max_seconds.has_value()},
      {"--repeat", command.repeat != 1},
  };
  for (const auto& [name, given] : others)
    if (given) return usage(name, "it is for --voxelize; leave it out");
  return check_stability_outputs(command);
}

/// The methods that are named, all that this build knows if none is. `object`: any.
std::optional<Failure> find_methods(const StabilityCommand& command, const Console& console,
                                    const CellObject& object, std::vector<CastMethod>& methods) {
  for (const std::string& word : words_of(command.methods)) {
    const auto found =
        std::ranges::find_if(cast_methods(), [&](const CastMethod& m) { return m.name == word; });
    if (found == cast_methods().end())
      return usage("--methods", "there is no method '" + word + "'; there are " + cast_method_names());
    methods.push_back(*found);
  }
  if (methods.empty()) methods.assign(cast_methods().begin(), cast_methods().end());
  std::erase_if(methods, [&](const CastMethod& m) {
    const bool known = make_cell_object_caster(object, m.name).ok();
    if (!known) console.warn("--methods", std::string(m.name) + " is not in this build and left out");
    return !known;
  });
  if (methods.empty()) return usage("--methods", "none of them is in this build");
  return std::nullopt;
}

std::optional<Failure> find_cases(const StabilityCommand& command, std::vector<CastCase>& cases) {
  cases = cast_cases(command.rays.value_or(kRays));
  std::string names;
  for (const CastCase& c : cases)
    if (("," + names + ",").find("," + c.name + ",") == std::string::npos)
      names += (names.empty() ? "" : ",") + c.name;
  std::erase_if(cases, [words = words_of(command.cases)](const CastCase& c) {
    return !words.empty() && std::ranges::none_of(words, [&](const std::string& word) {
      return c.row().starts_with(word) || c.group == word;
    });
  });
  if (cases.empty())
    return usage("--cases", "no case begins with '" + command.cases + "'; there are " + names +
                                ", and the groups thin, gaps, grazing, far, along, light");
  return std::nullopt;
}

Json result_json(const CastResult& r) {
  const CastErrors& e = r.errors;
  return {{"verdict", verdict_name(r.verdict)},
          {"rays", e.rays},
          {"hits", e.hits},
          {"missed", e.missed},
          {"wrong_cell", e.wrong_cell},
          {"off", e.off},
          {"false_hits", e.false_hits},
          {"wrong_percent", e.wrong_percent()},
          {"miss_rate", e.miss_rate()},
          {"false_hit_rate", e.false_hit_rate()},
          {"depth_error_mean", e.depth_mean},
          {"depth_error_p99", e.depth_p99},
          {"depth_error_max", e.depth_max},
          {"steps", e.steps}};
}

Json to_json(std::span<const CastResult> results, std::span<const CastMethod> methods, bool holds) {
  Json json{{"kind", "cast"}, {"methods", Json::array()}, {"holds", holds}, {"cases", Json::array()}};
  for (const CastMethod& m : methods) json["methods"].push_back(m.name);
  for (std::size_t k = 0; k < results.size(); ++k) {
    const CastResult& r = results[k];
    if (k % methods.size() == 0)
      json["cases"].push_back({{"group", r.group}, {"case", r.row()}, {"results", Json::object()}});
    json["cases"].back()["results"][r.method] = result_json(r);
  }
  return json;
}

}  // namespace

std::string cast_method_names() {
  std::string names;
  for (const CastMethod& m : cast_methods()) names += (names.empty() ? "" : ", ") + std::string(m.name);
  return names;
}

std::string cast_methods_help() {
  std::string text;
  for (const CastMethod& m : cast_methods()) text += "  " + std::string(m.name) + ": " + m.description + "\n";
  return text;
}

int run_cast_stability(const StabilityCommand& command, const Console& console) {
  if (const auto failure = check_cast(command)) return console.fail(*failure);
  std::vector<CastCase> cases;
  if (const auto failure = find_cases(command, cases)) return console.fail(*failure);
  std::vector<CastMethod> methods;
  if (const auto failure = find_methods(command, console, cases[0].object, methods))
    return console.fail(*failure);
  ProgressBar bar(!console.quiet());
  const Result<std::vector<CastResult>> results =
      measure_cast_stability(cases, methods, command.common.threads, &bar.progress());
  bar.finish();
  if (!results) return console.fail(results.error(), "");
  const std::string markdown = cast_markdown(*results);
  const std::string caption =
      std::to_string(command.rays.value_or(kRays)) +
      " rays a case, answers known in closed form; predicted: fails as the source predicts";
  if (const auto failure =
          write_stability(command, cast_csv(*results), markdown, cast_heat_map(*results, caption)))
    return console.fail(*failure);
  const bool holds = std::ranges::none_of(
      *results, [](const CastResult& r) { return r.exact && r.verdict != CastVerdict::kHolds; });
  if (!holds) console.warn("exact", "it does not hold everywhere");
  const int code = holds ? kExitDone : kExitCheckFailed;
  if (console.json()) return console.finish(to_json(*results, methods, holds).dump(2) + "\n", code);
  return console.finish(console.quiet() ? "" : markdown, code);
}

}  // namespace mesocell
