#pragma once

#include <cstddef>
#include <cstdint>
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
};

struct TestFile {
  std::uint32_t representation = 0;
  std::vector<TestChunk> chunks;

  /// Of a valid file; all chunks decoded to raw.
  [[nodiscard]] static TestFile take_apart(std::span<const std::byte> file);
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
/// Turns a raw chunk into a zstd chunk.
void compress(TestChunk& chunk, int level = 3);

/// Writes `bytes` low bytes of `value` at `at`.
void put(Bytes& bytes, std::size_t at, std::uint64_t value, unsigned count = 4);
[[nodiscard]] std::uint64_t get(const Bytes& bytes, std::size_t at, unsigned count = 4);
/// Recomputes hashes of the header, of the directory, or of all chunks that lie in the file, then of both.
void reseal_header(Bytes& file);
void reseal_directory(Bytes& file);
void reseal_chunks(Bytes& file);

/// What the three readers say of a file. Each gets a heap buffer of exactly the file's size.
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
