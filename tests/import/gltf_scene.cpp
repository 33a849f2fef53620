#include "tests/import/gltf_scene.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#pragma GCC diagnostic pop

namespace mesocell::test {
namespace {

void put(std::string& out, std::size_t n) { out += packed(std::vector<std::uint32_t>{std::uint32_t(n)}); }

void add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType number,
                   bool normalized, const std::string& values) {
  draco::GeometryAttribute attribute;
  const std::int64_t stride = std::int64_t(values.size() / mesh.num_points());
  attribute.Init(type, nullptr, 3, number, normalized, stride, 0);
  const int id = mesh.AddAttribute(attribute, true, mesh.num_points());
  for (std::uint32_t p = 0; p < mesh.num_points(); ++p)
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(p),
                                          values.data() + std::size_t(stride) * p);
}

}  // namespace

std::size_t GltfScene::view(const std::string& bytes, std::size_t stride) {
  data.resize((data.size() + 3) / 4 * 4);
  nlohmann::json added = {{"buffer", 0}, {"byteOffset", data.size()}, {"byteLength", bytes.size()}};
  if (stride > 0) added["byteStride"] = stride;
  json["bufferViews"].push_back(added);
  data += bytes;
  return json["bufferViews"].size() - 1;
}

std::size_t GltfScene::accessor(const std::string& bytes, int component, std::size_t count, const char* type,
                                bool normalized) {
  nlohmann::json added = {
      {"bufferView", view(bytes)}, {"componentType", component}, {"count", count}, {"type", type}};
  if (normalized) added["normalized"] = true;
  json["accessors"].push_back(added);
  return json["accessors"].size() - 1;
}

nlohmann::json& GltfScene::primitive(std::size_t positions) {
  json["nodes"].push_back({{"mesh", json["meshes"].size()}});
  json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", positions}}}}}}});
  return json["meshes"].back()["primitives"][0];
}

std::string GltfScene::glb() const {
  nlohmann::json whole = json;
  whole["buffers"] = nlohmann::json::array({{{"byteLength", data.size()}}});
  std::string text = whole.dump(), bytes = data, out = "glTF";
  text.resize((text.size() + 3) / 4 * 4, ' ');
  bytes.resize((bytes.size() + 3) / 4 * 4);
  put(out, 2);
  put(out, 28 + text.size() + bytes.size());
  put(out, text.size());
  out += "JSON" + text;
  put(out, bytes.size());
  return out + std::string("BIN\0", 4) + bytes;
}

std::string GltfScene::text(const std::string& uri) const {
  nlohmann::json whole = json;
  whole["buffers"] = nlohmann::json::array(
      {{{"byteLength", data.size()},
        {"uri", uri.empty() ? "data:application/octet-stream;base64," + base64(data) : uri}}});
  return whole.dump(1);
}

std::string packed_positions(const TriangleMesh& mesh) {
  std::vector<float> numbers;
  for (const Vec3& v : mesh.vertices)
    for (std::size_t a = 0; a < 3; ++a) numbers.push_back(float(v[a]));
  return packed(numbers);
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : std::uint8_t(0));
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

GltfScene scene_of(const TriangleMesh& mesh) {
  GltfScene scene;
  std::vector<std::uint16_t> indices;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) indices.push_back(std::uint16_t(v));
  const std::size_t positions = scene.accessor(packed_positions(mesh), 5126, mesh.vertices.size(), "VEC3");
  const std::size_t corners = scene.accessor(packed(indices), 5123, indices.size(), "SCALAR");
  scene.primitive(positions)["indices"] = corners;
  return scene;
}

std::string draco_bytes(const TriangleMesh& source, DracoMethod method, DracoNormals normals) {
  draco::Mesh mesh;
  mesh.set_num_points(std::uint32_t(source.vertices.size()));
  add_attribute(mesh, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, false, packed_positions(source));
  std::string colors;
  for (const Rgb8& color : source.colors)
    for (const std::uint8_t channel : color) colors += char(channel);
  if (!colors.empty()) add_attribute(mesh, draco::GeometryAttribute::COLOR, draco::DT_UINT8, true, colors);
  if (normals == DracoNormals::kSome)
    add_attribute(mesh, draco::GeometryAttribute::NORMAL, draco::DT_FLOAT32, false, packed_positions(source));
  for (const Triangle& t : source.triangles)
    mesh.AddFace({draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])});
  draco::Encoder encoder;
  const bool edges = method == DracoMethod::kEdgebreaker;
  encoder.SetEncodingMethod(edges ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  if (edges) encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok()) return {};
  return {buffer.data(), buffer.size()};
}

}  // namespace mesocell::test
