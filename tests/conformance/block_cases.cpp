#include <array>
#include <utility>

#include "format/fourcc.h"
#include "format/hash.h"
#include "format/normal_map.h"
#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

/// Chunks of several blocks. [spec 3.5, 3.6]
namespace mesocell::test {
namespace {

using std::to_string;

constexpr std::uint32_t kBlock = 4096;
constexpr std::size_t kTextEntry = entry_at(3);

/// TEXT of 10000 bytes, three blocks of 4096, 4096 and 1808, of which as frames each is small.
Bytes long_text() { return encode_text({{"long", std::string(9984, 'm')}}); }

Bytes last_bytes(std::ptrdiff_t count) {
  const Bytes all = long_text();
  return Bytes(all.end() - count, all.end());
}

TestFile with_text(const Bytes& payload, bool compressed) {
  TestFile parts = tiny_with(kTextChunk, payload);
  split_by_hand(parts.chunks.back(), kBlock, compressed);
  return parts;
}

TestFile three_frames() { return with_text(long_text(), true); }
std::vector<Bytes> frames() { return blocks_of(long_text(), kBlock, true); }

/// three_frames() with other blocks, or a table of these ends.
Bytes with_blocks(const std::vector<Bytes>& blocks, const std::vector<std::uint64_t>& ends = {}) {
  TestFile parts = three_frames();
  parts.chunks.back().stored = with_table(blocks, ends);
  return parts.build();
}

/// A file whose TEXT says `decoded` bytes in blocks of this size and stores these bytes.
Bytes promising(std::uint64_t decoded, std::uint32_t block_bytes, std::size_t stored,
                std::uint32_t codec = 1) {
  TestFile parts = tiny_with(kTextChunk, Bytes(stored, std::byte{1}));
  parts.chunks.back().codec = codec;
  parts.chunks.back().block_bytes = block_bytes;
  parts.chunks.back().decoded_bytes = decoded;
  return parts.build();
}

void add_valid_cases(CaseList& cases) {
  cases.valid("blocks/three-frames", "3.5", three_frames().build());
  cases.valid("blocks/two-raw", "3.5",
              with_text(encode_text({{"k", std::string(4100, 'm')}}), false).build());
  // The second block does not get smaller.
  std::string noise(9984, 'n');
  for (std::size_t i = 4000; i < 8500; ++i) noise[i] = char('a' + (i * i / 7 + i) % 26);
  cases.valid("blocks/frame-raw-frame", "3.5", with_text(encode_text({{"noise", noise}}), true).build());
  for (const std::size_t bytes : {4095u, 4096u, 4097u, 8191u, 8192u, 8193u, 16384u, 16385u, 20481u}) {
    const Bytes payload = encode_text({{"k", std::string(bytes - 13, 'v')}});
    cases.valid("blocks/of-" + to_string(bytes) + "-bytes", "3.5", with_text(payload, true).build());
  }
  // Every chunk but GRID in blocks.
  CellObject object = solid_object({16, 16, 32}, {70000, 1, 1});
  object.color = ColorMap{{20, 10, 10}, std::vector<Rgb8>(2000, {9, 9, 9})};
  object.normals.emplace().normals.assign(count_boundary_voxels(object.tile), {126, 252});
  const TestFile parts = TestFile::of(object);
  for (std::size_t i = 1; i < parts.chunks.size(); ++i) {
    if (parts.chunks[i].stored.size() <= kBlock) continue;
    TestFile one = parts;
    for (TestChunk& c : one.chunks)
      if (&c != &one.chunks[i]) pack(c);
    split_by_hand(one.chunks[i], kBlock, true);
    cases.valid("blocks/one-chunk-" + lower_name(parts.chunks[i].type), "3.5", one.build());
  }
  cases.valid("blocks/a-chunk-of-none", "3.5", tiny_with(fourcc("NONE"), {}).build(),
              "chunk-unknown-skippable");
  TestFile none = tiny_with(fourcc("NONE"), {});
  none.chunks.back().codec = 1;
  cases.valid("blocks/a-zstd-chunk-of-none", "3.5", none.build(), "chunk-unknown-skippable");
  TestFile raw = tiny_with(kTextChunk, encode_text({{"k", "v"}}));
  raw.chunks.back().codec = 1;
  cases.valid("blocks/a-raw-block-of-zstd", "3.5", raw.build());
}

void add_table_cases(CaseList& cases) {
  // Three blocks have a table of 48 bytes and 16 of padding.
  for (const std::size_t stored : {0u, 1u, 15u, 16u, 32u, 47u, 48u, 49u, 63u}) {
    cases.fault("block-table/frames-of-" + to_string(stored), promising(10000, kBlock, stored));
    cases.fault("block-table/raw-of-" + to_string(stored), promising(10000, kBlock, stored, 0));
  }
  cases.fault("block-table/2-to-40-bytes", promising(1ull << 40, kBlock, 64));
  cases.fault("block-table/2-to-63-bytes", promising(1ull << 63, kBlock, 64));
  cases.fault("block-table/all-ones", promising(~0ull, 8388608, 64));
  cases.fault("block-table/table-wraps", promising(~0ull, kBlock, 64));
  cases.fault("block-table/five-blocks", promising(4 * kBlock + 1, kBlock, 127));
  cases.fault("chunk-raw-size/blocks-one-less", promising(4200, kBlock, 64 + 4199, 0));
  cases.fault("chunk-raw-size/blocks-one-more", promising(4200, kBlock, 64 + 4201, 0));
  cases.fault("chunk-raw-size/blocks-without-a-table", promising(4200, kBlock, 4200, 0));
  cases.fault("chunk-raw-size/a-table-for-one-block", promising(64, kBlock, 128, 0));
  cases.fault("chunk-raw-size/2-to-32-more", promising((1ull << 32) + 64, 8388608, 512 * 16 + 128, 0));

  const Bytes file = three_frames().build();
  const std::size_t at = get(file, kTextEntry + 16, 8);
  for (std::size_t byte = 48; byte < 64; byte += 5)
    cases.fault("padding-nonzero/after-the-table-" + to_string(byte),
                flipped(file, at + byte, 1u << byte % 8));
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t byte = 0; byte < 16; byte += 5)
      cases.fault("chunk-hash/table-" + to_string(16 * row + byte), flipped(file, at + 16 * row + byte, 1));
  }
  const auto hashed = [&](std::span<const std::byte> bytes) {
    return patched(file, kTextEntry + 40, hash64(bytes), 8);
  };
  const std::span all(file);
  const std::size_t stored = get(file, kTextEntry + 24, 8);
  cases.fault("chunk-hash/of-all-stored-bytes", hashed(all.subspan(at, stored)));
  cases.fault("chunk-hash/of-the-blocks", hashed(all.subspan(at + 64, stored - 64)));
  cases.fault("chunk-hash/of-the-table-and-its-padding", hashed(all.subspan(at, 64)));
  cases.fault("chunk-hash/of-the-decoded-bytes", hashed(long_text()));
}

void add_hash_cases(CaseList& cases) {
  // A row's hash is wrong and the table's own right.
  const auto with_row_hash = [](std::size_t row, auto change) {
    TestFile parts = three_frames();
    Bytes& stored = parts.chunks.back().stored;
    put(stored, 16 * row + 8, change(get(stored, 16 * row + 8, 8)), 8);
    return parts.build();
  };
  for (std::size_t row = 0; row < 3; ++row) {
    const std::string name = "block-hash/row-" + to_string(row);
    for (unsigned byte = unsigned(row); byte < 8; byte += 2)
      cases.fault(name + "-byte-" + to_string(byte), with_row_hash(row, [&](std::uint64_t hash) {
                    return hash ^ 1ull << (8 * byte + (row + byte) % 8);
                  }));
    cases.fault(name + "-zero", with_row_hash(row, [](std::uint64_t) { return std::uint64_t{0}; }));
  }
  const Bytes file = three_frames().build();
  const std::size_t data = get(file, kTextEntry + 16, 8) + 64;
  for (std::size_t byte = 0; byte < get(file, kTextEntry + 24, 8) - 64; byte += 6)
    cases.fault("block-hash/damaged-" + to_string(byte), damaged(file, data + byte, 1u << byte % 8));
  TestFile parts = three_frames();
  Bytes& stored = parts.chunks.back().stored;
  const std::uint64_t first = get(stored, 8, 8), second = get(stored, 24, 8);
  put(stored, 8, second, 8);
  put(stored, 24, first, 8);
  cases.fault("block-hash/two-changed-places", parts.build());
  parts = three_frames();
  put(parts.chunks.back().stored, 40, hash64(last_bytes(1808)), 8);
  cases.fault("block-hash/of-decoded-bytes", parts.build());
}

void add_size_cases(CaseList& cases) {
  const auto blocks = frames();
  const std::uint64_t a = blocks[0].size(), b = a + blocks[1].size(), c = b + blocks[2].size();
  // Where the ends are wrong, so are hashes of what lies between them.
  const std::array<std::pair<const char*, std::vector<std::uint64_t>>, 12> ends = {{
      {"first-empty", {0, b, c}},
      {"second-empty", {a, a, c}},
      {"third-empty", {a, c, c}},
      {"first-one-less", {a - 1, b, c}},
      {"second-one-more", {a, b + 1, c}},
      {"out-of-order", {b, a, c}},
      {"last-one-less", {a, b, c - 1}},
      {"last-one-more", {a, b, c + 1}},
      {"last-is-zero", {a, b, 0}},
      {"last-2-to-32-more", {a, b, c + (1ull << 32)}},
      {"last-all-ones", {a, b, ~0ull}},
      {"counted-from-the-chunk", {64 + a, 64 + b, 64 + c}},
  }};
  for (const auto& [name, rows] : ends) {
    if (rows[0] == a - 1 || rows[1] == b + 1)
      cases.faults("block-hash/end-" + std::string(name), with_blocks(blocks, rows));
    else
      cases.faults("block-size/" + std::string(name), with_blocks(blocks, rows));
  }
  cases.faults("block-size/sizes-for-ends", with_blocks(blocks, {a, b - a, c - b}));
  cases.fault("block-size/bytes-after-the-last", [&] {
    TestFile parts = three_frames();
    parts.chunks.back().stored.push_back(std::byte{0});
    return parts.build();
  }());
  // Blocks with right hashes, and sizes that none can have.
  cases.fault("block-size/really-empty", with_blocks({blocks[0], {}, blocks[2]}));
  cases.fault("block-size/first-really-empty", with_blocks({{}, blocks[1], blocks[2]}));
  cases.fault("block-size/last-really-empty", with_blocks({blocks[0], blocks[1], {}}));
  cases.fault("block-size/larger-than-decoded", with_blocks({blocks[0], Bytes(4097), blocks[2]}));
  cases.fault("block-size/last-larger-than-decoded", with_blocks({blocks[0], blocks[1], Bytes(1809)}));
  const Bytes text = long_text();
  const auto part = [&](std::size_t begin, std::size_t end) {
    return Bytes(text.begin() + std::ptrdiff_t(begin), text.begin() + std::ptrdiff_t(end));
  };
  // A frame of a raw block: zstd takes it, but it is larger than what it holds.
  Bytes wrapped = bytes_of(std::string_view("\x28\xb5\x2f\xfd\x60\x00\x0f\x01\x80\x00", 10));
  cases.fault("block-size/raw-in-a-frame", with_blocks({blocks[0], wrapped + part(4096, 8192), blocks[2]}));
  // Raw blocks that are not as long as they must be, and make up for each other.
  TestFile raw = with_text(part(0, 4300), false);
  raw.chunks.back().stored = with_table({part(0, 4095), part(4095, 4300)});
  cases.fault("block-size/raw-first-one-less", raw.build());
  raw.chunks.back().stored = with_table({part(0, 204), part(204, 4300)});
  cases.fault("block-size/raw-short-one-first", raw.build());

  cases.fault("block-size/one-block-of-none", promising(20, kBlock, 0));
  cases.fault("block-size/one-block-of-one-more", promising(20, kBlock, 21));
  cases.fault("block-size/one-block-of-many-more", promising(20, kBlock, 500));
  cases.fault("block-size/bytes-that-decode-to-none", promising(0, kBlock, 1));
  // One stored byte to 32768 decoded ones is the most.
  cases.fault("block-ratio/one-block", promising(1 << 20, 1 << 20, 31));
  cases.fault("block-ratio/one-byte", promising(65536, 65536, 1));
  cases.fault("block-ratio/8388608", promising(8388608, 8388608, 255));
  cases.fault("block-ratio/last-byte-of-8388607", promising(8388607, 8388608, 254));
  TestFile wide = tiny_with(kTextChunk, {});
  wide.chunks.back().codec = 1;
  wide.chunks.back().block_bytes = 1 << 20;
  wide.chunks.back().decoded_bytes = 3 << 20;
  const auto with_sizes = [&](std::size_t x, std::size_t y, std::size_t z) {
    wide.chunks.back().stored = with_table({Bytes(x), Bytes(y), Bytes(z)});
    return wide.build();
  };
  cases.fault("block-ratio/first-of-three", with_sizes(31, 32, 32));
  cases.fault("block-ratio/second-of-three", with_sizes(32, 31, 32));
  cases.fault("block-ratio/third-of-three", with_sizes(32, 32, 31));
  cases.fault("zstd-frame/at-the-least-ratio", with_sizes(32, 32, 32));
}

/// Blocks that are right one by one, and not for their place.
void add_content_cases(CaseList& cases) {
  auto blocks = frames();
  std::swap(blocks[0], blocks[2]);
  cases.fault("zstd-size/first-and-last-changed-places", with_blocks(blocks));
  blocks = frames();
  blocks[1] = frame(long_text());
  cases.fault("zstd-size/all-in-the-second", with_blocks(blocks));
  blocks = frames();
  blocks[2] = blocks[1];
  cases.fault("zstd-size/last-is-a-whole-one", with_blocks(blocks));
  blocks[2] = frame(last_bytes(1807));
  cases.fault("zstd-size/last-one-less", with_blocks(blocks));
  blocks = frames();
  blocks[1][0] ^= std::byte{1};
  cases.fault("zstd-frame/of-the-second-block", with_blocks(blocks));
  blocks = frames();
  blocks[1].pop_back();
  cases.fault("zstd-data/second-block-cut", with_blocks(blocks));
  blocks = frames();
  blocks[1].push_back(std::byte{0});
  cases.fault("zstd-frame/a-byte-after-the-second-block", with_blocks(blocks));
  // One frame over all of the chunk, as if there were no blocks.
  TestFile parts = tiny_with(kTextChunk, long_text());
  compress_by_hand(parts.chunks.back());
  parts.chunks.back().block_bytes = kBlock;
  cases.fault("block-table/one-frame-for-three-blocks", parts.build());
}

}  // namespace

void add_block_cases(CaseList& cases) {
  add_valid_cases(cases);
  add_table_cases(cases);
  add_hash_cases(cases);
  add_size_cases(cases);
  add_content_cases(cases);
}

}  // namespace mesocell::test
