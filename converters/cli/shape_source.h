#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "converters/cli/commands.h"
#include "converters/cli/console.h"
#include "converters/import/read_notes.h"
#include "format/cell_object.h"
#include "format/text_chunk.h"
#include "sdk/author/cell_object.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/surface/color_field.h"

namespace mesocell {

/// What the input of `convert` gives a cell object its shape by.
class ShapeSource {
 public:
  virtual ~ShapeSource() = default;

  /// Fills the shape with a tile. Errors: those of author_cell_object().
  [[nodiscard]] virtual Result<CellObject> fill(TileMap tile, const AuthorOptions& options,
                                                AuthorReport& report, const Progress& progress) const = 0;
  /// The surface of the shape, metres; no triangles if it has none but the cells'.
  [[nodiscard]] virtual const TriangleMesh& surface() const = 0;
  /// What the asset's metadata says of it, beside how it was filled. See is_shape_key().
  [[nodiscard]] virtual Metadata metadata() const { return {}; }
  /// Whether color_field() is in vain, as far as can be told before the work. Errors: kUsage.
  [[nodiscard]] virtual Status check_colors() const { return {}; }
  /// The shape's own colors in an object that it filled; the shape must outlive them. Errors: kUsage (it has
  /// no colors), those of reading them.
  [[nodiscard]] virtual Result<ColorField> color_field(const CellObject& object, unsigned threads,
                                                       const Progress* progress) const;
};

/// A mesh as a shape, and what the metadata says of it.
[[nodiscard]] std::unique_ptr<ShapeSource> make_mesh_shape(TriangleMesh mesh, Metadata metadata);

/// The tile that an input shows alone, as for --tile; none if the input is a shape to be filled.
[[nodiscard]] std::optional<std::string> tile_of_input(const std::string& input);

/// Reads or makes the input of `convert`, by what the file holds; remarks are added to `warnings` and
/// `notes`. Untrusted input: safe.
[[nodiscard]] std::optional<Failure> read_shape(const ConvertCommand& command, const Progress& progress,
                                                std::unique_ptr<ShapeSource>& shape,
                                                std::vector<Warning>& warnings, ReadNotes& notes);

/// Whether ShapeSource::metadata() may have that key, so that --meta may not.
[[nodiscard]] bool is_shape_key(std::string_view key);

}  // namespace mesocell
