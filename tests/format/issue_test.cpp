#include <bit>
#include <functional>
#include <limits>
#include <map>
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

using Make = std::function<Bytes()>;

/// The file of spec section 7, taken apart: GRID, TILE, MEMB, TEXT, all raw.
TestFile small() { return TestFile::take_apart(encoded(walkthrough_object())); }

/// Places in the small file.
constexpr std::size_t kEntry = 64;  // of GRID; the others follow every 64 bytes
constexpr std::size_t kTileEntry = 128, kTextEntry = 256;
constexpr std::size_t kPieces = 24, kIds = 48;  // in TILE
constexpr std::size_t kRuns = 40;               // in MEMB

/// The small file with a number of a payload replaced.
Make payload(std::uint32_t type, std::size_t at, std::uint64_t value, unsigned count) {
  return [=] {
    TestFile parts = small();
    Bytes bytes = parts.payload(type);
    put(bytes, at, value, count);
    parts.set_payload(type, bytes);
    return parts.build();
  };
}

/// A file with all maps; its parts raw.
TestFile with_maps() { return TestFile::take_apart(small_files()[3]); }

/// That file with a number of a payload replaced.
Make map_payload(std::uint32_t type, std::size_t at, std::uint64_t value, unsigned count) {
  return [=] {
    TestFile parts = with_maps();
    Bytes bytes = parts.payload(type);
    put(bytes, at, value, count);
    parts.set_payload(type, bytes);
    return parts.build();
  };
}

Make resized(std::uint32_t type, int by) {
  return [=] {
    TestFile parts = with_maps();
    Bytes bytes = parts.payload(type);
    bytes.resize(std::size_t(int(bytes.size()) + by));
    parts.set_payload(type, bytes);
    return parts.build();
  };
}

/// The small file with a number of header or directory replaced, hashes right.
Make patched(std::size_t at, std::uint64_t value, unsigned count) {
  return [=] {
    Bytes file = small().build();
    put(file, at, value, count);
    reseal_directory(file);
    return file;
  };
}

/// The same, hashes left as they were.
Make damaged(std::size_t at) {
  return [=] {
    Bytes file = small().build();
    file.at(at) ^= std::byte{1};
    return file;
  };
}

/// The small file with its TILE chunk as this zstd frame.
Make framed(const std::function<Bytes(const Bytes& payload)>& frame, std::uint64_t decoded_more = 0) {
  return [=] {
    TestFile parts = small();
    TestChunk& tile = parts.chunk(kTileChunk);
    tile.codec = 1;
    tile.decoded_bytes = tile.stored.size() + decoded_more;
    tile.stored = frame(tile.stored);
    return parts.build();
  };
}

/// A frame with a raw block, by hand: not single-segment, window descriptor, content size in four bytes.
Bytes frame_with_window(const Bytes& content, unsigned window_descriptor) {
  Bytes frame(6 + 4 + 3);
  put(frame, 0, 0xFD2FB528, 4);
  put(frame, 4, 0x80, 1);
  put(frame, 5, window_descriptor, 1);
  put(frame, 6, content.size(), 4);
  put(frame, 10, content.size() << 3 | 1, 3);
  frame.insert(frame.end(), content.begin(), content.end());
  return frame;
}

Make text(std::vector<std::pair<std::string, std::string>> entries) {
  return [=] {
    TestFile parts = small();
    parts.set_payload(kTextChunk, encode_text(entries));
    return parts.build();
  };
}

/// A grid of more tiles in one mixed run, with these tags a tile.
Make mixed_tags(std::uint8_t tags) {
  return [=] {
    TestFile parts = small();
    Bytes memb = parts.payload(kMembershipChunk);
    put(memb, kRuns + 8, tags, 1);
    parts.set_payload(kMembershipChunk, memb);
    return parts.build();
  };
}

std::uint64_t bits(double v) { return std::bit_cast<std::uint64_t>(v); }

const std::multimap<std::string, Make>& cases() {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  static const std::multimap<std::string, Make> all = {
      {"header-truncated", [] { return Bytes(); }},
      {"header-truncated", [] { Bytes f = small().build(); f.resize(63); return f; }},
      {"header-magic", damaged(0)},
      {"header-magic", damaged(7)},
      {"header-magic", [] { return Bytes(1000, std::byte{'x'}); }},
      {"header-hash", damaged(56)},
      {"header-hash", damaged(33)},
      {"version-unsupported", patched(8, 1, 2)},
      {"version-unsupported", patched(10, 10, 2)},
      {"representation-unknown", patched(12, fourcc("SHEL"), 4)},
      {"header-flags", patched(28, 0x80000000, 4)},
      {"header-reserved", patched(55, 1, 1)},
      {"file-size", patched(16, 704, 8)},
      {"file-size", patched(16, 0, 8)},
      {"chunk-count", patched(24, 0, 4)},
      {"chunk-count", patched(24, 1025, 4)},
      {"directory-truncated", patched(24, 1000, 4)},
      {"directory-hash", [] { Bytes f = small().build(); put(f, 32, 1, 8); reseal_header(f); return f; }},
      {"chunk-flags", patched(kEntry + 4, 3, 4)},
      {"chunk-codec", patched(kEntry + 8, 2, 4)},
      {"chunk-reserved", patched(kEntry + 12, 1, 4)},
      {"chunk-reserved", patched(kEntry + 63, 1, 1)},
      {"chunk-offset", patched(kTileEntry + 16, 320, 8)},
      {"chunk-offset", patched(kEntry + 16, 321, 8)},
      {"chunk-bounds", patched(kTextEntry + 24, 1000, 8)},
      {"chunk-bounds", patched(kTextEntry + 16, ~std::uint64_t{0}, 8)},
      {"chunk-bounds", [] { Bytes f = small().build(); f.resize(f.size() - 8); put(f, 16, f.size(), 8); reseal_header(f); return f; }},
      {"chunk-raw-size", patched(kTileEntry + 32, 113, 8)},
      {"chunk-ratio", [] { Bytes f = framed([](const Bytes& b) { return zstd_frame(b); })(); put(f, kTileEntry + 32, 1u << 30, 8); reseal_directory(f); return f; }},
      {"chunk-duplicate", [] { TestFile p = small(); p.chunks.push_back(p.chunks[3]); return p.build(); }},
      {"chunk-criticality", patched(kEntry + 4, 0, 4)},
      {"chunk-criticality", patched(kTextEntry + 4, 1, 4)},
      {"chunk-criticality", [] { TestFile p = with_maps(); p.chunk(kColorChunk).flags = 1; return p.build(); }},
      {"chunk-criticality", [] { TestFile p = with_maps(); p.chunk(kNormalChunk).flags = 1; return p.build(); }},
      {"chunk-unknown-critical", [] { TestFile p = small(); p.chunks.push_back({fourcc("WHAT"), 1, 0, 0, {}}); return p.build(); }},
      {"chunk-unknown-skippable", [] { TestFile p = small(); p.chunks.push_back({fourcc("WHAT"), 0, 0, 0, {}}); return p.build(); }},
      {"chunk-missing", [] { TestFile p = small(); p.chunks.erase(p.chunks.begin() + 1); return p.build(); }},
      {"file-trailing", [] { Bytes f = small().build(); f.resize(f.size() + 64); put(f, 16, f.size(), 8); reseal_header(f); return f; }},
      {"padding-nonzero", damaged(639)},
      {"chunk-hash", damaged(320)},
      {"zstd-frame", framed([](const Bytes&) { return Bytes(); })},
      {"zstd-frame", framed([](const Bytes& b) { return b; })},
      {"zstd-frame", framed([](const Bytes& b) { Bytes f = zstd_frame(b); f.resize(f.size() + 1); return f; })},
      {"zstd-frame", framed([](const Bytes& b) { Bytes f = zstd_frame(b), g = f; f.insert(f.end(), g.begin(), g.end()); return f; })},
      {"zstd-frame", framed([](const Bytes& b) { Bytes f = zstd_frame(b); put(f, 4, get(f, 4, 1) | 1, 1); return f; })},
      {"zstd-window", framed([](const Bytes& b) { return frame_with_window(b, 13 << 3 | 1); })},
      {"zstd-size", framed([](const Bytes& b) { return zstd_frame(b); }, 1)},
      {"zstd-data", framed([](const Bytes& b) { Bytes f = zstd_frame(b); f.resize(f.size() - 1); return f; })},
      {"zstd-data", framed([](const Bytes& b) { Bytes f = frame_with_window(b, 0); put(f, 10, 7, 1); return f; })},
      {"payload-truncated", resized(kGridChunk, -1)},
      {"payload-truncated", resized(kTileChunk, -1)},
      {"payload-truncated", resized(kTileChunk, -89)},
      {"payload-truncated", [] { TestFile p = with_maps(); p.set_payload(kColorChunk, Bytes(15)); return p.build(); }},
      {"payload-truncated", [] { TestFile p = with_maps(); p.set_payload(kNormalChunk, {}); return p.build(); }},
      {"payload-truncated", resized(kMembershipChunk, -1)},
      {"payload-truncated", resized(kMembershipChunk, -10)},
      {"payload-truncated", resized(kTextChunk, -1)},
      {"payload-truncated", resized(kColorChunk, -1)},
      {"payload-truncated", map_payload(kColorChunk, 0, 1024 | std::uint64_t{1024} << 32, 8)},
      {"payload-truncated", resized(kCellColorChunk, -3)},
      {"payload-truncated", resized(kInstanceColorChunk, -1)},
      {"payload-truncated", resized(kNormalChunk, -2)},
      {"payload-trailing", resized(kColorChunk, 1)},
      {"payload-trailing", map_payload(kColorChunk, 0, 1 | std::uint64_t{1} << 32, 8)},
      {"payload-trailing", resized(kCellColorChunk, 1)},
      {"payload-trailing", resized(kInstanceColorChunk, 3)},
      {"payload-trailing", resized(kNormalChunk, 1)},
      {"payload-truncated", payload(kTextChunk, 0, 0xffffffff, 4)},
      {"payload-truncated", payload(kMembershipChunk, 32, 0xffffffff, 4)},
      {"payload-truncated", payload(kMembershipChunk, 36, 0xffffffff, 4)},
      {"payload-trailing", resized(kGridChunk, 1)},
      {"payload-trailing", resized(kTileChunk, 1)},
      {"payload-trailing", resized(kMembershipChunk, 1)},
      {"payload-trailing", resized(kTextChunk, 1)},
      {"grid-box", payload(kGridChunk, 0, bits(kInf), 8)},
      {"grid-box", payload(kGridChunk, 8, bits(std::numeric_limits<double>::quiet_NaN()), 8)},
      {"grid-box", payload(kGridChunk, 24, bits(1e308), 8)},
      {"grid-box", payload(kGridChunk, 0, bits(1e300), 8)},
      {"grid-voxel-edge", payload(kGridChunk, 24, bits(0), 8)},
      {"grid-voxel-edge", payload(kGridChunk, 24, bits(-1), 8)},
      {"grid-voxel-edge", payload(kGridChunk, 24, bits(kInf), 8)},
      {"grid-voxel-edge", payload(kGridChunk, 24, bits(std::numeric_limits<double>::quiet_NaN()), 8)},
      {"grid-tiles", payload(kGridChunk, 36, 0, 4)},
      {"grid-tiles", payload(kGridChunk, 36, 1u << 30, 4)},
      {"grid-tiles", payload(kGridChunk, 32, 0xffffffffffffffff, 8)},
      {"grid-extent", payload(kGridChunk, 32, (1u << 28) + 1, 4)},
      {"grid-reserved", payload(kGridChunk, 63, 1, 1)},
      {"tile-resolution", payload(kTileChunk, 0, 3, 4)},
      {"tile-resolution", payload(kTileChunk, 8, 1025, 4)},
      {"tile-cell-count", payload(kTileChunk, 12, 0, 4)},
      {"tile-cell-count", payload(kTileChunk, 12, 65536, 4)},
      {"tile-piece-count", payload(kTileChunk, 16, 1, 4)},
      {"tile-piece-count", payload(kTileChunk, 16, 65, 4)},
      {"tile-id-bytes", payload(kTileChunk, 20, 2, 4)},
      {"tile-id-bytes", payload(kTileChunk, 20, 0, 4)},
      {"piece-cell", payload(kTileChunk, kPieces + 16, 3, 2)},
      {"piece-cell", payload(kTileChunk, kPieces, 0, 2)},
      {"piece-reserved", payload(kTileChunk, kPieces + 7, 1, 1)},
      {"piece-order", payload(kTileChunk, kPieces + 18, 0xff, 1)},
      {"piece-order", payload(kTileChunk, kPieces + 18, 0xfe, 1)},
      {"cell-without-piece", payload(kTileChunk, kPieces, 2 | 0xfeull << 16, 8)},
      {"cell-without-piece", payload(kTileChunk, 12, 3, 4)},
      {"voxel-id", payload(kTileChunk, kIds + 63, 4, 1)},
      {"piece-without-voxel", [] { TestFile p = small(); Bytes b = p.payload(kTileChunk); for (auto& v : std::span(b).subspan(kIds)) if (v == std::byte{1}) v = std::byte{3}; p.set_payload(kTileChunk, b); return p.build(); }},
      {"cell-home", payload(kTileChunk, kPieces + 2, 1, 1)},
      {"cell-home", payload(kTileChunk, kPieces + 18, 1, 1)},
      {"memb-rule", payload(kMembershipChunk, 0, 2, 4)},
      {"memb-cell-count", payload(kMembershipChunk, 4, 3, 4)},
      {"memb-run-length", payload(kMembershipChunk, kRuns, 1, 4)},
      {"memb-run-merge", payload(kMembershipChunk, kRuns, 7, 4)},
      {"memb-run-sum", payload(kMembershipChunk, kRuns, 1 | 2 << 2, 4)},
      {"memb-run-sum", payload(kMembershipChunk, kRuns, 1 | 0x3fffffffull << 2, 4)},
      {"memb-mixed-count", payload(kMembershipChunk, kRuns + 4, 4 | 2, 4)},
      {"memb-tag", mixed_tags(0b1101)},
      {"memb-tag", mixed_tags(0b1110)},
      {"memb-unused-bits", mixed_tags(0b01001001)},
      {"memb-uniform", mixed_tags(0b0101)},
      {"memb-uniform", mixed_tags(0)},
      {"memb-counts", payload(kMembershipChunk, 8, 2, 8)},
      {"memb-counts", payload(kMembershipChunk, 24, 2, 8)},
      {"text-key", text({{"", "x"}})},
      {"text-key", text({{std::string(257, 'k'), "x"}})},
      {"text-key", text({{std::string("a\0b", 3), "x"}})},
      {"text-utf8", text({{"k", "\xc3"}})},
      {"text-utf8", text({{"\xed\xa0\x80", "surrogate"}})},
      {"text-order", text({{"a", "1"}, {"a", "2"}})},
      {"text-order", text({{"ab", "1"}, {"a", "2"}})},
      {"color-resolution", map_payload(kColorChunk, 0, 0, 4)},
      {"color-resolution", map_payload(kColorChunk, 8, 1025, 4)},
      {"color-reserved", map_payload(kColorChunk, 15, 1, 1)},
      {"normal-code", map_payload(kNormalChunk, 0, 253, 1)},
      {"normal-code", map_payload(kNormalChunk, 3, 255, 1)},
      {"limit-exceeded", payload(kGridChunk, 32, 1u << 28, 4)},
  };
  return all;
}

}  // namespace

TEST_CASE("format: every issue of the catalogue has a file that shows it") {
  std::set<std::string> shown;
  for (const auto& [id, make] : cases()) {
    CAPTURE(id);
    const Bytes file = make();
    // An axis of too many voxels has more tiles than the default limit allows.
    ReadLimits limits;
    if (id == "grid-extent") limits.max_tiles = ~std::uint64_t{0};
    if (id == "limit-exceeded") limits.max_tiles = (1u << 28) - 1;
    const ValidationReport report = validate(file, limits);
    const Issue* found = nullptr;
    for (const Issue& issue : report.issues)
      if (!found && issue.id == id) found = &issue;
    REQUIRE(found);
    CHECK_FALSE(found->text.empty());
    CHECK(report.valid == (found->severity != Severity::kError));
    shown.insert(id);
    const Verdicts v = verdicts(file, limits);
    CHECK(v.reader == report.valid);
    CHECK(v.limit == (id == "limit-exceeded"));
    INFO(v.why << "; the reader found " << v.reader_id);
    CHECK(v.agree);
  }
  for (const IssueInfo& info : issue_catalogue()) {
    CAPTURE(info.id);
    CHECK(shown.count(std::string(info.id)) == 1);
  }
}

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
  put(grid, 24, bits(-1), 8);
  put(grid, 63, 1, 1);
  put(tile, kPieces + 7, 1, 1);
  put(tile, kIds, 9, 1);
  put(memb, 0, 7, 4);
  put(memb, kRuns, 0, 4);
  parts.set_payload(kGridChunk, grid);
  parts.set_payload(kTileChunk, tile);
  parts.set_payload(kMembershipChunk, memb);
  parts.set_payload(kTextChunk, encode_text({{"b", "\xff"}, {"a", ""}}));
  Bytes file = parts.build();
  put(file, 28, 1, 4);
  put(file, kTileEntry + 12, 1, 4);
  file.back() = std::byte{1};
  reseal_directory(file);
  const Verdicts v = verdicts(file);
  CHECK(v.agree);
  for (const char* id :
       {"header-flags", "chunk-reserved", "padding-nonzero", "grid-voxel-edge", "grid-reserved",
        "piece-reserved", "voxel-id", "memb-rule", "memb-run-length", "text-utf8", "text-order"}) {
    CAPTURE(id);
    CHECK(v.has(id));
  }
}

TEST_CASE("format: an issue says where it is") {
  const auto first = [](const Bytes& file) { return validate(file).issues.at(0); };
  const Issue padding = first(damaged(639)());
  CHECK(padding.offset == 639);
  CHECK(padding.chunk == kTextChunk);
  const Issue piece = first(payload(kTileChunk, kPieces + 7, 1, 1)());
  CHECK(piece.offset == 384 + kPieces + 5 + 2);
  CHECK(piece.chunk == kTileChunk);

  // A byte of a compressed chunk has no offset of its own: the chunk's is given, and the text says the rest.
  TestFile parts = small();
  Bytes tile = parts.payload(kTileChunk);
  put(tile, kPieces + 7, 1, 1);
  parts.set_payload(kTileChunk, tile);
  compress(parts.chunk(kTileChunk));
  const Issue compressed = first(parts.build());
  CHECK(compressed.offset == 384);
  CHECK(compressed.text.find("at byte 31") != std::string::npos);
}

TEST_CASE("format: a file of a thousand faults gets a short report") {
  TestFile parts = small();
  Bytes memb = parts.payload(kMembershipChunk);
  Bytes runs(4 * 5000);
  memb.insert(memb.begin() + kRuns, runs.begin(), runs.end());
  put(memb, 32, 5002, 4);
  parts.set_payload(kMembershipChunk, memb);
  for (int i = 0; i < 600; ++i) parts.chunks.push_back({fourcc("AAAA") + std::uint32_t(i), 1, 9, 0, {}});
  const Bytes file = parts.build();
  const ValidationReport report = validate(file);
  CHECK_FALSE(report.valid);
  CHECK(report.capped);
  CHECK(report.issues.size() <= 16 * 6);
  const ValidationReport one = validate(file, {}, 1);
  CHECK(one.issues.size() == 1);
  CHECK(one.capped);
  CHECK_FALSE(one.valid);
}
