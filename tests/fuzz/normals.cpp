#include "format/normal_map.h"

#include <array>
#include <cmath>

#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: which tile, a byte, then a NORM chunk.

using namespace mesocell;

namespace {

constexpr std::uint32_t kTiles = 16;

/// Tiles of pieces that leave and enter, and one of a single cell that fills it and has no boundary.
const TileMap& tile_number(std::uint32_t number) {
  static const std::vector<TileMap> tiles = [] {
    std::vector<TileMap> made;
    for (std::uint32_t i = 0; i < kTiles; ++i) {
      test::RandomObjectOptions options;
      options.resolution = {4 + i % 3, 4, 5};
      options.cells = 1 + i % 3;
      options.block = 1 + i % 5;
      options.reach = int(i % 2);
      Rng rng(i);
      made.push_back(test::random_tile(rng, options));
    }
    return made;
  }();
  return tiles[number % kTiles];
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const TileMap& tile = tile_number(input.number(1));
  fuzz::check_decoder(
      kNormalChunk, input.rest(),
      [&](const ChunkPayload& chunk, MemoryBudget& budget, IssueSink& sink) {
        auto normals = decode_normals(chunk, &tile, budget, sink);
        for (const auto& code : normals ? normals->normals : std::vector<std::array<std::uint8_t, 2>>()) {
          const auto n = decode_normal(code);
          MESOCELL_FUZZ_CHECK(std::abs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-9);
          // Some directions have two codes.
          const auto again = decode_normal(encode_normal(n));
          MESOCELL_FUZZ_CHECK(n[0] * again[0] + n[1] * again[1] + n[2] * again[2] > 1 - 1e-9);
        }
        return normals;
      },
      encode_normals);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::vector<Bytes> seeds;
  for (std::uint32_t i = 0; i < kTiles; ++i) {
    NormalMap normals;
    normals.normals.resize(static_cast<std::size_t>(count_boundary_voxels(tile_number(i))), {126, 126});
    ByteWriter input;
    input.u8(std::uint8_t(i));
    input.append(encode_normals(normals));
    seeds.push_back(input.release());
  }
  return seeds;
}
