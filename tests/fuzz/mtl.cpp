#include "converters/import/mtl.h"

#include "tests/fuzz/plain_mesh_check.h"

// Input: an MTL.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::Exact exact(fuzz::Input(data, size).rest());
  const std::string_view text(reinterpret_cast<const char*>(exact.bytes().data()), size);
  const std::vector<MtlMaterial> materials = parse_mtl(text);
  MESOCELL_FUZZ_CHECK(materials.size() <= size / 6);
  for (const MtlMaterial& material : materials)
    for (std::size_t k = 0; k < 3; ++k)
      MESOCELL_FUZZ_CHECK(material.diffuse[k] >= 0 && material.diffuse[k] <= 1);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  return {to_bytes("newmtl red one\nKd 1 0 0\nmap_Kd -s 1 2 3 -o 0.5 -mm 0 1 -clamp on a picture.png\n"),
          to_bytes("Kd 1 1 1\nnewmtl\nKd nan 2 -1\r\nnewmtl a\nnewmtl a\nmap_Kd -\n")};
}
