#include "tests/fuzz/plain_mesh_check.h"

// Input: a PLY.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::check_plain_mesh(fuzz::Input(data, size).rest(), plain_ply);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  const std::string vertices = "property float x\nproperty float y\nproperty float z\n";
  const std::string text =
      "ply\nformat ascii 1.0\ncomment TextureFile a b.png\nelement vertex 3\n" + vertices +
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\nproperty float t\n"
      "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
      "property int texnumber\nproperty float red\nproperty float green\nproperty float blue\nend_header\n"
      "0 0 0 255 0 0 0 0\n1 0 0 0 255 0 1 0\n0 1 0 0 0 255 0 1\n3 0 1 2 6 0 0 1 0 0 1 0 1 0 0.5\n";
  std::string strips = "ply\nformat binary_big_endian 1.0\nelement vertex 4\n" + vertices +
                       "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  strips += std::string(48, '\0');
  const auto number = [&](std::uint32_t n) {
    for (int shift = 24; shift >= 0; shift -= 8) strips += char(std::uint8_t(n >> shift));
  };
  for (const std::uint32_t n : {8u, 0u, 1u, 2u, 3u, 0xffff'ffffu, 2u, 1u, 0u}) number(n);
  return {to_bytes(text), to_bytes(strips)};
}
