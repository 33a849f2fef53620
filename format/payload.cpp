#include "format/payload.h"

#include <cmath>

#include "format/byte_reader.h"

namespace mesocell {

using std::to_string;

void add_issue(IssueSink& sink, IssueId id, const ChunkPayload& chunk, std::uint64_t at, std::string detail) {
  if (chunk.raw) {
    sink.add(id, chunk.file_offset + at, chunk.type, std::move(detail));
    return;
  }
  // The byte has no place of its own in a compressed chunk.
  if (!detail.empty()) detail += ", ";
  detail += "at byte " + to_string(at) + " of the decoded chunk";
  sink.add(id, chunk.file_offset, chunk.type, std::move(detail));
}

bool check_payload_size(const ChunkPayload& chunk, std::uint64_t expected, IssueSink& sink) {
  if (chunk.bytes.size() == expected) return true;
  const bool is_short = chunk.bytes.size() < expected;
  add_issue(sink, is_short ? IssueId::kPayloadTruncated : IssueId::kPayloadTrailing, chunk,
            is_short ? chunk.bytes.size() : expected,
            to_string(chunk.bytes.size()) + " instead of " + to_string(expected) + " bytes");
  return false;
}

bool check_payload_header(const ChunkPayload& chunk, IssueSink& sink) {
  if (chunk.bytes.size() >= kPartAlignment) return true;
  add_issue(sink, IssueId::kPayloadTruncated, chunk, chunk.bytes.size(), "the header has 64 bytes");
  return false;
}

void check_payload_zeros(const ChunkPayload& chunk, std::uint64_t begin, std::uint64_t end, IssueId id,
                         IssueSink& sink) {
  const auto zeros = slice(chunk.bytes, begin, end - begin);
  if (const std::size_t i = first_nonzero(zeros); i < zeros.size()) add_issue(sink, id, chunk, begin + i);
}

float check_stated_error(const ChunkPayload& chunk, std::uint64_t at, IssueSink& sink) {
  ByteReader in(slice(chunk.bytes, at, sizeof(float)));
  const float error = in.f32();
  if (!std::isfinite(error) || std::signbit(error))
    add_issue(sink, IssueId::kMapError, chunk, at, to_string(error));
  return error;
}

}  // namespace mesocell
