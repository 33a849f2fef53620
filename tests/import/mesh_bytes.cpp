#include "tests/import/mesh_bytes.h"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace mesocell::test {
namespace {

std::string number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

std::string words(const Vec3& p) { return number(p.x) + " " + number(p.y) + " " + number(p.z); }

std::string words(const Triangle& t, std::uint32_t first) {
  return std::to_string(t[0] + first) + " " + std::to_string(t[1] + first) + " " +
         std::to_string(t[2] + first);
}

template <typename Bits>
void put(std::string& out, Bits bits, bool big = false) {
  for (std::size_t i = 0; i < sizeof(Bits); ++i) {
    const std::size_t shift = 8 * (big ? sizeof(Bits) - 1 - i : i);
    out += char(std::uint8_t(bits >> shift));
  }
}

std::string obj(const TriangleMesh& mesh) {
  std::string out = "# a comment\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    out += "v " + words(mesh.vertices[i]);
    for (std::size_t k = 0; k < 3 && !mesh.colors.empty(); ++k)
      out += " " + number(mesh.colors[i][k] / 255.0);
    out += "\n";
  }
  for (const Triangle& t : mesh.triangles) out += "f " + words(t, 1) + "\n";
  return out;
}

std::string off(const TriangleMesh& mesh) {
  std::string out = mesh.colors.empty() ? "OFF\n" : "COFF\n";
  out += std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    out += words(mesh.vertices[i]);
    for (std::size_t k = 0; k < 3 && !mesh.colors.empty(); ++k)
      out += " " + std::to_string(mesh.colors[i][k]);
    out += mesh.colors.empty() ? "\n" : " 255\n";
  }
  for (const Triangle& t : mesh.triangles) out += "3 " + words(t, 0) + "\n";
  return out;
}

std::string ply(const TriangleMesh& mesh, const std::string& encoding) {
  std::string out =
      "ply\nformat " + encoding + " 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
      "\nproperty double x\nproperty double y\nproperty double z\n" +
      (mesh.colors.empty() ? "" : "property uchar red\nproperty uchar green\nproperty uchar blue\n") +
      "element face " + std::to_string(mesh.triangles.size()) +
      "\nproperty list uchar uint vertex_indices\nend_header\n";
  const bool text = encoding == "ascii", big = encoding == "binary_big_endian";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3& p = mesh.vertices[i];
    if (text) out += words(p);
    for (std::size_t a = 0; a < 3 && !text; ++a) put(out, std::bit_cast<std::uint64_t>(p[a]), big);
    for (std::size_t k = 0; k < 3 && !mesh.colors.empty(); ++k)
      out += text ? " " + std::to_string(mesh.colors[i][k]) : std::string(1, char(mesh.colors[i][k]));
    if (text) out += "\n";
  }
  for (const Triangle& t : mesh.triangles) {
    if (text) {
      out += "3 " + words(t, 0) + "\n";
      continue;
    }
    out += char(3);
    for (const std::uint32_t v : t) put(out, v, big);
  }
  return out;
}

std::string stl_text(const TriangleMesh& mesh) {
  std::string out = "solid mesh\n";
  for (const Triangle& t : mesh.triangles) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t v : t) out += "vertex " + words(mesh.vertices[v]) + "\n";
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid mesh\n";
}

std::string stl_binary(const TriangleMesh& mesh) {
  std::string out(80, ' ');
  put(out, std::uint32_t(mesh.triangles.size()));
  for (const Triangle& t : mesh.triangles) {
    out += std::string(12, '\0');
    for (const std::uint32_t v : t)
      for (std::size_t a = 0; a < 3; ++a) put(out, std::bit_cast<std::uint32_t>(float(mesh.vertices[v][a])));
    out += std::string(2, '\0');
  }
  return out;
}

}  // namespace

std::vector<MeshBytes> in_all_formats(const TriangleMesh& mesh) {
  return {{"mesh.obj", obj(mesh)},
          {"mesh.off", off(mesh)},
          {"text.ply", ply(mesh, "ascii")},
          {"little.ply", ply(mesh, "binary_little_endian")},
          {"big.ply", ply(mesh, "binary_big_endian")},
          {"text.stl", stl_text(mesh)},
          {"binary.stl", stl_binary(mesh)}};
}

std::string mesh_bytes(const TriangleMesh& mesh, const std::string& name) {
  for (const MeshBytes& m : in_all_formats(mesh))
    if (m.name == name) return m.bytes;
  std::abort();
}

TempFolder::TempFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "mesocell-test-XXXXXX").string();
  if (!mkdtemp(name.data())) std::abort();
  path_ = name;
}

TempFolder::~TempFolder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

std::string TempFolder::write(const std::string& name, const std::string& bytes) const {
  std::ofstream(file(name), std::ios::binary) << bytes;
  return file(name);
}

std::vector<std::string> TempFolder::list() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string read_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace mesocell::test
