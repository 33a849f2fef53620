#include "converters/stability/report.h"

#include <algorithm>
#include <cstdio>

#include "converters/stability/heat_map.h"

namespace mesocell {
namespace {

const char* group_title(const std::string& group) {
  if (group == "clean") return "Clean meshes";
  if (group == "damage") return "Damaged meshes";
  if (group == "geometry") return "Sound meshes that are hard on a grid";
  return "Broken meshes against their sound twins";
}

const char* outcome_name(RunOutcome outcome) {
  switch (outcome) {
    case RunOutcome::kDone:
      return "done";
    case RunOutcome::kTooLong:
      return "too-long";
    case RunOutcome::kFailed:
      return "failed";
  }
  return "";
}

std::string far_text(const StabilityTable::Cell& cell) {
  if (!cell.measured) return "";
  if (cell.too_long || cell.failed) return cell_text(cell);
  return percent_text(cell.voxels.wrong_far_percent());
}

void add_table(std::string& out, const StabilityTable& table,
               std::string (*text)(const StabilityTable::Cell&)) {
  out += "| case |";
  for (const std::string& method : table.methods) out += " " + method + " |";
  out += "\n|---|";
  for (std::size_t m = 0; m < table.methods.size(); ++m) out += "---:|";
  out += "\n";
  for (const StabilityTable::Row& row : table.rows) {
    std::string name = row.name;
    for (std::size_t k = 0; (k = name.find('|', k)) != name.npos; k += 2) name.insert(k, "\\");
    out += "| " + name + " |";
    for (const StabilityTable::Cell& cell : row.cells) out += " " + text(cell) + " |";
    out += "\n";
  }
}

}  // namespace

StabilityTable tabulate(std::span<const StabilityResult> results) {
  StabilityTable table;
  for (const StabilityResult& r : results)
    if (std::ranges::find(table.methods, r.method) == table.methods.end()) table.methods.push_back(r.method);
  for (const StabilityResult& r : results) {
    auto row = std::ranges::find_if(table.rows, [&](const StabilityTable::Row& known) {
      return known.group == r.group && known.name == r.row();
    });
    if (row == table.rows.end())
      row =
          table.rows.insert(row, {r.group, r.row(), std::vector<StabilityTable::Cell>(table.methods.size())});
    StabilityTable::Cell& cell =
        row->cells[std::size_t(std::ranges::find(table.methods, r.method) - table.methods.begin())];
    cell.measured = true;
    cell.too_long |= r.run.outcome == RunOutcome::kTooLong;
    cell.failed |= r.run.outcome == RunOutcome::kFailed;
    cell.seconds += r.run.seconds;
    if (r.run.outcome == RunOutcome::kDone) cell.voxels += r.voxels;
  }
  return table;
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string percent_text(double percent) {
  if (percent == 0) return "0";
  if (percent < 0.01) return "<0.01";
  char text[32];
  std::snprintf(text, sizeof text, percent < 0.995 ? "%.2f" : percent < 9.95 ? "%.1f" : "%.0f", percent);
  return text;
}

std::string cell_text(const StabilityTable::Cell& cell) {
  if (!cell.measured) return "";
  if (cell.failed) return "failed";
  if (cell.too_long) return "too long";
  return percent_text(cell.voxels.wrong_percent());
}

std::string stability_csv(std::span<const StabilityResult> results) {
  std::string out =
      "group,case,strength,mesh,method,size_x,size_y,size_z,outcome,wrong,wrong_far,inside,far,voxels,"
      "wrong_percent_of_inside,wrong_far_percent_of_far,seconds,cpu_seconds,memory_bytes,message\n";
  for (const StabilityResult& r : results) {
    for (const std::string& field : {r.group, r.name, r.strength, r.mesh, r.method})
      out += csv_field(field) + ",";
    const bool done = r.run.outcome == RunOutcome::kDone;
    const WrongVoxels& v = r.voxels;
    for (const std::uint32_t n : r.size) out += std::to_string(n) + ",";
    out += outcome_name(r.run.outcome);
    out += done ? "," + std::to_string(v.wrong) + "," + std::to_string(v.wrong_far) : ",,";
    out +=
        "," + std::to_string(v.inside) + "," + std::to_string(v.far) + "," + std::to_string(v.voxels) + ",";
    char text[128];
    std::snprintf(text, sizeof text, "%.6g,%.6g,", v.wrong_percent(), v.wrong_far_percent());
    out += done ? text : ",,";
    std::snprintf(text, sizeof text, "%.6f,%.6f,", r.run.seconds, r.run.cpu_seconds);
    out += text + std::to_string(r.run.memory_bytes) + "," + csv_field(r.run.message) + "\n";
  }
  return out;
}

std::string stability_markdown(const StabilityTable& table) {
  std::string out = "Wrong voxels, in per cent of the voxels that are truly inside:\n\n";
  add_table(out, table, cell_text);
  out +=
      "\nWrong voxels over two voxels from the true surface, in per cent of all voxels of the grid that are "
      "over two "
      "voxels from it:\n\n";
  add_table(out, table, far_text);
  return out;
}

std::string benchmark_markdown(std::span<const StabilityResult> results) {
  std::string out =
      "| mesh | case | voxels | method | time | processor time | peak memory | wrong voxels | % of those "
      "inside | wrong over "
      "two voxels "
      "from the surface |\n|---|---|---:|---|---:|---:|---:|---:|---:|---:|\n";
  for (const StabilityResult& r : results) {
    char text[256];
    out += "| " + r.mesh + " | " + r.row() + " | " + std::to_string(r.size[0]) + "×" +
           std::to_string(r.size[1]) + "×" + std::to_string(r.size[2]) + " | " + r.method + " | ";
    if (r.run.outcome != RunOutcome::kDone) {
      std::snprintf(text, sizeof text, "%s after %.1f s | | | | | |\n", outcome_name(r.run.outcome),
                    r.run.seconds);
    } else {
      std::snprintf(text, sizeof text, "%.3f s | %.3f s | %.0f MB | %llu | %s | %llu |\n", r.run.seconds,
                    r.run.cpu_seconds, double(r.run.memory_bytes) * 1e-6,
                    static_cast<unsigned long long>(r.voxels.wrong),
                    percent_text(r.voxels.wrong_percent()).c_str(),
                    static_cast<unsigned long long>(r.voxels.wrong_far));
    }
    out += text;
  }
  return out;
}

std::string stability_heat_map(const StabilityTable& table, std::string_view caption) {
  HeatMap map{"Inside or outside? Wrong voxels by method and case",
              std::string(caption),
              "wrong voxels, % of those truly inside:",
              table.methods,
              {}};
  for (const StabilityTable::Row& row : table.rows) {
    HeatMap::Row drawn{group_title(row.group), row.name, {}};
    for (const StabilityTable::Cell& cell : row.cells) {
      drawn.cells.push_back({std::nullopt, cell_text(cell)});
      if (cell.measured && !cell.failed && !cell.too_long)
        drawn.cells.back().percent = cell.voxels.wrong_percent();
    }
    map.rows.push_back(std::move(drawn));
  }
  return draw_heat_map(map);
}

}  // namespace mesocell
