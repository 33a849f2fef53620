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

/// Of those that materials have beside color and alpha; how light is computed (illum) is none.
bool is_other_property(std::string_view key) {
  constexpr std::array<std::string_view, 12> kKeys = {"Ka",   "Ks",   "Ke",    "Ns",   "Ni",   "Tf",
                                                      "bump", "disp", "decal", "refl", "norm", "sharpness"};
  return std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end() || key.starts_with("P") ||
         (key.starts_with("map_") && key != "map_d");
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
      materials.push_back({.name = std::move(name), .diffuse_map = {}});
      material = &materials.back();
    } else if (material && key == "Kd") {
      Vec3 color;
      bool numbers = true;
      for (std::size_t k = 0; k < 3; ++k) numbers = numbers && parse_number(next_word(line), color[k]);
      if (!numbers || !is_finite(color)) continue;
      for (std::size_t k = 0; k < 3; ++k) material->diffuse[k] = std::clamp(color[k], 0.0, 1.0);
    } else if (material && key == "map_Kd") {
      material->diffuse_map = without_options(line);
      material->has_map_options = trimmed(line).starts_with('-');
    } else if (material) {
      double x = 0;
      const bool number = parse_number(next_word(line), x);
      material->has_alpha = material->has_alpha || (key == "d" && number && x < 1) ||
                            (key == "Tr" && number && x > 0) || key == "map_d";
      material->has_more = material->has_more || is_other_property(key);
    }
  }
  return materials;
}

}  // namespace mesocell
