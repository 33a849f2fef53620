#include "converters/vdb/volume_lookup.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace mesocell {
namespace {

constexpr unsigned kLeaf = 3, kNode = 7, kRoot = 12;

VoxelCoord down(const VoxelCoord& at, unsigned log2_edge) {
  const std::int32_t mask = ~((std::int32_t{1} << log2_edge) - 1);
  return {at[0] & mask, at[1] & mask, at[2] & mask};
}

std::size_t offset_in_leaf(const VoxelCoord& at) {
  return std::size_t((at[0] & 7) + 8 * ((at[1] & 7) + 8 * (at[2] & 7)));
}

/// The whole number below, in reach, and what is left.
std::int32_t split(double at, double& rest) {
  constexpr double kReach = SparseVolume::kReach;
  // In this order, so that what is no number is held to it, too.
  const double held = at < kReach - 2 ? (at > -kReach ? at : -kReach) : kReach - 2;
  const double low = std::floor(held);
  rest = held - low;
  return std::int32_t(low);
}

double mix(double a, double b, double t) { return a + (b - a) * t; }

void grow(VolumeLookup::Range& range, double low, double high) {
  range.low = std::min(range.low, low);
  range.high = std::max(range.high, high);
}

bool beyond(const VolumeLookup::Range& range, const VolumeLookup::Range& enough) {
  return range.low < enough.low && range.high > enough.high;
}

constexpr VolumeLookup::Range kEmpty = {std::numeric_limits<double>::infinity(),
                                        -std::numeric_limits<double>::infinity()};

}  // namespace

PlaceTable::PlaceTable(std::size_t count) : slots_(std::bit_ceil(2 * count + 1)) {}

std::size_t PlaceTable::slot_of(const VoxelCoord& place) const {
  // The finalizer of MurmurHash3.
  std::uint64_t hash = 0;
  for (const std::int32_t c : place) hash = hash << 21 ^ std::uint64_t(std::uint32_t(c)) >> 3;
  hash = (hash ^ hash >> 33) * 0xff51afd7ed558ccd;
  hash = (hash ^ hash >> 33) * 0xc4ceb9fe1a85ec53;
  std::size_t i = std::size_t(hash ^ hash >> 33) & (slots_.size() - 1);
  while (slots_[i].number != kNone && slots_[i].place != place) i = (i + 1) & (slots_.size() - 1);
  return i;
}

void PlaceTable::set(const VoxelCoord& place, std::uint32_t number) {
  slots_[slot_of(place)] = {place, number};
}

std::uint32_t PlaceTable::find(const VoxelCoord& place) const { return slots_[slot_of(place)].number; }

VolumeLookup::VolumeLookup(const SparseVolume& volume) : volume_(volume), leaves_(volume.leaves.size()) {
  std::array<std::size_t, kRoot + 1> counts{};
  for (const VolumeTile& tile : volume.tiles) ++counts[tile.log2_edge];
  small_tiles_ = PlaceTable(counts[kLeaf]);
  tiles_ = PlaceTable(counts[kNode]);
  roots_ = PlaceTable(counts[kRoot]);
  for (std::size_t i = 0; i < volume.tiles.size(); ++i) {
    const VolumeTile& tile = volume.tiles[i];
    PlaceTable& table = tile.log2_edge == kLeaf ? small_tiles_ : tile.log2_edge == kNode ? tiles_ : roots_;
    table.set(tile.origin, std::uint32_t(i));
  }
  has_tiles_ = !volume.tiles.empty();
  for (std::size_t i = 0; i < volume.leaves.size(); ++i)
    leaves_.set(volume.leaves[i].origin, std::uint32_t(i));

  leaf_ranges_.reserve(volume.leaves.size());
  for (std::size_t i = 0; i < volume.leaves.size(); ++i) {
    Range range = kEmpty;
    if (volume.type == VolumeType::kMask) {
      std::uint64_t any = 0, all = ~std::uint64_t{0};
      for (const std::uint64_t word : volume.leaves[i].active) any |= word, all &= word;
      range = {all == ~std::uint64_t{0} ? 1.0 : 0.0, any ? 1.0 : 0.0};
    } else {
      const std::size_t step = volume.channels(), first = i * SparseVolume::kLeafVoxels * step;
      for (std::size_t v = 0; v < SparseVolume::kLeafVoxels; ++v) {
        const std::size_t at = first + v * step;
        const double value = volume.has_floats() ? double(volume.floats[at]) : double(volume.ints[at]);
        grow(range, value, value);
      }
    }
    leaf_ranges_.push_back(range);
  }

  // Nodes, each with the range of all that is in it.
  std::vector<VoxelCoord> origins;
  for (const VolumeLeaf& leaf : volume.leaves) origins.push_back(down(leaf.origin, kNode));
  for (const VolumeTile& tile : volume.tiles)
    if (tile.log2_edge == kLeaf) origins.push_back(down(tile.origin, kNode));
  std::sort(origins.begin(), origins.end());
  origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
  nodes_ = PlaceTable(origins.size());
  for (const VoxelCoord& origin : origins) {
    nodes_.set(origin, std::uint32_t(node_list_.size()));
    node_list_.push_back({origin, kEmpty, 0});
  }
  const auto add = [&](const VoxelCoord& origin, const Range& range) {
    Node& node = node_list_[nodes_.find(down(origin, kNode))];
    grow(node.range, range.low, range.high);
    ++node.parts;
  };
  for (std::size_t i = 0; i < volume.leaves.size(); ++i) add(volume.leaves[i].origin, leaf_ranges_[i]);
  for (const VolumeTile& tile : volume.tiles)
    if (tile.log2_edge == kLeaf && leaves_.find(tile.origin) == PlaceTable::kNone)
      add(tile.origin, {tile.value[0], tile.value[0]});
  for (Node& node : node_list_) {
    if (node.parts == 4096) continue;
    std::uint32_t tile = tiles_.find(node.origin);
    if (tile == PlaceTable::kNone) tile = roots_.find(down(node.origin, kRoot));
    const double rest = tile == PlaceTable::kNone ? volume.background[0] : volume.tiles[tile].value[0];
    grow(node.range, rest, rest);
  }
}

std::uint32_t VolumeLookup::find_leaf(const VoxelCoord& at) const { return leaves_.find(down(at, kLeaf)); }

const VolumeValue& VolumeLookup::beyond_leaves(const VoxelCoord& at) const {
  if (has_tiles_) {
    std::uint32_t tile = small_tiles_.find(down(at, kLeaf));
    if (tile == PlaceTable::kNone) tile = tiles_.find(down(at, kNode));
    if (tile == PlaceTable::kNone) tile = roots_.find(down(at, kRoot));
    if (tile != PlaceTable::kNone) return volume_.tiles[tile].value;
  }
  return volume_.background;
}

VolumeValue VolumeLookup::leaf_numbers(std::uint32_t leaf, const VoxelCoord& at) const {
  const std::size_t offset = offset_in_leaf(at);
  if (volume_.type == VolumeType::kMask)
    return {double(volume_.leaves[leaf].active[offset / 64] >> (offset % 64) & 1), 0, 0};
  const std::size_t channels = volume_.channels();
  const std::size_t first = (std::size_t{leaf} * SparseVolume::kLeafVoxels + offset) * channels;
  VolumeValue value{};
  for (std::size_t c = 0; c < channels; ++c)
    value[c] = volume_.has_floats() ? double(volume_.floats[first + c]) : double(volume_.ints[first + c]);
  return value;
}

VolumeValue VolumeLookup::numbers(const VoxelCoord& at) const {
  const std::uint32_t leaf = find_leaf(at);
  return leaf == PlaceTable::kNone ? beyond_leaves(at) : leaf_numbers(leaf, at);
}

double VolumeLookup::interpolate(Vec3 at) const {
  std::array<double, 3> t;
  VoxelCoord low;
  for (std::size_t a = 0; a < 3; ++a) low[a] = split(at[a], t[a]);
  std::array<double, 8> v;
  const std::uint32_t leaf = find_leaf(low);
  const bool within = (low[0] & 7) < 7 && (low[1] & 7) < 7 && (low[2] & 7) < 7;
  if (within && leaf == PlaceTable::kNone) return beyond_leaves(low)[0];
  if (within && volume_.type == VolumeType::kFloat) {
    const float* first =
        volume_.floats.data() + std::size_t{leaf} * SparseVolume::kLeafVoxels + offset_in_leaf(low);
    for (std::size_t k = 0; k < 8; ++k) v[k] = double(first[(k & 1) + 8 * (k >> 1 & 1) + 64 * (k >> 2)]);
  } else {
    for (std::size_t k = 0; k < 8; ++k)
      v[k] = value(
          {low[0] + std::int32_t(k & 1), low[1] + std::int32_t(k >> 1 & 1), low[2] + std::int32_t(k >> 2)});
  }
  for (std::size_t k = 0; k < 4; ++k) v[k] = mix(v[2 * k], v[2 * k + 1], t[0]);
  for (std::size_t k = 0; k < 2; ++k) v[k] = mix(v[2 * k], v[2 * k + 1], t[1]);
  return mix(v[0], v[1], t[2]);
}

VolumeValue VolumeLookup::interpolate_numbers(Vec3 at) const {
  std::array<double, 3> t;
  VoxelCoord low;
  for (std::size_t a = 0; a < 3; ++a) low[a] = split(at[a], t[a]);
  std::array<VolumeValue, 8> v;
  for (std::size_t k = 0; k < 8; ++k)
    v[k] = numbers(
        {low[0] + std::int32_t(k & 1), low[1] + std::int32_t(k >> 1 & 1), low[2] + std::int32_t(k >> 2)});
  VolumeValue sum{};
  for (std::size_t c = 0; c < 3; ++c) {
    std::array<double, 4> x;
    for (std::size_t k = 0; k < 4; ++k) x[k] = mix(v[2 * k][c], v[2 * k + 1][c], t[0]);
    sum[c] = mix(mix(x[0], x[1], t[1]), mix(x[2], x[3], t[1]), t[2]);
  }
  return sum;
}

double VolumeLookup::nearest(Vec3 at) const {
  VoxelCoord low;
  double rest;
  for (std::size_t a = 0; a < 3; ++a) low[a] = split(at[a] + 0.5, rest);
  return value(low);
}

void VolumeLookup::add_range(const Node& node, const VoxelCoord& low, const VoxelCoord& high,
                             const Range& enough, Range& found) const {
  VoxelCoord first, last;
  bool whole = true;
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = std::max(low[a], node.origin[a]);
    last[a] = std::min(high[a], node.origin[a] + 127);
    if (first[a] > last[a]) return;
    whole = whole && first[a] == node.origin[a] && last[a] == node.origin[a] + 127;
  }
  // What all of the node adds nothing to, a part of it does not either.
  if (whole || (node.range.low >= found.low && node.range.high <= found.high)) {
    grow(found, node.range.low, node.range.high);
    return;
  }
  const VoxelCoord begin = down(first, kLeaf);
  for (std::int32_t z = begin[2]; z <= last[2]; z += 8)
    for (std::int32_t y = begin[1]; y <= last[1]; y += 8)
      for (std::int32_t x = begin[0]; x <= last[0]; x += 8) {
        const std::uint32_t leaf = leaves_.find({x, y, z});
        if (leaf != PlaceTable::kNone) {
          grow(found, leaf_ranges_[leaf].low, leaf_ranges_[leaf].high);
        } else {
          const double v = beyond_leaves({x, y, z})[0];
          grow(found, v, v);
        }
        if (beyond(found, enough)) return;
      }
}

std::optional<VolumeLookup::Range> VolumeLookup::fine_range(const Box3& box, const Range& enough) const {
  constexpr std::size_t kEdge = std::size_t(kFine) + 1;
  constexpr double kReach = SparseVolume::kReach - 2;
  VoxelCoord low, cells;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(box.min[a] >= -kReach && box.max[a] < kReach && box.max[a] - box.min[a] < kFine))
      return std::nullopt;
    low[a] = std::int32_t(std::floor(box.min[a]));
    cells[a] = std::int32_t(std::floor(box.max[a])) - low[a] + 1;
    if (cells[a] > kFine) return std::nullopt;
  }
  std::array<double, kEdge * kEdge * kEdge> samples;
  Range coarse = kEmpty;
  for (std::int32_t z = 0; z <= cells[2]; ++z)
    for (std::int32_t y = 0; y <= cells[1]; ++y)
      for (std::int32_t x = 0; x <= cells[0]; ++x) {
        const double v = value({low[0] + x, low[1] + y, low[2] + z});
        samples[std::size_t(x) + kEdge * (std::size_t(y) + kEdge * std::size_t(z))] = v;
        grow(coarse, v, v);
      }
  if (coarse.high < enough.low || coarse.low > enough.high) return coarse;
  // Of a cell the part that is in the box, as shares of its edges.
  const auto part = [&](std::size_t a, std::int32_t cell) {
    const double at = low[a] + cell;
    return std::array<double, 2>{std::max(box.min[a] - at, 0.0), std::min(box.max[a] - at, 1.0)};
  };
  Range found = kEmpty;
  for (std::int32_t z = 0; z < cells[2]; ++z)
    for (std::int32_t y = 0; y < cells[1]; ++y)
      for (std::int32_t x = 0; x < cells[0]; ++x) {
        const std::array<double, 2> tx = part(0, x), ty = part(1, y), tz = part(2, z);
        const double* const v =
            samples.data() + std::size_t(x) + kEdge * (std::size_t(y) + kEdge * std::size_t(z));
        for (const double t : tx) {
          const std::array<double, 4> c = {mix(v[0], v[1], t), mix(v[kEdge], v[kEdge + 1], t),
                                           mix(v[kEdge * kEdge], v[kEdge * kEdge + 1], t),
                                           mix(v[kEdge * kEdge + kEdge], v[kEdge * kEdge + kEdge + 1], t)};
          for (const double u : ty) {
            const double near = mix(c[0], c[1], u), far = mix(c[2], c[3], u);
            for (const double w : tz) {
              const double value = mix(near, far, w);
              grow(found, value, value);
            }
          }
        }
        if (beyond(found, enough)) return found;
      }
  // Rounding goes by the samples, which may be much greater than what is between them.
  const double slack = 1e-13 * std::max(std::abs(coarse.low), std::abs(coarse.high));
  return Range{found.low - slack, found.high + slack};
}

VolumeLookup::Range VolumeLookup::range(const VoxelCoord& low, const VoxelCoord& high,
                                        const Range& enough) const {
  Range found = kEmpty;
  const VoxelCoord first = down(low, kNode), last = down(high, kNode);
  double places = 1;
  for (std::size_t a = 0; a < 3; ++a) places *= double(last[a] - first[a]) / 128 + 1;
  if (places > 64 + double(node_list_.size() + volume_.tiles.size())) {
    // The box is large and what stands in it is little: a superset of the background's place.
    grow(found, volume_.background[0], volume_.background[0]);
    for (const VolumeTile& tile : volume_.tiles) {
      if (tile.log2_edge == kLeaf) continue;
      bool meets = true;
      for (std::size_t a = 0; a < 3; ++a)
        meets = meets && tile.origin[a] <= high[a] && tile.origin[a] + (1 << tile.log2_edge) > low[a];
      if (meets) grow(found, tile.value[0], tile.value[0]);
    }
    for (const Node& node : node_list_) {
      if (beyond(found, enough)) return found;
      add_range(node, low, high, enough, found);
    }
    return found;
  }
  for (std::int32_t z = first[2]; z <= last[2]; z += 128)
    for (std::int32_t y = first[1]; y <= last[1]; y += 128)
      for (std::int32_t x = first[0]; x <= last[0]; x += 128) {
        const std::uint32_t node = nodes_.find({x, y, z});
        if (node != PlaceTable::kNone) {
          add_range(node_list_[node], low, high, enough, found);
        } else {
          const double v = beyond_leaves({x, y, z})[0];
          grow(found, v, v);
        }
        if (beyond(found, enough)) return found;
      }
  return found;
}

}  // namespace mesocell
