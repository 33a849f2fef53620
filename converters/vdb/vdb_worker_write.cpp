#include <openvdb/openvdb.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <type_traits>
#include <vector>

#include "converters/vdb/vdb_wire.h"
#include "converters/vdb/vdb_worker.h"

namespace mesocell {
namespace {

/// Of the head of a file: before it are magic number, three versions and whether it has an index.
constexpr std::streamoff kUuidAt = 8 + 3 * 4 + 1;
constexpr std::size_t kUuidBytes = 36;

template <typename T>
T value_of(const double* numbers) {
  if constexpr (openvdb::VecTraits<T>::IsVec) {
    using Element = typename T::value_type;
    return T(Element(numbers[0]), Element(numbers[1]), Element(numbers[2]));
  } else if constexpr (std::is_same_v<T, bool>) {
    return numbers[0] != 0;
  } else {
    return T(numbers[0]);
  }
}

template <typename Grid>
typename Grid::Ptr make_grid(const SparseVolume& volume) {
  using Tree = typename Grid::TreeType;
  using Value = typename Grid::ValueType;
  auto grid = Grid::create(value_of<Value>(volume.background.data()));
  Tree& tree = grid->tree();
  // The largest first, as a smaller one is in the place of a larger.
  for (const unsigned edge : {12u, 7u, 3u})
    for (const VolumeTile& tile : volume.tiles)
      if (tile.log2_edge == edge)
        tree.addTile(edge == 12  ? 3
                     : edge == 7 ? 2
                                 : 1,
                     openvdb::Coord(tile.origin[0], tile.origin[1], tile.origin[2]),
                     value_of<Value>(tile.value.data()), tile.active);
  const std::size_t channels = volume.channels();
  for (std::size_t i = 0; i < volume.leaves.size(); ++i) {
    const VolumeLeaf& ours = volume.leaves[i];
    auto* leaf = tree.touchLeaf(openvdb::Coord(ours.origin[0], ours.origin[1], ours.origin[2]));
    for (unsigned z = 0; z < 8; ++z)
      for (unsigned y = 0; y < 8; ++y)
        for (unsigned x = 0; x < 8; ++x) {
          const bool on = ours.active[z] >> (x + 8 * y) & 1;
          const std::size_t at = (i * SparseVolume::kLeafVoxels + x + 8 * (y + 8 * z)) * channels;
          std::array<double, 3> numbers{on ? 1.0 : 0.0, 0, 0};
          for (std::size_t c = 0; c < channels; ++c) {
            if (volume.has_floats()) numbers[c] = double(volume.floats[at + c]);
            if (volume.has_ints()) numbers[c] = double(volume.ints[at + c]);
          }
          const openvdb::Index offset = x << 6 | y << 3 | z;
          const Value value = value_of<Value>(numbers.data());
          if (on)
            leaf->setValueOn(offset, value);
          else
            leaf->setValueOff(offset, value);
        }
  }
  return grid;
}

openvdb::GridBase::Ptr to_grid(const SparseVolume& volume) {
  openvdb::GridBase::Ptr grid;
  switch (volume.type) {
    case VolumeType::kFloat:
      grid = make_grid<openvdb::FloatGrid>(volume);
      break;
    case VolumeType::kFloat3:
      grid = make_grid<openvdb::Vec3SGrid>(volume);
      break;
    case VolumeType::kInt:
      grid = make_grid<openvdb::Int32Grid>(volume);
      break;
    case VolumeType::kInt3:
      grid = make_grid<openvdb::Vec3IGrid>(volume);
      break;
    case VolumeType::kMask:
      grid = make_grid<openvdb::BoolGrid>(volume);
      break;
  }
  grid->setName(volume.name);
  if (volume.volume_class == VolumeClass::kLevelSet) grid->setGridClass(openvdb::GRID_LEVEL_SET);
  if (volume.volume_class == VolumeClass::kFog) grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  openvdb::Mat4d m = openvdb::Mat4d::identity();
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) m(b, a) = volume.index_to_world.rows[std::size_t(a)][std::size_t(b)];
    m(3, a) = volume.index_to_world.move[std::size_t(a)];
  }
  grid->setTransform(openvdb::math::Transform::createLinearTransform(m));
  for (const auto& [key, value] : volume.metadata) grid->insertMeta(key, openvdb::StringMetadata(value));
  return grid;
}

/// OpenVDB gives each file a random number of 36 characters. In its place goes one that follows from the
/// rest, so that the same grids give the same bytes and others another number.
bool replace_uuid(const std::string& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  std::vector<char> chunk(1 << 20);
  std::uint64_t at = 0;
  std::array<std::uint64_t, 2> hash{0xcbf29ce484222325, 0x84222325cbf29ce4};  // FNV-1a, from two beginnings
  do {
    file.read(chunk.data(), std::streamsize(chunk.size()));
    for (std::streamsize i = 0; i < file.gcount(); ++i, ++at) {
      const bool is_uuid = at >= std::uint64_t(kUuidAt) && at < std::uint64_t(kUuidAt) + kUuidBytes;
      for (std::uint64_t& h : hash)
        h = (h ^ (is_uuid ? 0 : std::uint8_t(chunk[std::size_t(i)]))) * 0x100000001b3;
    }
  } while (file);
  if (!file.eof()) return false;
  file.clear();
  char text[kUuidBytes + 1];
  // Version 8, of a make of one's own. [RFC 9562]
  std::snprintf(text, sizeof text, "%08x-%04x-8%03x-8%03x-%012llx", unsigned(hash[0] >> 32),
                unsigned(hash[0] >> 16 & 0xffff), unsigned(hash[0] & 0xfff), unsigned(hash[1] >> 48 & 0xfff),
                static_cast<unsigned long long>(hash[1] & 0xffff'ffff'ffff));
  file.seekp(kUuidAt);
  file.write(text, kUuidBytes);
  file.close();
  return bool(file);
}

}  // namespace

Result<std::vector<std::byte>> write_grids(ByteReader& request) {
  const std::string path = read_text(request);
  const std::uint32_t count = request.u32();
  openvdb::GridPtrVec grids;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Result<SparseVolume> volume = read_volume(request);
    if (!volume) return volume.error();
    grids.push_back(to_grid(*volume));
  }
  {
    openvdb::io::File file(path);
    openvdb::MetaMap metadata;
    metadata.insertMeta("creator", openvdb::StringMetadata("mesocell"));
    try {
      file.write(grids, metadata);
    } catch (const openvdb::IoError& error) {
      return Error{ErrorCode::kOutput, std::string("it cannot be written (") + error.what() + ")"};
    }
    file.close();
  }
  if (!replace_uuid(path))
    return Error{ErrorCode::kOutput, "it cannot be written; see whether the disk is full"};
  return std::vector<std::byte>();
}

}  // namespace mesocell
