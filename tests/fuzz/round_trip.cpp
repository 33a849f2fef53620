#include "format/cell_object_io.h"

#include <algorithm>

#include "format/normal_map.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: a file. If it is valid, what is read is written and read again, and writing is a fixed point.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::Exact file(fuzz::Input(data, size).rest());
  const auto object = read_cell_object(file.bytes(), fuzz::kLimits);
  if (!object) {
    MESOCELL_FUZZ_CHECK(!object.error().message.empty() && !object.error().id.empty());
    return 0;
  }
  // What every user of an object asks it first.
  const auto box_max = object->box_max();
  for (std::size_t a = 0; a < 3; ++a) MESOCELL_FUZZ_CHECK(box_max[a] > object->grid.box_min[a]);
  MESOCELL_FUZZ_CHECK(count_inside_voxels(*object) <= object->grid.tile_count() * object->tile.voxel_count());
  MESOCELL_FUZZ_CHECK(inside_volume(*object) >= 0);  // 0 also where the voxels are tiny
  const auto boundary = boundary_voxels(object->tile);
  MESOCELL_FUZZ_CHECK(std::uint64_t(std::count(boundary.begin(), boundary.end(), 1)) ==
                      count_boundary_voxels(object->tile));
  const auto written = encode_cell_object(*object);
  MESOCELL_FUZZ_CHECK(written.ok());
  const auto again = read_cell_object(*written, fuzz::kLimits);
  MESOCELL_FUZZ_CHECK(again.ok() && *again == *object);
  const auto written_again = encode_cell_object(*again);
  MESOCELL_FUZZ_CHECK(written_again.ok() && *written_again == *written);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() { return file_seeds(); }
