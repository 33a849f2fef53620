#include <cstddef>

#include "tests/faults/fault_child.h"

namespace mesocell::test {

std::vector<std::byte> saved_bytes(unsigned seed) {
  std::vector<std::byte> bytes(1000 + seed * 66599 % 200000);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::byte(i * 7 + i / 251 + seed * 101);
  return bytes;
}

}  // namespace mesocell::test
