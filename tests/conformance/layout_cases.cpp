#include <algorithm>
#include <array>
#include <utility>

#include "format/fourcc.h"
#include "format/hash.h"
#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

/// Where chunks are in the file, and in which order. [spec 3.3, 3.4]
namespace mesocell::test {
namespace {

using std::to_string;

constexpr std::array<const char*, 4> kInOrder = {"grid", "tile", "memb", "text"};

/// small() with `bytes` zeros before a chunk; that one's offset and the later ones are moved with them.
Bytes with_gap(std::size_t chunk, std::size_t bytes) {
  Bytes file = small().build();
  const std::size_t at = get(file, entry_at(chunk) + 16, 8);
  file.insert(file.begin() + std::ptrdiff_t(at), bytes, std::byte{0});
  for (std::size_t i = chunk; i < 4; ++i)
    put(file, entry_at(i) + 16, get(file, entry_at(i) + 16, 8) + bytes, 8);
  put(file, 16, file.size(), 8);
  reseal_directory(file);
  return file;
}

/// Directory entries of two chunks change places, the chunks stay where they are.
Bytes with_entries_swapped(std::size_t a, std::size_t b) {
  Bytes file = small().build();
  std::swap_ranges(file.begin() + std::ptrdiff_t(entry_at(a)),
                   file.begin() + std::ptrdiff_t(entry_at(a) + 64),
                   file.begin() + std::ptrdiff_t(entry_at(b)));
  reseal_directory(file);
  return file;
}

void add_offset_cases(CaseList& cases) {
  const Bytes file = small().build();
  for (std::size_t chunk = 0; chunk < 4; ++chunk) {
    const std::string name = "chunk-offset/" + std::string(kInOrder[chunk]);
    for (const std::size_t gap : {64u, 128u})
      cases.fault(name + "-gap-of-" + to_string(gap), with_gap(chunk, gap));
    // Not a multiple of 64 either; the padding behind the last chunk is then too long.
    for (const std::size_t gap : {1u, 8u, 63u})
      cases.faults(name + "-not-aligned-" + to_string(gap), with_gap(chunk, gap));
    const std::uint64_t offset = get(file, entry_at(chunk) + 16, 8);
    for (const auto& [what, value] :
         std::array<std::pair<const char*, std::uint64_t>, 6>{{{"zero", 0},
                                                               {"in-the-header", 8},
                                                               {"in-the-directory", 128},
                                                               {"one-less", offset - 1},
                                                               {"one-more", offset + 1},
                                                               {"64-less", offset - 64}}})
      if (chunk != 1) cases.faults(name + "-" + what, patched(file, entry_at(chunk) + 16, value, 8));
    for (const auto& [what, value] :
         std::array<std::pair<const char*, std::uint64_t>, 4>{{{"plus-2-to-32", offset + 0x100000000},
                                                               {"plus-2-to-63", offset + (1ull << 63)},
                                                               {"all-ones", ~0ull},
                                                               {"end-wraps", ~0ull - 63}}})
      if (chunk != 1)
        cases.faults("chunk-bounds/offset-" + std::string(kInOrder[chunk]) + "-" + what,
                     patched(file, entry_at(chunk) + 16, value, 8));
    for (std::size_t other = chunk + 1; other < 3; ++other)
      cases.fault(name + "-changes-places-with-" + kInOrder[other], with_entries_swapped(chunk, other));
    if (chunk < 3) cases.faults(name + "-changes-places-with-text", with_entries_swapped(chunk, 3));
  }
  // Two chunks of the same bytes: nothing says that they may not share them but the order.
  TestFile twins = tiny_with(fourcc("AAAA"), Bytes(64));
  twins.chunks.push_back({fourcc("BBBB"), 0, 0, 64, Bytes(64)});
  Bytes shared = twins.build();
  put(shared, entry_at(4) + 16, get(shared, entry_at(3) + 16, 8), 8);
  reseal_directory(shared);
  cases.faults("chunk-offset/shared-bytes", shared);
  cases.fault("chunk-offset/shared-bytes-at-the-end", sized(shared, shared.size() - 64));
}

void add_bounds_cases(CaseList& cases) {
  const Bytes file = small().build();
  const std::size_t last = entry_at(3), offset = get(file, last + 16, 8);
  const auto stored = [&](std::uint64_t bytes) {
    Bytes result = patched(file, last + 12, 8388608);
    put(result, last + 24, bytes, 8);
    put(result, last + 32, bytes, 8);
    reseal_directory(result);
    return result;
  };
  const std::size_t room = file.size() - offset;
  cases.fault("chunk-bounds/one-beyond", stored(room + 1));
  cases.fault("chunk-bounds/64-beyond", stored(room + 64));
  cases.fault("chunk-bounds/the-file-s-size", stored(file.size()));
  cases.fault("chunk-bounds/8388608", stored(8388608));
  // A frame's stored size hangs on nothing else.
  TestFile packed = small();
  packed.chunk(kTextChunk).codec = 1;
  packed.chunk(kTextChunk).block_bytes = 8388608;
  packed.chunk(kTextChunk).decoded_bytes = 8192;
  const Bytes frame_file = packed.build();
  for (const std::size_t beyond : {1u, 2u, 44u, 63u, 64u, 65u, 4096u})
    cases.fault("chunk-bounds/frame-" + to_string(beyond) + "-beyond",
                patched(frame_file, last + 24, room + beyond, 8));
  // A chunk whose end in 64 bits is where GRID begins, and one that covers the file from there.
  TestFile wrapping = tiny_with(fourcc("AAAA"), {});
  wrapping.chunks.push_back({fourcc("BBBB"), 0, 0, 64, Bytes(64)});
  Bytes wrapped = wrapping.build();
  const std::uint64_t grid = get(wrapped, entry_at(0) + 16, 8), at = get(wrapped, entry_at(3) + 16, 8);
  put(wrapped, entry_at(3) + 8, 1);
  put(wrapped, entry_at(3) + 12, 8388608);
  put(wrapped, entry_at(3) + 24, grid - at, 8);
  put(wrapped, entry_at(3) + 32, ~0ull, 8);
  put(wrapped, entry_at(4) + 12, 8388608);
  put(wrapped, entry_at(4) + 16, grid, 8);
  put(wrapped, entry_at(4) + 24, wrapped.size() - grid, 8);
  put(wrapped, entry_at(4) + 32, wrapped.size() - grid, 8);
  cases.faults("chunk-bounds/end-wraps-to-the-first-chunk",
               patched(wrapped, entry_at(4) + 40, hash64(std::span(wrapped).subspan(grid)), 8));
  // The file ends in the padding.
  const std::size_t end = offset + get(file, last + 24, 8);
  for (std::size_t size = end; size < file.size(); size += size % 64 < 60 ? 4 : 1)
    cases.fault("chunk-bounds/padding-of-" + to_string(size - end), sized(file, size));
  for (std::size_t size = offset; size < end; size += 3)
    cases.fault("chunk-bounds/chunk-of-" + to_string(size - offset), sized(file, size));
  // Whole chunks are gone.
  for (std::size_t chunk = 0; chunk < 3; ++chunk)
    cases.faults("chunk-bounds/ends-before-" + std::string(kInOrder[chunk]),
                 sized(file, get(file, entry_at(chunk) + 16, 8)));
}

void add_trailing_cases(CaseList& cases) {
  const Bytes file = small().build();
  for (const std::size_t more : {1u, 2u, 8u, 63u, 64u, 65u, 128u, 1024u})
    cases.fault("file-trailing/zeros-" + to_string(more), sized(file, file.size() + more));
  cases.fault("file-trailing/a-line-feed", sized(file + bytes_of("\n"), file.size() + 1));
  cases.fault("file-trailing/text", sized(file + bytes_of("<html>"), file.size() + 6));
  cases.fault("file-trailing/the-file-again", sized(file + file, 2 * file.size()));
  // A last chunk that ends at a multiple of 64 has no padding.
  TestFile full = tiny_with(fourcc("WHAT"), Bytes(64));
  cases.valid("layout/no-padding-at-the-end", "3.4", full.build(), "chunk-unknown-skippable");
  cases.fault("file-trailing/padding-that-is-not-needed", sized(full.build(), full.build().size() + 64));
  for (std::size_t bytes = 0; bytes <= 65; bytes += bytes == 2 ? 60 : 1) {
    TestFile sizes = tiny_with(fourcc("WHAT"), Bytes(bytes, std::byte{'x'}));
    if (bytes != 64)
      cases.valid("layout/last-chunk-of-" + to_string(bytes), "3.4", sizes.build(),
                  "chunk-unknown-skippable");
  }
}

void add_order_cases(CaseList& cases) {
  std::array<std::size_t, 4> order = {0, 1, 2, 3};
  const TestFile from = small();
  while (std::next_permutation(order.begin(), order.end())) {
    TestFile parts = from;
    std::string name = "layout/order";
    for (std::size_t i = 0; i < 4; ++i) {
      parts.chunks[i] = from.chunks[order[i]];
      name += "-" + std::string(kInOrder[order[i]]);
    }
    cases.valid(name, "3.3", parts.build());
  }
}

}  // namespace

void add_layout_cases(CaseList& cases) {
  add_offset_cases(cases);
  add_bounds_cases(cases);
  add_trailing_cases(cases);
  add_order_cases(cases);
}

}  // namespace mesocell::test
