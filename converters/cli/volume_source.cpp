#include "converters/cli/volume_source.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "converters/image/extension.h"
#include "converters/image/input_file.h"
#include "converters/import/volume_file.h"
#include "converters/vdb/scan_file.h"
#include "converters/vdb/vdb_file.h"
#include "converters/vdb/volume_shape.h"
#include "format/utf8.h"
#include "sdk/core/number_text.h"

namespace mesocell {
namespace {

bool begins_as_inr(const std::string& path) {
  const Result<InputFile> file = InputFile::open(path, UINT64_MAX);
  constexpr std::string_view kMagic = "#INRIMAGE-4#{";
  std::array<std::byte, kMagic.size()> head{};
  if (!file || file->size() < head.size() || !file->read_at(0, head)) return false;
  return std::string_view(reinterpret_cast<const char*>(head.data()), head.size()) == kMagic;
}

bool is_scan(const std::string& path) {
  return begins_as_inr(path) || (has_scan_extension(path) && !is_vdb_file(path));
}

/// Of a .vdb file, by its label; empty if there is none.
std::string first_color_grid(const std::string& path) {
  const Result<std::vector<VdbGridHead>> grids = read_vdb_header(path);
  if (!grids) return {};
  const auto found = std::find_if(grids->begin(), grids->end(), [](const VdbGridHead& grid) {
    return grid.type.starts_with("vec3s") || grid.type.starts_with("vec3d");
  });
  return found == grids->end() ? std::string() : found->label();
}

/// The grid of the input that --color names; empty if it names none.
std::string color_grid_of(const ConvertCommand& command) {
  const Result<Recipe> recipe = parse_recipe(command.color.value_or("none"));
  if (!recipe) return {};
  if (recipe->name == "grid") return first_color_grid(command.input);
  const auto file = recipe->options.find("file"), grid = recipe->options.find("grid");
  if (recipe->name != "volume" || file == recipe->options.end() || !same_file(file->second, command.input))
    return {};
  return grid == recipe->options.end() ? first_color_grid(command.input) : grid->second;
}

/// A volume, filled with tiles.
class VolumeSource final : public ShapeSource {
 public:
  VolumeSource(std::unique_ptr<VolumeShape> shape, Metadata metadata, std::string path)
      : shape_(std::move(shape)), metadata_(std::move(metadata)), path_(std::move(path)) {}
  [[nodiscard]] Result<CellObject> fill(TileMap tile, const AuthorOptions& options, AuthorReport& report,
                                        const Progress& progress) const override {
    return author_cell_object(*shape_, std::move(tile), options, &report, &progress);
  }
  [[nodiscard]] const TriangleMesh& surface() const override { return none_; }
  [[nodiscard]] Metadata metadata() const override { return metadata_; }
  [[nodiscard]] Status check_colors() const override {
    if (first_color_grid(path_).empty())
      return Error{ErrorCode::kUsage,
                   "the volume has no grid of colors (vec3s or vec3d); choose another color"};
    return {};
  }
  [[nodiscard]] Result<ColorField> color_field(const CellObject& object, unsigned,
                                               const Progress* progress) const override {
    const auto colors = read_volume_colors(path_, {}, progress);
    if (!colors) return colors.error();
    return make_color_field(object.grid, [volume = *colors](Vec3 at) { return volume->at(at); });
  }

 private:
  std::unique_ptr<VolumeShape> shape_;
  Metadata metadata_;
  std::string path_;
  TriangleMesh none_;
};

/// Which file, grid and value the shape is of, as a recipe.
std::string source_text(const std::string& input, const std::string& grid, std::optional<double> iso) {
  Recipe recipe{"volume", {{"file", std::filesystem::path(input).filename().string()}}};
  if (!grid.empty()) recipe.options["grid"] = grid;
  if (iso) recipe.options["iso"] = number_text(*iso);
  const std::string text = to_text(recipe);
  return is_utf8(text) ? text : "volume";
}

/// Slices, or a volume texture: its longest side is 1 m.
Result<SparseVolume> read_stack(const std::string& path, const Progress& progress, ReadNotes& notes) {
  const Result<ScalarVolume> stack = read_scalar_volume(path, {}, &progress, &notes);
  if (!stack) return stack.error();
  SparseVolume volume = make_sparse(stack->values, stack->resolution);
  const double edge = 1.0 / *std::max_element(stack->resolution.begin(), stack->resolution.end());
  volume.index_to_world = scaling({edge, edge, edge});
  return volume;
}

/// A volume that is one grid.
Result<SparseVolume> read_one_grid(const std::string& path, const Progress& progress, ReadNotes& notes) {
  if (is_scan(path)) return read_scan(path, {}, &notes);
  if (is_raw_volume(path))
    return Error{
        ErrorCode::kInvalidInput,
        "a .raw file does not say how many voxels it has, nor of what kind; write a MetaImage header "
        "(.mhd) that names it, and give that"};
  return read_stack(path, progress, notes);
}

bool is_vdb(const std::string& path) { return is_vdb_file(path) || lower_extension(path) == ".vdb"; }

Result<SparseVolume> read(const ConvertCommand& command, VdbReadReport& report, const Progress& progress,
                          ReadNotes& notes) {
  if (!is_vdb(command.input)) return read_one_grid(command.input, progress, notes);
  VdbReadOptions options;
  options.grid = command.grid.value_or("");
  return read_vdb(command.input, options, &report, &progress);
}

const char* class_name(VolumeClass volume_class) {
  return volume_class == VolumeClass::kLevelSet ? "level set"
         : volume_class == VolumeClass::kFog    ? "fog volume"
                                                : "unknown";
}

nlohmann::ordered_json transform_json(const Transform& transform) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (std::size_t a = 0; a < 3; ++a)
    rows.push_back({transform.rows[a].x, transform.rows[a].y, transform.rows[a].z, transform.move[a]});
  return rows;
}

/// The box in metres of the samples from `low` to `high`.
nlohmann::ordered_json box_json(const Transform& transform, const VoxelCoord& low, const VoxelCoord& high) {
  Box3 box;
  for (int k = 0; k < 8; ++k)
    box.add(transform.point({double(k & 1 ? high[0] : low[0]), double(k & 2 ? high[1] : low[1]),
                             double(k & 4 ? high[2] : low[2])}));
  nlohmann::ordered_json json;
  json["min"] = to_array(box.min);
  json["max"] = to_array(box.max);
  return json;
}

nlohmann::ordered_json grid_json(const VdbGridInfo& grid) {
  nlohmann::ordered_json json;
  json["name"] = grid.head.label();
  json["type"] = grid.head.type + (grid.head.half ? " (half)" : "");
  json["usable"] = grid.usable && grid.facts.trouble.empty();
  if (!grid.facts.trouble.empty()) {
    json["trouble"] = grid.facts.trouble;
    return json;
  }
  json["class"] = class_name(grid.facts.volume_class);
  json["active_voxels"] = grid.facts.active_voxels;
  if (!grid.facts.linear) {
    json["transform"] = "not affine";
    return json;
  }
  json["transform"] = transform_json(grid.facts.index_to_world);
  json["voxels"]["min"] = grid.facts.low;
  json["voxels"]["max"] = grid.facts.high;
  if (grid.facts.low[0] <= grid.facts.high[0])
    json["box"] = box_json(grid.facts.index_to_world, grid.facts.low, grid.facts.high);
  return json;
}

}  // namespace

Result<std::shared_ptr<const VolumeColors>> read_volume_colors(const std::string& path,
                                                               const std::string& grid,
                                                               const Progress* progress) {
  VdbReadOptions options;
  options.grid = grid;
  options.purpose = VdbPurpose::kColors;
  Result<SparseVolume> volume = read_vdb(path, options, nullptr, progress);
  if (!volume) return volume.error();
  return VolumeColors::make(std::move(*volume));
}

void note_other_grids(const std::string& path, const std::vector<std::string>& taken, ReadNotes& notes) {
  const Result<std::vector<VdbGridHead>> grids = read_vdb_header(path);
  if (!grids) return;
  constexpr std::size_t kMaxName = 48;
  for (const VdbGridHead& grid : *grids)
    if (std::find(taken.begin(), taken.end(), grid.label()) == taken.end())
      notes.lose("grid " + grid.label().substr(0, kMaxName));
}

bool is_volume_input(const std::string& path) {
  return is_vdb(path) || is_scan(path) || is_raw_volume(path) || is_slice_stack(path);
}

std::optional<Failure> read_volume_shape(const ConvertCommand& command, const Progress& progress,
                                         std::unique_ptr<ShapeSource>& shape, std::vector<Warning>& warnings,
                                         ReadNotes& notes) {
  if (command.grid && !is_vdb(command.input))
    warnings.push_back({"option-unused", "--grid has no effect on what is one grid"});
  VdbReadReport report;
  Result<SparseVolume> volume = read(command, report, progress, notes);
  if (!volume)
    return Failure{volume.error(), volume.error().code == ErrorCode::kUsage ? "--grid" : command.input};
  if (!report.others.empty()) {
    std::string names;
    for (std::size_t i = 0; i < std::min<std::size_t>(report.others.size(), 20); ++i)
      names += (i ? ", " : "") + report.others[i];
    warnings.push_back({"grids-unused", "of the file's grids '" + report.grid +
                                            "' was taken; --grid takes another one: " + names});
  }
  if (!report.grid.empty() && volume->type == VolumeType::kFloat &&
      volume->volume_class == VolumeClass::kUnknown)
    warnings.push_back({"grid-class-unknown", "the file does not say what the values of grid '" +
                                                  report.grid +
                                                  "' are; they are taken as fog, more of it is inside"});
  if (is_vdb(command.input)) note_other_grids(command.input, {report.grid, color_grid_of(command)}, notes);
  Result<std::unique_ptr<VolumeShape>> made = VolumeShape::make(std::move(*volume), command.iso);
  if (!made) return Failure{made.error(), made.error().code == ErrorCode::kUsage ? "--iso" : command.input};
  Metadata metadata{{"source", source_text(command.input, report.grid, (*made)->iso())}};
  shape = std::make_unique<VolumeSource>(std::move(*made), std::move(metadata), command.input);
  return std::nullopt;
}

Result<nlohmann::ordered_json> describe_volume(const std::string& path, const Progress& progress) {
  nlohmann::ordered_json json;
  nlohmann::ordered_json grids = nlohmann::ordered_json::array();
  std::error_code ignored;
  const std::uint64_t file_bytes = std::filesystem::file_size(path, ignored);
  if (!is_vdb(path)) {
    ReadNotes unused;
    const Result<SparseVolume> volume = read_one_grid(path, progress, unused);
    if (!volume) return volume.error();
    json["format"] = is_scan(path) ? volume->name : "slices";
    nlohmann::ordered_json grid;
    grid["name"] = "";
    grid["type"] = "float_5_4_3";
    grid["usable"] = true;
    grid["class"] = class_name(volume->volume_class);
    grid["transform"] = transform_json(volume->index_to_world);
    VoxelCoord low, high;
    if (active_range(*volume, low, high)) {
      grid["voxels"]["min"] = low;
      grid["voxels"]["max"] = high;
      grid["box"] = box_json(volume->index_to_world, low, high);
    }
    grids.push_back(std::move(grid));
  } else {
    const Result<std::vector<VdbGridInfo>> list = list_vdb(path, {}, &progress);
    if (!list) return list.error();
    json["format"] = "VDB";
    for (const VdbGridInfo& grid : *list) grids.push_back(grid_json(grid));
  }
  json["file_bytes"] = file_bytes;
  json["grids"] = std::move(grids);
  return json;
}

std::string volumes_help() {
  return "VDB (level sets, fog, masks, labels), MetaImage and INRIMAGE-4 (.mhd, .mha, .inr), a folder of "
         "slices, a\nTIFF of several pages, a volume texture (.dds). --grid NAME or\n"
         "NAME[INDEX] says which grid of a VDB [the first that can be used]; --iso the value of the surface: "
         "inside\nis what is below it of a level set [0], what is at or above it of all else [half the "
         "greatest value].\nBetween samples values are interpolated trilinearly. `mesocell info FILE.vdb` "
         "lists "
         "the grids.\n";
}

}  // namespace mesocell
