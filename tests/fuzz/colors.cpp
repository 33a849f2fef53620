#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: the number of colors, 2 bytes, then a CCOL or ICOL chunk.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::uint32_t count = input.number(2);
  fuzz::check_decoder(
      kCellColorChunk, input.rest(),
      [&](const ChunkPayload& chunk, MemoryBudget& budget, IssueSink& sink) {
        return decode_colors(chunk, count, budget, sink);
      },
      encode_colors);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::vector<Bytes> seeds;
  for (std::uint64_t seed = 0; seed < 32; ++seed) {
    const auto list = test::random_small_object(seed).cell_colors;
    if (!list) continue;
    ByteWriter input;
    input.u16(std::uint16_t(list->colors.size()));
    input.append(encode_colors(*list));
    seeds.push_back(input.release());
  }
  return seeds;
}
