#include <sys/stat.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <string_view>

#include "converters/import/height_file.h"
#include "converters/import/mesh_file.h"
#include "converters/import/sniff.h"
#include "tests/import/mesh_bytes.h"
#include "tests/import/messages.h"
#include "tests/import/picture_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

PaintedMesh painted(const std::string& path, MeshReadReport& report) {
  Result<PaintedMesh> mesh = read_painted_mesh(path, {}, &report);
  INFO(path << ": " << (mesh ? "" : mesh.error().message));
  REQUIRE(mesh.ok());
  return std::move(*mesh);
}

std::string big(std::uint32_t n) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) text += char(std::uint8_t(n >> shift));
  return text;
}
std::string big(float x) { return big(std::bit_cast<std::uint32_t>(x)); }

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

}  // namespace

TEST_CASE("OBJ: materials with colors and a picture, from the folder of the mesh") {
  const TempFolder folder;
  folder.write("a b.png", png_bytes(kFour));
  folder.write("two words.mtl",
               "newmtl red one\nKd 1 0.5 0\nnewmtl wood\nKd 1 1 1\nmap_Kd -s 1 1 1 -bm 2 a b.png\n"
               "newmtl twin\nmap_Kd C:\\textures\\a b.png\n");
  MeshReadReport report;
  const PaintedMesh mesh = painted(
      folder.write("a.obj", "mtllib two words.mtl\n" + kSquare +
                                "f 1 2 3\nusemtl wood\nf 1/1 2/2 3/3 4/4\nusemtl red one\nf 1/1 3/3 4/4\n"
                                "usemtl twin\nf -4/-4 -3/-3 -2/-2\n"),
      report);
  const SurfacePaint& paint = mesh.paint;
  CHECK(paint.material_indices == std::vector<std::uint32_t>{SurfacePaint::kNoMaterial, 0, 0, 1, 2});
  REQUIRE(paint.materials.size() == 3);
  CHECK(paint.materials[1].base_color == Vec3{1, 0.5, 0});
  CHECK_FALSE(paint.materials[1].texture);
  REQUIRE(paint.materials[0].texture);
  REQUIRE(paint.materials[2].texture);
  CHECK(paint.materials[2].texture->image == paint.materials[0].texture->image);
  REQUIRE(paint.images.size() == 1);
  CHECK(paint.images[0].texels == std::vector<Rgb8>{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}});
  CHECK(paint.uvs[1] == std::array<Uv, 3>{Uv{0, 1}, Uv{1, 1}, Uv{1, 0}});
  // The first face has none.
  CHECK(has(report, "uv-missing"));
  // The lower left of the square has the lower left of the picture.
  const PaintSampler sampler(mesh.mesh, paint, 1);
  CHECK(length(sampler.color(1, {1, 0, 0}) - Vec3{0, 0, 1}) < 1e-6);
  CHECK(sampler.color(0, {1, 0, 0}) == Vec3{1, 1, 1});
}

TEST_CASE("OBJ: what is missing of materials is a warning") {
  const TempFolder folder;
  REQUIRE(mkfifo(folder.file("pipe.mtl").c_str(), 0600) == 0);
  folder.write("no.png", "this is no picture");
  folder.write("some.mtl", "newmtl a\nmap_Kd none.png\nnewmtl b\nmap_Kd no.png\nKd 0 0 1\n");
  const auto read = [&](const std::string& head, const char* id) {
    MeshReadReport report;
    const PaintedMesh mesh = painted(
        folder.write(
            "a.obj",
            head + kSquare + "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 4/4\nusemtl c\nf 1/1 2/2 4/4\n"),
        report);
    INFO(head);
    CHECK(has(report, id));
    CHECK(mesh.mesh.triangles.size() == 3);
    CHECK(mesh.paint.images.empty());
    return mesh.paint;
  };
  CHECK(read("mtllib missing.mtl\n", "material-missing").empty());
  CHECK(read("mtllib pipe.mtl\n", "material-missing").empty());
  CHECK(read("mtllib /dev/zero\n", "material-missing").empty());
  const SurfacePaint paint = read("mtllib some.mtl\n", "texture-missing");
  REQUIRE(paint.materials.size() == 3);
  CHECK(paint.materials[1].base_color == Vec3{0, 0, 1});
  // Without materials their files are not looked for.
  MeshReadReport report;
  CHECK(read_mesh_file(folder.file("a.obj"), {}, &report).ok());
  CHECK(report.warnings.empty());
}

TEST_CASE("PLY: colors of faces, pictures, and strips as in the Stanford archive") {
  const TempFolder folder;
  const std::string vertices = "property float x\nproperty float y\nproperty float z\n";
  MeshReadReport report;
  PaintedMesh mesh = painted(
      folder.write("a.ply",
                   "ply\nformat ascii 1.0\nelement vertex 4\n" + vertices +
                       "element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\n"
                       "property uchar green\nproperty uchar blue\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
                       "4 0 1 2 3 9 8 7\n3 0 1 3 1 2 3\n"),
      report);
  CHECK(mesh.paint.face_colors == std::vector<Rgb8>{{9, 8, 7}, {9, 8, 7}, {1, 2, 3}});
  CHECK(mesh.mesh.colors.empty());

  folder.write("four.png", png_bytes(kFour));
  mesh = painted(
      folder.write("b.ply",
                   "ply\nformat ascii 1.0\ncomment TextureFile four.png\nelement vertex 4\n" + vertices +
                       "element face 1\nproperty list uchar float texcoord\n"
                       "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
                       "8 0 0 1 0 1 1 0 1 4 0 1 2 3\n"),
      report);
  REQUIRE(mesh.paint.images.size() == 1);
  CHECK(mesh.paint.uvs[1] == std::array<Uv, 3>{Uv{0, 1}, Uv{1, 0}, Uv{0, 0}});
  CHECK(mesh.paint.material_indices == std::vector<std::uint32_t>{0, 0});
  mesh = painted(
      folder.write("c.ply", "ply\nformat ascii 1.0\ncomment TextureFile four.png\nelement vertex 3\n" +
                                vertices +
                                "property float s\nproperty float t\nelement face 1\n"
                                "property list uchar int vertex_indices\nend_header\n"
                                "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n3 0 1 2\n"),
      report);
  REQUIRE(mesh.paint.uvs.size() == 1);
  CHECK(mesh.paint.uvs[0] == std::array<Uv, 3>{Uv{0, 1}, Uv{1, 1}, Uv{1, 0}});

  std::string strips = "ply\nformat binary_big_endian 1.0\nelement vertex 5\n" + vertices +
                       "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  for (int i = 0; i < 15; ++i) strips += big(float(i * i % 7));
  strips += big(9u);
  for (const std::uint32_t v : {0u, 1u, 2u, 3u, 4u, 0xffff'ffffu, 3u, 1u, 0u}) strips += big(v);
  mesh = painted(folder.write("d.ply", strips), report);
  CHECK(mesh.mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {3, 1, 0}});
}

TEST_CASE("OFF: colors of faces by every kind of number, and the binary encoding") {
  const TempFolder folder;
  const auto faces = [&](const std::string& first, const std::string& second) {
    MeshReadReport report;
    return painted(folder.write("a.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 " + first + "\n3 2 1 0 " +
                                             second + "\n"),
                   report)
        .paint.face_colors;
  };
  using Colors = std::vector<Rgb8>;
  CHECK(faces("255 0 51", "0 1 2") == Colors{{255, 0, 51}, {0, 1, 2}});
  CHECK(faces("1.0 0 0.2 0.5", "0 1 0 1") == Colors{{255, 0, 51}, {0, 255, 0}});
  CHECK(faces("255 0 51 255", "") == Colors{{255, 0, 51}, {255, 255, 255}});
  // An index into a table that nobody has is no color.
  CHECK(faces("12", "7").empty());
  CHECK(faces("12", "1 0 0") == Colors{{255, 255, 255}, {255, 0, 0}});

  std::string binary = "STCNOFF BINARY\n" + big(3u) + big(1u) + big(0u);
  for (int v = 0; v < 3; ++v) {
    for (int axis = 0; axis < 3; ++axis) binary += big(axis < 2 ? float(v == axis + 1) : 0.0f);
    for (int k = 0; k < 3; ++k) binary += big(9.0f);
    for (const float channel : {1.0f, 0.0f, float(v) / 2, 1.0f}) binary += big(channel);
    for (int k = 0; k < 2; ++k) binary += big(5.0f);
  }
  binary += big(3u) + big(0u) + big(1u) + big(2u) + big(1u) + big(7u);
  MeshReadReport report;
  const PaintedMesh mesh = painted(folder.write("b.off", binary), report);
  CHECK(mesh.mesh.triangles == std::vector<Triangle>{{0, 1, 2}});
  CHECK(mesh.mesh.vertices == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  CHECK(mesh.mesh.colors == Colors{{255, 0, 0}, {255, 0, 128}, {255, 0, 255}});
  for (std::size_t n = 16; n < binary.size(); ++n) {
    INFO(n);
    CHECK_FALSE(read_mesh_file(folder.write("c.off", binary.substr(0, n))).ok());
  }
}

TEST_CASE("a mesh is read as what it is, whatever its name") {
  const TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  const TempFolder folder;
  for (const MeshBytes& file : in_all_formats(box))
    for (const char* name : {"a.obj", "a.off", "a.ply", "a.stl", "a.glb", "a.drc", "a.xyz", "a"}) {
      INFO(file.name << " as " << name);
      MeshReadReport report;
      const Result<TriangleMesh> mesh = read_mesh_file(folder.write(name, file.bytes), {}, &report);
      REQUIRE(mesh.ok());
      CHECK(mesh->triangles.size() == 12);
      const bool same = file.name.substr(file.name.find('.')) == std::string_view(name).substr(1);
      CHECK(has(report, "renamed") == !same);
    }
}

TEST_CASE("what is no mesh is called by its name") {
  using namespace std::string_view_literals;
  const std::pair<std::string_view, std::string_view> kContents[] = {{" BDV\0\0\0\0\x7f"sv, "OpenVDB"},
                                                                     {"II*\0\x08\0\0\0"sv, "TIFF"},
                                                                     {"MM\0*\0\0\0\x08"sv, "TIFF"},
                                                                     {"II+\0\x08\0\0\0"sv, "TIFF"},
                                                                     {"#?RADIANCE\nFORMAT"sv, "HDR"},
                                                                     {"DDS |\0\0\0"sv, "DDS"},
                                                                     {"#INRIMAGE-4#{\n"sv, "INRIMAGE"},
                                                                     {"ObjectType = Image\n"sv, "Meta"},
                                                                     {"NRRD0004\n"sv, "NRRD"},
                                                                     {"GIF89a"sv, "GIF"},
                                                                     {"\x76\x2f\x31\x01\2"sv, "EXR"},
                                                                     {"PK\x03\x04"sv, "zip"},
                                                                     {"LASF\0\0"sv, "LAS"},
                                                                     {"UHL11180"sv, "DTED"},
                                                                     {" NCOLS  12\nnrows"sv, "ESRI"},
                                                                     {"\x89HDF\r\n\x1a\n\0"sv, "HDF5"}};
  for (const auto& [bytes, name] : kContents)
    CHECK(sniff_content(bytes).find(name) != std::string_view::npos);
  CHECK(sniff_content("DRACO\2\2\1\1"sv) == kDracoContent);
  CHECK(sniff_content(" \n{ \"asset\" : {}}"sv) == kGltfContent);
  CHECK(sniff_content("STCN4nOFF\n"sv) == kOffContent);
  for (const std::string_view nothing : {"OFFICE"sv, "BMW"sv, "{}"sv, ""sv, "v 1 2 3\n"sv, "solid x"sv})
    CHECK(sniff_content(nothing).empty());
  const TempFolder folder;
  for (const auto& [bytes, name] : kContents) {
    const auto mesh = read_mesh_file(folder.write("a.obj", std::string(bytes)));
    REQUIRE_FALSE(mesh.ok());
    CHECK(mesh.error().code == ErrorCode::kInvalidInput);
    CHECK(mesh.error().message.find(name) != std::string::npos);
  }
}

TEST_CASE("terrain that is not read is called by its name, with what to do") {
  const TempFolder folder;
  const auto refusal = [&](const std::string& name, const std::string& bytes) {
    const std::string path = folder.write(name, bytes);
    const auto mesh = read_mesh_file(path);
    REQUIRE_FALSE(mesh.ok());
    CHECK(mesh.error().code == ErrorCode::kInvalidInput);
    // By who wants heights, as well.
    const auto heights = read_height_file(path);
    REQUIRE_FALSE(heights.ok());
    CHECK(heights.error().message == mesh.error().message);
    return mesh.error().message;
  };
  // Level 1, a regular pattern, UTM; metres twice, four sides [USGS, Standards for Digital Elevation Models].
  std::string usgs(1024, ' ');
  const auto put = [&](std::size_t at, const char* text) { usgs.replace(at, std::strlen(text), text); };
  put(0, "SOME HILLS");
  put(144, "     1     1     1    10");
  put(528, "     2     2     4");
  CHECK(refusal("a.dem", usgs).find("a USGS digital elevation model, which is not read; convert it") !=
        std::string::npos);
  CHECK(refusal("a.dem", usgs).find("gdal_translate") != std::string::npos);
  for (const std::size_t at : {149u, 155u, 161u, 533u, 539u, 545u, 3u}) {
    INFO(at);
    std::string other = usgs;
    other[at] = at == 3 ? '\0' : '9';
    if (at == 161) other.replace(159, 3, "999");
    CHECK(sniff_content(other).empty());
  }
  CHECK(sniff_content(usgs.substr(0, 863)).empty());
  CHECK(refusal("a", "ncols 3\nnrows 2\n").find("ESRI ASCII grid, which is not read; convert") !=
        std::string::npos);
  CHECK(refusal("a.laz", "LASF" + std::string(300, '\1')).find("PDAL") != std::string::npos);
  CHECK(refusal("N46W122.HGT", std::string(2 * 1201 * 1201, '\1')).find("SRTM") != std::string::npos);
  CHECK(sniff_name(".hgt", 2 * 3601 * 3601) == sniff_name(".hgt", 2 * 1201 * 1201));
  CHECK(sniff_name(".hgt", 1201 * 1201).empty());
  CHECK(sniff_name(".raw", 2 * 1201 * 1201).empty());
  for (const std::string_view other : {"ncolsx 3", "ncols", "ncols x", "DS", ""})
    CHECK(sniff_content(other).empty());
  CHECK(terrain_remedy(kPlyContent).empty());
}

TEST_CASE("STL: a wrong header and normals that are not numbers are warnings") {
  const TempFolder folder;
  const TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  std::string bytes = mesh_bytes(box, "binary.stl");
  MeshReadReport report;
  CHECK(read_mesh_file(folder.write("a.stl", bytes), {}, &report).ok());
  CHECK(report.warnings.empty());
  bytes.replace(0, 10, "solid cube");
  bytes.replace(84, 4, "\xff\xff\xff\x7f");
  CHECK(read_mesh_file(folder.write("a.stl", bytes), {}, &report)->triangles.size() == 12);
  CHECK(has(report, "stl-header"));
  CHECK(has(report, "normal-not-finite"));
  std::string text = mesh_bytes(box, "text.stl");
  const std::size_t normal = text.find("normal ");
  REQUIRE(normal != text.npos);
  text.replace(normal + 7, 1, "nan 0");
  CHECK(read_mesh_file(folder.write("b.stl", text), {}, &report)->triangles.size() == 12);
  CHECK(has(report, "normal-not-finite"));
}
