#include <zstd.h>

#include <string>

#include "format/byte_reader.h"
#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"
#include "format/fourcc.h"
#include "format/hash.h"
#include "format/limits.h"
#include "format/representation.h"
#include "format/utf8.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

TEST_CASE("format: four-character codes") {
  CHECK(fourcc("GRID") == 0x44495247);
  CHECK(fourcc_text(fourcc("GRID")) == "GRID");
  CHECK(fourcc_text(0xff0a5c41) == "A\\x5c\\x0a\\xff");
}

TEST_CASE("format: the byte reader never leaves its bytes") {
  const Bytes bytes = {std::byte{1}, std::byte{2}, std::byte{3}};
  ByteReader in(bytes);
  CHECK(in.u16() == 0x0201);
  CHECK(in.u32() == 0);
  CHECK(in.overrun());
  CHECK(in.position() == 2);
  CHECK(in.u8() == 3);
  CHECK(in.overrun());
  CHECK(in.take(1).empty());
  CHECK(in.take(~std::size_t{0}).empty());
}

TEST_CASE("format: numbers are written little-endian and read back") {
  ByteWriter out;
  out.u16(0x1234);
  out.u32(0x56789abc);
  out.u64(0x0102030405060708);
  out.f64(-0.1);
  out.pad_to(64);
  CHECK(out.size() == 64);
  CHECK(std::to_integer<int>(out.bytes()[0]) == 0x34);
  CHECK(std::to_integer<int>(out.bytes()[2]) == 0xbc);
  ByteReader in(out.bytes());
  CHECK(in.u16() == 0x1234);
  CHECK(in.u32() == 0x56789abc);
  CHECK(in.u64() == 0x0102030405060708);
  CHECK(in.f64() == -0.1);
}

TEST_CASE("format: XXH64 has its published values") {
  // [xxHash's specification: empty input and "abc"-like vectors with seed 0]
  CHECK(hash64({}) == 0xEF46DB3751D8E999);
  CHECK(hash64(std::as_bytes(std::span("abc", 3))) == 0x44BC2CF5AD770999);
}

TEST_CASE("format: the loader's hash equals the library's for every length") {
  // The loader's hash is private: a skippable chunk of every length makes it visible.
  Rng rng(4);
  for (std::size_t size = 0; size < 200; ++size) {
    TestFile parts = TestFile::take_apart(small_files()[0]);
    Bytes bytes(size);
    for (std::byte& b : bytes) b = std::byte(rng.below(256));
    parts.chunks.push_back({fourcc("HASH"), 0, 0, size, bytes, 1u << 20});
    const Verdicts v = verdicts(parts.build());
    CHECK(v.agree);
    CHECK(v.loader);
  }
}

TEST_CASE("format: UTF-8 is told from what is not") {
  for (const char* good : {"", "a", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80",
                           "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf", "\xe2\x82\xac!"})
    CHECK(is_utf8(good));
  for (const char* bad : {"\x80", "\xbf", "\xc0\x80", "\xc1\xbf", "\xc2", "\xc2\x41", "\xe0\x9f\xbf",
                          "\xe2\x82", "\xed\xa0\x80", "\xed\xbf\xbf", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80",
                          "\xf5\x80\x80\x80", "\xf8\x88\x80\x80\x80", "\xff", "a\xe2\x82"})
    CHECK_FALSE(is_utf8(bad));
  CHECK(is_utf8(std::string_view("a\0b", 3)));
}

TEST_CASE("format: every sequence of up to three bytes is UTF-8 to reader and loader alike") {
  // All lead bytes with edges of the ranges of what follows.
  const unsigned edges[] = {0x00, 0x41, 0x7f, 0x80, 0x8f, 0x90, 0x9f, 0xa0, 0xbf, 0xc0, 0xff};
  for (unsigned lead = 0x80; lead < 0x100; ++lead) {
    for (const unsigned second : edges) {
      std::string value = {char(lead), char(second), char(0x80), char(0xbf)};
      for (std::size_t size = 1; size <= 4; ++size) {
        TestFile parts = TestFile::take_apart(small_files()[0]);
        parts.set_payload(kTextChunk, encode_text({{"k", value.substr(0, size)}}));
        const Verdicts v = verdicts(parts.build());
        if (v.agree && v.reader == is_utf8(value.substr(0, size))) continue;
        CAPTURE(lead, second, size, v.why);
        CHECK(v.agree);
        CHECK(v.reader == is_utf8(value.substr(0, size)));
      }
    }
  }
}

TEST_CASE("format: a memory budget does not overflow") {
  MemoryBudget budget(ReadLimits{0, 100, 0});
  CHECK_FALSE(budget.charge(~std::uint64_t{0}, ~std::uint64_t{0}));
  CHECK_FALSE(budget.charge(2, std::uint64_t{1} << 63));
  CHECK(budget.charge(0, ~std::uint64_t{0}));
  CHECK(budget.charge(10, 10));
  CHECK_FALSE(budget.charge(1));
}

TEST_CASE("format: all kinds of zstd frame that the format allows are read") {
  const TestFile original = TestFile::take_apart(small_files()[2]);
  for (const int level : {-5, 1, 3, 9, 19, 22}) {
    for (const int checksum : {0, 1}) {
      TestFile parts = original;
      TestChunk& tile = parts.chunk(kTileChunk);
      ZSTD_CCtx* context = ZSTD_createCCtx();
      ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, level);
      ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, checksum);
      Bytes frame(ZSTD_compressBound(tile.stored.size()));
      frame.resize(
          ZSTD_compress2(context, frame.data(), frame.size(), tile.stored.data(), tile.stored.size()));
      ZSTD_freeCCtx(context);
      tile.codec = 1;
      tile.stored = frame;
      const Verdicts v = verdicts(parts.build());
      CHECK(v.agree);
      CHECK(v.reader);
    }
  }
  // A frame without content size, as a streaming compressor makes it, is not allowed.
  TestFile parts = original;
  TestChunk& tile = parts.chunk(kTileChunk);
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, 0);
  Bytes frame(ZSTD_compressBound(tile.stored.size()));
  frame.resize(ZSTD_compress2(context, frame.data(), frame.size(), tile.stored.data(), tile.stored.size()));
  ZSTD_freeCCtx(context);
  tile.codec = 1;
  tile.stored = frame;
  const Verdicts v = verdicts(parts.build());
  CHECK(v.agree);
  CHECK(v.reader_id == "zstd-frame");
}

TEST_CASE("format: representations are found by code") {
  REQUIRE(find_representation(fourcc("CELL")));
  CHECK(find_representation(fourcc("CELL"))->name == "cell-object");
  CHECK(find_representation(0) == nullptr);
  for (const Representation& r : representations()) {
    CHECK(find_representation(r.code) == &r);
    for (const ChunkRule& rule : r.chunks) CHECK((!rule.required || rule.critical));
  }
}
