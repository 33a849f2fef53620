#include "format/text_chunk.h"
#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: a TEXT chunk.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::check_decoder(
      kTextChunk, fuzz::Input(data, size).rest(),
      [](const ChunkPayload& chunk, MemoryBudget& budget, IssueSink& sink) {
        return decode_text(chunk, budget, sink);
      },
      encode_text);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::vector<Bytes> seeds = {encode_text({}), encode_text({{"name", "tiny"}})};
  for (std::uint64_t seed = 0; seed < 16; ++seed)
    seeds.push_back(encode_text(test::random_small_object(seed).metadata));
  return seeds;
}
