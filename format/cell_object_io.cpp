#include "format/cell_object_io.h"

#include <algorithm>
#include <cassert>
#include <new>
#include <string>

#include "format/block_table.h"
#include "format/cell_object_chunks.h"
#include "format/normal_map.h"
#include "format/representation.h"

namespace mesocell {
namespace {

Error no_such_asset(std::size_t asset, std::size_t count) {
  return Error{ErrorCode::kUsage, "there is no asset " + std::to_string(asset) + ": the file has " +
                                      std::to_string(count) + ", counted from 0"};
}

/// What follows from sizes that a caller may have asked for in good faith.
Status check_format_limits(const CellObject& object) {
  std::uint64_t tiles = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    tiles *= object.grid.tiles[a];
    if (tiles > kMaxTiles)
      return Error{ErrorCode::kLimit, "a grid has at most 2147483647 tiles; use fewer", "grid-tiles"};
  }
  for (std::size_t a = 0; a < 3; ++a) {
    if (std::uint64_t{object.grid.tiles[a]} * object.tile.resolution[a] > kMaxAxisVoxels) {
      return Error{
          ErrorCode::kLimit,
          "a grid has at most 1073741824 voxels along an axis; use fewer tiles or a lower resolution",
          "grid-extent"};
    }
  }
  return {};
}

using Importance = ContainerWriter::Importance;

/// MEMB is what is read in parts, a tile's tags at a time; the other chunks are needed whole. Smaller blocks
/// cost size: of a bunny of 256 tiles and 64 cells, 0.81 MB at 256 KiB are 0.89 MB at 128, 1.0 MB at 64
/// and 1.3 MB at 16.
constexpr std::uint32_t kMembershipBlockBytes = 1u << 18;
/// What the tags of a tile may take of the file, with some room for head and block table below 64 KiB.
constexpr std::uint64_t kTileTagsBytes = 57u << 10;

/// Whether the tags of any tile are read from at most kTileTagsBytes of MEMB.
bool tile_tags_fit(const MembershipLayout& layout, std::uint64_t tile_count, std::uint32_t block_bytes,
                   std::span<const std::uint64_t> stored) {
  const auto block_of = [&](std::uint64_t at) { return static_cast<std::size_t>(at / block_bytes); };
  // Each page of states is in one block or two, which may hold its rank too.
  std::uint64_t of_page = 0;
  for (std::uint64_t p = 0; p < MembershipLayout::page_count(tile_count); ++p) {
    const std::uint64_t begin = layout.states_at + p * (MembershipLayout::kPageTiles / 4);
    const std::uint64_t end = std::min(begin + MembershipLayout::kPageTiles / 4, layout.ranks_at);
    const std::size_t first = block_of(begin), last = block_of(end - 1);
    const std::size_t rank = block_of(layout.ranks_at + p * sizeof(std::uint32_t));
    of_page = std::max(of_page,
                       stored[first] + (last > first ? stored[last] : 0) + (rank > last ? stored[rank] : 0));
  }
  std::uint64_t of_tags = 0;
  for (std::uint64_t at = layout.tags_at; at < layout.bytes; at += layout.tile_tag_bytes) {
    const std::size_t first = block_of(at), last = block_of(at + layout.tile_tag_bytes - 1);
    of_tags = std::max(of_tags, stored[first] + (last > first ? stored[last] : 0));
  }
  return stored[0] + of_page + of_tags <= kTileTagsBytes;
}

Status add_asset(ContainerWriter& writer, const NamedCellObject& named, const FormatVersion& version) {
  const CellObject& object = *named.object;
  if (Status status = check_metadata(object.metadata); !status) return status;
  if (Status status = check_format_limits(object); !status) return status;
  assert(object.membership.tiles == object.grid.tiles);
  assert(object.membership.cell_count == object.tile.cell_count);
  assert(object.membership.entries.size() == object.grid.tile_count());
  assert(!object.cell_colors || object.cell_colors->colors.size() == object.tile.cell_count);
  assert(!object.instance_colors ||
         object.instance_colors->colors.size() == count_instances(object.membership).inside);
  assert(!object.surface_colors || object.surface_colors->entries.size() == object.grid.tile_count());
  assert(!object.normals || object.normals->normals.size() == count_boundary_voxels(object.tile));

  writer.begin_asset(kCellObjectRepresentation, named.name);
  writer.add_chunk(kGridChunk, Importance::kCritical, encode_grid(object.grid));
  writer.add_chunk(kTileChunk, Importance::kCritical, encode_tile(object.tile));
  const std::vector<std::byte> memb = encode_membership(object.membership);
  const auto layout = MembershipLayout::of(object.grid.tile_count(), object.tile.cell_count,
                                           read_membership_header(memb).mixed_count);
  writer.add_chunk(kMembershipChunk, Importance::kCritical, memb, kMembershipBlockBytes,
                   [&](std::uint32_t block_bytes, std::span<const std::uint64_t> stored) {
                     return tile_tags_fit(layout, object.grid.tile_count(), block_bytes, stored);
                   });
  if (object.color) writer.add_chunk(kColorChunk, Importance::kSkippable, encode_color(*object.color));
  if (object.cell_colors)
    writer.add_chunk(kCellColorChunk, Importance::kSkippable, encode_colors(*object.cell_colors));
  if (object.instance_colors)
    writer.add_chunk(kInstanceColorChunk, Importance::kSkippable, encode_colors(*object.instance_colors));
  if (object.surface_colors && version.minor >= 1)
    writer.add_chunk(kSurfaceColorChunk, Importance::kSkippable,
                     encode_surface_colors(*object.surface_colors));
  if (object.normals) writer.add_chunk(kNormalChunk, Importance::kSkippable, encode_normals(*object.normals));
  if (object.basic_mesh && version.minor >= 1)
    writer.add_chunk(kBasicMeshChunk, Importance::kSkippable, encode_basic_mesh(*object.basic_mesh));
  if (!object.metadata.empty())
    writer.add_chunk(kTextChunk, Importance::kSkippable, encode_text(object.metadata));
  return {};
}

#ifndef NDEBUG
/// Whether the bytes hold the objects: a writer that did not would lose what it was given.
bool reads_back(std::span<const std::byte> file, std::span<const NamedCellObject> objects,
                const FormatVersion& version) {
  const ReadLimits no_limits{~std::uint64_t{0}, ~std::uint64_t{0}, ~std::uint64_t{0}};
  for (std::size_t i = 0; i < objects.size(); ++i) {
    auto copy = read_cell_object(file, no_limits, i);
    if (!copy && copy.error().code == ErrorCode::kLimit) return true;  // no memory to tell
    if (copy && version.minor == 0) {                                  // which has none of these
      copy->basic_mesh = objects[i].object->basic_mesh;
      copy->surface_colors = objects[i].object->surface_colors;
    }
    if (!copy || !(*copy == *objects[i].object)) return false;
  }
  return true;
}
#endif

}  // namespace

Result<std::vector<std::byte>> encode_cell_object(const CellObject& object, const WriteOptions& options) {
  const NamedCellObject named{&object, {}};
  return encode_cell_objects({&named, 1}, options);
}

Result<std::vector<std::byte>> encode_cell_objects(std::span<const NamedCellObject> objects,
                                                   const WriteOptions& options) try {
  assert(!objects.empty());
  ContainerWriter writer(options);
  for (const NamedCellObject& named : objects)
    if (Status status = add_asset(writer, named, options.version); !status) return status.error();
  auto bytes = writer.finish();
  assert((!bytes.ok() || reads_back(*bytes, objects, options.version)) &&
         "the maps do not hold what format/cell_object.h says");
  return bytes;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

std::optional<CellObject> check_cell_object(std::span<const std::byte> file, const ContainerScan& scan,
                                            std::size_t asset, const ReadLimits& limits, MemoryBudget& budget,
                                            IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  // Decodes the chunk of a type if it is there and usable and hands it to `use`.
  const auto with_chunk = [&](std::uint32_t type, auto use) {
    const auto index = scan.find(asset, type);
    if (!index || !scan.usable[*index] || sink.stopped()) return;
    const ChunkInfo& chunk = scan.chunks[*index];
    std::vector<std::byte> bytes(static_cast<std::size_t>(chunk.decoded_bytes));
    if (!decode_chunk(file, chunk, bytes, sink)) return;
    use(ChunkPayload{type, bytes, chunk.offset + block_data_at(chunk), chunk.codec == kCodecRaw});
  };

  CellObject object;
  std::optional<GridLayout> grid;
  std::optional<TileMap> tile;
  ChunkPayload grid_place;
  with_chunk(kGridChunk, [&](const ChunkPayload& chunk) {
    grid = decode_grid(chunk, limits, sink);
    grid_place = {chunk.type, {}, chunk.file_offset, chunk.raw};
  });
  with_chunk(kTileChunk, [&](const ChunkPayload& chunk) { tile = decode_tile(chunk, budget, sink); });
  if (grid && tile && !check_extent(grid_place, *grid, tile->resolution, sink)) grid.reset();
  std::optional<MembershipMap> membership;
  with_chunk(kMembershipChunk, [&](const ChunkPayload& chunk) {
    membership = decode_membership(chunk, grid ? &*grid : nullptr, tile ? &*tile : nullptr, budget, sink);
  });
  with_chunk(kColorChunk,
             [&](const ChunkPayload& chunk) { object.color = decode_color(chunk, budget, sink); });
  const auto count_if = [](bool known, auto count) {
    return known ? std::optional<std::uint64_t>(count()) : std::nullopt;
  };
  with_chunk(kCellColorChunk, [&](const ChunkPayload& chunk) {
    const auto cells = count_if(tile.has_value(), [&] { return tile->cell_count; });
    object.cell_colors = decode_colors(chunk, cells, budget, sink);
  });
  with_chunk(kInstanceColorChunk, [&](const ChunkPayload& chunk) {
    const auto inside = count_if(membership.has_value(), [&] { return count_instances(*membership).inside; });
    object.instance_colors = decode_colors(chunk, inside, budget, sink);
  });
  with_chunk(kNormalChunk, [&](const ChunkPayload& chunk) {
    object.normals = decode_normals(chunk, tile ? &*tile : nullptr, budget, sink);
  });
  if (scan.minor >= 1) {
    with_chunk(kSurfaceColorChunk, [&](const ChunkPayload& chunk) {
      object.surface_colors =
          decode_surface_colors(chunk, grid ? &*grid : nullptr, tile ? &*tile : nullptr, budget, sink);
    });
    with_chunk(kBasicMeshChunk, [&](const ChunkPayload& chunk) {
      object.basic_mesh = decode_basic_mesh(chunk, budget, sink);
    });
  }
  with_chunk(kTextChunk, [&](const ChunkPayload& chunk) {
    if (auto text = decode_text(chunk, budget, sink)) object.metadata = std::move(*text);
  });
  if (sink.errors() != errors_before || !grid || !tile || !membership) return std::nullopt;
  object.grid = *grid;
  object.tile = std::move(*tile);
  object.membership = std::move(*membership);
  return object;
}

Result<CellObject> decode_cell_object(const Container& container, const ReadLimits& limits,
                                      std::size_t asset) try {
  IssueSink sink = IssueSink::first_error();
  const ContainerScan& scan = container.scan();
  if (asset >= scan.assets.size()) return no_such_asset(asset, scan.assets.size());
  if (!scan_asset(scan, asset, sink) || sink.errors() > 0) return sink.first_error_as_result();
  const AssetInfo& info = scan.assets[asset];
  if (info.representation != kCellObjectRepresentation) {
    sink.add(IssueId::kRepresentationUnknown, kHeaderBytes + asset * kAssetBytes, 0,
             "it is not a cell object");
    return sink.first_error_as_result();
  }
  MemoryBudget budget(limits);
  if (!charge_asset(scan, asset, budget, sink)) return sink.first_error_as_result();
  for (std::size_t i = 0; i < info.chunk_count; ++i) {
    const std::size_t chunk = info.first_chunk + i;
    if (info.rules->find(scan.chunks[chunk].type, scan.minor) &&
        !verify_chunk(container.file(), scan, chunk, sink))
      return sink.first_error_as_result();
  }
  auto object = check_cell_object(container.file(), scan, asset, limits, budget, sink);
  if (!object) return sink.first_error_as_result();
  return std::move(*object);
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<CellObject> read_cell_object(std::span<const std::byte> file, const ReadLimits& limits,
                                    std::size_t asset) try {
  const auto container = Container::open(file, limits);
  if (!container) return container.error();
  if (asset >= container->assets().size()) return no_such_asset(asset, container->assets().size());
  if (Status status = container->verify(asset); !status) return status.error();
  return decode_cell_object(*container, limits, asset);
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

}  // namespace mesocell
