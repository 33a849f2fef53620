#include <string>

#include "format/block_table.h"
#include "format/cell_object_chunks.h"
#include "format/cell_object_io.h"
#include "format/hash.h"
#include "format/validate.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Written and read back is the same object, for the reader and the loader; written again is the same file.
void check_round_trip(const CellObject& object) {
  const Bytes file = encoded(object);
  const auto read = read_cell_object(file);
  REQUIRE(read.ok());
  CHECK(*read == object);
  const Verdicts v = verdicts(file);
  INFO(v.why << " " << v.loader_text);
  CHECK(v.agree);
  CHECK(v.loader);
  CHECK(v.issues == (count_instances(object.membership).inside > 0
                         ? std::vector<std::string>{}
                         : std::vector<std::string>{"memb-nothing-inside"}));
  CHECK(encoded(*read) == file);
  CHECK(file.size() % 64 == 0);
}

}  // namespace

TEST_CASE("format: random cell objects survive the round trip") {
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    CAPTURE(seed);
    check_round_trip(random_small_object(seed));
  }
}

TEST_CASE("format: piece ids of one, two and four bytes survive the round trip") {
  RandomObjectOptions options;
  options.resolution = {10, 11, 9};
  options.cells = 700;
  const CellObject two = random_object(1, options);
  CHECK(two.tile.id_bytes == 2);
  check_round_trip(two);

  options.resolution = {64, 40, 40};
  options.cells = 65535;
  options.reach = 63;
  options.tiles = {2, 1, 1};
  const CellObject four = random_object(2, options);
  CHECK(four.tile.id_bytes == 4);
  CHECK(four.tile.cell_count > 50000);
  check_round_trip(four);
}

TEST_CASE("format: a whole grid of one membership is one run") {
  CellObject object = walkthrough_object();
  object.grid.tiles = object.membership.tiles = {300, 200, 100};
  object.membership.entries.assign(6000000, 1);
  object.membership.blocks.clear();
  check_round_trip(object);
  // Two bits a tile before zstd; a block of 64 KiB of them is some 20 bytes after it.
  CHECK(encoded(object).size() <= 2000);
  CHECK(count_instances(object.membership) == InstanceCounts{12000000, 0, 0});
}

TEST_CASE("format: instances are counted as they are tagged") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const MembershipMap m = random_small_object(seed).membership;
    InstanceCounts expected;
    for (std::uint64_t t = 0; t < m.entries.size(); ++t) {
      for (std::uint32_t c = 1; c <= m.cell_count; ++c) {
        const Tag tag = m.tag(t, c);
        ++(tag == Tag::kInside    ? expected.inside
           : tag == Tag::kOutside ? expected.outside
                                  : expected.intersected);
      }
    }
    CHECK(count_instances(m) == expected);
  }
}

TEST_CASE("format: the same object gives the same bytes, and the bytes of a small file are frozen") {
  const Bytes file = encoded(walkthrough_object());
  CHECK(file == encoded(walkthrough_object()));
  REQUIRE(file.size() == 960);
  // Changes of this hash are changes of the format. All chunks are raw, so it does not hang on zstd.
  CHECK(hash64(file) == 0xc01e3662cf4611e3);
}

TEST_CASE("format: maps of color and normals survive the round trip, each alone and all together") {
  for (unsigned maps = 0; maps <= kAllMaps; ++maps) {
    RandomObjectOptions options;
    options.resolution = {9, 8, 7};
    options.maps = maps;
    const CellObject object = random_object(100 + maps, options);
    CHECK(object.color.has_value() == ((maps & kColorMap) != 0));
    CHECK(object.normals.has_value() == ((maps & kNormals) != 0));
    CHECK(object.cell_colors.has_value() == ((maps & kCellColors) != 0));
    CHECK(object.instance_colors.has_value() == ((maps & kInstanceColors) != 0));
    CHECK(object.surface_colors.has_value() == ((maps & kSurfaceColors) != 0));
    check_round_trip(object);
  }
}

TEST_CASE("format: a basic mesh makes a file one of 1.1, and is left out of one of 1.0") {
  for (const std::size_t bytes : {0u, 1u, 100'000u}) {
    CellObject object = random_object(7);
    CHECK(get(encoded(object), 10, 2) == 0);
    const Bytes without = encoded(object);
    BasicMesh& mesh = object.basic_mesh.emplace();
    mesh = {Bytes(bytes), 3, 1, 0.25f};
    Rng rng(bytes);
    for (std::byte& b : mesh.draco) b = std::byte(rng.bits(8));
    check_round_trip(object);
    CHECK(get(encoded(object), 10, 2) == 1);
    WriteOptions options;
    options.version.minor = 0;
    const auto older = encode_cell_object(object, options);
    REQUIRE(older.ok());
    CHECK(*older == without);
    options.version.minor = 2;
    CHECK(encode_cell_object(object, options).error().code == ErrorCode::kUsage);
  }
}

TEST_CASE("format: instances of one color cost next to nothing") {
  CellObject object = walkthrough_object();
  object.grid.tiles = object.membership.tiles = {100, 100, 50};
  object.membership.entries.assign(500000, 1);
  object.membership.blocks.clear();
  const std::size_t without = encoded(object).size();
  object.instance_colors.emplace().colors.assign(1000000, {200, 100, 50});
  check_round_trip(object);
  CHECK(encoded(object).size() <= without + 64 + 512);
}

TEST_CASE("format: the bytes of a small file with all maps are frozen") {
  CellObject object = walkthrough_object();
  object.color = ColorMap{{1, 2, 1}, {{10, 20, 30}, {40, 50, 60}}, 0.5f};
  object.cell_colors = ColorList{{{1, 2, 3}, {4, 5, 6}}, 0};
  object.instance_colors = ColorList{{{7, 8, 9}, {10, 11, 12}, {13, 14, 15}}, 1.5f};
  object.normals.emplace().normals.assign(24, {127, 0});
  check_round_trip(object);
  // As above; no chunk is large enough to be compressed.
  CHECK(hash64(encoded(object)) == 0x120c10c840390ddc);
}

TEST_CASE("format: a writer refuses what the format cannot hold") {
  CellObject object = walkthrough_object();
  object.metadata = {{"b", "1"}, {"a", "2"}};
  CHECK(encode_cell_object(object).error().code == ErrorCode::kUsage);
  object.metadata = {{"", "1"}};
  CHECK(encode_cell_object(object).error().id == "text-key");
  object.metadata = {{"k", "\xff"}};
  CHECK(encode_cell_object(object).error().id == "text-utf8");
  object.metadata.clear();
  object.grid.tiles = object.membership.tiles = {1u << 29, 1, 1};
  CHECK(encode_cell_object(object).error().code == ErrorCode::kLimit);
  object.grid.tiles = {1u << 20, 1u << 11, 1};
  CHECK(encode_cell_object(object).error().id == "grid-tiles");
}

TEST_CASE("format: container chunks come back, and the writer compresses where it pays") {
  const Bytes plain(100, std::byte{7});
  const Bytes long_run(100000, std::byte{7});
  ContainerWriter writer;
  writer.begin_asset(fourcc("CELL"), "stone");
  writer.add_chunk(fourcc("LONG"), ContainerWriter::Importance::kSkippable, long_run);
  writer.add_chunk(fourcc("TINY"), ContainerWriter::Importance::kSkippable, plain);
  writer.add_chunk(fourcc("NONE"), ContainerWriter::Importance::kSkippable, {});
  for (const auto& part : TestFile::take_apart(encoded(walkthrough_object())).chunks)
    writer.add_chunk(
        part.type,
        part.flags != 0 ? ContainerWriter::Importance::kCritical : ContainerWriter::Importance::kSkippable,
        part.stored);
  const auto file = writer.finish();
  REQUIRE(file.ok());
  const auto container = Container::open(*file);
  REQUIRE(container.ok());
  CHECK(container->verify(0).ok());
  CHECK(container->chunks()[0].codec == kCodecZstd);
  CHECK(container->chunks()[0].stored_bytes < 100);
  CHECK(container->chunks()[1].codec == kCodecRaw);
  CHECK(*container->read_chunk(0, fourcc("LONG")) == long_run);
  CHECK(*container->read_chunk(0, fourcc("TINY")) == plain);
  CHECK(container->read_chunk(0, fourcc("NONE"))->empty());
  CHECK(container->read_chunk(0, fourcc("GONE")).error().id == "chunk-missing");
  CHECK(verdicts(*file).agree);
  CHECK(verdicts(*file).reader);
}

TEST_CASE("format: several assets in a file come back, each by itself") {
  std::vector<CellObject> objects;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) objects.push_back(random_small_object(seed));
  std::vector<NamedCellObject> named;
  for (std::size_t i = 0; i < objects.size(); ++i)
    named.push_back({&objects[i], i == 2 ? "" : "n\u00e4me " + std::to_string(i)});
  const auto file = encode_cell_objects(named);
  REQUIRE(file.ok());
  const Verdicts v = verdicts(*file);
  INFO(v.why);
  CHECK(v.agree);
  REQUIRE(v.reader);
  CHECK(v.has("asset-name-missing"));
  const auto container = Container::open(*file);
  REQUIRE(container.ok());
  REQUIRE(container->assets().size() == objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    CHECK(container->assets()[i].name == named[i].name);
    CHECK(*read_cell_object(*file, {}, i) == objects[i]);
  }
  CHECK(read_cell_object(*file, {}, 5).error().code == ErrorCode::kUsage);

  // Damage in one asset is none of the others' business.
  Bytes damaged = *file;
  damaged[std::size_t(container->chunks_of(3)[1].offset)] ^= std::byte{1};
  for (std::size_t i = 0; i < objects.size(); ++i) CHECK(read_cell_object(damaged, {}, i).ok() == (i != 3));
  CHECK_FALSE(verdicts(damaged).validator);

  named[4].name = named[3].name;
  CHECK(encode_cell_objects(named).error().id == "asset-name-duplicate");
  named[4].name = std::string(41, 'x');
  CHECK(encode_cell_objects(named).error().id == "asset-name");
  named[4].name = std::string(40, 'x');
  CHECK(encode_cell_objects(named).ok());
  named[4].name = "\xff";
  CHECK(encode_cell_objects(named).error().id == "asset-name");
}

TEST_CASE("format: what is not compressed can be used in place") {
  const CellObject object =
      random_object(3, {.resolution = {20, 30, 40}, .tiles = {9, 9, 9}, .maps = kAllMaps});
  WriteOptions options;
  options.compress = false;
  const auto file = encode_cell_object(object, options);
  REQUIRE(file.ok());
  CHECK(verdicts(*file).reader);
  CHECK(*read_cell_object(*file) == object);
  const auto container = Container::open(*file);
  for (const ChunkInfo& chunk : container->chunks()) {
    CHECK(chunk.codec == kCodecRaw);
    CHECK(chunk.offset % 64 == 0);
    CHECK(block_data_at(chunk) % 64 == 0);
  }
  CHECK(encode_cell_object(object, {.version = {1, 2}}).error().code == ErrorCode::kUsage);
  CHECK(encode_cell_object(object, {.version = {2, 0}}).error().code == ErrorCode::kUsage);
}
