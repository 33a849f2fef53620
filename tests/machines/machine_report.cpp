#include <zstd.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <string>

#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"
#include "format/cell_object_io.h"
#include "format/codec.h"
#include "format/file.h"
#include "format/hash.h"
#include "format/text_chunk.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"

// What this machine makes of objects and files, one line each, so that the lines of two machines can be
// compared:
//
//   mesocell_machine_report            objects made from seeds: encoded, and read back
//   mesocell_machine_report FILE...    files: read
//
// Exit code 1 if reader, validator and loader do not agree on something.

using namespace mesocell;
using namespace mesocell::test;

namespace {

bool all_agree = true;

/// Of the decoded maps, through the encoders of the chunks: what is hashed is little-endian and without
/// padding.
std::uint64_t hash_of_maps(const CellObject& object) {
  ByteWriter out;
  out.append(encode_grid(object.grid));
  out.append(encode_tile(object.tile));
  out.append(encode_membership(object.membership));
  if (object.color) out.append(encode_color(*object.color));
  if (object.cell_colors) out.append(encode_colors(*object.cell_colors));
  if (object.instance_colors) out.append(encode_colors(*object.instance_colors));
  if (object.normals) out.append(encode_normals(*object.normals));
  if (object.basic_mesh) out.append(encode_basic_mesh(*object.basic_mesh));
  if (object.surface_colors) out.append(encode_surface_colors(*object.surface_colors));
  out.append(encode_text(object.metadata));
  return hash64(out.bytes());
}

void report_file(const std::string& name, std::span<const std::byte> bytes) {
  std::printf("file %s: %zu bytes, hash %016" PRIx64 ", ", name.c_str(), bytes.size(), hash64(bytes));
  const Verdicts v = verdicts(bytes);
  if (!v.agree) {
    all_agree = false;
    std::printf("READERS DISAGREE: %s\n", v.why.c_str());
  } else if (const auto object = read_cell_object(bytes); object.ok()) {
    std::printf("valid, maps %016" PRIx64 "\n", hash_of_maps(*object));
  } else {
    std::printf("refused, %s, %s, %zu issues\n", v.reader_id.c_str(), v.loader_text.c_str(), v.issues.size());
  }
}

void report_objects() {
  report_file("walkthrough", encoded(walkthrough_object()));
  int number = 0;
  for (const Bytes& file : small_files()) report_file("small-" + std::to_string(number++), file);
  for (std::uint64_t seed = 0; seed < 200; ++seed)
    report_file("random-" + std::to_string(seed), encoded(random_small_object(seed)));
  // Damaged ones: the same faults are found, in the same order.
  Rng rng(20261122);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Bytes file = encoded(random_small_object(seed));
    for (int i = 0; i < 3; ++i) file[rng.below(std::uint32_t(file.size()))] ^= std::byte(1u << rng.below(8));
    report_file("damaged-" + std::to_string(seed), file);
  }
}

/// Tiles as large as those in use: their bytes hang on the hash tables of zstd. Each resolution takes another
/// path through its parameters.
void report_compression() {
  for (const std::uint32_t resolution : {16u, 32u, 64u, 128u}) {
    for (const std::uint32_t block : {1u, 4u, 16u}) {
      if (resolution >= 128 && block == 1) continue;  // noise, and slow
      RandomObjectOptions options;
      options.resolution = {resolution, resolution, resolution};
      options.cells = 40;
      options.block = block;
      Rng rng(resolution + block);
      const Bytes tile = encode_tile(random_tile(rng, options));
      Bytes stored;
      ZstdCompressor(tile.size()).compress(tile, stored);
      std::printf("zstd of a tile of %u voxels along an axis, blocks of %u: %zu bytes, hash %016" PRIx64 "; ",
                  resolution, block, tile.size(), hash64(tile));
      std::printf("%zu bytes, hash %016" PRIx64 "\n", stored.size(), hash64(stored));
    }
  }
}

}  // namespace

int main(int count, char** arguments) {
  std::printf("zstd %s\n", ZSTD_versionString());
  if (count == 1) {
    report_objects();
    report_compression();
  }
  for (int i = 1; i < count; ++i) {
    const std::string path = arguments[i];
    const auto bytes = read_file(path, ReadLimits{}.max_file_bytes);
    if (bytes)
      report_file(path, *bytes);
    else
      std::printf("file %s: %s\n", path.c_str(), bytes.error().message.c_str());
  }
  return all_agree ? 0 : 1;
}
