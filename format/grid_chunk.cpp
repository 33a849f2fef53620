#include <cmath>
#include <string>

#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"

namespace mesocell {
namespace {

constexpr std::size_t kGridBytes = 64;
constexpr std::size_t kVoxelEdgeAt = 24;
constexpr std::size_t kTilesAt = 32;
constexpr std::size_t kReservedAt = 44;
constexpr char kAxis[] = "xyz";

}  // namespace

std::vector<std::byte> encode_grid(const GridLayout& grid) {
  ByteWriter out;
  for (const double v : grid.box_min) out.f64(v);
  out.f64(grid.voxel_edge);
  for (const std::uint32_t n : grid.tiles) out.u32(n);
  out.zeros(kGridBytes - kReservedAt);
  return out.release();
}

std::optional<GridLayout> decode_grid(const ChunkPayload& chunk, const ReadLimits& limits, IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  if (!check_payload_size(chunk, kGridBytes, sink) && chunk.bytes.size() < kGridBytes) return std::nullopt;
  ByteReader in(chunk.bytes.first(kGridBytes));
  GridLayout grid;
  for (double& v : grid.box_min) v = in.f64();
  grid.voxel_edge = in.f64();
  for (std::uint32_t& n : grid.tiles) n = in.u32();

  for (std::size_t a = 0; a < 3; ++a) {
    if (!std::isfinite(grid.box_min[a]))
      add_issue(sink, IssueId::kGridBox, chunk, 8 * a, std::string("box_min.") + kAxis[a] + " is not finite");
  }
  if (!std::isfinite(grid.voxel_edge) || !(grid.voxel_edge > 0))
    add_issue(sink, IssueId::kGridVoxelEdge, chunk, kVoxelEdgeAt, std::to_string(grid.voxel_edge));
  std::uint64_t tiles = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    // tiles ≤ 2³¹ - 1 before each product of two numbers below 2³², so it cannot overflow.
    tiles *= grid.tiles[a];
    if (tiles != 0 && tiles <= kMaxTiles) continue;
    add_issue(sink, IssueId::kGridTiles, chunk, kTilesAt + 4 * a,
              std::to_string(grid.tiles[0]) + " × " + std::to_string(grid.tiles[1]) + " × " +
                  std::to_string(grid.tiles[2]));
    break;
  }
  check_payload_zeros(chunk, kReservedAt, kGridBytes, IssueId::kPayloadReserved, sink);
  if (sink.errors() != errors_before) return std::nullopt;
  if (tiles > limits.max_tiles) {
    sink.add(IssueId::kLimitExceeded, std::nullopt, chunk.type,
             std::to_string(tiles) + " tiles, the limit is " + std::to_string(limits.max_tiles));
    return std::nullopt;
  }
  return grid;
}

bool check_extent(const ChunkPayload& grid_chunk, const GridLayout& grid, const Index3& resolution,
                  IssueSink& sink) {
  bool ok = true;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint64_t voxels = std::uint64_t{grid.tiles[a]} * resolution[a];
    if (voxels > kMaxAxisVoxels) {
      add_issue(sink, IssueId::kGridExtent, grid_chunk, kTilesAt + 4 * a,
                std::to_string(voxels) + " along " + kAxis[a]);
      ok = false;
      continue;
    }
    // The same expression as CellObject::box_max(); the product of the counts is exact.
    const double box_max = grid.box_min[a] + static_cast<double>(voxels) * grid.voxel_edge;
    if (std::isfinite(box_max) && box_max > grid.box_min[a]) continue;
    add_issue(sink, IssueId::kGridBox, grid_chunk, 8 * a,
              std::string("box_max.") + kAxis[a] + " is " + std::to_string(box_max));
    ok = false;
  }
  return ok;
}

}  // namespace mesocell
