#include "converters/cli/tile_source.h"

#include <array>
#include <filesystem>
#include <string_view>
#include <utility>

#include "converters/cli/commands.h"
#include "converters/cli/representations.h"
#include "converters/cli/volume_source.h"
#include "converters/import/height_file.h"
#include "converters/import/mesh_file.h"
#include "converters/import/volume_file.h"
#include "converters/vdb/vdb_file.h"
#include "converters/vdb/volume_shape.h"
#include "format/cell_object_io.h"
#include "sdk/author/height_field.h"
#include "sdk/author/mesh_tile.h"
#include "sdk/tiles/tile_spec.h"

namespace mesocell {
namespace {

/// What an import is given.
struct Import {
  const Recipe& recipe;
  const std::string& file;
  const TileSourceOptions& options;
  const Progress& progress;
  ReadNotes& notes;
};

constexpr Index3 kTileResolution{64, 64, 64};

Result<TileMap> import_meshes(const Import& import, TileReport& report) {
  const auto resolution = resolution_option(import.recipe, "resolution", kTileResolution, 4, 1024);
  if (!resolution) return resolution.error();
  const auto size = number_option(import.recipe, "size", 0, 1e-300, 1e300);
  if (!size) return size.error();
  const auto origin = point_option(import.recipe, "origin");
  if (!origin) return origin.error();
  const auto cells = choice_option(import.recipe, "cells", {"parts", "file"});
  if (!cells) return cells.error();

  MeshReadReport read;
  const Result<TriangleMesh> mesh = read_mesh_file(import.file, {}, &read, &import.progress);
  if (!mesh) return mesh.error();
  import.notes.add(read.notes);
  if (!mesh->colors.empty()) import.notes.lose("colors of vertices");
  TilePlacement placement = place_tile(bounding_box(*mesh), *resolution, *size);
  if (*origin) placement.origin = **origin;
  const std::vector<TriangleMesh> parts =
      *cells == 0 ? split_into_parts(*mesh) : std::vector<TriangleMesh>{*mesh};
  return make_mesh_tile(parts, *resolution, placement, import.options.threads, &report, &import.progress);
}

/// The labels of a grid of whole numbers.
Result<LabelVolume> read_label_grid(const Import& import) {
  VdbReadOptions read;
  read.purpose = VdbPurpose::kLabels;
  if (const auto grid = import.recipe.options.find("grid"); grid != import.recipe.options.end())
    read.grid = grid->second;
  VdbReadReport report;
  const Result<SparseVolume> volume = read_vdb(import.file, read, &report, &import.progress);
  if (!volume) return volume.error();
  note_other_grids(import.file, {report.grid}, import.notes);
  return labels_of(*volume);
}

Result<TileMap> import_labels(const Import& import, TileReport& report) {
  VolumeReadOptions read;
  if (import.recipe.options.contains("resolution")) {
    const auto resolution = resolution_option(import.recipe, "resolution", kTileResolution, 4, 1024);
    if (!resolution) return resolution.error();
    read.raw_resolution = *resolution;
  }
  const Result<LabelVolume> volume =
      is_vdb_file(import.file) ? read_label_grid(import)
                               : read_label_volume(import.file, read, &import.progress, &import.notes);
  if (!volume) return volume.error();
  return make_label_tile(*volume, import.options.percolating, import.options.threads, &report,
                         &import.progress);
}

Result<TileMap> import_heights(const Import& import, TileReport& report) {
  HeightTileOptions options;
  const auto resolution = resolution_option(import.recipe, "resolution", options.resolution, 4, 1024);
  if (!resolution) return resolution.error();
  options.resolution = *resolution;
  const auto gap = number_option(import.recipe, "gap", options.gap, 0, 1);
  if (!gap) return gap.error();
  options.gap = *gap;
  const auto top = number_option(import.recipe, "top", options.high, 1e-3, 1000);
  if (!top) return top.error();
  options.high = *top;
  const auto up = choice_option(import.recipe, "up", {"white", "black"});
  if (!up) return up.error();
  Result<HeightSamples> samples = read_height_file(import.file, {}, &import.progress);
  if (!samples) return samples.error();
  import.notes.add(samples->notes);
  const HeightField field{.width = samples->width,
                          .depth = samples->depth,
                          .samples = std::move(samples->samples),
                          .spacing = 1,
                          .scale = *up == 1 ? -1.0 : 1.0};
  const Result<LabelVolume> labels = height_labels(field, options);
  if (!labels) return labels.error();
  return make_label_tile(*labels, import.options.percolating, import.options.threads, &report,
                         &import.progress);
}

struct Importer {
  std::string_view name, help;
  std::array<std::string_view, 5> options;  ///< the rest empty
  std::string_view options_help;
  Result<TileMap> (*make)(const Import&, TileReport&);
};

constexpr Importer kImporters[] = {
    {"mesh",
     "closed meshes as cells, wrapping through the border of the tile",
     {"file", "resolution", "size", "origin", "cells"},
     "mesh:file=stones.obj,resolution=64\n"
     "    size: the tile's longest edge in the file's units [all meshes fit in]; origin=XxYxZ: the tile's\n"
     "    corner [centred]; cells=parts|file: a cell for each part that is not connected [parts], or one",
     import_meshes},
    {"labels",
     "a volume of labels, 0 for empty space: a folder of pictures, a TIFF of several, .raw or "
     ".vdb",
     {"file", "resolution", "grid"},
     "labels:file=slices/\n"
     "    resolution=WxHxD is needed for .raw alone; grid=NAME: of a .vdb; --percolating says what is done "
     "with a cell that\n"
     "    meets its own copy through the border",
     import_labels},
    {"heights",
     "a picture that tiles, as a layer of cells: what hangs together above the gap is a cell",
     {"file", "resolution", "gap", "top", "up"},
     "heights:file=bricks.png,resolution=64x16x64,gap=0.3\n"
     "    gap: columns below that share of the heights' range are empty [0]; top: the share that the tile's "
     "upper\n"
     "    border is at [1.25]; up=white|black [white]; y is up [64x32x64]",
     import_heights},
};

std::string names_of_tiles() {
  std::string names = tile_generator_names();
  for (const Importer& importer : kImporters) names += ", " + std::string(importer.name);
  return names;
}

std::string plural(std::uint64_t count, const char* one, const char* several) {
  return std::to_string(count) + " " + (count == 1 ? one : several);
}

/// What the report has to say, as warnings.
void add_warnings(const TileReport& report, std::vector<Warning>& warnings) {
  if (report.dropped_cells > 0)
    warnings.push_back({"cells-dropped", plural(report.dropped_cells, "cell of the tile got no voxel and was",
                                                "cells of the tile got no voxel and were") +
                                             " left out; use fewer cells or a higher resolution"});
  if (report.percolating_cells > 0)
    warnings.push_back(
        {"tile-percolates",
         plural(report.percolating_cells, "cell meets its own copy", "cells meet their own copies") +
             " through the border of the tile and had to be cut, at the middle between them"});
  if (report.contested_voxels > 0)
    warnings.push_back(
        {"cells-overlap", plural(report.contested_voxels, "voxel is", "voxels are") +
                              " inside several cells and went to the first; move the meshes apart"});
}

std::optional<Failure> take_saved(const TileSource& source, SourcedTile& tile) {
  CellObject object;
  tile.notes.files.insert(parse_asset_path(source.saved).file);
  if (auto failure = read_named_object(source.saved, object)) return failure;
  tile.recipe = std::filesystem::path(source.saved).filename().string();
  for (const auto& [key, value] : object.metadata) {
    if (key == "tile") tile.recipe = value;
    if (key == "color") tile.color_recipe = value;
  }
  tile.tile = std::move(object.tile);
  tile.colors = {std::move(object.color), std::move(object.cell_colors)};
  tile.normals = std::move(object.normals);
  return std::nullopt;
}

}  // namespace

Recipe without_folders(Recipe recipe) {
  for (const char* option : {"file", "texture"}) {
    const auto file = recipe.options.find(option);
    if (file == recipe.options.end()) continue;
    const std::filesystem::path path = file->second;
    file->second = (path.has_filename() ? path : path.parent_path()).filename().string();
  }
  return recipe;
}

Result<TileSource> parse_tile_source(const std::string& text, std::string option) {
  TileSource source;
  source.option = std::move(option);
  if (is_asset_path(text)) {
    source.saved = text;
    return source;
  }
  Result<Recipe> recipe = parse_recipe(text);
  if (!recipe) return recipe.error();
  source.recipe = std::move(*recipe);
  return source;
}

bool reads_labels(const TileSource& source) {
  return source.saved.empty() && (source.recipe.name == "labels" || source.recipe.name == "heights");
}

std::optional<Failure> make_sourced_tile(const TileSource& source, const TileSourceOptions& options,
                                         const Progress& progress, SourcedTile& tile) {
  if (!source.saved.empty()) return take_saved(source, tile);
  TileReport report;
  const auto keep = [&](Result<TileMap> made) {
    tile.tile = std::move(*made);
    tile.recipe = to_text(without_folders(source.recipe));
    add_warnings(report, tile.warnings);
    return std::nullopt;
  };
  for (const Importer& importer : kImporters) {
    if (importer.name != source.recipe.name) continue;
    if (const Status status = check_options(source.recipe, "tile import", importer.options); !status)
      return Failure{status.error(), source.option};
    const auto file = source.recipe.options.find("file");
    if (file == source.recipe.options.end())
      return usage(source.option, "a file is missing; write " + source.recipe.name + ":file=NAME");
    tile.notes.files.insert(file->second);
    Result<TileMap> made =
        importer.make({source.recipe, file->second, options, progress, tile.notes}, report);
    if (made) return keep(std::move(made));
    return Failure{made.error(), made.error().code == ErrorCode::kUsage ? source.option : file->second};
  }
  if (!is_tile_generator(source.recipe.name))
    return usage(source.option, "there is no tile '" + source.recipe.name +
                                    "'; there are: " + names_of_tiles() + ", and files .meso");
  Result<TileMap> made = make_tile(source.recipe, options.threads, &report, &progress);
  if (!made) return Failure{made.error(), source.option};
  return keep(std::move(made));
}

std::string tile_sources_help() {
  std::string text = tile_generators_help();
  for (const Importer& importer : kImporters)
    text += std::string(importer.name) + ": " + std::string(importer.help) + "\n    " +
            std::string(importer.options_help) + "\n";
  return text + "FILE.meso: the tile of that file, with its colors and normals\n";
}

}  // namespace mesocell
