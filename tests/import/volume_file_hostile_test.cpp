#include <sys/stat.h>

#include <atomic>
#include <filesystem>

#include "converters/image/image_file.h"
#include "converters/image/image_reader.h"
#include "converters/import/volume_file.h"
#include "sdk/core/rng.h"
#include "tests/import/mesh_bytes.h"
#include "tests/import/messages.h"
#include "tests/import/picture_bytes.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

PlainPicture gray(std::uint32_t width, std::uint32_t height, std::uint32_t value = 3) {
  return {width, height, 1, std::vector<std::uint32_t>(std::size_t{width} * height, value)};
}
std::vector<PlainPicture> gray_pages(std::uint32_t width, std::uint32_t height, std::uint32_t pages) {
  return std::vector<PlainPicture>(pages, gray(width, height));
}

/// A small picture of different labels.
std::vector<PlainPicture> small_pages() {
  std::vector<PlainPicture> pages = gray_pages(5, 4, 4);
  std::uint32_t label = 0;
  for (PlainPicture& page : pages)
    for (std::uint32_t& sample : page.samples) sample = ++label;
  return pages;
}

/// The error's message, with its code checked, of labels or colors.
std::string refusal(const std::string& path, ErrorCode code = ErrorCode::kInvalidInput,
                    const VolumeReadOptions& options = {}, bool color = false) {
  Error error;
  if (color) {
    const Result<ColorMap> map = read_color_volume(path, options);
    REQUIRE(!map.ok());
    error = map.error();
  } else {
    const Result<LabelVolume> volume = read_label_volume(path, options);
    REQUIRE(!volume.ok());
    error = volume.error();
  }
  INFO(error.message);
  CHECK(error.code == code);
  CHECK(!error.message.empty());
  return error.message;
}

std::string tiff_refusal(const std::vector<PlainPicture>& pages, const TiffOptions& options,
                         ErrorCode code = ErrorCode::kInvalidInput) {
  const TempFolder folder;
  return refusal(folder.write("v.tif", tiff_bytes(pages, options)), code);
}

VolumeReadOptions raw(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  VolumeReadOptions options;
  options.raw_resolution = Index3{x, y, z};
  return options;
}

/// Writes a file anew; some file systems flush one that is written over, which takes milliseconds.
std::string rewrite(const TempFolder& folder, const std::string& name, const std::string& bytes) {
  std::filesystem::remove(folder.file(name));
  return folder.write(name, bytes);
}

/// What is promised of any bytes: a volume of the size that it says, or an error with a text.
bool sound(const Result<LabelVolume>& volume) {
  return volume.ok() ? volume->labels.size() == volume->voxel_count() && volume->voxel_count() > 0
                     : !volume.error().message.empty();
}

}  // namespace

TEST_CASE("a TIFF cut off anywhere is refused") {
  const TempFolder folder;
  for (const TiffOptions& options :
       {TiffOptions{}, TiffOptions{.big_endian = true, .big_tiff = true, .compression = 8},
        TiffOptions{.bits = 16, .tile = 16}}) {
    const std::string bytes = tiff_bytes(small_pages(), options);
    REQUIRE(read_label_volume(folder.write("v.tif", bytes)).ok());
    for (std::size_t n = 0; n < bytes.size(); ++n) {
      INFO("cut to " << n << " of " << bytes.size());
      const Result<LabelVolume> volume = read_label_volume(rewrite(folder, "v.tif", bytes.substr(0, n)));
      REQUIRE(!volume.ok());
      CHECK(volume.error().code == ErrorCode::kInvalidInput);
    }
  }
}

TEST_CASE("a slice cut off anywhere is refused, or nothing of its pixels is missing") {
  const TempFolder folder;
  for (int z = 0; z < 4; ++z) folder.write(std::to_string(z) + ".png", png_bytes(small_pages()[1]));
  const Result<LabelVolume> whole = read_label_volume(folder.path());
  REQUIRE(whole.ok());
  const std::string bytes = png_bytes(small_pages()[1]);
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    INFO("cut to " << n << " of " << bytes.size());
    rewrite(folder, "2.png", bytes.substr(0, n));
    const Result<LabelVolume> volume = read_label_volume(folder.path());
    if (volume.ok())
      CHECK(volume->labels == whole->labels);
    else
      CHECK(says(volume.error().message, "'2.png'"));
    // What is missing then is the end mark, the checksums or less.
    if (n + 24 < bytes.size()) CHECK(!volume.ok());
  }
}

TEST_CASE("a TIFF with any byte changed never crashes, hangs or gives an unsound volume") {
  const TempFolder folder;
  Rng rng(11);
  std::size_t read = 0, refused = 0;
  for (const TiffOptions& options :
       {TiffOptions{},
        TiffOptions{.big_endian = true, .big_tiff = true, .compression = 8, .rows_per_strip = 2},
        TiffOptions{.bits = 16, .compression = 32773}, TiffOptions{.tile = 16},
        TiffOptions{.separate = true}}) {
    const std::string bytes = tiff_bytes(small_pages(), options);
    for (std::size_t at = 0; at < bytes.size(); ++at)
      for (int round = 0; round < 3; ++round) {
        // Much of a tile is padding.
        if (options.tile && bytes[at] == 0 && round > 0) continue;
        std::string damaged = bytes;
        damaged[at] =
            char(std::uint8_t(damaged[at]) ^ (round == 0 ? 1u << rng.below(8) : 1 + rng.below(255)));
        const Result<LabelVolume> volume = read_label_volume(rewrite(folder, "v.tif", damaged));
        INFO("byte " << at);
        CHECK(sound(volume));
        (volume.ok() ? read : refused) += 1;
      }
  }
  CHECK(read > 100);
  CHECK(refused > 1000);
}

TEST_CASE("PNG and Radiance slices with any byte changed never crash or hang") {
  const TempFolder folder;
  Rng rng(12);
  PlainPicture rgbe{5, 4, 4, {}};
  for (std::uint32_t k = 0; k < 80; ++k) rgbe.samples.push_back(k % 4 == 3 ? 128 : 3 * k);
  const std::string files[] = {png_bytes(small_pages()[1], {.bits = 16, .gamma = 45455}), hdr_bytes(rgbe)};
  std::size_t read = 0, refused = 0;
  for (const std::string& bytes : files)
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      std::string damaged = bytes;
      damaged[at] = char(std::uint8_t(damaged[at]) ^ (1 + rng.below(255)));
      const Result<ColorMap> map = read_color_volume(rewrite(folder, "a.png", damaged));
      INFO("byte " << at);
      if (map.ok())
        CHECK(map->voxels.size() ==
              std::size_t{map->resolution[0]} * map->resolution[1] * map->resolution[2]);
      else
        CHECK(!map.error().message.empty());
      (map.ok() ? read : refused) += 1;
    }
  CHECK(read > 20);
  CHECK(refused > 50);
}

TEST_CASE("an EXR is refused by its header before the library takes memory for it") {
  const TempFolder folder;
  const std::vector<std::string> names = {"Y"};
  const std::vector<float> pixels(20, 3.0f);
  const std::string path = folder.file("a.exr");
  REQUIRE(write_image_file(path, {5, 4, names, pixels}).ok());
  const std::string bytes = read_bytes(path);
  REQUIRE(read_color_volume(path).ok());
  const std::size_t window = bytes.find("dataWindow") + std::string("dataWindow\0box2i\0size", 21).size();
  const std::size_t attribute =
      bytes.find("screenWindowWidth") + std::string("screenWindowWidth\0float\0", 24).size();
  const auto codes = [&](std::size_t at, const std::string& four) {
    std::string damaged = bytes;
    damaged.replace(at, 4, four);
    rewrite(folder, "a.exr", damaged);
    const Result<ColorMap> map = read_color_volume(path);
    const Result<Image> image = read_image_file(path);
    REQUIRE(!map.ok());
    REQUIRE(!image.ok());
    CHECK(map.error().code == image.error().code);
    return map.error().code;
  };
  // The right and lower end of the window, then one beyond its other end, then a coordinate far away.
  CHECK(codes(window + 8, std::string("\xff\xff\xff\x3f", 4)) == ErrorCode::kLimit);
  CHECK(codes(window + 12, std::string("\xff\xff\xff\x3f", 4)) == ErrorCode::kLimit);
  CHECK(codes(window + 12, std::string("\xff\xff\xff\xff", 4)) == ErrorCode::kInvalidInput);
  CHECK(codes(window, std::string("\xff\xff\xff\x7f", 4)) == ErrorCode::kInvalidInput);
  // An attribute of 2 GB.
  CHECK(codes(attribute, std::string("\0\0\0\x7f", 4)) == ErrorCode::kInvalidInput);
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    const Result<ColorMap> map = read_color_volume(rewrite(folder, "a.exr", bytes.substr(0, n)));
    INFO("cut to " << n << " of " << bytes.size());
    REQUIRE(!map.ok());
    CHECK(map.error().code == ErrorCode::kInvalidInput);
  }
  Rng rng(13);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = char(std::uint8_t(damaged[at]) ^ (1 + rng.below(255)));
    const Result<ColorMap> map = read_color_volume(rewrite(folder, "a.exr", damaged));
    INFO("byte " << at);
    CHECK((map.ok() ? map->voxels.size() == 20 || map->resolution != Index3{5, 4, 1}
                    : !map.error().message.empty()));
  }
}

TEST_CASE("damaged strips are noticed") {
  std::vector<PlainPicture> pages = gray_pages(64, 64, 4);
  const TempFolder folder;
  std::string bytes = tiff_bytes(pages, {.compression = 8});
  REQUIRE(read_label_volume(folder.write("v.tif", bytes)).ok());
  // The length of the first stored block, after the header of the file and of the stream.
  bytes[8 + 2 + 1] = char(std::uint8_t(bytes[8 + 2 + 1]) ^ 1u);
  CHECK(says(refusal(folder.write("v.tif", bytes)), "page 1"));
}

TEST_CASE("kinds of TIFF that the library would misread are refused by name") {
  const auto pages = gray_pages(4, 4, 4);
  const auto tagged = [&](unsigned tag, std::vector<std::uint32_t> values) {
    return tiff_refusal(pages, {.tags = {{tag, std::move(values)}}});
  };
  CHECK(says(tagged(262, {0}), "white as zero"));
  CHECK(says(tagged(262, {5}), "kind 5"));
  CHECK(says(tagged(259, {7}), "method 7"));
  CHECK(says(tagged(274, {3}), "turned"));
  CHECK(says(tagged(32997, {2}), "several slices"));
  CHECK(says(tagged(258, {24}), "24 bits"));
  CHECK(says(tagged(258, {12}), "12 bits"));
  CHECK(says(tagged(258, {64}), "64 bits"));
  CHECK(says(tagged(277, {5}), "5 channels"));
  CHECK(says(tagged(284, {3}), "planes"));
  CHECK(says(tagged(256, {}), "no tag 256"));
  CHECK(says(tagged(262, {}), "no tag 262"));
  CHECK(says(tagged(257, {0}), "no pixels"));
  CHECK(says(tagged(278, {0}), "strips or tiles"));
  CHECK(says(tagged(278, {1}), "4 strips"));
  CHECK(says(tagged(273, {4000000000}), "beyond the end"));
  CHECK(says(tagged(279, {15}), "shorter"));
  CHECK(says(tagged(279, {4000000000}), "beyond the end"));
  CHECK(says(tagged(322, {16}), "both strips and tiles"));
  CHECK(says(tiff_refusal(pages, {.bits = 16, .photometric = 3}), "palette"));
  CHECK(says(tiff_refusal(pages, {.tile = 16, .tags = {{322, {8}}}}), "size that cannot be"));
  const PlainPicture colors{4, 4, 3, std::vector<std::uint32_t>(48, 1)};
  CHECK(says(tiff_refusal({4, colors}, {.tags = {{258, {8, 16, 8}}}}), "different kinds"));
  CHECK(says(tiff_refusal({4, colors}, {.bits = 16}), "8 bits"));
}

TEST_CASE("a TIFF's pages must be alike") {
  std::vector<PlainPicture> pages = gray_pages(5, 4, 4);
  pages[2] = gray(5, 6);
  CHECK(says(tiff_refusal(pages, {}), "page 3: it has 5 x 6 pixels"));
  pages[2] = {5, 4, 2, std::vector<std::uint32_t>(40)};
  CHECK(says(tiff_refusal(pages, {}), "page 3: its pixels are of another kind"));
  // A chain of pages that leads back to the first.
  const TempFolder folder;
  std::string bytes = tiff_bytes(gray_pages(4, 4, 1), {});
  const std::string first = bytes.substr(4, 4);
  bytes.replace(bytes.size() - 4, 4, first);
  CHECK(says(refusal(folder.write("v.tif", bytes)), "page 2: it is the same"));
}

TEST_CASE("a stack that is none is refused, and its slice is named") {
  const TempFolder folder;
  const auto write = [&](const std::string& name, const std::string& bytes) {
    return folder.write(name, bytes);
  };
  CHECK(says(refusal(folder.path()), "no pictures"));
  for (int z = 0; z < 3; ++z) write(std::to_string(z) + ".png", png_bytes(gray(4, 4)));
  CHECK(says(refusal(folder.path()), "4 x 4 x 3"));
  write("3.png", png_bytes(gray(4, 4)));
  REQUIRE(read_label_volume(folder.path()).ok());
  const auto with = [&](const std::string& name, const std::string& bytes) {
    const std::string path = write(name, bytes);
    const std::string message = refusal(folder.path());
    REQUIRE(std::filesystem::remove(path));
    CHECK(says(message, "'" + name + "'"));
    return message;
  };
  CHECK(says(with("notes.txt", "z = 1 mm"), "no slice"));
  CHECK(says(with("a.gif", "GIF89a"), "no slice"));
  CHECK(says(with("4.tif", tiff_bytes({gray(4, 4)})), "several kinds"));
  CHECK(says(with("4.png", png_bytes(gray(4, 5))), "4 x 5 pixels"));
  CHECK(says(with("4.png", png_bytes(gray(4, 4), {.bits = 16})),
             "gray of 16 bits, the first slice gray of 8 bits"));
  CHECK(says(with("4.png", png_bytes({4, 4, 3, std::vector<std::uint32_t>(48)})), "colors of 8 bits"));
  CHECK(says(with("4.png", ""), "empty"));
  CHECK(says(with("4.png", "\xff\xd8\xff and more"), "JPEG"));
  CHECK(says(with("4.png", "Dear Sir or Madam,"), "no picture"));
  CHECK(says(with("4.png", tiff_bytes(gray_pages(4, 4, 2))), "2 pages"));
  CHECK(says(with("4.png", png_bytes(gray(4, 4), {.color_type = 5})), "cannot be read"));
  // A folder and a pipe, which would be waited for.
  REQUIRE(mkdir(folder.file("4.png").c_str(), 0700) == 0);
  CHECK(says(refusal(folder.path(), ErrorCode::kUnreadable), "not a file"));
  REQUIRE(std::filesystem::remove(folder.file("4.png")));
  REQUIRE(mkfifo(folder.file("4.png").c_str(), 0600) == 0);
  CHECK(says(refusal(folder.path(), ErrorCode::kUnreadable), "not a file"));
}

TEST_CASE("what holds no labels is refused") {
  const TempFolder folder;
  CHECK(says(refusal(folder.write("a.png", png_bytes(gray(8, 8)))), "one slice: give a folder"));
  CHECK(says(refusal(folder.write("a.tif", tiff_bytes({gray(8, 8)}))), "one slice: give a folder"));
  CHECK(says(refusal(folder.write("a.tif", tiff_bytes(gray_pages(3, 8, 8)))), "3 x 8 x 8"));
}

TEST_CASE("negative and lossy values are no labels") {
  CHECK(says(tiff_refusal(std::vector<PlainPicture>(4, gray(4, 4, 200)), {.format = 2}), "negative"));
  const TempFolder folder;
  const PlainPicture rgbe{4, 4, 4, std::vector<std::uint32_t>(64, 128)};
  for (int z = 0; z < 4; ++z) folder.write(std::to_string(z) + ".hdr", hdr_bytes(rgbe));
  CHECK(says(refusal(folder.path()), "exactly"));
}

TEST_CASE("missing files, and raw files without a fitting size") {
  const TempFolder folder;
  (void)refusal(folder.file("missing"), ErrorCode::kUnreadable);
  (void)refusal(folder.file("missing.raw"), ErrorCode::kUnreadable, raw(4, 4, 4));
  const std::string path = folder.write("v.raw", std::string(64, '\1'));
  CHECK(says(refusal(path, ErrorCode::kUsage), "resolution"));
  CHECK(says(refusal(path, ErrorCode::kInvalidInput, raw(4, 4, 5)), "80 or 160 or 320"));
  CHECK(says(refusal(path, ErrorCode::kInvalidInput, raw(4, 4, 5), true), "80 or 240"));
  CHECK(says(refusal(path, ErrorCode::kInvalidInput, raw(2, 4, 8)), "at least 4"));
  CHECK(says(refusal(path, ErrorCode::kInvalidInput, raw(0, 4, 8), true), "at least 1"));
  CHECK(says(refusal(path, ErrorCode::kLimit, raw(4294967295, 4294967295, 4294967295)), "1024"));
  REQUIRE(mkfifo(folder.file("pipe.raw").c_str(), 0600) == 0);
  (void)refusal(folder.file("pipe.raw"), ErrorCode::kUnreadable, raw(4, 4, 4));
}

TEST_CASE("limits are checked before memory is taken") {
  const TempFolder folder;
  const std::string tiff = folder.write("v.tif", tiff_bytes(gray_pages(4, 4, 6)));
  VolumeReadOptions options;
  options.max_file_bytes = 100;
  CHECK(says(refusal(tiff, ErrorCode::kLimit, options), "100 bytes"));
  options = {};
  options.max_voxels = 95;
  CHECK(says(refusal(tiff, ErrorCode::kLimit, options), "95 voxels"));
  options = {};
  options.max_slices = 5;
  CHECK(says(refusal(tiff, ErrorCode::kLimit, options), "5 pages"));
  const TempFolder stack;
  for (int z = 0; z < 6; ++z) stack.write(std::to_string(z) + ".png", png_bytes(gray(4, 4)));
  CHECK(says(refusal(stack.path(), ErrorCode::kLimit, options), "5 pictures"));
  // Sizes that stand in headers alone.
  CHECK(says(tiff_refusal(gray_pages(4, 4, 4), {.tags = {{256, {4000000000}}}}, ErrorCode::kLimit),
             "4000000000"));
  std::string png = png_bytes(gray(1025, 1));
  CHECK(says(refusal(folder.write("a.png", png), ErrorCode::kLimit, {}, true), "1025 x 1 x 1"));
  const std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n";
  CHECK(refusal(folder.write("a.hdr", hdr), ErrorCode::kLimit, {}, true) != "");
}

TEST_CASE("reading reports and can be cancelled between slices") {
  const TempFolder folder;
  const std::string tiff = folder.write("v.tif", tiff_bytes(gray_pages(4, 4, 8)));
  std::atomic<bool> cancel = false;
  std::vector<double> fractions;
  Progress progress;
  progress.cancel = &cancel;
  progress.report = [&](std::string_view, double fraction) {
    fractions.push_back(fraction);
    if (fractions.size() == 3) cancel = true;
  };
  CHECK(read_label_volume(tiff, {}, &progress).error().code == ErrorCode::kCancelled);
  CHECK(fractions == std::vector<double>{0, 0.125, 0.25});
  CHECK(read_color_volume(tiff, {}, &progress).error().code == ErrorCode::kCancelled);
  const std::string path = folder.write("v.raw", std::string(64, '\1'));
  CHECK(read_label_volume(path, raw(4, 4, 4), &progress).error().code == ErrorCode::kCancelled);
}
