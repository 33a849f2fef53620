#include <array>
#include <utility>

#include "format/fourcc.h"
#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

/// Frames of one block: which are allowed, and that they hold what they should. [spec 3.6; RFC 8878]
namespace mesocell::test {
namespace {

using std::to_string;

/// TILE of tiny(), 192 bytes.
Bytes tile() { return tiny().payload(kTileChunk); }

Bytes with_tile_stored(Bytes stored) {
  TestFile parts = tiny();
  parts.chunk(kTileChunk).codec = 1;
  parts.chunk(kTileChunk).stored = std::move(stored);
  return parts.build();
}

Bytes framed(const FrameOptions& options) { return with_tile_stored(frame(tile(), options)); }

/// TEXT of this many bytes, most of them the same.
Bytes text_of(std::size_t bytes) { return encode_text({{"key", std::string(bytes - 15, 'v')}}); }

Bytes with_text_frame(const Bytes& payload, const FrameOptions& options) {
  TestFile parts = tiny_with(kTextChunk, payload);
  compress_by_hand(parts.chunks.back(), options);
  return parts.build();
}

void add_valid_frame_cases(CaseList& cases) {
  const Bytes text = text_of(5000);
  for (const unsigned size_bytes : {2u, 4u, 8u}) {
    cases.valid("zstd/size-in-" + to_string(size_bytes), "3.6",
                with_text_frame(text, {.size_bytes = size_bytes}));
    // Windows from 8 KiB on hold all of it.
    for (unsigned exponent = 3; exponent <= 13; exponent += 5) {
      cases.valid("zstd/size-in-" + to_string(size_bytes) + "-window-2-to-" + to_string(10 + exponent), "3.6",
                  with_text_frame(
                      text, {.size_bytes = size_bytes, .single_segment = false, .window = exponent << 3}));
    }
  }
  cases.valid("zstd/size-in-1", "3.6", framed({.size_bytes = 1}));
  for (const unsigned window : {0x1fu, 0x5fu, 0x67u})
    cases.valid("zstd/window-" + to_string(window), "3.6",
                with_text_frame(text, {.single_segment = false, .window = window}));
  // Blocks of zstd are no larger than the window.
  for (unsigned exponent = 0; exponent < 3; ++exponent) {
    cases.valid(
        "zstd/small-window-" + to_string(exponent), "3.6",
        with_text_frame(text, {.single_segment = false, .window = exponent << 3, .largest_block = 1024}));
  }
  cases.valid("zstd/checksum", "3.6", with_text_frame(text, {.checksum = true}));
  cases.valid("zstd/many-blocks", "3.6", with_text_frame(text, {.largest_block = 256}));
  cases.valid("zstd/128-kib-blocks", "3.6", with_text_frame(text_of(300000), {}));
  cases.valid("zstd/an-unused-bit", "3.6", framed({.descriptor_bits = 0x10}));
  // What the library makes: entropy coding and sequences. Other versions of it make other bytes.
  Bytes mixed =
      encode_text({{"prose", [] {
                      std::string prose;
                      for (int i = 0; i < 300; ++i)
                        prose += "cell " + to_string(i * i % 97) + " of tile " + to_string(i % 13) + ", ";
                      return prose;
                    }()}});
  for (const int level : {1, 3, 9, 19}) {
    TestFile parts = tiny_with(kTextChunk, mixed);
    compress(parts.chunks.back(), level);
    cases.valid("zstd/library-level-" + to_string(level), "3.6", parts.build());
  }
  TestFile parts =
      TestFile::of(random_object(31, {.resolution = {16, 12, 10}, .cells = 9, .block = 3, .maps = kMapsOf1_0}));
  for (TestChunk& c : parts.chunks)
    if (c.type != kGridChunk) compress(c, 19);
  cases.valid("zstd/library-all-chunks", "3.6", parts.build());
  for (TestChunk& c : parts.chunks) {
    if (c.codec != 1) continue;
    c.stored = TestFile::take_apart(parts.build()).payload(c.type);
    split(c, 4096, true, 19);
  }
  cases.valid("zstd/library-blocks", "3.6", parts.build());
}

void add_frame_cases(CaseList& cases) {
  const Bytes good = frame(tile());
  for (std::size_t bit = 0; bit < 32; bit += 3) {
    Bytes bad = good;
    put(bad, bit / 8, get(bad, bit / 8, 1) ^ 1u << bit % 8, 1);
    cases.fault("zstd-frame/magic-bit-" + to_string(bit), with_tile_stored(bad));
  }
  for (const std::uint32_t magic :
       {0xFD2FB527u, 0xFD2FB522u, 0xEC30A437u, 0x184D2A50u, 0x184D2204u, 0x28B52FFDu}) {
    Bytes bad = good;
    put(bad, 0, magic);
    cases.fault("zstd-frame/magic-" + to_string(magic), with_tile_stored(bad));
  }
  cases.fault("zstd-frame/magicless", with_tile_stored(Bytes(good.begin() + 4, good.end())));
  cases.fault("zstd-frame/gzip", with_tile_stored(bytes_of("\x1f\x8b\x08...............")));
  cases.fault("zstd-frame/reserved-bit", framed({.descriptor_bits = 0x08}));
  for (const std::size_t id_bytes : {1u, 2u, 4u}) {
    cases.fault("zstd-frame/dictionary-zero-in-" + to_string(id_bytes),
                framed({.dictionary_id = Bytes(id_bytes)}));
    cases.fault("zstd-frame/dictionary-seven-in-" + to_string(id_bytes),
                framed({.dictionary_id = bytes_of("\x07") + Bytes(id_bytes - 1)}));
  }
  // A reader that does not know of dictionaries reads the zeros of the id as the size, and is right.
  for (const std::size_t id_bytes : {1u, 2u, 4u})
    cases.fault("zstd-frame/dictionary-zero-of-256-bytes-in-" + to_string(id_bytes),
                with_text_frame(text_of(256), {.dictionary_id = Bytes(id_bytes)}));
  // One that does not know that the size may be missing reads the block's header for it.
  const Bytes payload = tile();
  Bytes misread =
      bytes_of(std::string_view("\x28\xb5\x2f\xfd\x00\x18\xc0\x00\x00", 9)) + std::span(payload).first(24);
  const Bytes rest = frame(std::span(payload).subspan(24), {.size_bytes = 1});
  cases.fault("zstd-frame/no-content-size-but-a-byte-like-it",
              with_tile_stored(misread + std::span(rest).subspan(6)));
  // Without content size: 0x20 makes it a single segment, and a window follows if it is none.
  Bytes unsized_frame = frame(tile(), {.size_bytes = 1});
  put(unsized_frame, 4, 0, 1);
  put(unsized_frame, 5, 0x18, 1);
  cases.fault("zstd-frame/no-content-size", with_tile_stored(unsized_frame));
  Bytes skippable(8);
  put(skippable, 0, 0x184D2A50);
  Bytes skippable_15 = skippable + Bytes(3);
  put(skippable_15, 0, 0x184D2A5F);
  put(skippable_15, 4, 3);
  cases.fault("zstd-frame/skippable-before", with_tile_stored(skippable + good));
  cases.fault("zstd-frame/skippable-after", with_tile_stored(good + skippable));
  cases.fault("zstd-frame/other-skippable-before", with_tile_stored(skippable_15 + good));
  cases.fault("zstd-frame/other-skippable-after", with_tile_stored(good + skippable_15));
  cases.fault("zstd-frame/skippable-alone", with_tile_stored(skippable));
  cases.fault("zstd-frame/empty-frame-after", with_tile_stored(good + frame({})));
  cases.fault("zstd-frame/second-half-in-a-second-frame", [] {
    const Bytes all = tile();
    const Bytes first = frame(std::span(all).first(128), {.size_bytes = 1, .size = 192});
    return with_tile_stored(first + frame(std::span(all).subspan(128)));
  }());
  for (const std::size_t more : {1u, 3u, 4u, 8u})
    cases.fault("zstd-frame/zeros-after-" + to_string(more), with_tile_stored(good + Bytes(more)));
  cases.fault("zstd-frame/a-line-feed-after", with_tile_stored(good + bytes_of("\n")));

  // Cut at every byte: within the frame's header, and behind it. Nothing at all is no block.
  const std::size_t header = frame_header_bytes(tile());
  for (std::size_t bytes = 1; bytes<good.size(); bytes += bytes> header ? 2 : 1) {
    const std::string id = bytes < header ? "zstd-frame/cut-" : "zstd-data/cut-";
    cases.fault(id + to_string(bytes),
                with_tile_stored(Bytes(good.begin(), good.begin() + std::ptrdiff_t(bytes))));
  }
  const FrameOptions longest = {.size_bytes = 8, .single_segment = false, .window = 0x18, .checksum = true};
  const Bytes checked = frame(tile(), longest);
  for (std::size_t bytes = 5; bytes < frame_header_bytes(tile(), longest); ++bytes)
    cases.fault("zstd-frame/long-header-cut-" + to_string(bytes),
                with_tile_stored(Bytes(checked.begin(), checked.begin() + std::ptrdiff_t(bytes))));
  for (std::size_t less = 1; less <= 4; ++less)
    cases.fault("zstd-data/checksum-cut-by-" + to_string(less),
                with_tile_stored(Bytes(checked.begin(), checked.end() - std::ptrdiff_t(less))));
  for (std::size_t byte = 1; byte <= 4; ++byte)
    cases.fault("zstd-data/checksum-wrong-" + to_string(byte),
                with_tile_stored(damaged(checked, checked.size() - byte, 1u << byte)));
}

void add_window_and_size_cases(CaseList& cases) {
  for (unsigned window = 13 << 3 | 1; window < 256; window += window < 14 << 3 ? 1 : 9)
    cases.fault("zstd-window/descriptor-" + to_string(window),
                with_text_frame(text_of(5000), {.single_segment = false, .window = window}));
  for (const auto& [name, size] : std::array<std::pair<const char*, std::uint64_t>, 6>{
           {{"one-less", 191}, {"one-more", 193}, {"zero", 0}, {"64", 64}, {"128", 128}, {"255", 255}}})
    cases.fault("zstd-size/in-1-" + std::string(name), framed({.size_bytes = 1, .size = size}));
  const Bytes text = text_of(5000);
  for (const unsigned size_bytes : {2u, 4u, 8u}) {
    for (const auto& [name, size] : std::array<std::pair<const char*, std::uint64_t>, 5>{
             {{"one-less", 4999}, {"one-more", 5001}, {"256", 256}, {"65791", 65791}, {"plus-256", 5256}}})
      cases.fault("zstd-size/in-" + to_string(size_bytes) + "-" + name,
                  with_text_frame(text, {.size_bytes = size_bytes, .size = size}));
  }
  for (const unsigned size_bytes : {4u, 8u}) {
    cases.fault("zstd-size/in-" + to_string(size_bytes) + "-zero",
                with_text_frame(text, {.size_bytes = size_bytes, .size = 0}));
    cases.fault("zstd-size/in-" + to_string(size_bytes) + "-plus-65536",
                with_text_frame(text, {.size_bytes = size_bytes, .size = 5000 + 65536}));
    cases.fault(
        "zstd-size/in-" + to_string(size_bytes) + "-all-ones",
        with_text_frame(text, {.size_bytes = size_bytes, .size = size_bytes == 4 ? 0xffffffff : ~0ull}));
  }
  cases.fault("zstd-size/in-8-plus-2-to-32",
              with_text_frame(text, {.size_bytes = 8, .size = 5000 + (1ull << 32)}));
  TestFile decoded = tiny_with(kTextChunk, text);
  compress_by_hand(decoded.chunks.back());
  for (const int more : {-1, 1, 64, -64}) {
    TestFile other = decoded;
    other.chunks.back().decoded_bytes = std::uint64_t(5000 + more);
    cases.fault("zstd-size/directory-says-" + to_string(5000 + more), other.build());
  }
}

void add_data_cases(CaseList& cases) {
  const Bytes good = frame(tile());
  const std::size_t first = frame_header_bytes(tile());  // block header of three bytes
  const auto changed = [&](std::size_t at, std::uint64_t value, unsigned bytes) {
    Bytes bad = good;
    put(bad, at, value, bytes);
    return with_tile_stored(bad);
  };
  const std::uint64_t header = get(good, first, 3);
  cases.fault("zstd-data/block-of-the-reserved-kind", changed(first, header | 6, 3));
  cases.fault("zstd-data/block-of-no-sequences", changed(first, (header & ~6u) | 4, 3));
  cases.fault("zstd-data/block-longer-than-the-frame", changed(first, 0xfff8, 3));
  // Blocks that make more or less than the frame's content size.
  const std::size_t last = good.size() - 4;  // a run of the same id ends the tile, or of zeros
  const std::uint64_t last_header = get(good, last, 3);
  if ((last_header & 7) == 3) {
    cases.fault("zstd-data/one-byte-less", changed(last, last_header - 8, 3));
    cases.fault("zstd-data/one-byte-more", changed(last, last_header + 8, 3));
    cases.fault("zstd-data/128-kib-more", changed(last, (131072u << 3) | 3, 3));
    cases.fault("zstd-data/run-over-128-kib", changed(last, (131073u << 3) | 3, 3));
    cases.fault("zstd-data/run-of-2-mib", changed(last, 0xfffffb, 3));
    cases.fault("zstd-data/last-block-not-marked", changed(last, last_header & ~1u, 3));
  }
  // A last block in the middle leaves the rest of the bytes after the frame.
  cases.fault("zstd-frame/last-block-is-the-first", changed(first, header | 1, 3));
  const Bytes text = text_of(5000);
  // A compressed block of zstd, cut and damaged where entropy tables are.
  TestFile library = tiny_with(kTextChunk, text);
  Bytes made = frame(text);
  Bytes body = bytes_of(std::string_view("\x05\x00\x00", 3));
  const std::size_t text_header = frame_header_bytes(text);
  library.chunks.back().codec = 1;
  library.chunks.back().block_bytes = 8192;
  library.chunks.back().stored = Bytes(made.begin(), made.begin() + std::ptrdiff_t(text_header)) + body;
  cases.fault("zstd-data/compressed-block-of-none", library.build());
  body = bytes_of(std::string_view("\x45\x00\x00\xff\xff\xff\xff\xff\xff\xff\xff", 11));
  library.chunks.back().stored = Bytes(made.begin(), made.begin() + std::ptrdiff_t(text_header)) + body;
  cases.fault("zstd-data/compressed-block-of-ones", library.build());
}

}  // namespace

void add_zstd_cases(CaseList& cases) {
  add_valid_frame_cases(cases);
  add_frame_cases(cases);
  add_window_and_size_cases(cases);
  add_data_cases(cases);
}

}  // namespace mesocell::test
