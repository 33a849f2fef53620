#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/cell_object.h"
#include "format/limits.h"

/// Taking .meso files apart, changing them and putting them together with hashes that fit, so that a test
/// reaches what lies behind the hashes; and asking all three readers for their verdict.
namespace mesocell::test {

using Bytes = std::vector<std::byte>;

/// A chunk as a test wants it, right or wrong.
struct TestChunk {
  std::uint32_t type = 0;
  std::uint32_t flags = 0;
  std::uint32_t codec = 0;
  std::uint64_t decoded_bytes = 0;
  Bytes stored;
  std::uint32_t block_bytes = 1u << 20;
};

struct TestFile {
  std::uint32_t representation = 0;
  std::vector<TestChunk> chunks;
  std::uint16_t minor = 0;  ///< of the version that the file states
  std::string name;
  std::vector<TestFile> others;  ///< the assets that follow; theirs are not looked at

  /// The first asset of a valid file; all chunks decoded to raw and of one block.
  [[nodiscard]] static TestFile take_apart(std::span<const std::byte> file);
  /// The chunks of an object, right or wrong, raw and of one block; TEXT also if it is empty.
  [[nodiscard]] static TestFile of(const CellObject& object);
  /// The first chunk of this type (must be there).
  [[nodiscard]] TestChunk& chunk(std::uint32_t type);
  /// Replaces the payload by one that is stored raw.
  void set_payload(std::uint32_t type, Bytes payload);
  /// The payload of a raw chunk.
  [[nodiscard]] Bytes payload(std::uint32_t type) { return chunk(type).stored; }
  /// Header, directory and chunks, all hashes right.
  [[nodiscard]] Bytes build() const;
};

/// One zstd frame by the zstd library.
[[nodiscard]] Bytes zstd_frame(std::span<const std::byte> payload, int level = 3);
/// The same with another header: `descriptor` and what follows it, before the blocks that zstd made.
[[nodiscard]] Bytes zstd_frame_with_header(std::span<const std::byte> payload,
                                           std::initializer_list<std::uint8_t> header);
/// Turns a raw chunk of one block into a zstd chunk of one block, which stays raw if that is not smaller.
void compress(TestChunk& chunk, int level = 3);
/// Cuts a raw chunk of one block into blocks of this size, compressed or not.
void split(TestChunk& chunk, std::uint32_t block_bytes, bool compressed, int level = 3);

/// Where the directory entry of a chunk is, in a file of one asset.
constexpr std::size_t entry_at(std::size_t chunk) { return 128 + 64 * chunk; }

/// Writes `bytes` low bytes of `value` at `at`.
void put(Bytes& bytes, std::size_t at, std::uint64_t value, unsigned count = 4);
[[nodiscard]] std::uint64_t get(const Bytes& bytes, std::size_t at, unsigned count = 4);
/// Recomputes hashes of the header; of the tables, then of the header; of all blocks and chunks that lie in
/// the file, then of both.
void reseal_header(Bytes& file);
void reseal_directory(Bytes& file);
void reseal_chunks(Bytes& file);

/// What the three readers say of a file with all its assets. Each gets a heap buffer of exactly the file's
/// size.
struct Verdicts {
  bool reader = false;
  bool validator = false;
  bool loader = false;
  std::string reader_id;            ///< the issue that the reader stopped at
  std::vector<std::string> issues;  ///< ids, of the validator
  std::string loader_text;
  bool limit = false;  ///< the reader's error is kLimit
  bool loader_limit = false;
  /// All three agree; the validator names what the reader stopped at; and if the file is valid, reader and
  /// loader found the same maps and the maps encode to the chunks that were read.
  bool agree = false;
  std::string why;  ///< what they do not agree in

  [[nodiscard]] bool has(std::string_view id) const;
};
[[nodiscard]] Verdicts verdicts(std::span<const std::byte> file, const ReadLimits& limits = {});

}  // namespace mesocell::test
