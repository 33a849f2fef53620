#include "converters/import/off_plain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "converters/import/fan.h"
#include "converters/import/mesh_text.h"
#include "converters/import/vertex_color.h"

namespace mesocell {
namespace {

/// Words of an OFF file, comments left out; the rest of a line can be passed over.
class OffWords {
 public:
  explicit OffWords(std::string_view bytes) : lines_(bytes) {}

  /// The next word, on whatever line; empty at the end of the file.
  std::string_view next() {
    for (;;) {
      const std::string_view word = next_word(line_);
      if (!word.empty()) return word;
      if (!lines_.next(line_)) return {};
      line_ = line_.substr(0, line_.find('#'));
    }
  }
  /// The rest of the line, which is passed over.
  std::string_view rest_of_line() { return std::exchange(line_, {}); }
  [[nodiscard]] std::uint64_t number() const { return lines_.number(); }
  /// Offset of the byte after the line of the last word.
  [[nodiscard]] std::size_t offset() const { return lines_.offset(); }

 private:
  LineReader lines_;
  std::string_view line_;
};

Error ends_early(const char* what, std::uint64_t promised, std::uint64_t found) {
  return invalid_mesh("the header promises " + std::to_string(promised) + " " + what +
                      ", but the file ends after " + std::to_string(found) +
                      "; the file is cut off, fetch or export it again");
}

/// Reads the keyword: [ST][C][N]OFF.
Result<OffKind> read_keyword(OffWords& words) {
  std::string_view keyword = words.next();
  if (keyword.size() >= 3 && keyword.substr(keyword.size() - 3) == "OFF") {
    keyword.remove_suffix(3);
    if (keyword.find_first_of("4n") != keyword.npos)
      return invalid_mesh(
          "the file has vertices that are not points in space (4OFF or nOFF); export it as OFF");
    if (keyword.find_first_not_of("STCN") == keyword.npos)
      return OffKind{keyword.find("ST") != keyword.npos, keyword.find('C') != keyword.npos,
                     keyword.find('N') != keyword.npos};
  }
  return invalid_mesh("the file does not begin with OFF, so it is not an OFF mesh; check the file");
}

/// The colors of vertices, or of faces. Whether they are whole numbers up to 255 or have a point and go up to
/// 1 is not said in the file, and 1 may be either: all channels together tell.
class OffColors {
 public:
  /// `rest`: of a line, after the position, or after the corners of a face. One number of a face is an index
  /// into a table that is not in the file.
  void add(std::string_view rest, bool normals) {
    for (int k = 0; normals && k < 3; ++k) next_word(rest);
    std::array<double, 3> channels{};
    bool numbers = true, point = false, above = false;
    for (double& channel : channels) {
      const std::string_view word = next_word(rest);
      numbers = numbers && parse_number(word, channel);
      point = point || word.find_first_of(".eE") != word.npos;
      above = above || channel > 1;
    }
    double alpha = 0;
    if (numbers && parse_number(next_word(rest), alpha)) least_alpha_ = std::min(least_alpha_, alpha);
    has_point_ = has_point_ || (numbers && point);
    above_one_ = above_one_ || (numbers && above);
    if (!numbers) channels.fill(std::nan(""));
    channels_.push_back(channels);
  }
  /// One an add(); empty if there was none in any.
  [[nodiscard]] std::vector<Rgb8> take() const {
    const double full = full_channel();
    std::vector<Rgb8> colors;
    bool any = false;
    for (const std::array<double, 3>& channels : channels_) {
      const std::optional<Rgb8> color = make_color(channels, full);
      any = any || color;
      colors.push_back(color.value_or(kMissingColor));
    }
    if (!any) colors.clear();
    return colors;
  }

  [[nodiscard]] bool has_alpha() const { return least_alpha_ < full_channel(); }

 private:
  [[nodiscard]] double full_channel() const { return above_one_ && !has_point_ ? 255 : 1; }

  std::vector<std::array<double, 3>> channels_;
  double least_alpha_ = 255;
  bool has_point_ = false, above_one_ = false;
};

Result<bool> read_vertices(OffWords& words, std::uint64_t count, OffKind kind, const Progress* progress,
                           PlainMesh& mesh) {
  OffColors colors;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (stop_at(progress, i)) return cancelled();
    Vec3 p;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string_view word = words.next();
      if (word.empty()) return ends_early("vertices", count, i);
      if (!parse_number(word, p[axis]))
        return invalid_line(words.number(), "a coordinate of vertex " + std::to_string(i) +
                                                " is not a number; repair the file");
      mesh.bytes += library_holds(p[axis]) ? word : std::string_view("0");
      mesh.bytes += axis < 2 ? ' ' : '\n';
    }
    const std::string_view rest = words.rest_of_line();  // normal, color, texture coordinates
    if (kind.colors) colors.add(rest, kind.normals);
    mesh.positions.push_back(p);
  }
  mesh.colors = colors.take();
  if (!mesh.colors.empty() && colors.has_alpha()) mesh.notes.lose("alpha");
  if (count > 0 && kind.normals) mesh.notes.lose("normals");
  if (count > 0 && kind.uvs) mesh.notes.lose("texture coordinates");
  return true;
}

Result<bool> read_faces(OffWords& words, std::uint64_t count, std::uint64_t most, const Progress* progress,
                        PlainMesh& mesh, std::string& text) {
  std::vector<std::uint32_t> polygon;
  OffColors colors;
  std::vector<std::uint32_t> face_of;  // by triangle
  for (std::uint64_t i = 0; i < count; ++i) {
    if (stop_at(progress, i)) return cancelled();
    const std::string_view size_word = words.next();
    if (size_word.empty()) return ends_early("faces", count, i);
    std::int64_t size = 0;
    if (!parse_integer(size_word, size) || size < 0 || std::uint64_t(size) > most)
      return invalid_line(words.number(), "the number of corners of face " + std::to_string(i) +
                                              " makes no sense; repair the file");
    polygon.clear();
    for (std::int64_t k = 0; k < size; ++k) {
      const std::string_view word = words.next();
      if (word.empty()) return ends_early("faces", count, i);
      std::int64_t vertex = 0;
      if (!parse_integer(word, vertex))
        return invalid_line(words.number(), "a corner of face " + std::to_string(i) +
                                                " is not a vertex number; repair the file");
      if (vertex < 0 || std::uint64_t(vertex) >= mesh.positions.size())
        return invalid_line(words.number(), "face " + std::to_string(i) + " uses vertex " +
                                                std::to_string(vertex) +
                                                ", but the vertices are numbered 0 to " +
                                                std::to_string(std::int64_t(mesh.positions.size()) - 1) +
                                                "; export the mesh again");
      polygon.push_back(std::uint32_t(vertex));
    }
    colors.add(words.rest_of_line(), false);
    ++mesh.polygons;
    cut_into_fan(
        polygon, mesh.dropped_faces, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::size_t) {
          text += "3 " + std::to_string(a) + ' ' + std::to_string(b) + ' ' + std::to_string(c) + '\n';
          ++mesh.triangles;
          face_of.push_back(std::uint32_t(i));
        });
  }
  const std::vector<Rgb8> face_colors = colors.take();
  if (face_colors.empty()) return true;
  if (colors.has_alpha()) mesh.notes.lose("alpha");
  std::vector<Rgb8> triangle_colors;
  for (const std::uint32_t face : face_of) triangle_colors.push_back(face_colors[face]);
  keep_face_colors(mesh, std::move(triangle_colors));
  return true;
}

}  // namespace

std::optional<Error> check_off_counts(std::uint64_t vertices, std::uint64_t faces, std::uint64_t bytes,
                                      std::uint64_t vertex_bytes, std::uint64_t face_bytes) {
  if (vertices <= bytes / vertex_bytes && faces <= bytes / face_bytes && vertices <= kMaxMeshElements &&
      faces <= kMaxMeshElements)
    return std::nullopt;
  return invalid_mesh("the header promises " + std::to_string(vertices) + " vertices and " +
                      std::to_string(faces) + " faces, more than a file of " + std::to_string(bytes) +
                      " bytes can hold; the file is cut off or damaged, fetch or export it again");
}

void finish_off(PlainMesh& mesh, const std::string& faces) {
  mesh.bytes = "OFF\n" + std::to_string(mesh.positions.size()) + ' ' + std::to_string(mesh.triangles) +
               " 0\n" + mesh.bytes;
  mesh.bytes += faces;
}

void keep_face_colors(PlainMesh& mesh, std::vector<Rgb8> colors) {
  if (mesh.colors.empty())
    mesh.paint.face_colors = std::move(colors);
  else
    pass_over_face_colors(mesh);
}

Result<PlainMesh> plain_off(std::string_view bytes, const Progress* progress) {
  OffWords words(bytes);
  const Result<OffKind> kind = read_keyword(words);
  if (!kind) return kind.error();
  std::array<std::int64_t, 3> counts{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string_view word = words.next();
    if (i == 0 && word == "BINARY") return plain_off_binary(bytes.substr(words.offset()), *kind, progress);
    if (!parse_integer(word, counts[i]) || counts[i] < 0)
      return invalid_mesh(
          "the numbers of vertices, faces and edges after OFF cannot be read; repair the file");
  }
  const std::uint64_t vertices = std::uint64_t(counts[0]), faces = std::uint64_t(counts[1]);
  // A vertex takes six bytes and a face two at the least: counts that the file cannot hold are refused here.
  if (auto error = check_off_counts(vertices, faces, bytes.size(), 6, 2)) return *error;
  PlainMesh mesh;
  mesh.extension = "off";
  mesh.positions.reserve(vertices);
  const Result<bool> vertices_read = read_vertices(words, vertices, *kind, progress, mesh);
  if (!vertices_read) return vertices_read.error();
  std::string face_text;
  const Result<bool> faces_read = read_faces(words, faces, bytes.size() / 2, progress, mesh, face_text);
  if (!faces_read) return faces_read.error();
  finish_off(mesh, face_text);
  return mesh;
}

}  // namespace mesocell
