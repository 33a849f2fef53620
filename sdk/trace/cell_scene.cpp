#include "sdk/trace/cell_scene.h"

#include <algorithm>
#include <bit>

#include "sdk/core/gradient_kernel.h"
#include "sdk/core/parallel.h"
#include "sdk/core/srgb.h"
#include "sdk/trace/octant_cubes.h"
#include "sdk/trace/reach.h"
#include "sdk/trace/tile_record.h"

namespace mesocell {
namespace {

Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

}  // namespace

CellScene::CellScene(const CellObject& object)
    : box_{to_vec3(object.grid.box_min), to_vec3(object.box_max())},
      voxel_edge_(object.grid.voxel_edge),
      blocks_(object.tile),
      inside_(object.tile, object.membership),
      pieces_(object.tile.pieces) {
  for (std::size_t a = 0; a < 3; ++a) {
    resolution_[a] = object.tile.resolution[a];
    tiles_[a] = object.grid.tiles[a];
    size_[a] = std::int64_t{resolution_[a]} * tiles_[a];
  }
  labels_.push_back(0);
  for (const Piece& p : pieces_) labels_.push_back(p.cell);
  if (object.color) color_ = *object.color;
  if (object.cell_colors) cell_colors_ = object.cell_colors->colors;
  if (object.instance_colors) instance_colors_ = object.instance_colors->colors;
  if (object.surface_colors) surface_colors_ = *object.surface_colors;
  if (!instance_colors_.empty()) {
    membership_ = object.membership;
    std::uint64_t count = 0;
    for (std::uint64_t t = 0; t < membership_.entries.size(); ++t) {
      first_instance_.push_back(count);
      for (std::uint32_t c = 1; c <= membership_.cell_count; ++c)
        count += membership_.tag(t, c) == Tag::kInside;
    }
  }
  find_empty_tiles(object.grid.tiles);
  find_parts();
  if (blocks_.parts_of(0) != 0) return;
  const std::vector<std::uint32_t>& entries = inside_.entries();
  solid_reach_.resize(entries.size());
  std::transform(entries.begin(), entries.end(), solid_reach_.begin(),
                 [](std::uint32_t entry) { return std::uint8_t(entry == InsidePieces::kAll ? 255 : 0); });
  chebyshev_transform(solid_reach_, object.grid.tiles);
}

void CellScene::find_empty_tiles(const Index3& tiles) {
  const std::vector<std::uint32_t>& entries = inside_.entries();
  std::vector<std::uint8_t> empty(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) empty[i] = entries[i] == InsidePieces::kNone;
  std::array<std::uint8_t, 256> digit_of{};  // the greatest that promises no more
  for (std::uint32_t edge = 1, digit = 0; edge < 256; ++edge) {
    while (digit < kLastDigit && empty_edge(digit + 1) <= edge) ++digit;
    digit_of[edge] = std::uint8_t(digit);
  }
  tile_records_.resize(entries.size());
  for (unsigned pair = 0; pair < 8; pair += 2) {
    std::array<std::vector<std::uint8_t>, 2> edges;
    parallel_for(2, 0,
                 [&](std::size_t k, unsigned) { edges[k] = octant_cubes(empty, tiles, pair + unsigned(k)); });
    for (std::size_t i = 0; i < entries.size(); ++i)
      tile_records_[i] |= std::uint32_t{digit_of[edges[0][i]]} << (4 * pair) |
                          std::uint32_t{digit_of[edges[1][i]]} << (4 * pair + 4);
  }
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (entries[i] != InsidePieces::kNone) tile_records_[i] = kFullTile + entries[i] - 1;
}

void CellScene::find_parts() {
  // A packet reads four bytes at a time.
  parts_.assign(inside_.set_count() * 8 * 64 + 3, 0);
  occupied_parts_.resize(inside_.set_count());
  parallel_for((inside_.set_count() + 63) / 64, 0, [&](std::size_t chunk, unsigned) {
    for (std::size_t set = 64 * chunk; set < std::min(64 * chunk + 64, inside_.set_count()); ++set) {
      Bits64 occupied = 0;
      for (std::uint32_t id = 1; id <= pieces_.size(); ++id)
        if (inside_.has(std::uint32_t(set + 1), id)) occupied |= blocks_.parts_of(id);
      occupied_parts_[set] = occupied;
      for (unsigned octant = 0; octant < 8; ++octant) {
        const auto edges = upward_cubes(~blocks_.mirrored_parts(occupied, octant));
        std::copy(edges.begin(), edges.end(), parts_.begin() + std::ptrdiff_t((set * 8 + octant) * 64));
      }
    }
  });
}

std::uint64_t CellScene::memory_bytes() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return sizeof(*this) + blocks_.memory_bytes() + inside_.memory_bytes() + bytes(pieces_) + bytes(labels_) +
         bytes(tile_records_) + bytes(parts_) + bytes(occupied_parts_) + bytes(solid_reach_) +
         bytes(color_.voxels) + bytes(cell_colors_) + bytes(instance_colors_) + bytes(first_instance_) +
         bytes(membership_.entries) + bytes(membership_.blocks) + bytes(surface_colors_.entries) +
         bytes(surface_colors_.masks) + bytes(surface_colors_.first) + bytes(surface_colors_.colors);
}

bool CellScene::packets(PacketScene& out) const {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 31;
  if (tile_records_.size() >= kMost || parts_.size() >= kMost || blocks_.records().size() >= kMost ||
      blocks_.bricks().size() >= kMost || inside_.sets().size() >= kMost)
    return false;
  out.corner = to_array(box_.min);
  out.voxel_edge = voxel_edge_;
  for (std::size_t a = 0; a < 3; ++a) {
    if (size_[a] >= 1 << 22) return false;
    out.size[a] = double(size_[a]);
    out.inverse_resolution[a] = 1.0f / float(resolution_[a]);
    out.tiles[a] = std::int32_t(tiles_[a]);
    out.resolution[a] = std::int32_t(resolution_[a]);
    out.pad[a] = std::int32_t(blocks_.pad(a));
    out.end[a] = std::int32_t(blocks_.end(a));
    out.part_shift[a] = std::int32_t(blocks_.part_shift(a));
    out.blocks[a] = std::int32_t(blocks_.blocks(a));
  }
  out.cubes = resolution_[0] >= 16 && std::has_single_bit(resolution_[0]) &&
              resolution_[0] == resolution_[1] && resolution_[0] == resolution_[2];
  out.log2_resolution = std::countr_zero(resolution_[0]);
  out.id_bits = std::int32_t(blocks_.id_bits());
  out.voxel_shift = std::int32_t(blocks_.voxel_shift());
  out.edge_bits = std::int32_t(blocks_.edge_bits());
  out.flat = blocks_.flat();
  out.block_count = std::int32_t(blocks_.block_count());
  out.brick_count = std::int32_t(blocks_.brick_count());
  out.set_words = std::int32_t(inside_.set_words());
  out.tile_records = tile_records_.data();
  out.parts = parts_.data();
  out.occupied_parts = occupied_parts_.data();
  out.block_records = blocks_.records().data();
  out.bricks = blocks_.bricks().data();
  out.sets = inside_.sets().data();
  out.labels = labels_.data();
  return true;
}

double CellScene::tile_edge() const { return *std::max_element(resolution_.begin(), resolution_.end()); }

std::array<std::uint32_t, 3> CellScene::mirrored(const std::array<std::uint32_t, 3>& l,
                                                 unsigned octant) const {
  std::array<std::uint32_t, 3> m{};
  for (std::size_t a = 0; a < 3; ++a)
    m[a] = octant >> a & 1 ? l[a] : resolution_[a] - 1 - l[a] + blocks_.pad(a);
  return m;
}

bool CellScene::empty_tiles(const Voxel& v, unsigned octant, Voxel& low, Voxel& high) const {
  const Voxel tile = tile_of(v);
  const std::uint32_t record = tile_records_[tile_index(tile)];
  if (record >= kFullTile) return false;
  const std::int64_t edge = empty_edge(record, octant);
  for (std::size_t a = 0; a < 3; ++a) {
    const bool rises = octant >> a & 1;
    low[a] = (rises ? tile[a] : tile[a] + 1 - edge) * resolution_[a];
    high[a] = (rises ? tile[a] + edge : tile[a] + 1) * resolution_[a];
  }
  return true;
}

std::uint32_t CellScene::same_instance_to(const std::array<std::uint32_t, 3>& m, unsigned octant,
                                          std::array<std::uint32_t, 3>& to) const {
  const std::uint32_t record = blocks_.record(octant, blocks_.block_of(m));
  if (record & TileBlocks::kMixed) {
    const std::uint32_t voxel = blocks_.voxel(octant, record & ~TileBlocks::kMixed, TileBlocks::voxel_of(m));
    for (std::size_t a = 0; a < 3; ++a) to[a] = m[a] + blocks_.edge(voxel, a);
    return blocks_.id(voxel);
  }
  const std::uint32_t edge = record >> TileBlocks::kEdgeShift;
  for (std::size_t a = 0; a < 3; ++a)
    to[a] = std::min(((m[a] >> 2) + edge) << 2, blocks_.end(a) + (octant >> a & 1 ? 0 : blocks_.pad(a)));
  return record & TileBlocks::kIdMask;
}

namespace {

/// The box of voxels from `v` to where `to` is from `m` on axes on which an octant rises, else back.
void box_from(const Voxel& v, unsigned octant, const std::array<std::uint32_t, 3>& m,
              const std::array<std::uint32_t, 3>& to, Voxel& low, Voxel& high) {
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t way = std::int64_t{to[a]} - m[a];
    low[a] = octant >> a & 1 ? v[a] : v[a] + 1 - way;
    high[a] = octant >> a & 1 ? v[a] + way : v[a] + 1;
  }
}

}  // namespace

bool CellScene::empty_box(const Voxel& v, unsigned octant, Voxel& low, Voxel& high) const {
  if (empty_tiles(v, octant, low, high)) return true;
  const Voxel tile = tile_of(v);
  const std::uint32_t set = tile_records_[tile_index(tile)] - kFullTile;
  const std::array<std::uint32_t, 3> m = mirrored(in_tile(v, tile), octant);
  std::array<std::uint32_t, 3> to{};
  std::size_t part = 0;
  for (std::size_t a = 0; a < 3; ++a) part |= std::size_t{m[a] >> blocks_.part_shift(a)} << (2 * a);
  if (const std::uint32_t edge = parts_[(std::size_t{set} * 8 + octant) * 64 + part]; edge > 0) {
    for (std::size_t a = 0; a < 3; ++a) {
      const unsigned shift = blocks_.part_shift(a);
      to[a] = std::min(((m[a] >> shift) + edge) << shift,
                       resolution_[a] + (octant >> a & 1 ? 0 : blocks_.pad(a)));
    }
  } else if (inside_.has(set + 1, same_instance_to(m, octant, to))) {
    return false;
  }
  box_from(v, octant, m, to, low, high);
  return true;
}

void CellScene::solid_box(const Voxel& v, unsigned octant, Voxel& low, Voxel& high) const {
  const Voxel tile = tile_of(v);
  if (!solid_reach_.empty() && solid_reach_[tile_index(tile)] > 0) {
    const std::int64_t reach = solid_reach_[tile_index(tile)];
    for (std::size_t a = 0; a < 3; ++a) {
      // Unlike what is empty, what is solid ends with the grid.
      low[a] = std::max<std::int64_t>((tile[a] - reach + 1) * resolution_[a], 0);
      high[a] = std::min((tile[a] + reach) * resolution_[a], size_[a]);
    }
    return;
  }
  const std::array<std::uint32_t, 3> m = mirrored(in_tile(v, tile), octant);
  std::array<std::uint32_t, 3> to{};
  same_instance_to(m, octant, to);
  box_from(v, octant, m, to, low, high);
  // A file may say of an instance that leaves the grid that it is INSIDE.
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::max<std::int64_t>(low[a], 0);
    high[a] = std::min(high[a], size_[a]);
  }
}

Ray CellScene::to_voxels(const Ray& ray) const {
  // Multiplying the direction by the edge would do as well; t is in metres if it stays as it is and the
  // origin is divided, so t in voxels is t / edge.
  return {(ray.origin - box_.min) / voxel_edge_, ray.direction};
}

void CellScene::set_hit(const WalkRay& ray, const WalkPlace& place, Hit& hit) const {
  hit = {};
  hit.t = place.t * ray.scale * voxel_edge_;
  hit.element = place.voxel;
  set_instance(hit);
  if (place.entry_axis >= 0) {
    const std::size_t a = std::size_t(place.entry_axis);
    hit.face_normal[a] = ray.rises(a) ? -1 : 1;
  }
}

void CellScene::set_instance(Hit& hit) const {
  const Voxel tile = tile_of(hit.element);
  const Piece& piece = pieces_[blocks_.id_at(in_tile(hit.element, tile)) - 1];
  hit.label = piece.cell;
  hit.instance =
      std::int64_t(tile_index({tile[0] + piece.home[0], tile[1] + piece.home[1], tile[2] + piece.home[2]}));
}

Hit CellScene::details(const StreamHit& hit) const {
  Hit out;
  out.t = hit.t;
  out.element = {hit.element[0], hit.element[1], hit.element[2]};
  set_instance(out);
  if (hit.face >= 0) out.face_normal[std::size_t(hit.face / 2)] = hit.face % 2 ? 1 : -1;
  return out;
}

Vec3 CellScene::shading_normal(const Hit& hit) const {
  Vec3 sum;
  for (const KernelVoxel& n : gradient_kernel()) {
    const Voxel v{hit.element[0] + n.offset[0], hit.element[1] + n.offset[1], hit.element[2] + n.offset[2]};
    if (!in_grid(v) || !inside(v)) sum = sum + n.pull;
  }
  // Walls thinner than the neighbourhood can balance out; the face that was entered is right then.
  const double l = length(sum);
  return l > 1e-3 ? sum / l : hit.face_normal;
}

bool CellScene::inside_point(Vec3 point) const {
  const Vec3 p = (point - box_.min) / voxel_edge_;
  Voxel v{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(p[a] >= 0 && p[a] < double(size_[a]))) return false;
    v[a] = std::int64_t(p[a]);
  }
  return inside(v);
}

const Rgb8* CellScene::surface_color(const Voxel& v) const {
  if (surface_colors_.colors.empty()) return nullptr;
  const Voxel tile = tile_of(v);
  return surface_colors_.find(tile_index(tile), surface_colors_.color_voxel(in_tile(v, tile), resolution_));
}

Vec3 CellScene::color(const Hit& hit, Vec3 point) const {
  Vec3 color{1, 1, 1};
  if (!cell_colors_.empty()) color = srgb_to_linear(cell_colors_[hit.label - 1]);
  if (const Rgb8* const baked = surface_color(hit.element)) {
    color = times(color, srgb_to_linear(*baked));
  } else if (!instance_colors_.empty()) {
    const std::uint64_t home = std::uint64_t(hit.instance);
    std::uint64_t i = first_instance_[home];
    for (std::uint32_t c = 1; c < hit.label; ++c) i += membership_.tag(home, c) == Tag::kInside;
    color = times(color, srgb_to_linear(instance_colors_[i]));
  }
  if (color_.voxels.empty()) return color;
  // The point's share of its tile, held to the voxel that was hit: rounding may put it just beyond.
  const Vec3 p = (point - box_.min) / voxel_edge_;
  std::array<std::uint64_t, 3> at{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = std::clamp(p[a], double(hit.element[a]), double(hit.element[a]) + 1);
    const std::int64_t tile = hit.element[a] / resolution_[a];
    const double share = (x - double(tile * resolution_[a])) / resolution_[a];
    at[a] = std::min(std::uint64_t(share * color_.resolution[a]), std::uint64_t{color_.resolution[a]} - 1);
  }
  const std::uint64_t i = at[0] + color_.resolution[0] * (at[1] + color_.resolution[1] * at[2]);
  return times(color, srgb_to_linear(color_.voxels[i]));
}

}  // namespace mesocell
