#include <set>
#include <string>

#include "converters/import/mesh_file.h"
#include "tests/import/gltf_scene.h"
#include "tests/import/mesh_bytes.h"
#include "tests/import/picture_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;
using nlohmann::json;

namespace {

using Losses = std::set<std::string>;

Losses losses(const TempFolder& folder, const std::string& name, const std::string& bytes,
              const MeshReadOptions& options = {}) {
  MeshReadReport report;
  const Result<PaintedMesh> mesh = read_painted_mesh(folder.write(name, bytes), options, &report);
  INFO(name << ": " << (mesh ? "" : mesh.error().message));
  REQUIRE(mesh.ok());
  return report.notes.losses;
}

/// Without materials.
Losses plain_losses(const TempFolder& folder, const std::string& name) {
  MeshReadReport report;
  REQUIRE(read_mesh_file(folder.file(name), {}, &report).ok());
  return report.notes.losses;
}

const PlainPicture kDot{1, 1, 3, {255, 0, 0}};
const std::string kVertices = "property float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "element face 1\nproperty list uchar int vertex_indices\n";

std::string ply(const std::string& head, const std::string& body) {
  return "ply\nformat ascii 1.0\n" + head + "end_header\n" + body;
}

std::string big_float(float x) {
  const std::string little = packed<float>({x});
  return {little.rbegin(), little.rend()};
}

}  // namespace

TEST_CASE("losses: none where there is nothing to lose") {
  const TempFolder folder;
  TriangleMesh box = make_box({0, 0, 0}, {1, 2, 3});
  for (const MeshBytes& file : in_all_formats(box)) CHECK(losses(folder, file.name, file.bytes).empty());
  CHECK(losses(folder, "a.glb", scene_of(box).glb()).empty());
  box.colors.assign(8, {1, 2, 3});
  for (const MeshBytes& file : in_all_formats(box)) CHECK(losses(folder, file.name, file.bytes).empty());
  CHECK(losses(folder, "a.drc", draco_bytes(box)).empty());
}

TEST_CASE("losses: OBJ and its materials") {
  const TempFolder folder;
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", corners = "vt 0 0\nvt 1 0\nvt 0 1\n";
  CHECK(losses(folder, "a.obj", triangle + "s off\ns 0\nf 1 2 3\n").empty());
  CHECK(losses(folder, "a.obj", triangle + "g a\nvn 0 0 1\ns 1\nf 1//1 2//1 3//1\nl 1 2\np 3\n") ==
        Losses{"groups", "lines and points", "normals", "smoothing groups"});
  CHECK(losses(folder, "a.obj", triangle + corners + "f 1/1 2/2 3/3\n") == Losses{"texture coordinates"});
  folder.write("dot.png", png_bytes(kDot));
  const std::string painted = "mtllib a.mtl\n" + triangle + corners + "usemtl m\nf 1/1 2/2 3/3\n";
  folder.write("a.mtl",
               "# Ks\nnewmtl m\nKd 1 1 1\nd 1\nTr 0\nillum 2\nmap_Kd dot.png\nnewmtl unused\nd 0.5\n");
  CHECK(losses(folder, "a.obj", painted).empty());
  CHECK(plain_losses(folder, "a.obj") == Losses{"materials", "texture coordinates"});
  folder.write("a.mtl", "newmtl m\nKd 1 1 1\nd 0.5\nKs 1 1 1\nmap_Kd -s 2 2 2 dot.png\n");
  CHECK(losses(folder, "a.obj", painted) ==
        Losses{"alpha", "options of pictures", "other properties of materials"});
  // A picture in place of materials.
  MeshReadOptions options;
  options.texture = folder.file("dot.png");
  CHECK(losses(folder, "a.obj", painted, options) == Losses{"materials"});
  // One that is not there, and materials of which nothing is known.
  folder.write("a.mtl", "newmtl m\nKd 1 0 0\nmap_Kd none.png\n");
  CHECK(losses(folder, "a.obj", painted) == Losses{"texture coordinates"});
  folder.write("a.mtl", "");
  CHECK(losses(folder, "a.obj", painted) == Losses{"materials", "texture coordinates"});
}

TEST_CASE("losses: PLY, OFF and STL") {
  const TempFolder folder;
  const std::string points = "element vertex 3\n" + kVertices;
  CHECK(losses(folder, "a.ply",
               ply(points +
                       "property float nx\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                       "property uchar alpha\nproperty float confidence\n" +
                       kFaces +
                       "property int part\nelement edge 1\nproperty int a\nelement none 0\nproperty int b\n",
                   "0 0 0 0 1 1 1 255 9\n1 0 0 0 1 1 1 255 9\n0 1 0 0 1 1 1 254 9\n3 0 1 2 7\n1\n")) ==
        Losses{"alpha", "element edge", "normals", "property confidence of vertices",
               "property part of faces"});
  CHECK(losses(folder, "a.ply",
               ply(points + "property float s\nproperty float t\n" + kFaces,
                   "0 0 0 0 0\n1 0 0 0 0\n0 1 0 0 0\n3 0 1 2\n")) == Losses{"texture coordinates"});
  folder.write("dot.png", png_bytes(kDot));
  CHECK(losses(folder, "a.ply",
               ply("comment TextureFile dot.png\n" + points + "property float s\nproperty float t\n" + kFaces,
                   "0 0 0 0 0\n1 0 0 0 0\n0 1 0 0 0\n3 0 1 2\n"))
            .empty());
  CHECK(plain_losses(folder, "a.ply") == Losses{"materials", "texture coordinates"});
  const std::string color = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string both =
      ply(points + color + kFaces + color, "0 0 0 1 1 1\n1 0 0 1 1 1\n0 1 0 1 1 1\n3 0 1 2 9 9 9\n");
  CHECK(losses(folder, "a.ply", both) == Losses{"colors of faces"});
  CHECK(
      losses(folder, "a.ply", ply(points + kFaces + color, "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 9 9 9\n")).empty());
  CHECK(plain_losses(folder, "a.ply") == Losses{"colors of faces"});

  const auto off = [&](const std::string& word, const std::string& rest) {
    return losses(folder, "a.off",
                  word + "\n3 1 0\n0 0 0" + rest + "\n1 0 0" + rest + "\n0 1 0" + rest + "\n3 0 1 2\n");
  };
  CHECK(off("OFF", "").empty());
  CHECK(off("COFF", " 255 0 0 255").empty());
  CHECK(off("COFF", " 255 0 0 254") == Losses{"alpha"});
  CHECK(off("COFF", " 1.0 0 0 1").empty());
  CHECK(off("STNOFF", " 0 0 1 5 5") == Losses{"normals", "texture coordinates"});
  std::string binary = "STCNOFF BINARY\n";
  for (const int n : {3, 1, 0}) {
    binary.append(3, char(0));
    binary += char(n);
  }
  for (int v = 0; v < 3; ++v) {
    for (int axis = 0; axis < 3; ++axis) binary += big_float(axis < 2 ? float(v == axis + 1) : 0.0f);
    for (int k = 0; k < 9; ++k) binary += big_float(0.5f);
  }
  for (const int n : {3, 0, 1, 2, 0}) {
    binary.append(3, char(0));
    binary += char(n);
  }
  CHECK(losses(folder, "b.off", binary) == Losses{"alpha", "normals", "texture coordinates"});

  std::string stl = mesh_bytes(make_box({0, 0, 0}, {1, 1, 1}), "binary.stl");
  stl[84 + 7 * 50 + 49] = '\x80';
  CHECK(losses(folder, "a.stl", stl) == Losses{"attributes of triangles, such as colors"});
}

TEST_CASE("losses: glTF") {
  const TempFolder folder;
  GltfScene scene = scene_of(make_box({0, 0, 0}, {1, 2, 3}));
  json& primitive = scene.json["meshes"][0]["primitives"][0];
  const std::size_t uvs = scene.accessor(packed(std::vector<float>(16)), 5126, 8, "VEC2");
  for (const char* name : {"NORMAL", "TANGENT", "COLOR_1", "JOINTS_0", "_TEMPERATURE"})
    primitive["attributes"][name] = 0;
  primitive["attributes"]["TEXCOORD_0"] = primitive["attributes"]["TEXCOORD_1"] = uvs;
  primitive["targets"] = {{{"POSITION", 0}}};
  scene.json["meshes"][0]["primitives"].push_back({{"mode", 1}, {"attributes", {{"POSITION", 0}}}});
  scene.json["animations"] = scene.json["cameras"] = {{{"name", "x"}}};
  scene.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", json::array()}}};
  scene.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  scene.json["extensionsUsed"] = {"EXT_texture_webp", "KHR_lights_punctual"};
  CHECK(losses(folder, "a.glb", scene.glb()) ==
        Losses{"animations", "cameras", "extension EXT_texture_webp", "further colors of vertices", "lights",
               "lines and points", "morph targets", "normals", "other attributes of vertices", "other scenes",
               "skins", "tangents", "texture coordinates"});

  scene = scene_of(make_box({0, 0, 0}, {1, 2, 3}));
  json& painted = scene.json["meshes"][0]["primitives"][0];
  const std::size_t corners = scene.accessor(packed(std::vector<float>(16)), 5126, 8, "VEC2");
  painted["attributes"]["TEXCOORD_1"] = corners;
  painted["material"] = 0;
  scene.json["images"] = {{{"bufferView", scene.view(png_bytes(kDot))}}};
  scene.json["textures"] = {{{"source", 0}}};
  json& material = (scene.json["materials"] = {json::object()})[0];
  material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}, {"texCoord", 1}};
  material["alphaMode"] = "OPAQUE";
  CHECK(losses(folder, "a.glb", scene.glb()).empty());
  CHECK(plain_losses(folder, "a.glb") == Losses{"materials", "texture coordinates"});
  painted["attributes"]["TEXCOORD_0"] = corners;
  material["alphaMode"] = "MASK";
  material["pbrMetallicRoughness"]["metallicFactor"] = 0;
  CHECK(losses(folder, "a.glb", scene.glb()) ==
        Losses{"alpha", "further texture coordinates", "other properties of materials"});
  scene.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["_ID"] = corners;
  CHECK(losses(folder, "a.glb", scene.glb()).contains("other attributes of instances"));
  MeshReadOptions options;
  options.texture = folder.write("dot.png", png_bytes(kDot));
  CHECK(losses(folder, "a.glb", scene.glb(), options).contains("materials"));
}

TEST_CASE("losses: Draco") {
  const TempFolder folder;
  const TriangleMesh box = make_box({0, 0, 0}, {1, 2, 3});
  CHECK(losses(folder, "a.drc", draco_bytes(box, DracoMethod::kSequential, DracoNormals::kSome)) ==
        Losses{"normals"});
}

TEST_CASE("losses: so many as anyone wants to read") {
  const TempFolder folder;
  std::string head = "element vertex 3\n" + kVertices, zeros;
  for (int i = 0; i < 100; ++i) {
    head += "property float p" + std::to_string(i) + std::string(1000, 'x') + "\n";
    zeros += " 0";
  }
  const Losses many =
      losses(folder, "a.ply",
             ply(head + kFaces, "0 0 0" + zeros + "\n1 0 0" + zeros + "\n0 1 0" + zeros + "\n3 0 1 2\n"));
  CHECK(many.size() == ReadNotes::kMaxLosses);
  for (const std::string& loss : many) CHECK(loss.size() < 80);
}
