#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/api.h"
#include "format/container_scan.h"
#include "format/limits.h"
#include "format/result.h"

namespace mesocell MESOCELL_API {

/// A file of chunks, opened for reading. It refers to the bytes it was opened on and does not copy them.
/// Untrusted input: safe, all of it.
class Container {
 public:
  /// Checks the header, the directory, where chunks lie, the padding between them and whether all required
  /// and no unknown critical chunks are there; it does not look into chunks. [spec 3] Errors: kInvalidInput
  /// with the id, kLimit.
  [[nodiscard]] static Result<Container> open(std::span<const std::byte> file, const ReadLimits& limits = {});

  [[nodiscard]] std::uint16_t major() const { return scan_.major; }
  [[nodiscard]] std::uint16_t minor() const { return scan_.minor; }
  [[nodiscard]] std::uint32_t representation() const { return scan_.representation; }
  [[nodiscard]] std::uint64_t file_bytes() const { return scan_.file_bytes; }
  /// In the order of the file.
  [[nodiscard]] std::span<const ChunkInfo> chunks() const { return scan_.chunks; }

  /// Checks the hash of every chunk, also of those that a reader may skip.
  [[nodiscard]] Status verify() const;

  /// Checks the hash of the chunk of this type and decodes it. Errors: kInvalidInput (hash, codec, no such
  /// chunk), kLimit. What the bytes mean is not checked.
  [[nodiscard]] Result<std::vector<std::byte>> read_chunk(std::uint32_t type) const;

  [[nodiscard]] std::span<const std::byte> file() const { return file_; }
  [[nodiscard]] const ContainerScan& scan() const { return scan_; }

 private:
  std::span<const std::byte> file_;
  ContainerScan scan_;
};

/// Collects chunks and writes them in the order in which they were added. Same chunks, same bytes.
class ContainerWriter {
 public:
  enum class Importance : std::uint8_t { kSkippable, kCritical };

  /// Compresses the bytes if that makes the file smaller. `type` must not have been added before (assert).
  void add_chunk(std::uint32_t type, Importance importance, std::span<const std::byte> bytes);

  /// Bytes of the file: header, directory, chunks. At least one chunk must have been added (assert).
  /// Errors: kLimit (more than 1024 chunks, no memory).
  [[nodiscard]] Result<std::vector<std::byte>> finish(std::uint32_t representation);

 private:
  struct Chunk {
    std::uint32_t type = 0;
    Importance importance = Importance::kSkippable;
    std::uint32_t codec = 0;
    std::uint64_t decoded_bytes = 0;
    std::vector<std::byte> stored;
  };
  std::vector<Chunk> chunks_;
  bool out_of_memory_ = false;
};

}  // namespace mesocell
