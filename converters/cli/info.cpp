#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "converters/cli/commands.h"
#include "converters/cli/progress_bar.h"
#include "converters/cli/repair_report.h"
#include "converters/cli/representations.h"
#include "converters/cli/values.h"
#include "converters/cli/volume_source.h"
#include "converters/import/mesh_file.h"
#include "format/chunk_reader.h"
#include "format/tag_reader.h"
#include "sdk/membership/diagnose.h"

namespace mesocell {
namespace {

/// A value on one line: "[64, 63, 50]", "min [0, 0, 0], max [1, 1, 1]".
std::string value_text(const nlohmann::ordered_json& value) {
  std::string text;
  if (value.is_string()) return printable(value.get<std::string>());
  if (!value.is_structured()) return value.dump();
  for (const auto& [key, item] : value.items()) {
    if (!text.empty()) text += ", ";
    if (value.is_object()) text += printable(key) + " ";
    text += value_text(item);
  }
  return value.is_array() ? "[" + text + "]" : text;
}

/// A line for each entry; the elements of an array of objects get a line each.
std::string info_text(const nlohmann::ordered_json& info) {
  std::string text;
  for (const auto& [key, value] : info.items()) {
    if (value.is_null() || (value.is_structured() && value.empty())) continue;
    const std::string name = key + std::string(key.size() < 16 ? 16 - key.size() : 1, ' ');
    if (value.is_array() && value.front().is_object()) {
      for (const nlohmann::ordered_json& item : value) text += name + value_text(item) + "\n";
    } else {
      text += name + value_text(value) + "\n";
    }
  }
  return text;
}

/// A block of lines for each of several assets; one alone needs no name.
std::string file_text(nlohmann::ordered_json info) {
  const nlohmann::ordered_json assets = std::move(info["assets"]);
  info.erase("assets");
  if (assets.size() == 1) return info_text(info);
  std::string text = info_text({{"format", info["format"]}, {"file_bytes", info["file_bytes"]}});
  for (const nlohmann::ordered_json& asset : assets) text += "\n" + info_text(asset);
  return text;
}

/// What a mesh file holds and all that is amiss with it.
int tell_mesh(const InfoCommand& command, const Console& console) {
  ProgressBar bar(!console.quiet());
  MeshReadReport report;
  const Result<PaintedMesh> painted = read_painted_mesh(command.input, {}, &report, &bar.progress());
  if (!painted) {
    bar.finish();
    return console.fail(painted.error(), command.input);
  }
  const TriangleMesh* const mesh = &painted->mesh;
  DiagnoseOptions options;
  options.depth = DiagnosisDepth::kGeometry;
  options.threads = command.common.threads;
  const MeshDiagnosis diagnosis = diagnose(*mesh, options, &bar.progress());
  bar.finish();
  if (bar.progress().cancelled()) return console.fail({ErrorCode::kCancelled, "interrupted"}, {});
  const Box3 box = bounding_box(*mesh);
  nlohmann::ordered_json info;
  info["format"] = report.format;
  info["file_bytes"] = report.file_bytes;
  info["polygons"] = report.polygons;
  info["dropped_faces"] = report.dropped_faces;
  info["vertices"] = mesh->vertices.size();
  info["vertex_colors"] = report.vertex_colors;
  info["face_colors"] = !painted->paint.face_colors.empty();
  info["materials"] = painted->paint.materials.size();
  info["textures"] = painted->paint.images.size();
  info["box"]["min"] = to_array(box.min);
  info["box"]["max"] = to_array(box.max);
  info["volume"] = diagnosis.closed() ? nlohmann::ordered_json(signed_volume(*mesh)) : nullptr;
  for (const MeshWarning& warning : report.warnings)
    info["warnings"].push_back({{"id", warning.id}, {"text", warning.text}});
  nlohmann::ordered_json found = diagnosis_json(diagnosis);
  if (console.json()) {
    info["diagnosis"] = std::move(found);
    return console.finish(json_text(info));
  }
  found.erase("depth");
  found.erase("findings");
  info.update(found);
  std::string text = info_text(info);
  for (const MeshFinding& finding : findings(diagnosis)) text += describe(finding) + "\n";
  return console.finish(text);
}

/// The grids of a volume.
int tell_volume(const InfoCommand& command, const Console& console) {
  ProgressBar bar(!console.quiet());
  const Result<nlohmann::ordered_json> info = describe_volume(command.input, bar.progress());
  bar.finish();
  if (!info) return console.fail(info.error(), command.input);
  return console.finish(console.json() ? json_text(*info) : info_text(*info));
}

std::string_view tag_name(Tag tag) {
  return tag == Tag::kInside ? "inside" : tag == Tag::kOutside ? "outside" : "intersected";
}

/// The index of a file's asset that the path names, from its head alone.
Result<std::size_t> asset_index(ByteSource& source, const AssetPath& place) {
  if (!place.asset) return std::size_t{0};
  const Result<ContainerScan> scan = read_head(source, {});
  if (!scan) return scan.error();
  return find_asset(scan->assets, place.asset);
}

/// The tags of one tile, read from as little of the file as that takes.
int tell_tile(const InfoCommand& command, const Console& console) {
  const Result<std::array<double, 3>> wanted = parse_numbers<3>(command.tile);
  if (!wanted) return console.fail(wanted.error(), "--tile");
  const AssetPath place = parse_asset_path(command.input);
  Result<FileSource> source = FileSource::open(place.file);
  if (!source) return console.fail(source.error(), place.file);
  const Result<std::size_t> asset = asset_index(*source, place);
  if (!asset) return console.fail(asset.error(), command.input);
  Result<TagReader> reader = TagReader::open(*source, *asset);
  if (!reader) return console.fail(reader.error(), command.input);
  Index3 tile{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double v = (*wanted)[a];
    if (!(v >= 0 && v < reader->grid().tiles[a] && v == std::floor(v)))
      return console.fail(usage("--tile", "it must be three whole numbers below those of the grid's tiles, " +
                                              nlohmann::ordered_json(reader->grid().tiles).dump()));
    tile[a] = std::uint32_t(v);
  }
  const Result<std::vector<Tag>> tags = reader->tags(tile);
  if (!tags) return console.fail(tags.error(), command.input);
  nlohmann::ordered_json info;
  info["tile"] = tile;
  info["tags"] = nlohmann::ordered_json::array();
  for (const Tag tag : *tags) info["tags"].push_back(tag_name(tag));
  info["bytes_read"] = source->bytes_read();
  info["file_bytes"] = source->size();
  return console.finish(console.json() ? json_text(info) : info_text(info));
}

}  // namespace

int run_info(const InfoCommand& command) {
  const Console console(command.common);
  if (!command.tile.empty()) return tell_tile(command, console);
  if (is_volume_input(command.input)) return tell_volume(command, console);
  if (is_readable_mesh(command.input)) return tell_mesh(command, console);
  const Result<AssetFile> file = read_whole_asset_file(command.input);
  if (!file) return console.fail(file.error(), command.input);
  const nlohmann::ordered_json info = describe_assets(*file);
  return console.finish(console.json() ? json_text(info) : file_text(info));
}

}  // namespace mesocell
