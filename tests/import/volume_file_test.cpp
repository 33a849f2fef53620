#include "converters/import/volume_file.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "converters/image/image_file.h"
#include "converters/import/slice_stack.h"
#include "sdk/core/rng.h"
#include "tests/import/mesh_bytes.h"
#include "tests/import/picture_bytes.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Random labels below `limit`.
LabelVolume random_labels(const Index3& n, std::uint64_t limit, std::uint64_t seed) {
  LabelVolume volume{n, {}};
  Rng rng(seed);
  for (std::uint64_t i = 0; i < volume.voxel_count(); ++i)
    volume.labels.push_back(std::uint32_t(rng.next() % limit));
  return volume;
}

/// Slice z as a gray picture: the top row is the largest y.
PlainPicture slice(const LabelVolume& volume, std::uint32_t z) {
  const Index3& n = volume.resolution;
  PlainPicture picture{n[0], n[1], 1, {}};
  for (std::uint32_t row = 0; row < n[1]; ++row)
    for (std::uint32_t x = 0; x < n[0]; ++x)
      picture.samples.push_back(volume.labels[x + n[0] * (n[1] - 1 - row + n[1] * z)]);
  return picture;
}

std::vector<PlainPicture> all_slices(const LabelVolume& volume) {
  std::vector<PlainPicture> pages;
  for (std::uint32_t z = 0; z < volume.resolution[2]; ++z) pages.push_back(slice(volume, z));
  return pages;
}

void check_labels(const Result<LabelVolume>& read, const LabelVolume& volume) {
  if (!read.ok()) FAIL_CHECK(read.error().message);
  REQUIRE(read.ok());
  CHECK(read->resolution == volume.resolution);
  CHECK(read->labels == volume.labels);
}

/// Labels as RGB pictures.
PlainPicture split(const PlainPicture& labels, bool alpha) {
  PlainPicture picture{labels.width, labels.height, alpha ? 4u : 3u, {}};
  for (const std::uint32_t label : labels.samples) {
    for (const unsigned shift : {0u, 8u, 16u}) picture.samples.push_back(label >> shift & 255);
    if (alpha) picture.samples.push_back(std::uint32_t(picture.samples.size() % 251));
  }
  return picture;
}

std::string raw_bytes(const LabelVolume& volume, unsigned bytes) {
  std::string out;
  for (const std::uint32_t label : volume.labels)
    for (unsigned k = 0; k < bytes; ++k) out += char(std::uint8_t(label >> (8 * k)));
  return out;
}

std::uint8_t rounded_srgb(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  return std::uint8_t(std::lround(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055)));
}

}  // namespace

TEST_CASE("names are ordered as people count") {
  const std::vector<std::string> sorted = {"0.png",
                                           "00.png",
                                           "1.png",
                                           "a",
                                           "a0",
                                           "a00",
                                           "a1",
                                           "a01b",
                                           "a1c",
                                           "a2",
                                           "a2b10",
                                           "a10",
                                           "a10b2",
                                           "a10b9",
                                           "a10b10",
                                           "b",
                                           "slice99999999999999999999.png",
                                           "slice100000000000000000000.png"};
  for (std::size_t i = 0; i < sorted.size(); ++i)
    for (std::size_t k = 0; k < sorted.size(); ++k) {
      INFO(sorted[i] << " and " << sorted[k]);
      CHECK(natural_less(sorted[i], sorted[k]) == (i < k));
    }
}

TEST_CASE("a stack of PNG slices gives its labels exactly") {
  const TempFolder folder;
  for (const unsigned bits : {1u, 2u, 4u, 8u, 16u}) {
    INFO(bits << " bits");
    const LabelVolume volume = random_labels({7, 5, 12}, std::uint64_t{1} << bits, bits);
    // z = 2 is slice2 and comes before slice10.
    for (std::uint32_t z = 0; z < 12; ++z)
      folder.write("slice" + std::to_string(z) + ".png", png_bytes(slice(volume, z), {.bits = bits}));
    folder.write(".hidden", "no picture");
    check_labels(read_label_volume(folder.path()), volume);
    check_labels(read_label_volume(folder.path() + "/"), volume);
  }
}

TEST_CASE("axes: columns are x, rows y from the bottom, slices z") {
  const TempFolder folder;
  for (std::uint32_t z = 0; z < 6; ++z) {
    PlainPicture picture{4, 5, 1, std::vector<std::uint32_t>(20)};
    if (z == 4) picture.samples[0 * 4 + 3] = 9;  // the last column of the top row
    folder.write(std::to_string(z) + ".PNG", png_bytes(picture));
  }
  const Result<LabelVolume> volume = read_label_volume(folder.path());
  REQUIRE(volume.ok());
  CHECK(volume->resolution == Index3{4, 5, 6});
  CHECK(std::count(volume->labels.begin(), volume->labels.end(), 0u) == 4 * 5 * 6 - 1);
  CHECK(volume->labels[3 + 4 * (4 + 5 * 4)] == 9);
}

TEST_CASE("the label of a color is r + 256 g + 65536 b, whatever its alpha") {
  const LabelVolume volume = random_labels({6, 4, 4}, 1 << 24, 5);
  for (const bool alpha : {false, true}) {
    const TempFolder stack;
    std::vector<PlainPicture> pages;
    for (std::uint32_t z = 0; z < 4; ++z) {
      pages.push_back(split(slice(volume, z), alpha));
      stack.write(std::to_string(z) + ".png", png_bytes(pages.back()));
    }
    check_labels(read_label_volume(stack.path()), volume);
    for (const bool separate : {false, true})
      check_labels(read_label_volume(stack.write("v.tif", tiff_bytes(pages, {.separate = separate}))),
                   volume);
  }
  // A palette of labels 0x030201, 0, 0x0000ff, and gray with alpha.
  const TempFolder stack, gray;
  const PlainPicture indices{4, 4, 1, {0, 1, 2, 2, 1, 1, 1, 1, 2, 2, 2, 2, 0, 0, 0, 0}};
  PlainPicture with_alpha{4, 4, 2, {}};
  for (const std::uint32_t index : indices.samples) {
    with_alpha.samples.push_back(index);
    with_alpha.samples.push_back(0);
  }
  for (int z = 0; z < 4; ++z) {
    stack.write(std::to_string(z) + ".png",
                png_bytes(indices, {.bits = 4, .color_type = 3, .palette = {1, 2, 3, 0, 0, 0, 255, 0, 0}}));
    gray.write(std::to_string(z) + ".png", png_bytes(with_alpha));
  }
  const Result<LabelVolume> colors = read_label_volume(stack.path()), values = read_label_volume(gray.path());
  REQUIRE(colors.ok());
  REQUIRE(values.ok());
  CHECK(std::vector(colors->labels.end() - 4, colors->labels.end()) ==
        std::vector<std::uint32_t>{0x030201, 0, 255, 255});
  CHECK(std::vector(values->labels.end() - 4, values->labels.end()) ==
        std::vector<std::uint32_t>{0, 1, 2, 2});
}

TEST_CASE("a TIFF of several pages gives its labels exactly, however it is written") {
  const TempFolder folder;
  for (const unsigned bits : {1u, 2u, 4u, 8u, 16u, 32u})
    for (const unsigned compression : {1u, 5u, 8u, 32773u})
      for (const bool big : {false, true})
        for (const std::uint32_t rows : {0u, 1u, 4u, 9u})
          for (const std::uint32_t tile : {0u, 16u}) {
            if (tile && (rows || bits < 8)) continue;
            INFO(bits << " bits, compression " << compression << ", big " << big << ", rows " << rows
                      << ", tile " << tile);
            const LabelVolume volume = random_labels({21, 18, 4}, std::uint64_t{1} << bits, bits);
            const TiffOptions options{.big_endian = big,
                                      .big_tiff = rows == 4,
                                      .bits = bits,
                                      .compression = compression,
                                      .rows_per_strip = rows,
                                      .tile = tile};
            check_labels(read_label_volume(folder.write("v.tif", tiff_bytes(all_slices(volume), options))),
                         volume);
          }
  // Signed values that are not negative, and a palette.
  const LabelVolume volume = random_labels({5, 4, 5}, 128, 9);
  check_labels(read_label_volume(folder.write("i.tif", tiff_bytes(all_slices(volume), {.format = 2}))),
               volume);
  std::vector<std::uint32_t> map(3 * 256);
  for (std::uint32_t k = 0; k < 256; ++k) map[k] = 257 * k;
  check_labels(read_label_volume(folder.write(
                   "p.tif", tiff_bytes(all_slices(volume), {.photometric = 3, .tags = {{320, map}}}))),
               volume);
}

TEST_CASE("floats are labels if they are whole numbers") {
  const TempFolder folder;
  LabelVolume volume = random_labels({4, 4, 4}, 16777217, 2), bits = volume;
  volume.labels[5] = bits.labels[5] = 16777216;
  for (std::uint32_t& label : bits.labels) label = std::bit_cast<std::uint32_t>(float(label));
  const TiffOptions options{.bits = 32, .format = 3};
  check_labels(read_label_volume(folder.write("f.tif", tiff_bytes(all_slices(bits), options))), volume);
  for (const float wrong : {0.5f, -1.0f, 16777218.0f, std::nanf(""), HUGE_VALF}) {
    LabelVolume damaged = bits;
    damaged.labels[40] = std::bit_cast<std::uint32_t>(wrong);
    const auto read = read_label_volume(folder.write("w.tif", tiff_bytes(all_slices(damaged), options)));
    REQUIRE(!read.ok());
    CHECK(read.error().code == ErrorCode::kInvalidInput);
    // Voxel 40 = (0, 2, 2) lies in the second row from the top.
    CHECK(read.error().message.find("column 0, row 1") != std::string::npos);
  }
}

TEST_CASE("EXR slices are labels if their values are whole") {
  const TempFolder folder;
  const LabelVolume volume = random_labels({4, 6, 4}, 70000, 8);
  const std::vector<std::string> names = {"Y"};
  for (std::uint32_t z = 0; z < 4; ++z) {
    const PlainPicture picture = slice(volume, z);
    const std::vector<float> pixels(picture.samples.begin(), picture.samples.end());
    REQUIRE(write_image_file(folder.file(std::to_string(z) + ".exr"), {4, 6, names, pixels}).ok());
  }
  check_labels(read_label_volume(folder.path()), volume);
}

TEST_CASE("raw labels have 8, 16 or 32 bits by the file's size") {
  const TempFolder folder;
  for (const unsigned bytes : {1u, 2u, 4u}) {
    const LabelVolume volume = random_labels({5, 6, 7}, std::uint64_t{1} << (8 * bytes), bytes);
    const std::string path = folder.write("v.RAW", raw_bytes(volume, bytes));
    CHECK(is_raw_volume(path));
    VolumeReadOptions options;
    options.raw_resolution = volume.resolution;
    check_labels(read_label_volume(path, options), volume);
  }
  CHECK_FALSE(is_raw_volume("v.png"));
  CHECK_FALSE(is_raw_volume(folder.path()));
}

TEST_CASE("colors of 8 bits stay as they are, from every source") {
  const TempFolder folder;
  const LabelVolume colors = random_labels({5, 3, 2}, 1 << 24, 4);
  ColorMap map{colors.resolution, {}};
  for (const std::uint32_t c : colors.labels)
    map.voxels.push_back({std::uint8_t(c), std::uint8_t(c >> 8), std::uint8_t(c >> 16)});
  std::vector<PlainPicture> pages;
  for (std::uint32_t z = 0; z < 2; ++z) pages.push_back(split(slice(colors, z), z == 0));
  folder.write("1.png", png_bytes(pages[1]));
  folder.write("0.png", png_bytes(pages[0]));
  const Result<ColorMap> stack = read_color_volume(folder.path());
  REQUIRE(stack.ok());
  CHECK(*stack == map);
  pages[0] = split(slice(colors, 0), false);
  const Result<ColorMap> tiff = read_color_volume(folder.write("v.tiff", tiff_bytes(pages)));
  REQUIRE(tiff.ok());
  CHECK(*tiff == map);
  VolumeReadOptions options;
  options.raw_resolution = map.resolution;
  const Result<ColorMap> raw = read_color_volume(folder.write("v.raw", raw_bytes(colors, 3)), options);
  REQUIRE(raw.ok());
  CHECK(*raw == map);
  // One picture is one slice.
  const Result<ColorMap> single = read_color_volume(folder.file("1.png"));
  REQUIRE(single.ok());
  CHECK(single->resolution == Index3{5, 3, 1});
  CHECK(std::equal(single->voxels.begin(), single->voxels.end(), map.voxels.begin() + 15));
}

TEST_CASE("gray becomes RGB, more bits become 8, linear light becomes sRGB") {
  const TempFolder folder;
  const auto read = [&](const std::string& name, const std::string& bytes) {
    const Result<ColorMap> map = read_color_volume(folder.write(name, bytes));
    if (!map.ok()) FAIL(map.error().message);
    return map->voxels;
  };
  const auto gray = [](std::initializer_list<int> values) {
    std::vector<Rgb8> colors;
    for (const int v : values) colors.push_back({std::uint8_t(v), std::uint8_t(v), std::uint8_t(v)});
    return colors;
  };
  CHECK(read("a.png", png_bytes({3, 1, 1, {0, 7, 255}})) == gray({0, 7, 255}));
  CHECK(read("a.png", png_bytes({4, 1, 1, {0, 1, 2, 3}}, {.bits = 2})) == gray({0, 85, 170, 255}));
  CHECK(read("a.png", png_bytes({4, 1, 1, {0, 128, 129, 65535}}, {.bits = 16})) == gray({0, 0, 1, 255}));
  CHECK(read("a.tif", tiff_bytes({{2, 1, 1, {0x7fffffff, 0xffffffff}}}, {.bits = 32})) == gray({127, 255}));
  CHECK(read("a.tif", tiff_bytes({{2, 1, 1, {127, 64}}}, {.format = 2})) == gray({255, 129}));
  CHECK(read("a.png", png_bytes({3, 1, 1, {0, 128, 255}}, {.gamma = 100000})) == gray({0, 188, 255}));
  CHECK(read("a.png", png_bytes({3, 1, 1, {0, 128, 255}}, {.gamma = 45455})) == gray({0, 128, 255}));
  const auto f = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  CHECK(read("a.tif", tiff_bytes({{5, 1, 1, {f(0.5f), f(-1), f(2), f(std::nanf("")), f(HUGE_VALF)}}},
                                 {.bits = 32, .format = 3})) == gray({188, 0, 255, 0, 255}));
  // Mantissas of 1/2 and 1/4 of 2^1.
  CHECK(read("a.hdr", hdr_bytes({2, 1, 4, {128, 64, 0, 129, 0, 0, 128, 128}})) ==
        std::vector<Rgb8>{{255, 188, 0}, {0, 0, 188}});
  const std::vector<std::string> names = {"A", "B", "G", "R"};
  const std::vector<float> pixels = {0.1f, 0, 0.25f, 1};
  REQUIRE(write_image_file(folder.file("a.exr"), {1, 1, names, pixels}).ok());
  const Result<ColorMap> exr = read_color_volume(folder.file("a.exr"));
  REQUIRE(exr.ok());
  CHECK(exr->voxels == std::vector<Rgb8>{{255, rounded_srgb(0.25), 0}});
  VolumeReadOptions options;
  options.raw_resolution = Index3{2, 1, 1};
  const Result<ColorMap> raw = read_color_volume(folder.write("a.raw", "\x07\x08"), options);
  REQUIRE(raw.ok());
  CHECK(raw->voxels == gray({7, 8}));
}

TEST_CASE("volumes of others") {
  const auto texture = find_data("textures3d/perlinvolume.dds");
  const auto heights = find_data("heights/heightmap_16bit.png"),
             jpeg = find_data("heights/brickwall_albedo.png");
  const auto linear = find_data("heights/heightmap_16bit.exr"),
             negative = find_data("heights/bigtujunga.tif");
  const auto squared = find_data("heights/dem_squared.tif");
  if (!texture || !heights || !jpeg || !linear || !negative || !squared) {
    WARN("skipped: the test data are not there");
    return;
  }
  const TempFolder folder;
  // A header of 128 bytes, then 128³ of 8 bits.
  VolumeReadOptions options;
  options.raw_resolution = Index3{128, 128, 128};
  const std::string path = folder.write("perlin.raw", read_bytes(*texture).substr(128));
  const Result<ColorMap> perlin = read_color_volume(path, options);
  REQUIRE(perlin.ok());
  CHECK(perlin->voxels.size() == 128 * 128 * 128);
  CHECK(read_label_volume(path, options).ok());
  CHECK(read_color_volume(*texture)->resolution == Index3{128, 128, 128});
  const Result<ColorMap> picture = read_color_volume(*heights), exr = read_color_volume(*linear);
  REQUIRE(picture.ok());
  REQUIRE(exr.ok());
  CHECK(picture->resolution == Index3{253, 253, 1});
  CHECK(exr->resolution == Index3{253, 253, 1});
  const auto albedo = read_color_volume(*jpeg);  // JPEG under the name of a PNG
  REQUIRE(albedo);
  CHECK(albedo->resolution == Index3{512, 512, 1});
  const auto labels = read_label_volume(*jpeg);
  REQUIRE_FALSE(labels);
  CHECK(labels.error().code == ErrorCode::kInvalidInput);
  CHECK(read_color_volume(*negative).error().code == ErrorCode::kLimit);
  CHECK(read_color_volume(*squared)->resolution == Index3{129, 129, 1});
}

namespace {

/// A DirectDraw Surface of 8 bits a channel, gray or BGR.
std::string dds_bytes(std::uint32_t width, std::uint32_t height, std::uint32_t depth, bool gray) {
  std::string bytes(128, '\0');
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = char(value >> (8 * k));
  };
  bytes.replace(0, 4, "DDS ");
  put(4, 124);
  put(8, 0x801007);
  put(12, height);
  put(16, width);
  put(24, depth);
  put(76, 32);
  put(80, gray ? 0x20000 : 0x40);
  put(88, gray ? 8 : 24);
  put(92, gray ? 0xff : 0xff0000);
  put(96, gray ? 0 : 0xff00);
  put(100, gray ? 0 : 0xff);
  const std::size_t count = std::size_t{width} * height * depth * (gray ? 1 : 3);
  for (std::size_t i = 0; i < count; ++i) bytes += char(i % 251);
  return bytes;
}

}  // namespace

TEST_CASE("a volume texture has its slices, rows from the top and colors as they are stored") {
  const TempFolder folder;
  const std::string path = folder.write("a.dds", dds_bytes(5, 4, 6, true));
  const auto labels = read_label_volume(path);
  REQUIRE(labels);
  CHECK(labels->resolution == Index3{5, 4, 6});
  // Voxel (1, 3, 2) is of the top row of the third slice.
  CHECK(labels->labels[1 + 5 * (3 + 4 * 2)] == 1 + 5 * (0 + 4 * 2));
  const auto values = read_scalar_volume(path);
  REQUIRE(values);
  CHECK(values->values[1 + 5 * (0 + 4 * 5)] == float(1 + 5 * (3 + 4 * 5)));
  const auto colors = read_color_volume(folder.write("b.dds", dds_bytes(4, 4, 4, false)));
  REQUIRE(colors);
  CHECK(colors->voxels[4 * 3] == Rgb8{2, 1, 0});
  CHECK(is_slice_stack(path));
}

TEST_CASE("what of slices is passed over is told") {
  using Losses = std::set<std::string>;
  const TempFolder folder;
  PlainPicture rgba{4, 4, 4, std::vector<std::uint32_t>(64, 5)};
  const auto of_colors = [&](const std::string& path) {
    ReadNotes notes;
    REQUIRE(read_color_volume(path, {}, nullptr, &notes).ok());
    return notes.losses;
  };
  const std::string alpha = folder.write("a.png", png_bytes(rgba));
  CHECK(of_colors(alpha) == Losses{"alpha"});
  const std::string deep = folder.write("b.png", png_bytes({1, 1, 3, {1, 2, 3}}, {.bits = 16}));
  CHECK(of_colors(deep) == Losses{"precision of colors beyond 8 bits"});
  CHECK(of_colors(folder.write("c.png", png_bytes({1, 1, 3, {1, 2, 3}}))).empty());
  const std::string stack =
      folder.write("v.tif", tiff_bytes({rgba, rgba, rgba, rgba}, {.tags = {{338, {2}}}}));
  ReadNotes notes;
  REQUIRE(read_label_volume(stack, {}, nullptr, &notes).ok());
  CHECK(notes.losses == Losses{"alpha"});
  notes = {};
  REQUIRE(read_scalar_volume(stack, {}, nullptr, &notes).ok());
  CHECK(notes.losses == Losses{"channel A", "channel B", "channel G"});
  notes = {};
  const auto with = [](std::string bytes, std::size_t at, std::uint32_t bits) {
    for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = char(std::uint8_t(bytes[at + k]) | bits >> (8 * k));
    return bytes;
  };
  const std::string dds = dds_bytes(4, 4, 4, true);
  REQUIRE(read_label_volume(folder.write("a.dds", dds), {}, nullptr, &notes).ok());
  CHECK(notes.losses.empty());
  const std::string more = with(with(with(dds, 8, 0x20000), 28, 3), 80, 1);
  REQUIRE(read_label_volume(folder.write("b.dds", more), {}, nullptr, &notes).ok());
  CHECK(notes.losses == Losses{"alpha", "levels of detail"});
  CHECK(notes.files.empty());
}

TEST_CASE("a volume texture that is damaged or of another kind is refused") {
  const TempFolder folder;
  const std::string whole = dds_bytes(5, 4, 6, true);
  const auto refused = [&](const std::string& bytes) {
    const auto read = read_scalar_volume(folder.write("a.dds", bytes));
    if (!read)
      CHECK((read.error().code == ErrorCode::kInvalidInput || read.error().code == ErrorCode::kLimit));
    return !read;
  };
  for (std::size_t bytes = 1; bytes < whole.size(); ++bytes)
    if (!refused(whole.substr(0, bytes))) FAIL("a file cut off at " << bytes << " is read");
  const auto with = [&](std::size_t at, std::uint32_t value) {
    std::string bytes = whole;
    for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = char(value >> (8 * k));
    return bytes;
  };
  for (const std::size_t at : {12u, 16u, 24u}) {
    CHECK(refused(with(at, 0)));
    CHECK(refused(with(at, 0xffffffff)));
    CHECK(refused(with(at, 0x10000)));
  }
  CHECK(refused(with(4, 123)));
  CHECK(refused(with(80, 0x4).replace(84, 4, "DXT5")));
  CHECK(refused(with(88, 7)));
  CHECK(refused(with(92, 0x1ff)));
  CHECK(refused(with(112, 0x200)));
}
