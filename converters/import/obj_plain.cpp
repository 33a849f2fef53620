#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
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

/// Texture coordinates begin at the lower left.
Uv read_uv(std::string_view rest) {
  double u = 0, v = 0;
  const bool read = parse_number(next_word(rest), u) && (parse_number(next_word(rest), v) || true);
  const float s = float(u), t = float(1 - v);
  return read && std::isfinite(s) && std::isfinite(t) ? Uv{s, t} : Uv{0, 0};
}

/// Notes statements that are passed over.
class PassedOver {
 public:
  void see(std::string_view key, std::string_view rest) {
    for (std::size_t i = 0; i < kKeys.size(); ++i) seen_[i] = seen_[i] || key == kKeys[i].first;
    const std::string_view group = trimmed(rest);
    smooth_ = smooth_ || (key == "s" && !group.empty() && group != "off" && group != "0");
  }
  void note(ReadNotes& notes) const {
    for (std::size_t i = 0; i < kKeys.size(); ++i)
      if (seen_[i]) notes.lose(kKeys[i].second);
    if (smooth_) notes.lose("smoothing groups");
  }

 private:
  static constexpr std::array<std::pair<std::string_view, const char*>, 8> kKeys = {
      {{"vn", "normals"},
       {"g", "groups"},
       {"o", "groups"},
       {"l", "lines and points"},
       {"p", "lines and points"},
       {"curv", "curves and surfaces"},
       {"curv2", "curves and surfaces"},
       {"surf", "curves and surfaces"}}};
  std::array<bool, kKeys.size()> seen_{};
  bool smooth_ = false;
};

/// What a face can refer to.
struct Seen {
  std::uint64_t vertices = 0, uvs = 0;  ///< before it
  std::uint64_t all_vertices = 0;
  const std::vector<Uv>& all_uvs;
};

/// The texture coordinates of a corner "v/vt/vn"; nothing if it has none, or some that are not there.
std::optional<Uv> corner_uv(std::string_view word, const Seen& seen) {
  const std::size_t slash = word.find('/');
  if (slash == word.npos) return std::nullopt;
  word.remove_prefix(slash + 1);
  std::int64_t index = 0;
  if (!parse_integer(word.substr(0, word.find('/')), index)) return std::nullopt;
  const std::int64_t uv = index < 0 ? std::int64_t(seen.uvs) + index : index - 1;
  if (index == 0 || uv < 0 || std::uint64_t(uv) >= seen.all_uvs.size()) return std::nullopt;
  return seen.all_uvs[std::size_t(uv)];
}

/// Reads the vertices of a face and their texture coordinates; normals are passed over. `has_uvs`: all
/// corners have some.
Result<bool> read_face(std::string_view rest, std::uint64_t line, const Seen& at,
                       std::vector<std::uint32_t>& polygon, std::vector<Uv>& uvs, bool& has_uvs) {
  const std::uint64_t seen = at.vertices, total = at.all_vertices;
  polygon.clear();
  uvs.clear();
  has_uvs = true;
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
    const std::optional<Uv> uv = corner_uv(word, at);
    has_uvs = has_uvs && uv;
    uvs.push_back(uv.value_or(Uv{0, 0}));
  }
  if (polygon.size() < 3) return invalid_line(line, "a face has fewer than three corners; repair the file");
  return true;
}

/// Which material the next faces have.
class Materials {
 public:
  explicit Materials(PlainMesh& mesh) : mesh_(mesh) {}
  void use(std::string_view name) {
    const auto [place, is_new] = indices_.try_emplace(std::string(name), std::uint32_t(indices_.size()));
    if (is_new) mesh_.materials.emplace_back(name);
    now_ = place->second;
    // Triangles before the first material have none.
    fill_up(mesh_.paint.material_indices, mesh_.triangles, SurfacePaint::kNoMaterial);
    used_ = true;
  }
  /// For a triangle.
  void add() {
    if (used_) mesh_.paint.material_indices.push_back(now_);
  }

 private:
  PlainMesh& mesh_;
  std::map<std::string, std::uint32_t> indices_;
  std::uint32_t now_ = 0;
  bool used_ = false;
};

}  // namespace

Result<PlainMesh> plain_obj(std::string_view bytes, const Progress* progress) {
  PlainMesh mesh;
  mesh.extension = "obj";
  mesh.bytes.reserve(bytes.size());
  std::string joined;
  std::string_view statement;

  // Two passes, since faces may use vertices that come later.
  std::vector<Uv> uvs;
  PassedOver passed_over;
  LineReader vertices(bytes);
  for (std::uint64_t n = 0; next_statement(vertices, joined, statement); ++n) {
    if (stop_at(progress, n)) return cancelled();
    const std::string_view key = next_word(statement);
    if (key == "vt") uvs.push_back(read_uv(statement));
    if (key == "mtllib") mesh.material_files.emplace_back(trimmed(statement));
    if (key != "v") {
      passed_over.see(key, statement);
      continue;
    }
    if (mesh.positions.size() >= kMaxMeshElements)
      return invalid_mesh("the mesh has too many vertices; split it");
    const Result<bool> read = read_vertex(statement, vertices.number(), mesh);
    if (!read) return read.error();
  }
  LineReader faces(bytes);
  std::vector<std::uint32_t> polygon;
  std::vector<Uv> corner_uvs;
  Materials materials(mesh);
  Seen seen{0, 0, mesh.positions.size(), uvs};
  std::uint64_t without_uvs = 0;
  for (std::uint64_t n = 0; next_statement(faces, joined, statement); ++n) {
    if (stop_at(progress, n)) return cancelled();
    const std::string_view key = next_word(statement);
    if (key == "v") ++seen.vertices;
    if (key == "vt") ++seen.uvs;
    if (key == "usemtl") materials.use(trimmed(statement));
    if (key != "f" && key != "fo") continue;
    bool has_uvs = false;
    const Result<bool> read = read_face(statement, faces.number(), seen, polygon, corner_uvs, has_uvs);
    if (!read) return read.error();
    ++mesh.polygons;
    if (!uvs.empty() && !has_uvs) ++without_uvs;
    cut_into_fan(
        polygon, mesh.dropped_faces, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::size_t i) {
          mesh.bytes +=
              "f " + std::to_string(a + 1) + ' ' + std::to_string(b + 1) + ' ' + std::to_string(c + 1) + '\n';
          ++mesh.triangles;
          materials.add();
          if (!uvs.empty()) mesh.paint.uvs.push_back({corner_uvs[0], corner_uvs[i - 1], corner_uvs[i]});
        });
  }
  passed_over.note(mesh.notes);
  if (without_uvs > 0)
    mesh.warnings.push_back(
        {"uv-missing", std::to_string(without_uvs) +
                           " faces have corners without texture coordinates, or with some "
                           "that are not there; the picture's upper left is taken for them"});
  if (mesh.positions.empty() && mesh.polygons == 0)
    return invalid_mesh(
        "the file holds neither vertices nor faces, so it is not an OBJ mesh; check the file");
  return mesh;
}

}  // namespace mesocell
