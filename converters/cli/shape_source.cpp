#include "converters/cli/shape_source.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

#include "converters/cli/color_source.h"
#include "converters/cli/height_source.h"
#include "converters/cli/volume_source.h"
#include "converters/image/input_file.h"
#include "converters/import/mesh_file.h"
#include "converters/import/picture_file.h"
#include "sdk/author/tile_sample.h"
#include "sdk/core/recipe.h"
#include "sdk/core/shapes.h"

namespace mesocell {
namespace {

constexpr std::string_view kTilePrefix = "tile:", kShapePrefix = "shape:";

/// A closed mesh, filled with tiles.
class MeshShape final : public ShapeSource {
 public:
  explicit MeshShape(PaintedMesh painted)
      : mesh_(std::move(painted.mesh)), paint_(std::move(painted.paint)) {}
  [[nodiscard]] Result<CellObject> fill(TileMap tile, const AuthorOptions& options, AuthorReport& report,
                                        const Progress& progress) const override {
    return author_cell_object(mesh_, std::move(tile), options, &report, &progress);
  }
  [[nodiscard]] const TriangleMesh& surface() const override { return mesh_; }
  [[nodiscard]] Status check_colors() const override {
    if (mesh_.colors.empty() && paint_.empty()) return mesh_without_colors();
    return {};
  }
  [[nodiscard]] Result<ColorField> color_field(const CellObject& object, unsigned threads,
                                               const Progress*) const override {
    return make_mesh_color_field(object.grid, mesh_, paint_, threads);
  }

 private:
  TriangleMesh mesh_;
  SurfacePaint paint_;
};

/// The cells of a tile themselves.
class TileShape final : public ShapeSource {
 public:
  [[nodiscard]] Result<CellObject> fill(TileMap tile, const AuthorOptions&, AuthorReport&,
                                        const Progress&) const override {
    return make_tile_sample(std::move(tile));
  }
  [[nodiscard]] const TriangleMesh& surface() const override { return none_; }
  [[nodiscard]] Status check_colors() const override { return mesh_without_colors(); }

 private:
  TriangleMesh none_;
};

enum class Content : std::uint8_t { kTile, kGenerated, kPicture, kVolume, kMesh };

/// What an input is, by what the file holds; a file of which nothing is known is left to the meshes, which
/// have the most to say.
Content find_content(const std::string& input) {
  if (tile_of_input(input)) return Content::kTile;
  if (input.starts_with(kShapePrefix)) return Content::kGenerated;
  if (is_volume_input(input)) return Content::kVolume;
  const Result<InputFile> file = InputFile::open(input, UINT64_MAX);
  if (!file) return Content::kMesh;
  std::array<std::byte, 32> head{};
  const std::size_t bytes = std::size_t(std::min<std::uint64_t>(file->size(), head.size()));
  if (!file->read_at(0, std::span(head).first(bytes))) return Content::kMesh;
  const std::string_view text(reinterpret_cast<const char*>(head.data()), bytes);
  return picture_format(text) ? Content::kPicture : Content::kMesh;
}

/// A shape of which more is known.
class DescribedShape final : public ShapeSource {
 public:
  DescribedShape(std::unique_ptr<ShapeSource> shape, Metadata metadata)
      : shape_(std::move(shape)), metadata_(std::move(metadata)) {}
  [[nodiscard]] Result<CellObject> fill(TileMap tile, const AuthorOptions& options, AuthorReport& report,
                                        const Progress& progress) const override {
    return shape_->fill(std::move(tile), options, report, progress);
  }
  [[nodiscard]] const TriangleMesh& surface() const override { return shape_->surface(); }
  [[nodiscard]] Metadata metadata() const override { return metadata_; }
  [[nodiscard]] Status check_colors() const override { return shape_->check_colors(); }
  [[nodiscard]] Result<ColorField> color_field(const CellObject& object, unsigned threads,
                                               const Progress* progress) const override {
    return shape_->color_field(object, threads, progress);
  }

 private:
  std::unique_ptr<ShapeSource> shape_;
  Metadata metadata_;
};

std::optional<Failure> make_generated(const std::string& input, std::unique_ptr<ShapeSource>& shape) {
  const Result<Recipe> recipe = parse_recipe(std::string_view(input).substr(kShapePrefix.size()));
  if (!recipe) return Failure{recipe.error(), input};
  Result<TriangleMesh> mesh = make_shape(*recipe);
  if (!mesh) return Failure{mesh.error(), input};
  shape = make_mesh_shape(std::move(*mesh), {{"shape", to_text(*recipe)}});
  return std::nullopt;
}

Result<PaintedMesh> without_materials(Result<TriangleMesh> mesh) {
  if (!mesh) return mesh.error();
  PaintedMesh painted;
  painted.mesh = std::move(*mesh);
  return painted;
}

std::optional<Failure> read_mesh(const ConvertCommand& command, const Progress& progress,
                                 std::unique_ptr<ShapeSource>& shape, std::vector<Warning>& warnings,
                                 ReadNotes& notes) {
  MeshReadReport report;
  MeshReadOptions options;
  options.texture = texture_of_color(command.color);
  // Pictures of materials are read for whom they color.
  Result<PaintedMesh> mesh =
      takes_mesh_colors(command.color)
          ? read_painted_mesh(command.input, options, &report, &progress)
          : without_materials(read_mesh_file(command.input, options, &report, &progress));
  if (!mesh) return Failure{mesh.error(), mesh.error().code == ErrorCode::kUsage ? "--color" : command.input};
  if (report.dropped_faces > 0)
    warnings.push_back(
        {"faces-dropped", std::to_string(report.dropped_faces) +
                              " triangles with two equal corners were left out; they enclose nothing"});
  for (MeshWarning& warning : report.warnings)
    warnings.push_back({std::move(warning.id), std::move(warning.text)});
  notes.add(report.notes);
  if (!takes_mesh_colors(command.color) && !command.keep_mesh && !mesh->mesh.colors.empty())
    notes.lose("colors of vertices");
  shape = std::make_unique<MeshShape>(std::move(*mesh));
  return std::nullopt;
}

}  // namespace

std::optional<std::string> tile_of_input(const std::string& input) {
  if (!input.starts_with(kTilePrefix)) return std::nullopt;
  return input.substr(kTilePrefix.size());
}

Result<ColorField> ShapeSource::color_field(const CellObject&, unsigned, const Progress*) const {
  return mesh_without_colors();
}

std::unique_ptr<ShapeSource> make_mesh_shape(TriangleMesh mesh, Metadata metadata) {
  PaintedMesh painted;
  painted.mesh = std::move(mesh);
  return std::make_unique<DescribedShape>(std::make_unique<MeshShape>(std::move(painted)),
                                          std::move(metadata));
}

bool is_shape_key(std::string_view key) { return key == "heights" || key == "shape" || key == "source"; }

std::optional<Failure> read_shape(const ConvertCommand& command, const Progress& progress,
                                  std::unique_ptr<ShapeSource>& shape, std::vector<Warning>& warnings,
                                  ReadNotes& notes) {
  const std::string& input = command.input;
  const Content content = find_content(input);
  if (command.heights && content != Content::kPicture)
    warnings.push_back({"option-unused", "--heights has no effect where the input is no picture"});
  if ((command.grid || command.iso) && content != Content::kVolume)
    warnings.push_back({"option-unused", "--grid and --iso have no effect where the input is no volume"});
  switch (content) {
    case Content::kTile:
      shape = std::make_unique<TileShape>();
      return std::nullopt;
    case Content::kGenerated:
      return make_generated(input, shape);
    case Content::kPicture: {
      const Result<HeightPlan> plan = parse_height_plan(command.heights.value_or(""));
      if (!plan) return Failure{plan.error(), "--heights"};
      return read_heights(input, *plan, progress, shape, warnings, notes);
    }
    case Content::kVolume:
      return read_volume_shape(command, progress, shape, warnings, notes);
    case Content::kMesh:
      return read_mesh(command, progress, shape, warnings, notes);
  }
  return std::nullopt;
}

}  // namespace mesocell
