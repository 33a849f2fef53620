#include <array>
#include <utility>

#include "format/fourcc.h"
#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

namespace mesocell::test {
namespace {

using std::to_string;

constexpr std::array<const char*, 5> kNames = {"grid", "tile", "memb", "text", "unknown"};

/// GRID, TILE, MEMB, TEXT and a chunk of a type that nobody knows.
TestFile five() {
  TestFile parts = small();
  parts.chunks.push_back({fourcc("WHAT"), 0, 0, 5, bytes_of("what?")});
  return parts;
}

/// A chunk of each type that may be skipped, small and right for tiny().
TestFile with_maps() {
  CellObject object = walkthrough_object();
  object.color = ColorMap{{1, 1, 1}, {{1, 2, 3}}};
  object.cell_colors = ColorList{{{1, 2, 3}, {4, 5, 6}}};
  object.instance_colors = ColorList{{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}};
  object.normals.emplace().normals.assign(24, {0, 252});
  return TestFile::of(object);
}

void add_field_cases(CaseList& cases) {
  const Bytes file = five().build();
  for (std::size_t chunk = 0; chunk < 5; ++chunk) {
    const std::size_t at = entry_at(chunk);
    const std::string name = std::string(kNames[chunk]) + "-";
    for (unsigned bit = 1; bit < 16; bit += chunk == 0 ? 1 : 4)
      cases.fault("chunk-flags/" + name + to_string(bit), flipped(file, at + 4 + bit / 8, 1u << bit % 8));
    for (unsigned bit = 16; bit < 32; bit += chunk == 0 ? 3 : 5)
      cases.fault("extension-nonzero/flag-" + name + to_string(bit),
                  flipped(file, at + 4 + bit / 8, 1u << bit % 8));
    for (unsigned byte = unsigned(chunk % 2); byte < 8; byte += 2) {
      const unsigned mask = 1u << (byte + chunk) % 8;
      cases.fault("chunk-reserved/" + name + to_string(byte), flipped(file, at + 48 + byte, mask));
      cases.fault("extension-nonzero/byte-" + name + to_string(byte), flipped(file, at + 56 + byte, mask));
    }
    const std::array<std::pair<const char*, std::uint32_t>, 6> codecs = {{{"2", 2},
                                                                          {"3", 3},
                                                                          {"256", 256},
                                                                          {"65537", 65537},
                                                                          {"sign-bit", 0x80000000},
                                                                          {"all-ones", 0xffffffff}}};
    for (const auto& [codec, number] : codecs)
      cases.fault("chunk-codec/" + name + codec, patched(file, at + 8, number));
    const std::array<std::pair<const char*, std::uint32_t>, 11> sizes = {{{"zero", 0},
                                                                          {"one", 1},
                                                                          {"2048", 2048},
                                                                          {"4095", 4095},
                                                                          {"4097", 4097},
                                                                          {"6144", 6144},
                                                                          {"12288", 12288},
                                                                          {"8388607", 8388607},
                                                                          {"8388609", 8388609},
                                                                          {"16777216", 16777216},
                                                                          {"sign-bit", 0x80000000}}};
    for (const auto& [size, number] : sizes) {
      if (chunk % 2 == 0 && number != 0 && number != 2048 && number != 16777216) continue;
      cases.fault("block-bytes/" + name + size, patched(file, at + 12, number));
    }
    for (unsigned byte = unsigned(chunk % 3); byte < 8; byte += 3) {
      cases.fault("chunk-hash/" + name + "field-" + to_string(byte),
                  flipped(file, at + 40 + byte, 0x80u >> byte));
    }
    const std::uint64_t offset = get(file, at + 16, 8), stored = get(file, at + 24, 8);
    for (std::uint64_t byte = 0; byte < stored; byte += stored / 3 + 1)
      cases.fault("chunk-hash/" + name + "damaged-" + to_string(byte),
                  damaged(file, offset + byte, 1u << byte % 8));
    cases.fault("chunk-hash/" + name + "last-byte", damaged(file, offset + stored - 1, 0xff));
    cases.fault("chunk-hash/" + name + "zero", patched(file, at + 40, 0, 8));
    for (std::uint64_t end = offset + stored, byte = 0; (end + byte) % 64 != 0;
         byte += (end + byte) % 64 < 60 ? 4 : 1)
      cases.fault("padding-nonzero/" + name + to_string(byte), damaged(file, end + byte, 1u << byte % 8));
    cases.fault("chunk-raw-size/" + name + "one-less", patched(file, at + 32, stored - 1, 8));
    cases.fault("chunk-raw-size/" + name + "one-more", patched(file, at + 32, stored + 1, 8));
    cases.fault("chunk-raw-size/" + name + "none", patched(file, at + 32, 0, 8));
    cases.fault("chunk-raw-size/" + name + "twice", patched(file, at + 32, 2 * stored, 8));
    cases.fault("chunk-raw-size/" + name + "plus-2-to-16", patched(file, at + 32, 4096, 8));
  }
  for (std::uint32_t size = 4096; size <= 8388608; size *= 2) {
    Bytes sizes = file;
    for (std::size_t chunk = 0; chunk < 5; ++chunk) put(sizes, entry_at(chunk) + 12, size);
    reseal_directory(sizes);
    cases.valid("directory/block-bytes-" + to_string(size), "3.3", sizes, "chunk-unknown-skippable");
  }
}

void add_type_cases(CaseList& cases) {
  const TestFile parts = with_maps();
  cases.valid("directory/all-types", "3.3", parts.build());
  for (std::size_t i = 0; i < parts.chunks.size(); ++i) {
    const std::string name = lower_name(parts.chunks[i].type);
    TestFile flag = parts;
    flag.chunks[i].flags ^= 1;
    cases.fault("chunk-criticality/" + name, flag.build());
    TestFile twice = parts;
    twice.chunks.push_back(parts.chunks[i]);
    cases.fault("chunk-duplicate/" + name + "-at-the-end", twice.build());
    twice.chunks.pop_back();
    twice.chunks.insert(twice.chunks.begin() + std::ptrdiff_t(i), parts.chunks[i]);
    if (i + 1 < parts.chunks.size()) cases.fault("chunk-duplicate/" + name + "-next-to-it", twice.build());
    TestFile packed = parts;
    compress_by_hand(packed.chunks[i]);
    if (parts.chunks[i].type != kGridChunk && packed.chunks[i].stored.size() < parts.chunks[i].stored.size())
      cases.valid("directory/zstd-" + name, "3.3", packed.build());
    if (parts.chunks[i].type != kGridChunk) continue;
    cases.fault("chunk-codec/grid-is-zstd", packed.build());
    packed.chunks[i].stored = parts.chunks[i].stored;
    cases.fault("chunk-codec/grid-is-a-raw-block-of-zstd", packed.build());
  }
  for (const std::uint32_t missing : {kGridChunk, kTileChunk, kMembershipChunk}) {
    TestFile less = tiny();
    std::erase_if(less.chunks, [&](const TestChunk& c) { return c.type == missing; });
    cases.fault("chunk-missing/" + lower_name(missing), less.build());
    cases.fault("chunk-missing/" + lower_name(missing) + "-of-the-second",
                joined({named(tiny(), "a"), named(less, "b")}));
    cases.fault("chunk-missing/" + lower_name(missing) + "-of-the-first",
                joined({named(less, "a"), named(tiny(), "b")}));
    TestFile alone = tiny();
    std::erase_if(alone.chunks, [&](const TestChunk& c) { return c.type != missing; });
    cases.fault("chunk-missing/all-but-" + lower_name(missing), alone.build());
    // The place is taken by a chunk of another name.
    TestFile other = tiny();
    other.chunk(missing).flags = 0;
    other.chunk(missing).type ^= 0x20;
    cases.fault("chunk-missing/" + lower_name(missing) + "-in-lower-case", other.build());
  }
  TestFile text = small();
  text.chunks.erase(text.chunks.begin(), text.chunks.begin() + 3);
  cases.fault("chunk-missing/all-but-text", text.build());

  const std::array<std::pair<const char*, std::uint32_t>, 14> codes = {
      {{"what", fourcc("WHAT")},
       {"grid-in-lower-case", fourcc("grid")},
       {"grid-reversed", fourcc("DIRG")},
       {"tile-reversed", fourcc("ELIT")},
       {"memb-reversed", fourcc("BMEM")},
       {"grid-and-one", kGridChunk + 1},
       {"tile-and-one", kTileChunk + 1},
       {"memb-and-one", kMembershipChunk + 1},
       {"text-in-lower-case", fourcc("text")},
       {"blanks", fourcc("    ")},
       {"cell", fourcc("CELL")},
       {"three-letters", fourcc("GRI\0")},
       {"zero", 0},
       {"all-ones", 0xffffffff}}};
  for (const auto& [name, code] : codes) {
    TestFile more = tiny_with(code, bytes_of("..."));
    cases.valid("directory/skipped-" + std::string(name), "3.3", more.build(), "chunk-unknown-skippable");
    more.chunks.back().flags = 1;
    cases.fault("chunk-unknown-critical/" + std::string(name), more.build());
  }
  TestFile twice = five();
  twice.chunks.push_back(twice.chunks.back());
  cases.fault("chunk-duplicate/unknown", twice.build());
  TestFile many = tiny();
  for (std::uint32_t i = 0; i < 40; ++i) many.chunks.push_back({fourcc("A000") + i, 0, 0, 0, {}});
  cases.valid("directory/skipped-forty", "3.3", many.build(), "chunk-unknown-skippable");
  TestFile critical = tiny();
  critical.chunks.insert(critical.chunks.begin(), {fourcc("WHAT"), 1, 0, 0, {}});
  cases.fault("chunk-unknown-critical/first", critical.build());
  cases.fault("chunk-unknown-critical/of-the-second", joined({named(tiny(), "a"), named(critical, "b")}));

  // What is in a chunk that is skipped is nobody's business, but its sizes and hashes are everybody's.
  TestFile garbage = tiny_with(fourcc("WHAT"), bytes_of("not a frame"));
  garbage.chunks.back().codec = 1;
  garbage.chunks.back().decoded_bytes = 4096;
  cases.valid("directory/skipped-with-a-frame-that-does-not-decode", "3.3", garbage.build(),
              "chunk-unknown-skippable");
  garbage.chunks.back().decoded_bytes = 10;
  cases.fault("block-size/skipped-is-larger-than-decoded", garbage.build());
}

}  // namespace

void add_directory_cases(CaseList& cases) {
  add_field_cases(cases);
  add_type_cases(cases);
  TestFile most = tiny();
  for (std::uint32_t i = 0; i < 4093; ++i) most.chunks.push_back({0x80000000 + i, 0, 0, 0, {}});
  cases.valid("directory/4096-chunks", "3.3", most.build(), "chunk-unknown-skippable");
  most.chunks.push_back({0x70000000, 0, 0, 0, {}});
  cases.fault("chunk-count/really-4097", most.build());
}

}  // namespace mesocell::test
