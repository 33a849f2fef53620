#include "format/loader/mesocell_loader.h"

#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/fuzz/fuzz.h"

// Input: a file, read with hashes that fit.

using namespace mesocell;

namespace {

constexpr MesocellOptions options(bool in_place) {
  return {fuzz::kLimits.max_file_bytes, fuzz::kLimits.max_decoded_bytes, fuzz::kLimits.max_tiles,
          in_place ? 1 : 0};
}

volatile std::uint64_t sum_of_all = 0;  // keeps the reads from being left out

/// Reads all that an engine would, for the address sanitizer.
void walk(const MesocellObject& object) {
  std::uint64_t sum = 0;
  const std::uint64_t voxels =
      std::uint64_t{object.resolution[0]} * object.resolution[1] * object.resolution[2];
  for (std::uint64_t i = 0; i < voxels; ++i) {
    const std::uint32_t id = mesocell_voxel_id(&object, i);
    MESOCELL_FUZZ_CHECK(id <= object.piece_count);
    sum += id;
  }
  for (std::uint32_t id = 1; id <= object.piece_count; ++id) {
    int home[3];
    const std::uint32_t cell = mesocell_piece(&object, id, home);
    MESOCELL_FUZZ_CHECK(cell >= 1 && cell <= object.cell_count);
  }
  std::uint64_t tags[4] = {};
  const std::uint64_t tiles = std::uint64_t{object.tiles[0]} * object.tiles[1] * object.tiles[2];
  if (tiles * object.cell_count < 100000) {
    for (std::uint64_t tile = 0; tile < tiles; ++tile)
      for (std::uint32_t cell = 1; cell <= object.cell_count; ++cell)
        ++tags[mesocell_tag(&object, tile, cell)];
    MESOCELL_FUZZ_CHECK(tags[0] == object.outside && tags[1] == object.inside &&
                        tags[2] == object.intersected);
  }
  const auto add = [&](const std::uint8_t* bytes, std::uint64_t count) {
    for (std::uint64_t i = 0; bytes && i < count; ++i) sum += bytes[i];
  };
  add(object.color, std::uint64_t{3} * object.color_resolution[0] * object.color_resolution[1] *
                        object.color_resolution[2]);
  add(object.cell_colors, std::uint64_t{3} * object.cell_count);
  add(object.instance_colors, 3 * object.inside);
  add(object.normals, 2 * object.normal_count);
  add(object.mesh, object.mesh_bytes);
  if (object.surface_colors) {
    add(object.surface_colors, std::uint64_t{3} * object.surface_color_count);
    for (std::uint64_t i = 0; i < 20000; ++i) {
      const std::uint64_t tile = i % tiles, v = i / tiles * 7 % voxels;
      const std::uint32_t voxel[3] = {
          std::uint32_t(v % object.resolution[0]),
          std::uint32_t(v / object.resolution[0] % object.resolution[1]),
          std::uint32_t(v / object.resolution[0] / object.resolution[1]),
      };
      const std::uint8_t* const color = mesocell_surface_color(&object, tile, voxel);
      if (!color) continue;
      MESOCELL_FUZZ_CHECK(color >= object.surface_colors &&
                          color < object.surface_colors + std::uint64_t{3} * object.surface_color_count);
      sum += color[0];
    }
  }
  std::uint64_t cursor = 0;
  const char *key = nullptr, *value = nullptr;
  std::uint32_t key_bytes = 0, value_bytes = 0, texts = 0;
  for (; mesocell_next_text(&object, &cursor, &key, &key_bytes, &value, &value_bytes) != 0; ++texts) {
    for (std::uint32_t i = 0; i < key_bytes; ++i) sum += static_cast<unsigned char>(key[i]);
    for (std::uint32_t i = 0; i < value_bytes; ++i) sum += static_cast<unsigned char>(value[i]);
  }
  MESOCELL_FUZZ_CHECK(texts == object.text_count);
  sum_of_all = sum;
}

void check_asset(std::span<const std::byte> file, std::uint32_t asset, bool in_place) {
  const MesocellOptions o = options(in_place);
  std::size_t need = 0;
  MesocellFault fault = {};
  MesocellObject object = {};
  if (mesocell_arena_bytes(file.data(), file.size(), asset, &o, &need, &fault) != kMesocellOk) {
    MESOCELL_FUZZ_CHECK(fault.text != nullptr && fault.offset <= file.size());
    // Whatever it is, loading does not go further, with any arena.
    const auto arena = std::make_unique<std::byte[]>(1000);
    MESOCELL_FUZZ_CHECK(mesocell_load(file.data(), file.size(), asset, &o, arena.get(), 1000, &object,
                                      nullptr) != kMesocellOk);
    return;
  }
  const auto arena = std::make_unique<std::byte[]>(need);
  const MesocellStatus status =
      mesocell_load(file.data(), file.size(), asset, &o, arena.get(), need, &object, &fault);
  MESOCELL_FUZZ_CHECK(status != kMesocellArenaTooSmall);
  MESOCELL_FUZZ_CHECK((status == kMesocellOk) == (fault.text == nullptr));
  if (status == kMesocellOk) walk(object);
  if (need == 0) return;
  const auto small = std::make_unique<std::byte[]>(need - 1);
  MESOCELL_FUZZ_CHECK(mesocell_load(file.data(), file.size(), asset, &o, small.get(), need - 1, &object,
                                    nullptr) != kMesocellOk);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = fuzz::Input(data, size).rest();
  fuzz::Bytes resealed(bytes.begin(), bytes.end());
  test::reseal_chunks(resealed);
  const fuzz::Exact file(resealed);
  const MesocellOptions o = options(false);
  MesocellFile info = {};
  MesocellFault fault = {};
  if (mesocell_open(file.bytes().data(), size, &o, &info, &fault) != kMesocellOk) {
    MESOCELL_FUZZ_CHECK(fault.text != nullptr);
    info.asset_count = 1;
  }
  for (std::uint32_t asset = 0; asset < std::min(info.asset_count, 4u); ++asset)
    for (const bool in_place : {false, true}) check_asset(file.bytes(), asset, in_place);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() { return file_seeds(); }
