#include <algorithm>

#include "format/normal_map.h"
#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

namespace mesocell::test {
namespace {

using std::to_string;

TestFile with_normals(const CellObject& object) {
  NormalMap map;
  const std::uint64_t count = count_boundary_voxels(object.tile);
  for (std::uint64_t i = 0; i < count; ++i)
    map.normals.push_back({std::uint8_t(i * 5 % 253), std::uint8_t(252 - i % 253)});
  TestFile parts = TestFile::of(object);
  const Bytes payload = encode_normals(map);
  parts.chunks.back() = {kNormalChunk, 0, 0, payload.size(), payload};
  return parts;
}

}  // namespace

void add_normal_cases(CaseList& cases) {
  // All 24 voxels that are not empty have empty ones around them.
  const TestFile parts = with_normals(tiny_object());
  const std::size_t right = 64 + 2 * 24;
  cases.valid("norm/24", "4.8", parts.build());
  add_chunk_header_cases(cases, parts, kNormalChunk, 8);
  add_stated_error_cases(cases, parts, kNormalChunk, 4, "4.8");
  for (unsigned bit = 0; bit < 32; bit += 3)
    cases.fault("normal-encoding/bit-" + to_string(bit), with_bit(parts, kNormalChunk, 0, bit));
  cases.fault("normal-encoding/all-ones", with(parts, kNormalChunk, 0, 0xffffffff));
  for (std::size_t i = 0; i < 48; i += i < 4 || i > 44 ? 1 : 4) {
    cases.fault("normal-code/byte-" + to_string(i), with(parts, kNormalChunk, 64 + i, 253 + i % 3, 1));
    if (i % 8 == 0)
      cases.valid("norm/greatest-at-" + to_string(i), "4.8",
                  with(parts, kNormalChunk, 64 + i, i % 16 == 0 ? 252 : 251, 1));
  }
  cases.fault("normal-code/all", edited(parts, kNormalChunk, [](Bytes& bytes) {
                std::fill(bytes.begin() + 64, bytes.end(), std::byte{0xff});
              }));
  for (std::size_t bytes = 64; bytes < right; bytes += bytes < 67 || bytes > 108 ? 1 : 7)
    cases.fault("payload-truncated/norm-" + to_string(bytes), with_size(parts, kNormalChunk, bytes));
  for (const std::size_t more : {1u, 2u, 3u, 4u, 64u})
    cases.fault("payload-trailing/norm-" + to_string(right + more),
                with_size(parts, kNormalChunk, right + more));
  cases.fault("payload-trailing/norm-one-a-voxel", with_size(parts, kNormalChunk, 64 + 2 * 64));

  // What is a boundary: another piece of the same instance is none, the same cell of the next tile is one.
  CellObject solid = solid_object({4, 4, 4}, {2, 1, 1});
  cases.valid("norm/at-the-faces-of-the-tile", "4.8", with_normals(solid).build());
  cases.fault("payload-trailing/norm-of-inner-voxels",
              with_size(with_normals(solid), kNormalChunk, 64 + 2 * 64));
  cases.fault("payload-truncated/norm-without-the-faces", with_size(with_normals(solid), kNormalChunk, 64));
  CellObject halves = solid_object({6, 5, 4}, {2, 1, 1});
  halves.tile.pieces = {{1, {-1, 0, 0}}, {1, {0, 0, 0}}};
  for (std::size_t v = 0; v < halves.tile.voxel_ids.size(); ++v) halves.tile.voxel_ids[v] = v % 6 < 3 ? 1 : 2;
  cases.valid("norm/across-a-face", "4.8", with_normals(halves).build());
  cases.fault(
      "payload-trailing/norm-at-pieces",
      with_size(with_normals(halves), kNormalChunk, with_normals(halves).chunks.back().stored.size() + 12));
  CellObject corners = solid_object({4, 4, 4}, {2, 1, 1});
  corners.tile.voxel_ids.assign(64, 1);
  corners.tile.voxel_ids[21] = 0;  // one empty voxel: its 26 neighbours, around the torus or not
  cases.valid("norm/around-an-empty-voxel", "4.8", with_normals(corners).build());
  CellObject many = many_cells_object(200);
  cases.valid("norm/200-cells", "4.8", with_normals(many).build());
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const CellObject object =
        random_object(seed, {.resolution = {7, 6, 5}, .cells = 3, .block = 3, .texts = 0});
    const TestFile random = with_normals(object);
    cases.valid("norm/random-" + to_string(seed), "4.8", random.build());
    const std::size_t bytes = random.chunks.back().stored.size();
    cases.fault("payload-truncated/norm-random-" + to_string(seed),
                with_size(random, kNormalChunk, bytes - 2));
    cases.fault("payload-trailing/norm-random-" + to_string(seed),
                with_size(random, kNormalChunk, bytes + 2));
  }
}

}  // namespace mesocell::test
