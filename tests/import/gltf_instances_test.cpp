#include <limits>
#include <string>
#include <string_view>

#include "converters/import/mesh_file.h"
#include "sdk/core/rng.h"
#include "sdk/core/srgb.h"
#include "tests/import/gltf_scene.h"
#include "tests/import/mesh_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;
using nlohmann::json;

namespace {

constexpr const char* kExtension = "EXT_mesh_gpu_instancing";

const TriangleMesh kInstance = make_box({0, 0, 0}, {1, 2, 3});

/// A box in a node that has instances, as yet without attributes.
GltfScene instanced() {
  GltfScene scene = scene_of(kInstance);
  scene.json["extensionsRequired"] = scene.json["extensionsUsed"] = {kExtension};
  scene.json["nodes"][0]["extensions"][kExtension]["attributes"] = json::object();
  return scene;
}

void set(GltfScene& scene, const char* name, std::size_t accessor) {
  scene.json["nodes"][0]["extensions"][kExtension]["attributes"][name] = accessor;
}

void add(GltfScene& scene, const char* name, const std::vector<float>& numbers, const char* type) {
  const std::size_t each = type == std::string_view("VEC4") ? 4 : 3;
  set(scene, name, scene.accessor(packed(numbers), 5126, numbers.size() / each, type));
}

Result<PaintedMesh> read(const GltfScene& scene, MeshReadReport* report = nullptr) {
  const TempFolder folder;
  return read_painted_mesh(folder.write("a.glb", scene.glb()), {}, report);
}

PaintedMesh sound(const GltfScene& scene) {
  MeshReadReport report;
  Result<PaintedMesh> mesh = read(scene, &report);
  INFO((mesh ? "" : mesh.error().message));
  REQUIRE(mesh.ok());
  CHECK(report.warnings.empty());
  CHECK(report.polygons == mesh->mesh.triangles.size());
  return std::move(*mesh);
}

/// The part of a mesh that is of one box.
Box3 box_of(const TriangleMesh& mesh, std::size_t instance) {
  Box3 box;
  for (std::size_t i = 0; i < 8; ++i) box.add(mesh.vertices[8 * instance + i]);
  return box;
}

void check_box(const Box3& box, Vec3 low, Vec3 high) {
  CHECK(length(box.min - low) < 1e-12);
  CHECK(length(box.max - high) < 1e-12);
}

Error refusal(const GltfScene& scene) {
  const Result<PaintedMesh> mesh = read(scene);
  REQUIRE_FALSE(mesh.ok());
  return mesh.error();
}

bool says(const GltfScene& scene, std::string_view what, ErrorCode code = ErrorCode::kInvalidInput) {
  const Error error = refusal(scene);
  INFO(error.message);
  CHECK(error.code == code);
  return error.message.find(what) != std::string::npos;
}

}  // namespace

TEST_CASE("instances: moved, turned, scaled and mirrored within the node, out stays out") {
  GltfScene scene = instanced();
  scene.json["nodes"][0]["scale"] = {2, 2, 2};
  scene.json["nodes"][0]["translation"] = {100, 0, 0};
  const float h = 0.70710678f;
  add(scene, "TRANSLATION", {0, 0, 0, 10, 0, 0, 0, 20, 0}, "VEC3");
  // About z by a quarter; the second is of no unit length.
  add(scene, "ROTATION", {0, 0, 0, 1, 0, 0, 3, 3, 0, 0, h, h}, "VEC4");
  add(scene, "SCALE", {1, 1, 1, 1, 1, 1, 2, -1, 1}, "VEC3");
  const TriangleMesh mesh = sound(scene).mesh;
  REQUIRE(mesh.vertices.size() == 24);
  REQUIRE(mesh.triangles.size() == 36);
  check_box(box_of(mesh, 0), {100, 0, 0}, {102, 4, 6});
  // x, y becomes -y, x.
  check_box(box_of(mesh, 1), {116, 0, 0}, {120, 2, 6});
  // Scaled, then turned: x, y becomes y, 2 x.
  const Box3 third = box_of(mesh, 2);
  CHECK(length(third.min - Vec3{100, 40, 0}) < 1e-6);
  CHECK(length(third.max - Vec3{104, 44, 6}) < 1e-6);
  CHECK(signed_volume(mesh) == Approx(8 * (6 + 6 + 12)));
  // A node that mirrors as well turns those back that do not.
  scene.json["nodes"][0]["scale"] = {-2, 2, 2};
  CHECK(signed_volume(sound(scene).mesh) == Approx(8 * (6 + 6 + 12)));
}

TEST_CASE("instances: each attribute alone, rotations of integers, and a program's own") {
  GltfScene scene = instanced();
  add(scene, "TRANSLATION", {5, 0, 0, 0, 7, 0}, "VEC3");
  CHECK(bounding_box(sound(scene).mesh).max == Vec3{6, 9, 3});
  scene = instanced();
  add(scene, "SCALE", {3, 1, 1, 1, 3, 1}, "VEC3");
  CHECK(bounding_box(sound(scene).mesh).max == Vec3{3, 6, 3});
  for (const bool bytes : {true, false}) {
    scene = instanced();
    const std::string numbers = bytes ? packed<std::int8_t>({0, 0, 0, 127, 0, 0, 90, 90})
                                      : packed<std::int16_t>({0, 0, 0, 32767, 0, 0, 90, 90});
    set(scene, "ROTATION", scene.accessor(numbers, bytes ? 5120 : 5122, 2, "VEC4", true));
    const TriangleMesh mesh = sound(scene).mesh;
    check_box(box_of(mesh, 0), {0, 0, 0}, {1, 2, 3});
    check_box(box_of(mesh, 1), {-2, 0, 0}, {0, 1, 3});
  }
  // It alone says how many.
  scene = instanced();
  set(scene, "_ID", scene.accessor(packed<std::uint16_t>({1, 2, 3, 4}), 5123, 4, "SCALAR"));
  CHECK(sound(scene).mesh.triangles.size() == 48);
  // The node has no mesh: nothing is shown but the other one.
  scene.json["nodes"].push_back({{"mesh", 0}});
  scene.json["nodes"][0].erase("mesh");
  CHECK(sound(scene).mesh.triangles.size() == 12);
}

TEST_CASE("instances: colors multiply those of vertices, in linear light") {
  GltfScene scene = instanced();
  add(scene, "TRANSLATION", {0, 0, 0, 5, 0, 0}, "VEC3");
  add(scene, "_COLOR_0", {1, 0.5f, 0, 0.25f, 1, 1}, "VEC3");
  const TriangleMesh plain = sound(scene).mesh;
  REQUIRE(plain.colors.size() == 16);
  CHECK(plain.colors[0] == linear_to_srgb8(Vec3{1, 0.5, 0}));
  CHECK(plain.colors[15] == linear_to_srgb8(Vec3{0.25, 1, 1}));
  std::vector<float> colors;
  for (int i = 0; i < 8; ++i) colors.insert(colors.end(), {0.5f, 0.5f, float(i) / 8});
  const std::size_t of_vertices = scene.accessor(packed(colors), 5126, 8, "VEC3");
  scene.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = of_vertices;
  const TriangleMesh mesh = sound(scene).mesh;
  REQUIRE(mesh.colors.size() == 16);
  CHECK(mesh.colors[4] == linear_to_srgb8(Vec3{0.5, 0.25, 0}));
  CHECK(mesh.colors[12] == linear_to_srgb8(Vec3{0.125, 0.5, 0.5}));
  // Another node without colors is white, before and after it.
  scene.json["nodes"].push_back({{"mesh", 1}});
  scene.json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}});
  CHECK(sound(scene).mesh.colors[16] == Rgb8{255, 255, 255});
  scene = instanced();
  set(scene, "_COLOR_0", scene.accessor(packed<std::uint8_t>({255, 0, 51, 9}), 5121, 1, "VEC4"));
  CHECK(sound(scene).mesh.colors[0] == Rgb8{255, 0, linear_to_srgb8(0.2)});
}

TEST_CASE("instances: what is wrong with them is refused with its place") {
  GltfScene scene = instanced();
  CHECK(says(scene, "node 0 has instances without attributes"));
  add(scene, "TRANSLATION", {0, 0, 0, 5, 0, 0}, "VEC3");
  GltfScene wrong = scene;
  add(wrong, "SCALE", {1, 1, 1}, "VEC3");
  CHECK(says(wrong, "node 0 has attributes of instances of different lengths"));
  wrong = scene;
  set(wrong, "SCALE", 99);
  CHECK(says(wrong, "node 0"));
  wrong = scene;
  add(wrong, "ROTATION", {0, 0, 0, 0, 0, 0}, "VEC3");
  CHECK(says(wrong, "node 0 has an accessor of the wrong type for ROTATION"));
  wrong = scene;
  set(wrong, "ROTATION", wrong.accessor(packed<std::int8_t>({0, 0, 0, 1, 0, 0, 0, 1}), 5120, 2, "VEC4"));
  CHECK(says(wrong, "wrong type for ROTATION"));
  wrong = scene;
  wrong.json["accessors"].push_back({{"componentType", 5126}, {"count", 2}, {"type", "VEC3"}});
  set(wrong, "SCALE", wrong.json["accessors"].size() - 1);
  CHECK(says(wrong, "a SCALE without data"));
  wrong = scene;
  wrong.json["accessors"].back()["count"] = 1'000'000'000;
  CHECK(says(wrong, "reaches beyond"));
  wrong = scene;
  wrong.json["nodes"][0]["extensions"][kExtension]["attributes"] = 3;
  CHECK(says(wrong, "without attributes"));
  wrong = instanced();
  add(wrong, "TRANSLATION", {0, 0, 0, std::numeric_limits<float>::quiet_NaN(), 0, 0}, "VEC3");
  CHECK(says(wrong, "not finite"));
}

TEST_CASE("instances: more triangles or vertices than can be had are refused before they are made") {
  GltfScene scene = instanced();
  // All zeros but for one; so few bytes can stand for very many.
  const std::size_t places = scene.view(packed<std::uint32_t>({1}));
  const std::size_t values = scene.view(packed<float>({5, 0, 0}));
  const json sparse = {{"count", 1},
                       {"indices", {{"bufferView", places}, {"componentType", 5125}}},
                       {"values", {{"bufferView", values}}}};
  scene.json["accessors"].push_back(
      {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}, {"sparse", sparse}});
  set(scene, "TRANSLATION", scene.json["accessors"].size() - 1);
  CHECK(sound(scene).mesh.triangles.size() == 36);
  scene.json["accessors"].back()["count"] = 1 << 26;
  CHECK(says(scene, "with all instances of its meshes", ErrorCode::kLimit));
  scene.json["accessors"].back()["count"] = 1 << 30;
  CHECK(says(scene, "sparse accessor"));
  // Few triangles of many vertices.
  scene = instanced();
  scene.primitive(scene.accessor(packed(std::vector<float>(30000)), 5126, 10000, "VEC3"))["indices"] =
      scene.accessor(packed<std::uint16_t>({0, 1, 2}), 5123, 3, "SCALAR");
  add(scene, "TRANSLATION", std::vector<float>(3 * 250000), "VEC3");
  scene.json["nodes"][0]["mesh"] = 1;
  CHECK(says(scene, "vertices with all instances", ErrorCode::kLimit));
}

TEST_CASE("instances: damaged files are refused, or give a sound mesh") {
  GltfScene scene = instanced();
  add(scene, "TRANSLATION", {0, 0, 0, 10, 0, 0, 0, 20, 0}, "VEC3");
  add(scene, "ROTATION", {0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC4");
  add(scene, "_COLOR_0", {1, 1, 1, 0, 1, 0, 0, 0, 1}, "VEC3");
  const std::string whole = scene.glb();
  const TempFolder folder;
  Rng rng(5);
  for (int round = 0; round < 300; ++round) {
    std::string bytes = whole;
    for (std::uint32_t k = 1 + rng.below(3); k > 0; --k)
      bytes[12 + rng.below(std::uint32_t(bytes.size() - 12))] = char(std::uint8_t(rng.below(256)));
    const Result<PaintedMesh> mesh = read_painted_mesh(folder.write("a.glb", bytes));
    if (!mesh) {
      CHECK_FALSE(mesh.error().message.empty());
      continue;
    }
    CHECK((mesh->mesh.colors.empty() || mesh->mesh.colors.size() == mesh->mesh.vertices.size()));
    for (const Triangle& t : mesh->mesh.triangles)
      for (const std::uint32_t v : t)
        if (v >= mesh->mesh.vertices.size() || !is_finite(mesh->mesh.vertices[v])) FAIL("a wrong triangle");
  }
}
