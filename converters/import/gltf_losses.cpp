#include "converters/import/gltf_losses.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace mesocell {
namespace {

bool has_entries(const Json& object, const char* key) {
  const Json* found = member(object, key);
  return found && found->is_array() && !found->empty();
}

/// Whether an object has another member than these.
template <std::size_t N>
bool has_more(const Json& object, const std::array<std::string_view, N>& known) {
  if (!object.is_object()) return false;
  for (const auto& entry : object.items())
    if (std::find(known.begin(), known.end(), entry.key()) == known.end()) return true;
  return false;
}

}  // namespace

void note_material_losses(const Json& material, ReadNotes& notes) {
  constexpr std::array<std::string_view, 6> kKnown = {"name",        "pbrMetallicRoughness", "alphaMode",
                                                      "alphaCutoff", "doubleSided",          "extras"};
  constexpr std::array<std::string_view, 3> kKnownPbr = {"baseColorFactor", "baseColorTexture", "extras"};
  const Json* pbr = member(material, "pbrMetallicRoughness");
  if (has_more(material, kKnown) || (pbr && has_more(*pbr, kKnownPbr)))
    notes.lose("other properties of materials");
  const Json* alpha = member(material, "alphaMode");
  if (alpha && *alpha != "OPAQUE") notes.lose("alpha");
}

void note_attribute_losses(const Json& primitive, const std::string& used_set, ReadNotes& notes) {
  if (has_entries(primitive, "targets")) notes.lose("morph targets");
  const Json* attributes = member(primitive, "attributes");
  if (!attributes || !attributes->is_object()) return;
  for (const auto& entry : attributes->items()) {
    const std::string& name = entry.key();
    if (name == "POSITION" || name == "COLOR_0" || name == used_set) continue;
    if (name == "NORMAL")
      notes.lose("normals");
    else if (name == "TANGENT")
      notes.lose("tangents");
    else if (name.starts_with("TEXCOORD_"))
      notes.lose(used_set.empty() ? "texture coordinates" : "further texture coordinates");
    else if (name.starts_with("COLOR_"))
      notes.lose("further colors of vertices");
    else if (name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_"))
      notes.lose("skins");
    else
      notes.lose("other attributes of vertices");
  }
}

void note_scene_losses(const Json& gltf, ReadNotes& notes) {
  if (has_entries(gltf, "animations")) notes.lose("animations");
  if (has_entries(gltf, "cameras")) notes.lose("cameras");
  if (has_entries(gltf, "skins")) notes.lose("skins");
  const Json* scenes = member(gltf, "scenes");
  if (scenes && scenes->is_array() && scenes->size() > 1) notes.lose("other scenes");
  const Json* extensions = member(gltf, "extensions");
  const Json* lights = extensions ? member(*extensions, "KHR_lights_punctual") : nullptr;
  if (lights && has_entries(*lights, "lights")) notes.lose("lights");
}

}  // namespace mesocell
