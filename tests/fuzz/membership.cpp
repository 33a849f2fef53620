#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: the tiles of the grid, a byte an axis, the number of cells, 2 bytes, then a MEMB chunk.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  GridLayout grid;
  for (std::uint32_t& t : grid.tiles) t = 1 + input.number(1) % 16;
  TileMap tile;  // of which the number of cells alone matters
  tile.cell_count = std::max(1u, input.number(2));
  const auto decode = [&](const ChunkPayload& chunk, MemoryBudget& budget, IssueSink& sink) {
    return decode_membership(chunk, &grid, &tile, budget, sink);
  };
  fuzz::check_decoder(kMembershipChunk, input.rest(), decode, encode_membership);

  // As the validator calls it after faults in other chunks: any issues, and no result.
  const fuzz::Exact exact(input.rest());
  const ChunkPayload chunk = fuzz::raw_payload(kMembershipChunk, exact.bytes());
  for (const bool has_grid : {false, true}) {
    MemoryBudget budget(fuzz::kLimits);
    IssueSink sink = IssueSink::all(64);
    const auto maps =
        decode_membership(chunk, has_grid ? &grid : nullptr, has_grid ? nullptr : &tile, budget, sink);
    MESOCELL_FUZZ_CHECK(has_grid || !maps);
  }
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::vector<Bytes> seeds;
  for (std::uint64_t seed = 0; seed < 32; ++seed) {
    const MembershipMap membership = test::random_small_object(seed).membership;
    ByteWriter input;
    for (const std::uint32_t t : membership.tiles) input.u8(std::uint8_t(t - 1));
    input.u16(std::uint16_t(membership.cell_count));
    input.append(encode_membership(membership));
    seeds.push_back(input.release());
  }
  return seeds;
}
