#include "format/container.h"

#include "format/validate.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: a file, read as it is and with hashes that fit.

using namespace mesocell;

namespace {

void check_container(std::span<const std::byte> bytes) {
  const fuzz::Exact file(bytes);
  const auto container = Container::open(file.bytes(), fuzz::kLimits);
  const ValidationReport report = validate(file.bytes(), fuzz::kLimits);
  if (!container) {
    MESOCELL_FUZZ_CHECK(!report.valid);
    MESOCELL_FUZZ_CHECK(report.capped ||
                        std::any_of(report.issues.begin(), report.issues.end(),
                                    [&](const Issue& issue) { return issue.id == container.error().id; }));
    return;
  }
  MESOCELL_FUZZ_CHECK(!container->assets().empty());
  for (std::size_t asset = 0; asset < container->assets().size(); ++asset) {
    if (!container->verify(asset)) MESOCELL_FUZZ_CHECK(!report.valid);
    MESOCELL_FUZZ_CHECK(!container->read_chunk(asset, 0).ok() || container->scan().find(asset, 0));
    for (const ChunkInfo& chunk : container->chunks_of(asset)) {
      MESOCELL_FUZZ_CHECK(chunk.offset <= bytes.size() && chunk.stored_bytes <= bytes.size() - chunk.offset);
      const auto decoded = container->read_chunk(asset, chunk.type);
      if (decoded) MESOCELL_FUZZ_CHECK(decoded->size() <= fuzz::kLimits.max_decoded_bytes);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = fuzz::Input(data, size).rest();
  check_container(bytes);
  fuzz::Bytes resealed(bytes.begin(), bytes.end());
  test::reseal_chunks(resealed);
  check_container(resealed);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() { return file_seeds(); }
