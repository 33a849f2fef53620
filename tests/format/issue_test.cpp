#include <bit>
#include <set>
#include <string>

#include "format/cell_object_chunks.h"
#include "format/cell_object_io.h"
#include "format/issues.h"
#include "format/validate.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// The file of spec section 7, taken apart: GRID, TILE, MEMB, TEXT, all raw.
TestFile small() { return TestFile::take_apart(encoded(walkthrough_object())); }

/// Places in the small file.
constexpr std::size_t kTileAt = 448, kLastPadding = 959;
constexpr std::size_t kPieces = 64, kIds = 128;  // in TILE

/// The small file with a byte of TILE replaced.
Bytes with_tile_byte(std::size_t at, std::uint64_t value) {
  TestFile parts = small();
  Bytes bytes = parts.payload(kTileChunk);
  put(bytes, at, value, 1);
  parts.set_payload(kTileChunk, bytes);
  return parts.build();
}

}  // namespace

TEST_CASE("format: the issues of the catalogue have unique names, texts and clauses") {
  std::set<std::string_view> ids, texts;
  for (const IssueInfo& info : issue_catalogue()) {
    CHECK(ids.insert(info.id).second);
    CHECK(texts.insert(info.text).second);
    CHECK_FALSE(info.clause.empty());
    CHECK((info.severity == Severity::kError) == !remedy_text(info.remedy).empty());
  }
}

TEST_CASE("format: the validator goes on after a fault and reports what it can reach") {
  TestFile parts = small();
  Bytes grid = parts.payload(kGridChunk), tile = parts.payload(kTileChunk),
        memb = parts.payload(kMembershipChunk);
  put(grid, 24, std::bit_cast<std::uint64_t>(-1.0), 8);
  put(grid, 63, 1, 1);
  put(tile, kPieces + 7, 1, 1);
  put(tile, kIds, 9, 1);
  put(memb, 0, 7, 4);
  parts.set_payload(kGridChunk, grid);
  parts.set_payload(kTileChunk, tile);
  parts.set_payload(kMembershipChunk, memb);
  parts.set_payload(kTextChunk, encode_text({{"b", "\xff"}, {"a", ""}}));
  Bytes file = parts.build();
  put(file, 28, 1, 4);
  put(file, entry_at(1) + 48, 1, 1);
  file.back() = std::byte{1};
  reseal_directory(file);
  const Verdicts v = verdicts(file);
  CHECK(v.agree);
  for (const char* id :
       {"header-flags", "chunk-reserved", "padding-nonzero", "grid-voxel-edge", "payload-reserved",
        "piece-reserved", "voxel-id", "memb-rule", "text-utf8", "text-order"}) {
    CAPTURE(id);
    CHECK(v.has(id));
  }
}

TEST_CASE("format: an issue says where it is") {
  const auto first = [](const Bytes& file) { return validate(file).issues.at(0); };
  Bytes damaged = small().build();
  damaged.at(kLastPadding) ^= std::byte{1};
  CHECK(first(damaged).offset == kLastPadding);
  CHECK(first(damaged).chunk == kTextChunk);
  const Issue piece = first(with_tile_byte(kPieces + 7, 1));
  CHECK(piece.offset == kTileAt + kPieces + 7);
  CHECK(piece.chunk == kTileChunk);

  // A byte of a compressed chunk has no offset of its own: the chunk's is given, and the text says the rest.
  TestFile parts = small();
  Bytes tile = parts.payload(kTileChunk);
  put(tile, kPieces + 7, 1, 1);
  parts.set_payload(kTileChunk, tile);
  compress(parts.chunk(kTileChunk));
  const Issue compressed = first(parts.build());
  CHECK(compressed.offset == kTileAt);
  CHECK(compressed.text.find("at byte 71") != std::string::npos);

  // A byte of a raw chunk of several blocks comes after the table.
  TestFile blocks = TestFile::take_apart(encoded(random_object(1, {.resolution = {32, 32, 32}})));
  Bytes payload = blocks.payload(kTileChunk);
  put(payload, kPieces + 7, 1, 1);
  blocks.set_payload(kTileChunk, payload);
  split(blocks.chunk(kTileChunk), 4096, false);
  const Bytes file = blocks.build();
  const Issue later = first(file);
  CHECK(later.id == "piece-reserved");
  CHECK(std::to_integer<int>(file.at(std::size_t(*later.offset))) == 1);
}

TEST_CASE("format: a file of a thousand faults gets a short report") {
  TestFile parts = small();
  Bytes memb(64 + 1088 + 64 + 4096);
  put(memb, 4, 2, 4);
  put(memb, 32, 4096, 4);
  for (std::size_t i = 0; i < 1024; ++i) put(memb, 64 + i, 0xff, 1);
  put(memb, 64 + 1088 + 4, 4096, 4);
  parts.set_payload(kMembershipChunk, memb);
  Bytes grid = parts.payload(kGridChunk);
  put(grid, 32, 4097, 4);
  parts.set_payload(kGridChunk, grid);
  for (int i = 0; i < 600; ++i) parts.chunks.push_back({fourcc("AAAA") + std::uint32_t(i), 1, 9, 0, {}, 0});
  const Bytes file = parts.build();
  const ValidationReport report = validate(file);
  CHECK_FALSE(report.valid);
  CHECK(report.capped);
  CHECK(report.errors > 1000);
  CHECK(report.issues.size() <= 16 * 6);
  const ValidationReport one = validate(file, {}, 1);
  CHECK(one.issues.size() == 1);
  CHECK(one.capped);
  CHECK_FALSE(one.valid);
}
