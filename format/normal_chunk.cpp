#include <cstring>
#include <string>

#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"
#include "format/normal_map.h"

namespace mesocell {
namespace {

using std::to_string;

using Code = std::array<std::uint8_t, 2>;
static_assert(sizeof(Code) == 2);
constexpr std::uint32_t kOctahedral = 0;
constexpr std::uint64_t kNormalFieldBytes = 8;

/// Finding the boundary takes up to this much for a voxel of one slice; the same on every machine, so that
/// limits are.
constexpr std::uint64_t kSliceCost = 8;

}  // namespace

std::vector<std::byte> encode_normals(const NormalMap& normals) {
  ByteWriter out;
  out.reserve(kPartAlignment + normals.normals.size() * sizeof(Code));
  out.u32(kOctahedral);
  out.f32(normals.max_error_degrees);
  out.pad_to(kPartAlignment);
  out.append(std::as_bytes(std::span(normals.normals)));
  return out.release();
}

std::optional<NormalMap> decode_normals(const ChunkPayload& chunk, const TileMap* tile, MemoryBudget& budget,
                                        IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  if (!check_payload_header(chunk, sink)) return std::nullopt;
  ByteReader in(chunk.bytes);
  NormalMap normals;
  if (const std::uint32_t encoding = in.u32(); encoding != kOctahedral)
    add_issue(sink, IssueId::kNormalEncoding, chunk, 0, to_string(encoding));
  normals.max_error_degrees = check_stated_error(chunk, 4, sink);
  check_payload_zeros(chunk, kNormalFieldBytes, kPartAlignment, IssueId::kPayloadReserved, sink);
  const auto codes = chunk.bytes.subspan(kPartAlignment);
  for (std::size_t i = 0; i < codes.size() && sink.wants(IssueId::kNormalCode); ++i) {
    if (std::to_integer<std::uint8_t>(codes[i]) > kMaxNormalByte)
      add_issue(sink, IssueId::kNormalCode, chunk, kPartAlignment + i, "normal " + to_string(i / 2));
  }
  if (!tile || sink.stopped()) return std::nullopt;
  if (!budget.charge(std::uint64_t{tile->resolution[0]} * tile->resolution[1], kSliceCost) ||
      !budget.charge(codes.size())) {
    sink.add(IssueId::kLimitExceeded, std::nullopt, chunk.type, "memory for normals");
    return std::nullopt;
  }
  const std::uint64_t count = count_boundary_voxels(*tile);
  if (!check_payload_size(chunk, kPartAlignment + count * sizeof(Code), sink) ||
      sink.errors() != errors_before)
    return std::nullopt;
  normals.normals.resize(static_cast<std::size_t>(count));
  if (count > 0) std::memcpy(normals.normals.data(), codes.data(), codes.size());
  return normals;
}

}  // namespace mesocell
