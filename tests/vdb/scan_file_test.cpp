#include "converters/vdb/scan_file.h"

#include <bit>
#include <fstream>

#include "converters/vdb/volume_lookup.h"
#include "sdk/core/rng.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"
#include "tests/support/folder.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

void save(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string meta(const std::string& type, const std::string& more, const std::string& data) {
  return "ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\nElementSpacing = 0.5 1 2\nOffset = 1 2 3\n" + more +
         "ElementType = " + type + "\nElementDataFile = " + data + "\n";
}

std::string inr(const std::string& type, const std::string& bits, const std::string& cpu) {
  std::string head = "#INRIMAGE-4#{\nXDIM=3\nYDIM=2\nZDIM=2\nVDIM=1\nTYPE=" + type + "\nPIXSIZE=" + bits +
                     " bits\nCPU=" + cpu + "\nVX=0.5\nVY=1\nVZ=2\nTX=1\nTY=2\nTZ=3\n";
  head.resize(252, '\n');
  return head + "##}\n";
}

/// 12 numbers 0, 3, 6, … of so many bytes each.
std::string numbers(std::size_t bytes, bool big_endian, bool floats = false) {
  std::string text;
  for (std::uint32_t i = 0; i < 12; ++i) {
    const std::uint32_t bits = floats ? std::bit_cast<std::uint32_t>(float(3 * i)) : 3 * i;
    for (std::size_t b = 0; b < bytes; ++b)
      text += char(bits >> (8 * (big_endian ? bytes - 1 - b : b)) & 0xff);
  }
  return text;
}

void check_good(const std::string& path) {
  const auto volume = read_scan(path);
  INFO(path);
  if (!volume) FAIL(volume.error().message);
  const VolumeLookup lookup(*volume);
  CHECK(lookup.value({0, 0, 0}) == 0);
  CHECK(lookup.value({2, 0, 0}) == 6);
  CHECK(lookup.value({0, 1, 0}) == 9);
  CHECK(lookup.value({2, 1, 1}) == 33);
  CHECK(lookup.value({3, 1, 1}) == 0);
  CHECK(volume->index_to_world.point({1, 1, 1}) == Vec3{1.5, 3, 5});
}

}  // namespace

TEST_CASE("scan: numbers of all kinds are read from both formats") {
  const Folder folder(in_memory());
  const std::string path = folder / "a.mha";
  save(path, meta("MET_UCHAR", "", "LOCAL") + numbers(1, false));
  check_good(path);
  save(path, meta("MET_USHORT", "ElementByteOrderMSB = True\n", "LOCAL") + numbers(2, true));
  check_good(path);
  save(path, meta("MET_SHORT", "BinaryDataByteOrderMSB = False\n", "LOCAL") + numbers(2, false));
  check_good(path);
  save(path, meta("MET_FLOAT", "TransformMatrix = 1 0 0 0 1 0 0 0 1\n", "LOCAL") + numbers(4, false, true));
  check_good(path);
  save(folder / "beside.raw", numbers(1, false));
  save(folder / "b.mhd", meta("MET_UCHAR", "CompressedData = False\n", "beside.raw"));
  check_good(folder / "b.mhd");
  save(folder / "c.inr", inr("float", "32", "sun") + numbers(4, true, true));
  check_good(folder / "c.inr");
  save(folder / "c.inr", inr("unsigned fixed", "16", "decm") + numbers(2, false));
  check_good(folder / "c.inr");
  save(folder / "c.inr", inr("signed fixed", "8", "decm") + numbers(1, false));
  check_good(folder / "c.inr");
}

TEST_CASE("scan: what is not read is refused for a reason") {
  const Folder folder(in_memory());
  const std::string path = folder / "a.mha";
  const auto refused = [&](const std::string& bytes, ErrorCode code = ErrorCode::kInvalidInput) {
    save(path, bytes);
    const auto volume = read_scan(path);
    REQUIRE_FALSE(volume);
    INFO(volume.error().message);
    CHECK(volume.error().code == code);
    CHECK(volume.error().message.size() > 20);
  };
  const std::string data = numbers(1, false);
  refused("");
  refused("PNG");
  refused(meta("MET_UCHAR", "", "LOCAL") + data + "x");
  refused(meta("MET_UCHAR", "", "LOCAL") + data.substr(1));
  refused(meta("MET_DOUBLE", "", "LOCAL") + data);
  refused(meta("MET_UCHAR", "CompressedData = True\n", "LOCAL") + data);
  refused(meta("MET_UCHAR", "BinaryData = False\n", "LOCAL") + data);
  refused(meta("MET_UCHAR", "NDims = 2\n", "LOCAL") + data);
  refused(meta("MET_UCHAR", "TransformMatrix = 0 1 0 1 0 0 0 0 1\n", "LOCAL") + data);
  refused(meta("MET_UCHAR", "DimSize = 3 2\n", "LOCAL") + data);
  refused(meta("MET_UCHAR", "DimSize = 3 2 -2\n", "LOCAL") + data);
  refused(meta("MET_UCHAR", "DimSize = 3 2 2 2\n", "LOCAL") + data);
  refused(meta("MET_UCHAR", "DimSize = 1000000 1000000 1000000\n", "LOCAL") + data, ErrorCode::kLimit);
  refused(meta("MET_UCHAR", "DimSize = 65536 65536 1\n", "LOCAL") + data, ErrorCode::kLimit);
  refused(meta("MET_UCHAR", "DimSize = 600 600 600\n", "LOCAL") + data);
  refused(meta("MET_UCHAR", "ElementSpacing = 0 1 1\n", "LOCAL") + data);
  refused(meta("MET_UCHAR", "ElementSpacing = nan 1 1\n", "LOCAL") + data);
  refused(meta("MET_UCHAR", "ElementNumberOfChannels = 3\n", "LOCAL") + data);
  refused(meta("MET_UCHAR", "", "LIST"));
  refused(meta("MET_UCHAR", "", "/etc/passwd"));
  refused(meta("MET_UCHAR", "", ".."));
  refused(meta("MET_UCHAR", "", "missing.raw"), ErrorCode::kUnreadable);
  refused("NDims = 3\nnothing\n");
  refused("NDims = 3\n");
  const std::string good = inr("float", "32", "decm");
  refused(good.substr(0, 200));
  refused(good);
  refused(inr("float", "64", "decm") + numbers(4, false, true));
  refused(inr("float", "32", "vax") + numbers(4, false, true));
  CHECK(read_scan(folder.path().string()).error().code == ErrorCode::kUnreadable);
}

TEST_CASE("scan: damaged heads are refused or sound") {
  Rng rng(1);
  std::uint64_t parsed = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string head = round % 2 ? meta("MET_UCHAR", "TransformMatrix = 1 0 0 0 1 0 0 0 1\n", "LOCAL")
                                 : inr("float", "32", "decm");
    for (std::uint32_t k = 0; k <= rng.below(3); ++k)
      head[rng.below(std::uint32_t(round % 2 ? head.size() : 150))] = char(rng.below(256));
    if (rng.below(4) == 0) head.resize(rng.below(std::uint32_t(head.size() + 1)));
    const auto parsed_head = parse_scan_head(std::as_bytes(std::span(head)));
    if (!parsed_head) continue;
    ++parsed;
    CHECK(parsed_head->voxel_count() > 0);
    CHECK(parsed_head->voxel_count() <= std::uint64_t{1} << 28);
    CHECK(is_sound(parsed_head->index_to_world));
  }
  CHECK(parsed > 100);
}

TEST_CASE("scan: those of the test data are read") {
  const auto head = find_data("volumes/HeadMRVolume.mhd");
  if (!head) return;
  const auto volume = read_scan(*head);
  REQUIRE(volume);
  CHECK(volume->leaves.size() > 100);
  CHECK(volume->index_to_world.rows[0].x == 4);
  const auto skull = read_scan(*find_data("volumes/skull_2.9.inr"));
  REQUIRE(skull);
  CHECK(skull->index_to_world.rows[2].z == 3.650790);
}
