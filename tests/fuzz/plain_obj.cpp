#include "tests/fuzz/plain_mesh_check.h"

// Input: an OBJ.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::check_plain_mesh(fuzz::Input(data, size).rest(), plain_obj);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  return {to_bytes("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0 1 0.5 0\nf 1 2 3\nf -1 -2 -3 -4\n"),
          to_bytes("mtllib a b.mtl\nv 0 0 0\nv 1 0 nan\nv 0 1e999 0\nvt 0 1\nvt .5\nusemtl red one\n"
                   "f 1/1 2/2/1 3/-1\nusemtl\nf 1//1 \\\n 2 3 1 # x\nfo 1 2 3\n")};
}
