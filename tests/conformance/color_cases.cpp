#include <utility>

#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

/// COLR, CCOL and ICOL. [spec 4.5, 4.6, 4.7]
namespace mesocell::test {
namespace {

using std::to_string;

std::vector<Rgb8> ramp(std::size_t count) {
  std::vector<Rgb8> colors(count);
  for (std::size_t i = 0; i < count; ++i)
    colors[i] = {std::uint8_t(i), std::uint8_t(255 - i), std::uint8_t(7 * i)};
  return colors;
}

TestFile with_map(const Index3& resolution, float error = 0.5f) {
  ColorMap map;
  map.resolution = resolution;
  map.voxels = ramp(std::size_t{resolution[0]} * resolution[1] * resolution[2]);
  map.max_error = error;
  return tiny_with(kColorChunk, encode_color(map));
}

TestFile with_list(std::uint32_t type, std::size_t count) {
  return tiny_with(type, encode_colors({ramp(count), 0.5f}));
}

void add_map_cases(CaseList& cases) {
  const TestFile parts = with_map({2, 1, 3});
  add_chunk_header_cases(cases, parts, kColorChunk, 16);
  add_stated_error_cases(cases, parts, kColorChunk, 12, "4.5");
  cases.valid("colr/one-color", "4.5", with_map({1, 1, 1}).build());
  cases.valid("colr/of-another-resolution-than-the-tile", "4.5", with_map({7, 5, 3}).build());
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis = kAxes[a];
    for (const std::uint32_t r : {0u, 1025u, 65537u, 0x80000001u, 0xffffffffu})
      cases.fault("color-resolution/" + axis + "-" + to_string(r), with(parts, kColorChunk, 4 * a, r));
    Index3 resolution = {1, 1, 1};
    resolution[a] = 1024;
    cases.valid("colr/1024-along-" + axis, "4.5", with_map(resolution).build());
    resolution[a] = 1025;
    cases.fault("color-resolution/" + axis + "-really-1025", with_map(resolution).build());
    resolution[a] = 0;
    resolution[(a + 1) % 3] = 2;
    cases.fault("color-resolution/" + axis + "-really-0", with_map(resolution).build());
    cases.fault("payload-truncated/colr-one-more-along-" + axis,
                with(parts, kColorChunk, 4 * a, get(parts.chunks.back().stored, 4 * a) + 1));
  }
  for (std::size_t bytes = 64; bytes < 64 + 18; ++bytes)
    cases.fault("payload-truncated/colr-" + to_string(bytes), with_size(parts, kColorChunk, bytes));
  for (const std::size_t more : {1u, 2u, 3u, 6u, 64u})
    cases.fault("payload-trailing/colr-" + to_string(82 + more), with_size(parts, kColorChunk, 82 + more));
  cases.fault("payload-trailing/colr-one-less-along-x", with(parts, kColorChunk, 0, 1));
  cases.fault("payload-trailing/colr-one-less-along-z", with(parts, kColorChunk, 8, 2));
  cases.fault("payload-truncated/colr-greatest", edited(parts, kColorChunk, [](Bytes& bytes) {
                for (std::size_t a = 0; a < 3; ++a) put(bytes, 4 * a, 1024);
              }));
}

/// One color a cell, or one an INSIDE instance: two and three in tiny().
void add_list_cases(CaseList& cases, std::uint32_t type, std::size_t count, std::string_view clause) {
  const TestFile parts = with_list(type, count);
  const std::string name = lower_name(type);
  cases.valid(name + "/as-many-as-there-are", clause, parts.build());
  add_chunk_header_cases(cases, parts, type, 4);
  add_stated_error_cases(cases, parts, type, 0, clause);
  const std::size_t right = 64 + 3 * count;
  for (std::size_t bytes = 64; bytes < right; ++bytes)
    cases.fault("payload-truncated/" + name + "-" + to_string(bytes), with_size(parts, type, bytes));
  for (const std::size_t more : {1u, 2u, 3u, 6u, 64u})
    cases.fault("payload-trailing/" + name + "-" + to_string(right + more),
                with_size(parts, type, right + more));
}

}  // namespace

void add_color_cases(CaseList& cases) {
  add_map_cases(cases);
  add_list_cases(cases, kCellColorChunk, 2, "4.6");
  add_list_cases(cases, kInstanceColorChunk, 3, "4.7");
  // As many colors as cells, or as instances of any tag.
  cases.fault("payload-truncated/icol-one-a-cell",
              edited(with_list(kInstanceColorChunk, 2), kInstanceColorChunk,
                     [](Bytes& bytes) { bytes[64] = std::byte{9}; }));
  cases.fault("payload-trailing/icol-one-an-instance", with_list(kInstanceColorChunk, 4).build());
  cases.fault("payload-trailing/ccol-one-a-piece", with_list(kCellColorChunk, 3).build());

  // Without an INSIDE instance there are none of their colors.
  CellObject object = tiny_object();
  object.membership.entries = {0, 2};
  object.membership.blocks.clear();
  TestFile none = TestFile::of(object);
  none.chunks.back() = {kInstanceColorChunk, 0, 0, 64, Bytes(64)};
  cases.valid("icol/none", "4.7", none.build(), "memb-nothing-inside");
  cases.fault("payload-trailing/icol-one-of-none", with_size(none, kInstanceColorChunk, 67));
  cases.fault("payload-truncated/icol-none-and-no-header", with_size(none, kInstanceColorChunk, 0));
  TestFile all = tiny();
  for (TestFile from :
       {with_map({3, 3, 3}), with_list(kCellColorChunk, 2), with_list(kInstanceColorChunk, 3)})
    all.chunks.push_back(from.chunks.back());
  cases.valid("colr/all-three", "4.5", all.build());
  // 90 cells, and 91 instances.
  TestFile many = TestFile::of(many_cells_object(90));
  many.chunks.back() = with_list(kCellColorChunk, 90).chunks.back();
  many.chunks.push_back(with_list(kInstanceColorChunk, 91).chunks.back());
  cases.valid("ccol/90", "4.6", many.build());
  cases.fault("payload-truncated/ccol-89-of-90", with_size(many, kCellColorChunk, 64 + 89 * 3));
  cases.fault("payload-trailing/icol-92-of-91", with_size(many, kInstanceColorChunk, 64 + 92 * 3));
  cases.fault("payload-truncated/icol-90-of-91", with_size(many, kInstanceColorChunk, 64 + 90 * 3));
}

}  // namespace mesocell::test
