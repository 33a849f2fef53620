#include "converters/import/mesh_format.h"

#include <algorithm>
#include <array>

#include "converters/image/extension.h"
#include "converters/import/mesh_text.h"
#include "converters/import/sniff.h"

namespace mesocell {
namespace {

constexpr std::array<MeshFormat, 7> kFormats = {{
    {MeshKind::kObj, ".obj", "OBJ", plain_obj},
    {MeshKind::kOff, ".off", "OFF", plain_off},
    {MeshKind::kPly, ".ply", "PLY", plain_ply},
    {MeshKind::kStl, ".stl", "STL", plain_stl},
    {MeshKind::kGltf, ".gltf", "glTF", nullptr},
    {MeshKind::kGlb, ".glb", "GLB", nullptr},
    {MeshKind::kDraco, ".drc", "Draco", nullptr},
}};

const MeshFormat* find(MeshKind kind) {
  return &*std::find_if(kFormats.begin(), kFormats.end(),
                        [&](const MeshFormat& f) { return f.kind == kind; });
}

/// An OBJ has no mark: its first statement, and one of a vertex among the first, must be its.
bool is_obj(std::string_view bytes) {
  constexpr std::array<std::string_view, 9> kFirst = {"v", "vt",     "vn",     "o", "g",
                                                      "s", "mtllib", "usemtl", "f"};
  LineReader lines(bytes.substr(0, 65536));
  std::string_view line;
  bool begun = false;
  while (lines.next(line)) {
    const std::string_view key = next_word(line);
    if (key.empty() || key[0] == '#') continue;
    if (!begun && std::find(kFirst.begin(), kFirst.end(), key) == kFirst.end()) return false;
    begun = true;
    double x = 0;
    if (key == "v") return parse_number(next_word(line), x);
  }
  return false;
}

}  // namespace

const MeshFormat* format_by_extension(const std::string& path) {
  const std::string extension = lower_extension(path);
  for (const MeshFormat& format : kFormats)
    if (format.extension == extension) return &format;
  return nullptr;
}

const MeshFormat* format_by_content(std::string_view bytes, std::string_view& other) {
  const std::string_view content = sniff_content(bytes);
  if (content == kPlyContent) return find(MeshKind::kPly);
  if (content == kOffContent) return find(MeshKind::kOff);
  if (content == kGlbContent) return find(MeshKind::kGlb);
  if (content == kGltfContent) return find(MeshKind::kGltf);
  if (content == kDracoContent) return find(MeshKind::kDraco);
  if (is_binary_stl(bytes)) return find(MeshKind::kStl);
  if (!content.empty()) {
    other = content;
    return nullptr;
  }
  if (is_text_stl(bytes) && bytes.substr(0, 4096).find("facet") != bytes.npos) return find(MeshKind::kStl);
  return is_obj(bytes) ? find(MeshKind::kObj) : nullptr;
}

}  // namespace mesocell
