#include "converters/export/mesh_writer.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "converters/export/mesh_export.h"
#include "converters/import/mesh_file.h"
#include "sdk/membership/diagnose.h"
#include "tests/export/surfaces.h"
#include "tests/support/catch.h"
#include "tests/support/folder.h"
#include "tests/support/shapes.h"
#include "tests/support/voxel_objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

std::string content(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

bool contains(const std::vector<std::string>& losses, const std::string& text) {
  return std::any_of(losses.begin(), losses.end(),
                     [&](const std::string& l) { return l.find(text) != std::string::npos; });
}

}  // namespace

TEST_CASE("written surfaces come back with equal vertices, triangles and colors, and closed") {
  const Folder folder(in_memory());
  const CellObject o = colored_object();
  SurfaceOptions options;
  options.colors = true;
  options.normals = SurfaceNormals::kShading;
  const auto surface = make_explicit_surface(o, options);
  REQUIRE(surface.ok());
  REQUIRE(surface->split_vertices > 0);
  for (const char* name : {"a.obj", "a.OFF", "a.ply", "a.stl"}) {
    INFO(name);
    MeshWriteReport report;
    const Status written = write_mesh_file(view_of(*surface, o.grid), folder / name, {}, &report);
    REQUIRE(written.ok());
    CHECK(report.bytes == std::filesystem::file_size(folder / name));
    const auto back = read_mesh_file(folder / name);
    REQUIRE(back.ok());
    REQUIRE(back->triangles.size() == surface->triangle_count());
    const bool stl = std::string(name) == "a.stl";
    if (!stl) {
      REQUIRE(back->vertices.size() == surface->vertices.size());
      for (std::size_t v = 0; v < back->vertices.size(); ++v)
        REQUIRE(back->vertices[v] == lattice_point(o.grid, surface->vertices[v]));
      for (std::size_t k = 0; k < back->triangles.size(); ++k)
        REQUIRE(back->triangles[k] == surface->triangle(k));
      REQUIRE(back->colors == surface->colors);
    } else {
      CHECK(contains(report.losses, "single precision, by at most"));
      CHECK(contains(report.losses, "colors"));
      for (std::size_t k = 0; k < back->triangles.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c) {
          const Vec3 p = lattice_point(o.grid, surface->vertices[surface->triangle(k)[c]]);
          REQUIRE(back->vertices[back->triangles[k][c]] ==
                  Vec3{double(float(p.x)), double(float(p.y)), double(float(p.z))});
        }
    }
    CHECK(contains(report.losses, "normals") == (stl || std::string(name) == "a.OFF"));
    const MeshDiagnosis diagnosis = diagnose(*back, {DiagnosisDepth::kTopology});
    CHECK(diagnosis.closed());
    CHECK(diagnosis.duplicate_triangles == 0);
    CHECK(signed_volume(*back) == Approx(inside_volume(o)).epsilon(stl ? 1e-3 : 1e-9));
    // The same mesh gives the same bytes.
    REQUIRE(write_mesh_file(view_of(*surface, o.grid), folder / "again" + name).ok());
    CHECK(content(folder / name) == content(folder / "again" + name));
  }
  const std::string ply = content(folder / "a.ply");
  CHECK(ply.find("property float nz") < ply.find("end_header"));
  CHECK(content(folder / "a.obj").find("\nvn ") != std::string::npos);
}

TEST_CASE("a mesh in double precision comes back to the bit") {
  const Folder folder(in_memory());
  TriangleMesh mesh = make_sphere({1e-3, 1e6 / 3, -7}, 0.37, 12);
  for (const char* name : {"a.obj", "a.off", "a.ply"}) {
    REQUIRE(write_mesh_file(view_of(mesh), folder / name).ok());
    const auto back = read_mesh_file(folder / name);
    REQUIRE(back.ok());
    CHECK(back->vertices == mesh.vertices);
    CHECK(back->triangles == mesh.triangles);
    CHECK(back->colors.empty());
  }
}

TEST_CASE("an STL whose vertices would fall together is refused") {
  const Folder folder(in_memory());
  CellObject o = make_voxels({1, 1, 1}, [](auto x, auto y, auto z) { return x + y + z < 5; });
  o.grid.voxel_edge = 1e-3;
  const auto surface = make_explicit_surface(o);
  o.grid.box_min = {100, 0, 0};
  CHECK(write_mesh_file(view_of(*surface, o.grid), folder / "near.stl").ok());
  o.grid.box_min = {1e5, 0, 0};
  const Status far = write_mesh_file(view_of(*surface, o.grid), folder / "far.stl");
  REQUIRE(!far.ok());
  CHECK(far.error().code == ErrorCode::kLimit);
  CHECK(!std::filesystem::exists(folder / "far.stl"));
  CHECK(write_mesh_file(view_of(*surface, o.grid), folder / "far.ply").ok());
  // Where nothing is known of steps, vertices are compared.
  TriangleMesh mesh = make_box({1e5, 0, 0}, {1e5 + 1e-3, 1, 1});
  CHECK(write_mesh_file(view_of(mesh), folder / "far.stl").error().code == ErrorCode::kLimit);
  CHECK(write_mesh_file(view_of(make_box({1e5, 0, 0}, {1e5 + 1, 1, 1})), folder / "far.stl").ok());
}

TEST_CASE("exports say what they refuse, and leave nothing behind") {
  const Folder folder(in_memory());
  const CellObject o = colored_object();
  const auto refused = [&](const std::string& name, const MeshExportOptions& options) {
    const Status status = write_mesh_export(o, folder / name, options);
    REQUIRE(!status.ok());
    return status.error().code;
  };
  MeshExportOptions options;
  CHECK(refused("a.xyz", options) == ErrorCode::kUsage);
  options.max_faces = 10;
  CHECK(refused("a.ply", options) == ErrorCode::kLimit);
  options = {};
  options.draco = true;
  CHECK(refused("a.ply", options) == ErrorCode::kUsage);
  options = {};
  options.drop_buried = true;
  CHECK(refused("a.glb", options) == ErrorCode::kUsage);
  CHECK(write_mesh_export(o, folder / "no/a.ply").error().code == ErrorCode::kOutput);
  CHECK(write_mesh_export(o, "/dev/full").error().code == ErrorCode::kUsage);
  CHECK(folder.count() == 0);
  REQUIRE(write_mesh_export(o, folder / "a.ply").ok());
  options = {};
  options.no_clobber = true;
  CHECK(refused("a.ply", options) == ErrorCode::kOutput);
  const std::atomic<bool> stop = true;
  Progress progress;
  progress.cancel = &stop;
  CHECK(write_mesh_export(o, folder / "b.ply", {}, nullptr, &progress).error().code == ErrorCode::kCancelled);
  CHECK(folder.count() == 1);
}

TEST_CASE("an export reports what it wrote, and takes a box of tiles") {
  const Folder folder(in_memory());
  const CellObject o = colored_object();
  MeshExportOptions options;
  options.colors = true;
  options.tiles = TileBox{{1, 1, 0}, {2, 3, 2}};
  MeshExportReport report;
  REQUIRE(write_mesh_export(o, folder / "a.ply", options, &report).ok());
  const auto back = read_mesh_file(folder / "a.ply");
  REQUIRE(back.ok());
  CHECK(report.triangles == back->triangles.size());
  CHECK(report.faces * 2 == report.triangles);
  CHECK(report.vertices == back->vertices.size());
  CHECK(report.bytes == std::filesystem::file_size(folder / "a.ply"));
  CHECK(report.seconds.size() == 2);
  CHECK(diagnose(*back).closed());
  SurfaceOptions same;
  same.tiles = options.tiles;
  CHECK(*count_surface_faces(o, same) == report.faces);
}
