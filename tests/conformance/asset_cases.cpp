#include <array>
#include <utility>

#include "format/fourcc.h"
#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

namespace mesocell::test {
namespace {

using std::to_string;

constexpr std::size_t kNameAt = kAssetAt + 16;
constexpr std::size_t kSecondAt = kAssetAt + 64;

/// Two assets of three chunks each.
Bytes two(std::string first, std::string second) {
  return joined({named(tiny(), std::move(first)), named(tiny(), std::move(second))});
}

/// The first asset's name field as these bytes, whatever they are.
Bytes with_name(std::string_view bytes) {
  Bytes file = tiny().build();
  for (std::size_t i = 0; i < bytes.size(); ++i)
    put(file, kNameAt + i, static_cast<unsigned char>(bytes[i]), 1);
  reseal_directory(file);
  return file;
}

void add_name_cases(CaseList& cases) {
  const std::string longest(40, 'n');
  cases.valid("asset-name/one-letter", "3.2", with_name("a"));
  cases.valid("asset-name/40-bytes", "3.2", with_name(longest));
  cases.valid("asset-name/39-bytes", "3.2", with_name(longest.substr(1)));
  cases.valid("asset-name/blank", "3.2", with_name(" "));
  cases.valid("asset-name/control", "3.2", with_name("\x01\x7f\n"));
  cases.valid("asset-name/two-byte-letters", "3.2", with_name("\xc2\x80\xdf\xbf"));
  cases.valid("asset-name/three-byte-letters", "3.2",
              with_name("\xe0\xa0\x80\xed\x9f\xbf\xee\x80\x80\xef\xbf\xbf"));
  cases.valid("asset-name/four-byte-letters", "3.2", with_name("\xf0\x90\x80\x80\xf4\x8f\xbf\xbf"));
  cases.valid("asset-name/ends-with-a-letter-of-four-bytes", "3.2",
              with_name(longest.substr(4) + "\xf0\x9f\x90\xb0"));
  cases.valid("asset-name/byte-order-mark", "3.2", with_name("\xef\xbb\xbfx"));
  for (const BadText& bad : bad_utf8()) {
    const std::string text(bad.text);
    cases.fault("asset-name/" + std::string(bad.name), with_name(text));
    if (bad.name.starts_with("short"))
      cases.fault("asset-name/end-" + std::string(bad.name), with_name(longest.substr(text.size()) + text));
  }
  for (std::size_t gap = 0; gap < 39; gap += 4) {
    const std::string name = longest.substr(0, gap);
    cases.fault("asset-name/zero-at-" + to_string(gap), with_name(name + std::string("\0z", 2)));
  }
  for (std::size_t at = 2; at < 39; at += 6)
    cases.fault("asset-name/late-byte-" + to_string(at + 1), [&] {
      Bytes file = with_name("a");
      put(file, kNameAt + at + 1, 1, 1);
      reseal_directory(file);
      return file;
    }());
  cases.fault("asset-name/of-the-second", patched(two("a", "b"), kSecondAt + 16, 0xff, 1));

  cases.valid("asset-name/two", "3.2", two("a", "b"));
  cases.valid("asset-name/two-by-the-last-byte", "3.2", two(longest, longest.substr(1) + "m"));
  cases.valid("asset-name/two-by-case", "3.2", two("a", "A"));
  cases.valid("asset-name/two-by-length", "3.2", two("a", "aa"));
  cases.valid("asset-name/two-by-a-blank", "3.2", two("a", "a "));
  cases.valid("asset-name/two-by-composition", "3.2", two("\xc3\xa9", "e\xcc\x81"));
  cases.fault("asset-name-duplicate/two", two("a", "a"));
  cases.fault("asset-name-duplicate/40-bytes", two(longest, longest));
  cases.fault("asset-name-duplicate/39-bytes", two(longest.substr(1), longest.substr(1)));
  cases.fault("asset-name-duplicate/letters", two("\xc3\xa9", "\xc3\xa9"));
  const TestFile a = named(tiny(), "a"), b = named(tiny(), "b"), none = tiny();
  cases.fault("asset-name-duplicate/first-and-third", joined({a, b, a}));
  cases.fault("asset-name-duplicate/second-and-third", joined({b, a, a}));
  cases.fault("asset-name-duplicate/all-of-three", joined({a, a, a}));
  cases.fault("asset-name-duplicate/with-one-that-has-none", joined({a, none, a}));
  cases.valid("asset-name/first-missing", "3.2", two("", "b"), "asset-name-missing");
  cases.valid("asset-name/second-missing", "3.2", two("a", ""), "asset-name-missing");
  cases.valid("asset-name/both-missing", "3.2", two("", ""), "asset-name-missing");
  cases.valid("asset-name/three-with-two-missing", "3.2", joined({none, a, none}), "asset-name-missing");
}

void add_count_cases(CaseList& cases) {
  const Bytes one = tiny().build();
  const std::array<std::pair<const char*, std::uint32_t>, 7> counts = {{{"none", 0},
                                                                        {"one-less", 2},
                                                                        {"one-more", 4},
                                                                        {"plus-4096", 4099},
                                                                        {"plus-65536", 65539},
                                                                        {"sign-bit", 0x80000003},
                                                                        {"all-ones", 0xffffffff}}};
  for (const auto& [name, count] : counts)
    cases.fault("asset-chunk-count/" + std::string(name), patched(one, kAssetAt + 8, count));
  const auto counted = [](std::uint32_t first, std::uint32_t second) {
    return patched(patched(two("a", "b"), kAssetAt + 8, first), kSecondAt + 8, second);
  };
  cases.fault("asset-chunk-count/first-of-two-has-none", counted(0, 6));
  cases.fault("asset-chunk-count/second-of-two-has-none", counted(6, 0));
  cases.fault("asset-chunk-count/two-one-less", counted(3, 2));
  cases.fault("asset-chunk-count/two-one-more", counted(4, 3));
  cases.fault("asset-chunk-count/both-all", counted(6, 6));
  // Sums that are right in 32 bits.
  cases.fault("asset-chunk-count/wraps-1", counted(0xffffffff, 7));
  cases.fault("asset-chunk-count/wraps-2", counted(0x80000003, 0x80000003));
  cases.fault("asset-chunk-count/wraps-3", counted(3, 0xffffffff));
  // Sums that are right, and chunks at the wrong asset.
  cases.faults("chunk-missing/one-chunk-given-to-the-second", counted(2, 4));
  cases.faults("chunk-duplicate/one-chunk-taken-from-the-second", counted(4, 2));
}

}  // namespace

void add_asset_cases(CaseList& cases) {
  const Bytes file = tiny().build();
  for (unsigned bit = 0; bit < 16; ++bit)
    cases.fault("asset-flags/bit-" + to_string(bit), flipped(file, kAssetAt + 4 + bit / 8, 1u << bit % 8));
  for (unsigned bit = 16; bit < 32; bit += 3)
    cases.fault("extension-nonzero/asset-flag-" + to_string(bit),
                flipped(file, kAssetAt + 4 + bit / 8, 1u << bit % 8));
  for (unsigned bit = 0; bit < 32; bit += 5)
    cases.fault("asset-reserved/bit-" + to_string(bit),
                flipped(file, kAssetAt + 12 + bit / 8, 1u << bit % 8));
  for (unsigned bit = 0; bit < 64; bit += 7)
    cases.fault("extension-nonzero/asset-bit-" + to_string(bit),
                flipped(file, kAssetAt + 56 + bit / 8, 1u << bit % 8));
  for (unsigned bit = 0; bit < 32; bit += 3)
    cases.fault("representation-unknown/bit-" + to_string(bit),
                flipped(file, kAssetAt + bit / 8, 1u << bit % 8));
  cases.fault("representation-unknown/zero", patched(file, kAssetAt, 0));
  cases.fault("representation-unknown/all-ones", patched(file, kAssetAt, 0xffffffff));
  cases.fault("representation-unknown/reversed", patched(file, kAssetAt, fourcc("LLEC")));
  cases.fault("representation-unknown/shel", patched(file, kAssetAt, fourcc("SHEL")));

  const Bytes pair = two("a", "b");
  cases.fault("asset-flags/of-the-second", flipped(pair, kSecondAt + 4, 1));
  cases.fault("asset-reserved/of-the-second", flipped(pair, kSecondAt + 15, 0x80));
  cases.fault("extension-nonzero/flag-of-the-second", flipped(pair, kSecondAt + 7, 0x80));
  cases.fault("extension-nonzero/byte-of-the-second", flipped(pair, kSecondAt + 63, 0x80));
  cases.fault("representation-unknown/of-the-second", patched(pair, kSecondAt, fourcc("SHEL")));
  add_name_cases(cases);
  add_count_cases(cases);
  TestFile c = named(small(), "c"), d = named(TestFile::of(solid_object({4, 5, 6}, {1, 2, 3})), "d");
  cases.valid("asset/three-of-different-sizes", "3.2", joined({named(tiny(), "a"), c, d}));
  std::vector<TestFile> many;
  for (int i = 0; i < 5; ++i) many.push_back(named(tiny(), "asset " + to_string(i)));
  cases.valid("asset/five", "3.2", joined(many));
  // At 1024 assets the file has 852 kB: made at test time alone, and without names, which are compared each
  // with each whenever an asset is read.
  many.assign(1024, tiny());
  cases.valid("asset/1024", "3.2", joined(many), "asset-name-missing");
  many.push_back(tiny());
  cases.fault("asset-count/really-1025", joined(many));
}

}  // namespace mesocell::test
