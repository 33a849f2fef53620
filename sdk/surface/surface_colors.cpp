#include "sdk/surface/surface_colors.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "format/limits.h"
#include "sdk/core/parallel.h"
#include "sdk/core/srgb.h"
#include "sdk/surface/inside_tiles.h"

namespace mesocell {
namespace {

/// Neighbouring samples cost little more than one, and eight of them are as many as a color voxel of 2³
/// voxels on a slope has faces.
constexpr std::size_t kMostSamples = 8;

/// Tiles that are colored in one go.
constexpr std::size_t kBlockTiles = 64;

/// A face between two pieces of the repeated tile, of which either may be INSIDE without the other.
struct PieceFace {
  std::uint32_t own = 0, other = 0;      ///< ids; `own` is not 0
  std::array<std::uint16_t, 3> voxel{};  ///< of `own`, in the tile
  std::uint8_t face = 0;                 ///< 2 · axis, + 1 if `other` is up the axis
  bool across = false;                   ///< whether `other` is in the next tile
};

/// All of them, by color voxel.
class PieceFaces {
 public:
  /// `most`: faces at most, or there are none.
  PieceFaces(const TileMap& tile, const SurfaceColors& map, std::size_t most) {
    first_.assign(map.voxels_per_brick() + 1, 0);
    std::size_t count = 0;
    each(tile, [&](const PieceFace& face) {
      ++first_[color_voxel(tile, map, face) + 1];
      ++count;
    });
    fit_ = count <= most;
    if (!fit_) return;
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    faces_.resize(count);
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    each(tile, [&](const PieceFace& face) { faces_[next[color_voxel(tile, map, face)]++] = face; });
  }
  [[nodiscard]] bool fit() const { return fit_; }
  [[nodiscard]] const PieceFace* begin(std::size_t v) const { return faces_.data() + first_[v]; }
  [[nodiscard]] const PieceFace* end(std::size_t v) const { return faces_.data() + first_[v + 1]; }

 private:
  static std::size_t color_voxel(const TileMap& tile, const SurfaceColors& map, const PieceFace& face) {
    return map.color_voxel({face.voxel[0], face.voxel[1], face.voxel[2]}, tile.resolution);
  }

  template <typename Use>
  static void each(const TileMap& tile, const Use& use) {
    const Index3& r = tile.resolution;
    Index3 v{};
    std::uint64_t i = 0;
    for (v[2] = 0; v[2] < r[2]; ++v[2])
      for (v[1] = 0; v[1] < r[1]; ++v[1])
        for (v[0] = 0; v[0] < r[0]; ++v[0], ++i) {
          const std::uint32_t own = tile.id(i);
          if (own == 0) continue;
          for (std::uint8_t face = 0; face < 6; ++face) {
            const std::size_t a = face / 2;
            const bool up = face % 2 != 0;
            Index3 n = v;
            const bool across = v[a] == (up ? r[a] - 1 : 0);
            n[a] = across ? (up ? 0 : r[a] - 1) : (up ? v[a] + 1 : v[a] - 1);
            const std::uint32_t other = tile.id(tile.voxel_index(n[0], n[1], n[2]));
            if (other == own && !across) continue;
            use(PieceFace{
                own, other, {std::uint16_t(v[0]), std::uint16_t(v[1]), std::uint16_t(v[2])}, face, across});
          }
        }
  }

  bool fit_ = true;
  std::vector<std::size_t> first_;
  std::vector<PieceFace> faces_;
};

/// Some tiles' part of the map.
struct Part {
  std::vector<std::uint64_t> tiles;
  std::vector<std::uint8_t> masks;
  std::vector<std::uint32_t> counts;
  std::vector<Rgb8> colors;
};

class Baker {
 public:
  Baker(const CellObject& object, const ColorField& field, const SurfaceColors& map, const PieceFaces& faces)
      : inside_(object, TileBox{{0, 0, 0}, object.grid.tiles}),
        tiles_(object.grid.tiles),
        resolution_(object.tile.resolution),
        field_(field),
        map_(map),
        faces_(faces) {}

  void bake(std::uint64_t tile, std::vector<const PieceFace*>& open, Part& part) const {
    const LatticePoint t{std::int32_t(tile % tiles_[0]), std::int32_t(tile / tiles_[0] % tiles_[1]),
                         std::int32_t(tile / tiles_[0] / tiles_[1])};
    const std::uint32_t own = inside_.entry(t);
    if (own == InsidePieces::kNone || buried(t)) return;
    std::array<std::uint32_t, 6> next{};
    for (std::size_t face = 0; face < 6; ++face) {
      LatticePoint n = t;
      n[face / 2] += face % 2 ? 1 : -1;
      next[face] = inside_.entry(n);
    }
    Vec3 corner;  // exact: a grid has at most 2^30 voxels along an axis
    for (std::size_t a = 0; a < 3; ++a) corner[a] = double(t[a]) * resolution_[a];
    const std::size_t begin = part.colors.size(), mask = part.masks.size();
    part.masks.resize(mask + map_.mask_bytes());
    for (std::size_t v = 0; v < map_.voxels_per_brick(); ++v) {
      open.clear();
      for (const PieceFace* face = faces_.begin(v); face != faces_.end(v); ++face)
        if (inside_.has(own, face->own) && !inside_.has(face->across ? next[face->face] : own, face->other))
          open.push_back(face);
      if (open.empty()) continue;
      part.masks[mask + v / 8] |= std::uint8_t(1u << v % 8);
      part.colors.push_back(mean_color(open, corner));
    }
    if (part.colors.size() == begin) {
      part.masks.resize(mask);
      return;
    }
    part.tiles.push_back(tile);
    part.counts.push_back(std::uint32_t(part.colors.size() - begin));
  }

 private:
  [[nodiscard]] bool buried(const LatticePoint& t) const {
    for (std::int32_t z = -1; z <= 1; ++z)
      for (std::int32_t y = -1; y <= 1; ++y)
        for (std::int32_t x = -1; x <= 1; ++x)
          if (inside_.entry({t[0] + x, t[1] + y, t[2] + z}) != InsidePieces::kAll) return false;
    return true;
  }

  [[nodiscard]] Rgb8 mean_color(const std::vector<const PieceFace*>& open, Vec3 corner) const {
    const std::size_t samples = std::min(open.size(), kMostSamples);
    Vec3 sum;
    for (std::size_t k = 0; k < samples; ++k) {
      const PieceFace& face = *open[(2 * k + 1) * open.size() / (2 * samples)];
      Vec3 at = corner;
      for (std::size_t a = 0; a < 3; ++a)
        at[a] += face.voxel[a] + (a != face.face / 2u ? 0.5 : face.face % 2 ? 1.0 : 0.0);
      sum = sum + field_(at);
    }
    return linear_to_srgb8(sum / double(samples));
  }

  InsideTiles inside_;
  Index3 tiles_, resolution_;
  const ColorField& field_;
  const SurfaceColors& map_;
  const PieceFaces& faces_;
};

}  // namespace

Result<std::optional<SurfaceColors>> make_surface_colors(const CellObject& object, const ColorField& field,
                                                         const Index3& resolution, unsigned threads,
                                                         const Progress* progress) {
  SurfaceColors map;
  for (std::size_t a = 0; a < 3; ++a) {
    if (resolution[a] < 1 || resolution[a] > SurfaceColors::kMaxResolution)
      return Error{ErrorCode::kUsage, "a tile has 1 to " + std::to_string(SurfaceColors::kMaxResolution) +
                                          " color voxels along an axis"};
    map.resolution[a] = std::min(resolution[a], object.tile.resolution[a]);
  }
  const std::uint64_t most_bytes = ReadLimits{}.max_decoded_bytes / 2;
  const PieceFaces faces(object.tile, map, std::size_t(most_bytes / sizeof(PieceFace)));
  if (!faces.fit())
    return Error{ErrorCode::kLimit,
                 "the tile's cells have too many faces for colors at the surface; use a coarser tile"};
  const Baker baker(object, field, map, faces);
  const std::uint64_t tile_count = object.grid.tile_count();
  std::vector<Part> parts(std::size_t((tile_count + kBlockTiles - 1) / kBlockTiles));
  std::atomic<std::uint64_t> bytes = 0;
  const bool done = parallel_for(
      parts.size(), threads,
      [&](std::size_t block, unsigned) {
        std::vector<const PieceFace*> open;
        Part& part = parts[block];
        const std::uint64_t end = std::min<std::uint64_t>(tile_count, (block + 1) * kBlockTiles);
        for (std::uint64_t t = block * kBlockTiles; t < end; ++t) {
          if (bytes > most_bytes || (progress && progress->cancelled())) return;
          baker.bake(t, open, part);
        }
        bytes += part.masks.size() + part.colors.size() * sizeof(Rgb8);
      },
      progress, "baking colors");
  if (!done || (progress && progress->cancelled())) return Error{ErrorCode::kCancelled, "interrupted"};
  if (bytes > most_bytes)
    return Error{ErrorCode::kLimit,
                 "the surface takes too many colors; bake with fewer color voxels or use fewer tiles"};
  map.entries.assign(std::size_t(tile_count), SurfaceColors::kNoBrick);
  for (Part& part : parts) {
    std::uint32_t first = std::uint32_t(map.colors.size());
    for (std::size_t k = 0; k < part.tiles.size(); ++k) {
      map.entries[std::size_t(part.tiles[k])] = std::uint32_t(map.first.size());
      map.first.push_back(first);
      first += part.counts[k];
    }
    map.masks.insert(map.masks.end(), part.masks.begin(), part.masks.end());
    map.colors.insert(map.colors.end(), part.colors.begin(), part.colors.end());
    part = {};
  }
  if (map.first.empty()) return std::optional<SurfaceColors>();
  return std::optional(std::move(map));
}

}  // namespace mesocell
