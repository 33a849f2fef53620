#include "converters/mesh_worker/draco_mesh.h"

#include <memory>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>
#pragma GCC diagnostic pop

namespace mesocell {
namespace {

Error damaged(const std::string& why) {
  return {ErrorCode::kInvalidInput,
          "the mesh that Draco compressed cannot be decoded (" + why + "); fetch or export it again"};
}

/// The greatest value of an integer type; 0 of types that are not read.
double full_draco_value(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return 127;
    case draco::DT_UINT8:
      return 255;
    case draco::DT_INT16:
      return 32767;
    case draco::DT_UINT16:
      return 65535;
    case draco::DT_INT32:
      return 2147483647.0;
    case draco::DT_UINT32:
      return 4294967295.0;
    case draco::DT_FLOAT32:
    case draco::DT_FLOAT64:
      return 1;
    default:
      return 0;
  }
}

template <typename T>
bool read_values(const draco::PointAttribute& attribute, std::uint32_t points, DracoValues& out) {
  out.values.resize(points);
  for (std::uint32_t p = 0; p < points; ++p) {
    const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(p));
    std::array<T, 4> values{};
    if (index.value() >= attribute.size() ||
        !attribute.ConvertValue<T>(index, std::int8_t(out.components), values.data()))
      return false;
    for (std::size_t k = 0; k < 4; ++k) out.values[p][k] = double(values[k]);
  }
  return true;
}

bool read_attribute(const draco::PointAttribute& attribute, std::uint32_t points, DracoValues& out) {
  out.components = attribute.num_components();
  out.full = full_draco_value(attribute.data_type());
  if (out.components < 1 || out.components > 4 || out.full == 0) return false;
  switch (attribute.data_type()) {
    case draco::DT_FLOAT32:
    case draco::DT_FLOAT64:
      return read_values<double>(attribute, points, out);
    case draco::DT_UINT32:
      return read_values<std::uint32_t>(attribute, points, out);
    default:
      return read_values<std::int32_t>(attribute, points, out);
  }
}

const char* attribute_name(draco::GeometryAttribute::Type type) {
  return type == draco::GeometryAttribute::NORMAL      ? "normals"
         : type == draco::GeometryAttribute::TEX_COORD ? "texture coordinates"
                                                       : "other attributes of vertices";
}

}  // namespace

Result<DracoMesh> decode_draco(std::span<const std::byte> bytes, std::span<const std::uint32_t> ids) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto type = draco::Decoder::GetEncodedGeometryType(&buffer);
  if (!type.ok()) return damaged(type.status().error_msg_string());
  if (type.value() != draco::TRIANGULAR_MESH)
    return Error{ErrorCode::kInvalidInput, "the file is a point cloud that Draco compressed, not a mesh"};
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) return damaged(decoded.status().error_msg_string());
  const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();

  DracoMesh result;
  result.points = mesh->num_points();
  for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f) {
    Triangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] = mesh->face(f)[k].value();
      if (triangle[k] >= result.points) return damaged("a face uses a point that is not there");
    }
    result.triangles.push_back(triangle);
  }
  std::vector<const draco::PointAttribute*> wanted;
  for (const std::uint32_t id : ids) {
    wanted.push_back(mesh->GetAttributeByUniqueId(id));
    if (!wanted.back()) return damaged("it has no attribute " + std::to_string(id));
  }
  if (ids.empty()) {
    wanted = {mesh->GetNamedAttribute(draco::GeometryAttribute::POSITION),
              mesh->GetNamedAttribute(draco::GeometryAttribute::COLOR)};
    if (!wanted[0]) return damaged("it has no positions");
    for (std::int32_t i = 0; i < mesh->num_attributes(); ++i)
      if (const draco::PointAttribute* other = mesh->attribute(i); other != wanted[0] && other != wanted[1])
        result.notes.lose(attribute_name(other->attribute_type()));
  }
  for (const draco::PointAttribute* attribute : wanted) {
    result.attributes.emplace_back();
    if (attribute && !read_attribute(*attribute, result.points, result.attributes.back()))
      return damaged("an attribute is damaged or of a type that is not read");
  }
  return result;
}

}  // namespace mesocell
