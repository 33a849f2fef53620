#include "format/codec.h"

#include <zstd.h>

#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: the promised size of what is decoded, 3 bytes, then a zstd frame.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::size_t promised = input.number(3) % (std::size_t{1} << 20);
  const fuzz::Exact frame(input.rest());
  IssueSink sink = IssueSink::first_error();
  static ZstdDecompressor decompressor;
  const auto decoded = std::make_unique<std::byte[]>(promised);
  const bool decodes =
      decompressor.decompress(fuzz::raw_payload(kTileChunk, frame.bytes()), {decoded.get(), promised}, sink);
  MESOCELL_FUZZ_CHECK(decodes == (sink.errors() == 0));
  if (decodes) {
    // zstd's own idea of the frame.
    MESOCELL_FUZZ_CHECK(ZSTD_getFrameContentSize(frame.bytes().data(), frame.bytes().size()) == promised);
    fuzz::Bytes by_zstd(promised);
    MESOCELL_FUZZ_CHECK(
        ZSTD_decompress(by_zstd.data(), promised, frame.bytes().data(), frame.bytes().size()) == promised);
    MESOCELL_FUZZ_CHECK(std::equal(by_zstd.begin(), by_zstd.end(), decoded.get()));
  }

  // The bytes as what is to be compressed; seldom, since that takes a thousand times as long.
  const auto rest = input.rest();
  if (rest.size() < 256 || promised % 64 != 0) return 0;
  fuzz::Bytes stored;
  ZstdCompressor(rest.size()).compress(rest, stored);
  MESOCELL_FUZZ_CHECK(stored.size() <= rest.size());
  if (stored.size() == rest.size()) return 0;  // they stay raw
  fuzz::Bytes back(rest.size());
  IssueSink none = IssueSink::first_error();
  MESOCELL_FUZZ_CHECK(decompressor.decompress(fuzz::raw_payload(kTileChunk, stored), back, none));
  MESOCELL_FUZZ_CHECK(std::equal(back.begin(), back.end(), rest.begin(), rest.end()));
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::vector<Bytes> seeds;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Bytes tile = encode_tile(test::random_small_object(seed).tile);
    for (const bool framed : {true, false}) {
      ByteWriter input;
      input.u16(framed ? std::uint16_t(tile.size()) : 0);
      input.u8(framed ? std::uint8_t(tile.size() >> 16) : 0);
      input.append(framed ? test::zstd_frame(tile, 1 + int(seed)) : tile);
      seeds.push_back(input.release());
    }
  }
  return seeds;
}
