#include <cstring>
#include <string>

#include "format/cell_object_chunks.h"
#include "format/normal_map.h"

namespace mesocell {
namespace {

using std::to_string;

using Code = std::array<std::uint8_t, 2>;
static_assert(sizeof(Code) == 2);

/// Finding the boundary takes up to this much for a voxel of one slice; the same on every machine, so that
/// limits are.
constexpr std::uint64_t kSliceCost = 8;

}  // namespace

std::vector<std::byte> encode_normals(const NormalMap& normals) {
  const auto bytes = std::as_bytes(std::span(normals.normals));
  return {bytes.begin(), bytes.end()};
}

std::optional<NormalMap> decode_normals(const ChunkPayload& chunk, const TileMap* tile, MemoryBudget& budget,
                                        IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  for (std::size_t i = 0; i < chunk.bytes.size() && sink.wants(IssueId::kNormalCode); ++i) {
    if (std::to_integer<std::uint8_t>(chunk.bytes[i]) > kMaxNormalByte)
      add_issue(sink, IssueId::kNormalCode, chunk, i, "normal " + to_string(i / 2));
  }
  if (!tile || sink.stopped()) return std::nullopt;
  if (!budget.charge(std::uint64_t{tile->resolution[0]} * tile->resolution[1], kSliceCost) ||
      !budget.charge(chunk.bytes.size())) {
    sink.add(IssueId::kLimitExceeded, std::nullopt, chunk.type, "memory for normals");
    return std::nullopt;
  }
  const std::uint64_t count = count_boundary_voxels(*tile);
  if (chunk.bytes.size() != count * sizeof(Code)) {
    const bool is_short = chunk.bytes.size() < count * sizeof(Code);
    add_issue(sink, is_short ? IssueId::kPayloadTruncated : IssueId::kPayloadTrailing, chunk,
              is_short ? chunk.bytes.size() : static_cast<std::size_t>(count * sizeof(Code)),
              to_string(chunk.bytes.size()) + " bytes for " + to_string(count) + " boundary voxels");
  }
  if (sink.errors() != errors_before) return std::nullopt;
  NormalMap normals;
  normals.normals.resize(count);
  if (count > 0) std::memcpy(normals.normals.data(), chunk.bytes.data(), chunk.bytes.size());
  return normals;
}

}  // namespace mesocell
