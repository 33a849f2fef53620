#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <string>

#include "converters/import/fan.h"
#include "converters/import/mesh_text.h"
#include "converters/import/off_plain.h"
#include "converters/import/vertex_color.h"

namespace mesocell {
namespace {

/// Big-endian numbers; zeros beyond the end, which is told.
class BigReader {
 public:
  explicit BigReader(std::string_view bytes) : bytes_(bytes) {}
  std::uint32_t u32() {
    if (left() < 4) {
      ended_ = true;
      return 0;
    }
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) value = value << 8 | std::uint8_t(bytes_[at_++]);
    return value;
  }
  float f32() { return std::bit_cast<float>(u32()); }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool ended_ = false;
};

Error cut_off(const char* what, std::uint64_t number) {
  return invalid_mesh(std::string("the binary OFF ends, or is damaged, at ") + what + " " +
                      std::to_string(number) + "; fetch or export it again");
}

void append_number(std::string& text, float value) {
  std::array<char, 32> word{};
  const auto [end, error] = std::to_chars(word.data(), word.data() + word.size(), value);
  text.append(word.data(), end);
}

std::optional<Rgb8> read_color(BigReader& in, std::uint32_t channels, ReadNotes& notes) {
  std::array<double, 3> rgb{};
  for (std::uint32_t k = 0; k < channels; ++k) {
    const float value = in.f32();
    if (k < 3) rgb[k] = double{value};
    if (k == 3 && value < 1) notes.lose("alpha");
  }
  return channels >= 3 ? make_color(rgb, 1) : std::nullopt;
}

Result<bool> read_faces(BigReader& in, std::uint64_t count, const Progress* progress, PlainMesh& mesh,
                        std::string& text) {
  std::vector<std::uint32_t> polygon;
  std::vector<Rgb8> colors;
  bool any_color = false;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (stop_at(progress, i)) return cancelled();
    const std::uint32_t size = in.u32();
    if (in.ended() || size > in.left() / 4) return cut_off("face", i);
    polygon.clear();
    for (std::uint32_t k = 0; k < size; ++k) {
      const std::uint32_t vertex = in.u32();
      if (vertex >= mesh.positions.size())
        return invalid_mesh("face " + std::to_string(i) + " uses vertex " + std::to_string(vertex) +
                            ", but the file has " + std::to_string(mesh.positions.size()) +
                            "; export the mesh again");
      polygon.push_back(vertex);
    }
    const std::uint32_t channels = in.u32();
    if (in.ended() || channels > in.left() / 4) return cut_off("face", i);
    const std::optional<Rgb8> color = read_color(in, channels, mesh.notes);
    any_color = any_color || color;
    ++mesh.polygons;
    cut_into_fan(
        polygon, mesh.dropped_faces, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::size_t) {
          text += "3 " + std::to_string(a) + ' ' + std::to_string(b) + ' ' + std::to_string(c) + '\n';
          ++mesh.triangles;
          colors.push_back(color.value_or(kMissingColor));
        });
  }
  if (any_color) keep_face_colors(mesh, std::move(colors));
  return true;
}

}  // namespace

Result<PlainMesh> plain_off_binary(std::string_view body, OffKind kind, const Progress* progress) {
  BigReader in(body);
  const std::uint32_t vertices = in.u32(), faces = in.u32();
  in.u32();  // edges, which nobody counts
  if (in.ended()) return invalid_mesh("the binary OFF ends before its counts; fetch or export it again");
  const std::uint64_t vertex_bytes =
      12 + (kind.normals ? 12 : 0) + (kind.colors ? 16 : 0) + (kind.uvs ? 8 : 0);
  if (auto error = check_off_counts(vertices, faces, in.left(), vertex_bytes, 8)) return *error;
  PlainMesh mesh;
  mesh.extension = "off";
  mesh.positions.reserve(vertices);
  for (std::uint32_t i = 0; i < vertices; ++i) {
    if (stop_at(progress, i)) return cancelled();
    Vec3 p;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float x = in.f32();
      p[axis] = double{x};
      append_number(mesh.bytes, std::isfinite(x) ? x : 0.0f);
      mesh.bytes += axis < 2 ? ' ' : '\n';
    }
    for (int k = 0; kind.normals && k < 3; ++k) in.u32();
    std::optional<Rgb8> color;
    if (kind.colors) color = read_color(in, 4, mesh.notes);
    for (int k = 0; kind.uvs && k < 2; ++k) in.u32();
    add_vertex(mesh, p, color);
  }
  if (in.ended()) return cut_off("vertex", vertices);
  if (vertices > 0 && kind.normals) mesh.notes.lose("normals");
  if (vertices > 0 && kind.uvs) mesh.notes.lose("texture coordinates");
  std::string text;
  const Result<bool> read = read_faces(in, faces, progress, mesh, text);
  if (!read) return read.error();
  finish_off(mesh, text);
  return mesh;
}

}  // namespace mesocell
