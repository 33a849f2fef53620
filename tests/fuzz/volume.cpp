#include <array>
#include <string_view>
#include <utility>

#include "converters/vdb/object_metadata.h"
#include "converters/vdb/scan_file.h"
#include "converters/vdb/sparse_volume.h"
#include "converters/vdb/assemble_object.h"
#include "converters/vdb/volume_shape.h"
#include "format/cell_object_io.h"
#include "tests/fuzz/fuzz.h"

// Input: a byte, 0: a volume as a worker sends it; 1: the head of a scan; 2: three volumes of an asset.

using namespace mesocell;

namespace {

constexpr std::int32_t kSmall = 64;

void check_volume(const SparseVolume& volume) {
  MESOCELL_FUZZ_CHECK(volume.floats.size() == (volume.has_floats() ? volume.number_count() : 0));
  MESOCELL_FUZZ_CHECK(volume.ints.size() == (volume.has_ints() ? volume.number_count() : 0));
  MESOCELL_FUZZ_CHECK(is_sound(volume.index_to_world));
  VoxelCoord low, high;
  bool small = active_range(volume, low, high);
  for (std::size_t a = 0; a < 3; ++a) small = small && std::int64_t{high[a]} - low[a] < kSmall;
  if (small) {
    const Result<LabelVolume> labels = labels_of(volume);
    MESOCELL_FUZZ_CHECK(!labels || labels->labels.size() == labels->voxel_count());
  }
  const auto shape = VolumeShape::make(volume, std::nullopt);
  if (!shape) return;
  const Box3 box = (*shape)->box();
  MESOCELL_FUZZ_CHECK(!box.empty());
  for (int k = 0; k < 64; ++k) {
    Box3 part;
    for (const int corner : {0, 1}) {
      Vec3 p;
      for (std::size_t a = 0; a < 3; ++a)
        p[a] = box.min[a] + (box.max[a] - box.min[a]) * ((k >> (2 * a) & 3) + corner) / 4;
      part.add(p);
    }
    const BoxSide side = (*shape)->side(part);
    if (side == BoxSide::kMixed) continue;
    MESOCELL_FUZZ_CHECK((*shape)->inside(part.min) == (side == BoxSide::kInside));
    MESOCELL_FUZZ_CHECK((*shape)->inside((part.min + part.max) * 0.5) == (side == BoxSide::kInside));
  }
}

void check_asset(ByteReader& in) {
  std::array<SparseVolume, 3> grids;
  for (SparseVolume& grid : grids) {
    Result<SparseVolume> read = read_volume(in);
    if (!read) return;
    grid = std::move(*read);
  }
  const Result<ObjectLayout> layout = parse_object_metadata(grids[0].metadata);
  if (!layout || layout->grid.tile_count() > 4096) return;
  for (const std::uint32_t n : layout->resolution)
    if (n > std::uint32_t(kSmall)) return;
  const Result<CellObject> object = assemble_object(grids[0], grids[1], grids[2], 1);
  if (!object) return;
  const Result<std::vector<std::byte>> bytes = encode_cell_object(*object);
  MESOCELL_FUZZ_CHECK(bytes.ok() && read_cell_object(*bytes).ok());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::uint32_t kind = input.number(1) % 3;
  const fuzz::Exact exact(input.rest());
  ByteReader in(exact.bytes());
  if (kind == 0) {
    const Result<SparseVolume> volume = read_volume(in);
    if (volume) check_volume(*volume);
  } else if (kind == 1) {
    const Result<ScanHead> head = parse_scan_head(exact.bytes());
    if (head)
      MESOCELL_FUZZ_CHECK(head->voxel_count() > 0 && head->voxel_count() <= ScanReadOptions{}.max_voxels &&
                          is_sound(head->index_to_world));
  } else {
    check_asset(in);
  }
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  std::vector<Bytes> seeds;
  SparseVolume volume;
  volume.volume_class = VolumeClass::kLevelSet;
  volume.background[0] = 1;
  volume.tiles.push_back({{8, 0, 0}, 3, false, {-1, 0, 0}});
  volume.leaves.push_back({{0, 0, 0}, {~std::uint64_t{0}}});
  for (int v = 0; v < 512; ++v) volume.floats.push_back(float(v % 8 - 4));
  SparseVolume labels;
  labels.type = VolumeType::kInt;
  labels.leaves.push_back({{0, 0, 0}, {0x0f0f0f0f}});
  labels.ints.assign(512, 1);
  SparseVolume homes = labels;
  homes.type = VolumeType::kInt3;
  homes.ints.assign(512 * 3, 0);
  SparseVolume mask = labels;
  mask.type = VolumeType::kMask;
  mask.ints.clear();
  for (const SparseVolume& v : {volume, labels, homes, mask}) {
    ByteWriter out;
    out.u8(0);
    write_volume(v, out);
    seeds.push_back(out.release());
  }
  for (const char* text :
       {"#INRIMAGE-4#{\nXDIM=3\nYDIM=2\nZDIM=2\nTYPE=float\nPIXSIZE=32 bits\nCPU=decm\n##}\n",
        "ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\nElementSpacing = 1 1 2\n"
        "ElementType = MET_SHORT\nElementDataFile = LOCAL\n"}) {
    ByteWriter out;
    out.u8(1);
    out.append(std::string_view(text));
    seeds.push_back(out.release());
  }
  labels.metadata = {{"mesocell:version", "1"},        {"mesocell:box_min", "0 0 0"},
                     {"mesocell:voxel_edge", "0.5"},   {"mesocell:tiles", "1 1 1"},
                     {"mesocell:resolution", "8 8 8"}, {"mesocell:rule", "centre"},
                     {"mesocell:cells", "1"}};
  ByteWriter out;
  out.u8(2);
  for (const SparseVolume& v : {labels, homes, labels}) write_volume(v, out);
  seeds.push_back(out.release());
  return seeds;
}
