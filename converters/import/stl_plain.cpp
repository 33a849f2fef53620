#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <string>

#include "converters/import/fan.h"
#include "converters/import/mesh_text.h"
#include "converters/import/plain_mesh.h"

namespace mesocell {
namespace {

using Point = std::array<float, 3>;

/// Whether the library merges two corners: it takes differences up to the least normal number as none.
bool merged(const Point& a, const Point& b) {
  for (std::size_t i = 0; i < 3; ++i)
    if (std::abs(a[i] - b[i]) > FLT_MIN) return false;
  return true;
}

/// Counts a triangle, or counts it as dropped if two of its corners are the same.
void count_triangle(const std::array<Point, 3>& p, PlainMesh& mesh) {
  ++mesh.polygons;
  if (merged(p[0], p[1]) || merged(p[1], p[2]) || merged(p[2], p[0]))
    ++mesh.dropped_faces;
  else
    ++mesh.triangles;
}

Error not_finite(std::uint64_t triangle) {
  return invalid_mesh(
      "triangle " + std::to_string(triangle) +
      " has a corner whose coordinates are not finite (NaN or infinite, in single precision); repair "
      "the mesh");
}

std::uint32_t load_u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{std::uint8_t(bytes[at + i])} << (8 * i);
  return value;
}

/// Normals are not used: corners say which side is out.
void warn_of_normals(std::uint64_t count, PlainMesh& mesh) {
  if (count > 0)
    mesh.warnings.push_back(
        {"normal-not-finite", std::to_string(count) +
                                  " triangles have normals that are not numbers; the order "
                                  "of the corners says which side is out"});
}

constexpr std::size_t kHeader = 84, kRecord = 50;

Result<PlainMesh> plain_binary(std::string_view bytes, const Progress* progress) {
  PlainMesh mesh;
  mesh.extension = "stl";
  mesh.binary = true;
  const std::uint64_t count = (bytes.size() - kHeader) / kRecord;
  if (count > kMaxMeshElements / 3) return invalid_mesh("the mesh has too many triangles; split it");
  std::uint64_t bad_normals = 0;
  bool attributes = false;
  for (std::uint64_t t = 0; t < count; ++t) {
    if (stop_at(progress, t)) return cancelled();
    std::array<Point, 3> corner{};
    bool normal_is_number = true;
    for (std::size_t i = 0; i < 3; ++i)
      normal_is_number = normal_is_number &&
                         std::isfinite(std::bit_cast<float>(load_u32(bytes, kHeader + t * kRecord + 4 * i)));
    bad_normals += !normal_is_number;
    for (std::size_t i = 0; i < 9; ++i) {
      const float x = std::bit_cast<float>(load_u32(bytes, kHeader + t * kRecord + 12 + 4 * i));
      if (!std::isfinite(x)) return not_finite(t);
      corner[i / 3][i % 3] = x;
    }
    count_triangle(corner, mesh);
    attributes = attributes || bytes.substr(kHeader + t * kRecord + 48, 2) != std::string_view("\0\0", 2);
  }
  mesh.bytes.assign(bytes);
  if (attributes) mesh.notes.lose("attributes of triangles, such as colors");
  warn_of_normals(bad_normals, mesh);
  return mesh;
}

std::string lower(std::string_view word) {
  std::string text(word.substr(0, 16));
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return text;
}

/// Reads the three coordinates after "vertex" and hands them on.
Result<Point> read_corner(std::string_view& line, std::uint64_t number, std::uint64_t triangle,
                          std::string& out) {
  Point p{};
  out += "vertex";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view word = next_word(line);
    double x = 0;
    if (word.empty() || !parse_number(word, x))
      return invalid_line(number,
                          "a vertex does not have three coordinates that are numbers; repair the file");
    if (!library_holds(x)) return not_finite(triangle);
    p[axis] = float(x);
    out += ' ';
    out += word;
  }
  out += '\n';
  return p;
}

/// Text STL: only the corners are passed on, one loop of three a triangle.
Result<PlainMesh> plain_text(std::string_view bytes, const Progress* progress) {
  PlainMesh mesh;
  mesh.extension = "stl";
  LineReader lines(bytes);
  std::array<Point, 3> corner{};
  std::size_t corners = 0;
  std::uint64_t bad_normals = 0;
  bool in_loop = false, in_name = false, ended = false;
  std::string_view line;
  while (lines.next(line)) {
    if (stop_at(progress, lines.number())) return cancelled();
    in_name = false;
    for (std::string_view word = next_word(line); !word.empty() && !in_name; word = next_word(line)) {
      const std::string key = lower(word);
      if (key == "solid" || key == "endsolid") {
        ended = key == "endsolid";
        in_name = true;  // the rest of the line is a name, which may hold any words
      } else if (key == "normal") {
        bool number = true;
        for (int k = 0; k < 3; ++k) {
          double x = 0;
          number = parse_number(next_word(line), x) && std::isfinite(x) && number;
        }
        bad_normals += !number;
      } else if (key == "outer") {
        if (in_loop)
          return invalid_line(lines.number(), "a facet begins before the last one ended; repair the file");
        in_loop = true;
        corners = 0;
        mesh.bytes += "outer loop\n";
      } else if (key == "vertex") {
        if (!in_loop || corners == 3)
          return invalid_line(lines.number(),
                              "a facet does not have three corners; repair or triangulate the mesh");
        Result<Point> p = read_corner(line, lines.number(), mesh.polygons, mesh.bytes);
        if (!p) return p.error();
        corner[corners++] = *p;
      } else if (key == "endloop") {
        if (!in_loop || corners != 3)
          return invalid_line(lines.number(),
                              "a facet does not have three corners; repair or triangulate the mesh");
        in_loop = false;
        count_triangle(corner, mesh);
      }
    }
  }
  if (in_loop || !ended)
    return invalid_mesh("the file does not end with endsolid; it is cut off, fetch or export it again");
  if (mesh.polygons > kMaxMeshElements / 3) return invalid_mesh("the mesh has too many triangles; split it");
  warn_of_normals(bad_normals, mesh);
  return mesh;
}

}  // namespace

bool is_binary_stl(std::string_view bytes) {
  return bytes.size() >= kHeader && bytes.size() - kHeader == std::uint64_t{load_u32(bytes, 80)} * kRecord;
}

bool is_text_stl(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, 1024);
  const std::size_t start = head.find_first_not_of(" \t\r\n");
  return start != head.npos && lower(head.substr(start, 5)) == "solid" && head.find('\0') == head.npos;
}

Result<PlainMesh> plain_stl(std::string_view bytes, const Progress* progress) {
  // Many binary files begin with "solid" too: the size decides.
  if (is_binary_stl(bytes)) {
    Result<PlainMesh> mesh = plain_binary(bytes, progress);
    if (mesh && lower(bytes.substr(0, 5)) == "solid")
      mesh->warnings.push_back(
          {"stl-header", "the file begins with \"solid\", as text does, but is binary; it was read so"});
    return mesh;
  }
  if (is_text_stl(bytes)) return plain_text(bytes, progress);
  if (bytes.size() < kHeader)
    return invalid_mesh("the file is too short for an STL mesh; fetch or export it again");
  return invalid_mesh("the header promises " + std::to_string(load_u32(bytes, 80)) +
                      " triangles, which does not fit a file of " + std::to_string(bytes.size()) +
                      " bytes; the file is cut off, damaged or not an STL mesh, fetch or export it again");
}

}  // namespace mesocell
