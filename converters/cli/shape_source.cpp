#include "converters/cli/shape_source.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

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
  explicit MeshShape(TriangleMesh mesh) : mesh_(std::move(mesh)) {}
  [[nodiscard]] Result<CellObject> fill(TileMap tile, const AuthorOptions& options, AuthorReport& report,
                                        const Progress& progress) const override {
    return author_cell_object(mesh_, std::move(tile), options, &report, &progress);
  }
  [[nodiscard]] const TriangleMesh& surface() const override { return mesh_; }

 private:
  TriangleMesh mesh_;
};

/// The cells of a tile themselves.
class TileShape final : public ShapeSource {
 public:
  [[nodiscard]] Result<CellObject> fill(TileMap tile, const AuthorOptions&, AuthorReport&,
                                        const Progress&) const override {
    return make_tile_sample(std::move(tile));
  }
  [[nodiscard]] const TriangleMesh& surface() const override { return none_; }

 private:
  TriangleMesh none_;
};

enum class Content : std::uint8_t { kTile, kGenerated, kPicture, kVolume, kMesh };

/// What an input is, by what the file holds; a file of which nothing is known is left to the meshes, which
/// have the most to say.
Content find_content(const std::string& input) {
  if (tile_of_input(input)) return Content::kTile;
  if (input.starts_with(kShapePrefix)) return Content::kGenerated;
  const Result<InputFile> file = InputFile::open(input, UINT64_MAX);
  if (!file) return Content::kMesh;
  std::array<std::byte, 32> head{};
  const std::size_t bytes = std::size_t(std::min<std::uint64_t>(file->size(), head.size()));
  if (!file->read_at(0, std::span(head).first(bytes))) return Content::kMesh;
  const std::string_view text(reinterpret_cast<const char*>(head.data()), bytes);
  if (picture_format(text)) return Content::kPicture;
  return is_volume_input(input) ? Content::kVolume : Content::kMesh;
}

/// A shape of its own name, with no file.
class GeneratedShape final : public ShapeSource {
 public:
  GeneratedShape(TriangleMesh mesh, std::string recipe)
      : mesh_(std::move(mesh)), recipe_(std::move(recipe)) {}
  [[nodiscard]] Result<CellObject> fill(TileMap tile, const AuthorOptions& options, AuthorReport& report,
                                        const Progress& progress) const override {
    return mesh_.fill(std::move(tile), options, report, progress);
  }
  [[nodiscard]] const TriangleMesh& surface() const override { return mesh_.surface(); }
  [[nodiscard]] Metadata metadata() const override { return {{"shape", recipe_}}; }

 private:
  MeshShape mesh_;
  std::string recipe_;
};

std::optional<Failure> make_generated(const std::string& input, std::unique_ptr<ShapeSource>& shape) {
  const Result<Recipe> recipe = parse_recipe(std::string_view(input).substr(kShapePrefix.size()));
  if (!recipe) return Failure{recipe.error(), input};
  Result<TriangleMesh> mesh = make_shape(*recipe);
  if (!mesh) return Failure{mesh.error(), input};
  shape = std::make_unique<GeneratedShape>(std::move(*mesh), to_text(*recipe));
  return std::nullopt;
}

std::optional<Failure> read_mesh(const std::string& input, const Progress& progress,
                                 std::unique_ptr<ShapeSource>& shape, std::vector<Warning>& warnings) {
  MeshReadReport report;
  Result<TriangleMesh> mesh = read_mesh_file(input, {}, &report, &progress);
  if (!mesh) return Failure{mesh.error(), input};
  if (report.dropped_faces > 0)
    warnings.push_back(
        {"faces-dropped", std::to_string(report.dropped_faces) +
                              " triangles with two equal corners were left out; they enclose nothing"});
  shape = std::make_unique<MeshShape>(std::move(*mesh));
  return std::nullopt;
}

}  // namespace

std::optional<std::string> tile_of_input(const std::string& input) {
  if (!input.starts_with(kTilePrefix)) return std::nullopt;
  return input.substr(kTilePrefix.size());
}

std::unique_ptr<ShapeSource> make_mesh_shape(TriangleMesh mesh) {
  return std::make_unique<MeshShape>(std::move(mesh));
}

bool is_shape_key(std::string_view key) { return key == "heights" || key == "shape" || key == "source"; }

std::optional<Failure> read_shape(const ConvertCommand& command, const Progress& progress,
                                  std::unique_ptr<ShapeSource>& shape, std::vector<Warning>& warnings) {
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
      return read_heights(input, *plan, progress, shape, warnings);
    }
    case Content::kVolume:
      return read_volume_shape(command, progress, shape, warnings);
    case Content::kMesh:
      return read_mesh(input, progress, shape, warnings);
  }
  return std::nullopt;
}

}  // namespace mesocell
