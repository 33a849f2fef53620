#include "converters/bench/chart.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "converters/bench/gnuplot.h"
#include "converters/cli/commands.h"
#include "converters/cli/interrupt.h"
#include "format/file.h"

namespace mesocell {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20;

std::optional<Failure> parse(const ChartCommand& command, ChartRows& rows, ChartPicture& picture) {
  const bool svg = has_extension(command.output, ".svg");
  picture.png = has_extension(command.output, ".png");
  if (!svg && !picture.png)
    return usage(command.output,
                 "it is neither .svg nor .png; give the picture's name one of these extensions");
  if (command.chart != "all") {
    picture.pareto = command.chart == "pareto";
    picture.memory = command.chart == "memory";
    picture.steps = command.chart == "steps";
    if (!picture.pareto && !picture.memory && !picture.steps)
      return usage("--chart",
                   "there is no chart '" + command.chart + "'; there are pareto, memory, steps and all");
  }
  if (command.error != "wrong" && command.error != "depth")
    return usage("--error", "there is no error '" + command.error + "'; there are wrong and depth");
  rows = {.scene = command.scene,
          .camera = command.camera,
          .rays = command.rays,
          .threads = command.threads,
          .error = command.error == "depth" ? ChartError::kDepth : ChartError::kWrong};
  return std::nullopt;
}

Result<TextTable> read_table(const std::string& path) {
  const Result<std::vector<std::byte>> bytes = read_input(path, kMostBytes);
  if (!bytes && bytes.error().code == ErrorCode::kLimit)
    return Error{ErrorCode::kInvalidInput,
                 "it has over " + std::to_string(kMostBytes >> 20) +
                     " MiB, which no benchmark writes; give the CSV of mesocell bench"};
  if (!bytes) return bytes.error();
  return parse_table({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
}

Json range_json(const ChartRange& range) {
  return {{"median", range.median}, {"min", range.low}, {"max", range.high}};
}

Json chart_json(const Chart& chart, const std::string& output) {
  Json json{{"output", output}, {"subject", chart.subject}, {"methods", Json::array()}};
  for (const ChartMethod& m : chart.methods) {
    Json steps = Json::array();
    for (const auto& [angle, count] : m.steps)
      steps.push_back({{"angle_degrees", angle}, {"steps_per_ray", count}});
    json["methods"].push_back({{"method", m.name},
                               {"rows", m.rows},
                               {"rays_per_second", range_json(m.speed)},
                               {"peak_bytes", range_json(m.memory)},
                               {"error", range_json(m.error)},
                               {"steps", std::move(steps)}});
  }
  return json;
}

}  // namespace

int run_chart(const ChartCommand& command) {
  const Console console({.json = command.json, .quiet = command.quiet});
  ChartRows rows;
  ChartPicture picture;
  if (const auto failure = parse(command, rows, picture)) return console.fail(*failure);
  const Result<TextTable> table = read_table(command.input);
  if (!table) return console.fail(table.error(), command.input);
  if (same_file(command.input, command.output))
    return console.fail(usage(command.output, "it is the input as well; give the picture another name"));
  if (const Status status = check_output(command.output, command.no_clobber); !status)
    return console.fail(status.error(), command.output);
  const Result<Chart> chart = make_chart(*table, rows);
  if (!chart) return console.fail(chart.error(), command.input);
  if (chart->steps_scene.empty() && picture.steps) {
    if (!picture.pareto)
      return console.fail(
          Error{ErrorCode::kInvalidInput,
                "no scene tells of steps_per_ray at two of angle_degrees; chart more cameras"},
          command.input);
    console.warn(command.input,
                 "no scene tells of steps_per_ray at two of angle_degrees: steps are left out");
  }
  const Progress progress{.report = nullptr, .cancel = &cancel_flag()};
  const Result<std::vector<std::byte>> bytes = run_gnuplot(chart_script(*chart, picture), &progress);
  if (!bytes) return console.fail(bytes.error(), command.output);
  if (const Status status = write_file(command.output, *bytes, command.no_clobber); !status)
    return console.fail(status.error(), command.output);
  if (console.json()) return console.finish(chart_json(*chart, command.output).dump(2) + "\n");
  return console.finish("");
}

}  // namespace mesocell
