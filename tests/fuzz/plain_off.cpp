#include "tests/fuzz/plain_mesh_check.h"

// Input: an OFF.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::check_plain_mesh(fuzz::Input(data, size).rest(), plain_off);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::string binary = "COFF BINARY\n";
  const auto number = [&](std::uint32_t n) {
    for (int shift = 24; shift >= 0; shift -= 8) binary += char(std::uint8_t(n >> shift));
  };
  for (const std::uint32_t n : {3u, 1u, 0u}) number(n);
  for (std::uint32_t i = 0; i < 21; ++i) number(0x3f80'0000 + (i << 20));
  for (const std::uint32_t n : {3u, 0u, 1u, 2u, 4u, 0u, 0u, 0x3f80'0000u, 0u}) number(n);
  return {to_bytes("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n"),
          to_bytes("STCNOFF # x\n4 2 0\n0 0 0 0 0 1 1 0 0 1 .5 .5\n1 0 0\n0 1 0 1 2 3 0.1 0.2 0.3\n1 1 nan\n"
                   "4 0 1 3 2 0.5 0.5 0.5 1\n3 0 1 2 7\n"),
          to_bytes(binary)};
}
