#include "converters/cli/color_source.h"

#include <array>
#include <cstdio>
#include <span>
#include <string_view>
#include <utility>

#include "converters/cli/volume_source.h"
#include "converters/import/volume_file.h"

namespace mesocell {
namespace {

constexpr std::string_view kImport = "image", kOwn = "mesh", kOwnGrid = "grid", kVolumeColors = "volume",
                           kColorOption = "--color";

/// What tells that a texture does not tile.
void check_seams(const ColorMap& map, std::vector<Warning>& warnings) {
  const WrapCheck check = check_wrap(map);
  if (!check.has_seam()) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "the colors do not tile: steps across the border of the tile are %.1f times the largest "
                "within, changes of "
                "slope %.1f times; seams will be seen",
                check.value_ratio, check.gradient_ratio);
  warnings.push_back({"color-seam", text});
}

/// How finely colors of the surface are wanted, if they are.
std::optional<Failure> read_bake(const Recipe& recipe, Colors& colors) {
  if (!recipe.options.contains("bake")) return std::nullopt;
  const auto resolution = resolution_option(recipe, "bake", {}, 1, SurfaceColors::kMaxResolution);
  if (!resolution) return Failure{resolution.error(), std::string(kColorOption)};
  colors.surface_resolution = *resolution;
  return std::nullopt;
}

/// Colors from a grid of a volume.
std::optional<Failure> read_colors_of_volume(const Recipe& recipe, const Progress& progress, Colors& colors,
                                             ReadNotes& notes) {
  const std::string option(kColorOption);
  constexpr std::array<std::string_view, 3> kOptions = {"bake", "file", "grid"};
  if (const Status status = check_options(recipe, "color", kOptions); !status)
    return Failure{status.error(), option};
  const auto file = recipe.options.find("file"), grid = recipe.options.find("grid");
  if (file == recipe.options.end()) return usage(option, "a file is missing; write volume:file=NAME");
  notes.files.insert(file->second);
  const auto read = read_volume_colors(
      file->second, grid == recipe.options.end() ? std::string() : grid->second, &progress);
  if (!read) return Failure{read.error(), read.error().code == ErrorCode::kUsage ? option : file->second};
  colors = {};
  colors.field = [volume = *read](const CellObject& object, unsigned, const Progress*) {
    return Result<ColorField>(make_color_field(object.grid, [volume](Vec3 at) { return volume->at(at); }));
  };
  return read_bake(recipe, colors);
}

}  // namespace

std::optional<Failure> make_sourced_colors(const Recipe& recipe, std::uint32_t cell_count,
                                           const ShapeSource& shape, const Progress& progress, Colors& colors,
                                           std::vector<Warning>& warnings, ReadNotes& notes) {
  const std::string option(kColorOption);
  if (recipe.name == kVolumeColors) return read_colors_of_volume(recipe, progress, colors, notes);
  if (recipe.name == kOwn || recipe.name == kOwnGrid) {
    // The picture was read with the mesh, see texture_of_color().
    constexpr std::array<std::string_view, 2> kOwnOptions = {"bake", "texture"};
    const std::span options = std::span(kOwnOptions).first(recipe.name == kOwn ? 2 : 1);
    if (const Status status = check_options(recipe, "color", options); !status)
      return Failure{status.error(), option};
    if (const Status status = shape.check_colors(); !status) return Failure{status.error(), option};
    colors = {};
    colors.field = [&shape](const CellObject& object, unsigned threads, const Progress* bar) {
      return shape.color_field(object, threads, bar);
    };
    return read_bake(recipe, colors);
  }
  if (recipe.name != kImport) {
    Result<Colors> made = make_colors(recipe, cell_count);
    if (!made) return Failure{made.error(), option};
    colors = std::move(*made);
    return std::nullopt;
  }
  constexpr std::array<std::string_view, 2> kOptions = {"file", "resolution"};
  if (const Status status = check_options(recipe, "color", kOptions); !status)
    return Failure{status.error(), option};
  const auto file = recipe.options.find("file");
  if (file == recipe.options.end()) return usage(option, "a file is missing; write image:file=NAME");
  notes.files.insert(file->second);
  VolumeReadOptions read;
  if (recipe.options.contains("resolution")) {
    const auto resolution = resolution_option(recipe, "resolution", {}, 1, 1024);
    if (!resolution) return Failure{resolution.error(), option};
    read.raw_resolution = *resolution;
  }
  Result<ColorMap> map = read_color_volume(file->second, read, &progress, &notes);
  if (!map) return Failure{map.error(), map.error().code == ErrorCode::kUsage ? option : file->second};
  check_seams(*map, warnings);
  colors = {};
  colors.map = std::move(*map);
  return std::nullopt;
}

bool takes_mesh_colors(const std::optional<std::string>& color) {
  if (!color) return false;
  const Result<Recipe> recipe = parse_recipe(*color);
  return recipe && recipe->name == kOwn;
}

std::string texture_of_color(const std::optional<std::string>& color) {
  if (!color) return {};
  const Result<Recipe> recipe = parse_recipe(*color);
  if (!recipe || recipe->name != kOwn) return {};
  const auto texture = recipe->options.find("texture");
  return texture == recipe->options.end() ? std::string() : texture->second;
}

std::string color_sources_help() {
  return color_recipes_help() +
         "mesh   the mesh's own (of vertices, faces, materials and textures), one for each cell inside;\n"
         "    texture=skin.png: by its texture coordinates from this picture, instead of materials\n"
         "image:file=slices/   a picture, a folder of pictures or a TIFF of several, as a solid texture of "
         "the tile;\n"
         "    resolution=WxHxD is needed for .raw alone\n"
         "grid   of a .vdb as input the colors of its first grid of colors, one for each cell inside\n"
         "volume:file=x.vdb,grid=Cd   the same of another file or grid; linear light\n"
         "    bake=8, with these three: beside that, colors of the surface, on so many color voxels along "
         "an\n"
         "    edge of each tile at it (1 to 32), where one color for each cell is too coarse\n";
}

}  // namespace mesocell
