#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "format/block_table.h"
#include "format/cell_object.h"
#include "format/fourcc.h"
#include "format/text_chunk.h"

/// The chunks of a cell object, a function each way for each. [spec 4]
/// Decoders take untrusted input: safe. They check every rule, report to the sink, allocate after the sizes
/// are checked against the chunk and the budget, and return nothing after an error of theirs. Encoders expect
/// maps that hold what format/cell_object.h says.
namespace mesocell {

inline constexpr std::uint32_t kCellObjectRepresentation = fourcc("CELL");
inline constexpr std::uint32_t kGridChunk = fourcc("GRID");
inline constexpr std::uint32_t kTileChunk = fourcc("TILE");
inline constexpr std::uint32_t kMembershipChunk = fourcc("MEMB");
inline constexpr std::uint32_t kColorChunk = fourcc("COLR");
inline constexpr std::uint32_t kCellColorChunk = fourcc("CCOL");
inline constexpr std::uint32_t kInstanceColorChunk = fourcc("ICOL");
inline constexpr std::uint32_t kSurfaceColorChunk = fourcc("SCOL");  ///< from 1.1 on
inline constexpr std::uint32_t kNormalChunk = fourcc("NORM");
inline constexpr std::uint32_t kBasicMeshChunk = fourcc("MESH");  ///< from 1.1 on

inline constexpr std::uint64_t kMaxTiles = 0x7fffffff;
inline constexpr std::uint64_t kMaxAxisVoxels = std::uint64_t{1} << 30;
inline constexpr std::uint32_t kMinResolution = 4;
inline constexpr std::uint32_t kMaxResolution = 1024;
inline constexpr std::uint32_t kMaxCells = 65535;
inline constexpr std::uint32_t kMaxColorResolution = 1024;

/// GRID [spec 4.1]
[[nodiscard]] std::vector<std::byte> encode_grid(const GridLayout& grid);
[[nodiscard]] std::optional<GridLayout> decode_grid(const ChunkPayload& chunk, const ReadLimits& limits,
                                                    IssueSink& sink);
/// The rules that need both the grid and the tile resolution: extent and box. [spec 4.1]
[[nodiscard]] bool check_extent(const ChunkPayload& grid_chunk, const GridLayout& grid,
                                const Index3& resolution, IssueSink& sink);

/// TILE [spec 4.2]
[[nodiscard]] std::vector<std::byte> encode_tile(const TileMap& tile);
[[nodiscard]] std::optional<TileMap> decode_tile(const ChunkPayload& chunk, MemoryBudget& budget,
                                                 IssueSink& sink);

/// The fixed fields of MEMB, as they stand there. `bytes` are its first 64 or more.
struct MembershipHeader {
  std::uint32_t rule = 0;
  std::uint32_t cell_count = 0;
  InstanceCounts counts;
  std::uint32_t mixed_count = 0;
};
[[nodiscard]] MembershipHeader read_membership_header(std::span<const std::byte> bytes);

/// Where the parts of MEMB are. For at most 2³¹ − 1 tiles and 65535 cells nothing overflows.
struct MembershipLayout {
  static constexpr std::uint64_t kPageTiles = 4096;
  std::uint64_t states_at = 0, ranks_at = 0, tags_at = 0, bytes = 0;
  std::uint64_t tile_tag_bytes = 0;
  [[nodiscard]] static MembershipLayout of(std::uint64_t tile_count, std::uint32_t cell_count,
                                           std::uint32_t mixed_count);
  [[nodiscard]] static std::uint64_t page_count(std::uint64_t tile_count) {
    return (tile_count + kPageTiles - 1) / kPageTiles;
  }
};

/// MEMB [spec 4.3]. `grid` and `tile` are null where those chunks are at fault: the rules that need them are
/// then left out, and the result is empty.
[[nodiscard]] std::vector<std::byte> encode_membership(const MembershipMap& membership);
[[nodiscard]] std::optional<MembershipMap> decode_membership(const ChunkPayload& chunk,
                                                             const GridLayout* grid, const TileMap* tile,
                                                             MemoryBudget& budget, IssueSink& sink);

/// COLR [spec 4.5]
[[nodiscard]] std::vector<std::byte> encode_color(const ColorMap& color);
[[nodiscard]] std::optional<ColorMap> decode_color(const ChunkPayload& chunk, MemoryBudget& budget,
                                                   IssueSink& sink);

/// CCOL and ICOL: `count` colors. [spec 4.6, 4.7] Without a count, because the chunk that states it is at
/// fault, the rest is checked and the result is empty.
[[nodiscard]] std::vector<std::byte> encode_colors(const ColorList& list);
[[nodiscard]] std::optional<ColorList> decode_colors(const ChunkPayload& chunk,
                                                     std::optional<std::uint64_t> count, MemoryBudget& budget,
                                                     IssueSink& sink);

/// NORM [spec 4.8]. `tile` is null where that chunk is at fault: the number of normals is then not checked,
/// and the result is empty.
[[nodiscard]] std::vector<std::byte> encode_normals(const NormalMap& normals);
[[nodiscard]] std::optional<NormalMap> decode_normals(const ChunkPayload& chunk, const TileMap* tile,
                                                      MemoryBudget& budget, IssueSink& sink);

/// MESH [spec 4.10]. What is in the mesh's bytes is not looked at.
[[nodiscard]] std::vector<std::byte> encode_basic_mesh(const BasicMesh& mesh);
[[nodiscard]] std::optional<BasicMesh> decode_basic_mesh(const ChunkPayload& chunk, MemoryBudget& budget,
                                                         IssueSink& sink);

/// SCOL [spec 4.11]. `grid` and `tile` are null where those chunks are at fault: the rules that need them are
/// then left out, and without a grid the result is empty. A map without a brick must not be encoded (assert).
[[nodiscard]] std::vector<std::byte> encode_surface_colors(const SurfaceColors& colors);
[[nodiscard]] std::optional<SurfaceColors> decode_surface_colors(const ChunkPayload& chunk,
                                                                 const GridLayout* grid, const TileMap* tile,
                                                                 MemoryBudget& budget, IssueSink& sink);

}  // namespace mesocell
