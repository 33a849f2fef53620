#include <array>
#include <utility>

#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

namespace mesocell::test {
namespace {

using std::to_string;

Bytes text(const Metadata& metadata) { return tiny_with(kTextChunk, encode_text(metadata)).build(); }

/// TEXT of one entry, "name" and "tiny": count, two sizes, eight letters, 20 bytes.
TestFile one() { return small(); }

void add_valid_text_cases(CaseList& cases) {
  cases.valid("text/none", "4.4", text({}));
  cases.valid("text/empty-value", "4.4", text({{"k", ""}}));
  cases.valid("text/one-byte", "4.4", text({{"k", "v"}}));
  cases.valid("text/key-of-256", "4.4", text({{std::string(256, 'k'), "v"}}));
  cases.valid("text/key-of-255", "4.4", text({{std::string(255, 'k'), "v"}}));
  cases.valid("text/value-of-1000", "4.4", text({{"k", std::string(1000, 'v')}}));
  cases.valid("text/tab-and-line-feed", "4.4", text({{"k", "a\tb\nc"}}));
  cases.valid("text/letters-of-one-to-four-bytes", "4.4",
              text({{"\x7e", "~"},
                    {"\xc2\x80", "\xdf\xbf"},
                    {"\xe0\xa0\x80", "\xef\xbf\xbf"},
                    {"\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"}}));
  cases.valid("text/around-the-surrogates", "4.4", text({{"\xed\x9f\xbf", "\xee\x80\x80"}}));
  cases.valid("text/byte-order-mark", "4.4", text({{"\xef\xbb\xbfk", "\xef\xbb\xbf"}}));
  // Bytes decide: code units of UTF-16 would give another order.
  cases.valid(
      "text/order-of-bytes", "4.4",
      text({{"Z", ""}, {"a", ""}, {"aa", ""}, {"b", ""}, {"\xef\xbf\xbd", ""}, {"\xf0\x90\x80\x80", ""}}));
  Metadata many;
  for (int i = 100; i < 300; ++i) many.emplace_back("key " + to_string(i), to_string(i * i));
  cases.valid("text/two-hundred", "4.4", text(many));
  for (unsigned c = 0; c < 128; ++c) {
    if ((c >= 0x20 && c != 0x7f) || c == '\t' || c == '\n') continue;
    const std::string letter(1, char(c));
    if (c % 2 == 0 || c == 0x7f)
      cases.valid("text/control-" + to_string(c) + "-in-a-value", "4.4", text({{"k", "a" + letter}}),
                  "text-control");
    if (c % 4 == 3)
      cases.valid("text/control-" + to_string(c) + "-in-a-key", "4.4", text({{"k" + letter, ""}}),
                  "text-control");
  }
}

void add_entry_cases(CaseList& cases) {
  cases.fault("text-key/empty", text({{"", "v"}}));
  cases.fault("text-key/empty-with-an-empty-value", text({{"", ""}}));
  cases.fault("text-key/empty-and-more", text({{"", "v"}, {"k", "v"}}));
  cases.fault("text-key/257", text({{std::string(257, 'k'), "v"}}));
  cases.fault("text-key/258", text({{std::string(258, 'k'), "v"}}));
  cases.fault("text-key/512", text({{std::string(512, 'k'), "v"}}));
  cases.fault("text-key/86-letters-of-3-bytes", [] {
    std::string key;
    for (int i = 0; i < 86; ++i) key += "\xe2\x82\xac";
    return text({{key, "v"}});
  }());
  cases.fault("text-key/of-the-last", text({{"a", ""}, {"b", ""}, {std::string(257, 'k'), ""}}));
  for (const std::size_t at : {0u, 1u, 2u, 3u})
    cases.fault("text-key/zero-at-" + to_string(at), [&] {
      std::string key = "name";
      key[at] = 0;
      return text({{key, "tiny"}});
    }());
  for (const BadText& bad : bad_utf8()) {
    const std::string letters(bad.text);
    if (&bad - bad_utf8().data() < 4 || letters.size() > 2)
      cases.fault("text-utf8/key-" + std::string(bad.name), text({{letters, "v"}}));
    cases.fault("text-utf8/value-" + std::string(bad.name), text({{"k", letters}}));
  }
  cases.fault("text-utf8/value-after-1000-letters", text({{"k", std::string(1000, 'v') + "\xff"}}));
  cases.fault("text-utf8/letter-over-key-and-value", text({{"k\xc3", "\xa9"}}));
  cases.fault("text-utf8/of-the-second", text({{"a", ""}, {"b", "\x80"}}));
  cases.fault("text-utf8/key-of-256-cut", text({{std::string(255, 'k') + "\xc3", "v"}}));
  const std::array<std::pair<const char*, std::pair<std::string, std::string>>, 8> orders = {{
      {"same", {"a", "a"}},
      {"descending", {"b", "a"}},
      {"longer-first", {"ab", "a"}},
      {"case", {"a", "Z"}},
      {"signed-bytes", {"\xc3\xa9", "z"}},
      {"utf-16", {"\xf0\x90\x80\x80", "\xef\xbf\xbd"}},
      {"shorter-but-greater", {"b", "aa"}},
      {"last-letter", {"key 2", "key 10"}},
  }};
  for (const auto& [name, keys] : orders)
    cases.fault("text-order/" + std::string(name), text({{keys.first, "1"}, {keys.second, "2"}}));
  cases.fault("text-order/same-of-256", text({{std::string(256, 'k'), "1"}, {std::string(256, 'k'), "2"}}));
  cases.fault("text-order/same-with-the-same-value", text({{"a", "1"}, {"a", "1"}}));
  cases.fault("text-order/last-two-of-three", text({{"a", ""}, {"c", ""}, {"b", ""}}));
  cases.fault("text-order/first-and-third", text({{"b", ""}, {"c", ""}, {"b", ""}}));
  cases.fault("text-order/first-two-of-three", text({{"b", ""}, {"a", ""}, {"c", ""}}));
}

void add_text_size_cases(CaseList& cases) {
  for (std::size_t bytes = 0; bytes < 20; ++bytes)
    cases.fault("payload-truncated/text-" + to_string(bytes), with_size(one(), kTextChunk, bytes));
  for (const std::size_t bytes : {21u, 22u, 24u, 28u, 64u, 512u})
    cases.fault("payload-trailing/text-" + to_string(bytes), with_size(one(), kTextChunk, bytes));
  cases.fault("payload-trailing/text-of-no-entries", with(one(), kTextChunk, 0, 0));
  cases.fault("payload-trailing/text-of-no-entries-and-one-byte", tiny_with(kTextChunk, Bytes(5)).build());
  for (const std::uint32_t count : {2u, 3u, 257u, 65537u, 0x01000000u, 0x80000001u, 0xffffffffu})
    cases.fault("payload-truncated/text-count-" + to_string(count), with(one(), kTextChunk, 0, count));
  for (const std::uint32_t size :
       {9u, 260u, 65540u, 0x04000000u, 0x7fffffffu, 0x80000004u, 0xfffffffcu, 0xffffffffu}) {
    cases.fault("payload-truncated/text-key-of-" + to_string(size), with(one(), kTextChunk, 4, size));
    cases.fault("payload-truncated/text-value-of-" + to_string(size), with(one(), kTextChunk, 8, size));
  }
  cases.fault("payload-truncated/text-sizes-that-wrap", edited(one(), kTextChunk, [](Bytes& bytes) {
                put(bytes, 4, 0xfffffffc);
                put(bytes, 8, 12);
              }));
  cases.fault("payload-truncated/text-both-sizes-at-most",
              edited(one(), kTextChunk, [](Bytes& bytes) { put(bytes, 4, ~0ull, 8); }));
  cases.fault("payload-truncated/text-value-one-more", with(one(), kTextChunk, 8, 5));
  cases.fault("payload-trailing/text-value-one-less", with(one(), kTextChunk, 8, 3));
  cases.fault("payload-truncated/text-key-one-more", with(one(), kTextChunk, 4, 5));
  cases.fault("payload-trailing/text-key-one-less", with(one(), kTextChunk, 4, 3));
  cases.fault("payload-truncated/text-second-entry",
              tiny_with(kTextChunk,
                        [] {
                          Bytes bytes = encode_text({{"a", "1"}, {"b", "2"}});
                          bytes.pop_back();
                          return bytes;
                        }())
                  .build());
  // 473 bytes of chunks, 40 for pieces, 64 ids, 8 for tiles, a byte of tags, 132 for entries. [spec 6]
  const Bytes two = text({{"a", "1"}, {"b", "2"}});
  cases.limit("text-entries", two, {.max_decoded_bytes = 717});
  cases.valid("limits/text-entries", "6", two, {}, {.max_decoded_bytes = 718});
}

}  // namespace

void add_text_cases(CaseList& cases) {
  add_valid_text_cases(cases);
  add_entry_cases(cases);
  add_text_size_cases(cases);
}

}  // namespace mesocell::test
