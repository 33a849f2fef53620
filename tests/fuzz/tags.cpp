#include "format/cell_object_io.h"
#include "format/tag_reader.h"
#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

/// Tags read tile by tile: of a valid file those that the reader finds; of any other some or none.
namespace mesocell::fuzz {

std::vector<Bytes> seeds() {
  std::vector<Bytes> files = test::small_files();
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
    files.push_back(test::encoded(test::random_small_object(seed)));
  return files;
}

}  // namespace mesocell::fuzz

using namespace mesocell;
using namespace mesocell::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Exact exact(std::as_bytes(std::span(data, size)));
  SpanSource source(exact.bytes());
  const auto object = read_cell_object(exact.bytes(), kLimits);
  auto reader = TagReader::open(source, 0, kLimits);
  MESOCELL_FUZZ_CHECK(reader.ok() || !object.ok());
  if (!reader) return 0;
  const Index3& tiles = reader->grid().tiles;
  const std::uint64_t count = reader->grid().tile_count();
  // Some tiles from all of the grid.
  for (std::uint64_t i = 0, step = count / 16 + 1; i < count; i += step) {
    const Index3 tile = {std::uint32_t(i % tiles[0]), std::uint32_t(i / tiles[0] % tiles[1]),
                         std::uint32_t(i / tiles[0] / tiles[1])};
    const auto tags = reader->tags(tile);
    MESOCELL_FUZZ_CHECK(tags.ok() || !object.ok());
    if (!object) continue;
    MESOCELL_FUZZ_CHECK(tags->size() == object->tile.cell_count);
    for (std::uint32_t cell = 1; cell <= object->tile.cell_count; ++cell)
      MESOCELL_FUZZ_CHECK((*tags)[cell - 1] == object->membership.tag(i, cell));
  }
  return 0;
}
