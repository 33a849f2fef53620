#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <string>

#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"

namespace mesocell {
namespace {

using std::to_string;

constexpr std::uint64_t kFieldBytes = 24;
constexpr std::uint64_t kPageTiles = 4096;
constexpr std::uint64_t kBrickRankBytes = 8;  // of a page: bricks and colors before it

/// Where the parts are. Tiles are below 2³¹, bricks and colors, as stated, below 2³² and masks of at most
/// 4096 bytes, so that all sums stay below 2⁴⁵.
struct Layout {
  std::uint64_t bricks_at = 0, ranks_at = 0, masks_at = 0, colors_at = 0, bytes = 0;
  std::uint64_t bricks_end = 0, ranks_end = 0, masks_end = 0;  ///< without the zeros to the next part

  Layout(std::uint64_t tiles, std::uint64_t mask_bytes, std::uint64_t bricks, std::uint64_t colors) {
    bricks_at = kPartAlignment;
    bricks_end = bricks_at + (tiles + 7) / 8;
    ranks_at = aligned_part(bricks_end);
    ranks_end = ranks_at + (tiles + kPageTiles - 1) / kPageTiles * kBrickRankBytes;
    masks_at = aligned_part(ranks_end);
    masks_end = masks_at + bricks * mask_bytes;
    colors_at = aligned_part(masks_end);
    bytes = colors_at + colors * sizeof(Rgb8);
  }
};

/// `use(i, predicted)` for each color i, in order: what is predicted from those before it, which must be
/// right by then. [spec 4.11]
template <typename Use>
void for_each_prediction(const SurfaceColors& map, Use use) {
  // The last color of each column of a brick along z, and a number of its voxel that no other brick has.
  struct Last {
    std::uint64_t voxel = ~std::uint64_t{0};
    std::size_t color = 0;
  };
  std::array<Last, std::size_t{SurfaceColors::kMaxResolution} * SurfaceColors::kMaxResolution> columns;
  const std::size_t row = map.resolution[0], plane = row * map.resolution[1], mask_bytes = map.mask_bytes();
  std::size_t color = 0;
  std::uint64_t brick_voxels = 0;
  for (std::size_t at = 0; at < map.masks.size(); at += mask_bytes, brick_voxels += map.voxels_per_brick()) {
    std::array<unsigned, 3> before{};  // the color before, in the brick
    for (std::size_t byte = 0; byte < mask_bytes; ++byte) {
      for (unsigned bits = map.masks[at + byte]; bits != 0; bits &= bits - 1, ++color) {
        const std::size_t v = 8 * byte + static_cast<std::size_t>(std::countr_zero(bits)), column = v % plane;
        std::array<unsigned, 3> sum{};
        unsigned count = 0;
        const auto add = [&](bool in_brick, std::size_t back, std::size_t neighbour_column) {
          if (!in_brick || columns[neighbour_column].voxel != brick_voxels + v - back) return;
          for (std::size_t c = 0; c < 3; ++c) sum[c] += map.colors[columns[neighbour_column].color][c];
          ++count;
        };
        add(v % row > 0, 1, column - 1);
        add(column >= row, row, column - row);
        add(v >= plane, plane, column);
        Rgb8 predicted{};
        for (std::size_t c = 0; c < 3; ++c)
          predicted[c] = static_cast<std::uint8_t>(count > 0 ? sum[c] / count : before[c]);
        use(color, predicted);
        std::copy(map.colors[color].begin(), map.colors[color].end(), before.begin());
        columns[column] = {brick_voxels + v, color};
      }
    }
  }
}

/// Which tiles have bricks; false if their number is not what is stated.
bool check_bricks(const ChunkPayload& chunk, const Layout& layout, std::uint64_t tiles,
                  std::uint32_t brick_count, IssueSink& sink) {
  const auto bits = slice(chunk.bytes, layout.bricks_at, layout.bricks_end - layout.bricks_at);
  const unsigned after = tiles % 8 == 0 ? 0 : std::to_integer<unsigned>(bits.back()) >> tiles % 8;
  if (after != 0)
    add_issue(sink, IssueId::kScolUnusedBits, chunk, layout.bricks_end - 1, "after the last tile");
  check_payload_zeros(chunk, layout.bricks_end, layout.ranks_at, IssueId::kPayloadPadding, sink);
  check_payload_zeros(chunk, layout.ranks_end, layout.masks_at, IssueId::kPayloadPadding, sink);
  std::uint64_t bricks = 0;
  for (const std::byte b : bits) bricks += static_cast<unsigned>(std::popcount(std::to_integer<unsigned>(b)));
  bricks -= static_cast<unsigned>(std::popcount(after));
  if (bricks == brick_count && bricks > 0) return !sink.stopped();
  add_issue(sink, IssueId::kScolBrickCount, chunk, 16,
            to_string(brick_count) + (bricks > 0 ? " instead of " + to_string(bricks) : ""));
  return false;
}

/// The masks and where each brick's colors begin.
void check_masks(const ChunkPayload& chunk, const Layout& layout, SurfaceColors& map,
                 std::uint32_t color_count, IssueSink& sink) {
  const std::size_t mask_bytes = map.mask_bytes(), used_in_last = (map.voxels_per_brick() - 1) % 8 + 1;
  check_payload_zeros(chunk, layout.masks_end, layout.colors_at, IssueId::kPayloadPadding, sink);
  std::uint64_t colors = 0;
  for (std::size_t brick = 0; brick < map.first.size() && !sink.stopped(); ++brick) {
    const auto mask = std::span(map.masks).subspan(brick * mask_bytes, mask_bytes);
    const auto where = [&] { return "brick " + to_string(brick); };
    const unsigned after = unsigned{mask.back()} >> used_in_last;
    if (after != 0 && sink.wants(IssueId::kScolUnusedBits))
      add_issue(sink, IssueId::kScolUnusedBits, chunk, layout.masks_at + (brick + 1) * mask_bytes - 1,
                where());
    map.first[brick] = static_cast<std::uint32_t>(colors & 0xffffffff);
    const std::uint64_t before = colors;
    for (const std::uint8_t m : mask) colors += static_cast<unsigned>(std::popcount(m));
    colors -= static_cast<unsigned>(std::popcount(after));
    if (colors == before && sink.wants(IssueId::kScolEmptyBrick))
      add_issue(sink, IssueId::kScolEmptyBrick, chunk, layout.masks_at + brick * mask_bytes, where());
  }
  if (!sink.stopped() && colors != color_count)
    add_issue(sink, IssueId::kScolColorCount, chunk, 20,
              to_string(color_count) + " instead of " + to_string(colors));
}

/// The number of each tile's brick, and the ranks.
void number_bricks(const ChunkPayload& chunk, const Layout& layout, SurfaceColors& map,
                   std::uint32_t color_count, IssueSink& sink) {
  const auto bits = slice(chunk.bytes, layout.bricks_at, layout.bricks_end - layout.bricks_at);
  ByteReader ranks(slice(chunk.bytes, layout.ranks_at, layout.ranks_end - layout.ranks_at));
  std::uint32_t brick = 0;
  for (std::size_t t = 0; t < map.entries.size(); ++t) {
    if (t % kPageTiles == 0) {
      const std::uint32_t bricks = ranks.u32(), colors = ranks.u32();
      const std::uint32_t colors_before = brick < map.first.size() ? map.first[brick] : color_count;
      if ((bricks != brick || colors != colors_before) && sink.wants(IssueId::kScolRank))
        add_issue(sink, IssueId::kScolRank, chunk, layout.ranks_at + t / kPageTiles * kBrickRankBytes,
                  to_string(bricks) + ", " + to_string(colors) + " instead of " + to_string(brick) + ", " +
                      to_string(colors_before));
    }
    const bool has_brick = (std::to_integer<unsigned>(bits[t / 8]) >> t % 8 & 1u) != 0;
    map.entries[t] = has_brick ? brick++ : SurfaceColors::kNoBrick;
  }
}

}  // namespace

// Differences pay here, unlike in COLR: on the 233 490 color voxels along a bumpy ball, of 32 × 32 × 32 tiles
// of 8³, zstd makes of plain triples, of differences from the color before, and of those that are written
//   350, 189 and 167 kB of smooth colors,
//   633, 392 and 363 kB of smooth ones with noise of ±4,
//   369, 277 and 226 kB of a fractal,
//   154, 162 and 162 kB of two colors with a grain common to all channels;
// of 16³ × 16³ the same to some percent. Planes of channels, differences against green, and the mean over all
// 13 neighbours before made hardly any of them smaller and some larger. Where a brick's colors begin cost 4 %
// more as a number each; they are counted instead, from a rank a page.
std::vector<std::byte> encode_surface_colors(const SurfaceColors& map) {
  const std::size_t bricks = map.first.size();
  assert(bricks > 0 && bricks <= map.entries.size() && map.masks.size() == bricks * map.mask_bytes());
  assert(map.colors.size() <= 0xffffffff);
  const Layout layout(map.entries.size(), map.mask_bytes(), bricks, map.colors.size());
  ByteWriter out;
  out.reserve(layout.bytes);
  for (const std::uint32_t r : map.resolution) out.u32(r);
  out.f32(map.max_error);
  out.u32(static_cast<std::uint32_t>(bricks));
  out.u32(static_cast<std::uint32_t>(map.colors.size()));
  out.pad_to(kPartAlignment);
  ByteWriter ranks;
  std::uint32_t brick = 0;
  unsigned eight = 0;
  for (std::size_t t = 0; t < map.entries.size(); ++t) {
    if (t % kPageTiles == 0) {
      ranks.u32(brick);
      ranks.u32(brick < bricks ? map.first[brick] : static_cast<std::uint32_t>(map.colors.size()));
    }
    if (map.entries[t] != SurfaceColors::kNoBrick) {
      assert(map.entries[t] == brick);
      ++brick;
      eight |= 1u << t % 8;
    }
    if (t % 8 == 7 || t + 1 == map.entries.size()) out.u8(static_cast<std::uint8_t>(std::exchange(eight, 0)));
  }
  assert(brick == bricks);
  out.pad_to(kPartAlignment);
  out.append(ranks.bytes());
  out.pad_to(kPartAlignment);
  out.append(std::as_bytes(std::span(map.masks)));
  out.pad_to(kPartAlignment);
  for_each_prediction(map, [&](std::size_t i, const Rgb8& predicted) {
    for (std::size_t c = 0; c < 3; ++c) out.u8(static_cast<std::uint8_t>(map.colors[i][c] - predicted[c]));
  });
  assert(out.size() == layout.bytes);
  return out.release();
}

std::optional<SurfaceColors> decode_surface_colors(const ChunkPayload& chunk, const GridLayout* grid,
                                                   const TileMap* tile, MemoryBudget& budget,
                                                   IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  if (!check_payload_header(chunk, sink)) return std::nullopt;
  ByteReader in(chunk.bytes);
  SurfaceColors map;
  bool resolution_ok = true;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t r = map.resolution[a] = in.u32();
    if (r > 0 && r <= SurfaceColors::kMaxResolution && (!tile || r <= tile->resolution[a])) continue;
    add_issue(sink, IssueId::kScolResolution, chunk, 4 * a, to_string(r));
    resolution_ok = false;
  }
  in.skip(sizeof(float));
  map.max_error = check_stated_error(chunk, 12, sink);
  const std::uint32_t brick_count = in.u32(), color_count = in.u32();
  check_payload_zeros(chunk, kFieldBytes, kPartAlignment, IssueId::kPayloadReserved, sink);
  if (!grid || !resolution_ok || sink.stopped()) return std::nullopt;

  const std::uint64_t tiles = grid->tile_count();
  const Layout layout(tiles, map.mask_bytes(), brick_count, color_count);
  if (!check_payload_size(chunk, layout.bytes, sink) && chunk.bytes.size() < layout.bytes)
    return std::nullopt;
  if (sink.stopped() || !check_bricks(chunk, layout, tiles, brick_count, sink)) return std::nullopt;
  const std::uint64_t mask_bytes = layout.masks_end - layout.masks_at;
  if (!budget.charge(tiles, sizeof(std::uint32_t)) || !budget.charge(brick_count, sizeof(std::uint32_t)) ||
      !budget.charge(mask_bytes) || !budget.charge(color_count, sizeof(Rgb8))) {
    sink.add(IssueId::kLimitExceeded, std::nullopt, chunk.type, "memory for the surface colors");
    return std::nullopt;
  }
  const auto masks = slice(chunk.bytes, layout.masks_at, mask_bytes);
  map.masks.resize(masks.size());
  std::memcpy(map.masks.data(), masks.data(), masks.size());
  map.first.resize(brick_count);
  check_masks(chunk, layout, map, color_count, sink);
  if (sink.stopped()) return std::nullopt;
  map.entries.resize(static_cast<std::size_t>(tiles));
  number_bricks(chunk, layout, map, color_count, sink);
  if (sink.errors() != errors_before) return std::nullopt;

  map.colors.resize(color_count);
  const auto differences = slice(chunk.bytes, layout.colors_at, layout.bytes - layout.colors_at);
  for_each_prediction(map, [&](std::size_t i, const Rgb8& predicted) {
    for (std::size_t c = 0; c < 3; ++c)
      map.colors[i][c] =
          static_cast<std::uint8_t>(predicted[c] + std::to_integer<unsigned>(differences[3 * i + c]));
  });
  return map;
}

}  // namespace mesocell
