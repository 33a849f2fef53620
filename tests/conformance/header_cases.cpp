#include <algorithm>
#include <array>
#include <utility>

#include "format/hash.h"
#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

namespace mesocell::test {
namespace {

using std::to_string;

std::string with_bit_name(const char* name, std::size_t bit) { return name + to_string(bit); }

/// The file with another hash in its header.
Bytes with_header_hash(std::uint64_t hash) {
  Bytes file = tiny().build();
  put(file, 56, hash, 8);
  return file;
}

std::uint64_t swapped(std::uint64_t v) {
  std::uint64_t result = 0;
  for (int i = 0; i < 8; ++i) result |= (v >> (8 * i) & 0xff) << (56 - 8 * i);
  return result;
}

void add_magic_cases(CaseList& cases) {
  const Bytes file = tiny().build();
  for (std::size_t bit = 0; bit < 64; bit += bit % 8 == 6 ? 1 : 2)
    cases.fault(with_bit_name("header-magic/bit-", bit), flipped(file, bit / 8, 1u << bit % 8));
  // What programs that take the file for text make of it.
  const auto replaced = [&](std::string_view magic) {
    Bytes head = bytes_of(magic);
    return sized(head + std::span(file).subspan(8), file.size() - 8 + magic.size());
  };
  cases.fault("header-magic/line-feed-alone", replaced("\x89MESO\n\x1a"));
  cases.fault("header-magic/carriage-return-twice", replaced("\x89MESO\r\r\n\x1a"));
  cases.fault("header-magic/utf-8", replaced("\xc2\x89MESO\r\n\x1a"));
  cases.fault("header-magic/utf-8-mark-before", replaced("\xef\xbb\xbf\x89MESO\r\n\x1a"));
  cases.fault("header-magic/png", replaced("\x89PNG\r\n\x1a\n"));
  cases.fault("header-magic/lower-case", replaced("\x89meso\r\n\x1a"));
  cases.fault("header-magic/zstd", frame(file));
  cases.fault("header-magic/one-wrong-byte-alone", bytes_of("M"));
  cases.fault("header-magic/text", bytes_of(std::string(200, 'x')));
  cases.fault("header-magic/zeros", Bytes(960));
  cases.fault("header-magic/one-byte-late", sized(Bytes(1) + file, file.size() + 1));
  for (std::size_t bytes = 0; bytes < 64; bytes += bytes < 9 || bytes > 60 ? 1 : 4)
    cases.fault("header-truncated/" + to_string(bytes),
                Bytes(file.begin(), file.begin() + std::ptrdiff_t(bytes)));
}

void add_header_hash_cases(CaseList& cases) {
  const Bytes file = tiny().build();
  for (std::size_t bit = 0; bit < 64; bit += 5)
    cases.fault(with_bit_name("header-hash/bit-", bit), damaged(file, 56 + bit / 8, 1u << bit % 8));
  const std::uint64_t hash = get(file, 56, 8);
  const std::span bytes(file);
  cases.fault("header-hash/zero", with_header_hash(0));
  cases.fault("header-hash/all-ones", with_header_hash(~std::uint64_t{0}));
  cases.fault("header-hash/big-endian", with_header_hash(swapped(hash)));
  cases.fault("header-hash/low-half-alone", with_header_hash(hash & 0xffffffff));
  cases.fault("header-hash/of-48-bytes", with_header_hash(hash64(bytes.first(48))));
  cases.fault("header-hash/of-no-bytes", with_header_hash(hash64({})));
  Bytes zeroed = file;
  put(zeroed, 56, 0, 8);
  cases.fault("header-hash/of-64-bytes", with_header_hash(hash64(std::span(zeroed).first(64))));
  cases.fault("header-hash/of-the-file", with_header_hash(hash64(zeroed)));
  // A header that is damaged where nothing else depends on it.
  for (std::size_t at = 40; at < 48; ++at)
    cases.faults("header-hash/damaged-" + to_string(at), damaged(file, at));
  cases.faults("header-hash/damaged-flags", damaged(file, 28));
  cases.faults("header-hash/damaged-file-size", damaged(file, 16));
  cases.faults("header-hash/damaged-tables-hash", damaged(file, 32));
}

void add_header_size_cases(CaseList& cases) {
  const Bytes file = tiny().build();
  const std::uint64_t size = file.size();
  const std::array<std::pair<const char*, std::uint64_t>, 12> stated = {
      {{"one-less", size - 1},
       {"one-more", size + 1},
       {"64-less", size - 64},
       {"64-more", size + 64},
       {"zero", 0},
       {"header-alone", 64},
       {"twice", 2 * size},
       {"plus-2-to-16", size + 0x10000},
       {"plus-2-to-32", size + 0x100000000},
       {"plus-2-to-63", size + (1ull << 63)},
       {"all-ones", ~0ull},
       {"big-endian", swapped(size)}}};
  for (const auto& [name, value] : stated)
    cases.fault("file-size/stated-" + std::string(name), patched(file, 16, value, 8));
  for (const std::size_t cut : {1u, 2u, 62u, 63u, 64u, 255u, 256u, 447u, 448u, 512u})
    cases.faults("file-size/cut-by-" + to_string(cut), Bytes(file.begin(), file.end() - std::ptrdiff_t(cut)));
  for (const std::size_t more : {1u, 64u, 1024u}) {
    Bytes longer = file;
    longer.resize(file.size() + more);
    cases.faults("file-size/longer-by-" + to_string(more), longer);
  }
}

void add_header_count_cases(CaseList& cases) {
  const Bytes file = tiny().build();
  const std::array<std::pair<const char*, std::uint32_t>, 9> assets = {{{"zero", 0},
                                                                        {"1025", 1025},
                                                                        {"2048", 2048},
                                                                        {"65536", 65536},
                                                                        {"65537", 65537},
                                                                        {"big-endian-one", 0x01000000},
                                                                        {"2-to-26-and-one", 0x04000001},
                                                                        {"sign-bit", 0x80000001},
                                                                        {"all-ones", 0xffffffff}}};
  for (const auto& [name, count] : assets)
    cases.fault("asset-count/" + std::string(name), patched(file, 12, count));
  const std::array<std::pair<const char*, std::uint32_t>, 9> chunks = {{{"zero", 0},
                                                                        {"4097", 4097},
                                                                        {"8192", 8192},
                                                                        {"65539", 65539},
                                                                        {"big-endian-three", 0x03000000},
                                                                        {"2-to-26-and-three", 0x04000003},
                                                                        {"sign-bit", 0x80000003},
                                                                        {"all-ones", 0xffffffff},
                                                                        {"4099", 4099}}};
  for (const auto& [name, count] : chunks)
    cases.fault("chunk-count/" + std::string(name), patched(file, 24, count));

  // Neither assets nor chunks, and so no asset without a chunk.
  Bytes nothing = sized(file, 64);
  put(nothing, 12, 0);
  cases.faults("chunk-count/nothing-in-the-file", patched(nothing, 24, 0));

  for (unsigned bit = 0; bit < 32; ++bit)
    cases.fault(with_bit_name("header-flags/bit-", bit), flipped(file, 28 + bit / 8, 1u << bit % 8));
  for (unsigned bit = 0; bit < 64; bit += 5)
    cases.fault(with_bit_name("header-reserved/bit-", bit), flipped(file, 40 + bit / 8, 1u << bit % 8));
  for (unsigned bit = 0; bit < 64; bit += 5)
    cases.fault(with_bit_name("extension-nonzero/header-bit-", bit),
                flipped(file, 48 + bit / 8, 1u << bit % 8));

  // Header, asset table and directory end at 320; the header's size is that of the file.
  for (std::size_t bytes = 64; bytes < 320; bytes += 16)
    cases.fault("directory-truncated/" + to_string(bytes), sized(file, bytes));
  for (const std::size_t bytes : {65u, 127u, 129u, 191u, 193u, 255u, 257u, 319u})
    cases.fault("directory-truncated/" + to_string(bytes), sized(file, bytes));
  cases.fault("directory-truncated/4096-chunks", patched(file, 24, 4096));
  cases.fault("directory-truncated/1024-assets", patched(file, 12, 1024));
  cases.fault("directory-truncated/all-of-both", patched(patched(file, 12, 1024), 24, 4096));
  cases.fault("directory-truncated/one-row-beyond-the-file", patched(file, 24, 12));
}

void add_directory_hash_cases(CaseList& cases) {
  const Bytes file = named(tiny(), "bunny").build();
  const auto with_hash = [&](std::uint64_t hash) {
    Bytes result = file;
    put(result, 32, hash, 8);
    reseal_header(result);
    return result;
  };
  const std::uint64_t hash = get(file, 32, 8);
  const std::span bytes(file);
  for (unsigned bit = 0; bit < 64; bit += 5)
    cases.fault(with_bit_name("directory-hash/bit-", bit), with_hash(hash ^ 1ull << bit));
  cases.fault("directory-hash/zero", with_hash(0));
  cases.fault("directory-hash/big-endian", with_hash(swapped(hash)));
  cases.fault("directory-hash/of-the-asset-table-alone", with_hash(hash64(bytes.subspan(64, 64))));
  cases.fault("directory-hash/of-the-directory-alone", with_hash(hash64(bytes.subspan(128, 192))));
  cases.fault("directory-hash/of-all-from-the-header", with_hash(hash64(bytes.first(320))));
  cases.fault("directory-hash/of-all-after-the-header", with_hash(hash64(bytes.subspan(64))));
  // Damage that makes another asset or chunk of it, as good as the one before.
  for (std::size_t i = 0; i < 5; ++i)
    cases.fault("directory-hash/damaged-name-" + to_string(i), damaged(file, 80 + i));
  for (std::size_t chunk = 0; chunk < 3; ++chunk)
    cases.fault("directory-hash/damaged-block-size-" + to_string(chunk),
                damaged(file, 128 + 64 * chunk + 14, 0x30));
}

}  // namespace

void add_header_cases(CaseList& cases) {
  cases.valid("header/tiny", "3.1", tiny().build());
  cases.valid("header/small", "3.1", small().build());
  add_magic_cases(cases);
  add_header_hash_cases(cases);
  add_header_size_cases(cases);
  add_header_count_cases(cases);
  add_directory_hash_cases(cases);
}

}  // namespace mesocell::test
