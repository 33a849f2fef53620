#include <algorithm>
#include <string>

#include "format/cell_object_chunks.h"
#include "format/cell_object_io.h"
#include "format/fourcc.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Small files, and one in which a chunk has several blocks.
std::vector<Bytes> files_to_damage() {
  std::vector<Bytes> files = small_files();
  TestFile parts = TestFile::take_apart(encoded(random_object(10, {.resolution = {16, 16, 17}, .block = 8})));
  split(parts.chunk(kTileChunk), 4096, true, 19);
  files.push_back(parts.build());
  return files;
}

void check_refused(const Bytes& file) {
  const Verdicts v = verdicts(file);
  INFO(v.why);
  if (v.agree && !v.reader) return;  // one assertion a file would be most of the time
  CHECK(v.agree);
  CHECK_FALSE(v.reader);
}

}  // namespace

TEST_CASE("format: every truncation is refused") {
  for (const Bytes& file : files_to_damage()) {
    REQUIRE(verdicts(file).reader);
    for (std::size_t size = 0; size < file.size(); ++size) {
      CAPTURE(size);
      check_refused(Bytes(file.begin(), file.begin() + std::ptrdiff_t(size)));
    }
  }
}

TEST_CASE("format: every flip of a bit is refused") {
  for (const Bytes& file : files_to_damage()) {
    Bytes damaged = file;
    for (std::size_t bit = 0; bit < file.size() * 8; ++bit) {
      CAPTURE(bit);
      damaged[bit / 8] ^= std::byte(1u << bit % 8);
      check_refused(damaged);
      damaged[bit / 8] = file[bit / 8];
    }
  }
}

TEST_CASE("format: bytes after the end are refused") {
  for (const Bytes& file : small_files()) {
    for (const std::size_t extra : {1, 63, 64, 65, 4096}) {
      Bytes longer = file;
      longer.resize(file.size() + extra);
      check_refused(longer);
      put(longer, 16, longer.size(), 8);
      reseal_header(longer);
      check_refused(longer);
    }
  }
}

TEST_CASE("format: a chunk of color or normals may be left out alone") {
  const Bytes whole = small_files()[3];
  for (const std::uint32_t type : {kColorChunk, kCellColorChunk, kInstanceColorChunk, kNormalChunk}) {
    TestFile parts = TestFile::take_apart(whole);
    parts.chunks.erase(parts.chunks.begin() + (&parts.chunk(type) - parts.chunks.data()));
    const Bytes file = parts.build();
    const Verdicts v = verdicts(file);
    CHECK(v.agree);
    REQUIRE(v.reader);
    CellObject expected = *read_cell_object(whole);
    if (type == kColorChunk) expected.color.reset();
    if (type == kCellColorChunk) expected.cell_colors.reset();
    if (type == kInstanceColorChunk) expected.instance_colors.reset();
    if (type == kNormalChunk) expected.normals.reset();
    CHECK(*read_cell_object(file) == expected);
  }
}

TEST_CASE("format: other versions are refused by name") {
  for (const auto& [major, minor] :
       {std::pair{0u, 9u}, {0u, 0u}, {2u, 0u}, {0x0101u, 0u}, {0xffffu, 0xffffu}}) {
    Bytes file = small_files()[0];
    put(file, 8, major, 2);
    put(file, 10, minor, 2);
    check_refused(file);
    CHECK(verdicts(file).reader_id == "header-hash");
    reseal_header(file);
    check_refused(file);
    const auto error = read_cell_object(file).error();
    CHECK(error.id == "version-unsupported");
    CHECK(error.message.find(std::to_string(major) + "." + std::to_string(minor)) != std::string::npos);
  }
}

TEST_CASE("format: unknown critical chunks are refused, unknown skippable ones are ignored") {
  for (const bool compressed : {false, true}) {
    for (std::size_t position = 0; position <= 3; ++position) {
      TestFile parts = TestFile::take_apart(small_files()[1]);
      TestChunk unknown{fourcc("NEWS"), 0, 0, 1000, Bytes(1000, std::byte{3}), 1u << 20};
      if (compressed) compress(unknown);
      parts.chunks.insert(parts.chunks.begin() + std::ptrdiff_t(position), unknown);
      const Verdicts skippable = verdicts(parts.build());
      CHECK(skippable.agree);
      CHECK(skippable.reader);
      CHECK(skippable.issues == std::vector<std::string>{"chunk-unknown-skippable"});

      parts.chunk(fourcc("NEWS")).flags = 1;
      const Verdicts critical = verdicts(parts.build());
      CHECK(critical.agree);
      CHECK(critical.reader_id == "chunk-unknown-critical");

      // What it holds is nobody's business, but its bytes are covered all the same.
      parts.chunk(fourcc("NEWS")).flags = 0;
      Bytes damaged = parts.build();
      const auto at = std::size_t(get(damaged, entry_at(position) + 16, 8));
      damaged[at] ^= std::byte{1};
      check_refused(damaged);
      CHECK(verdicts(damaged).reader_id == "chunk-hash");
    }
  }
}

TEST_CASE("format: chunks may come in any order and in either codec") {
  TestFile parts = TestFile::take_apart(small_files()[1]);
  const CellObject object = *read_cell_object(small_files()[1]);
  std::vector<int> order = {0, 1, 2, 3};
  do {
    for (unsigned codecs = 0; codecs < 16; ++codecs) {
      TestFile shuffled;
      shuffled.representation = parts.representation;
      for (const int i : order) {
        shuffled.chunks.push_back(parts.chunks[std::size_t(i)]);
        // GRID stays raw.
        if ((codecs >> i & 1) != 0 && i > 0) compress(shuffled.chunks.back(), int(codecs) - 7);
      }
      const Bytes file = shuffled.build();
      const Verdicts v = verdicts(file);
      INFO(v.why << v.reader_id);
      CHECK(v.agree);
      REQUIRE(v.reader);
      CHECK(*read_cell_object(file) == object);
    }
  } while (std::next_permutation(order.begin(), order.end()));
}
