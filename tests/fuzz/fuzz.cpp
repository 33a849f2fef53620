#include "tests/fuzz/fuzz.h"

#include <cstdio>
#include <cstdlib>

#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"

namespace mesocell::fuzz {

std::vector<Bytes> file_seeds() {
  std::vector<Bytes> files = test::small_files();
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    files.push_back(test::encoded(test::random_small_object(seed)));
    // In blocks, as only large objects are.
    test::TestFile parts = test::TestFile::take_apart(files.back());
    for (test::TestChunk& chunk : parts.chunks)
      test::split(chunk, 4096, seed % 2 == 0 && chunk.type != kGridChunk);
    files.push_back(parts.build());
  }
  // Of 1.1, of which a third of those above are.
  CellObject with_mesh = test::random_small_object(12);
  for (const std::size_t bytes : {0u, 100u, 9000u}) {
    with_mesh.basic_mesh = BasicMesh{Bytes(bytes, std::byte{17}), 8, 12, 0.25f};
    files.push_back(test::encoded(with_mesh));
  }
  // Several pages of tiles, and several blocks of membership.
  test::TestFile pages =
      test::TestFile::take_apart(test::encoded(test::random_object(9, {.tiles = {20, 20, 30}, .cells = 3})));
  for (const bool compressed : {false, true}) {
    test::TestFile parts = pages;
    test::split(parts.chunk(kMembershipChunk), 4096, compressed);
    files.push_back(parts.build());
  }
  return files;
}

void fail(const char* source, int line, const char* promise) {
  std::fprintf(stderr, "%s:%d: broken promise: %s\n", source, line, promise);
  std::abort();
}

}  // namespace mesocell::fuzz
