#include "converters/import/mtl.h"

#include <algorithm>
#include <array>
#include <set>

#include "converters/import/mesh_text.h"

namespace mesocell {
namespace {

/// The picture's name: what comes after options, which may hold blanks.
std::string_view without_options(std::string_view rest) {
  for (;;) {
    rest = trimmed(rest);
    if (rest.empty() || rest[0] != '-') return rest;
    std::string_view after = rest;
    const std::string_view option = next_word(after);
    std::size_t most = 1, least = 1;
    if (option == "-mm") most = least = 2;
    if (option == "-o" || option == "-s" || option == "-t") most = 3;
    for (std::size_t k = 0; k < most; ++k) {
      std::string_view next = after;
      const std::string_view word = next_word(next);
      double number = 0;
      if (k >= least && !parse_number(word, number)) break;
      after = next;
    }
    rest = after;
  }
}

}  // namespace

std::vector<MtlMaterial> parse_mtl(std::string_view bytes) {
  std::vector<MtlMaterial> materials;
  std::set<std::string> names;
  MtlMaterial* material = nullptr;
  LineReader lines(bytes);
  std::string_view line;
  while (lines.next(line)) {
    const std::string_view key = next_word(line);
    if (key == "newmtl") {
      std::string name(trimmed(line));
      material = nullptr;
      if (!names.insert(name).second) continue;
      materials.push_back({std::move(name), {1, 1, 1}, {}});
      material = &materials.back();
    } else if (material && key == "Kd") {
      Vec3 color;
      bool numbers = true;
      for (std::size_t k = 0; k < 3; ++k) numbers = numbers && parse_number(next_word(line), color[k]);
      if (!numbers || !is_finite(color)) continue;
      for (std::size_t k = 0; k < 3; ++k) material->diffuse[k] = std::clamp(color[k], 0.0, 1.0);
    } else if (material && key == "map_Kd") {
      material->diffuse_map = without_options(line);
    }
  }
  return materials;
}

}  // namespace mesocell
