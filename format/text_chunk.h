#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "format/api.h"
#include "format/fourcc.h"
#include "format/limits.h"
#include "format/payload.h"
#include "format/result.h"

/// Free text, which assets of every representation may have. [spec 4.4]
namespace mesocell MESOCELL_API {

inline constexpr std::uint32_t kTextChunk = fourcc("TEXT");
inline constexpr std::uint32_t kMaxKeyBytes = 256;

/// Keys and values, UTF-8, ascending by key, keys unique.
using Metadata = std::vector<std::pair<std::string, std::string>>;

/// Whether the metadata can be written. Errors: kUsage (keys, UTF-8, order), kLimit.
[[nodiscard]] Status check_metadata(const Metadata& metadata);

/// Expects what check_metadata() finds right.
[[nodiscard]] std::vector<std::byte> encode_text(const Metadata& metadata);
/// Untrusted input: safe; as the decoders of format/cell_object_chunks.h.
[[nodiscard]] std::optional<Metadata> decode_text(const ChunkPayload& chunk, MemoryBudget& budget,
                                                  IssueSink& sink);

}  // namespace mesocell
