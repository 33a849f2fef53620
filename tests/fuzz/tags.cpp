#include "format/cell_object_io.h"
#include "format/tag_reader.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: a file, as it is and with hashes that fit. The tags of a valid asset, read tile by tile, are those
// that the reader finds; of any other they are some or none.

using namespace mesocell;
using namespace mesocell::fuzz;

namespace {

void check_asset(std::span<const std::byte> file, std::size_t asset) {
  SpanSource source(file);
  const auto object = read_cell_object(file, kLimits, asset);
  auto reader = TagReader::open(source, asset, kLimits);
  MESOCELL_FUZZ_CHECK(reader.ok() || !object.ok());
  if (!reader) return;
  const Index3& tiles = reader->grid().tiles;
  const std::uint64_t count = reader->grid().tile_count();
  // Some tiles from all of the grid.
  for (std::uint64_t i = 0, step = count / 16 + 1; i < count; i += step) {
    const Index3 tile = {std::uint32_t(i % tiles[0]), std::uint32_t(i / tiles[0] % tiles[1]),
                         std::uint32_t(i / tiles[0] / tiles[1])};
    const auto tags = reader->tags(tile);
    MESOCELL_FUZZ_CHECK(tags.ok() || !object.ok());
    if (!object) continue;
    MESOCELL_FUZZ_CHECK(tags->size() == reader->cell_count());
    for (std::uint32_t cell = 1; cell <= object->tile.cell_count; ++cell)
      MESOCELL_FUZZ_CHECK((*tags)[cell - 1] == object->membership.tag(i, cell));
  }
}

void check_file(std::span<const std::byte> bytes) {
  const Exact exact(bytes);
  // One more than most files have, so that one is asked for that is not there.
  for (std::size_t asset = 0; asset < 3; ++asset) check_asset(exact.bytes(), asset);
}

}  // namespace

std::vector<Bytes> fuzz::seeds() { return file_seeds(); }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = Input(data, size).rest();
  check_file(bytes);
  Bytes resealed(bytes.begin(), bytes.end());
  test::reseal_chunks(resealed);
  check_file(resealed);
  return 0;
}
