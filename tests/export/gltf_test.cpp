#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "converters/export/gltf_writer.h"
#include "converters/export/mesh_export.h"
#include "converters/import/mesh_file.h"
#include "sdk/core/srgb.h"
#include "tests/export/glb_reader.h"
#include "tests/export/surfaces.h"
#include "tests/support/folder.h"
#include "tests/support/voxel_objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Runs tests/export/gltf_tool.cjs; its output, or none if it fails.
std::optional<std::string> run_tool(const std::string& arguments) {
  const std::string command =
      "node '" MESOCELL_SOURCE_DIR "/tests/export/gltf_tool.cjs' " + arguments + " 2>/dev/null";
  FILE* const pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe);
  std::string out;
  char part[4096];
  for (std::size_t n = 0; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) out.append(part, n);
  const int code = ::pclose(pipe);
  if (!WIFEXITED(code) || WEXITSTATUS(code) != 0) return std::nullopt;
  return out;
}

/// Whether node and what it needs are there; says so if not.
bool has_tools() {
  if (run_tool("check")) return true;
  WARN("skipped: MESOCELL_GLTF_TOOLS names no folder with gltf-validator, @gltf-transform and draco3dgltf");
  return false;
}

void check_valid(const std::string& path) {
  const auto report = run_tool("validate '" + path + "'");
  REQUIRE(report);
  INFO(*report);
  CHECK(report->substr(0, report->find('\n')) == "0");
}

struct Decoded {
  std::multiset<LatticeTriangle> triangles;
  std::vector<std::string> attributes;
  std::size_t vertices = 0, meshes = 0;
};

Decoded decode(const std::string& path) {
  const auto text = run_tool("decode '" + path + "'");
  REQUIRE(text);
  Decoded out;
  std::istringstream lines(*text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    if (line.starts_with("mesh")) {
      std::size_t vertices = 0;
      words >> line >> vertices;
      out.vertices += vertices;
      ++out.meshes;
    } else if (line.starts_with("attribute")) {
      out.attributes.push_back(line.substr(10));
    } else {
      LatticeTriangle t;
      for (auto& corner : t)
        for (auto& x : corner) {
          double number = 0;
          REQUIRE(words >> number);
          // Exactly whole numbers.
          REQUIRE(number == double(std::int32_t(number)));
          x = std::int32_t(number);
        }
      out.triangles.insert(turned(t));
    }
  }
  return out;
}

ExplicitSurface colored_surface(const CellObject& o) {
  SurfaceOptions options;
  options.colors = true;
  options.normals = SurfaceNormals::kShading;
  auto surface = make_explicit_surface(o, options);
  REQUIRE(surface.ok());
  return std::move(*surface);
}

}  // namespace

TEST_CASE("a GLB holds the surface's lattice, a node makes metres of it") {
  const Folder folder(in_memory());
  const CellObject o = colored_object();
  const ExplicitSurface s = colored_surface(o);
  std::uint64_t bytes = 0;
  REQUIRE(write_gltf(s, o.grid, folder / "a.glb", {}, &bytes).ok());
  CHECK(bytes == std::filesystem::file_size(folder / "a.glb"));
  const Glb glb(folder / "a.glb");
  const auto base = least_of(s);
  CHECK(glb.triangles(0) == triangles_of(s, base));
  CHECK(glb.json["asset"]["version"] == "2.0");
  CHECK(!glb.json.contains("extensionsUsed"));
  const auto& node = glb.json["nodes"][0];
  const Vec3 at = lattice_point(o.grid, base);
  for (std::size_t a = 0; a < 3; ++a) {
    CHECK(node["translation"][a].get<double>() == at[a]);
    CHECK(node["scale"][a].get<double>() == o.grid.voxel_edge);
  }
  const auto& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
  const auto normals = glb.numbers(attributes["NORMAL"]);
  REQUIRE(normals.size() == 3 * s.vertices.size());
  for (std::size_t k = 0; k < normals.size(); ++k) REQUIRE(normals[k] == s.normals[k / 3][k % 3]);
  const auto colors = glb.numbers(attributes["COLOR_0"]);
  REQUIRE(colors.size() == 4 * s.vertices.size());
  for (std::size_t v = 0; v < s.vertices.size(); ++v) {
    for (std::size_t a = 0; a < 3; ++a) {
      // Linear, and finer than the steps of sRGB.
      REQUIRE(std::abs(colors[4 * v + a] / 65535 - srgb_to_linear(s.colors[v][a])) < 1e-5);
      REQUIRE(linear_to_srgb8(colors[4 * v + a] / 65535) == s.colors[v][a]);
    }
    REQUIRE(colors[4 * v + 3] == 65535);
  }
  const auto& positions = glb.json["accessors"][attributes["POSITION"].get<std::size_t>()];
  const auto numbers = glb.numbers(attributes["POSITION"]);
  for (std::size_t a = 0; a < 3; ++a) {
    double low = 1e9, high = -1e9;
    for (std::size_t k = a; k < numbers.size(); k += 3) {
      low = std::min(low, numbers[k]);
      high = std::max(high, numbers[k]);
    }
    CHECK(positions["min"][a] == low);
    CHECK(positions["max"][a] == high);
  }
}

TEST_CASE("indices have 32 bits from 65536 vertices on") {
  const Folder folder(in_memory());
  for (const std::uint32_t n : {10u, 20u}) {
    // Every other voxel alone, eight vertices each: 64000, and 512000.
    const CellObject o =
        make_voxels({n, n, n}, [](auto x, auto y, auto z) { return x % 2 && y % 2 && z % 2; });
    REQUIRE(write_mesh_export(o, folder / "a.glb").ok());
    const Glb glb(folder / "a.glb");
    const auto& indices =
        glb.json["accessors"][glb.json["meshes"][0]["primitives"][0]["indices"].get<std::size_t>()];
    CHECK(indices["componentType"] == (n == 10 ? 5123 : 5125));
    CHECK(glb.triangles(0).size() == std::size_t{12} * 2 * n * 2 * n * 2 * n);
  }
}

TEST_CASE("instances in a GLB are the surface of the object, cell by cell") {
  const Folder folder(in_memory());
  CellObject o = colored_object();
  o.instance_colors.emplace();
  for (std::uint64_t k = 0; k < count_instances(o.membership).inside; ++k)
    o.instance_colors->colors.push_back({std::uint8_t(k), std::uint8_t(k >> 3), 77});
  MeshExportOptions options;
  options.instanced = true;
  options.colors = true;
  MeshExportReport report;
  REQUIRE(write_mesh_export(o, folder / "a.glb", options, &report).ok());
  CHECK(report.instances == count_instances(o.membership).inside);
  const Glb glb(folder / "a.glb");
  CHECK(glb.json["extensionsRequired"] == nlohmann::json{"EXT_mesh_gpu_instancing"});
  const auto cells = make_cell_surfaces(o.tile, 1 << 28);
  REQUIRE(glb.json["nodes"].size() == o.tile.cell_count);
  std::size_t placed = 0;
  for (std::size_t c = 0; c < o.tile.cell_count; ++c) {
    const auto& node = glb.json["nodes"][c];
    CHECK(glb.triangles(node["mesh"]) == triangles_of((*cells)[c]));
    const auto places =
        glb.numbers(node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"]);
    const auto colors = glb.numbers(node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["_COLOR_0"]);
    REQUIRE(colors.size() == places.size());
    for (std::size_t k = 0; k < places.size(); k += 3) {
      Index3 tile{};
      for (std::size_t a = 0; a < 3; ++a) {
        // Node and translation together give the corner of the home tile.
        const double middle =
            std::round((node["translation"][a].get<double>() - o.grid.box_min[a]) / o.grid.voxel_edge);
        tile[a] = std::uint32_t(places[k + a] + middle) / o.tile.resolution[a];
      }
      CHECK(o.membership.tag(o.grid.tile_index(tile[0], tile[1], tile[2]), std::uint32_t(c + 1)) ==
            Tag::kInside);
      // Colors are in order of homes, then of cells.
      std::size_t number = 0;
      for (std::uint64_t t = 0; t < o.membership.entries.size(); ++t)
        for (std::uint32_t other = 1; other <= o.tile.cell_count; ++other) {
          if (t == o.grid.tile_index(tile[0], tile[1], tile[2]) && other == c + 1)
            for (std::size_t a = 0; a < 3; ++a)
              CHECK(colors[k + a] == double(float(srgb_to_linear(o.instance_colors->colors[number][a]))));
          number += o.membership.tag(t, other) == Tag::kInside;
        }
      ++placed;
    }
    const auto& material = glb.json["materials"][c]["pbrMetallicRoughness"];
    const Vec3 color = srgb_to_linear(o.cell_colors->colors[c]);
    for (std::size_t a = 0; a < 3; ++a) CHECK(material["baseColorFactor"][a].get<double>() == color[a]);
  }
  CHECK(placed == report.instances);

  // Of a solid block the inner ones are buried.
  o.membership.entries.assign(o.membership.entries.size(), std::uint32_t(Tag::kInside));
  o.membership.blocks.clear();
  o.instance_colors.reset();
  options.drop_buried = true;
  REQUIRE(write_mesh_export(o, folder / "b.glb", options, &report).ok());
  CHECK(report.buried > 0);
  CHECK(report.instances + report.buried == 5 * o.membership.entries.size());
}

TEST_CASE("instances in a GLB are read back as the cells' surfaces at their places") {
  const Folder folder(in_memory());
  CellObject o = colored_object();
  o.instance_colors.emplace();
  std::multiset<LatticeTriangle> expected;
  const auto cells = make_cell_surfaces(o.tile, 1 << 28);
  std::uint64_t voxels = 0;
  for (std::uint32_t z = 0; z < o.grid.tiles[2]; ++z)
    for (std::uint32_t y = 0; y < o.grid.tiles[1]; ++y)
      for (std::uint32_t x = 0; x < o.grid.tiles[0]; ++x)
        for (std::uint32_t cell = 1; cell <= o.tile.cell_count; ++cell) {
          if (o.membership.tag(o.grid.tile_index(x, y, z), cell) != Tag::kInside) continue;
          o.instance_colors->colors.push_back({std::uint8_t(cell), std::uint8_t(x), std::uint8_t(y)});
          const auto& n = o.tile.resolution;
          expected.merge(triangles_of((*cells)[cell - 1], {-std::int32_t(x * n[0]), -std::int32_t(y * n[1]),
                                                           -std::int32_t(z * n[2])}));
        }
  for (std::uint64_t v = 0; v < o.tile.voxel_count(); ++v)
    for (std::size_t t = 0; t < o.membership.entries.size() && o.tile.id(v) != 0; ++t)
      voxels += o.membership.tag(t, o.tile.pieces[o.tile.id(v) - 1].cell) == Tag::kInside;
  for (const bool draco : {false, true}) {
    MeshExportOptions options;
    options.instanced = options.colors = true;
    options.draco = draco;
    REQUIRE(write_mesh_export(o, folder / "a.glb", options).ok());
    MeshReadReport report;
    const Result<PaintedMesh> read = read_painted_mesh(folder / "a.glb", {}, &report);
    INFO((read ? "" : read.error().message));
    REQUIRE(read.ok());
    CHECK(report.warnings.empty());
    const TriangleMesh& mesh = read->mesh;
    std::multiset<LatticeTriangle> found;
    Box3 of_lattice;
    for (const Triangle& t : mesh.triangles) {
      LatticeTriangle of;
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t a = 0; a < 3; ++a)
          of[c][a] =
              std::int32_t(std::lround((mesh.vertices[t[c]][a] - o.grid.box_min[a]) / o.grid.voxel_edge));
        of_lattice.add(lattice_point(o.grid, of[c]));
        CHECK(length(lattice_point(o.grid, of[c]) - mesh.vertices[t[c]]) < 1e-9);
      }
      found.insert(turned(of));
    }
    CHECK(found == expected);
    const double edge = o.grid.voxel_edge;
    CHECK(signed_volume(mesh) == Approx(double(voxels) * edge * edge * edge));
    CHECK(length(bounding_box(mesh).max - of_lattice.max) < 1e-9);
    // Colors of instances as they were; of cells as materials.
    const std::set<Rgb8> colors(mesh.colors.begin(), mesh.colors.end());
    CHECK(colors == std::set<Rgb8>(o.instance_colors->colors.begin(), o.instance_colors->colors.end()));
    CHECK(read->paint.materials.size() == o.tile.cell_count);
  }
}

TEST_CASE("nothing inside is no glTF") {
  const Folder folder(in_memory());
  const CellObject o = make_voxels({1, 1, 1}, [](auto, auto, auto) { return false; });
  MeshExportOptions options;
  CHECK(write_mesh_export(o, folder / "a.glb").error().code == ErrorCode::kLimit);
  options.instanced = true;
  CHECK(write_mesh_export(o, folder / "a.glb", options).error().code == ErrorCode::kLimit);
  CHECK(folder.count() == 0);
}

TEST_CASE("the validator of the Khronos Group finds no error in what we write") {
  if (!has_tools()) return;
  const Folder folder(in_memory());
  const CellObject o = colored_object();
  const ExplicitSurface s = colored_surface(o);
  REQUIRE(write_gltf(s, o.grid, folder / "plain.glb").ok());
  check_valid(folder / "plain.glb");
  REQUIRE(write_mesh_export(o, folder / "bare.glb").ok());
  check_valid(folder / "bare.glb");
  MeshExportOptions options;
  options.draco = true;
  options.colors = true;
  options.normals = SurfaceNormals::kShading;
  REQUIRE(write_mesh_export(o, folder / "draco.glb", options).ok());
  check_valid(folder / "draco.glb");
  options.normals = SurfaceNormals::kNone;
  options.instanced = true;
  CellObject colored = o;
  colored.instance_colors =
      ColorList{std::vector<Rgb8>(count_instances(o.membership).inside, {9, 99, 199}), 0};
  REQUIRE(write_mesh_export(colored, folder / "colored.glb", options).ok());
  check_valid(folder / "colored.glb");
  for (const bool draco : {false, true}) {
    options.draco = draco;
    options.drop_buried = draco;
    REQUIRE(write_mesh_export(o, folder / "instanced.glb", options).ok());
    check_valid(folder / "instanced.glb");
  }
}

TEST_CASE("another decoder finds the same triangles in what Draco compressed") {
  if (!has_tools()) return;
  const Folder folder(in_memory());
  const CellObject o = colored_object();
  const ExplicitSurface s = colored_surface(o);
  GltfOptions options;
  for (const bool draco : {false, true}) {
    options.draco = draco;
    REQUIRE(write_gltf(s, o.grid, folder / "a.glb", options).ok());
    const Decoded found = decode(folder / "a.glb");
    CHECK(found.triangles == triangles_of(s, least_of(s)));
    CHECK(found.vertices == s.vertices.size());
    CHECK(found.attributes == std::vector<std::string>{"POSITION", "NORMAL", "COLOR_0"});
  }
  CHECK(std::filesystem::file_size(folder / "a.glb") * 4 < 100 * s.squares.size());

  const auto cells = make_cell_surfaces(o.tile, 1 << 28);
  MeshExportOptions instanced;
  instanced.instanced = instanced.draco = true;
  REQUIRE(write_mesh_export(o, folder / "b.glb", instanced).ok());
  std::multiset<LatticeTriangle> expected;
  for (const ExplicitSurface& cell : *cells) expected.merge(triangles_of(cell));
  const Decoded found = decode(folder / "b.glb");
  CHECK(found.meshes == 5);
  CHECK(found.triangles == expected);
}
