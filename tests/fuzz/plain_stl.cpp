#include "tests/fuzz/plain_mesh_check.h"

// Input: an STL.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::check_plain_mesh(fuzz::Input(data, size).rest(), plain_stl);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::string binary = "solid or not" + std::string(72, '\0') + std::string(50, '\1');
  binary[80] = 1;
  return {to_bytes("solid a b\nfacet normal 0 nan 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                   "endloop\nendfacet\nendsolid a b\n"),
          to_bytes(binary)};
}
