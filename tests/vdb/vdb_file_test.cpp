#include "converters/vdb/vdb_file.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "converters/vdb/volume_shape.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"
#include "tests/support/folder.h"
#include "tests/vdb/volumes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

void save(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::vector<std::byte> bytes_of(SparseVolume volume) {
  std::erase_if(volume.metadata, [](const auto& entry) { return entry.first != "note"; });
  std::sort(volume.leaves.begin(), volume.leaves.end(),
            [](const VolumeLeaf& a, const VolumeLeaf& b) { return a.origin < b.origin; });
  std::sort(volume.tiles.begin(), volume.tiles.end(),
            [](const VolumeTile& a, const VolumeTile& b) { return a.origin < b.origin; });
  // What is as the background is not kept.
  std::erase_if(volume.tiles,
                [&](const VolumeTile& tile) { return !tile.active && tile.value == volume.background; });
  for (VolumeTile& tile : volume.tiles)
    if (volume.channels() == 1) tile.value[1] = tile.value[2] = 0;
  volume.floats.clear();
  volume.ints.clear();
  ByteWriter out;
  write_volume(volume, out);
  return out.release();
}

/// How many voxels of two volumes differ.
std::uint64_t differences(const SparseVolume& a, const SparseVolume& b) {
  const VolumeLookup in_a(a), in_b(b);
  std::uint64_t count = 0;
  VoxelCoord at;
  for (at[2] = -40; at[2] < 40; ++at[2])
    for (at[1] = -40; at[1] < 40; ++at[1])
      for (at[0] = -40; at[0] < 40; ++at[0]) {
        const VolumeValue va = in_a.numbers(at), vb = in_b.numbers(at);
        for (std::size_t c = 0; c < a.channels(); ++c) count += va[c] != vb[c];
      }
  return count;
}

ErrorCode refusal(const std::string& path, const VdbReadOptions& options = {}) {
  const auto volume = read_vdb(path, options);
  REQUIRE_FALSE(volume);
  INFO(volume.error().message);
  CHECK(volume.error().message.size() > 20);
  return volume.error().code;
}

}  // namespace

TEST_CASE("vdb: what is written is read, of all types, and the same bytes each time") {
  const Folder folder(in_memory());
  Rng rng(1);
  std::vector<SparseVolume> volumes;
  int k = 0;
  for (const VolumeType type :
       {VolumeType::kFloat, VolumeType::kFloat3, VolumeType::kInt, VolumeType::kInt3, VolumeType::kMask}) {
    volumes.push_back(random_volume(rng, type, VolumeClass::kUnknown));
    volumes.back().name = "grid " + std::to_string(k++);
    volumes.back().metadata = {{"note", "of " + std::to_string(k)}};
  }
  const std::string path = folder / "all.vdb";
  REQUIRE(write_vdb(path, volumes));
  for (const SparseVolume& volume : volumes) {
    VdbReadOptions options;
    options.grid = volume.name;
    options.purpose = VdbPurpose::kAny;
    VdbReadReport report;
    const auto back = read_vdb(path, options, &report);
    REQUIRE(back);
    CHECK(report.grid == volume.name);
    CHECK(report.others.empty());
    CHECK(differences(volume, *back) == 0);
    CHECK((bytes_of(volume) == bytes_of(*back)));
  }
  const std::string again = folder / "again.vdb";
  REQUIRE(write_vdb(again, volumes));
  CHECK(content(path) == content(again));
  volumes[0].floats[0] += 1;
  REQUIRE(write_vdb(again, volumes));
  CHECK(content(path).substr(21, 36) != content(again).substr(21, 36));
  CHECK(write_vdb(path, volumes, true).error().code == ErrorCode::kOutput);
  CHECK(folder.count() == 2);
}

TEST_CASE("vdb: a grid is chosen by name, by name and index, or is the first that is usable") {
  const Folder folder(in_memory());
  Rng rng(2);
  std::vector<SparseVolume> volumes;
  for (const VolumeType type :
       {VolumeType::kFloat3, VolumeType::kFloat, VolumeType::kFloat, VolumeType::kInt})
    volumes.push_back(random_volume(rng, type, VolumeClass::kFog));
  volumes[0].name = "Cd";
  volumes[1].name = volumes[2].name = "density";
  volumes[3].name = "odd]name[1";
  const std::string path = folder / "several.vdb";
  REQUIRE(write_vdb(path, volumes));
  VdbReadReport report;
  const auto first = read_vdb(path, {}, &report);
  REQUIRE(first);
  CHECK(report.grid == "density[0]");
  CHECK(report.others == std::vector<std::string>{"Cd", "density[1]", "odd]name[1"});
  CHECK(differences(*first, volumes[1]) == 0);
  VdbReadOptions options;
  options.grid = "density[1]";
  const auto second = read_vdb(path, options, &report);
  REQUIRE(second);
  CHECK(differences(*second, volumes[2]) == 0);
  options.grid = "density";
  const auto named = read_vdb(path, options, &report);
  REQUIRE(named);
  CHECK(differences(*named, volumes[1]) == 0);
  options.grid = "odd]name[1";
  CHECK(read_vdb(path, options));
  for (const char* bad : {"density[2]", "density[]", "density[x]", "density[-1]", "none", "[0]"}) {
    options.grid = bad;
    CHECK(refusal(path, options) == ErrorCode::kUsage);
  }
  options.grid = "Cd";
  CHECK(refusal(path, options) == ErrorCode::kInvalidInput);
  options.purpose = VdbPurpose::kColors;
  CHECK(read_vdb(path, options));
  const auto list = list_vdb(path);
  REQUIRE(list);
  REQUIRE(list->size() == 4);
  CHECK((*list)[3].head.type == "int32_5_4_3");
  CHECK((*list)[1].facts.volume_class == VolumeClass::kFog);
  CHECK((*list)[1].facts.linear);
  CHECK((*list)[1].facts.active_voxels > 1000);
  VoxelCoord low, high;
  REQUIRE(active_range(volumes[1], low, high));
  CHECK((*list)[1].facts.low == low);
  CHECK((*list)[1].facts.high == high);
}

TEST_CASE("vdb: limits are kept before values are loaded") {
  const Folder folder(in_memory());
  const std::string path = folder / "ball.vdb";
  const std::vector<SparseVolume> ball{ball_volume(1, 0.05)};
  REQUIRE(write_vdb(path, ball));
  VdbReadOptions options;
  options.max_voxels = ball[0].leaves.size() * 512;
  CHECK(read_vdb(path, options));
  options.max_voxels -= 1;
  CHECK(refusal(path, options) == ErrorCode::kLimit);
  options = {};
  options.max_bytes = 100000;
  CHECK(refusal(path, options) == ErrorCode::kLimit);
  options = {};
  options.max_file_bytes = 1000;
  CHECK(refusal(path, options) == ErrorCode::kLimit);
  options = {};
  std::atomic<bool> cancel = true;
  const Progress progress{nullptr, &cancel};
  CHECK(read_vdb(path, {}, nullptr, &progress).error().code == ErrorCode::kCancelled);
}

TEST_CASE("vdb: files that are none are refused for what they are") {
  const Folder folder(in_memory());
  CHECK(refusal(folder / "missing.vdb") == ErrorCode::kUnreadable);
  CHECK(refusal(folder.path().string()) == ErrorCode::kUnreadable);
  save(folder / "empty.vdb", "");
  CHECK(refusal(folder / "empty.vdb") == ErrorCode::kInvalidInput);
  save(folder / "ply.vdb", "ply\nformat ascii 1.0\n");
  CHECK(refusal(folder / "ply.vdb") == ErrorCode::kInvalidInput);
  CHECK(read_vdb(folder / "ply.vdb").error().message.find("a PLY mesh") != std::string::npos);
  CHECK_FALSE(is_vdb_file(folder / "ply.vdb"));
  const std::vector<SparseVolume> ball{ball_volume(1, 0.1)};
  REQUIRE(write_vdb(folder / "ball.vdb", ball));
  CHECK(is_vdb_file(folder / "ball.vdb"));
  std::string bytes = content(folder / "ball.vdb");
  bytes[8] = 99;  // the version
  save(folder / "new.vdb", bytes);
  CHECK(refusal(folder / "new.vdb") == ErrorCode::kInvalidInput);
  CHECK(read_vdb(folder / "new.vdb").error().message.find("version 99") != std::string::npos);
  bytes = content(folder / "ball.vdb");
  bytes[20] = 0;  // no index
  save(folder / "stream.vdb", bytes);
  CHECK(refusal(folder / "stream.vdb") == ErrorCode::kInvalidInput);
}

TEST_CASE("vdb: files cut short and damaged ones harm nobody") {
  const Folder folder(in_memory());
  Rng rng(7);
  std::vector<SparseVolume> volumes{ball_volume(1, 0.1),
                                    random_volume(rng, VolumeType::kFloat, VolumeClass::kFog)};
  volumes[1].name = "other";
  const std::string path = folder / "good.vdb", hurt = folder / "hurt.vdb";
  REQUIRE(write_vdb(path, volumes));
  const std::string good = content(path);
  VdbReadOptions options;
  options.worker.max_seconds = 10;
  options.worker.max_memory_bytes = std::uint64_t{2} << 30;
  std::uint64_t read_well = 0;
  const auto attempt = [&](const std::string& bytes) {
    std::filesystem::remove(hurt);
    save(hurt, bytes);
    options.grid = rng.below(2) ? "ball" : "other";
    const auto volume = read_vdb(hurt, options);
    read_well += volume.ok();
    if (!volume) {
      CHECK(volume.error().message.size() > 10);
      return;
    }
    // Whatever it is, it can be used.
    const auto shape = VolumeShape::make(*volume, std::nullopt);
    if (shape) (void)(*shape)->inside({0, 0, 0});
  };
  for (std::size_t size = 0; size < 600; size += 7) {
    std::filesystem::remove(hurt);
    save(hurt, good.substr(0, size));
    CHECK(refusal(hurt) == ErrorCode::kInvalidInput);
  }
  for (int cut = 0; cut < 25; ++cut) {
    std::filesystem::remove(hurt);
    save(hurt, good.substr(0, rng.below(std::uint32_t(good.size()))));
    CHECK(refusal(hurt) == ErrorCode::kInvalidInput);
  }
  for (int round = 0; round < 80; ++round) {
    std::string bytes = good;
    for (std::uint32_t k = 0; k <= rng.below(8); ++k) {
      // Half of them where the trees begin.
      const std::size_t at = rng.below(round % 2 ? 2000 : std::uint32_t(bytes.size()));
      bytes[at] = char(bytes[at] ^ char(1 << rng.below(8)));
    }
    attempt(bytes);
  }
  CHECK(read_well > 0);
}

TEST_CASE("vdb: the files of the test data are read, points are refused by name") {
  const auto points = find_data("volumes/points.vdb");
  if (!points) return;
  const auto refused = read_vdb(*points);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::kInvalidInput);
  CHECK(refused.error().message.find("PointDataGrid") != std::string::npos);
  const auto smoke = read_vdb(*find_data("volumes/smoke.vdb"));
  REQUIRE(smoke);
  CHECK(smoke->name == "density");
  CHECK(smoke->volume_class == VolumeClass::kFog);
  CHECK(VolumeShape::make(*smoke, std::nullopt));
  const auto sphere = read_vdb(*find_data("volumes/sphere.vdb"));
  REQUIRE(sphere);
  CHECK(sphere->volume_class == VolumeClass::kLevelSet);
  CHECK(VolumeShape::make(*sphere, std::nullopt));
  const auto torus = read_vdb(*find_data("volumes/torus01.vdb"));
  REQUIRE(torus);
  CHECK(VolumeShape::make(*torus, std::nullopt));
}
