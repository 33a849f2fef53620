#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "converters/import/fan.h"
#include "converters/import/mesh_text.h"
#include "converters/import/plain_mesh.h"
#include "converters/import/ply_header.h"
#include "converters/import/vertex_color.h"

namespace mesocell {
namespace {

/// Reads values of the body one after the other; integers come as doubles, which hold 32 bits exactly.
class PlyValues {
 public:
  PlyValues(std::string_view body, PlyEncoding encoding) : body_(body), encoding_(encoding) {}

  [[nodiscard]] std::size_t left() const { return body_.size() - at_; }
  /// The fewest bytes that a value takes.
  [[nodiscard]] std::size_t least_bytes(PlyType type) const {
    return encoding_ == PlyEncoding::kText ? 1 : ply_type_bytes(type);
  }
  bool read(PlyType type, double& value) {
    return encoding_ == PlyEncoding::kText ? read_word(value) : read_binary(type, value);
  }

 private:
  bool read_word(double& value) {
    const auto separates = [](char c) { return is_blank(c) || c == '\n'; };
    while (at_ < body_.size() && separates(body_[at_])) ++at_;
    const std::size_t begin = at_;
    while (at_ < body_.size() && !separates(body_[at_])) ++at_;
    return parse_number(body_.substr(begin, at_ - begin), value);
  }
  bool read_binary(PlyType type, double& value) {
    const std::size_t bytes = ply_type_bytes(type);
    if (bytes > left()) return false;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < bytes; ++i) {
      const std::size_t shift = encoding_ == PlyEncoding::kLittleEndian ? i : bytes - 1 - i;
      bits |= std::uint64_t{std::uint8_t(body_[at_ + i])} << (8 * shift);
    }
    at_ += bytes;
    switch (type) {
      case PlyType::kInt8:
        value = double(std::int8_t(bits));
        break;
      case PlyType::kUint8:
        value = double(std::uint8_t(bits));
        break;
      case PlyType::kInt16:
        value = double(std::int16_t(bits));
        break;
      case PlyType::kUint16:
        value = double(std::uint16_t(bits));
        break;
      case PlyType::kInt32:
        value = double(std::int32_t(bits));
        break;
      case PlyType::kUint32:
        value = double(std::uint32_t(bits));
        break;
      case PlyType::kFloat32:
        value = double(std::bit_cast<float>(std::uint32_t(bits)));
        break;
      case PlyType::kFloat64:
        value = std::bit_cast<double>(bits);
        break;
    }
    return true;
  }

  std::string_view body_;
  PlyEncoding encoding_;
  std::size_t at_ = 0;
};

void append_bits(std::string& out, std::uint64_t bits, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) out += char(std::uint8_t(bits >> (8 * i)));
}

/// Which properties of the vertices are red, green and blue: `prefix` and these names. Nothing if one is
/// missing.
std::optional<std::array<std::size_t, 3>> find_color(const PlyElement& e, const std::string& prefix) {
  constexpr std::array<const char*, 3> kNames = {"red", "green", "blue"};
  std::array<std::size_t, 3> color{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto found = std::find_if(e.properties.begin(), e.properties.end(), [&](const PlyProperty& p) {
      return !p.is_list && p.name == prefix + kNames[k];
    });
    if (found == e.properties.end()) return std::nullopt;
    color[k] = std::size_t(found - e.properties.begin());
  }
  return color;
}

double full_channel(PlyType type) {
  if (type == PlyType::kFloat32 || type == PlyType::kFloat64) return 1;
  return type == PlyType::kUint16 ? 65535 : 255;
}

/// Walks over the body and writes vertices and triangles in plain form.
class PlyBody {
 public:
  PlyBody(const PlyHeader& header, std::string_view body, std::uint64_t vertices, const Progress* progress)
      : values_(body, header.encoding), vertices_(vertices), progress_(progress) {}

  std::optional<Error> element(const PlyElement& e, PlainMesh& mesh) {
    std::size_t least = 0;
    for (const PlyProperty& p : e.properties) least += values_.least_bytes(p.is_list ? p.count_type : p.type);
    if (least == 0) return std::nullopt;  // an element without properties takes no room
    if (e.count > values_.left() / least || e.count > kMaxMeshElements)
      return invalid_mesh(
          "the header promises " + std::to_string(e.count) + " elements '" + e.name +
          "', more than the rest of the file can hold; the file is cut off or damaged, fetch or "
          "export it again");
    std::optional<std::array<std::size_t, 3>> color_places;
    if (e.name == "vertex") color_places = find_color(e, "");
    if (e.name == "vertex" && !color_places) color_places = find_color(e, "diffuse_");
    std::vector<double> values(e.properties.size());  // of those that are no lists
    for (std::uint64_t i = 0; i < e.count; ++i) {
      if (stop_at(progress_, i)) return cancelled();
      Vec3 position;
      for (std::size_t k = 0; k < values.size(); ++k) {
        const PlyProperty& p = e.properties[k];
        const std::optional<Error> error =
            p.is_list ? list(e, p, i, mesh) : scalar(e, p, i, values[k], position);
        if (error) return error;
      }
      if (e.name == "vertex") {
        for (std::size_t axis = 0; axis < 3; ++axis)
          append_bits(points,
                      std::bit_cast<std::uint64_t>(library_holds(position[axis]) ? position[axis] : 0.0), 8);
        add_vertex(mesh, position, color_places ? color(e, values, *color_places) : std::nullopt);
      }
    }
    return std::nullopt;
  }

  std::string points, faces;  ///< in plain form

 private:
  static std::optional<Rgb8> color(const PlyElement& e, const std::vector<double>& values,
                                   const std::array<std::size_t, 3>& places) {
    std::array<double, 3> channels{};  // their types may differ
    for (std::size_t k = 0; k < 3; ++k)
      channels[k] = values[places[k]] / full_channel(e.properties[places[k]].type);
    return make_color(channels, 1);
  }
  static Error unreadable(const PlyElement& e, std::uint64_t i) {
    return invalid_mesh("element " + std::to_string(i) + " of '" + e.name +
                        "' is cut off or not a number; fetch or export the file again");
  }
  std::optional<Error> scalar(const PlyElement& e, const PlyProperty& p, std::uint64_t i, double& value,
                              Vec3& position) {
    if (!values_.read(p.type, value)) return unreadable(e, i);
    if (p.name == "x") position.x = value;
    if (p.name == "y") position.y = value;
    if (p.name == "z") position.z = value;
    return std::nullopt;
  }
  std::optional<Error> list(const PlyElement& e, const PlyProperty& p, std::uint64_t i, PlainMesh& mesh) {
    double count = 0;
    if (!values_.read(p.count_type, count)) return unreadable(e, i);
    if (!(count >= 0 && count <= double(values_.left() / values_.least_bytes(p.type))) ||
        count != std::floor(count))
      return invalid_mesh("the list '" + p.name + "' of element " + std::to_string(i) + " of '" + e.name +
                          "' is longer than the rest of the file; the file is damaged, export it again");
    const bool is_face = e.name == "face" && (p.name == "vertex_indices" || p.name == "vertex_index");
    polygon_.clear();
    for (std::uint64_t k = 0; k < std::uint64_t(count); ++k) {
      double value = 0;
      if (!values_.read(p.type, value)) return unreadable(e, i);
      if (!is_face) continue;
      if (!(value >= 0 && value < double(vertices_)) || value != std::floor(value))
        return invalid_mesh("face " + std::to_string(i) + " uses a vertex that is not there: the file has " +
                            std::to_string(vertices_) + "; export the mesh again");
      polygon_.push_back(std::uint32_t(value));
    }
    if (!is_face) return std::nullopt;
    ++mesh.polygons;
    cut_into_fan(polygon_, mesh.dropped_faces, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      faces += char(3);
      for (const std::uint32_t index : {a, b, c}) append_bits(faces, index, 4);
      ++mesh.triangles;
    });
    return std::nullopt;
  }

  PlyValues values_;
  std::uint64_t vertices_;
  const Progress* progress_;
  std::vector<std::uint32_t> polygon_;
};

/// Whether the header has what a mesh needs, each once.
std::optional<Error> check_elements(const PlyHeader& header, std::uint64_t& vertices) {
  int vertex_elements = 0, axes = 0, face_lists = 0;
  for (const PlyElement& e : header.elements) {
    if (e.name == "vertex") {
      ++vertex_elements;
      vertices = e.count;
      for (const PlyProperty& p : e.properties)
        if (!p.is_list && (p.name == "x" || p.name == "y" || p.name == "z")) ++axes;
    }
    if (e.name == "face")
      for (const PlyProperty& p : e.properties)
        if (p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index")) ++face_lists;
  }
  if (vertex_elements != 1 || axes != 3)
    return invalid_mesh("the PLY header does not describe vertices with x, y and z; export the mesh again");
  if (face_lists != 1)
    return invalid_mesh(
        "the PLY file has no faces with vertex_indices (a point cloud or triangle strips?); export a mesh of "
        "polygons");
  return std::nullopt;
}

}  // namespace

Result<PlainMesh> plain_ply(std::string_view bytes, const Progress* progress) {
  const Result<PlyHeader> header = parse_ply_header(bytes);
  if (!header) return header.error();
  std::uint64_t vertices = 0;
  if (std::optional<Error> error = check_elements(*header, vertices)) return *error;
  PlainMesh mesh;
  mesh.extension = "ply";
  PlyBody body(*header, bytes.substr(header->body), vertices, progress);
  for (const PlyElement& e : header->elements)
    if (std::optional<Error> error = body.element(e, mesh)) return *error;
  mesh.bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices) +
               "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
               std::to_string(mesh.triangles) + "\nproperty list uchar int vertex_indices\nend_header\n" +
               body.points + body.faces;
  return mesh;
}

}  // namespace mesocell
