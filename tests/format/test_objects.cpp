#include "tests/format/test_objects.h"

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>

#include "format/cell_object_io.h"
#include "format/normal_map.h"

namespace mesocell::test {
namespace {

struct Label {
  std::uint32_t cell = 0;  // 0 empty
  std::array<int, 3> home{};
};

/// Moves the homes of each cell so that its first voxel has home (0,0,0), and numbers the cells that are
/// there.
void normalise(std::vector<Label>& labels, const Index3& r, std::uint32_t& cell_count) {
  using Place = std::array<int, 3>;  // z, y, x
  std::map<std::uint32_t, std::pair<Place, std::array<int, 3>>> first;
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const Label& label = labels[v];
    if (label.cell == 0) continue;
    const int x = int(v % r[0]), y = int(v / r[0] % r[1]), z = int(v / r[0] / r[1]);
    const Place place = {z - int(r[2]) * label.home[2], y - int(r[1]) * label.home[1],
                         x - int(r[0]) * label.home[0]};
    const auto [at, is_new] = first.try_emplace(label.cell, place, label.home);
    if (!is_new && place < at->second.first) at->second = {place, label.home};
  }
  std::map<std::uint32_t, std::uint32_t> number;
  for (const auto& [cell, entry] : first) number.emplace(cell, std::uint32_t(number.size()) + 1);
  for (Label& label : labels) {
    if (label.cell == 0) continue;
    for (std::size_t a = 0; a < 3; ++a) label.home[a] -= first.at(label.cell).second[a];
    label.cell = number.at(label.cell);
  }
  cell_count = std::uint32_t(number.size());
}

MembershipMap random_membership(Rng& rng, const Index3& tiles, std::uint32_t cell_count,
                                std::uint32_t longest_run) {
  MembershipMap m;
  m.rule = rng.below(2) == 0 ? MembershipRule::kCentre : MembershipRule::kConservative;
  m.tiles = tiles;
  m.cell_count = cell_count;
  const std::size_t count = std::size_t{tiles[0]} * tiles[1] * tiles[2];
  std::uint32_t blocks = 0;
  while (m.entries.size() < count) {
    const std::uint32_t kind = rng.below(cell_count > 1 ? 4 : 3);
    for (std::uint32_t i = 0, n = 1 + rng.below(longest_run); i < n && m.entries.size() < count; ++i) {
      if (kind < 3) {
        m.entries.push_back(kind);
        continue;
      }
      m.entries.push_back(MembershipMap::kFirstBlock + blocks++);
      const std::size_t at = m.blocks.size();
      m.blocks.resize(at + m.block_bytes());
      std::uint32_t first_tag = 0;
      for (std::uint32_t c = 0; c < cell_count; ++c) {
        std::uint32_t tag = rng.below(3);
        if (c == 0) first_tag = tag;
        // The last cell makes sure that the tile is mixed.
        if (c + 1 == cell_count && tag == first_tag) tag = (tag + 1) % 3;
        m.blocks[at + c / 4] = std::uint8_t(m.blocks[at + c / 4] | tag << (2 * (c % 4)));
      }
    }
  }
  return m;
}

std::vector<Rgb8> random_colors(Rng& rng, std::uint64_t count) {
  std::vector<Rgb8> colors(static_cast<std::size_t>(count));
  for (Rgb8& color : colors)
    for (std::uint8_t& channel : color) channel = std::uint8_t(rng.below(256));
  return colors;
}

void add_random_maps(Rng& rng, unsigned maps, CellObject& object) {
  if ((maps & kColorMap) != 0) {
    ColorMap color;
    for (std::uint32_t& r : color.resolution) r = 1 + rng.below(6);
    color.voxels =
        random_colors(rng, std::uint64_t{color.resolution[0]} * color.resolution[1] * color.resolution[2]);
    object.color = std::move(color);
  }
  if ((maps & kCellColors) != 0)
    object.cell_colors = ColorList{random_colors(rng, object.tile.cell_count), 0.5f};
  if ((maps & kInstanceColors) != 0)
    object.instance_colors = ColorList{random_colors(rng, count_instances(object.membership).inside), 0};
  if ((maps & kNormals) != 0) {
    NormalMap normals;
    for (const std::uint8_t at_boundary : boundary_voxels(object.tile))
      if (at_boundary != 0)
        normals.normals.push_back(
            {std::uint8_t(rng.below(kMaxNormalByte + 1)), std::uint8_t(rng.below(kMaxNormalByte + 1))});
    object.normals = std::move(normals);
  }
  if ((maps & kSurfaceColors) != 0)
    object.surface_colors = random_surface_colors(rng, object.tile.resolution, object.grid.tile_count());
}

}  // namespace

TileMap random_tile(Rng& rng, const RandomObjectOptions& options) {
  TileMap tile;
  tile.resolution = options.resolution;
  const Index3& r = tile.resolution;
  std::vector<Label> labels(static_cast<std::size_t>(tile.voxel_count()));
  std::map<std::array<std::uint32_t, 3>, Label> of_block;
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const std::uint32_t x = std::uint32_t(v % r[0]), y = std::uint32_t(v / r[0] % r[1]),
                        z = std::uint32_t(v / r[0] / r[1]);
    const auto [at, is_new] =
        of_block.try_emplace({x / options.block, y / options.block, z / options.block}, Label{});
    if (is_new) {
      at->second.cell = rng.below(options.cells + 1);
      for (int& h : at->second.home) h = int(rng.below(std::uint32_t(2 * options.reach + 1))) - options.reach;
    }
    labels[v] = at->second;
  }
  labels[0].cell = 1;
  normalise(labels, r, tile.cell_count);

  std::map<std::tuple<std::uint32_t, int, int, int>, std::uint32_t> ids;
  const auto key = [](const Label& l) { return std::tuple(l.cell, l.home[2], l.home[1], l.home[0]); };
  for (const Label& label : labels)
    if (label.cell != 0) ids.emplace(key(label), 0);
  for (auto& [k, id] : ids) {
    const auto& [cell, z, y, x] = k;
    tile.pieces.push_back({std::uint16_t(cell), {std::int8_t(x), std::int8_t(y), std::int8_t(z)}});
    id = std::uint32_t(tile.pieces.size());
  }
  tile.id_bytes = TileMap::id_bytes_for(tile.pieces.size());
  for (const Label& label : labels) {
    const std::uint32_t id = label.cell == 0 ? 0 : ids.at(key(label));
    for (std::uint32_t b = 0; b < tile.id_bytes; ++b) tile.voxel_ids.push_back(std::uint8_t(id >> (8 * b)));
  }
  return tile;
}

SurfaceColors random_surface_colors(Rng& rng, const Index3& tile, std::uint64_t tiles) {
  SurfaceColors map;
  for (std::size_t a = 0; a < 3; ++a)
    map.resolution[a] = 1 + rng.below(std::min(tile[a], SurfaceColors::kMaxResolution));
  map.max_error = 0.75f;
  for (std::uint64_t t = 0; t < tiles; ++t) {
    const bool last_chance = t + 1 == tiles && map.first.empty();
    if (!last_chance && rng.below(2) == 0) {
      map.entries.push_back(SurfaceColors::kNoBrick);
      continue;
    }
    map.entries.push_back(std::uint32_t(map.first.size()));
    map.first.push_back(std::uint32_t(map.colors.size()));
    const std::size_t at = map.masks.size();
    map.masks.resize(at + map.mask_bytes());
    const std::uint32_t voxels = std::uint32_t(map.voxels_per_brick()), one = rng.below(voxels),
                        share = rng.below(3);  // halves that have a color
    for (std::uint32_t v = 0; v < voxels; ++v) {
      if (v != one && rng.below(2) >= share) continue;
      map.masks[at + v / 8] = std::uint8_t(map.masks[at + v / 8] | 1u << v % 8);
      Rgb8 color;
      for (std::uint8_t& channel : color) channel = std::uint8_t(rng.below(256));
      map.colors.push_back(color);
    }
  }
  return map;
}

CellObject random_object(std::uint64_t seed, const RandomObjectOptions& options) {
  Rng rng(seed);
  CellObject object;
  object.tile = random_tile(rng, options);
  for (double& v : object.grid.box_min) v = rng.uniform(-100, 100);
  object.grid.voxel_edge = rng.uniform(1e-3, 1);
  object.grid.tiles = options.tiles;
  object.membership = random_membership(rng, options.tiles, object.tile.cell_count, options.longest_run);
  std::map<std::string, std::string> texts;
  const std::array<std::string, 5> letters = {"a", "\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x90\xb0", "z"};
  while (texts.size() < options.texts) {
    std::string key = "k", value;
    for (std::uint32_t i = 0, n = rng.below(5); i < n; ++i) key += letters[rng.below(5)];
    for (std::uint32_t i = 0, n = rng.below(40); i < n; ++i) value += letters[rng.below(5)];
    texts[key] = value;
  }
  object.metadata.assign(texts.begin(), texts.end());
  add_random_maps(rng, options.maps, object);
  return object;
}

CellObject random_small_object(std::uint64_t seed) {
  Rng rng(seed ^ 0x5eedu);
  RandomObjectOptions options;
  for (std::uint32_t& r : options.resolution) r = 4 + rng.below(6);
  for (std::uint32_t& t : options.tiles) t = 1 + rng.below(5);
  options.cells = 1 + rng.below(rng.below(4) == 0 ? 120 : 9);
  options.reach = rng.below(8) == 0 ? 60 : int(rng.below(3));
  options.block = 1 + rng.below(3);
  options.longest_run = 1 + rng.below(30);
  options.texts = rng.below(4);
  options.maps = rng.below(kMapsOf1_0 + 1);
  if (rng.below(3) == 0) options.maps |= kSurfaceColors;
  return random_object(seed, options);
}

CellObject walkthrough_object() {
  CellObject object;
  object.grid.voxel_edge = 0.25;
  object.grid.tiles = {2, 1, 1};
  TileMap& tile = object.tile;
  tile.resolution = {4, 4, 4};
  tile.cell_count = 2;
  tile.pieces = {{1, {0, 0, 0}}, {2, {-1, 0, 0}}, {2, {0, 0, 0}}};
  tile.voxel_ids.assign(64, 0);
  for (std::size_t row = 0; row < 8; ++row) {  // y and z in 0…3 and 0…1
    tile.voxel_ids[4 * row + 0] = 2;
    tile.voxel_ids[4 * row + 1] = 1;
    tile.voxel_ids[4 * row + 3] = 3;
  }
  object.membership.tiles = object.grid.tiles;
  object.membership.cell_count = 2;
  object.membership.entries = {1, MembershipMap::kFirstBlock};
  object.membership.blocks = {0b1001};
  object.metadata = {{"name", "tiny"}};
  return object;
}

std::vector<std::vector<std::byte>> small_files() {
  RandomObjectOptions compressible;
  compressible.resolution = {8, 8, 8};
  compressible.block = 4;
  compressible.texts = 0;
  RandomObjectOptions with_maps;
  with_maps.resolution = {4, 4, 4};
  with_maps.tiles = {2, 1, 2};
  with_maps.cells = 3;
  with_maps.block = 2;
  with_maps.texts = 1;
  with_maps.maps = kAllMaps;
  return {encoded(walkthrough_object()), encoded(random_object(7)), encoded(random_object(8, compressible)),
          encoded(random_object(9, with_maps))};
}

std::vector<std::byte> encoded(const CellObject& object) {
  auto bytes = encode_cell_object(object);
  if (!bytes) throw std::runtime_error(bytes.error().message);
  return std::move(*bytes);
}

}  // namespace mesocell::test
