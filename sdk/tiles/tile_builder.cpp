#include "sdk/tiles/tile_builder.h"

#include <cassert>
#include <vector>

namespace mesocell {

TileBuilder::TileBuilder(Index3 resolution, std::uint32_t cells, std::int32_t reach)
    : resolution_(resolution),
      cells_(cells),
      reach_(reach),
      images_(std::uint32_t((2 * reach + 1) * (2 * reach + 1) * (2 * reach + 1))),
      codes_(std::uint64_t{resolution[0]} * resolution[1] * resolution[2], std::uint64_t{cells} * images_) {
  assert(cells >= 1 && cells <= 0xffff);
}

TileMap TileBuilder::finish(unsigned threads, TileReport* report) const {
  std::vector<CodeOwner> owners;
  owners.reserve(std::size_t{cells_} * images_);
  for (std::uint32_t cell = 1; cell <= cells_; ++cell)
    for (std::uint32_t image = 0; image < images_; ++image) owners.push_back({cell, image_shift(image)});
  TileMap tile = assemble_tile(resolution_, codes_, owners, threads);
  if (report) report->dropped_cells = cells_ - tile.cell_count;
  return tile;
}

}  // namespace mesocell
