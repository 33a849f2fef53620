#pragma once

#include "format/cell_object.h"

namespace mesocell {

/// A cell object that shows a tile: each of its cells once, whole. The grid has as many tiles as the cells
/// reach into; the tile at home is 1 m along its longest side, its minimum corner at the origin. Colors,
/// normals and metadata are left to the caller. This is also the form in which a tile is kept in a file.
[[nodiscard]] CellObject make_tile_sample(TileMap tile);

}  // namespace mesocell
