#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"
#include "format/issue_sink.h"
#include "format/limits.h"
#include "format/payload.h"

/// What fuzz targets share. A target is one source that defines LLVMFuzzerTestOneInput() of libFuzzer and
/// seeds(), and one line in CMakeLists.txt. Everything that a target promises, it checks with
/// MESOCELL_FUZZ_CHECK.
namespace mesocell::fuzz {

using Bytes = std::vector<std::byte>;

/// Inputs to begin with: the same each time, valid ones of all kinds. Defined by each target.
[[nodiscard]] std::vector<Bytes> seeds();

/// Seeds of targets whose inputs are files.
[[nodiscard]] std::vector<Bytes> file_seeds();

/// Small, so that no input takes long or much memory.
inline constexpr ReadLimits kLimits = {std::uint64_t{1} << 20, std::uint64_t{1} << 22,
                                       std::uint64_t{1} << 14};

/// Says what was promised and aborts.
[[noreturn]] void fail(const char* source, int line, const char* promise);
#define MESOCELL_FUZZ_CHECK(promise) \
  if (!(promise)) ::mesocell::fuzz::fail(__FILE__, __LINE__, #promise)

/// A heap buffer of exactly these bytes, so that the address sanitizer sees a read of one too many.
class Exact {
 public:
  explicit Exact(std::span<const std::byte> bytes)
      : bytes_(std::make_unique<std::byte[]>(bytes.size())), size_(bytes.size()) {
    std::copy(bytes.begin(), bytes.end(), bytes_.get());
  }
  [[nodiscard]] std::span<const std::byte> bytes() const { return {bytes_.get(), size_}; }

 private:
  std::unique_ptr<std::byte[]> bytes_;
  std::size_t size_;
};

/// Takes numbers from the front of an input; zeros when it has ended.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : bytes_(std::as_bytes(std::span(data, size))) {}
  std::uint32_t number(unsigned count) {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < count && !bytes_.empty(); ++i, bytes_ = bytes_.subspan(1))
      value |= std::to_integer<std::uint32_t>(bytes_[0]) << (8 * i);
    return value;
  }
  [[nodiscard]] std::span<const std::byte> rest() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

/// A chunk of a file that holds these bytes as they are. All that targets know of ChunkPayload is here.
[[nodiscard]] inline ChunkPayload raw_payload(std::uint32_t type, std::span<const std::byte> bytes) {
  return {type, bytes, 4096, true};
}

/// Whether the sink has an issue of the kind that a reader stopped at.
[[nodiscard]] inline bool names(const IssueSink& sink, std::string_view id) {
  return sink.capped() || std::any_of(sink.issues().begin(), sink.issues().end(),
                                      [&](const Issue& issue) { return issue.id == id; });
}

/// What every decoder promises: a result or an issue; the same verdict whether it stops at the first issue or
/// not; bytes that are accepted are what the encoder makes of the result; and it takes from the budget what
/// it needs. `decode(chunk, budget, sink)` is an optional of the maps, `encode(maps)` bytes.
template <typename Decode, typename Encode>
void check_decoder(std::uint32_t type, std::span<const std::byte> bytes, Decode decode, Encode encode) {
  const Exact exact(bytes);
  const ChunkPayload chunk = raw_payload(type, exact.bytes());
  IssueSink first = IssueSink::first_error();
  MemoryBudget budget(kLimits);
  const auto maps = decode(chunk, budget, first);
  MESOCELL_FUZZ_CHECK(maps.has_value() == (first.errors() == 0));

  IssueSink all = IssueSink::all(64);
  MemoryBudget same_budget(kLimits);
  const auto maps_again = decode(chunk, same_budget, all);
  MESOCELL_FUZZ_CHECK(maps_again.has_value() == (all.errors() == 0));
  MESOCELL_FUZZ_CHECK(maps_again.has_value() == maps.has_value());
  if (!maps) {
    MESOCELL_FUZZ_CHECK(names(all, first.first_error_as_result().id));
    return;
  }
  MESOCELL_FUZZ_CHECK(*maps_again == *maps);
  const Bytes encoded = encode(*maps);
  MESOCELL_FUZZ_CHECK(std::equal(encoded.begin(), encoded.end(), bytes.begin(), bytes.end()));

  const std::uint64_t need = kLimits.max_decoded_bytes - budget.left();
  const auto decodes_with = [&](std::uint64_t most) {
    ReadLimits limits = kLimits;
    limits.max_decoded_bytes = most;
    MemoryBudget this_budget(limits);
    IssueSink sink = IssueSink::first_error();
    const bool decodes = decode(chunk, this_budget, sink).has_value();
    MESOCELL_FUZZ_CHECK(decodes || sink.first_error_as_result().code == ErrorCode::kLimit);
    return decodes;
  };
  MESOCELL_FUZZ_CHECK(decodes_with(need));
  if (need > 0) MESOCELL_FUZZ_CHECK(!decodes_with(need - 1));
}

}  // namespace mesocell::fuzz
