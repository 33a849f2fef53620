#include "converters/vdb/sparse_volume.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>

namespace mesocell {
namespace {

constexpr std::uint32_t kMagic = 0x4c4f5653;  // "SVOL"
constexpr std::size_t kTileBytes = 3 * 4 + 2 + 3 * 8, kLeafBytes = 3 * 4 + 8 * 8;

Error damaged(const char* what) {
  return {ErrorCode::kInvalidInput,
          std::string("what was read of the volume is not one (") + what + "); fetch or export it again"};
}

template <typename T>
void write_array(const std::vector<T>& values, ByteWriter& out) {
  out.append(std::as_bytes(std::span(values)));
}

template <typename T>
bool read_array(ByteReader& in, std::size_t count, std::vector<T>& values) {
  if (count > in.remaining() / sizeof(T)) return false;
  const auto bytes = in.take(count * sizeof(T));
  values.resize(count);
  if (count > 0) std::memcpy(values.data(), bytes.data(), bytes.size());
  return true;
}

void write_coord(const VoxelCoord& coord, ByteWriter& out) {
  for (const std::int32_t c : coord) out.u32(std::uint32_t(c));
}

VoxelCoord read_coord(ByteReader& in) {
  VoxelCoord coord;
  for (std::int32_t& c : coord) c = std::int32_t(in.u32());
  return coord;
}

bool placed(const VoxelCoord& origin, unsigned log2_edge) {
  return std::all_of(origin.begin(), origin.end(), [&](std::int32_t c) {
    return c >= -SparseVolume::kReach && c < SparseVolume::kReach && (c & ((1 << log2_edge) - 1)) == 0;
  });
}

/// Whether numbers are such as the type has.
bool fits(const SparseVolume& volume, const VolumeValue& value) {
  for (std::size_t c = 0; c < 3; ++c) {
    const double v = value[c];
    if (!std::isfinite(v) || std::abs(v) > double(std::numeric_limits<float>::max())) return false;
    if (!volume.has_floats() && !(v == std::floor(v) && std::abs(v) <= 0x1p31 && v < 0x1p31)) return false;
  }
  return true;
}

/// Whether all places are different; sorts them.
bool distinct(std::vector<VoxelCoord>& places) {
  std::sort(places.begin(), places.end());
  return std::adjacent_find(places.begin(), places.end()) == places.end();
}

Status read_tiles(ByteReader& in, SparseVolume& volume) {
  const std::uint64_t count = in.u64();
  if (count > in.remaining() / kTileBytes) return damaged("more tiles than bytes");
  volume.tiles.reserve(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    VolumeTile tile;
    tile.origin = read_coord(in);
    tile.log2_edge = in.u8();
    tile.active = in.u8() != 0;
    for (double& v : tile.value) v = in.f64();
    if (tile.log2_edge != 3 && tile.log2_edge != 7 && tile.log2_edge != 12) return damaged("size of a tile");
    if (!placed(tile.origin, tile.log2_edge)) return damaged("place of a tile");
    if (!fits(volume, tile.value)) return damaged("value of a tile");
    volume.tiles.push_back(tile);
  }
  for (const int size : {3, 7, 12}) {
    std::vector<VoxelCoord> places;
    for (const VolumeTile& tile : volume.tiles)
      if (tile.log2_edge == size) places.push_back(tile.origin);
    if (!distinct(places)) return damaged("two tiles at one place");
  }
  return {};
}

Status read_leaves(ByteReader& in, SparseVolume& volume) {
  const std::uint64_t count = in.u64();
  if (count > in.remaining() / kLeafBytes) return damaged("more leaves than bytes");
  volume.leaves.reserve(count);
  std::vector<VoxelCoord> places;
  places.reserve(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    VolumeLeaf leaf;
    leaf.origin = read_coord(in);
    for (std::uint64_t& word : leaf.active) word = in.u64();
    if (!placed(leaf.origin, 3)) return damaged("place of a leaf");
    volume.leaves.push_back(leaf);
    places.push_back(leaf.origin);
  }
  if (!distinct(places)) return damaged("two leaves at one place");
  if (volume.has_floats() && !read_array(in, volume.number_count(), volume.floats))
    return damaged("values missing");
  if (volume.has_ints() && !read_array(in, volume.number_count(), volume.ints))
    return damaged("values missing");
  for (float& v : volume.floats)
    if (!std::isfinite(v)) v = 0;
  return {};
}

}  // namespace

void write_text(std::string_view text, ByteWriter& out) {
  out.u32(std::uint32_t(text.size()));
  out.append(text);
}

std::string read_text(ByteReader& in) {
  const auto bytes = in.take(in.u32());
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void write_transform(const Transform& transform, ByteWriter& out) {
  for (const Vec3& row : transform.rows)
    for (std::size_t a = 0; a < 3; ++a) out.f64(row[a]);
  for (std::size_t a = 0; a < 3; ++a) out.f64(transform.move[a]);
}

Transform read_transform(ByteReader& in) {
  Transform transform;
  for (Vec3& row : transform.rows)
    for (std::size_t a = 0; a < 3; ++a) row[a] = in.f64();
  for (std::size_t a = 0; a < 3; ++a) transform.move[a] = in.f64();
  return transform;
}

bool is_sound(const Transform& transform) {
  if (!is_finite(transform.move)) return false;
  const std::optional<Transform> inverse = transform.inverse();
  if (!inverse || !is_finite(inverse->move)) return false;
  const std::array<Vec3, 3>& r = transform.rows;
  // Rows in a plane, but for rounding.
  if (!(std::abs(dot(cross(r[0], r[1]), r[2])) > 1e-12 * length(r[0]) * length(r[1]) * length(r[2])))
    return false;
  return std::all_of(transform.rows.begin(), transform.rows.end(), [](Vec3 row) { return is_finite(row); }) &&
         std::all_of(inverse->rows.begin(), inverse->rows.end(), [](Vec3 row) { return is_finite(row); });
}

void write_volume(const SparseVolume& volume, ByteWriter& out) {
  out.reserve(out.size() + 4096 + volume.tiles.size() * kTileBytes + volume.leaves.size() * kLeafBytes +
              4 * (volume.floats.size() + volume.ints.size()));
  out.u32(kMagic);
  write_text(volume.name, out);
  out.u8(std::uint8_t(volume.type));
  out.u8(std::uint8_t(volume.volume_class));
  write_transform(volume.index_to_world, out);
  for (const double v : volume.background) out.f64(v);
  out.u32(std::uint32_t(volume.metadata.size()));
  for (const auto& [key, value] : volume.metadata) {
    write_text(key, out);
    write_text(value, out);
  }
  out.u64(volume.tiles.size());
  for (const VolumeTile& tile : volume.tiles) {
    write_coord(tile.origin, out);
    out.u8(tile.log2_edge);
    out.u8(tile.active ? 1 : 0);
    for (const double v : tile.value) out.f64(v);
  }
  out.u64(volume.leaves.size());
  for (const VolumeLeaf& leaf : volume.leaves) {
    write_coord(leaf.origin, out);
    for (const std::uint64_t word : leaf.active) out.u64(word);
  }
  write_array(volume.floats, out);
  write_array(volume.ints, out);
}

Result<SparseVolume> read_volume(ByteReader& in) {
  if (in.u32() != kMagic) return damaged("magic number");
  SparseVolume volume;
  volume.name = read_text(in);
  const std::uint8_t type = in.u8(), volume_class = in.u8();
  if (type > std::uint8_t(VolumeType::kMask) || volume_class > std::uint8_t(VolumeClass::kFog))
    return damaged("type");
  volume.type = VolumeType(type);
  volume.volume_class = VolumeClass(volume_class);
  volume.index_to_world = read_transform(in);
  if (in.overrun() || !is_sound(volume.index_to_world))
    return Error{ErrorCode::kInvalidInput,
                 "the volume's transform is not finite or flattens it; export it with another one"};
  for (double& v : volume.background) v = in.f64();
  if (!fits(volume, volume.background)) return damaged("background");
  const std::uint32_t texts = in.u32();
  if (texts > in.remaining() / 8) return damaged("more metadata than bytes");
  for (std::uint32_t i = 0; i < texts; ++i) {
    std::string key = read_text(in);
    volume.metadata.emplace_back(std::move(key), read_text(in));
  }
  if (Status status = read_tiles(in, volume); !status) return status.error();
  if (Status status = read_leaves(in, volume); !status) return status.error();
  if (in.overrun()) return damaged("its end is missing");
  return volume;
}

bool active_range(const SparseVolume& volume, VoxelCoord& low, VoxelCoord& high) {
  low.fill(std::numeric_limits<std::int32_t>::max());
  high.fill(std::numeric_limits<std::int32_t>::min());
  bool any = false;
  const auto add = [&](const VoxelCoord& first, const VoxelCoord& last) {
    any = true;
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], first[a]);
      high[a] = std::max(high[a], last[a]);
    }
  };
  for (const VolumeTile& tile : volume.tiles) {
    // A mask's tiles are true where they are active.
    if (!tile.active) continue;
    const std::int32_t reach = (1 << tile.log2_edge) - 1;
    add(tile.origin, {tile.origin[0] + reach, tile.origin[1] + reach, tile.origin[2] + reach});
  }
  for (const VolumeLeaf& leaf : volume.leaves) {
    std::uint64_t rows = 0;
    std::int32_t first = 8, last = -1;
    for (std::int32_t z = 0; z < 8; ++z) {
      if (leaf.active[std::size_t(z)] == 0) continue;
      rows |= leaf.active[std::size_t(z)];
      first = std::min(first, z);
      last = z;
    }
    if (rows == 0) continue;
    std::uint64_t columns = 0;
    for (int y = 0; y < 8; ++y) columns |= rows >> (8 * y) & 0xff;
    const VoxelCoord& o = leaf.origin;
    add({o[0] + std::countr_zero(columns), o[1] + std::countr_zero(rows) / 8, o[2] + first},
        {o[0] + 63 - std::countl_zero(columns), o[1] + (63 - std::countl_zero(rows)) / 8, o[2] + last});
  }
  return any;
}

SparseVolume make_sparse(std::span<const float> values, const std::array<std::uint32_t, 3>& size) {
  SparseVolume volume;
  float least = std::numeric_limits<float>::infinity();
  for (const float v : values)
    if (std::isfinite(v)) least = std::min(least, v);
  if (!std::isfinite(least)) least = 0;
  volume.background[0] = double(least);
  std::array<float, SparseVolume::kLeafVoxels> block;
  for (std::uint32_t z0 = 0; z0 < size[2]; z0 += 8)
    for (std::uint32_t y0 = 0; y0 < size[1]; y0 += 8)
      for (std::uint32_t x0 = 0; x0 < size[0]; x0 += 8) {
        VolumeLeaf leaf{{std::int32_t(x0), std::int32_t(y0), std::int32_t(z0)}, {}};
        block.fill(least);
        bool any = false;
        for (std::uint32_t z = z0; z < std::min(z0 + 8, size[2]); ++z)
          for (std::uint32_t y = y0; y < std::min(y0 + 8, size[1]); ++y)
            for (std::uint32_t x = x0; x < std::min(x0 + 8, size[0]); ++x) {
              const float v = values[x + std::size_t{size[0]} * (y + std::size_t{size[1]} * z)];
              if (!std::isfinite(v) || v == least) continue;
              any = true;
              block[(x - x0) + 8 * ((y - y0) + 8 * (z - z0))] = v;
              leaf.active[z - z0] |= std::uint64_t{1} << ((x - x0) + 8 * (y - y0));
            }
        if (!any) continue;
        volume.leaves.push_back(leaf);
        volume.floats.insert(volume.floats.end(), block.begin(), block.end());
      }
  return volume;
}

}  // namespace mesocell
