#include <cassert>
#include <cstring>
#include <string>

#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"

namespace mesocell {
namespace {

using std::to_string;

constexpr std::uint64_t kColorBytes = 3;
static_assert(sizeof(Rgb8) == kColorBytes);
/// Where the header's fields end: a color map has its resolution before the stated error.
constexpr std::uint64_t kColorFieldBytes = 16;
constexpr std::uint64_t kListFieldBytes = 4;

/// The colors after the header. Empty if the budget does not allow them.
std::optional<std::vector<Rgb8>> take_colors(const ChunkPayload& chunk, std::uint64_t count,
                                             MemoryBudget& budget, IssueSink& sink) {
  if (!budget.charge(count, kColorBytes)) {
    sink.add(IssueId::kLimitExceeded, std::nullopt, chunk.type, "memory for colors");
    return std::nullopt;
  }
  std::vector<Rgb8> colors(static_cast<std::size_t>(count));
  const auto bytes = slice(chunk.bytes, kPartAlignment, count * kColorBytes);
  if (!colors.empty()) std::memcpy(colors.data(), bytes.data(), bytes.size());
  return colors;
}

}  // namespace

// A predictor before zstd does not pay: on solid textures of 64³ (marble, wood, stone) zstd makes 275, 282
// and 282 kB of the plain triples; of differences along x, by planes and against green, 337, 411 and 393 kB;
// of those from the seven neighbours before (Lorenzo), 323, 274 and 493 kB.
std::vector<std::byte> encode_color(const ColorMap& color) {
  assert(color.voxels.size() ==
         std::uint64_t{color.resolution[0]} * color.resolution[1] * color.resolution[2]);
  ByteWriter out;
  out.reserve(kPartAlignment + color.voxels.size() * kColorBytes);
  for (const std::uint32_t r : color.resolution) out.u32(r);
  out.f32(color.max_error);
  out.pad_to(kPartAlignment);
  out.append(std::as_bytes(std::span(color.voxels)));
  return out.release();
}

std::optional<ColorMap> decode_color(const ChunkPayload& chunk, MemoryBudget& budget, IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  if (!check_payload_header(chunk, sink)) return std::nullopt;
  ByteReader in(chunk.bytes);
  ColorMap color;
  std::uint64_t voxels = 1;
  bool resolution_ok = true;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint32_t r = color.resolution[a] = in.u32();
    if (r == 0 || r > kMaxColorResolution) {
      add_issue(sink, IssueId::kColorResolution, chunk, 4 * a, to_string(r));
      resolution_ok = false;
      continue;
    }
    voxels *= r;
  }
  color.max_error = check_stated_error(chunk, kColorFieldBytes - 4, sink);
  check_payload_zeros(chunk, kColorFieldBytes, kPartAlignment, IssueId::kPayloadReserved, sink);
  if (!resolution_ok || !check_payload_size(chunk, kPartAlignment + voxels * kColorBytes, sink) ||
      sink.errors() != errors_before)
    return std::nullopt;
  auto colors = take_colors(chunk, voxels, budget, sink);
  if (!colors) return std::nullopt;
  color.voxels = std::move(*colors);
  return color;
}

std::vector<std::byte> encode_colors(const ColorList& list) {
  ByteWriter out;
  out.reserve(kPartAlignment + list.colors.size() * kColorBytes);
  out.f32(list.max_error);
  out.pad_to(kPartAlignment);
  out.append(std::as_bytes(std::span(list.colors)));
  return out.release();
}

std::optional<ColorList> decode_colors(const ChunkPayload& chunk, std::optional<std::uint64_t> count,
                                       MemoryBudget& budget, IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  if (!check_payload_header(chunk, sink)) return std::nullopt;
  ColorList list;
  list.max_error = check_stated_error(chunk, 0, sink);
  check_payload_zeros(chunk, kListFieldBytes, kPartAlignment, IssueId::kPayloadReserved, sink);
  // A number of instances is below 2³¹ tiles × 2¹⁶ cells, so the product does not overflow.
  if (!count || !check_payload_size(chunk, kPartAlignment + *count * kColorBytes, sink) ||
      sink.errors() != errors_before)
    return std::nullopt;
  auto colors = take_colors(chunk, *count, budget, sink);
  if (!colors) return std::nullopt;
  list.colors = std::move(*colors);
  return list;
}

}  // namespace mesocell
