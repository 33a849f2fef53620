#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
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

/// Index of a property that is no list.
std::optional<std::size_t> find_scalar(const PlyElement& e, std::initializer_list<std::string_view> names) {
  for (std::size_t k = 0; k < e.properties.size(); ++k)
    for (const std::string_view name : names)
      if (!e.properties[k].is_list && e.properties[k].name == name) return k;
  return std::nullopt;
}

bool is_vertex_list(const PlyProperty& p) {
  return p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
}

/// What an element's properties that are no lists mean.
struct PlyPlaces {
  std::optional<std::array<std::size_t, 3>> color;
  std::optional<std::size_t> u, v, picture, alpha;

  explicit PlyPlaces(const PlyElement& e) {
    if (e.name != "vertex" && e.name != "face") return;
    color = find_color(e, "");
    if (!color) color = find_color(e, "diffuse_");
    if (color) alpha = find_scalar(e, {"alpha"});
    picture = find_scalar(e, {"texnumber"});
    if (e.name != "vertex") return;
    u = find_scalar(e, {"s", "u", "texture_u"});
    v = find_scalar(e, {"t", "v", "texture_v"});
  }
};

/// Texture coordinates begin at the lower left.
Uv make_uv(double u, double v) {
  const float s = float(u), t = float(1 - v);
  return std::isfinite(s) && std::isfinite(t) ? Uv{s, t} : Uv{0, 0};
}

/// Walks over the body and writes vertices and triangles in plain form.
class PlyBody {
 public:
  PlyBody(const PlyHeader& header, std::string_view body, std::uint64_t vertices, const Progress* progress)
      : values_(body, header.encoding),
        vertices_(vertices),
        textures_(header.textures.size()),
        progress_(progress) {}

  std::optional<Error> element(const PlyElement& e, PlainMesh& mesh) {
    std::size_t least = 0;
    for (const PlyProperty& p : e.properties) least += values_.least_bytes(p.is_list ? p.count_type : p.type);
    if (least == 0) return std::nullopt;  // an element without properties takes no room
    if (e.count > values_.left() / least || e.count > kMaxMeshElements)
      return invalid_mesh(
          "the header promises " + std::to_string(e.count) + " elements '" + e.name +
          "', more than the rest of the file can hold; the file is cut off or damaged, fetch or "
          "export it again");
    const PlyPlaces places(e);
    if (e.count > 0) note_losses(e, places, mesh.notes);
    std::vector<double> values(e.properties.size());  // of those that are no lists
    for (std::uint64_t i = 0; i < e.count; ++i) {
      if (stop_at(progress_, i)) return cancelled();
      Vec3 position;
      polygon_.clear();
      corner_uvs_.clear();
      for (std::size_t k = 0; k < values.size(); ++k) {
        const PlyProperty& p = e.properties[k];
        const std::optional<Error> error = p.is_list ? list(e, p, i) : scalar(e, p, i, values[k], position);
        if (error) return error;
      }
      alpha_ =
          alpha_ || (places.alpha && values[*places.alpha] < full_channel(e.properties[*places.alpha].type));
      const std::optional<Rgb8> own = places.color ? color(e, values, *places.color) : std::nullopt;
      if (e.name == "vertex") {
        for (std::size_t axis = 0; axis < 3; ++axis)
          append_bits(points,
                      std::bit_cast<std::uint64_t>(library_holds(position[axis]) ? position[axis] : 0.0), 8);
        add_vertex(mesh, position, own);
        if (places.u && places.v) vertex_uvs_.push_back(make_uv(values[*places.u], values[*places.v]));
      } else if (e.name == "face") {
        add_face(own, places.picture ? values[*places.picture] : 0, mesh);
      } else if (e.name == "tristrips") {
        add_strips(mesh);
      }
    }
    return std::nullopt;
  }

  /// Once all elements are there: arrays of one entry a triangle.
  void finish(PlainMesh& mesh) {
    if (alpha_) mesh.notes.lose("alpha");
    if (face_colors_.size() == mesh.triangles && any_face_color_) {
      if (mesh.colors.empty())
        mesh.paint.face_colors = std::move(face_colors_);
      else
        pass_over_face_colors(mesh);
    }
    if (textures_ == 0) return;
    if (uvs_.size() == mesh.triangles && any_uvs_) {
      mesh.paint.uvs = std::move(uvs_);
    } else if (vertex_uvs_.size() == vertices_) {
      for (const Triangle& t : triangles_)
        mesh.paint.uvs.push_back({vertex_uvs_[t[0]], vertex_uvs_[t[1]], vertex_uvs_[t[2]]});
    } else {
      mesh.warnings.push_back(
          {"uv-missing", "the file names a picture but has no texture coordinates for it"});
      return;
    }
    mesh.paint.material_indices = std::move(pictures_);
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
  /// Properties and elements that are passed over.
  void note_losses(const PlyElement& e, const PlyPlaces& places, ReadNotes& notes) const {
    constexpr std::size_t kMaxName = 48;
    const bool of_vertices = e.name == "vertex", of_faces = e.name == "face";
    if (!of_vertices && !of_faces && e.name != "tristrips") {
      notes.lose("element " + e.name.substr(0, kMaxName));
      return;
    }
    for (std::size_t k = 0; k < e.properties.size(); ++k) {
      const PlyProperty& p = e.properties[k];
      const bool coordinates =
          (of_vertices && (places.u == k || places.v == k)) || (of_faces && p.name == "texcoord");
      if (coordinates && textures_ == 0) notes.lose("texture coordinates");
      const bool position = of_vertices && (p.name == "x" || p.name == "y" || p.name == "z");
      const bool of_color = places.color && std::count(places.color->begin(), places.color->end(), k) > 0;
      if (coordinates || position || of_color || places.alpha == k || (!of_vertices && is_vertex_list(p)) ||
          (of_faces && places.picture == k && textures_ > 0))
        continue;
      if (p.name == "nx" || p.name == "ny" || p.name == "nz")
        notes.lose("normals");
      else
        notes.lose("property " + p.name.substr(0, kMaxName) + (of_vertices ? " of vertices" : " of faces"));
    }
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
  /// Reads a list into polygon_ or corner_uvs_, or passes it over. The vertices of strips may be -1.
  std::optional<Error> list(const PlyElement& e, const PlyProperty& p, std::uint64_t i) {
    double count = 0;
    if (!values_.read(p.count_type, count)) return unreadable(e, i);
    if (!(count >= 0 && count <= double(values_.left() / values_.least_bytes(p.type))) ||
        count != std::floor(count))
      return invalid_mesh("the list '" + p.name + "' of element " + std::to_string(i) + " of '" + e.name +
                          "' is longer than the rest of the file; the file is damaged, export it again");
    const bool strips = e.name == "tristrips", is_face = (strips || e.name == "face") && is_vertex_list(p);
    const bool uvs = e.name == "face" && p.name == "texcoord" && textures_ > 0;
    for (std::uint64_t k = 0; k < std::uint64_t(count); ++k) {
      double value = 0;
      if (!values_.read(p.type, value)) return unreadable(e, i);
      if (uvs) corner_uvs_.push_back(value);
      if (!is_face) continue;
      if (strips && value == -1) {
        polygon_.push_back(kStripEnd);
        continue;
      }
      if (!(value >= 0 && value < double(vertices_)) || value != std::floor(value))
        return invalid_mesh("face " + std::to_string(i) + " uses a vertex that is not there: the file has " +
                            std::to_string(vertices_) + "; export the mesh again");
      polygon_.push_back(std::uint32_t(value));
    }
    return std::nullopt;
  }

  void add_face(const std::optional<Rgb8>& own, double picture, PlainMesh& mesh) {
    ++mesh.polygons;
    any_face_color_ = any_face_color_ || own;
    const bool uvs = corner_uvs_.size() == 2 * polygon_.size();
    any_uvs_ = any_uvs_ || (uvs && !polygon_.empty());
    const auto corner = [&](std::size_t k) {
      return uvs ? make_uv(corner_uvs_[2 * k], corner_uvs_[2 * k + 1]) : Uv{0, 0};
    };
    cut_into_fan(
        polygon_, mesh.dropped_faces, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::size_t i) {
          add_triangle({a, b, c}, mesh);
          if (own || any_face_color_) {
            fill_up(face_colors_, mesh.triangles - 1, kMissingColor);
            face_colors_.push_back(own.value_or(kMissingColor));
          }
          if (textures_ == 0) return;
          uvs_.push_back({corner(0), corner(i - 1), corner(i)});
          pictures_.push_back(picture >= 0 && picture < double(textures_) ? std::uint32_t(picture)
                                                                          : SurfacePaint::kNoMaterial);
        });
  }

  /// Strips one after the other, -1 between them; each second triangle of one runs the other way
  /// [Stanford 3D Scanning Repository].
  void add_strips(PlainMesh& mesh) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      if (polygon_[i] == kStripEnd) begin = i + 1;
      if (i < begin + 2 || polygon_[i] == kStripEnd) continue;
      Triangle t{polygon_[i - 2], polygon_[i - 1], polygon_[i]};
      if ((i - begin) % 2 != 0) std::swap(t[0], t[1]);
      ++mesh.polygons;
      // Strips turn corners by triangles without area.
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      add_triangle(t, mesh);
      if (textures_ == 0) continue;
      uvs_.push_back({});
      pictures_.push_back(0);
    }
  }

  void add_triangle(const Triangle& t, PlainMesh& mesh) {
    faces += char(3);
    for (const std::uint32_t index : t) append_bits(faces, index, 4);
    ++mesh.triangles;
    if (textures_ > 0) triangles_.push_back(t);
  }

  static constexpr std::uint32_t kStripEnd = 0xffff'ffff;

  PlyValues values_;
  std::uint64_t vertices_, textures_;
  const Progress* progress_;
  std::vector<std::uint32_t> polygon_;  ///< of this element
  std::vector<double> corner_uvs_;      ///< two a corner
  std::vector<Uv> vertex_uvs_;
  // One a triangle, as far as there are such.
  std::vector<Rgb8> face_colors_;
  std::vector<std::array<Uv, 3>> uvs_;
  std::vector<std::uint32_t> pictures_;
  std::vector<Triangle> triangles_;
  bool any_face_color_ = false, any_uvs_ = false, alpha_ = false;
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
    if (e.name == "face" || e.name == "tristrips")
      face_lists += int(std::count_if(e.properties.begin(), e.properties.end(), is_vertex_list));
  }
  if (vertex_elements != 1 || axes != 3)
    return invalid_mesh("the PLY header does not describe vertices with x, y and z; export the mesh again");
  if (face_lists != 1)
    return invalid_mesh(
        "the PLY file has no faces or tristrips with vertex_indices (a point cloud?); export a mesh of "
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
  body.finish(mesh);
  mesh.materials = header->textures;
  mesh.bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices) +
               "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
               std::to_string(mesh.triangles) + "\nproperty list uchar int vertex_indices\nend_header\n" +
               body.points + body.faces;
  return mesh;
}

}  // namespace mesocell
