#include "converters/bench/chart.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace mesocell {
namespace {

struct Row {
  std::string scene, camera, rays, method;
  unsigned threads = 0;
  double speed = 0, memory = 0, error = 0;
  std::optional<double> steps, angle;
};

constexpr std::array<std::string_view, 9> kNeeded = {"scene",      "camera",    "rays",
                                                     "method",     "threads",   "rays_per_second",
                                                     "peak_bytes", "miss_rate", "depth_error_max"};

Error bad(const TextTable::Row& row, const std::string& text) {
  return Error{ErrorCode::kInvalidInput, "line " + std::to_string(row.line) + ": " + text};
}

/// Reads rows by the names of columns.
class RowReader {
 public:
  RowReader(const TextTable& table, ChartError error) : table_(table), error_(error) {}

  [[nodiscard]] bool only_missed() const {
    return !table_.find("hit_rate") || !table_.find("false_hit_rate");
  }

  Status read(const TextTable::Row& from, Row& row) {
    row.scene = text(from, "scene");
    row.camera = text(from, "camera");
    row.rays = text(from, "rays");
    row.method = text(from, "method");
    if (row.method.empty()) return bad(from, "it names no method");
    failure_ = {};
    const double threads = needed(from, "threads");
    row.speed = needed(from, "rays_per_second");
    row.memory = needed(from, "peak_bytes");
    const double missed = needed(from, "miss_rate");
    row.steps = optional(from, "steps_per_ray");
    row.angle = optional(from, "angle_degrees");
    // Nothing was hit: no depth is wrong.
    row.error =
        error_ == ChartError::kDepth ? optional(from, "depth_error_max").value_or(0) : wrong(from, missed);
    if (!failure_) return failure_;
    if (row.speed <= 0 || row.memory <= 0) return bad(from, "rays_per_second and peak_bytes must be above 0");
    if (threads > 1e6) return bad(from, "so many threads cannot be");
    row.threads = unsigned(threads);
    if (error_ == ChartError::kWrong && row.error > 1 + 1e-9) return bad(from, "a share of rays is above 1");
    if (row.angle && *row.angle > 90) return bad(from, "angle_degrees is above 90");
    return {};
  }

 private:
  [[nodiscard]] double wrong(const TextTable::Row& from, double missed) {
    if (only_missed()) return missed;
    const double hit = optional(from, "hit_rate").value_or(0);
    const double false_hits = optional(from, "false_hit_rate").value_or(0);
    // What does not know cells is measured by voxels.
    std::optional<double> other = optional(from, "wrong_cell_rate");
    if (!other) other = optional(from, "wrong_voxel_rate");
    return hit * (missed + (1 - missed) * other.value_or(0)) + (1 - hit) * false_hits;
  }

  [[nodiscard]] std::string text(const TextTable::Row& from, std::string_view column) const {
    return from.fields[*table_.find(column)];
  }
  std::optional<double> optional(const TextTable::Row& from, std::string_view column) {
    const auto at = table_.find(column);
    if (!at) return std::nullopt;
    const Result<std::optional<double>> number = number_at(table_, from, *at);
    if (number) return *number;
    if (failure_) failure_ = number.error();
    return std::nullopt;
  }
  double needed(const TextTable::Row& from, std::string_view column) {
    const auto number = optional(from, column);
    if (!number && failure_) failure_ = bad(from, "column " + std::string(column) + " is empty");
    return number.value_or(0);
  }

  const TextTable& table_;
  ChartError error_;
  Status failure_;
};

ChartRange range_of(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return {(values[(n - 1) / 2] + values[n / 2]) / 2, values.front(), values.back()};
}

/// Keeps rows whose text is the one wanted. Errors: kUsage with what there is.
Status keep(std::vector<Row>& rows, std::string Row::*member, const std::string& wanted, const char* what) {
  if (wanted.empty()) return {};
  std::set<std::string> there;
  for (const Row& row : rows) there.insert(row.*member);
  std::erase_if(rows, [&](const Row& row) { return row.*member != wanted; });
  if (!rows.empty()) return {};
  std::string names;
  for (const std::string& name : there)
    if (names.size() < 300) names += (names.empty() ? "" : ", ") + name;
  return Error{ErrorCode::kUsage,
               std::string("there are no rows of ") + what + " '" + wanted + "'; there are " + names};
}

Status filter(std::vector<Row>& rows, const ChartRows& wanted) {
  if (Status status = keep(rows, &Row::scene, wanted.scene, "scene"); !status) return status;
  if (Status status = keep(rows, &Row::camera, wanted.camera, "camera"); !status) return status;
  std::string rays = wanted.rays;
  if (rays.empty()) {
    const bool primary = std::ranges::any_of(rows, [](const Row& row) { return row.rays == "primary"; });
    rays = primary ? "primary" : rows.front().rays;
  }
  if (Status status = keep(rows, &Row::rays, rays, "rays"); !status) return status;
  const unsigned most = std::ranges::max(rows, {}, &Row::threads).threads;
  const unsigned threads = wanted.threads.value_or(most);
  std::erase_if(rows, [&](const Row& row) { return row.threads != threads; });
  if (rows.empty())
    return Error{ErrorCode::kUsage, "there are no rows of " + std::to_string(threads) +
                                        " threads; there are some of " + std::to_string(most)};
  return {};
}

std::string count_of(const std::set<std::string>& names, const std::string& what) {
  return names.size() == 1 ? *names.begin() : std::to_string(names.size()) + " " + what;
}

std::string subject_of(const std::vector<Row>& rows) {
  std::set<std::string> scenes, cameras;
  for (const Row& row : rows) {
    scenes.insert(row.scene);
    cameras.insert(row.camera);
  }
  return count_of(scenes, "scenes") + ", " + (cameras.size() == 1 ? "camera " : "") +
         count_of(cameras, "cameras") + ", " + rows.front().rays + " rays, " +
         std::to_string(rows.front().threads) + (rows.front().threads == 1 ? " thread" : " threads");
}

/// The scene whose steps are known at the most angles, two at least: those of several do not lie on one line.
std::string richest_scene(const std::vector<Row>& rows) {
  std::map<std::string, std::set<double>> angles;
  for (const Row& row : rows)
    if (row.steps && row.angle) angles[row.scene].insert(*row.angle);
  std::erase_if(angles, [](const auto& entry) { return entry.second.size() < 2; });
  std::string best;
  for (const Row& row : rows)  // the first of several
    if (const auto of = angles.find(row.scene); of != angles.end())
      if (best.empty() || of->second.size() > angles[best].size()) best = row.scene;
  return best;
}

}  // namespace

Result<Chart> make_chart(const TextTable& table, const ChartRows& wanted) {
  for (const std::string_view column : kNeeded)
    if (!table.find(column))
      return Error{ErrorCode::kInvalidInput,
                   "it has no column '" + std::string(column) + "'; give the CSV of mesocell bench"};
  RowReader reader(table, wanted.error);
  std::vector<Row> rows(table.rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (const Status status = reader.read(table.rows[k], rows[k]); !status) return status.error();
  if (const Status status = filter(rows, wanted); !status) return status.error();
  Chart chart;
  chart.error = wanted.error;
  chart.only_missed = reader.only_missed();
  chart.subject = subject_of(rows);
  chart.steps_scene = richest_scene(rows);
  for (const std::string& line : table.head)
    if (const std::size_t at = line.find("processor:"); at != line.npos && at <= 1 && chart.processor.empty())
      chart.processor = line.substr(std::min(line.find_first_not_of(' ', at + 10), line.size()));
  std::map<std::string, std::vector<const Row*>> methods;
  for (const Row& row : rows) methods[row.method].push_back(&row);
  if (methods.size() > 100)
    return Error{ErrorCode::kInvalidInput, "it has over 100 methods, which no picture can tell apart"};
  for (const auto& [name, of] : methods) {
    ChartMethod method;
    method.name = name;
    method.rows = of.size();
    const auto range = [&](double Row::*member) {
      std::vector<double> values;
      for (const Row* row : of) values.push_back(row->*member);
      return range_of(std::move(values));
    };
    method.speed = range(&Row::speed);
    method.memory = range(&Row::memory);
    method.error = range(&Row::error);
    std::map<double, std::vector<double>> steps;
    for (const Row* row : of)
      if (row->steps && row->angle && row->scene == chart.steps_scene)
        steps[*row->angle].push_back(*row->steps);
    for (auto& [angle, counts] : steps) method.steps.emplace_back(angle, range_of(std::move(counts)).median);
    chart.methods.push_back(std::move(method));
  }
  return chart;
}

}  // namespace mesocell
