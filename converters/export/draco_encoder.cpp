#include "converters/export/draco_encoder.h"

#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <cassert>
#include <limits>
#include <memory>
#include <new>
#include <string>

namespace mesocell {
namespace {

/// Adds an attribute, a value for each vertex; returns its place.
template <typename Value, typename At>
int add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType data,
                  bool normalized, std::uint32_t unique_id, std::uint32_t count, const At& at) {
  auto attribute = std::make_unique<draco::PointAttribute>();
  attribute->Init(type, std::int8_t(std::tuple_size_v<Value>), data, normalized, count);
  for (std::uint32_t v = 0; v < count; ++v) {
    const Value value = at(v);
    attribute->SetAttributeValue(draco::AttributeValueIndex(v), value.data());
  }
  const int place = mesh.AddAttribute(std::move(attribute));
  mesh.attribute(place)->set_unique_id(unique_id);
  return place;
}

Result<DracoMesh> encode(const DracoInput& in) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  if (in.vertex_count > kMost || in.triangle_count > kMost)
    return Error{ErrorCode::kLimit, "Draco takes at most 2^31 - 1 vertices and triangles; write without it"};
  assert(in.position_bits >= 1 && in.position_bits <= 30);
  draco::Mesh mesh;
  mesh.set_num_points(in.vertex_count);
  mesh.SetNumFaces(std::size_t(in.triangle_count));
  for (std::uint64_t k = 0; k < in.triangle_count; ++k) {
    const Triangle t = in.triangle(k);
    mesh.SetFace(draco::FaceIndex(std::uint32_t(k)),
                 {draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])});
  }
  using Float3 = std::array<float, 3>;
  using Color = std::array<std::uint16_t, 4>;
  const int position = add_attribute<Float3>(mesh, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32,
                                             false, kDracoPosition, in.vertex_count, in.position);
  int normal = -1;
  if (!in.normals.empty())
    normal =
        add_attribute<Float3>(mesh, draco::GeometryAttribute::NORMAL, draco::DT_FLOAT32, false, kDracoNormal,
                              in.vertex_count, [&](std::uint32_t v) { return in.normals[v]; });
  if (!in.colors.empty())
    add_attribute<Color>(mesh, draco::GeometryAttribute::COLOR, draco::DT_UINT16, true, kDracoColor,
                         in.vertex_count, [&](std::uint32_t v) { return in.colors[v]; });
  draco::ExpertEncoder encoder(mesh);
  encoder.SetTrackEncodedProperties(true);
  encoder.SetSpeedOptions(5, 5);
  encoder.SetEncodingMethod(in.keep_order ? draco::MESH_SEQUENTIAL_ENCODING
                                          : draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetAttributeExplicitQuantization(position, in.position_bits, 3, in.origin.data(), in.range);
  if (normal >= 0) encoder.SetAttributeQuantization(normal, 10);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeToBuffer(&buffer);
  if (!status.ok())
    return Error{ErrorCode::kInvalidInput, std::string("Draco cannot compress the mesh (") +
                                               status.error_msg() + "); write without it"};
  DracoMesh out;
  const auto* const bytes = reinterpret_cast<const std::byte*>(buffer.data());
  out.bytes.assign(bytes, bytes + buffer.size());
  out.vertices = encoder.num_encoded_points();
  out.triangles = encoder.num_encoded_faces();
  return out;
}

}  // namespace

Result<DracoMesh> encode_draco(const DracoInput& input) {
  try {
    return encode(input);
  } catch (const std::bad_alloc&) {
    return out_of_memory();
  }
}

}  // namespace mesocell
