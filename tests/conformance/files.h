#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/cell_object_chunks.h"
#include "format/text_chunk.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"

/// What the cases are made of: small valid files, and ways to change them.
namespace mesocell::test {

/// The object of the walk-through without text: GRID, TILE and MEMB of 64, 192 and 193 bytes.
[[nodiscard]] CellObject tiny_object();
[[nodiscard]] TestFile tiny();
/// The same with the walk-through's TEXT of 20 bytes as fourth chunk.
[[nodiscard]] TestFile small();
/// tiny() with one more raw chunk that is not critical.
[[nodiscard]] TestFile tiny_with(std::uint32_t type, Bytes payload);
/// One cell that fills a tile of this resolution, in a grid of these tiles, all INSIDE.
[[nodiscard]] CellObject solid_object(const Index3& resolution, const Index3& tiles);
/// tiny_object() with this many tiles along x, all INSIDE but for those that are mixed.
[[nodiscard]] CellObject row_object(std::uint32_t tiles, const std::vector<std::uint32_t>& mixed);
/// Tile of 8 × 8 × 4 voxels with a cell of its own in each of the first ones.
[[nodiscard]] CellObject many_cells_object(std::uint32_t cells);

/// Places in tiny() and small().
inline constexpr std::size_t kAssetAt = 64;
inline constexpr std::size_t kPiecesAt = 64, kIdsAt = 128;                   // in TILE
inline constexpr std::size_t kStatesAt = 64, kRanksAt = 128, kTagsAt = 192;  // in MEMB

/// The file with `bytes` bytes at `at` replaced and the hashes of header and tables made right.
[[nodiscard]] Bytes patched(Bytes file, std::size_t at, std::uint64_t value, unsigned bytes = 4);
/// The same with `mask` flipped in one byte.
[[nodiscard]] Bytes flipped(Bytes file, std::size_t at, unsigned mask);
/// The file with `mask` flipped in one byte and no hash made right.
[[nodiscard]] Bytes damaged(Bytes file, std::size_t at, unsigned mask = 1);
/// The file with another size and the header's size and hash made right.
[[nodiscard]] Bytes sized(Bytes file, std::size_t bytes);

/// The file with the payload of a raw chunk changed.
[[nodiscard]] Bytes edited(TestFile parts, std::uint32_t type, const std::function<void(Bytes&)>& edit);
/// Numbers, bits and sizes in a payload.
[[nodiscard]] Bytes with(TestFile parts, std::uint32_t type, std::size_t at, std::uint64_t value,
                         unsigned bytes = 4);
[[nodiscard]] Bytes with_bit(TestFile parts, std::uint32_t type, std::size_t at, unsigned bit);
[[nodiscard]] Bytes with_size(TestFile parts, std::uint32_t type, std::size_t bytes);
/// The file with the second asset's, third asset's … parts after the first's.
[[nodiscard]] Bytes joined(std::vector<TestFile> assets);
[[nodiscard]] TestFile named(TestFile parts, std::string name);

/// How a zstd frame is made by hand, of raw and RLE blocks: the same bytes with every zstd library.
struct FrameOptions {
  unsigned size_bytes = 0;  ///< 1, 2, 4 or 8; 0: the least that holds the size
  bool single_segment = true;
  unsigned window = 0;                               ///< descriptor, if not single segment
  unsigned descriptor_bits = 0;                      ///< flipped in the frame header's first byte
  std::optional<std::uint64_t> size = std::nullopt;  ///< stated instead of the true one
  Bytes dictionary_id = {};
  bool checksum = false;
  std::size_t largest_block = 128 << 10;
};
[[nodiscard]] Bytes frame(std::span<const std::byte> payload, const FrameOptions& options = {});
/// Bytes of a frame before its first block.
[[nodiscard]] std::size_t frame_header_bytes(std::span<const std::byte> payload,
                                             const FrameOptions& options = {});

/// Stores a raw chunk of one block as one frame().
void compress_by_hand(TestChunk& chunk, const FrameOptions& options = {});
/// The same if the chunk may be zstd and gets smaller.
void pack(TestChunk& chunk);
/// The blocks of a payload: raw, or frames where they are smaller.
[[nodiscard]] std::vector<Bytes> blocks_of(std::span<const std::byte> payload, std::uint32_t block_bytes,
                                           bool compressed);
/// Block table and blocks. `ends`: instead of the true ones.
[[nodiscard]] Bytes with_table(const std::vector<Bytes>& blocks, const std::vector<std::uint64_t>& ends = {});
/// Stores a raw chunk of one block in blocks of this size.
void split_by_hand(TestChunk& chunk, std::uint32_t block_bytes, bool compressed);

[[nodiscard]] Bytes operator+(Bytes a, std::span<const std::byte> b);
[[nodiscard]] Bytes bytes_of(std::string_view text);
[[nodiscard]] std::uint64_t bits(double v);
[[nodiscard]] std::uint32_t bits(float v);

/// Strings that are not UTF-8, each with a name.
struct BadText {
  std::string_view name, text;
};
[[nodiscard]] std::span<const BadText> bad_utf8();
/// Stated errors that are not finite or below zero, each with a name.
struct BadFloat {
  std::string_view name;
  std::uint32_t bits;
};
[[nodiscard]] std::span<const BadFloat> bad_stated_errors();

class CaseList;
/// What every chunk with a header has, of `type` in `parts` with fields of `fields` bytes: header cut short
/// at and around its fields, a bit that is not zero in every byte that is reserved.
void add_chunk_header_cases(CaseList& cases, const TestFile& parts, std::uint32_t type, std::size_t fields);
/// A stated error at `at`: values from both sides of every bound.
void add_stated_error_cases(CaseList& cases, const TestFile& parts, std::uint32_t type, std::size_t at,
                            std::string_view clause);
/// "grid" of GRID.
[[nodiscard]] std::string lower_name(std::uint32_t type);

}  // namespace mesocell::test
