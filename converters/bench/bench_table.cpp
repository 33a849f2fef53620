#include "converters/bench/bench_table.h"

#include <array>
#include <cstdio>

namespace mesocell {
namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

/// Empty where nothing was compared.
std::string of(std::uint64_t compared, double x) { return compared > 0 ? number(x) : ""; }

std::uint64_t both_hit(const TracingError& e) { return e.hits - e.missed; }

constexpr std::array<BenchColumn, 27> kColumns = {{
    {"scene", true, [](const BenchRow& r) { return r.scene; }},
    {"shape", true, [](const BenchRow& r) { return r.shape; }},
    {"tile", true, [](const BenchRow& r) { return r.tile; }},
    {"tiles", false, [](const BenchRow& r) { return std::to_string(r.tiles); }},
    {"tile_resolution", false, [](const BenchRow& r) { return std::to_string(r.resolution); }},
    {"camera", true, [](const BenchRow& r) { return r.camera; }},
    {"rays", true, [](const BenchRow& r) { return r.rays; }},
    {"method", true, [](const BenchRow& r) { return r.figures.method; }},
    {"threads", false, [](const BenchRow& r) { return std::to_string(r.figures.threads); }},
    {"ray_count", false, [](const BenchRow& r) { return std::to_string(r.figures.ray_count); }},
    {"hit_rate", false, [](const BenchRow& r) { return number(r.figures.hit_rate); }},
    {"angle_degrees", false, [](const BenchRow& r) { return number(r.angle_degrees); }},
    {"repeats", false, [](const BenchRow& r) { return std::to_string(r.repeats); }},
    {"rays_per_second", false, [](const BenchRow& r) { return number(r.figures.rays_per_second); }},
    {"rays_per_second_min", false, [](const BenchRow& r) { return number(r.figures.rays_per_second_min); }},
    {"rays_per_second_max", false, [](const BenchRow& r) { return number(r.figures.rays_per_second_max); }},
    {"steps_per_ray", false,
     [](const BenchRow& r) { return r.figures.steps_per_ray ? number(*r.figures.steps_per_ray) : ""; }},
    {"build_seconds", false, [](const BenchRow& r) { return number(r.figures.build_seconds); }},
    {"peak_bytes", false, [](const BenchRow& r) { return std::to_string(r.figures.peak_bytes); }},
    {"miss_rate", false, [](const BenchRow& r) { return number(r.figures.error.miss_rate()); }},
    {"false_hit_rate", false, [](const BenchRow& r) { return number(r.figures.error.false_hit_rate()); }},
    {"depth_error_mean", false,
     [](const BenchRow& r) { return of(both_hit(r.figures.error), r.figures.error.depth_mean); }},
    {"depth_error_p99", false,
     [](const BenchRow& r) { return of(both_hit(r.figures.error), r.figures.error.depth_p99); }},
    {"depth_error_max", false,
     [](const BenchRow& r) { return of(both_hit(r.figures.error), r.figures.error.depth_max); }},
    {"normal_angle_mean", false,
     [](const BenchRow& r) { return of(r.figures.error.normals, r.figures.error.normal_angle); }},
    {"wrong_cell_rate", false,
     [](const BenchRow& r) { return of(r.figures.error.cells, r.figures.error.wrong_cell_rate()); }},
    {"wrong_voxel_rate", false,
     [](const BenchRow& r) { return of(r.figures.error.voxels, r.figures.error.wrong_voxel_rate()); }},
}};

/// A text as a field of CSV: names may be those of files.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r#") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

/// One line, whatever is in it.
std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text;
}

std::string short_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, x != 0 && (x < 0.01 || x >= 1e5) ? "%.1e" : x < 10 ? "%.3g" : "%.4g", x);
  return text;
}

}  // namespace

std::span<const BenchColumn> bench_columns() { return kColumns; }

std::string bench_csv(const BenchHead& head, std::span<const BenchRow> rows) {
  std::string out;
  for (const auto& [name, text] : head) out += "# " + one_line(name + ": " + text) + "\n";
  for (const BenchColumn& c : kColumns) out += (&c == kColumns.data() ? "" : ",") + std::string(c.name);
  out += "\n";
  for (const BenchRow& row : rows) {
    for (const BenchColumn& c : kColumns) out += (&c == kColumns.data() ? "" : ",") + csv_field(c.text(row));
    out += "\n";
  }
  return out;
}

std::string bench_markdown(const BenchHead& head, std::span<const BenchRow> rows) {
  std::string out;
  for (const auto& [name, text] : head) out += one_line(name + ": " + text) + "\n";
  const BenchRow* above = nullptr;
  for (const BenchRow& row : rows) {
    if (!above || above->scene != row.scene || above->camera != row.camera || above->rays != row.rays)
      out += "\n" + row.scene + ", camera " + row.camera + ", " + row.rays + " rays:\n\n" +
             "| method | threads | M rays/s | steps a ray | MB | missed % | false % | depth error, voxels: "
             "mean | "
             "max | wrong voxel % |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
    above = &row;
    const TracingError& e = row.figures.error;
    out += "| " + row.figures.method + " | " + std::to_string(row.figures.threads);
    out += " | " + short_number(row.figures.rays_per_second * 1e-6) + " | ";
    if (row.figures.steps_per_ray) out += short_number(*row.figures.steps_per_ray);
    for (const double x : {double(row.figures.peak_bytes) * 1e-6, 100 * e.miss_rate(),
                           100 * e.false_hit_rate(), e.depth_mean, e.depth_max})
      out += " | " + short_number(x);
    out += " | " + (e.voxels > 0 ? short_number(100 * e.wrong_voxel_rate()) : std::string()) + " |\n";
  }
  return out;
}

}  // namespace mesocell
