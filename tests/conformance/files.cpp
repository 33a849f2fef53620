#include "tests/conformance/files.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <limits>

#include "format/byte_writer.h"
#include "format/fourcc.h"
#include "format/hash.h"
#include "tests/conformance/cases.h"

namespace mesocell::test {

CellObject tiny_object() {
  CellObject object = walkthrough_object();
  object.metadata.clear();
  return object;
}

TestFile tiny() {
  TestFile parts = TestFile::of(tiny_object());
  parts.chunks.pop_back();  // the empty TEXT
  return parts;
}

TestFile small() { return TestFile::of(walkthrough_object()); }

TestFile tiny_with(std::uint32_t type, Bytes payload) {
  TestFile parts = tiny();
  const std::uint64_t size = payload.size();
  parts.chunks.push_back({type, 0, 0, size, std::move(payload)});
  return parts;
}

CellObject solid_object(const Index3& resolution, const Index3& tiles) {
  CellObject object = tiny_object();
  object.tile.resolution = resolution;
  object.tile.cell_count = 1;
  object.tile.pieces = {{1, {0, 0, 0}}};
  object.tile.voxel_ids.assign(object.tile.voxel_count(), 1);
  object.grid.tiles = object.membership.tiles = tiles;
  object.membership.cell_count = 1;
  object.membership.blocks.clear();
  object.membership.entries.assign(object.grid.tile_count(), 1);
  return object;
}

CellObject row_object(std::uint32_t tiles, const std::vector<std::uint32_t>& mixed) {
  CellObject object = tiny_object();
  object.grid.tiles = object.membership.tiles = {tiles, 1, 1};
  object.membership.entries.assign(tiles, 1);
  object.membership.blocks.clear();
  for (const std::uint32_t tile : mixed) {
    object.membership.entries.at(tile) =
        MembershipMap::kFirstBlock + std::uint32_t(object.membership.blocks.size());
    object.membership.blocks.push_back(0b1001);
  }
  return object;
}

CellObject many_cells_object(std::uint32_t cells) {
  CellObject object = tiny_object();
  TileMap& tile = object.tile;
  tile.resolution = {8, 8, 4};
  tile.cell_count = cells;
  tile.id_bytes = TileMap::id_bytes_for(cells);
  tile.pieces.clear();
  tile.voxel_ids.assign(tile.voxel_count() * tile.id_bytes, 0);
  for (std::uint32_t c = 1; c <= cells; ++c) {
    tile.pieces.push_back({std::uint16_t(c), {0, 0, 0}});
    for (std::uint32_t b = 0; b < tile.id_bytes; ++b)
      tile.voxel_ids[(c - 1) * tile.id_bytes + b] = std::uint8_t(c >> (8 * b));
  }
  object.membership.cell_count = cells;
  object.membership.blocks.assign(object.membership.block_bytes(), 0);
  object.membership.blocks[0] = 0b01;  // the first cell INSIDE, the others OUTSIDE
  return object;
}

Bytes patched(Bytes file, std::size_t at, std::uint64_t value, unsigned bytes) {
  put(file, at, value, bytes);
  reseal_directory(file);
  return file;
}

Bytes flipped(Bytes file, std::size_t at, unsigned mask) {
  return patched(file, at, get(file, at, 1) ^ mask, 1);
}

Bytes damaged(Bytes file, std::size_t at, unsigned mask) {
  put(file, at, get(file, at, 1) ^ mask, 1);
  return file;
}

Bytes sized(Bytes file, std::size_t bytes) {
  file.resize(bytes);
  put(file, 16, bytes, 8);
  reseal_header(file);
  return file;
}

Bytes edited(TestFile parts, std::uint32_t type, const std::function<void(Bytes&)>& edit) {
  Bytes payload = parts.payload(type);
  edit(payload);
  parts.set_payload(type, std::move(payload));
  return parts.build();
}

Bytes with(TestFile parts, std::uint32_t type, std::size_t at, std::uint64_t value, unsigned bytes) {
  return edited(std::move(parts), type, [&](Bytes& payload) { put(payload, at, value, bytes); });
}

Bytes with_bit(TestFile parts, std::uint32_t type, std::size_t at, unsigned bit) {
  return edited(std::move(parts), type, [&](Bytes& payload) {
    put(payload, at + bit / 8, get(payload, at + bit / 8, 1) ^ 1u << bit % 8, 1);
  });
}

Bytes with_size(TestFile parts, std::uint32_t type, std::size_t bytes) {
  return edited(std::move(parts), type, [&](Bytes& payload) { payload.resize(bytes); });
}

Bytes joined(std::vector<TestFile> assets) {
  TestFile first = assets.at(0);
  first.others.assign(assets.begin() + 1, assets.end());
  return first.build();
}

TestFile named(TestFile parts, std::string name) {
  parts.name = std::move(name);
  return parts;
}

namespace {

unsigned size_bytes_of(std::uint64_t size, const FrameOptions& options) {
  if (options.size_bytes > 0) return options.size_bytes;
  if (size < 256 && options.single_segment) return 1;
  return size >= 256 && size < 65536 + 256 ? 2 : 4;
}

/// Bytes from `begin` that are the same as the first of them, at most this many.
std::size_t run_length(std::span<const std::byte> bytes, std::size_t begin, std::size_t most) {
  const std::size_t last = std::min(bytes.size(), begin + most);
  std::size_t end = begin;
  while (end < last && bytes[end] == bytes[begin]) ++end;
  return end - begin;
}

}  // namespace

std::size_t frame_header_bytes(std::span<const std::byte> payload, const FrameOptions& options) {
  return 5 + (options.single_segment ? 0 : 1) + options.dictionary_id.size() +
         size_bytes_of(payload.size(), options);
}

Bytes frame(std::span<const std::byte> payload, const FrameOptions& options) {
  constexpr std::size_t kShortestRun = 8;  // else a raw block's header costs as much
  const std::uint64_t size = options.size.value_or(payload.size());
  const unsigned size_bytes = size_bytes_of(payload.size(), options);
  const unsigned size_flag = size_bytes == 1 ? 0 : size_bytes == 2 ? 1 : size_bytes == 4 ? 2 : 3;
  const unsigned dictionary_flag =
      options.dictionary_id.size() == 4 ? 3 : unsigned(options.dictionary_id.size());
  ByteWriter out;
  out.u32(0xFD2FB528);
  out.u8(std::uint8_t((size_flag << 6 | (options.single_segment ? 0x20u : 0u) | (options.checksum ? 4u : 0u) |
                       dictionary_flag) ^
                      options.descriptor_bits));
  if (!options.single_segment) out.u8(std::uint8_t(options.window));
  out.append(options.dictionary_id);
  const std::uint64_t stated = size_bytes == 2 ? size - 256 : size;
  for (unsigned i = 0; i < size_bytes; ++i) out.u8(std::uint8_t(stated >> (8 * i)));

  std::size_t at = 0;
  do {
    const std::size_t run = run_length(payload, at, options.largest_block);
    const bool is_run = run >= kShortestRun;
    std::size_t bytes = run;
    if (!is_run) {
      for (bytes = 0; at + bytes < payload.size() && bytes < options.largest_block; ++bytes)
        if (run_length(payload, at + bytes, kShortestRun) >= kShortestRun) break;
    }
    const bool last = at + bytes == payload.size();
    const std::uint32_t header = std::uint32_t(bytes << 3) | (is_run ? 2u : 0u) | (last ? 1u : 0u);
    out.u16(std::uint16_t(header & 0xffff));
    out.u8(std::uint8_t(header >> 16));
    out.append(payload.subspan(at, is_run ? 1 : bytes));
    at += bytes;
  } while (at < payload.size());
  if (options.checksum) out.u32(std::uint32_t(hash64(payload) & 0xffffffff));
  return out.release();
}

void compress_by_hand(TestChunk& chunk, const FrameOptions& options) {
  chunk.codec = 1;
  chunk.decoded_bytes = chunk.stored.size();
  while (chunk.block_bytes < chunk.decoded_bytes) chunk.block_bytes *= 2;
  chunk.stored = frame(chunk.stored, options);
}

void pack(TestChunk& chunk) {
  TestChunk packed = chunk;
  compress_by_hand(packed);
  if (chunk.type != kGridChunk && packed.stored.size() < chunk.stored.size()) chunk = std::move(packed);
}

std::vector<Bytes> blocks_of(std::span<const std::byte> payload, std::uint32_t block_bytes, bool compressed) {
  std::vector<Bytes> blocks;
  for (std::size_t at = 0; at < payload.size(); at += block_bytes) {
    const auto block = payload.subspan(at, std::min<std::size_t>(block_bytes, payload.size() - at));
    Bytes stored(block.begin(), block.end());
    if (Bytes made = frame(block); compressed && made.size() < block.size()) stored = std::move(made);
    blocks.push_back(std::move(stored));
  }
  return blocks;
}

Bytes with_table(const std::vector<Bytes>& blocks, const std::vector<std::uint64_t>& ends) {
  ByteWriter out, data;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    data.append(blocks[b]);
    out.u64(b < ends.size() ? ends[b] : data.size());
    out.u64(hash64(blocks[b]));
  }
  out.pad_to(64);
  out.append(data.bytes());
  return out.release();
}

void split_by_hand(TestChunk& chunk, std::uint32_t block_bytes, bool compressed) {
  const auto blocks = blocks_of(chunk.stored, block_bytes, compressed);
  chunk.codec = compressed ? 1 : 0;
  chunk.block_bytes = block_bytes;
  chunk.decoded_bytes = chunk.stored.size();
  chunk.stored = blocks.size() > 1 ? with_table(blocks) : blocks.at(0);
}

Bytes operator+(Bytes a, std::span<const std::byte> b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::uint64_t bits(double v) { return std::bit_cast<std::uint64_t>(v); }
std::uint32_t bits(float v) { return std::bit_cast<std::uint32_t>(v); }

std::span<const BadText> bad_utf8() {
  // [Unicode 15, table 3-7]: what a decoder may take that looks at fewer bits than it should.
  static constexpr std::array<BadText, 32> all = {{
      {"continuation-80", "\x80"},
      {"continuation-bf", "\xbf"},
      {"continuation-after-letter", "a\x80"},
      {"overlong-2-c0", "\xc0\x80"},
      {"overlong-2-c1", "\xc1\xbf"},
      {"overlong-3-e0-80", "\xe0\x80\x80"},
      {"overlong-3-e0-9f", "\xe0\x9f\xbf"},
      {"overlong-4-f0-80", "\xf0\x80\x80\x80"},
      {"overlong-4-f0-8f", "\xf0\x8f\xbf\xbf"},
      {"surrogate-first-high", "\xed\xa0\x80"},
      {"surrogate-last-high", "\xed\xaf\xbf"},
      {"surrogate-first-low", "\xed\xb0\x80"},
      {"surrogate-last-low", "\xed\xbf\xbf"},
      {"surrogate-pair", "\xed\xa0\xbd\xed\xb0\xb0"},
      {"above-10ffff", "\xf4\x90\x80\x80"},
      {"lead-f5", "\xf5\x80\x80\x80"},
      {"lead-f7", "\xf7\xbf\xbf\xbf"},
      {"lead-f8", "\xf8\x88\x80\x80\x80"},
      {"lead-fc", "\xfc\x84\x80\x80\x80\x80"},
      {"byte-fe", "\xfe"},
      {"byte-ff", "\xff"},
      {"short-2", "\xc3"},
      {"short-3-one", "\xe2"},
      {"short-3-two", "\xe2\x82"},
      {"short-4-one", "\xf0"},
      {"short-4-two", "\xf0\x9f"},
      {"short-4-three", "\xf0\x9f\x90"},
      {"letter-within-2", "\xc3z"},
      {"letter-within-3", "\xe2\x82z"},
      {"letter-within-4", "\xf0\x9f\x90z"},
      {"lead-within-3", "\xe2\xc3\xa9"},
      {"latin-1", "na\xefve"},
  }};
  return all;
}

std::span<const BadFloat> bad_stated_errors() {
  static constexpr std::array<BadFloat, 10> all = {{
      {"minus-zero", 0x80000000},
      {"minus-least", 0x80000001},
      {"minus-half", 0xbf000000},
      {"minus-greatest", 0xff7fffff},
      {"minus-infinity", 0xff800000},
      {"infinity", 0x7f800000},
      {"signalling-nan", 0x7f800001},
      {"quiet-nan", 0x7fc00000},
      {"nan-all-bits", 0x7fffffff},
      {"minus-nan", 0xffffffff},
  }};
  return all;
}

std::string lower_name(std::uint32_t type) {
  std::string name = fourcc_text(type);
  for (char& c : name) c = char(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

void add_chunk_header_cases(CaseList& cases, const TestFile& parts, std::uint32_t type, std::size_t fields) {
  const std::string name = lower_name(type);
  for (const std::size_t bytes : {0u, 1u, 4u, 16u, 36u, 44u, 63u})
    cases.fault("payload-truncated/" + name + "-header-" + std::to_string(bytes),
                with_size(parts, type, bytes));
  for (std::size_t at = fields; at < 64; at += at < fields + 4 || at >= 60 ? 1 : 4) {
    // Another bit in each byte, so that no reader gets by with looking at one.
    cases.fault("payload-reserved/" + name + "-" + std::to_string(at), with_bit(parts, type, at, at % 8));
  }
}

void add_stated_error_cases(CaseList& cases, const TestFile& parts, std::uint32_t type, std::size_t at,
                            std::string_view clause) {
  const std::string name = lower_name(type);
  for (const BadFloat& bad : bad_stated_errors())
    cases.fault("map-error/" + name + "-" + std::string(bad.name), with(parts, type, at, bad.bits));
  constexpr std::array<std::pair<const char*, std::uint32_t>, 5> good = {
      {{"zero", 0}, {"least", 1}, {"quarter", 0x3e800000}, {"many", 0x43b40000}, {"greatest", 0x7f7fffff}}};
  for (const auto& [value, number] : good)
    cases.valid(name + "/stated-error-" + value, clause, with(parts, type, at, number));
}

}  // namespace mesocell::test
