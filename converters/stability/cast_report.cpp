#include "converters/stability/cast_report.h"

#include <algorithm>
#include <cstdio>

#include "converters/stability/heat_map.h"
#include "converters/stability/report.h"

namespace mesocell {
namespace {

const char* cast_group_title(const std::string& group) {
  if (group == "thin") return "Thin cells in tiles of 256 voxels";
  if (group == "gaps") return "Gaps between cells";
  if (group == "grazing") return "Grazing angles: slats of one voxel";
  if (group == "far") return "Far and tiny objects";
  if (group == "along") return "Rays along and through faces, edges, corners of a checkerboard";
  return "Light";
}

/// "holds", "12 %", "12 % predicted".
std::string verdict_text(const CastResult& r) {
  if (r.verdict == CastVerdict::kHolds) return "holds";
  return percent_text(r.errors.wrong_percent()) + " %" +
         (r.verdict == CastVerdict::kFailsAsPredicted ? " predicted" : "");
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", x);
  return text;
}

std::string figures_text(const CastResult& r) {
  const CastErrors& e = r.errors;
  return percent_text(100 * e.miss_rate()) + " / " + percent_text(100 * e.false_hit_rate()) + " / " +
         number(e.depth_p99) + " / " + number(e.depth_max);
}

/// Results are by cases, then methods.
std::size_t count_methods(std::span<const CastResult> results) {
  std::size_t n = 0;
  while (n < results.size() && results[n].group == results[0].group && results[n].row() == results[0].row())
    ++n;
  return n;
}

void add_table(std::string& out, std::span<const CastResult> results,
               std::string (*text)(const CastResult&)) {
  const std::size_t methods = count_methods(results);
  out += "| case |";
  for (std::size_t m = 0; m < methods; ++m) out += " " + results[m].method + " |";
  out += "\n|---|";
  for (std::size_t m = 0; m < methods; ++m) out += "---:|";
  for (std::size_t k = 0; k < results.size(); ++k) {
    if (k % methods == 0) out += "\n| " + results[k].row() + " |";
    out += " " + text(results[k]) + " |";
  }
  out += "\n";
}

}  // namespace

std::string cast_csv(std::span<const CastResult> results) {
  std::string out =
      "group,case,strength,method,verdict,rays,hits,missed,wrong_cell,off,false_hits,wrong_percent,miss_rate,"
      "false_hit_rate,depth_error_mean,depth_error_p99,depth_error_max,steps\n";
  for (const CastResult& r : results) {
    for (const std::string& field :
         {r.group, r.name, r.strength, r.method, std::string(verdict_name(r.verdict))})
      out += csv_field(field) + ",";
    const CastErrors& e = r.errors;
    for (const std::uint64_t n : {e.rays, e.hits, e.missed, e.wrong_cell, e.off, e.false_hits})
      out += std::to_string(n) + ",";
    char text[192];
    std::snprintf(text, sizeof text, "%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,", e.wrong_percent(), e.miss_rate(),
                  e.false_hit_rate(), e.depth_mean, e.depth_p99, e.depth_max);
    out += text + std::to_string(e.steps) + "\n";
  }
  return out;
}

std::string cast_markdown(std::span<const CastResult> results) {
  std::string out =
      "Verdicts: a method holds if it answers every ray as closed form does, with hits within 1/16 voxel for "
      "each mirror on the way, of exact to rounding; else the share of rays that it does not. *Predicted*: "
      "it fails "
      "as the source predicts, by passing by what rays go through by less than a step, or, with a fixed "
      "step, cells "
      "at grazing angles.\n\n";
  add_table(out, results, verdict_text);
  out +=
      "\nFigures: missed, % of the rays that hit / false hits, % of those that do not / error in depth of "
      "found hits, "
      "voxels, 99th "
      "percentile / greatest:\n\n";
  add_table(out, results, figures_text);
  return out;
}

std::string cast_heat_map(std::span<const CastResult> results, std::string_view caption) {
  HeatMap map{"First hits and what follows: wrong rays by method and case",
              std::string(caption),
              "wrong rays, % of all:",
              {},
              {}};
  map.column_width = 136;
  const std::size_t methods = count_methods(results);
  for (std::size_t m = 0; m < methods; ++m) map.columns.push_back(results[m].method);
  for (std::size_t k = 0; k < results.size(); ++k) {
    if (k % methods == 0) map.rows.push_back({cast_group_title(results[k].group), results[k].row(), {}});
    map.rows.back().cells.push_back({results[k].errors.wrong_percent(), verdict_text(results[k])});
  }
  return draw_heat_map(map);
}

}  // namespace mesocell
