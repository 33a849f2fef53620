#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/api.h"
#include "format/issue_sink.h"
#include "format/limits.h"

/// The checks of header, directory and chunk storage, written once: a reader runs them until the first fault,
/// the validator to the end.
namespace mesocell MESOCELL_API {

struct Representation;

inline constexpr std::array<unsigned char, 8> kMagic = {0x89, 'M', 'E', 'S', 'O', 0x0d, 0x0a, 0x1a};
inline constexpr std::uint16_t kFormatMajor = 0;
inline constexpr std::uint16_t kFormatMinor = 9;
inline constexpr std::size_t kHeaderBytes = 64;
inline constexpr std::size_t kEntryBytes = 64;
inline constexpr std::size_t kChunkAlignment = 64;
inline constexpr std::uint32_t kMaxChunks = 1024;
inline constexpr std::uint32_t kCriticalFlag = 1;
inline constexpr std::uint32_t kCodecRaw = 0;
inline constexpr std::uint32_t kCodecZstd = 1;

/// A directory entry. [spec 3.2]
struct ChunkInfo {
  std::uint32_t type = 0;
  bool critical = false;
  std::uint32_t codec = 0;
  std::uint64_t offset = 0;         ///< from the file's start, bytes
  std::uint64_t stored_bytes = 0;   ///< in the file
  std::uint64_t decoded_bytes = 0;  ///< after the codec
};

/// What header and directory say.
struct ContainerScan {
  std::uint16_t major = 0;
  std::uint16_t minor = 0;
  std::uint32_t representation = 0;
  std::uint64_t file_bytes = 0;
  const Representation* rules = nullptr;  ///< of the representation; null if it is unknown
  std::vector<ChunkInfo> chunks;
  std::vector<std::uint64_t> hashes;  ///< of the stored bytes, as the directory gives them, one a chunk
  std::vector<bool> usable;           ///< the chunk lies in the file and has a known codec, one a chunk
  bool over_limit = false;            ///< the chunks together decode to more than the caller allows

  /// The first chunk of this type, if any.
  [[nodiscard]] std::optional<std::size_t> find(std::uint32_t type) const;
};

/// A chunk's decoded bytes, and what it takes to say where in the file they came from.
struct ChunkPayload {
  std::uint32_t type = 0;
  std::span<const std::byte> bytes;
  std::uint64_t file_offset = 0;  ///< of the stored bytes
  bool raw = true;                ///< decoded byte i is byte file_offset + i of the file
};

/// Reads and checks header, directory, layout and padding. Takes the chunks' decoded bytes from the budget.
/// Untrusted input: safe. Empty if the directory could not be reached or the sink is full.
[[nodiscard]] std::optional<ContainerScan> scan_container(std::span<const std::byte> file,
                                                          const ReadLimits& limits, MemoryBudget& budget,
                                                          IssueSink& sink);

/// Checks the hash of a usable chunk's stored bytes.
[[nodiscard]] bool verify_chunk(std::span<const std::byte> file, const ContainerScan& scan, std::size_t index,
                                IssueSink& sink);

/// Decodes a usable chunk, whose size the budget has. Untrusted input: safe. Empty after an issue.
[[nodiscard]] std::optional<std::vector<std::byte>> decode_chunk(std::span<const std::byte> file,
                                                                 const ContainerScan& scan, std::size_t index,
                                                                 IssueSink& sink);

/// Reports an issue at byte `at` of a decoded chunk.
void add_issue(IssueSink& sink, IssueId id, const ChunkPayload& chunk, std::size_t at,
               std::string detail = {});

}  // namespace mesocell
