#include "format/tag_reader.h"

#include <cstdlib>
#include <string>

#include "format/cell_object_chunks.h"
#include "format/cell_object_io.h"
#include "format/file.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"
#include "tests/support/folder.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Whether the reader gives the object's tags in `count` random tiles, and where it gives none whether it
/// says why.
bool gives_tags(TagReader& reader, const CellObject& object, int count, std::uint64_t seed,
                bool may_fail = false) {
  Rng rng(seed);
  for (int i = 0; i < count; ++i) {
    Index3 tile{};
    for (std::size_t a = 0; a < 3; ++a) tile[a] = rng.below(object.grid.tiles[a]);
    const auto tags = reader.tags(tile);
    if (!tags) {
      if (!may_fail || tags.error().message.empty()) return false;
      continue;
    }
    const std::uint64_t index = object.grid.tile_index(tile[0], tile[1], tile[2]);
    for (std::uint32_t c = 1; c <= object.tile.cell_count; ++c)
      if ((*tags)[c - 1] != object.membership.tag(index, c)) return false;
  }
  return true;
}

/// A ball of 256 tiles with 64 cells, whose mixed tiles have random tags: more than any real object has.
CellObject large_ball() {
  Rng rng(1);
  CellObject object = random_object(2, {.resolution = {8, 8, 8}, .cells = 64, .reach = 0});
  const std::uint32_t n = 256;
  object.grid.tiles = object.membership.tiles = {n, n, n};
  MembershipMap& m = object.membership;
  m.entries.clear();
  m.blocks.clear();
  std::uint32_t mixed = 0;
  for (std::uint32_t z = 0; z < n; ++z)
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t x = 0; x < n; ++x) {
        const auto d = [&](std::uint32_t v) { return (int(v) - 128) * (int(v) - 128); };
        const int r2 = d(x) + d(y) + d(z);
        const bool shell = r2 > 108 * 108 && r2 < 110 * 110;
        m.entries.push_back(shell ? MembershipMap::kFirstBlock + mixed++ : r2 <= 108 * 108 ? 1u : 0u);
        if (!shell) continue;
        const std::size_t at = m.blocks.size();
        m.blocks.resize(at + m.block_bytes());
        for (std::uint32_t c = 0; c < m.cell_count; ++c)
          m.blocks[at + c / 4] |= std::uint8_t((c == 0 ? 0u : c == 1 ? 1u : rng.below(3)) << (2 * (c % 4)));
      }
  return object;
}

}  // namespace

TEST_CASE("format: tags are read tile by tile, whatever the codec and the size of blocks") {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    CAPTURE(seed);
    const CellObject object =
        seed % 10 == 0 ? random_object(seed, {.tiles = {40, 41, 42}, .cells = 9}) : random_small_object(seed);
    TestFile parts = TestFile::take_apart(encoded(object));
    if (seed % 3 == 1) split(parts.chunk(kMembershipChunk), 4096, true);
    if (seed % 3 == 2) split(parts.chunk(kMembershipChunk), 4096, false);
    const Bytes file = parts.build();
    REQUIRE(verdicts(file).reader);
    SpanSource source(file);
    auto reader = TagReader::open(source);
    REQUIRE(reader.ok());
    CHECK(reader->grid() == object.grid);
    CHECK(reader->cell_count() == object.tile.cell_count);
    CHECK(gives_tags(*reader, object, 200, seed));
  }
}

TEST_CASE("format: a damaged file gives right tags or none, tile by tile") {
  const CellObject object = random_object(5, {.tiles = {30, 31, 32}, .cells = 7, .longest_run = 3});
  TestFile parts = TestFile::take_apart(encoded(object));
  split(parts.chunk(kMembershipChunk), 4096, true);
  const Bytes file = parts.build();
  Rng rng(7);
  int opened = 0;
  for (int i = 0; i < 3000; ++i) {
    Bytes damaged = file;
    damaged[rng.below(std::uint32_t(file.size()))] ^= std::byte(1u << rng.below(8));
    SpanSource source(damaged);
    auto reader = TagReader::open(source);
    if (!reader) continue;
    ++opened;
    CHECK(gives_tags(*reader, object, 20, std::uint64_t(i), true));
  }
  CHECK(opened > 1000);
}

TEST_CASE("format: tags of a truncated or hostile file are refused") {
  TestFile parts = TestFile::take_apart(encoded(walkthrough_object()));
  const Bytes file = parts.build();
  for (std::size_t size = 0; size < file.size(); ++size) {
    const Bytes part(file.begin(), file.begin() + std::ptrdiff_t(size));
    SpanSource source(part);
    CHECK_FALSE(TagReader::open(source).ok());
  }
  // Numbers that nothing but the reader of tags looks at.
  for (const auto& [at, value] :
       {std::pair{std::size_t{32}, std::uint64_t{0xffffffff}}, {4, 0}, {4, 65536}, {32, 0}}) {
    Bytes memb = parts.payload(kMembershipChunk);
    put(memb, at, value, 4);
    TestFile changed = parts;
    changed.set_payload(kMembershipChunk, memb);
    const Bytes bytes = changed.build();
    SpanSource source(bytes);
    CHECK_FALSE(TagReader::open(source).ok());
  }
  for (const std::uint32_t rank : {1u, 0xffffffffu}) {
    Bytes memb = parts.payload(kMembershipChunk);
    put(memb, 128, rank, 4);
    TestFile changed = parts;
    changed.set_payload(kMembershipChunk, memb);
    const Bytes bytes = changed.build();
    SpanSource source(bytes);
    auto reader = TagReader::open(source);
    REQUIRE(reader.ok());
    CHECK(reader->tags({0, 0, 0}).ok());
    CHECK(reader->tags({1, 0, 0}).error().id == "memb-rank");
  }
  SpanSource source(file);
  CHECK(TagReader::open(source, 1).error().code == ErrorCode::kUsage);
}

TEST_CASE("format: the tags of a tile of 256 tiles are read from less than 64 KiB of the file") {
  const CellObject object = large_ball();
  const Folder folder;
  for (const bool compress : {true, false}) {
    const auto bytes = encode_cell_object(object, {.version = {}, .compress = compress});
    REQUIRE(bytes.ok());
    REQUIRE(write_file(folder / "ball.meso", *bytes).ok());
    std::uint64_t most = 0;
    Rng rng(11);
    for (int i = 0; i < 50; ++i) {
      auto source = FileSource::open(folder / "ball.meso");
      REQUIRE(source.ok());
      auto reader = TagReader::open(*source);
      REQUIRE(reader.ok());
      // Half of them mixed tiles, which take most.
      Index3 tile = {rng.below(256), rng.below(256), rng.below(256)};
      if (i % 2 == 0)
        while (object.membership.entries[std::size_t(object.grid.tile_index(tile[0], tile[1], tile[2]))] < 3)
          tile = {rng.below(256), rng.below(256), rng.below(256)};
      const auto tags = reader->tags(tile);
      REQUIRE(tags.ok());
      const std::uint64_t index = object.grid.tile_index(tile[0], tile[1], tile[2]);
      for (std::uint32_t c = 1; c <= object.tile.cell_count; ++c)
        REQUIRE((*tags)[c - 1] == object.membership.tag(index, c));
      most = std::max(most, source->bytes_read());
    }
    CAPTURE(compress, bytes->size(), most);
    CHECK(most < 65536);
    if (std::getenv("MESOCELL_TEST_PRINT"))
      WARN((compress ? "zstd: " : "raw: ") << most << " bytes of " << bytes->size());
  }
}
