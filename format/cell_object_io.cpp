#include "format/cell_object_io.h"

#include <cassert>
#include <new>
#include <string>

#include "format/cell_object_chunks.h"
#include "format/normal_map.h"
#include "format/representation.h"

namespace mesocell {
namespace {

Error no_memory() { return Error{ErrorCode::kLimit, "there is not enough memory", "limit-exceeded"}; }

Status check_metadata(const Metadata& metadata) {
  const std::string* previous = nullptr;
  for (const auto& [key, value] : metadata) {
    if (key.empty() || key.size() > kMaxKeyBytes || key.find('\0') != std::string::npos)
      return Error{ErrorCode::kUsage, "a metadata key must have 1 to 256 bytes, none of them zero",
                   "text-key"};
    if (!is_utf8(key) || !is_utf8(value))
      return Error{ErrorCode::kUsage, "metadata must be valid UTF-8", "text-utf8"};
    if (previous && !(*previous < key))
      return Error{ErrorCode::kUsage, "metadata keys must be unique and ascending: '" + key + "'",
                   "text-order"};
    if (value.size() > 0xffffffffu)
      return Error{ErrorCode::kLimit, "a metadata value is longer than 4 GiB", "limit-exceeded"};
    previous = &key;
  }
  return {};
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

}  // namespace

Result<std::vector<std::byte>> encode_cell_object(const CellObject& object) try {
  if (Status status = check_metadata(object.metadata); !status) return status.error();
  if (Status status = check_format_limits(object); !status) return status.error();
  assert(object.membership.tiles == object.grid.tiles);
  assert(object.membership.cell_count == object.tile.cell_count);
  assert(object.membership.entries.size() == object.grid.tile_count());
  assert(object.cell_colors.empty() || object.cell_colors.size() == object.tile.cell_count);
  assert(object.instance_colors.empty() ||
         object.instance_colors.size() == count_instances(object.membership).inside);
  assert(!object.normals || object.normals->normals.size() == count_boundary_voxels(object.tile));

  using Importance = ContainerWriter::Importance;
  ContainerWriter writer;
  writer.add_chunk(kGridChunk, Importance::kCritical, encode_grid(object.grid));
  writer.add_chunk(kTileChunk, Importance::kCritical, encode_tile(object.tile));
  writer.add_chunk(kMembershipChunk, Importance::kCritical, encode_membership(object.membership));
  if (object.color) writer.add_chunk(kColorChunk, Importance::kSkippable, encode_color(*object.color));
  if (!object.cell_colors.empty())
    writer.add_chunk(kCellColorChunk, Importance::kSkippable, encode_colors(object.cell_colors));
  if (!object.instance_colors.empty())
    writer.add_chunk(kInstanceColorChunk, Importance::kSkippable, encode_colors(object.instance_colors));
  if (object.normals) writer.add_chunk(kNormalChunk, Importance::kSkippable, encode_normals(*object.normals));
  if (!object.metadata.empty())
    writer.add_chunk(kTextChunk, Importance::kSkippable, encode_text(object.metadata));
  auto bytes = writer.finish(kCellObjectRepresentation);
#ifndef NDEBUG
  if (bytes.ok()) {
    const ReadLimits no_limits{~std::uint64_t{0}, ~std::uint64_t{0}, ~std::uint64_t{0}};
    const auto copy = read_cell_object(*bytes, no_limits);
    assert(copy.ok() && *copy == object && "the maps do not hold what format/cell_object.h says");
  }
#endif
  return bytes;
} catch (const std::bad_alloc&) {
  return no_memory();
}

std::optional<CellObject> check_cell_object(std::span<const std::byte> file, const ContainerScan& scan,
                                            const ReadLimits& limits, MemoryBudget& budget, IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  // Decodes the chunk of a type if it is there and usable and hands it to `use`.
  const auto with_chunk = [&](std::uint32_t type, auto use) {
    const auto index = scan.find(type);
    if (!index || !scan.usable[*index] || sink.stopped()) return;
    const auto bytes = decode_chunk(file, scan, *index, sink);
    if (!bytes) return;
    const ChunkInfo& chunk = scan.chunks[*index];
    use(ChunkPayload{type, *bytes, chunk.offset, chunk.codec == kCodecRaw});
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
  with_chunk(kCellColorChunk, [&](const ChunkPayload& chunk) {
    if (!tile) return;
    if (auto colors = decode_colors(chunk, tile->cell_count, budget, sink))
      object.cell_colors = std::move(*colors);
  });
  with_chunk(kInstanceColorChunk, [&](const ChunkPayload& chunk) {
    if (!membership) return;
    if (auto colors = decode_colors(chunk, count_instances(*membership).inside, budget, sink))
      object.instance_colors = std::move(*colors);
  });
  with_chunk(kNormalChunk, [&](const ChunkPayload& chunk) {
    object.normals = decode_normals(chunk, tile ? &*tile : nullptr, budget, sink);
  });
  with_chunk(kTextChunk, [&](const ChunkPayload& chunk) {
    if (auto text = decode_text(chunk, budget, sink)) object.metadata = std::move(*text);
  });
  if (sink.errors() != errors_before || !grid || !tile || !membership) return std::nullopt;
  object.grid = *grid;
  object.tile = std::move(*tile);
  object.membership = std::move(*membership);
  return object;
}

Result<CellObject> decode_cell_object(const Container& container, const ReadLimits& limits) try {
  IssueSink sink = IssueSink::first_error();
  const ContainerScan& scan = container.scan();
  if (scan.representation != kCellObjectRepresentation) {
    sink.add(IssueId::kRepresentationUnknown, 12, 0, "it is not a cell object");
    return sink.first_error_as_result();
  }
  MemoryBudget budget(limits);
  for (std::size_t i = 0; i < scan.chunks.size(); ++i) {
    const std::uint32_t type = scan.chunks[i].type;
    if (!budget.charge(scan.chunks[i].decoded_bytes)) {
      sink.add(IssueId::kLimitExceeded, std::nullopt, type, "the chunks' decoded bytes");
      return sink.first_error_as_result();
    }
    if (scan.rules->find(type) && !verify_chunk(container.file(), scan, i, sink))
      return sink.first_error_as_result();
  }
  auto object = check_cell_object(container.file(), scan, limits, budget, sink);
  if (!object) return sink.first_error_as_result();
  return std::move(*object);
} catch (const std::bad_alloc&) {
  return no_memory();
}

Result<CellObject> read_cell_object(std::span<const std::byte> file, const ReadLimits& limits) {
  const auto container = Container::open(file, limits);
  if (!container) return container.error();
  if (Status status = container->verify(); !status) return status.error();
  return decode_cell_object(*container, limits);
}

}  // namespace mesocell
