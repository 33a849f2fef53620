#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/api.h"
#include "format/container_scan.h"
#include "format/limits.h"
#include "format/result.h"

namespace mesocell MESOCELL_API {

/// A file of assets, opened for reading. It refers to the bytes it was opened on and does not copy them.
/// Untrusted input: safe, all of it.
class Container {
 public:
  /// Checks the header, the asset table and the directory; it does not look at chunks. [spec 3] Errors:
  /// kInvalidInput with the id, kLimit.
  [[nodiscard]] static Result<Container> open(std::span<const std::byte> file, const ReadLimits& limits = {});

  [[nodiscard]] std::uint16_t major() const { return scan_.major; }
  [[nodiscard]] std::uint16_t minor() const { return scan_.minor; }
  [[nodiscard]] std::uint64_t file_bytes() const { return scan_.file_bytes; }
  /// In the order of the file; there is at least one.
  [[nodiscard]] std::span<const AssetInfo> assets() const { return scan_.assets; }
  /// Of all assets, in the order of the file.
  [[nodiscard]] std::span<const ChunkInfo> chunks() const { return scan_.chunks; }
  /// Of one asset. `asset` < assets().size() (assert), also below.
  [[nodiscard]] std::span<const ChunkInfo> chunks_of(std::size_t asset) const;

  /// Checks which chunks an asset has and all hashes and padding of them, also of those that a reader may
  /// skip.
  [[nodiscard]] Status verify(std::size_t asset) const;

  /// Checks the hashes of the asset's chunk of this type and decodes it. Errors: kInvalidInput (hash, codec,
  /// no such chunk), kLimit. What the bytes mean is not checked.
  [[nodiscard]] Result<std::vector<std::byte>> read_chunk(std::size_t asset, std::uint32_t type) const;

  [[nodiscard]] std::span<const std::byte> file() const { return file_; }
  [[nodiscard]] const ContainerScan& scan() const { return scan_; }

 private:
  std::span<const std::byte> file_;
  ContainerScan scan_;
  ReadLimits limits_;
};

/// A version of the format.
struct FormatVersion {
  std::uint16_t major = kFormatMajor;
  std::uint16_t minor = kFormatMinor;
  bool operator==(const FormatVersion&) const = default;
};

/// How a file is written.
struct WriteOptions {
  /// The newest that may be written; what it does not have is left out. The file states the least version
  /// that has all of it. kUsage for a version that there is not.
  FormatVersion version;
  /// Compress chunks where that makes the file smaller; if not, all of them can be used in place from a
  /// memory map.
  bool compress = true;
};

/// Collects assets and chunks and writes them in the order in which they were added. Same chunks, same bytes.
class ContainerWriter {
 public:
  enum class Importance : std::uint8_t { kSkippable, kCritical };

  /// Blocks of a chunk, if nothing else is asked for: small ones cost size, for each is compressed alone.
  static constexpr std::uint32_t kUsualBlockBytes = 1u << 20;

  /// Whether blocks of `block_bytes` will do; `stored` is how many bytes of the file each takes, in their
  /// order.
  using BlocksFit = std::function<bool(std::uint32_t block_bytes, std::span<const std::uint64_t> stored)>;

  explicit ContainerWriter(const WriteOptions& options = {}) : options_(options) {}

  /// The chunks that follow are of this asset. `name`: UTF-8 without zero, at most 40 bytes, not that of
  /// another asset unless it is empty: kUsage in finish() if not.
  void begin_asset(std::uint32_t representation, std::string_view name = {});
  /// `type` must not have been added to the asset before (assert). `block_bytes` is how many bytes can be
  /// read alone, a power of two of at least 4 KiB and at most 8 MiB (assert). As long as `fits` refuses it,
  /// it is halved.
  void add_chunk(std::uint32_t type, Importance importance, std::span<const std::byte> bytes,
                 std::uint32_t block_bytes = kUsualBlockBytes, const BlocksFit& fits = {});

  /// Bytes of the file. At least one asset must have been begun, and each have a chunk (assert). Errors:
  /// kLimit (too many assets or chunks, no memory), kUsage.
  [[nodiscard]] Result<std::vector<std::byte>> finish();

 private:
  struct Asset {
    std::uint32_t representation = 0;
    std::string name;
    std::uint32_t chunk_count = 0;
  };
  struct Chunk {
    ChunkInfo info;
    std::vector<std::byte> stored;
  };
  /// The least minor version that has all chunks that were added.
  [[nodiscard]] std::uint16_t least_minor() const;

  WriteOptions options_;
  std::vector<Asset> assets_;
  std::vector<Chunk> chunks_;
  bool out_of_memory_ = false;
};

}  // namespace mesocell
