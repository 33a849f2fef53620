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
  const auto decoded = decompress_zstd(fuzz::raw_payload(kTileChunk, frame.bytes()), promised, sink);
  MESOCELL_FUZZ_CHECK(decoded.has_value() == (sink.errors() == 0));
  if (decoded) {
    // zstd's own idea of the frame.
    MESOCELL_FUZZ_CHECK(decoded->size() == promised);
    MESOCELL_FUZZ_CHECK(ZSTD_getFrameContentSize(frame.bytes().data(), frame.bytes().size()) == promised);
    fuzz::Bytes by_zstd(promised);
    MESOCELL_FUZZ_CHECK(
        ZSTD_decompress(by_zstd.data(), promised, frame.bytes().data(), frame.bytes().size()) == promised);
    MESOCELL_FUZZ_CHECK(by_zstd == *decoded);
  }

  // The bytes as what is to be compressed; seldom, since that takes a thousand times as long.
  if (input.rest().size() < 256 || promised % 64 != 0) return 0;
  if (const auto stored = compress_zstd(input.rest())) {
    IssueSink none = IssueSink::first_error();
    const auto back = decompress_zstd(fuzz::raw_payload(kTileChunk, *stored), input.rest().size(), none);
    MESOCELL_FUZZ_CHECK(back &&
                        std::equal(back->begin(), back->end(), input.rest().begin(), input.rest().end()));
  }
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
