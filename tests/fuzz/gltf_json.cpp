#include <cstring>

#include "converters/import/gltf_normal.h"
#include "tests/fuzz/plain_mesh_check.h"

// Input: the JSON of a glTF, up to a zero, then the second chunk of a GLB.

using namespace mesocell;

namespace {

Result<std::vector<std::byte>> read_any(const std::string& uri) {
  if (uri.find("none") != uri.npos) return Error{ErrorCode::kUnreadable, "there is no such file"};
  return std::vector<std::byte>(64, std::byte{1});
}

std::uint32_t number_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t n = 0;
  for (std::size_t i = 0; i < 4; ++i) n |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  return n;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::Exact exact(fuzz::Input(data, size).rest());
  const auto bytes = exact.bytes();
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t end = std::min(text.find('\0'), text.size());
  std::vector<MeshWarning> warnings;
  ReadNotes notes;
  const auto glb = normalize_gltf(text.substr(0, end), bytes.subspan(std::min(end + 1, bytes.size())),
                                  read_any, warnings, notes);
  if (!glb) {
    MESOCELL_FUZZ_CHECK(!glb.error().message.empty());
    return 0;
  }
  // What was made is whole, and sound once more: to the byte what is made of it again.
  const std::span<const std::byte> made(*glb);
  MESOCELL_FUZZ_CHECK(made.size() >= 28 && number_at(made, 8) == made.size());
  const std::size_t json_bytes = number_at(made, 12);
  MESOCELL_FUZZ_CHECK(json_bytes <= made.size() - 28);
  MESOCELL_FUZZ_CHECK(number_at(made, 20 + json_bytes) == made.size() - 28 - json_bytes);
  const std::string_view json(reinterpret_cast<const char*>(made.data()) + 20, json_bytes);
  std::vector<MeshWarning> none;
  const auto again = normalize_gltf(json, made.subspan(28 + json_bytes), read_any, none, notes);
  MESOCELL_FUZZ_CHECK(again.ok());
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  const std::string head = R"({"asset":{"version":"2.0"},)";
  std::string plain = head + R"("scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"children":[1],"scale":[1,-1,1]},{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2,"material":0,"mode":5}]}],
    "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0,1],"baseColorTexture":{"index":0,"texCoord":0,
      "extensions":{"KHR_texture_transform":{"offset":[0,1],"rotation":1.5,"scale":[0.5,0.5]}}}}}],
    "textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071}],
    "images":[{"uri":"none.png"},{"bufferView":1,"mimeType":"image/png"}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
      {"componentType":5126,"count":3,"type":"VEC2","sparse":{"count":1,"indices":{"bufferView":1,
        "componentType":5121},"values":{"bufferView":0}}},
      {"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":36,"byteStride":12},{"buffer":0,"byteOffset":36,"byteLength":4}],
    "buffers":[{"byteLength":40}]})";
  plain += std::string(41, '\0');
  const std::string draco = head + R"("extensionsRequired":["KHR_draco_mesh_compression"],
    "extensionsUsed":["KHR_draco_mesh_compression","KHR_texture_basisu"],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"extensions":{"KHR_draco_mesh_compression":
      {"bufferView":0,"attributes":{"POSITION":0}}}},{"mode":1,"attributes":{}}]}],
    "accessors":[{"componentType":5126,"count":3.0,"type":"VEC3","normalized":false}],
    "bufferViews":[{"buffer":1,"byteLength":3}],
    "buffers":[{"uri":"a.bin","byteLength":5},{"uri":"data:application/octet-stream;base64,AAEC","byteLength":3}]})";
  std::string instanced = head + R"("extensionsRequired":["EXT_mesh_gpu_instancing"],
    "nodes":[{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0,"ROTATION":1,
      "SCALE":0,"_COLOR_0":0,"_ID":2}}}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
      {"bufferView":0,"componentType":5122,"count":3,"type":"VEC4","normalized":true},
      {"componentType":5121,"count":3,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]})";
  instanced += std::string(37, '\0');
  return {to_bytes(plain), to_bytes(draco), to_bytes(instanced), to_bytes(head + "\"meshes\":[]}")};
}
