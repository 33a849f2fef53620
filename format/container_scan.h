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

/// The checks of header, asset table and directory, written once: a reader runs them until the first fault,
/// the validator to the end.
namespace mesocell MESOCELL_API {

struct Representation;

inline constexpr std::array<unsigned char, 8> kMagic = {0x89, 'M', 'E', 'S', 'O', 0x0d, 0x0a, 0x1a};
inline constexpr std::uint16_t kFormatMajor = 1;
inline constexpr std::uint16_t kFormatMinor = 1;
inline constexpr std::size_t kHeaderBytes = 64;
inline constexpr std::size_t kAssetBytes = 64;
inline constexpr std::size_t kEntryBytes = 64;
inline constexpr std::size_t kChunkAlignment = 64;
inline constexpr std::size_t kMaxNameBytes = 40;
inline constexpr std::uint32_t kMaxAssets = 1024;
inline constexpr std::uint32_t kMaxChunks = 4096;
inline constexpr std::uint32_t kCriticalFlag = 1;
/// Flags that a reader must refuse if it does not know them, in a file of any minor version. The others may
/// be ignored. [spec 5]
inline constexpr std::uint32_t kMustKnowFlags = 0x0000ffff;
inline constexpr std::uint32_t kCodecRaw = 0;
inline constexpr std::uint32_t kCodecZstd = 1;
inline constexpr std::uint32_t kMinBlockBytes = 1u << 12;
inline constexpr std::uint32_t kMaxBlockBytes = 1u << 23;
/// Header, asset table and directory are never longer than this.
inline constexpr std::uint64_t kMaxHeadBytes =
    kHeaderBytes + kMaxAssets * std::uint64_t{kAssetBytes} + kMaxChunks * std::uint64_t{kEntryBytes};

/// A row of the asset table. [spec 3.2]
struct AssetInfo {
  std::uint32_t representation = 0;
  const Representation* rules = nullptr;  ///< of the representation; null if it is unknown
  std::string name;                       ///< UTF-8, may be empty
  std::uint32_t first_chunk = 0;          ///< in the directory; an asset's chunks follow each other there
  std::uint32_t chunk_count = 0;
};

/// A directory entry. [spec 3.3]
struct ChunkInfo {
  std::uint32_t type = 0;
  bool critical = false;
  std::uint32_t codec = 0;
  std::uint32_t block_bytes = 0;    ///< decoded bytes of every block but the last
  std::uint64_t offset = 0;         ///< from the file's start, bytes
  std::uint64_t stored_bytes = 0;   ///< in the file, with the block table
  std::uint64_t decoded_bytes = 0;  ///< of all blocks
  std::uint64_t hash = 0;           ///< of the block table, or without one of the stored bytes

  [[nodiscard]] std::uint64_t block_count() const {
    return block_bytes == 0 ? 0 : decoded_bytes / block_bytes + (decoded_bytes % block_bytes != 0);
  }
  bool operator==(const ChunkInfo&) const = default;
};

/// What header, asset table and directory say.
struct ContainerScan {
  std::uint16_t major = 0;
  std::uint16_t minor = 0;
  std::uint64_t file_bytes = 0;
  std::vector<AssetInfo> assets;
  std::vector<ChunkInfo> chunks;
  std::vector<bool> usable;  ///< the chunk lies in the file and its sizes fit its codec, one a chunk

  /// Index in `chunks` of the asset's first chunk of this type, if it has one.
  [[nodiscard]] std::optional<std::size_t> find(std::size_t asset, std::uint32_t type) const;
  /// Byte in the file where a chunk's directory entry begins.
  [[nodiscard]] std::uint64_t entry_at(std::size_t chunk) const {
    return kHeaderBytes + assets.size() * kAssetBytes + chunk * kEntryBytes;
  }
};

/// Bytes that the header, the asset table and the directory take, by a header of at least 64 bytes that may
/// be wrong: never more than kMaxHeadBytes.
[[nodiscard]] std::uint64_t head_bytes(std::span<const std::byte> header);

/// Reads and checks header, asset table and directory. `head` holds the file's first bytes: all, or at least
/// the first head_bytes(). `file_bytes` is the file's size. Untrusted input: safe. Empty if the directory
/// could not be reached or the sink is full.
[[nodiscard]] std::optional<ContainerScan> scan_container(std::span<const std::byte> head,
                                                          std::uint64_t file_bytes, const ReadLimits& limits,
                                                          IssueSink& sink);

/// Checks which chunks an asset has, by its representation's rules. [spec 3.3, 4] False if that is unknown.
[[nodiscard]] bool scan_asset(const ContainerScan& scan, std::size_t asset, IssueSink& sink);

/// Takes the decoded bytes of the asset's usable chunks from the budget; reports if that does not allow it.
[[nodiscard]] bool charge_asset(const ContainerScan& scan, std::size_t asset, MemoryBudget& budget,
                                IssueSink& sink);

}  // namespace mesocell
