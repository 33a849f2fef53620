#include <openvdb/openvdb.h>

#include <algorithm>
#include <limits>
#include <string>
#include <type_traits>

#include "converters/vdb/vdb_wire.h"
#include "converters/vdb/vdb_worker.h"

namespace mesocell {
namespace {

constexpr std::size_t kMaxTexts = 256, kMaxTextBytes = 4096;

VolumeClass class_of(const openvdb::GridBase& grid) {
  switch (grid.getGridClass()) {
    case openvdb::GRID_LEVEL_SET:
      return VolumeClass::kLevelSet;
    case openvdb::GRID_FOG_VOLUME:
      return VolumeClass::kFog;
    default:
      return VolumeClass::kUnknown;
  }
}

Transform transform_of(const openvdb::GridBase& grid) {
  // Points are rows there, columns here.
  const openvdb::Mat4d m = grid.transform().baseMap()->getAffineMap()->getMat4();
  Transform transform;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) transform.rows[std::size_t(a)][std::size_t(b)] = m(b, a);
    transform.move[std::size_t(a)] = m(3, a);
  }
  return transform;
}

/// A file whose values are read only when they are asked for.
class OpenFile {
 public:
  explicit OpenFile(const std::string& path) : file_(path) {
    file_.setCopyMaxBytes(0);  // not into a temporary file, which it would map instead
    file_.open(true);
  }
  openvdb::io::File* operator->() { return &file_; }

 private:
  openvdb::io::File file_;
};

template <typename T>
VolumeValue numbers_of(const T& value) {
  if constexpr (openvdb::VecTraits<T>::IsVec)
    return {double(value[0]), double(value[1]), double(value[2])};
  else if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, openvdb::ValueMask>)
    return {value ? 1.0 : 0.0, 0, 0};
  else
    return {double(value), 0, 0};
}

template <typename T>
void append_numbers(const T& value, std::vector<float>& numbers) {
  for (std::size_t c = 0; c < (openvdb::VecTraits<T>::IsVec ? 3 : 1); ++c)
    numbers.push_back(float(numbers_of(value)[c]));
}

Error too_large(const std::string& what) {
  return {ErrorCode::kLimit, "the grid " + what + "; crop it, or export it with larger voxels"};
}

bool in_reach(const openvdb::CoordBBox& box) {
  for (int a = 0; a < 3; ++a)
    if (box.min()[a] < -SparseVolume::kReach || box.max()[a] >= SparseVolume::kReach) return false;
  return true;
}

template <typename Grid>
Result<std::vector<std::byte>> encode(const Grid& grid, VolumeType type, const VdbReadLimits& limits,
                                      SparseVolume volume) {
  using Tree = typename Grid::TreeType;
  using Value = typename Grid::ValueType;
  constexpr bool kIsMask = std::is_same_v<Value, bool> || std::is_same_v<Value, openvdb::ValueMask>;
  const Tree& tree = grid.tree();
  const std::uint64_t leaf_count = tree.leafCount();
  volume.type = type;
  const std::uint64_t leaf_bytes = 128 + (kIsMask ? 0 : 512 * 4 * volume.channels());
  if (leaf_count > limits.max_voxels / SparseVolume::kLeafVoxels)
    return too_large("has " + std::to_string(leaf_count * SparseVolume::kLeafVoxels) + " voxels, over " +
                     std::to_string(limits.max_voxels));
  if (leaf_count > limits.max_bytes / leaf_bytes)
    return too_large("takes " + std::to_string(leaf_count * leaf_bytes >> 20) + " MiB, over " +
                     std::to_string(limits.max_bytes >> 20));

  const Value background = grid.background();
  volume.background = numbers_of(background);
  auto value = tree.cbeginValueAll();
  value.setMaxDepth(Tree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; value; ++value) {
    if (!value.isValueOn() && value.getValue() == background) continue;
    openvdb::CoordBBox box;
    value.getBoundingBox(box);
    if (!in_reach(box)) return too_large("reaches beyond 2^23 voxels from its origin");
    const std::uint32_t edge = std::uint32_t(box.dim()[0]);
    VolumeTile tile;
    for (int a = 0; a < 3; ++a) tile.origin[std::size_t(a)] = box.min()[a];
    tile.log2_edge = edge == 8 ? 3 : edge == 128 ? 7 : 12;
    tile.value = numbers_of(value.getValue());
    tile.active = kIsMask ? tile.value[0] != 0 : value.isValueOn();
    volume.tiles.push_back(tile);
    if (volume.tiles.size() > limits.max_bytes / sizeof(VolumeTile))
      return too_large("has too many tiles for " + std::to_string(limits.max_bytes >> 20) + " MiB");
  }

  volume.leaves.reserve(leaf_count);
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    if (!in_reach(leaf->getNodeBoundingBox())) return too_large("reaches beyond 2^23 voxels from its origin");
    VolumeLeaf& ours = volume.leaves.emplace_back();
    for (int a = 0; a < 3; ++a) ours.origin[std::size_t(a)] = leaf->origin()[a];
    for (unsigned z = 0; z < 8; ++z)
      for (unsigned y = 0; y < 8; ++y)
        for (unsigned x = 0; x < 8; ++x) {
          const openvdb::Index at = x << 6 | y << 3 | z;
          const auto v = leaf->getValue(at);
          const bool on = kIsMask ? bool(numbers_of(v)[0] != 0) : leaf->isValueOn(at);
          if (on) ours.active[z] |= std::uint64_t{1} << (x + 8 * y);
          if constexpr (std::is_integral_v<Value> && !kIsMask) {
            if (v < std::numeric_limits<std::int32_t>::min() || v > std::numeric_limits<std::int32_t>::max())
              return Error{ErrorCode::kInvalidInput,
                           "the grid has numbers beyond 32 bits, which are no labels; renumber them"};
            volume.ints.push_back(std::int32_t(v));
          } else if constexpr (std::is_same_v<Value, openvdb::Vec3i>) {
            for (int a = 0; a < 3; ++a) volume.ints.push_back(v[a]);
          } else if constexpr (!kIsMask) {
            append_numbers(v, volume.floats);
          }
        }
  }
  ByteWriter reply;
  write_volume(volume, reply);
  return reply.release();
}

/// Encodes the grid if it is of this type.
template <typename Grid>
bool try_type(const openvdb::GridBase& grid, VolumeType type, const VdbReadLimits& limits,
              const SparseVolume& head, Result<std::vector<std::byte>>& reply) {
  if (!grid.isType<Grid>()) return false;
  reply = encode(static_cast<const Grid&>(grid), type, limits, head);
  return true;
}

}  // namespace

Result<std::vector<std::byte>> list_grids(ByteReader& request) {
  OpenFile file(read_text(request));
  const std::uint32_t count = request.u32();
  ByteWriter reply;
  for (std::uint32_t i = 0; i < count && !request.overrun(); ++i) {
    VdbGridFacts facts;
    const std::string name = read_text(request);
    try {
      const openvdb::GridBase::Ptr grid = file->readGrid(name);
      facts.volume_class = class_of(*grid);
      facts.active_voxels = grid->activeVoxelCount();
      facts.linear = grid->transform().isLinear();
      if (facts.linear) facts.index_to_world = transform_of(*grid);
      const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
      for (int a = 0; a < 3; ++a) {
        facts.low[std::size_t(a)] = box.min()[a];
        facts.high[std::size_t(a)] = box.max()[a];
      }
    } catch (const openvdb::Exception& exception) {
      facts.trouble = exception.what();
    }
    write_facts(facts, reply);
  }
  return reply.release();
}

Result<std::vector<std::byte>> read_grid(ByteReader& request) {
  OpenFile file(read_text(request));
  VdbReadLimits limits;
  limits.max_voxels = request.u64();
  limits.max_bytes = request.u64();
  const openvdb::GridBase::Ptr grid = file->readGrid(read_text(request));
  if (!grid->transform().isLinear())
    return Error{ErrorCode::kInvalidInput,
                 "the grid's transform is a frustum (" + grid->transform().mapType() +
                     "), whose voxels are of no one shape; resample it to one that is not"};
  SparseVolume head;
  head.name = grid->getName();
  head.volume_class = class_of(*grid);
  head.index_to_world = transform_of(*grid);
  for (auto meta = grid->beginMeta(); meta != grid->endMeta() && head.metadata.size() < kMaxTexts; ++meta)
    if (meta->second && meta->second->typeName() == "string")
      head.metadata.emplace_back(meta->first.substr(0, kMaxTextBytes),
                                 meta->second->str().substr(0, kMaxTextBytes));
  Result<std::vector<std::byte>> reply =
      Error{ErrorCode::kInvalidInput, "grids of type " + grid->valueType() + " cannot be read"};
  const openvdb::GridBase& g = *grid;
  // One line a type, as each takes the compiler long.
  (void)(try_type<openvdb::FloatGrid>(g, VolumeType::kFloat, limits, head, reply) ||
         try_type<openvdb::DoubleGrid>(g, VolumeType::kFloat, limits, head, reply) ||
         try_type<openvdb::Vec3SGrid>(g, VolumeType::kFloat3, limits, head, reply) ||
         try_type<openvdb::Vec3DGrid>(g, VolumeType::kFloat3, limits, head, reply) ||
         try_type<openvdb::Int32Grid>(g, VolumeType::kInt, limits, head, reply) ||
         try_type<openvdb::Int64Grid>(g, VolumeType::kInt, limits, head, reply) ||
         try_type<openvdb::Vec3IGrid>(g, VolumeType::kInt3, limits, head, reply) ||
         try_type<openvdb::BoolGrid>(g, VolumeType::kMask, limits, head, reply) ||
         try_type<openvdb::MaskGrid>(g, VolumeType::kMask, limits, head, reply));
  return reply;
}

}  // namespace mesocell
