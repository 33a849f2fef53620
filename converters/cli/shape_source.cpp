#include "converters/cli/shape_source.h"

#include <string_view>
#include <utility>

#include "converters/import/mesh_file.h"
#include "sdk/author/tile_sample.h"
#include "sdk/surface/instance_colors.h"

namespace mesocell {
namespace {

constexpr std::string_view kTilePrefix = "tile:";

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
  [[nodiscard]] Result<std::vector<Rgb8>> instance_colors(const CellObject& object, unsigned threads,
                                                          const Progress* progress) const override {
    return make_instance_colors(object, mesh_, paint_, threads, progress);
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

}  // namespace

Result<std::vector<Rgb8>> ShapeSource::instance_colors(const CellObject&, unsigned, const Progress*) const {
  return mesh_without_colors();
}

std::optional<std::string> tile_of_input(const std::string& input) {
  if (!input.starts_with(kTilePrefix)) return std::nullopt;
  return input.substr(kTilePrefix.size());
}

std::optional<Failure> read_shape(const std::string& input, const Progress& progress,
                                  std::unique_ptr<ShapeSource>& shape, std::vector<Warning>& warnings) {
  if (tile_of_input(input)) {
    shape = std::make_unique<TileShape>();
    return std::nullopt;
  }
  MeshReadReport report;
  Result<PaintedMesh> mesh = read_painted_mesh(input, {}, &report, &progress);
  if (!mesh) return Failure{mesh.error(), input};
  if (report.dropped_faces > 0)
    warnings.push_back(
        {"faces-dropped", std::to_string(report.dropped_faces) +
                              " triangles with two equal corners were left out; they enclose nothing"});
  for (MeshWarning& warning : report.warnings)
    warnings.push_back({std::move(warning.id), std::move(warning.text)});
  shape = std::make_unique<MeshShape>(std::move(*mesh));
  return std::nullopt;
}

}  // namespace mesocell
