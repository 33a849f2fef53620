// Writes a cube of 1 m, one tile of one cell, with the installed runtime alone: `make_cube cube.meso`.
#include <cstdio>

#include "format/cell_object_io.h"
#include "format/file.h"
#include "format/validate.h"

int main(int argc, char** argv) {
  using namespace mesocell;
  CellObject object;
  object.grid = {{0, 0, 0}, 0.25, {1, 1, 1}};
  object.tile.resolution = {4, 4, 4};
  object.tile.cell_count = 1;
  object.tile.pieces = {{1, {0, 0, 0}}};
  object.tile.voxel_ids.assign(64, 1);
  object.membership.tiles = object.grid.tiles;
  object.membership.cell_count = 1;
  object.membership.entries = {static_cast<std::uint32_t>(Tag::kInside)};
  const Result<std::vector<std::byte>> bytes = encode_cell_object(object);
  if (!bytes || argc < 2 || !write_file(argv[1], *bytes)) return 4;
  return validate(*bytes).valid ? 0 : 1;
}
