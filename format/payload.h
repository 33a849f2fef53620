#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "format/api.h"
#include "format/issue_sink.h"

/// The decoded bytes of a chunk, and the checks that all kinds of chunks share.
namespace mesocell MESOCELL_API {

/// A chunk's decoded bytes, and what it takes to say where in the file they came from.
struct ChunkPayload {
  std::uint32_t type = 0;
  std::span<const std::byte> bytes;
  std::uint64_t file_offset = 0;  ///< of the first block
  bool raw = true;                ///< decoded byte i is byte file_offset + i of the file
};

/// Fixed fields stand in a header of this size, and parts begin at multiples of it, so that a raw chunk can
/// be used where it is mapped. [spec 2.6]
inline constexpr std::uint64_t kPartAlignment = 64;
[[nodiscard]] constexpr std::uint64_t aligned_part(std::uint64_t bytes) {
  return (bytes + kPartAlignment - 1) / kPartAlignment * kPartAlignment;
}

/// Reports an issue at byte `at` of a decoded chunk.
void add_issue(IssueSink& sink, IssueId id, const ChunkPayload& chunk, std::uint64_t at,
               std::string detail = {});

/// Whether the chunk has this size; reports payload-truncated or payload-trailing if not.
[[nodiscard]] bool check_payload_size(const ChunkPayload& chunk, std::uint64_t expected, IssueSink& sink);
/// Whether it has at least its header of 64 bytes.
[[nodiscard]] bool check_payload_header(const ChunkPayload& chunk, IssueSink& sink);
/// Reports bytes from `begin` to `end`, which must be in the chunk, that are not zero.
void check_payload_zeros(const ChunkPayload& chunk, std::uint64_t begin, std::uint64_t end, IssueId id,
                         IssueSink& sink);

/// The f32 at byte `at`, which must be in the chunk: how far a quantised map is off at most. Reports one that
/// is not finite or not at least zero. [spec 2.7]
[[nodiscard]] float check_stated_error(const ChunkPayload& chunk, std::uint64_t at, IssueSink& sink);

}  // namespace mesocell
