#include <array>
#include <utility>

#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

namespace mesocell::test {
namespace {

using std::to_string;

constexpr std::size_t kMembershipFieldBytes = 36;
constexpr std::uint32_t kPage = 4096;

Bytes with_memb(std::size_t at, std::uint64_t value, unsigned bytes = 4) {
  return with(tiny(), kMembershipChunk, at, value, bytes);
}

TestFile parts_of(const CellObject& object) {
  TestFile parts = TestFile::of(object);
  parts.chunks.pop_back();
  return parts;
}

Bytes packed(TestFile parts) {
  for (TestChunk& c : parts.chunks) pack(c);
  return parts.build();
}

void add_membership_field_cases(CaseList& cases) {
  for (unsigned bit = 1; bit < 32; bit += 2)
    cases.fault("memb-rule/bit-" + to_string(bit), with_bit(tiny(), kMembershipChunk, 0, bit));
  cases.fault("memb-rule/3", with_memb(0, 3));
  cases.fault("memb-rule/all-ones", with_memb(0, 0xffffffff));
  cases.valid("memb/conservative", "4.3", with_memb(0, 1));
  for (const std::uint32_t count :
       {0u, 1u, 3u, 4u, 258u, 65535u, 65536u, 65538u, 0x02000000u, 0x80000002u, 0xffffffffu})
    cases.fault("memb-cell-count/" + to_string(count), with_memb(4, count));
  // tiny() has 3 INSIDE, none OUTSIDE and one INTERSECTED instance.
  const std::array<std::pair<const char*, std::size_t>, 3> counts = {
      {{"inside", 8}, {"outside", 16}, {"intersected", 24}}};
  const Bytes payload = tiny().payload(kMembershipChunk);
  for (const auto& [name, at] : counts) {
    const std::uint64_t right = get(payload, at, 8);
    for (const std::uint64_t wrong : std::initializer_list<std::uint64_t>{
             std::uint64_t{0}, right + 1, right - 1, std::uint64_t{4}, right + (1ull << 32),
             right + (1ull << 63), right << 56, ~std::uint64_t{0}}) {
      if (wrong == right || (wrong == ~std::uint64_t{0} && right == 0)) continue;
      if ((wrong == right - 1 || wrong == right + 1 || wrong == right << 56) && (wrong == 0 || wrong == 4))
        continue;
      cases.fault("memb-counts/" + std::string(name) + "-" + to_string(wrong), with_memb(at, wrong, 8));
    }
  }
  const auto with_counts = [&](std::uint64_t inside, std::uint64_t outside, std::uint64_t intersected) {
    return edited(tiny(), kMembershipChunk, [&](Bytes& memb) {
      put(memb, 8, inside, 8);
      put(memb, 16, outside, 8);
      put(memb, 24, intersected, 8);
    });
  };
  const std::uint64_t in = get(payload, 8, 8), out = get(payload, 16, 8), cut = get(payload, 24, 8);
  cases.fault("memb-counts/changed-places-1", with_counts(out, in, cut));
  cases.fault("memb-counts/changed-places-2", with_counts(cut, out, in));
  cases.fault("memb-counts/changed-places-3", with_counts(in, cut, out));
  cases.fault("memb-counts/none", with_counts(0, 0, 0));
  cases.fault("memb-counts/of-tiles", with_counts(1, 0, 0));
  cases.fault("memb-counts/same-sum", with_counts(in - 1, out + 1, cut));

  // Stated mixed tiles with as many tags as they need, and without.
  for (const std::uint32_t mixed : {0u, 2u, 3u, 64u})
    cases.fault("memb-mixed-count/really-" + to_string(mixed),
                edited(tiny(), kMembershipChunk, [&](Bytes& memb) {
                  put(memb, 32, mixed);
                  memb.resize(kTagsAt + mixed, std::byte{0b1001});
                }));
  // Counted as those readers would count that believe the number.
  cases.fault("memb-mixed-count/2-with-their-instances", edited(tiny(), kMembershipChunk, [&](Bytes& memb) {
                put(memb, 8, in + 1, 8);
                put(memb, 24, cut + 1, 8);
                put(memb, 32, 2);
                memb.push_back(std::byte{0b1001});
              }));
  cases.fault("memb-mixed-count/0-with-their-instances", edited(tiny(), kMembershipChunk, [&](Bytes& memb) {
                put(memb, 8, in - 1, 8);
                put(memb, 24, cut - 1, 8);
                put(memb, 32, 0);
                memb.pop_back();
              }));
  for (const std::uint32_t mixed : {2u, 257u, 65537u, 0x01000000u, 0x80000001u, 0xffffffffu})
    cases.fault("payload-truncated/memb-mixed-" + to_string(mixed), with_memb(32, mixed));
  cases.faults("memb-mixed-count/zero", with_memb(32, 0));
  for (const std::size_t bytes : {64u, 65u, 66u, 127u, 128u, 131u, 132u, 191u, 192u})
    cases.fault("payload-truncated/memb-" + to_string(bytes), with_size(tiny(), kMembershipChunk, bytes));
  for (const std::size_t bytes : {194u, 195u, 196u, 200u, 256u, 257u})
    cases.fault("payload-trailing/memb-" + to_string(bytes), with_size(tiny(), kMembershipChunk, bytes));
  for (const std::uint32_t tiles : {1024u, 5u * kPage})
    cases.fault("payload-truncated/memb-of-" + to_string(tiles) + "-tiles",
                with(tiny(), kGridChunk, 32, tiles));
}

void add_state_cases(CaseList& cases) {
  for (unsigned bit = 4; bit < 8; ++bit)
    cases.fault("memb-unused-bits/state-bit-" + to_string(bit),
                with_bit(tiny(), kMembershipChunk, kStatesAt, bit));
  cases.faults("memb-unused-bits/all-after-the-states", with_memb(kStatesAt, 0b11111101, 1));
  for (std::size_t at = kStatesAt + 1; at<kRanksAt; at += at + 3> kRanksAt ? 1 : 6)
    cases.fault("payload-padding/memb-" + to_string(at), with_bit(tiny(), kMembershipChunk, at, at % 8));
  for (std::size_t at = kRanksAt + 4; at<kTagsAt; at += at + 5> kTagsAt ? 1 : 5)
    cases.fault("payload-padding/memb-" + to_string(at), with_bit(tiny(), kMembershipChunk, at, at % 8));
  for (unsigned bit = 0; bit < 32; bit += 3)
    cases.fault("memb-rank/bit-" + to_string(bit), with_bit(tiny(), kMembershipChunk, kRanksAt, bit));

  for (const std::uint32_t tiles : {1u, 3u, 4u, 5u, 7u, 8u, 255u, 256u, 257u, 511u, 513u}) {
    const TestFile parts = parts_of(row_object(tiles, {tiles / 2}));
    cases.valid("memb/" + to_string(tiles) + "-tiles", "4.3", parts.build());
    for (unsigned bit = 2 * (tiles % 4); bit % 8 != 0; ++bit) {
      cases.fault("memb-unused-bits/" + to_string(tiles) + "-tiles-bit-" + to_string(bit),
                  with_bit(parts, kMembershipChunk, kStatesAt + tiles / 4, bit));
    }
  }
  // Uniform tiles that are said to be mixed, and the reverse: numbers of tags and states no longer agree.
  cases.faults("memb-mixed-count/none-in-the-states", with_memb(kStatesAt, 0b0101, 1));
  cases.faults("memb-mixed-count/two-in-the-states", with_memb(kStatesAt, 0b1111, 1));
  cases.fault("memb-counts/state-outside", with_memb(kStatesAt, 0b1100, 1));
  cases.fault("memb-counts/state-intersected", with_memb(kStatesAt, 0b1110, 1));
}

/// Pages of 4096 tiles, stored as frames.
void add_page_cases(CaseList& cases) {
  const auto with_rank = [](const TestFile& parts, std::size_t at, std::uint32_t rank, unsigned bytes = 4) {
    TestFile other = parts;
    Bytes memb = other.payload(kMembershipChunk);
    put(memb, at, rank, bytes);
    other.set_payload(kMembershipChunk, memb);
    return packed(other);
  };
  for (const std::uint32_t tiles : {kPage - 1, kPage, kPage + 1, 2 * kPage, 2 * kPage + 1}) {
    std::vector<std::uint32_t> mixed = {0, 7, kPage - 2};
    if (tiles > kPage) mixed.push_back(kPage - 1);
    if (tiles > kPage) mixed.push_back(kPage);
    if (tiles > kPage + 1) mixed.push_back(tiles - 1);
    const TestFile parts = parts_of(row_object(tiles, mixed));
    const std::string name = to_string(tiles);
    cases.valid("memb/pages-" + name + "-tiles", "4.3", packed(parts));
    const MembershipLayout layout = MembershipLayout::of(tiles, 2, std::uint32_t(mixed.size()));
    const Bytes memb = parts.chunks.back().stored;
    for (std::size_t page = 0; page < MembershipLayout::page_count(tiles); ++page) {
      const std::size_t at = layout.ranks_at + 4 * page;
      const std::uint32_t rank = std::uint32_t(get(memb, at));
      const std::string where = "memb-rank/" + name + "-tiles-page-" + to_string(page);
      cases.fault(where + "-high", with_rank(parts, at, rank + 1));
      cases.fault(where + "-sign-bit", with_rank(parts, at, rank | 0x80000000));
      if (page > 0) cases.fault(where + "-plus-65536", with_rank(parts, at, rank + 65536));
      if (rank > 0) cases.fault(where + "-low", with_rank(parts, at, rank - 1));
      if (rank > 1) cases.fault(where + "-zero", with_rank(parts, at, 0));
      if (rank > 0) cases.fault(where + "-big-endian", with_rank(parts, at, rank << 24));
    }
    const std::size_t end = layout.ranks_at + 4 * MembershipLayout::page_count(tiles);
    for (const std::size_t at : {end, layout.tags_at - 1})
      cases.fault("payload-padding/memb-after-ranks-of-" + name + "-tiles-" + to_string(at),
                  with_rank(parts, at, 1, 1));
  }
  // 16 ranks fill 64 bytes, 17 do not.
  for (const std::uint32_t pages : {16u, 17u, 33u}) {
    std::vector<std::uint32_t> mixed;
    for (std::uint32_t p = 0; p < pages; ++p) mixed.push_back(p * kPage + p * 37);
    const TestFile parts = parts_of(row_object(pages * kPage, mixed));
    cases.valid("memb/" + to_string(pages) + "-pages", "4.3", packed(parts));
    const MembershipLayout layout = MembershipLayout::of(pages * kPage, 2, pages);
    for (const std::uint32_t page : {1u, pages / 2, pages - 1})
      cases.fault("memb-rank/page-" + to_string(page) + "-of-" + to_string(pages),
                  with_rank(parts, layout.ranks_at + 4 * page, page + 1));
    cases.fault("memb-rank/page-counted-with-itself-of-" + to_string(pages), [&] {
      TestFile other = parts;
      Bytes memb = other.payload(kMembershipChunk);
      for (std::uint32_t p = 0; p < pages; ++p) put(memb, layout.ranks_at + 4 * p, p + 1);
      other.set_payload(kMembershipChunk, memb);
      return packed(other);
    }());
  }
  // Ranks that count from the page before would be zeros.
  const TestFile none = parts_of(row_object(3 * kPage, {}));
  cases.valid("memb/pages-without-mixed-tiles", "4.3", packed(none));
  cases.fault("memb-rank/without-mixed-tiles",
              with_rank(none, MembershipLayout::of(3 * kPage, 2, 0).ranks_at + 8, 1));
}

void add_tag_cases(CaseList& cases) {
  for (const std::uint32_t cells : {2u, 3u, 4u, 5u, 8u, 9u}) {
    const TestFile parts = parts_of(many_cells_object(cells));
    const std::string name = to_string(cells) + "-cells";
    const std::size_t tag_bytes = (cells + 3) / 4;
    for (std::uint32_t cell = 0; cell < cells; ++cell) {
      // The counts leave the bad tag out: one fault alone.
      cases.fault("memb-tag/" + name + "-" + to_string(cell),
                  edited(parts, kMembershipChunk, [&](Bytes& memb) {
                    const std::size_t at = kTagsAt + cell / 4;
                    put(memb, at, get(memb, at, 1) | 3u << 2 * (cell % 4), 1);
                    const std::size_t count_at = cell == 0 ? 8 : 16;
                    put(memb, count_at, get(memb, count_at, 8) - 1, 8);
                  }));
    }
    for (unsigned bit = 2 * (cells % 4); bit % 8 != 0; ++bit)
      cases.fault("memb-unused-bits/" + name + "-bit-" + to_string(bit),
                  with_bit(parts, kMembershipChunk, kTagsAt + tag_bytes - 1, bit));
    // The second cell is OUTSIDE: 3 has the bits of both others.
    cases.fault("memb-tag/" + name + "-counted-as-both", edited(parts, kMembershipChunk, [&](Bytes& memb) {
                  put(memb, kTagsAt, get(memb, kTagsAt, 1) | 3u << 2, 1);
                  put(memb, 8, get(memb, 8, 8) + 1, 8);
                  put(memb, 16, get(memb, 16, 8) - 2, 8);
                  put(memb, 24, get(memb, 24, 8) + 1, 8);
                }));
    if (cells % 4 != 0)
      cases.fault("memb-unused-bits/" + name + "-counted", edited(parts, kMembershipChunk, [&](Bytes& memb) {
                    const std::size_t last = kTagsAt + tag_bytes - 1;
                    put(memb, last, get(memb, last, 1) | 0x40, 1);
                    put(memb, 8, get(memb, 8, 8) + 1, 8);
                    put(memb, 16, get(memb, 16, 8) - 1, 8);
                  }));
    for (unsigned tag = 0; tag < 3; ++tag) {
      CellObject object = many_cells_object(cells);
      for (std::uint32_t cell = 0; cell < cells; ++cell) {
        std::uint8_t& byte = object.membership.blocks[cell / 4];
        byte = std::uint8_t((byte & ~(3u << 2 * (cell % 4))) | tag << 2 * (cell % 4));
      }
      cases.fault("memb-uniform/" + name + "-" + to_string(tag), parts_of(object).build());
      // All but the last one the same: as little as it takes.
      std::uint8_t& last = object.membership.blocks[(cells - 1) / 4];
      last = std::uint8_t((last & ~(3u << 2 * ((cells - 1) % 4))) | (tag + 1) % 3 << 2 * ((cells - 1) % 4));
      cases.valid("memb/" + name + "-all-but-the-last-" + to_string(tag), "4.3", parts_of(object).build());
    }
  }
  // One cell cannot differ from itself.
  for (unsigned tag = 0; tag < 3; ++tag) {
    CellObject object = solid_object({4, 4, 4}, {2, 1, 1});
    object.membership.entries = {1, MembershipMap::kFirstBlock};
    object.membership.blocks = {std::uint8_t(tag)};
    cases.fault("memb-uniform/one-cell-" + to_string(tag), parts_of(object).build());
  }
  // The second of two mixed tiles.
  CellObject both = tiny_object();
  both.membership.entries = {MembershipMap::kFirstBlock, MembershipMap::kFirstBlock + 1};
  both.membership.blocks = {0b0001, 0b0110};
  const TestFile parts = parts_of(both);
  cases.valid("memb/both-mixed", "4.3", parts.build());
  both.membership.blocks[1] = 0b1010;
  cases.fault("memb-uniform/of-the-second-tile", parts_of(both).build());
  cases.fault("memb-unused-bits/of-the-second-tile", with_bit(parts, kMembershipChunk, kTagsAt + 1, 7));
  cases.fault("memb-unused-bits/of-the-first-tile", with_bit(parts, kMembershipChunk, kTagsAt, 4));
  cases.fault("memb-counts/other-tags", with(parts, kMembershipChunk, kTagsAt, 0x0606, 2));

  // Without anything inside: valid, and worth a warning.
  const auto filled = [](std::uint32_t first, std::uint32_t second, std::vector<std::uint8_t> blocks) {
    CellObject object = tiny_object();
    object.membership.entries = {first, second};
    object.membership.blocks = std::move(blocks);
    return parts_of(object).build();
  };
  cases.valid("memb/all-outside", "4.3", filled(0, 0, {}), "memb-nothing-inside");
  cases.valid("memb/all-intersected", "4.3", filled(2, 2, {}), "memb-nothing-inside");
  cases.valid("memb/outside-and-intersected", "4.3", filled(0, 2, {}), "memb-nothing-inside");
  cases.valid("memb/mixed-without-inside", "4.3", filled(0, 3, {0b1000}), "memb-nothing-inside");
  cases.valid("memb/all-inside", "4.3", filled(1, 1, {}));
  cases.valid("memb/inside-in-a-mixed-tile-alone", "4.3", filled(0, 3, {0b0100}));
}

}  // namespace

void add_membership_cases(CaseList& cases) {
  add_chunk_header_cases(cases, tiny(), kMembershipChunk, kMembershipFieldBytes);
  add_membership_field_cases(cases);
  add_state_cases(cases);
  add_page_cases(cases);
  add_tag_cases(cases);
}

}  // namespace mesocell::test
