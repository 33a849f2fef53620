#include <cmath>
#include <limits>
#include <string>

#include "converters/import/mesh_file.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

Result<TriangleMesh> read(const std::string& name, const std::string& bytes,
                          MeshReadReport* report = nullptr) {
  const TempFolder folder;
  return read_mesh_file(folder.write(name, bytes), {}, report);
}

}  // namespace

TEST_CASE("every format gives the same closed mesh") {
  const TriangleMesh torus = make_torus({0.5, -1, 2}, 1, 0.25, 24, 12);
  for (const MeshBytes& file : in_all_formats(torus)) {
    INFO(file.name);
    MeshReadReport report;
    const Result<TriangleMesh> mesh = read(file.name, file.bytes, &report);
    REQUIRE(mesh.ok());
    CHECK(report.polygons == torus.triangles.size());
    CHECK(report.dropped_faces == 0);
    CHECK(report.file_bytes == file.bytes.size());
    REQUIRE(mesh->vertices.size() == torus.vertices.size());
    REQUIRE(mesh->triangles.size() == torus.triangles.size());
    const bool stl = report.format == "STL";
    double furthest = 0;
    for (std::size_t t = 0; t < torus.triangles.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        furthest = std::max(
            furthest, length(mesh->vertices[mesh->triangles[t][i]] - torus.vertices[torus.triangles[t][i]]));
    CHECK(furthest <= (stl ? 3e-7 : 0.0));
  }
}

TEST_CASE("positions keep double precision far from the origin") {
  TriangleMesh box = make_box({1e6 + 0.001, 2e6 + 0.002, 0.1}, {1e6 + 0.004, 2e6 + 0.005, 0.2});
  for (const MeshBytes& file : in_all_formats(box)) {
    if (file.name.ends_with(".stl")) continue;
    INFO(file.name);
    const Result<TriangleMesh> mesh = read(file.name, file.bytes);
    REQUIRE(mesh.ok());
    CHECK(mesh->vertices == box.vertices);
  }
}

TEST_CASE("very large and very small coordinates are read as they are") {
  for (const double scale : {1e30, 1e-30, 1e200, 1e-200}) {
    const TriangleMesh box = make_box({-scale, -scale, -scale}, {scale, scale, scale});
    for (const char* name : {"mesh.obj", "mesh.off", "text.ply", "little.ply"}) {
      INFO(name << " " << scale);
      const Result<TriangleMesh> mesh = read(name, mesh_bytes(box, name));
      REQUIRE(mesh.ok());
      CHECK(mesh->vertices == box.vertices);
    }
  }
}

TEST_CASE("polygons become fans, and what hangs on the corners is passed over") {
  const std::string obj =
      "mtllib /dev/zero\no pyramid\nv 0 0 0\nv 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0\nv +.5 5e-1 1.\n"
      "vt 0 0\nvn 0 0 nan\nusemtl red\ns off\nf 4/1/1 3/1/1 2/1/1 1/1/1\n"
      "f 1//1 2//1 5//1\nf -4 -3 -1 # side\nf 3 4 \\\n 5\nf 4/ 1 5\n";
  MeshReadReport report;
  const Result<TriangleMesh> mesh = read("p.obj", obj, &report);
  REQUIRE(mesh.ok());
  CHECK(report.polygons == 5);
  CHECK(mesh->triangles ==
        std::vector<Triangle>{{3, 2, 1}, {3, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  CHECK(signed_volume(*mesh) == Approx(1.0 / 3));

  const std::string off =
      "# made by hand\nCOFF 5 5 0 # counts\n\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n1 1 0\n0 1 0\n.5 .5 1\n"
      "4 3 2 1 0 255 0 0\n3 0 1 4\n3 1 2 4 0.5 0.5 0.5\n\n3 2 3 4\n3 3 0 4\n";
  CHECK(read("p.off", off)->triangles == mesh->triangles);

  const std::string ply =
      "ply\r\nformat ascii 1.0\r\ncomment x\r\nobj_info y\r\nelement vertex 5\r\nproperty uchar "
      "red\r\nproperty float "
      "x\r\nproperty float y\r\nproperty float z\r\nproperty float nx\r\nelement face 5\r\nproperty uchar "
      "q\r\n"
      "property list int int vertex_index\r\nproperty list uchar float texcoord\r\nelement edge "
      "1\r\nproperty int a\r\n"
      "end_header\r\n9 0 0 0 nan\r\n9 1 0 0 0\r\n9 1 1 0 0\r\n9 0 1 0 0\r\n9 .5 .5 1 0\r\n"
      "7 4 3 2 1 0 2 .1 .2\r\n7 3 0 1 4 0\r\n7 3 1 2 4 0\r\n7 3 2 3 4 0\r\n7 3 3 0 4 1 5\r\n3\r\n";
  CHECK(read("p.ply", ply)->triangles == mesh->triangles);
}

TEST_CASE("a soup stays a soup: edges of three faces, double faces, unused vertices") {
  const std::string obj =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nv 9 9 9\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 3\nf 3 2 1\n";
  const Result<TriangleMesh> mesh = read("s.obj", obj);
  REQUIRE(mesh.ok());
  CHECK(mesh->vertices.size() == 6);
  CHECK(mesh->triangles == std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 1, 2}, {2, 1, 0}});
}

TEST_CASE("triangles with two equal corners are left out and counted") {
  MeshReadReport report;
  CHECK(
      read("d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 1 2 1 3\n", &report)->triangles.size() ==
      1);
  CHECK(report.dropped_faces == 3);
  TriangleMesh flat = make_box({0, 0, 0}, {1, 1, 1});
  flat.triangles.push_back({0, 0, 1});
  for (const char* name : {"text.stl", "binary.stl"}) {
    CHECK(read(name, mesh_bytes(flat, name), &report)->triangles.size() == 12);
    CHECK(report.dropped_faces == 1);
  }
}

TEST_CASE("the extension may be in capitals, and a binary STL may begin with solid") {
  const TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  std::string bytes = mesh_bytes(box, "binary.stl");
  bytes.replace(0, 10, "solid cube");
  const Result<TriangleMesh> mesh = read("BOX.STL", bytes);
  REQUIRE(mesh.ok());
  CHECK(mesh->triangles.size() == 12);
  CHECK(mesh->vertices.size() == 8);
}

TEST_CASE("a corner that is not finite is an error that names the vertex, elsewhere it harms nobody") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInf = std::numeric_limits<double>::infinity();
  for (const double bad : {kNan, kInf, -kInf}) {
    TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
    box.vertices.push_back({0, bad, 0});
    for (const MeshBytes& file : in_all_formats(box)) {
      INFO(file.name << " " << bad);
      const Result<TriangleMesh> mesh = read(file.name, file.bytes);
      REQUIRE(mesh.ok());
      CHECK(mesh->triangles.size() == 12);
      for (const Vec3& v : mesh->vertices) CHECK(is_finite(v));
    }
    box.vertices[5].z = bad;
    for (const MeshBytes& file : in_all_formats(box)) {
      INFO(file.name << " " << bad);
      const Result<TriangleMesh> mesh = read(file.name, file.bytes);
      REQUIRE(!mesh.ok());
      CHECK(mesh.error().code == ErrorCode::kInvalidInput);
      CHECK(mesh.error().message.find("not finite") != std::string::npos);
      if (file.name == "mesh.off") CHECK(mesh.error().message.find("vertex 5 ") != std::string::npos);
      if (file.name == "mesh.obj") CHECK(mesh.error().message.find("vertex 6 ") != std::string::npos);
    }
  }
}
