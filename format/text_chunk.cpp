#include <string>

#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"

namespace mesocell {
namespace {

/// What an entry costs in memory besides its bytes; the same on every machine, so that limits are.
constexpr std::uint64_t kEntryCost = 64;
static_assert(sizeof(Metadata::value_type) <= kEntryCost);

std::string text_of(std::span<const std::byte> bytes) {
  return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

}  // namespace

bool is_utf8(std::string_view text) {
  const auto byte = [&](std::size_t i) -> unsigned {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
  };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned lead = byte(i);
    std::size_t length = 1;
    // The second byte's range excludes overlong forms, surrogates and what lies above U+10FFFF.
    unsigned low = 0x80, high = 0xbf;
    if (lead >= 0x80) {
      if (lead < 0xc2 || lead > 0xf4) return false;
      length = lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
      if (lead == 0xe0) low = 0xa0;
      if (lead == 0xed) high = 0x9f;
      if (lead == 0xf0) low = 0x90;
      if (lead == 0xf4) high = 0x8f;
    }
    for (std::size_t k = 1; k < length; ++k) {
      if (byte(i + k) < low || byte(i + k) > high) return false;
      low = 0x80;
      high = 0xbf;
    }
    i += length;
  }
  return true;
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
