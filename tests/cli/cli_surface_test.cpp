#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "tests/cli/picture_scene.h"
#include "tests/import/picture_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;
using nlohmann::json;

namespace {

json info_of(const std::string& path) {
  const Run run = run_command({"info", path, "--json"});
  REQUIRE(run.exit == 0);
  return run.json();
}

/// Colors of the pixels that hit, each once.
std::set<std::vector<float>> colors_of(const Scene& scene) {
  REQUIRE(scene.render("c.exr", {"--mode", "color"}).exit == 0);
  const Image image = read_picture(scene.folder.file("c.exr"));
  const auto channel = [&](const char* name) {
    REQUIRE(find_channel(image, name));
    return *find_channel(image, name);
  };
  const std::size_t r = channel("color.R"), g = channel("color.G"), b = channel("color.B"),
                    cell = channel("cell.id"), stride = image.channels.size();
  std::set<std::vector<float>> colors;
  for (std::size_t i = 0; i < image.pixels.size(); i += stride)
    if (image.pixels[i + cell] > 0)
      colors.insert({image.pixels[i + r], image.pixels[i + g], image.pixels[i + b]});
  return colors;
}

}  // namespace

TEST_CASE("the rule of membership is the one that was asked for") {
  const Scene centre({"--rule", "centre"}), conservative({"--rule", "conservative"});
  const json a = info_of(centre.asset), b = info_of(conservative.asset);
  CHECK(a["rule"] == "centre");
  CHECK(b["rule"] == "conservative");
  CHECK(b["instances"]["inside"] < a["instances"]["inside"]);
  CHECK(b["instances"]["intersected"] > a["instances"]["intersected"]);
  CHECK(read_bytes(Scene().asset) == read_bytes(centre.asset));
}

TEST_CASE("an asset without a surface has white cells and no maps") {
  const Scene scene;
  const json info = info_of(scene.asset);
  CHECK(info["color_resolution"].is_null());
  CHECK(info["cell_colors"] == 0);
  CHECK(info["instance_colors"] == 0);
  CHECK(info["normals"] == 0);
  CHECK(colors_of(scene) == std::set<std::vector<float>>{{1, 1, 1}});
}

TEST_CASE("a solid texture is in the file, its recipe in the metadata") {
  const Scene scene({"--color", "marble:seed=5,resolution=24"});
  const json info = info_of(scene.asset);
  CHECK(info["color_resolution"] == json({24, 24, 24}));
  CHECK(info["cell_colors"] == 0);
  CHECK(info["metadata"]["color"] == "marble:resolution=24,seed=5");
  CHECK(info["metadata"]["tile"] == "voronoi:cells=8,resolution=16,seed=1");
  CHECK(run_command({"validate", scene.asset}).exit == 0);
  CHECK(colors_of(scene).size() > 50);
  const Run text = run_command({"info", scene.asset});
  CHECK(text.out.find("[24, 24, 24]") != std::string::npos);
}

TEST_CASE("a color for each cell") {
  const Scene scene({"--color", "cells:seed=2"});
  const json info = info_of(scene.asset);
  CHECK(info["color_resolution"].is_null());
  CHECK(info["cell_colors"] == 8);
  CHECK(info["metadata"]["color"] == "cells:seed=2");
  CHECK(run_command({"validate", scene.asset}).exit == 0);
  const std::set<std::vector<float>> colors = colors_of(scene);
  CHECK(colors.size() > 3);
  CHECK(colors.size() <= 8);
}

TEST_CASE("the mesh's own colors, one for each cell inside, from every format that has them") {
  TriangleMesh ball = make_sphere({0, 0, 0}, 1, 24);
  for (const Vec3& v : ball.vertices) ball.colors.push_back(v.x < 0 ? Rgb8{200, 30, 30} : Rgb8{30, 30, 200});
  const Scene scene;
  std::string first;
  for (const char* name : {"text.ply", "big.ply", "mesh.off", "mesh.obj"}) {
    INFO(name);
    const std::string mesh = scene.folder.write(name, mesh_bytes(ball, name));
    const Run run = run_command({"convert", mesh, scene.asset, "--tiles", "8", "--tile",
                                 "voronoi:cells=8,resolution=16,seed=1", "--color", "mesh", "--threads",
                                 first.empty() ? "1" : "3", "--json"});
    INFO(run.err);
    REQUIRE(run.exit == 0);
    CHECK(run.json()["instance_colors"] == run.json()["instances"]["inside"]);
    CHECK(run.json()["max_error"]["instance_colors"] == 0.5);
    if (first.empty()) first = read_bytes(scene.asset);
    CHECK(read_bytes(scene.asset) == first);
  }
  const json info = info_of(scene.asset);
  CHECK(info["instance_colors"] > 100);
  CHECK(info["cell_colors"] == 0);
  CHECK(info["color_resolution"].is_null());
  CHECK(info["metadata"]["color"] == "mesh");
  CHECK(run_command({"validate", scene.asset}).exit == 0);

  // Red on the left, blue on the right, but for cells that are about as near to both.
  REQUIRE(scene.render("c.exr", {"--mode", "color", "--eye", "0,0,5", "--look", "0,0,0"}).exit == 0);
  const Image image = read_picture(scene.folder.file("c.exr"));
  const std::size_t r = find_channel(image, "color.R").value(), b = find_channel(image, "color.B").value(),
                    cell = find_channel(image, "cell.id").value(), stride = image.channels.size();
  std::size_t hits = 0, right_color = 0;
  for (std::size_t i = 0; i < image.pixels.size() / stride; ++i) {
    const float* pixel = image.pixels.data() + i * stride;
    if (pixel[cell] == 0) continue;
    ++hits;
    right_color += (i % image.width < image.width / 2) == (pixel[r] > pixel[b]);
  }
  CHECK(hits > 100);
  CHECK(double(right_color) > 0.9 * double(hits));
}

TEST_CASE("a mesh without colors has none to take over, and that is said before the work") {
  const Scene scene;
  const Run run = run_command({"convert", scene.folder.file("ball.off"), scene.folder.file("o.meso"),
                               "--color", "mesh", "--tiles", "8"});
  CHECK(run.exit == 2);
  CHECK(run.err.find("no colors") != std::string::npos);
  CHECK(run.messages() == 1);
  CHECK(scene.folder.list() == std::vector<std::string>{"ball.meso", "ball.off"});
  CHECK(run_command({"convert", "--help"}).out.find("\nmesh ") != std::string::npos);
}

TEST_CASE("normals are stored on demand and are of length 1 in a picture") {
  const Scene plain, smooth({"--normals"});
  const json info = info_of(smooth.asset);
  CHECK(info["normals"] > 100);
  CHECK(info["normals"] <= 16 * 16 * 16);
  CHECK(run_command({"validate", smooth.asset}).exit == 0);
  REQUIRE(smooth.render("n.exr", {"--mode", "normal"}).exit == 0);
  const Image image = read_picture(smooth.folder.file("n.exr"));
  const std::size_t stride = image.channels.size();
  const std::size_t x = find_channel(image, "normal.X").value(), y = find_channel(image, "normal.Y").value(),
                    z = find_channel(image, "normal.Z").value(),
                    cell = find_channel(image, "cell.id").value();
  std::size_t hits = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += stride) {
    const double nx = image.pixels[i + x], ny = image.pixels[i + y], nz = image.pixels[i + z];
    const bool hit = image.pixels[i + cell] > 0;
    hits += hit;
    REQUIRE(nx * nx + ny * ny + nz * nz == Approx(hit ? 1 : 0).margin(1e-5));
  }
  CHECK(hits > 100);
}

TEST_CASE("making the surface is measured, and does not depend on threads") {
  const Scene one({"--color", "stone", "--normals", "--threads", "1"});
  const Scene two({"--color", "stone", "--normals", "--threads", "2"});
  CHECK(read_bytes(one.asset) == read_bytes(two.asset));
  const Run run = run_command({"convert", one.folder.file("ball.off"), one.folder.file("o.meso"), "--tiles",
                               "8", "--tile", "voronoi:cells=8,resolution=16,seed=1", "--color", "stone",
                               "--normals", "--json"});
  REQUIRE(run.exit == 0);
  CHECK(run.json()["seconds"]["surface"] > 0.0005);  // 64³ sums of noise, and 3000 gradients
  CHECK(run.json()["normals"] > 100);
  CHECK(read_bytes(one.folder.file("o.meso")) == read_bytes(one.asset));
}

TEST_CASE("a mesh that is not closed is repaired, and what was done is told and kept") {
  const TempFolder folder;
  TriangleMesh mesh = make_sphere({0, 0, 0}, 1, 16);
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  const auto convert = [&](const std::string& input, const std::string& repair) {
    return run_command({"convert", input, folder.file("o.meso"), "--tiles", "6", "--tile",
                        "voronoi:resolution=8", "--json", "--repair", repair});
  };
  const std::string turned = folder.write("turned.off", mesh_bytes(mesh, "mesh.off"));
  CHECK(convert(turned, "strict").exit == 3);
  json result = convert(turned, "auto").json();
  CHECK(result["repair"]["rung"] == "orient");
  CHECK(result["repair"]["turned_triangles"] == 1);
  CHECK(result["warnings"][0]["id"] == "mesh-oriented");
  mesh.triangles.erase(mesh.triangles.begin() + 40, mesh.triangles.begin() + 44);
  const std::string open = folder.write("open.off", mesh_bytes(mesh, "mesh.off"));
  CHECK(convert(open, "orient").exit == 3);
  for (const char* repair : {"winding", "auto"}) {
    result = convert(open, repair).json();
    CHECK(result["repair"]["rung"] == "winding");
    CHECK(result["repair"]["boundary_edges"] > 0);
    CHECK(result["metadata"]["repair"].get<std::string>().starts_with("winding, "));
    CHECK(result["warnings"].back()["id"] == "mesh-open");
  }
  CHECK(convert(open, "perhaps").exit == 2);
}

TEST_CASE("a picture colors a mesh by its texture coordinates, where the mesh names none") {
  const TempFolder folder;
  // The left half of the box looks into the left half of the picture, which is red, the right one into blue.
  std::string box =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvt 0 0.5\nvt 1 0.5\n";
  for (const char* face : {"1 4 3 2", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8"}) {
    box += "f";
    for (const std::size_t k : {0, 2, 4, 6}) {
      const int vertex = face[k] - '0';
      box += " " + std::to_string(vertex) + "/" +
             (vertex == 1 || vertex == 4 || vertex == 5 || vertex == 8 ? "1" : "2");
    }
    box += "\n";
  }
  const std::string mesh = folder.write("box.obj", box), asset = folder.file("box.meso");
  const std::string picture = folder.write("skin.png", png_bytes({2, 1, 3, {255, 0, 0, 0, 0, 255}}));
  const Run run =
      run_command({"convert", mesh, asset, "--tiles", "6", "--tile", "voronoi:cells=8,resolution=8",
                   "--color", "mesh:texture=" + picture, "--json"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  CHECK(run.json()["metadata"]["color"] == "mesh:texture=skin.png");
  const std::string ply = folder.file("out.ply");
  REQUIRE(run_command({"convert", asset, ply}).exit == 0);
  find_image_module();
  REQUIRE(run_command({"render", asset, folder.file("c.png"), "--mode", "color", "--size", "40x30", "--eye",
                       "0.5,0.5,4", "--look", "0.5,0.5,0"})
              .exit == 0);
  const Image image = read_picture(folder.file("c.png"));
  const auto at = [&](std::uint32_t x, std::size_t channel) {
    return image.pixels[(15 * image.width + x) * image.channels.size() + channel];
  };
  CHECK(at(14, 0) > at(14, 2));
  CHECK(at(26, 2) > at(26, 0));
  const std::string bare = folder.write("bare.obj", mesh_bytes(make_box({0, 0, 0}, {1, 1, 1}), "mesh.obj"));
  CHECK(run_command({"convert", bare, asset, "--color", "mesh:texture=" + picture}).exit == 2);
  CHECK(run_command({"convert", mesh, asset, "--color", "mesh:texture=" + folder.file("none.png")}).exit ==
        3);
}

TEST_CASE("baked colors are finer than cells") {
  const TempFolder folder;
  // Red to blue along x.
  TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  for (const Vec3& v : box.vertices) box.colors.push_back(v.x > 0.5 ? Rgb8{0, 0, 255} : Rgb8{255, 0, 0});
  const std::string mesh = folder.write("box.off", mesh_bytes(box, "mesh.off"));
  const auto make = [&](const char* color) {
    const std::string asset = folder.file("box.meso");
    const Run run = run_command({"convert", mesh, asset, "--tiles", "4", "--tile", "bricks:resolution=16",
                                 "--color", color, "--json"});
    INFO(run.err);
    REQUIRE(run.exit == 0);
    CHECK(run.json()["metadata"]["color"] == color);
    CHECK(run_command({"validate", asset}).exit == 0);
    return info_of(asset);
  };
  const auto colors_in_a_row = [&] {
    REQUIRE(run_command({"render", folder.file("box.meso"), folder.file("c.png"), "--mode", "color", "--size",
                         "80x60", "--eye", "0.5,0.5,4", "--look", "0.5,0.5,0"})
                .exit == 0);
    const Image image = read_picture(folder.file("c.png"));
    const std::size_t stride = image.channels.size();
    std::vector<float> reds;
    for (std::size_t x = 0; x < image.width; ++x) {
      const float* const pixel = image.pixels.data() + (30 * image.width + x) * stride;
      if (pixel[0] + pixel[2] > 0.1f && pixel[1] < 0.1f && (reds.empty() || reds.back() != pixel[0]))
        reds.push_back(pixel[0]);
    }
    CHECK(std::is_sorted(reds.rbegin(), reds.rend()));
    return reds.size();
  };
  find_image_module();
  const json plain = make("mesh");
  CHECK(plain["surface_color_resolution"].is_null());
  CHECK(plain["surface_colors"] == 0);
  const std::size_t of_cells = colors_in_a_row();
  const json baked = make("mesh:bake=8");
  CHECK(baked["surface_color_resolution"] == json({8, 8, 8}));
  CHECK(baked["surface_colors"] > 1000);
  CHECK(baked["instance_colors"] == plain["instance_colors"]);
  CHECK(baked["max_error"]["surface_colors"] == 0.5);
  CHECK(colors_in_a_row() >= 3 * of_cells);
  CHECK(make("mesh:bake=4x2x1")["surface_color_resolution"] == json({4, 2, 1}));
  for (const char* wrong : {"mesh:bake=0", "mesh:bake=33", "mesh:bake=fine", "marble:bake=4"})
    CHECK(run_command({"convert", mesh, folder.file("no.meso"), "--tiles", "4", "--color", wrong}).exit == 2);
}

TEST_CASE("a glTF with a texture and an OBJ with materials give their colors to the cells") {
  const TempFolder folder;
  const std::string box =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
      "usemtl red\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  folder.write("box.mtl", "newmtl red\nKd 1 0 0\n");
  const std::string mesh = folder.write("box.obj", "mtllib box.mtl\n" + box), asset = folder.file("box.meso");
  const Run run = run_command({"convert", mesh, asset, "--tiles", "4", "--color", "mesh", "--json"});
  CHECK(run.exit == 0);
  CHECK(run.json()["instances"]["inside"] > 0);
  const Run info = run_command({"info", mesh, "--json"});
  CHECK(info.json()["materials"] == 1);
  // A picture of a kind that the image library reads, by its content.
  folder.write("light.hdr", hdr_bytes({1, 1, 4, {128, 0, 0, 128}}));
  folder.write("box.mtl", "newmtl red\nmap_Kd light.hdr\n");
  folder.write("box.obj", "mtllib box.mtl\nvt 0.5 0.5\n" + box);
  CHECK(run_command({"info", mesh, "--json"}).json()["textures"] == 1);
  // The file of materials is gone: a warning, and then there are no colors.
  folder.write("box.obj", "mtllib none.mtl\n" + box);
  CHECK(run_command({"info", mesh, "--json"}).json()["warnings"][0]["id"] == "material-missing");
  CHECK(run_command({"convert", mesh, asset, "--tiles", "4", "--color", "mesh"}).exit == 2);
  const auto truck = find_data("meshes/CesiumMilkTruck.glb");
  if (!truck) {
    WARN("skipped: the test data are not there");
    return;
  }
  const Run glb = run_command({"convert", *truck, asset, "--tiles", "8", "--color", "mesh", "--json"});
  CHECK(glb.exit == 0);
  CHECK(run_command({"info", *truck, "--json"}).json()["textures"] == 1);
}
