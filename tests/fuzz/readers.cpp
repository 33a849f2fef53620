#include <cstdio>

#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: a file. Reader, validator and loader must agree on it as it is and with hashes that fit.

using namespace mesocell;

namespace {

void check_verdicts(std::span<const std::byte> bytes) {
  const test::Verdicts v = test::verdicts(bytes, fuzz::kLimits);
  if (!v.agree) std::fprintf(stderr, "%s\n", v.why.c_str());
  MESOCELL_FUZZ_CHECK(v.agree);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = fuzz::Input(data, size).rest();
  check_verdicts(bytes);
  fuzz::Bytes resealed(bytes.begin(), bytes.end());
  test::reseal_chunks(resealed);
  if (!std::equal(resealed.begin(), resealed.end(), bytes.begin(), bytes.end())) check_verdicts(resealed);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() { return file_seeds(); }
