#include <array>
#include <utility>

#include "format/container_scan.h"
#include "format/fourcc.h"
#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

/// Other versions: what a reader takes of later ones, and what it refuses. [spec 5]
namespace mesocell::test {
namespace {

using std::to_string;

/// small() with a chunk of an unknown type, in this version.
Bytes of_minor(std::uint32_t minor, std::size_t at = 10, std::uint64_t value = 0, unsigned bytes = 2) {
  TestFile parts = small();
  parts.chunks.push_back({fourcc("NEWS"), 0, 0, 8, bytes_of("a chunk!")});
  Bytes file = parts.build();
  put(file, 10, minor, 2);
  return patched(file, at, at == 10 ? minor : value, bytes);
}

Bytes newer(std::size_t at, std::uint64_t value, unsigned bytes = 4) { return of_minor(7, at, value, bytes); }

void add_later_minor_cases(CaseList& cases) {
  for (const std::uint32_t minor : {1u, 2u, 7u, 255u, 256u, 32768u, 65535u})
    cases.valid("version/1-" + to_string(minor), "5", of_minor(minor),
                minor > kFormatMinor ? "version-newer" : "chunk-unknown-skippable");
  Bytes plain = tiny().build();
  cases.valid("version/1-1-and-nothing-new", "5", patched(plain, 10, 1, 2));
  // All that may be set in a later minor version, one by one and at once.
  for (unsigned byte = 0; byte < 8; byte += 7) {
    cases.valid("version/header-byte-" + to_string(byte), "5", newer(48 + byte, 0x81, 1), "version-newer");
    cases.valid("version/asset-byte-" + to_string(byte), "5", newer(kAssetAt + 56 + byte, 0x81, 1),
                "version-newer");
    cases.valid("version/entry-byte-" + to_string(byte), "5", newer(entry_at(1) + 56 + byte, 0x81, 1),
                "version-newer");
  }
  for (unsigned bit = 16; bit < 32; bit += 5) {
    cases.valid("version/asset-flag-" + to_string(bit), "5", newer(kAssetAt + 4, 1u << bit), "version-newer");
    cases.valid("version/chunk-flag-" + to_string(bit), "5", newer(entry_at(0) + 4, 1 | 1u << bit),
                "version-newer");
  }
  Bytes all = of_minor(9);
  put(all, 48, ~0ull, 8);
  put(all, kAssetAt + 6, 0xffff, 2);
  put(all, kAssetAt + 56, ~0ull, 8);
  for (std::size_t chunk = 0; chunk < 5; ++chunk) {
    put(all, entry_at(chunk) + 6, 0xffff, 2);
    put(all, entry_at(chunk) + 56, ~0ull, 8);
  }
  all = patched(all, 10, 9, 2);
  cases.valid("version/all-that-may-be-set", "5", all, "version-newer");
  put(all, 10, 0, 2);
  reseal_header(all);
  cases.fault("extension-nonzero/all-that-may-be-set-later", all);
}

void add_refused_cases(CaseList& cases) {
  const Bytes plain = tiny().build();
  for (const std::uint32_t major : {0u, 2u, 3u, 10u, 255u, 256u, 257u, 32769u, 65535u}) {
    cases.fault("version-unsupported/" + to_string(major) + "-0", patched(plain, 8, major, 2));
    cases.fault("version-unsupported/" + to_string(major) + "-9",
                patched(patched(plain, 8, major, 2), 10, 9, 2));
  }
  cases.fault("version-unsupported/0-1", patched(patched(plain, 8, 0, 2), 10, 1, 2));
  cases.faults("header-hash/damaged-major", damaged(plain, 8, 2));
  cases.faults("header-hash/damaged-minor", damaged(plain, 10, 1));

  // What a reader must know it must know in every version; the file says 1.7.
  for (const unsigned bit : {0u, 7u, 16u, 31u})
    cases.fault("header-flags/in-1-7-bit-" + to_string(bit), newer(28, 1u << bit));
  for (const unsigned byte : {40u, 47u})
    cases.fault("header-reserved/in-1-7-byte-" + to_string(byte), newer(byte, 1, 1));
  for (const unsigned bit : {0u, 15u})
    cases.fault("asset-flags/in-1-7-bit-" + to_string(bit), newer(kAssetAt + 4, 1u << bit));
  for (const unsigned byte : {12u, 15u})
    cases.fault("asset-reserved/in-1-7-byte-" + to_string(byte), newer(kAssetAt + byte, 1, 1));
  for (const unsigned bit : {1u, 15u})
    cases.fault("chunk-flags/in-1-7-bit-" + to_string(bit), newer(entry_at(1) + 4, 1 | 1u << bit));
  for (const unsigned byte : {48u, 55u})
    cases.fault("chunk-reserved/in-1-7-byte-" + to_string(byte), newer(entry_at(1) + byte, 1, 1));
  cases.fault("chunk-codec/in-1-7", newer(entry_at(2) + 8, 2));
  cases.fault("chunk-codec/in-1-7-of-a-skippable-chunk", newer(entry_at(4) + 8, 2));
  cases.fault("representation-unknown/in-1-7", newer(kAssetAt, fourcc("SHEL")));
  cases.fault("chunk-unknown-critical/in-1-7", newer(entry_at(4) + 4, 1));
  cases.fault("chunk-criticality/in-1-7", newer(entry_at(3) + 4, 1));
  cases.fault("block-bytes/in-1-7", newer(entry_at(2) + 12, 1 << 24));
  cases.fault("chunk-hash/in-1-7-of-a-skippable-chunk", newer(entry_at(4) + 40, 1, 8));
  // Payloads have no bytes that may be ignored.
  const auto in_1_7 = [](Bytes file) { return patched(std::move(file), 10, 7, 2); };
  cases.fault("payload-reserved/in-1-7-grid", in_1_7(with(tiny(), kGridChunk, 60, 1)));
  cases.fault("payload-reserved/in-1-7-tile", in_1_7(with(tiny(), kTileChunk, 60, 1)));
  cases.fault("payload-reserved/in-1-7-memb", in_1_7(with(tiny(), kMembershipChunk, 60, 1)));
  cases.fault("piece-reserved/in-1-7", in_1_7(with(tiny(), kTileChunk, kPiecesAt + 5, 1, 1)));
  cases.fault("memb-rule/in-1-7", in_1_7(with(tiny(), kMembershipChunk, 0, 2)));
  cases.fault("payload-trailing/in-1-7-grid", in_1_7(with_size(tiny(), kGridChunk, 128)));
  cases.fault("header-hash/in-1-7", [&] {
    Bytes file = plain;
    put(file, 10, 7, 2);
    return file;
  }());
  cases.fault("padding-nonzero/in-1-7", damaged(newer(10, 7, 2), newer(10, 7, 2).size() - 1));
}

}  // namespace

void add_version_cases(CaseList& cases) {
  add_later_minor_cases(cases);
  add_refused_cases(cases);
}

}  // namespace mesocell::test
