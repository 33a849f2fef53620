#include "format/cell_object_io.h"
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
  const auto written = encode_cell_object(*object);
  MESOCELL_FUZZ_CHECK(written.ok());
  const auto again = read_cell_object(*written, fuzz::kLimits);
  MESOCELL_FUZZ_CHECK(again.ok() && *again == *object);
  const auto written_again = encode_cell_object(*again);
  MESOCELL_FUZZ_CHECK(written_again.ok() && *written_again == *written);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::vector<Bytes> seeds = test::small_files();
  for (std::uint64_t seed = 0; seed < 24; ++seed)
    seeds.push_back(test::encoded(test::random_small_object(seed)));
  return seeds;
}
