#include "format/cell_object_chunks.h"
#include "tests/fuzz/fuzz.h"

// Input: a MESH chunk.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::check_decoder(
      kBasicMeshChunk, fuzz::Input(data, size).rest(),
      [](const ChunkPayload& chunk, MemoryBudget& budget, IssueSink& sink) {
        return decode_basic_mesh(chunk, budget, sink);
      },
      encode_basic_mesh);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::vector<Bytes> seeds;
  for (std::uint32_t bytes = 0; bytes < 200; bytes += 40)
    seeds.push_back(encode_basic_mesh({Bytes(bytes, std::byte{17}), 3 + bytes, 1 + bytes, 0.25f}));
  return seeds;
}
