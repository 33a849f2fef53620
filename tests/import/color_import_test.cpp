#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "converters/import/mesh_file.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

constexpr Rgb8 kWhite{255, 255, 255};

using VertexColors = std::vector<Rgb8>;

/// The colors of a file that must be readable; the report must agree with them.
VertexColors colors_of(const std::string& name, const std::string& bytes) {
  const TempFolder folder;
  MeshReadReport report;
  const Result<TriangleMesh> mesh = read_mesh_file(folder.write(name, bytes), {}, &report);
  INFO(name << ": " << (mesh ? std::string() : mesh.error().message) << "\n" << bytes.substr(0, 400));
  REQUIRE(mesh.ok());
  CHECK(report.vertex_colors == !mesh->colors.empty());
  CHECK((mesh->colors.empty() || mesh->colors.size() == mesh->vertices.size()));
  return mesh->colors;
}

/// A text PLY of one triangle; `rows`: what follows each vertex's position.
std::string ply(const std::string& properties, const std::array<std::string, 3>& rows) {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
         properties + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 " + rows[0] +
         "\n1 0 0 " + rows[1] + "\n0 1 0 " + rows[2] + "\n3 0 1 2\n";
}

std::string rgb(const std::string& type, const std::string& prefix = "") {
  std::string text;
  for (const char* name : {"red", "green", "blue"}) text += "property " + type + " " + prefix + name + "\n";
  return text;
}

/// The rows follow the positions of three vertices.
std::string obj(const std::array<std::string, 3>& rows) {
  return "v 0 0 0 " + rows[0] + "\nv 1 0 0 " + rows[1] + "\nv 0 1 0 " + rows[2] + "\nf 1 2 3\n";
}
std::string off(const std::string& keyword, const std::array<std::string, 3>& rows) {
  return keyword + "\n3 1 0\n0 0 0 " + rows[0] + "\n1 0 0 " + rows[1] + "\n0 1 0 " + rows[2] +
         "\n3 0 1 2 9 8 7\n";
}

}  // namespace

TEST_CASE("every format that has vertex colors gives them as they are") {
  TriangleMesh sphere = make_sphere({0, 0, 0}, 1, 24);
  for (std::size_t i = 0; i < sphere.vertices.size(); ++i)
    sphere.colors.push_back({std::uint8_t(i), std::uint8_t(255 - i), std::uint8_t(i * 7)});
  REQUIRE(sphere.vertices.size() > 256);
  for (const MeshBytes& file : in_all_formats(sphere)) {
    INFO(file.name);
    CHECK(colors_of(file.name, file.bytes) == (file.name.ends_with("stl") ? VertexColors{} : sphere.colors));
  }
  sphere.colors.clear();
  for (const MeshBytes& file : in_all_formats(sphere)) CHECK(colors_of(file.name, file.bytes).empty());
}

TEST_CASE("PLY: the type of a channel says its range") {
  const VertexColors expected = {{255, 0, 128}, {0, 51, 255}, {1, 2, 3}};
  for (const char* type : {"uchar", "uint8", "int", "uint", "short"})
    CHECK(colors_of("a.ply", ply(rgb(type), {"255 0 128", "0 51 255", "1 2 3"})) == expected);
  for (const char* type : {"ushort", "uint16"})
    CHECK(colors_of("a.ply", ply(rgb(type), {"65535 0 32896", "0 13107 65535", "257 514 771"})) == expected);
  for (const char* type : {"float", "double", "float32"})
    CHECK(colors_of("a.ply", ply(rgb(type), {"1 0 .502", "0 .2 1", "0.004 0.008 0.012"})) == expected);
  const std::string mixed = "property ushort red\nproperty uchar green\nproperty float blue\n";
  CHECK(colors_of("a.ply", ply(mixed, {"65535 0 .502", "0 51 1", "257 2 0.012"})) == expected);
}

TEST_CASE("PLY: where the channels stand and what they are called") {
  const std::array<std::string, 3> rows = {"1 2 3", "4 5 6", "7 8 9"};
  const VertexColors expected = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  CHECK(colors_of("a.ply", ply(rgb("uchar", "diffuse_"), rows)) == expected);
  CHECK(colors_of("a.ply", ply(rgb("uchar") + "property uchar alpha\n",
                               {"1 2 3 0", "4 5 6 0", "7 8 9 255"})) == expected);
  // Reversed, with others between them, and beside diffuse ones.
  CHECK(colors_of("a.ply", ply("property list uchar int q\nproperty uchar blue\nproperty float nx\n"
                               "property uchar green\nproperty uchar red\n" +
                                   rgb("uchar", "diffuse_"),
                               {"0 3 nan 2 1 99 99 99", "2 0 0 6 inf 5 4 99 99 99",
                                "1 1 9 .5 8 7 99 99 99"})) == expected);
  for (const char* no_color : {"property uchar red\nproperty uchar green\nproperty uchar alpha\n",
                               "property uchar r\nproperty uchar g\nproperty uchar b\n",
                               "property uchar red\nproperty uchar green\nproperty uchar diffuse_blue\n",
                               "property uchar Red\nproperty uchar Green\nproperty uchar Blue\n"})
    CHECK(colors_of("a.ply", ply(no_color, rows)).empty());
  CHECK(colors_of("a.ply", ply("property list uchar uchar red\nproperty uchar green\nproperty uchar blue\n",
                               {"1 2 3 4", "0 5 6", "1 7 8 9"}))
            .empty());
}

TEST_CASE("PLY: colors of faces are not colors of vertices") {
  const std::string bytes =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement "
      "face 1\nproperty list uchar int vertex_indices\n" +
      rgb("uchar") + "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 10 20 30\n";
  CHECK(colors_of("a.ply", bytes).empty());
}

TEST_CASE("PLY: channels of both byte orders") {
  for (const bool big : {false, true}) {
    std::string bytes =
        std::string("ply\nformat binary_") + (big ? "big" : "little") +
        "_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property ushort red\nproperty double green\nproperty float blue\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    const auto put = [&](const auto& value) {
      std::array<char, sizeof value> raw{};
      std::memcpy(raw.data(), &value, sizeof value);
      if (big != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
      bytes.append(raw.data(), raw.size());
    };
    const std::array<std::array<float, 3>, 3> positions = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const std::array<std::uint16_t, 3> red = {0x0101, 0xff00, 0x00ff};
    const std::array<double, 3> green = {0.25, 7, std::numeric_limits<double>::infinity()};
    const std::array<float, 3> blue = {1.0f, -1.0f, -std::numeric_limits<float>::infinity()};
    for (std::size_t i = 0; i < 3; ++i) {
      for (const float x : positions[i]) put(x);
      put(red[i]);
      put(green[i]);
      put(blue[i]);
    }
    bytes += char(3);
    for (const std::int32_t v : {0, 1, 2}) put(v);
    CHECK(colors_of("a.ply", bytes) == VertexColors{{1, 64, 255}, {254, 255, 0}, {1, 255, 0}});
  }
}

TEST_CASE("PLY: channels beyond their range are held to it, and what is no number is white") {
  CHECK(colors_of("a.ply", ply(rgb("uchar"), {"256 -1 1e300", "nan 0 0", "254.6 0.4 0"})) ==
        VertexColors{{255, 0, 255}, kWhite, {255, 0, 0}});
  CHECK(colors_of("a.ply", ply(rgb("float"), {"1e39 -1e39 inf", "0 nan 0", "-inf -0 1e-320"})) ==
        VertexColors{{255, 0, 255}, kWhite, {0, 0, 0}});
  CHECK(colors_of("a.ply", ply(rgb("float"), {"nan nan nan", "nan 1 1", "1 1 nan"})).empty());
}

TEST_CASE("OBJ: three numbers after the position are a color, a fourth is alpha, and one alone is a weight") {
  CHECK(colors_of("a.obj", obj({"1 0 0.502", "0 0.2 1 0.5", "0 0 0 # black"})) ==
        VertexColors{{255, 0, 128}, {0, 51, 255}, {0, 0, 0}});
  CHECK(colors_of("a.obj", obj({"1", "0.5", "1"})).empty());
  CHECK(colors_of("a.obj", obj({"1 1", "", "0.5 0.5"})).empty());
  CHECK(colors_of("a.obj", obj({"# 1 0 0", "# 1 0 0", ""})).empty());
  CHECK(colors_of("a.obj", obj({"1 \\\n 0 0", "0 1 0", "0 \\\r\n0\\\r\n 1"})) ==
        VertexColors{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}});
}

TEST_CASE("OBJ: vertices without a color are white if others have one") {
  const Rgb8 red{255, 0, 0};
  CHECK(colors_of("a.obj", obj({"", "1 0 0", "1"})) == VertexColors{kWhite, red, kWhite});
  CHECK(colors_of("a.obj", obj({"", "", "1 0 0"})) == VertexColors{kWhite, kWhite, red});
  CHECK(colors_of("a.obj", obj({"1 0 0", "x y z", "1 0 x"})) == VertexColors{red, kWhite, kWhite});
  CHECK(colors_of("a.obj", obj({"nan nan nan", "1 0 nan", "1 0 0"})) == VertexColors{kWhite, kWhite, red});
  CHECK(colors_of("a.obj", obj({"nan nan nan", "1 0 nan", "a b c"})).empty());
}

TEST_CASE("OBJ: channels beyond their range are held to it") {
  CHECK(colors_of("a.obj", obj({"1.5 -0.5 inf", "1e999 -1e999 -inf", "255 128 1e-999"})) ==
        VertexColors{{255, 0, 255}, {255, 0, 0}, {255, 255, 0}});
}

TEST_CASE("OFF: only a C in the keyword announces colors, and an N normals before them") {
  const std::array<std::string, 3> rows = {"10 20 30 255", "40 50 60 255", "70 80 90 255"};
  const VertexColors expected = {{10, 20, 30}, {40, 50, 60}, {70, 80, 90}};
  CHECK(colors_of("a.off", off("COFF", rows)) == expected);
  CHECK(colors_of("a.off", off("STCOFF", {"10 20 30 .5 .5", "40 50 60 1 0", "70 80 90"})) == expected);
  for (const char* keyword : {"OFF", "NOFF", "STOFF", "STNOFF"})
    CHECK(colors_of("a.off", off(keyword, rows)).empty());
  for (const char* keyword : {"CNOFF", "NCOFF", "STCNOFF"})
    CHECK(colors_of("a.off", off(keyword, {"0 0.5 1e0 10 20 30 255", "0 0 1 40 50 60",
                                           "nan x y 70 80 90 # z"})) == expected);
  CHECK(colors_of("a.off", off("CNOFF", {"10 20 30", "40 50 60", "70 80 90"})).empty());
  // The file that needs no keyword's line: it may stand beside the counts.
  CHECK(colors_of("a.off", "COFF 3 1 0\n0 0 0 1 2 3\n1\n0\n0 4 5 6\n0 1 0 7 8 9\n3 0 1 2\n") ==
        VertexColors{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}});
}

TEST_CASE("OFF: all channels together tell whether they go up to 255 or to 1") {
  const auto read = [](const std::array<std::string, 3>& rows) {
    return colors_of("a.off", off("COFF", rows));
  };
  CHECK(read({"1 0 0 1", "0 1 0 1", "0 0 1 1"}) == VertexColors{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}});
  CHECK(read({"1 0 0 1", "0 1 0 1", "0 0 2 1"}) == VertexColors{{1, 0, 0}, {0, 1, 0}, {0, 0, 2}});
  CHECK(read({"1.0 0 0", "0 0.502 0", "0 0 2e-1"}) == VertexColors{{255, 0, 0}, {0, 128, 0}, {0, 0, 51}});
  // Alpha does not count: some write it as a share beside whole numbers.
  CHECK(read({"255 0 0 1.0", "0 128 0 0.5", "0 0 51 1.0"}) ==
        VertexColors{{255, 0, 0}, {0, 128, 0}, {0, 0, 51}});
  CHECK(read({"1.5 -1 0", "inf -inf 0.2", "0 0 0"}) == VertexColors{{255, 0, 0}, {255, 0, 51}, {0, 0, 0}});
  CHECK(read({"256 -1 99999999999999999999", "0 0 0", "1 1 1"}) ==
        VertexColors{{255, 0, 255}, {0, 0, 0}, {1, 1, 1}});
}

TEST_CASE("OFF: vertices without a color are white if others have one") {
  CHECK(colors_of("a.off", off("COFF", {"", "1 2 3", "7"})) == VertexColors{kWhite, {1, 2, 3}, kWhite});
  CHECK(colors_of("a.off", off("COFF", {"1 x 3", "nan 2 3", "4 5 6"})) ==
        VertexColors{kWhite, kWhite, {4, 5, 6}});
  CHECK(colors_of("a.off", off("COFF", {"", "7", "# 1 2 3"})).empty());
}

TEST_CASE("a vertex at no place keeps the others' colors where they are") {
  CHECK(colors_of("a.obj", "v nan 0 0 1 1 0\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 2 3 4\n") ==
        VertexColors{{255, 255, 0}, {255, 0, 0}, {0, 255, 0}, {0, 0, 255}});
}

TEST_CASE("colored meshes from elsewhere") {
  const auto knot = find_data("meshes/knot_orig_metro.ply"), cube = find_data("defects/nancolor.obj");
  if (!knot || !cube) {
    WARN("skipped: the test data are not there");
    return;
  }
  MeshReadReport report;
  const Result<TriangleMesh> a = read_mesh_file(*knot, {}, &report);
  REQUIRE(a.ok());
  CHECK(report.vertex_colors);
  REQUIRE(a->colors.size() == 12800);
  const Result<TriangleMesh> b = read_mesh_file(*cube);
  REQUIRE(b.ok());
  REQUIRE(b->colors.size() == 8);
  CHECK(b->colors[0] == Rgb8{137, 254, 138});
  CHECK(b->colors[6] == kWhite);  // it is nan nan nan
}
