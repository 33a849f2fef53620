#include "converters/cli/repair_report.h"

#include <cstdio>
#include <nlohmann/json.hpp>

namespace mesocell {

nlohmann::ordered_json diagnosis_json(const MeshDiagnosis& d) {
  nlohmann::ordered_json json;
  json["depth"] = d.depth == DiagnosisDepth::kEdges      ? "edges"
                  : d.depth == DiagnosisDepth::kTopology ? "topology"
                                                         : "geometry";
  json["closed"] = d.closed();
  json["triangles"] = d.triangles;
  if (d.depth != DiagnosisDepth::kEdges) {
    json["components"] = d.components;
    json["closed_components"] = d.closed_components;
  }
  if (d.depth == DiagnosisDepth::kGeometry) json["cavities"] = d.cavities;
  json["findings"] = nlohmann::ordered_json::array();
  for (const MeshFinding& f : findings(d)) {
    nlohmann::ordered_json finding;
    finding["id"] = f.id;
    finding["count"] = f.count;
    finding["at_least"] = f.at_least;
    finding["example"] = f.example ? nlohmann::ordered_json(to_array(*f.example)) : nullptr;
    finding["text"] = describe(f);
    json["findings"].push_back(std::move(finding));
  }
  return json;
}

nlohmann::ordered_json repair_json(const RepairReport& report) {
  nlohmann::ordered_json json;
  json["rung"] = rung_name(report.rung);
  json["stitched_edges"] = report.stitched_edges;
  json["inserted_vertices"] = report.inserted_vertices;
  json["stitch_tolerance"] = report.stitch_tolerance;
  json["largest_move"] = report.largest_move;
  json["turned_triangles"] = report.turned_triangles;
  json["dropped_triangles"] = report.dropped_triangles;
  json["boundary_edges"] = report.boundary_edges;
  json["unsure_voxels"] = report.unsure_voxels;
  json["thickness"] = report.thickness;
  json["thickened_triangles"] = report.thickened_triangles;
  json["wrap_alpha"] = report.wrap_alpha;
  json["wrap_offset"] = report.wrap_offset;
  json["wrap_distance"] = report.wrap_distance;
  return json;
}

std::string repair_text(const RepairReport& report) {
  std::string text = rung_name(report.rung);
  text += ", " + std::to_string(report.unsure_voxels) + " voxels unsure";
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) text += ", " + std::to_string(count) + what;
  };
  const auto add_length = [&](const char* what, double metres) {
    char number[48];
    std::snprintf(number, sizeof number, "%.6g", metres);
    text += std::string(", ") + what + " " + number;
  };
  add(report.stitched_edges, " edges stitched");
  add(report.inserted_vertices, " vertices inserted");
  if (report.largest_move > 0) add_length("moved up to", report.largest_move);
  add(report.turned_triangles, " triangles turned");
  add(report.dropped_triangles, " triangles left out");
  add(report.boundary_edges, " boundary edges left");
  if (report.rung == RepairRung::kThicken) {
    add(report.thickened_triangles, " triangles thickened");
    add_length("thickness", report.thickness);
  }
  if (report.rung == RepairRung::kWrap) {
    add_length("alpha", report.wrap_alpha);
    add_length("offset", report.wrap_offset);
    add_length("wrap up to", report.wrap_distance);
    text += " away";
  }
  return text;
}

}  // namespace mesocell
