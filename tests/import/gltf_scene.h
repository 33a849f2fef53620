#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sdk/core/triangle_mesh.h"

/// glTF files for tests, made by hand.
namespace mesocell::test {

/// A glTF that grows: a JSON, and the one buffer that it has.
struct GltfScene {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
  std::string data;

  /// Adds bytes, aligned, as a view; returns its index.
  std::size_t view(const std::string& bytes, std::size_t stride = 0);
  /// Adds an accessor of a view's numbers; returns its index.
  std::size_t accessor(const std::string& bytes, int component, std::size_t count, const char* type,
                       bool normalized = false);
  /// Adds a mesh of one primitive and a node for it; returns the primitive.
  nlohmann::json& primitive(std::size_t positions);
  /// The whole of it in one file.
  [[nodiscard]] std::string glb() const;
  /// As text, with the buffer in `uri`, or as a data URI if that is empty.
  [[nodiscard]] std::string text(const std::string& uri = "") const;
};

/// Numbers as bytes, little-endian.
template <typename T>
[[nodiscard]] std::string packed(const std::vector<T>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T)};
}
[[nodiscard]] std::string packed_positions(const TriangleMesh& mesh);
[[nodiscard]] std::string base64(const std::string& bytes);

/// The triangles of a mesh with indices of 16 bits.
[[nodiscard]] GltfScene scene_of(const TriangleMesh& mesh);

/// A mesh compressed by Draco; unique ids are 0 of the positions and 1 of the colors, if it has some. As a
/// list of triangles without loss, or by its connectivity in 14 bits, which changes the order of points.
enum class DracoMethod : std::uint8_t { kSequential, kEdgebreaker };
enum class DracoNormals : std::uint8_t { kNone, kSome };
[[nodiscard]] std::string draco_bytes(const TriangleMesh& mesh, DracoMethod method = DracoMethod::kSequential,
                                      DracoNormals normals = DracoNormals::kNone);

}  // namespace mesocell::test
