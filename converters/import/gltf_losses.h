#pragma once

#include <string>

#include "converters/import/gltf_json.h"
#include "converters/import/read_notes.h"

/// What normalize_gltf() leaves out of a glTF, which may hold anything.
namespace mesocell {

void note_material_losses(const Json& material, ReadNotes& notes);
/// `used_set`: the texture coordinates that its material wants, "TEXCOORD_0"; empty if none.
void note_attribute_losses(const Json& primitive, const std::string& used_set, ReadNotes& notes);
/// Of all that is not in meshes and materials.
void note_scene_losses(const Json& gltf, ReadNotes& notes);

}  // namespace mesocell
