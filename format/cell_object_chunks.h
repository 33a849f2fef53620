#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "format/cell_object.h"
#include "format/container_scan.h"
#include "format/fourcc.h"

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
inline constexpr std::uint32_t kNormalChunk = fourcc("NORM");
inline constexpr std::uint32_t kTextChunk = fourcc("TEXT");

inline constexpr std::uint64_t kMaxTiles = 0x7fffffff;
inline constexpr std::uint64_t kMaxAxisVoxels = std::uint64_t{1} << 30;
inline constexpr std::uint32_t kMinResolution = 4;
inline constexpr std::uint32_t kMaxResolution = 1024;
inline constexpr std::uint32_t kMaxCells = 65535;
inline constexpr std::uint32_t kMaxRun = (1u << 30) - 1;
inline constexpr std::uint32_t kMaxColorResolution = 1024;
inline constexpr std::uint32_t kMaxKeyBytes = 256;

using Metadata = std::vector<std::pair<std::string, std::string>>;

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

/// MEMB [spec 4.3]. `grid` and `tile` are null where those chunks are at fault: the rules that need them are
/// then left out, and the result is empty.
[[nodiscard]] std::vector<std::byte> encode_membership(const MembershipMap& membership);
[[nodiscard]] std::optional<MembershipMap> decode_membership(const ChunkPayload& chunk,
                                                             const GridLayout* grid, const TileMap* tile,
                                                             MemoryBudget& budget, IssueSink& sink);

/// TEXT [spec 4.4]
[[nodiscard]] std::vector<std::byte> encode_text(const Metadata& metadata);
[[nodiscard]] std::optional<Metadata> decode_text(const ChunkPayload& chunk, MemoryBudget& budget,
                                                  IssueSink& sink);
/// Whether the bytes are UTF-8 without surrogates and overlong forms. [RFC 3629]
[[nodiscard]] bool is_utf8(std::string_view text);

/// COLR [spec 4.5]
[[nodiscard]] std::vector<std::byte> encode_color(const ColorMap& color);
[[nodiscard]] std::optional<ColorMap> decode_color(const ChunkPayload& chunk, MemoryBudget& budget,
                                                   IssueSink& sink);

/// CCOL and ICOL: `count` colors and nothing else. [spec 4.6, 4.7]
[[nodiscard]] std::vector<std::byte> encode_colors(std::span<const Rgb8> colors);
[[nodiscard]] std::optional<std::vector<Rgb8>> decode_colors(const ChunkPayload& chunk, std::uint64_t count,
                                                             MemoryBudget& budget, IssueSink& sink);

/// NORM [spec 4.8]. `tile` is null where that chunk is at fault: the number of normals is then not checked,
/// and the result is empty.
[[nodiscard]] std::vector<std::byte> encode_normals(const NormalMap& normals);
[[nodiscard]] std::optional<NormalMap> decode_normals(const ChunkPayload& chunk, const TileMap* tile,
                                                      MemoryBudget& budget, IssueSink& sink);

}  // namespace mesocell
