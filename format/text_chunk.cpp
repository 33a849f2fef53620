#include "format/text_chunk.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/utf8.h"

namespace mesocell {
namespace {

/// What an entry costs in memory besides its bytes; the same on every machine, so that limits are.
constexpr std::uint64_t kEntryCost = 64;
static_assert(sizeof(Metadata::value_type) <= kEntryCost);

std::string text_of(std::span<const std::byte> bytes) {
  return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

/// Whether there are control characters but tab and line feed.
bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && byte != '\t' && byte != '\n') || byte == 0x7f;
  });
}

}  // namespace

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

std::vector<std::byte> encode_text(const Metadata& metadata) {
  ByteWriter out;
  out.u32(static_cast<std::uint32_t>(metadata.size()));
  for (const auto& [key, value] : metadata) {
    out.u32(static_cast<std::uint32_t>(key.size()));
    out.u32(static_cast<std::uint32_t>(value.size()));
    out.append(key);
    out.append(value);
  }
  return out.release();
}

std::optional<Metadata> decode_text(const ChunkPayload& chunk, MemoryBudget& budget, IssueSink& sink) {
  const std::uint64_t errors_before = sink.errors();
  ByteReader in(chunk.bytes);
  const std::uint32_t count = in.u32();
  Metadata metadata;
  for (std::uint32_t i = 0; i < count && !in.overrun() && !sink.stopped(); ++i) {
    const std::size_t at = in.position();
    const std::uint32_t key_bytes = in.u32();
    const std::uint32_t value_bytes = in.u32();
    const auto key_span = in.take(key_bytes);
    const auto value_span = in.take(value_bytes);
    if (in.overrun()) break;
    if (!budget.charge(kEntryCost + key_bytes + value_bytes)) {
      sink.add(IssueId::kLimitExceeded, std::nullopt, chunk.type, "memory for the text");
      return std::nullopt;
    }
    std::string key = text_of(key_span);
    std::string value = text_of(value_span);
    const auto entry = [&] { return "entry " + std::to_string(i); };
    if ((key_bytes == 0 || key_bytes > kMaxKeyBytes || key.find('\0') != std::string::npos) &&
        sink.wants(IssueId::kTextKey))
      add_issue(sink, IssueId::kTextKey, chunk, at, entry());
    if ((!is_utf8(key) || !is_utf8(value)) && sink.wants(IssueId::kTextUtf8))
      add_issue(sink, IssueId::kTextUtf8, chunk, at, entry());
    if ((has_control(key) || has_control(value)) && sink.wants(IssueId::kTextControl))
      add_issue(sink, IssueId::kTextControl, chunk, at, entry());
    // std::string compares bytes as unsigned char.
    if (!metadata.empty() && !(metadata.back().first < key) && sink.wants(IssueId::kTextOrder))
      add_issue(sink, IssueId::kTextOrder, chunk, at, entry());
    metadata.emplace_back(std::move(key), std::move(value));
  }
  if (in.overrun()) {
    add_issue(
        sink, IssueId::kPayloadTruncated, chunk, in.position(),
        std::to_string(count) + " entries do not fit in " + std::to_string(chunk.bytes.size()) + " bytes");
  } else if (in.remaining() > 0 && !sink.stopped()) {
    add_issue(sink, IssueId::kPayloadTrailing, chunk, in.position(),
              std::to_string(in.remaining()) + " bytes after the last entry");
  }
  if (sink.errors() != errors_before) return std::nullopt;
  return metadata;
}

}  // namespace mesocell
