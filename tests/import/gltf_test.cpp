#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>

#include "converters/import/mesh_file.h"
#include "sdk/core/rng.h"
#include "sdk/core/srgb.h"
#include "tests/import/gltf_scene.h"
#include "tests/import/mesh_bytes.h"
#include "tests/import/messages.h"
#include "tests/import/picture_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;
using nlohmann::json;

namespace {

Result<PaintedMesh> read(const std::string& bytes, MeshReadReport* report = nullptr,
                         const std::string& name = "a.glb") {
  const TempFolder folder;
  return read_painted_mesh(folder.write(name, bytes), {}, report);
}

PaintedMesh sound(const std::string& bytes, MeshReadReport* report = nullptr) {
  Result<PaintedMesh> mesh = read(bytes, report);
  INFO((mesh ? "" : mesh.error().message));
  REQUIRE(mesh.ok());
  return std::move(*mesh);
}

std::string refusal(const std::string& bytes) {
  const Result<PaintedMesh> mesh = read(bytes);
  REQUIRE_FALSE(mesh.ok());
  CHECK(mesh.error().code == ErrorCode::kInvalidInput);
  return mesh.error().message;
}

const TriangleMesh kBox = make_box({0, 0, 0}, {1, 2, 3});

/// A triangle with texture coordinates and a picture as its material.
GltfScene textured(const std::string& picture_uri = "") {
  GltfScene scene;
  const std::size_t positions = scene.accessor(packed<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}), 5126, 3, "VEC3");
  const std::size_t wrong = scene.accessor(packed<float>({0, 0, 0, 0, 0, 0}), 5126, 3, "VEC2");
  const std::size_t uvs = scene.accessor(packed<float>({0, 0, 1, 0, 0, 1}), 5126, 3, "VEC2");
  json& primitive = scene.primitive(positions);
  primitive["attributes"]["TEXCOORD_0"] = wrong;
  primitive["attributes"]["TEXCOORD_1"] = uvs;
  primitive["material"] = 0;
  scene.json["materials"] = json::parse(R"([{"pbrMetallicRoughness":{"baseColorFactor":[0.5,1,1,1],
    "baseColorTexture":{"index":0,"texCoord":1}}}])");
  scene.json["textures"] = json::parse(R"([{"source":0,"sampler":0}])");
  scene.json["samplers"] = json::parse(R"([{"wrapS":33071,"wrapT":33648}])");
  if (picture_uri.empty()) {
    const std::size_t view = scene.view(png_bytes(kFour));
    scene.json["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}});
  } else {
    scene.json["images"].push_back({{"uri", picture_uri}});
  }
  return scene;
}

}  // namespace

TEST_CASE("glTF: a mesh as GLB, as text with a data URI, and with a file beside it") {
  const GltfScene scene = scene_of(kBox);
  MeshReadReport report;
  CHECK(sound(scene.glb(), &report).mesh.vertices == kBox.vertices);
  CHECK(report.format == "GLB");
  CHECK(report.warnings.empty());
  const TempFolder folder;
  const auto check = [&](const std::string& text) {
    const Result<PaintedMesh> mesh = read_painted_mesh(folder.write("a.gltf", text), {}, &report);
    INFO((mesh ? "" : mesh.error().message));
    REQUIRE(mesh.ok());
    CHECK(mesh->mesh.triangles == kBox.triangles);
    CHECK(report.format == "glTF");
  };
  check(scene.text());
  folder.write("a b.bin", scene.data);
  check(scene.text("a%20b.bin"));
  check(scene.text("./a b.bin"));
}

TEST_CASE("glTF: only files in the folder of the scene and below are read") {
  const GltfScene scene = scene_of(kBox);
  const TempFolder folder;
  std::filesystem::create_directory(folder.file("in"));
  folder.write("out.bin", scene.data);
  std::filesystem::create_symlink(folder.file("out.bin"), folder.file("in/link.bin"));
  for (const std::string& uri :
       {std::string("../out.bin"), std::string("%2e%2e/out.bin"), folder.file("out.bin"),
        "file://" + folder.file("out.bin"), std::string("link.bin"), std::string("x/../../out.bin"),
        std::string("http://a/b.bin")}) {
    INFO(uri);
    const auto mesh = read_painted_mesh(folder.write("in/a.gltf", scene.text(uri)));
    REQUIRE_FALSE(mesh.ok());
    CHECK(mesh.error().code == ErrorCode::kInvalidInput);
    CHECK(says(mesh.error().message, "folder"));
  }
  const auto missing = read_painted_mesh(folder.write("in/a.gltf", scene.text("none.bin")));
  REQUIRE_FALSE(missing.ok());
  CHECK(missing.error().code == ErrorCode::kUnreadable);
}

TEST_CASE("glTF: nodes place meshes, and out stays out where they mirror") {
  GltfScene scene = scene_of(kBox);
  scene.json["nodes"] = json::parse(R"([{"children":[1,2],"translation":[10,0,0]},
    {"mesh":0,"scale":[-1,1,1]},{"mesh":0,"rotation":[0,0,0.70710678118654752,0.70710678118654752]},{"mesh":0}])");
  scene.json["scenes"] = json::parse(R"([{"nodes":[3]},{"nodes":[0]}])");
  scene.json["scene"] = 1;
  MeshReadReport report;
  PaintedMesh both = sound(scene.glb(), &report);
  CHECK(has(report, "scenes-skipped"));
  CHECK(both.mesh.triangles.size() == 24);
  CHECK(signed_volume(both.mesh) == Approx(12));
  Box3 box = bounding_box(both.mesh);
  CHECK(length(box.min - Vec3{8, 0, 0}) < 1e-12);
  CHECK(length(box.max - Vec3{10, 2, 3}) < 1e-12);
  // A matrix that mirrors and skews.
  scene.json["nodes"][3]["matrix"] = {2, 0, 0, 0, 1, -1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
  scene.json.erase("scene");
  both = sound(scene.glb());
  CHECK(both.mesh.triangles.size() == 12);
  CHECK(signed_volume(both.mesh) == Approx(12));
  CHECK(bounding_box(both.mesh).max == Vec3{9, 6, 10});
  // No scene: all roots.
  scene.json.erase("scenes");
  CHECK(sound(scene.glb()).mesh.triangles.size() == 36);
  // No nodes: all meshes.
  scene.json.erase("nodes");
  CHECK(sound(scene.glb()).mesh.triangles.size() == 12);
  scene.json["nodes"] = json::parse(R"([{"children":[1]},{"children":[0],"mesh":0}])");
  CHECK(says(refusal(scene.glb()), "no triangles"));
  scene.json["nodes"] = json::parse(R"([{"children":[1]},{"mesh":0},{"children":[1]}])");
  CHECK(says(refusal(scene.glb()), "child of two"));
}

TEST_CASE("glTF: lists, strips and fans, with indices of all types and without") {
  const std::vector<float> five = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0};
  const auto triangles = [&](int mode, const std::string& indices, int component, std::size_t count) {
    GltfScene scene;
    const std::size_t positions = scene.accessor(packed(five), 5126, 6, "VEC3");
    const std::size_t corners = count > 0 ? scene.accessor(indices, component, count, "SCALAR") : 0;
    json& primitive = scene.primitive(positions);
    primitive["mode"] = mode;
    if (count > 0) primitive["indices"] = corners;
    return sound(scene.glb()).mesh.triangles;
  };
  using Triangles = std::vector<Triangle>;
  CHECK(triangles(4, "", 0, 0) == Triangles{{0, 1, 2}, {3, 4, 5}});
  CHECK(triangles(5, "", 0, 0) == Triangles{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}});
  CHECK(triangles(6, "", 0, 0) == Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}});
  CHECK(triangles(4, packed<std::uint8_t>({5, 1, 3}), 5121, 3) == Triangles{{5, 1, 3}});
  CHECK(triangles(5, packed<std::uint16_t>({5, 1, 3, 0}), 5123, 4) == Triangles{{5, 1, 3}, {3, 1, 0}});
  CHECK(triangles(6, packed<std::uint32_t>({5, 1, 3, 0}), 5125, 4) == Triangles{{5, 1, 3}, {5, 3, 0}});
}

TEST_CASE("glTF: sparse, interleaved, quantized and normalized accessors") {
  GltfScene scene;
  // Zeros but for two, and three but for one.
  const std::size_t places = scene.view(packed<std::uint16_t>({1, 2}));
  const std::size_t values = scene.view(packed<float>({1, 0, 0, 0, 1, 0}));
  const std::size_t base = scene.view(packed<float>({5, 5, 5, 9, 6, 5, 5, 9, 5, 6, 5, 9}), 16);
  const json sparse = {{"count", 2},
                       {"indices", {{"bufferView", places}, {"componentType", 5123}}},
                       {"values", {{"bufferView", values}}}};
  scene.json["accessors"].push_back(
      {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}, {"sparse", sparse}});
  scene.json["accessors"].push_back(
      {{"bufferView", base}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  scene.primitive(0);
  scene.primitive(1);
  CHECK(sound(scene.glb()).mesh.vertices ==
        std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}, {6, 5, 5}, {5, 6, 5}});

  const auto positions = [&](const std::string& bytes, int component, bool normalized) {
    GltfScene small;
    small.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    small.primitive(small.accessor(bytes, component, 3, "VEC3", normalized));
    return sound(small.glb()).mesh.vertices;
  };
  const std::string bytes = packed<std::int8_t>({0, 0, 0, 127, 0, 0, 0, -128, -127});
  CHECK(positions(bytes, 5120, false)[2] == Vec3{0, -128, -127});
  CHECK(positions(bytes, 5120, true)[2] == Vec3{0, -1, -1});
  CHECK(positions(bytes, 5121, true)[1].x == Approx(127 / 255.0));
  const std::string shorts = packed<std::uint16_t>({0, 0, 0, 65535, 0, 0, 0, 32768, 1});
  CHECK(positions(shorts, 5122, false)[2] == Vec3{0, -32768, 1});
  CHECK(positions(shorts, 5123, true)[1] == Vec3{1, 0, 0});
}

TEST_CASE("glTF: colors of vertices of all types are linear light") {
  const auto colors = [&](const std::string& bytes, int component, const char* type) {
    GltfScene scene;
    const std::size_t positions = scene.accessor(packed<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}), 5126, 3, "VEC3");
    const std::size_t color = scene.accessor(bytes, component, 3, type, component != 5126);
    scene.primitive(positions)["attributes"]["COLOR_0"] = color;
    return sound(scene.glb()).mesh.colors;
  };
  const std::vector<Rgb8> expected = {{255, 0, 0}, {0, 255, 0}, {0, 0, linear_to_srgb8(0.2)}};
  CHECK(colors(packed<float>({1, 0, 0, 0, 1, 0, 0, 0, 0.2f}), 5126, "VEC3") == expected);
  CHECK(colors(packed<float>({1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0.2f, 1}), 5126, "VEC4") == expected);
  CHECK(colors(packed<std::uint8_t>({255, 0, 0, 9, 0, 255, 0, 9, 0, 0, 51, 9}), 5121, "VEC4") == expected);
  CHECK(colors(packed<std::uint16_t>({65535, 0, 0, 0, 65535, 0, 0, 0, 13107}), 5123, "VEC3") == expected);
}

TEST_CASE("glTF: base color, texture, wrap modes and transform of a material") {
  GltfScene scene = textured();
  scene.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]
            ["KHR_texture_transform"] = {{"offset", {0, 1}}, {"rotation", 0.5}, {"scale", {0.5, 2}}};
  MeshReadReport report;
  const SurfacePaint paint = sound(scene.glb(), &report).paint;
  CHECK(report.warnings.empty());
  REQUIRE(paint.materials.size() == 1);
  CHECK(paint.materials[0].base_color == Vec3{0.5, 1, 1});
  REQUIRE(paint.materials[0].texture);
  CHECK(paint.materials[0].texture->wrap == std::array{TextureWrap::kClamp, TextureWrap::kMirror});
  CHECK(paint.materials[0].texture->transform == UvTransform{{0, 1}, {0.5, 2}, 0.5});
  REQUIRE(paint.images.size() == 1);
  CHECK(paint.images[0].texels == std::vector<Rgb8>{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}});
  CHECK(paint.uvs == std::vector<std::array<Uv, 3>>{{Uv{0, 0}, Uv{1, 0}, Uv{0, 1}}});
  CHECK(paint.material_indices == std::vector<std::uint32_t>{0});
}

TEST_CASE("glTF: pictures in data URIs and files, and those that are missing") {
  const auto images = [](const std::string& uri, const TempFolder& folder, MeshReadReport& report) {
    const auto mesh = read_painted_mesh(folder.write("a.glb", textured(uri).glb()), {}, &report);
    REQUIRE(mesh.ok());
    CHECK(mesh->paint.materials[0].texture.has_value() == report.warnings.empty());
    return report.warnings.empty();
  };
  const TempFolder folder;
  folder.write("four.png", png_bytes(kFour));
  folder.write("bad.png", png_bytes(kFour).substr(0, 40));
  MeshReadReport report;
  CHECK(images("four.png", folder, report));
  CHECK(images("data:image/png;base64," + base64(png_bytes(kFour)), folder, report));
  for (const char* uri : {"none.png", "bad.png", "../four.png", "data:image/png;base64,!"}) {
    INFO(uri);
    CHECK_FALSE(images(uri, folder, report));
    CHECK(has(report, "texture-missing"));
  }
}

TEST_CASE("glTF: what is not read is refused by name, or told") {
  GltfScene scene = scene_of(kBox);
  scene.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  CHECK(says(refusal(scene.glb()), "EXT_meshopt_compression"));
  scene.json["extensionsRequired"] = {"KHR_materials_unlit"};
  scene.json["extensionsUsed"] = {"KHR_materials_unlit", "EXT_texture_webp"};
  scene.json["meshes"][0]["primitives"].push_back({{"mode", 1}, {"attributes", {{"POSITION", 0}}}});
  scene.json["nodes"][0]["skin"] = 0;
  MeshReadReport report;
  CHECK(sound(scene.glb(), &report).mesh.triangles.size() == 12);
  for (const char* id : {"extension-ignored", "primitives-skipped", "deformation-ignored"})
    CHECK(has(report, id));
  scene.json["asset"]["version"] = "1.0";
  CHECK(says(refusal(scene.glb()), "glTF 1.0"));
}

TEST_CASE("glTF: indices and ranges beyond what is there are refused with their place") {
  const auto damaged = [](const char* pointer, json value) {
    GltfScene scene = textured();
    scene.json[json::json_pointer(pointer)] = std::move(value);
    return refusal(scene.glb());
  };
  CHECK(says(damaged("/meshes/0/primitives/0/attributes/POSITION", 9), "primitive 0 of mesh 0"));
  CHECK(says(damaged("/meshes/0/primitives/0/indices", -1), "primitive 0 of mesh 0"));
  CHECK(says(damaged("/meshes/0/primitives/0/indices", 0), "wrong type"));
  CHECK(says(damaged("/accessors/0/count", 4), "accessor 0 reaches beyond"));
  CHECK(says(damaged("/accessors/0/count", 1000000000), "accessor 0 reaches beyond"));
  CHECK(says(damaged("/accessors/0/byteOffset", 4), "accessor 0 reaches beyond"));
  CHECK(says(damaged("/accessors/0/componentType", 5130), "accessor 0"));
  CHECK(says(damaged("/accessors/0/type", "VEC5"), "accessor 0"));
  CHECK(says(damaged("/accessors/0/type", "VEC2"), "POSITION"));
  CHECK(says(damaged("/accessors/2/count", 2), "different lengths"));
  CHECK(says(damaged("/bufferViews/0/byteLength", 5000), "buffer view 0 reaches beyond"));
  CHECK(says(damaged("/bufferViews/0/byteOffset", 4294967295u), "buffer view 0 reaches beyond"));
  CHECK(says(damaged("/bufferViews/0/buffer", 1), "buffer view 0"));
  CHECK(says(damaged("/materials/0/pbrMetallicRoughness/baseColorTexture/index", 1), "material 0"));
  CHECK(says(damaged("/textures/0/source", 1), "texture 0"));
  CHECK(says(damaged("/images/0/bufferView", 77), "image 0"));
  CHECK(says(damaged("/samplers/0/wrapS", 1), "sampler 0"));
  CHECK(says(damaged("/nodes/0/mesh", 1), "node 0"));
  CHECK(says(damaged("/nodes/0/matrix", json::array({1, 2})), "node 0"));
  CHECK(says(damaged("/meshes", 3), "meshes"));
  CHECK(says(damaged("/nodes/0/scale", {1e300, 1e300, "x"}), "node 0"));
  CHECK(says(refusal("{\"asset\":{\"version\":\"2.0\"}"), "damaged"));
  CHECK(says(refusal("{\"asset\":" + std::string(100000, '[')), "deep"));
  CHECK(says(refusal(R"({"asset":{"version":"2.0","generator":"\\\"[[[["},"meshes":[]})"), "no triangles"));
}

TEST_CASE("glTF: files cut off or damaged are refused, or give a sound mesh") {
  const std::string whole = textured().glb();
  const TempFolder folder;
  const auto check = [&](const std::string& bytes) {
    const Result<PaintedMesh> mesh = read_painted_mesh(folder.write("a.glb", bytes));
    if (!mesh) return !mesh.error().message.empty();
    for (const Triangle& t : mesh->mesh.triangles)
      for (const std::uint32_t v : t)
        if (v >= mesh->mesh.vertices.size() || !is_finite(mesh->mesh.vertices[v])) return false;
    return true;
  };
  for (std::size_t n = 0; n < whole.size(); n += n < 40 ? 1 : 37) {
    INFO(n);
    CHECK_FALSE(read_painted_mesh(folder.write("a.glb", whole.substr(0, n))).ok());
  }
  Rng rng(11);
  for (int round = 0; round < 300; ++round) {
    std::string bytes = whole;
    for (std::uint32_t k = 1 + rng.below(3); k > 0; --k)
      bytes[12 + rng.below(std::uint32_t(bytes.size() - 12))] = char(std::uint8_t(rng.below(128)));
    CHECK(check(bytes));
  }
}

TEST_CASE("Draco: alone and in a glTF") {
  TriangleMesh box = kBox;
  for (std::uint8_t i = 0; i < 8; ++i) box.colors.push_back({i, std::uint8_t(255 - i), 7});
  const std::string bytes = draco_bytes(box);
  REQUIRE_FALSE(bytes.empty());
  MeshReadReport report;
  const Result<PaintedMesh> alone = read(bytes, &report, "a.drc");
  REQUIRE(alone.ok());
  CHECK(report.format == "Draco");
  CHECK(alone->mesh.vertices == box.vertices);
  CHECK(alone->mesh.triangles == box.triangles);
  CHECK(alone->mesh.colors == box.colors);

  GltfScene scene;
  scene.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  scene.json["accessors"] = json::parse(R"([{"componentType":5126,"count":8,"type":"VEC3"},
    {"componentType":5121,"count":8,"type":"VEC3","normalized":true},{"componentType":5123,"count":36,"type":"SCALAR"}])");
  const std::size_t view = scene.view(bytes);
  json& primitive = scene.primitive(0);
  primitive["attributes"]["COLOR_0"] = 1;
  primitive["indices"] = 2;
  primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view},
                                                           {"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}};
  const PaintedMesh packed_mesh = sound(scene.glb());
  CHECK(packed_mesh.mesh.vertices == box.vertices);
  CHECK(packed_mesh.mesh.triangles == box.triangles);
  CHECK(packed_mesh.mesh.colors[3][1] == linear_to_srgb8(252 / 255.0));
  GltfScene unknown = scene;
  unknown.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]
              ["POSITION"] = 7;
  CHECK(says(refusal(unknown.glb()), "no attribute 7"));

  const TriangleMesh torus = make_torus({0, 0, 0}, 2, 1, 30, 20);
  const Result<PaintedMesh> by_edges = read(draco_bytes(torus, DracoMethod::kEdgebreaker), nullptr, "a.drc");
  REQUIRE(by_edges.ok());
  CHECK(by_edges->mesh.triangles.size() == torus.triangles.size());
  CHECK(signed_volume(by_edges->mesh) == Approx(signed_volume(torus)).epsilon(1e-3));

  for (std::size_t n = 0; n < bytes.size(); n += 3) {
    INFO(n);
    CHECK_FALSE(read(bytes.substr(0, n), nullptr, "a.drc").ok());
  }
  Rng rng(2);
  for (int round = 0; round < 100; ++round) {
    std::string damaged = bytes;
    damaged[rng.below(std::uint32_t(bytes.size()))] = char(std::uint8_t(rng.below(256)));
    const Result<PaintedMesh> mesh = read(damaged, nullptr, "a.drc");
    CHECK((mesh.ok() || !mesh.error().message.empty()));
  }
}
