#include <bit>
#include <string>

#include "converters/image/page_writer.h"
#include "converters/import/mesh_file.h"
#include "sdk/core/srgb.h"
#include "tests/import/mesh_bytes.h"
#include "tests/import/picture_bytes.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

using Texels = std::vector<Rgb8>;

const Texels kFourTexels = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}};

/// A triangle with a picture.
Result<PaintedMesh> read(const TempFolder& folder, const std::string& picture, MeshReadReport& report) {
  folder.write("a.mtl", "newmtl m\nmap_Kd " + picture + "\n");
  return read_painted_mesh(
      folder.write("a.obj",
                   "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\n"
                   "f 1/1 2/2 3/3\n"),
      {}, &report);
}

Texels texels(const TempFolder& folder, const std::string& picture) {
  MeshReadReport report;
  const Result<PaintedMesh> mesh = read(folder, picture, report);
  REQUIRE(mesh.ok());
  INFO((report.warnings.empty() ? "" : report.warnings[0].text));
  REQUIRE(mesh->paint.images.size() == 1);
  CHECK(report.warnings.empty());
  return mesh->paint.images[0].texels;
}

/// Why it is left out.
std::string warning(const TempFolder& folder, const std::string& picture) {
  MeshReadReport report;
  const Result<PaintedMesh> mesh = read(folder, picture, report);
  REQUIRE(mesh.ok());
  CHECK(mesh->paint.images.empty());
  REQUIRE(report.warnings.size() == 1);
  CHECK(report.warnings[0].id == "texture-missing");
  return report.warnings[0].text;
}

std::string exr(const std::vector<float>& samples, std::uint32_t pages = 1) {
  const std::vector<std::string> names = {"R", "G", "B"};
  const auto bytes =
      encode_pages("a.exr", {2, 1, pages, names, PageSampleType::kFloat, std::as_bytes(std::span(samples))});
  REQUIRE(bytes.ok());
  return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

}  // namespace

TEST_CASE("textures: TIFF of all kinds of numbers") {
  const TempFolder folder;
  for (const bool big_endian : {false, true}) {
    TiffOptions options{.big_endian = big_endian};
    folder.write("a.tif", tiff_bytes({kFour}, options));
    CHECK(texels(folder, "a.tif") == kFourTexels);
    options.bits = 16;
    folder.write("b.tiff", tiff_bytes({{2, 1, 3, {65535, 0, 257 * 50, 128, 129, 32768}}}, options));
    CHECK(texels(folder, "b.tiff") == Texels{{255, 0, 50}, {0, 1, 128}});
    // Floats are linear light.
    options = {.big_endian = big_endian, .bits = 32, .format = 3};
    const auto f = [](float x) { return std::bit_cast<std::uint32_t>(x); };
    folder.write("c.tif", tiff_bytes({{1, 1, 3, {f(2), f(0.2f), f(-1)}}}, options));
    CHECK(texels(folder, "c.tif") == Texels{{255, linear_to_srgb8(double{0.2f}), 0}});
  }
  folder.write("gray.tif", tiff_bytes({{2, 1, 1, {7, 250}}}));
  CHECK(texels(folder, "gray.tif") == Texels{{7, 7, 7}, {250, 250, 250}});
  folder.write("alpha.tif", tiff_bytes({{1, 1, 4, {1, 2, 3, 0}}}, {.compression = 8, .tags = {{338, {2}}}}));
  CHECK(texels(folder, "alpha.tif") == Texels{{1, 2, 3}});
}

TEST_CASE("textures: the first page or part of several") {
  const TempFolder folder;
  PlainPicture other = kFour;
  other.samples.assign(12, 9);
  folder.write("a.tif", tiff_bytes({kFour, other, other}));
  CHECK(texels(folder, "a.tif") == kFourTexels);
  folder.write("a.exr", exr({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1}, 2));
  CHECK(texels(folder, "a.exr") == Texels{{255, 0, 0}, {0, 255, 0}});
}

TEST_CASE("textures: pictures are what they begin as, whatever their names") {
  const TempFolder folder;
  const std::string light = exr({1, 0.2f, 0, 0, 0.5f, 1});
  const Texels expected = {{255, linear_to_srgb8(double{0.2f}), 0}, {0, linear_to_srgb8(0.5), 255}};
  for (const char* name : {"a.exr", "a.png", "a", "a.tif"}) {
    INFO(name);
    folder.write(name, light);
    CHECK(texels(folder, name) == expected);
  }
  folder.write("b.jpg", tiff_bytes({kFour}));
  CHECK(texels(folder, "b.jpg") == kFourTexels);
  folder.write("c.exr", png_bytes(kFour));
  CHECK(texels(folder, "c.exr") == kFourTexels);
  folder.write("d.tif", hdr_bytes({1, 1, 4, {128, 0, 64, 129}}));
  CHECK(texels(folder, "d.tif") == Texels{{255, 0, linear_to_srgb8(0.5)}});
  // Also one that colors a mesh in place of its materials.
  MeshReadReport report;
  MeshReadOptions options;
  options.texture = folder.file("b.jpg");
  REQUIRE(read(folder, "none.png", report).ok());
  const Result<PaintedMesh> mesh = read_painted_mesh(folder.file("a.obj"), options, &report);
  REQUIRE(mesh.ok());
  CHECK(mesh->paint.images[0].texels == kFourTexels);
}

TEST_CASE("textures: what is damaged or too large is left out, with the reason") {
  const TempFolder folder;
  const std::string whole = tiff_bytes({kFour});
  for (std::size_t n = 4; n < whole.size(); n += 5) {
    folder.write("a.tif", whole.substr(0, n));
    CHECK_FALSE(warning(folder, "a.tif").empty());
  }
  folder.write("b.tif", tiff_bytes({kFour}, {.tags = {{256, {40000}}}}));
  CHECK(warning(folder, "b.tif").find("40000") != std::string::npos);
  const std::string light = exr({1, 0, 0, 0, 1, 0});
  for (std::size_t n = 4; n + 9 < light.size(); n += 23) {
    INFO(n);
    folder.write("c.exr", light.substr(0, n));
    CHECK_FALSE(warning(folder, "c.exr").empty());
  }
}
