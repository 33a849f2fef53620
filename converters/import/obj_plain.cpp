#include <array>
#include <optional>
#include <string>
#include <vector>

#include "converters/import/fan.h"
#include "converters/import/mesh_text.h"
#include "converters/import/plain_mesh.h"
#include "converters/import/vertex_color.h"

namespace mesocell {
namespace {

/// Reads one statement, joining lines that end with a backslash; comments are taken off.
bool next_statement(LineReader& lines, std::string& joined, std::string_view& statement) {
  joined.clear();
  if (!lines.next(statement)) return false;
  const auto strip = [](std::string_view line) {
    line = line.substr(0, line.find('#'));
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    return line;
  };
  statement = strip(statement);
  while (!statement.empty() && statement.back() == '\\') {
    if (joined.empty()) joined.assign(statement);
    joined.back() = ' ';
    std::string_view more;
    if (!lines.next(more)) break;
    joined += strip(more);
    statement = joined;
  }
  if (!joined.empty()) statement = joined;
  return true;
}

/// Three numbers after the position are a color, whatever comes after it; fewer are a weight.
std::optional<Rgb8> read_color(std::string_view rest) {
  std::array<double, 3> channels{};
  for (double& channel : channels)
    if (!parse_number(next_word(rest), channel)) return std::nullopt;
  return make_color(channels, 1);
}

Result<bool> read_vertex(std::string_view rest, std::uint64_t line, PlainMesh& mesh) {
  Vec3 p;
  mesh.bytes += 'v';
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view word = next_word(rest);
    if (word.empty()) return invalid_line(line, "a vertex has fewer than three coordinates; repair the file");
    if (!parse_number(word, p[axis]))
      return invalid_line(line, "a coordinate of a vertex is not a number; repair the file");
    mesh.bytes += ' ';
    mesh.bytes += library_holds(p[axis]) ? word : std::string_view("0");
  }
  mesh.bytes += '\n';
  add_vertex(mesh, p, read_color(rest));
  return true;
}

/// Reads the vertex indices of a face; texture and normal indices are passed over.
Result<bool> read_face(std::string_view rest, std::uint64_t line, std::uint64_t seen, std::uint64_t total,
                       std::vector<std::uint32_t>& polygon) {
  polygon.clear();
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
    std::int64_t index = 0;
    if (!parse_integer(word.substr(0, word.find('/')), index))
      return invalid_line(line, "a corner of a face is not a vertex number; repair the file");
    // Negative numbers count back from the last vertex seen so far.
    const std::int64_t vertex = index < 0 ? std::int64_t(seen) + index : index - 1;
    if (index == 0 || vertex < 0 || std::uint64_t(vertex) >= total)
      return invalid_line(line, "a face uses vertex " + std::to_string(index) + ", but the file has " +
                                    std::to_string(total) + "; export the mesh again");
    polygon.push_back(std::uint32_t(vertex));
  }
  if (polygon.size() < 3) return invalid_line(line, "a face has fewer than three corners; repair the file");
  return true;
}

}  // namespace

Result<PlainMesh> plain_obj(std::string_view bytes, const Progress* progress) {
  PlainMesh mesh;
  mesh.extension = "obj";
  mesh.bytes.reserve(bytes.size());
  std::string joined;
  std::string_view statement;

  // Two passes, since faces may use vertices that come later.
  LineReader vertices(bytes);
  for (std::uint64_t n = 0; next_statement(vertices, joined, statement); ++n) {
    if (stop_at(progress, n)) return cancelled();
    if (next_word(statement) != "v") continue;
    if (mesh.positions.size() >= kMaxMeshElements)
      return invalid_mesh("the mesh has too many vertices; split it");
    const Result<bool> read = read_vertex(statement, vertices.number(), mesh);
    if (!read) return read.error();
  }
  LineReader faces(bytes);
  std::vector<std::uint32_t> polygon;
  std::uint64_t seen = 0;
  for (std::uint64_t n = 0; next_statement(faces, joined, statement); ++n) {
    if (stop_at(progress, n)) return cancelled();
    const std::string_view key = next_word(statement);
    if (key == "v") ++seen;
    if (key != "f" && key != "fo") continue;
    const Result<bool> read = read_face(statement, faces.number(), seen, mesh.positions.size(), polygon);
    if (!read) return read.error();
    ++mesh.polygons;
    cut_into_fan(polygon, mesh.dropped_faces, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      mesh.bytes +=
          "f " + std::to_string(a + 1) + ' ' + std::to_string(b + 1) + ' ' + std::to_string(c + 1) + '\n';
      ++mesh.triangles;
    });
  }
  if (mesh.positions.empty() && mesh.polygons == 0)
    return invalid_mesh(
        "the file holds neither vertices nor faces, so it is not an OBJ mesh; check the file");
  return mesh;
}

}  // namespace mesocell
