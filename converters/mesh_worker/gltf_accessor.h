#pragma once

#include <array>
#include <vector>

#include "format/result.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/surface/surface_paint.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

namespace mesocell {

/// A primitive of triangles as arrays.
struct GltfPrimitive {
  std::vector<Vec3> positions;
  std::vector<Vec3> colors;  ///< linear light; one a position, or none
  std::vector<Uv> uvs;       ///< one a position, or none
  std::vector<Triangle> triangles;
};

/// All elements of an accessor, normalized if it is so; components that there are not are 0. All ranges are
/// checked again. Errors: kInvalidInput.
using GltfElement = std::array<double, 4>;
[[nodiscard]] Result<std::vector<GltfElement>> read_accessor(const tinygltf::Model& model, int index);

/// The greatest value of a component type; 1 of floats.
[[nodiscard]] double full_value(int component);

/// Reads a primitive's accessors, sparse ones too, or its Draco stream; strips and fans become triangles.
/// `set`: of texture coordinates that are wanted, -1 for none. All ranges are checked again. Errors:
/// kInvalidInput.
[[nodiscard]] Result<GltfPrimitive> read_primitive(const tinygltf::Model& model,
                                                   const tinygltf::Primitive& primitive, int set);

}  // namespace mesocell
