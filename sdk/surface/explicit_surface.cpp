#include "sdk/surface/explicit_surface.h"

#include <algorithm>
#include <limits>
#include <string>

#include "sdk/core/parallel.h"
#include "sdk/surface/inside_tiles.h"
#include "sdk/surface/surface_attributes.h"
#include "sdk/surface/tile_contacts.h"
#include "sdk/surface/voxel_mesher.h"

namespace mesocell {
namespace {

Error cancelled() { return Error{ErrorCode::kCancelled, "cancelled"}; }

Result<TileBox> box_of(const CellObject& object, const SurfaceOptions& options) {
  if (!options.tiles) return TileBox{{0, 0, 0}, object.grid.tiles};
  const TileBox& box = *options.tiles;
  for (std::size_t a = 0; a < 3; ++a)
    if (box.begin[a] >= box.end[a] || box.end[a] > object.grid.tiles[a])
      return Error{ErrorCode::kUsage, "the box of tiles is empty or not in the grid, which has " +
                                          std::to_string(object.grid.tiles[0]) + " x " +
                                          std::to_string(object.grid.tiles[1]) + " x " +
                                          std::to_string(object.grid.tiles[2]) + " tiles"};
  return box;
}

Result<std::uint64_t> count_faces(const InsideTiles& tiles, unsigned threads, const Progress* progress) {
  const TileContacts contacts(tiles.tile());
  const TileBox& box = tiles.box();
  std::vector<std::uint64_t> layers(box.end[2] - box.begin[2], 0);
  const bool done = parallel_for(
      layers.size(), threads,
      [&](std::size_t z, unsigned) {
        LatticePoint t{0, 0, std::int32_t(box.begin[2] + z)};
        for (t[1] = std::int32_t(box.begin[1]); t[1] < std::int32_t(box.end[1]); ++t[1])
          for (t[0] = std::int32_t(box.begin[0]); t[0] < std::int32_t(box.end[0]); ++t[0])
            layers[z] += tiles.count_own_faces(contacts, t);
      },
      progress, "counting faces");
  if (!done) return cancelled();
  std::uint64_t faces = 0;
  for (const std::uint64_t layer : layers) faces += layer;
  return faces;
}

/// A tile, or one just beyond the upper borders of the box, that may have vertices. It has those of its
/// points that are not on its upper borders.
struct ActiveTile {
  std::uint64_t key;  ///< z, y, x in turn
  LatticePoint place;
  std::uint64_t first_square = 0;
  std::uint32_t first_vertex = 0;
};

class UnionMesher {
 public:
  UnionMesher(const InsideTiles& tiles, unsigned threads, const Progress* progress)
      : tiles_(tiles), threads_(threads), progress_(progress) {
    for (std::size_t a = 0; a < 3; ++a) {
      begin_[a] = std::int32_t(tiles.box().begin[a]);
      size_[a] = std::int32_t(tiles.box().end[a]) - begin_[a] + 1;
      resolution_[a] = std::int32_t(tiles.tile().resolution[a]);
    }
    for (LatticePoint d{}; d[2] < size_[2]; ++d[2])
      for (d[1] = 0; d[1] < size_[1]; ++d[1])
        for (d[0] = 0; d[0] < size_[0]; ++d[0])
          if (active(place(d))) active_.push_back({key(place(d)), place(d), 0, 0});
  }

  Result<ExplicitSurface> mesh() {
    ExplicitSurface surface;
    if (!make_vertices(surface) || !make_squares(surface)) return cancelled();
    return surface;
  }

 private:
  [[nodiscard]] LatticePoint place(const LatticePoint& d) const {
    return {begin_[0] + d[0], begin_[1] + d[1], begin_[2] + d[2]};
  }
  [[nodiscard]] std::uint64_t key(const LatticePoint& t) const {
    return std::uint64_t(t[0] - begin_[0]) +
           std::uint64_t(size_[0]) *
               (std::uint64_t(t[1] - begin_[1]) + std::uint64_t(size_[1]) * std::uint64_t(t[2] - begin_[2]));
  }

  /// Whether the surface can pass by points of the tile, or faces of its voxels can be on it.
  [[nodiscard]] bool active(const LatticePoint& t) const {
    bool any = false, full = true;
    for (std::int32_t d = 0; d < 8; ++d) {
      const std::uint32_t entry = tiles_.entry({t[0] - (d & 1), t[1] - (d >> 1 & 1), t[2] - (d >> 2)});
      any = any || entry != InsidePieces::kNone;
      full = full && tiles_.full(entry);
    }
    if (!full) return any;
    for (std::size_t a = 0; a < 3; ++a) {
      LatticePoint next = t;
      ++next[a];
      if (!tiles_.full(tiles_.entry(next))) return true;
    }
    return false;
  }

  [[nodiscard]] LatticePoint to_grid(const LatticePoint& t, const LatticePoint& point) const {
    return {t[0] * resolution_[0] + point[0], t[1] * resolution_[1] + point[1],
            t[2] * resolution_[2] + point[2]};
  }

  bool make_vertices(ExplicitSurface& surface) {
    std::vector<std::vector<LatticePoint>> made(active_.size());
    std::vector<std::uint64_t> split(active_.size(), 0);
    std::vector<PaddedVoxels> voxels(resolve_threads(threads_));
    const bool done = parallel_for(
        active_.size(), threads_,
        [&](std::size_t k, unsigned worker) {
          tiles_.fill(active_[k].place, voxels[worker]);
          VoxelMesher::each_vertex(voxels[worker], resolution_,
                                   [&](const LatticePoint& p, unsigned fans, bool) {
                                     made[k].insert(made[k].end(), fans, to_grid(active_[k].place, p));
                                     split[k] += fans - 1;
                                   });
          made[k].shrink_to_fit();
        },
        progress_, "making vertices");
    if (!done) return false;
    std::size_t count = 0;
    for (std::size_t k = 0; k < made.size(); ++k) {
      active_[k].first_vertex = std::uint32_t(count);
      count += made[k].size();
      surface.split_vertices += split[k];
    }
    surface.vertices.reserve(count);
    for (std::vector<LatticePoint>& part : made) {
      surface.vertices.insert(surface.vertices.end(), part.begin(), part.end());
      std::vector<LatticePoint>().swap(part);
    }
    return true;
  }

  /// Finds vertices of the tile's points, those on its upper borders among those of the next tiles.
  class Numbers {
   public:
    Numbers(const UnionMesher& mesher, std::size_t tile, const std::vector<LatticePoint>& vertices)
        : mesher_(mesher), vertices_(vertices), next_(mesher.active_[tile].first_vertex) {
      for (unsigned d = 0; d < 8; ++d) {
        LatticePoint t = mesher.active_[tile].place;
        for (unsigned a = 0; a < 3; ++a) t[a] += std::int32_t(d >> a & 1);
        // Out of the grid of keys there is nothing, and nothing looks there.
        const std::uint64_t key = mesher.key(t);
        const auto found = std::lower_bound(mesher.active_.begin(), mesher.active_.end(), key,
                                            [](const ActiveTile& x, std::uint64_t y) { return x.key < y; });
        if (found == mesher.active_.end() || found->key != key) continue;
        begin_[d] = found->first_vertex;
        end_[d] = found + 1 == mesher.active_.end() ? std::uint32_t(vertices.size()) : found[1].first_vertex;
      }
      tile_ = mesher.active_[tile].place;
    }

    std::uint32_t operator()(const LatticePoint& p, unsigned fans) {
      unsigned owner = 0;
      for (unsigned a = 0; a < 3; ++a) owner |= unsigned(p[a] == mesher_.resolution_[a]) << a;
      if (owner == 0) {
        const std::uint32_t first = next_;
        next_ += fans;
        return first;
      }
      const LatticePoint at = mesher_.to_grid(tile_, p);
      const auto found =
          std::lower_bound(vertices_.begin() + begin_[owner], vertices_.begin() + end_[owner], at,
                           [](const LatticePoint& x, const LatticePoint& y) {
                             return x[2] != y[2] ? x[2] < y[2] : x[1] != y[1] ? x[1] < y[1] : x[0] < y[0];
                           });
      return std::uint32_t(found - vertices_.begin());
    }

   private:
    const UnionMesher& mesher_;
    const std::vector<LatticePoint>& vertices_;
    LatticePoint tile_{};
    std::uint32_t next_;
    std::array<std::uint32_t, 8> begin_{}, end_{};
  };

  bool make_squares(ExplicitSurface& surface) {
    const TileContacts contacts(tiles_.tile());
    std::uint64_t count = 0;
    for (ActiveTile& tile : active_) {
      tile.first_square = count;
      count += tiles_.count_own_faces(contacts, tile.place);
    }
    surface.squares.resize(std::size_t(count));
    std::vector<PaddedVoxels> voxels(resolve_threads(threads_));
    std::vector<VoxelMesher> meshers(voxels.size());
    return parallel_for(
        active_.size(), threads_,
        [&](std::size_t k, unsigned worker) {
          const std::uint64_t end = k + 1 < active_.size() ? active_[k + 1].first_square : count;
          if (active_[k].first_square == end) return;
          tiles_.fill(active_[k].place, voxels[worker]);
          Numbers numbers(*this, k, surface.vertices);
          auto* out = surface.squares.data() + active_[k].first_square;
          meshers[worker].mesh(
              voxels[worker], [&](const LatticePoint& p, unsigned fans) { return numbers(p, fans); },
              [&](const std::array<std::uint32_t, 4>& corners, std::size_t) { *out++ = corners; });
        },
        progress_, "making faces");
  }

  const InsideTiles& tiles_;
  unsigned threads_;
  const Progress* progress_;
  LatticePoint begin_{}, size_{}, resolution_{};
  std::vector<ActiveTile> active_;
};

}  // namespace

SquareFace face_of_square(const ExplicitSurface& surface, std::size_t square) {
  const auto& s = surface.squares[square];
  const auto &first = surface.vertices[s[0]], &second = surface.vertices[s[1]],
             &opposite = surface.vertices[s[2]];
  std::size_t axis = 0;
  while (first[axis] != opposite[axis]) ++axis;
  const bool up = second[(axis + 1) % 3] != first[(axis + 1) % 3];
  SquareFace out{first, int(2 * axis + up)};
  out.voxel[axis] -= up;
  return out;
}

Result<std::uint64_t> count_surface_faces(const CellObject& object, const SurfaceOptions& options,
                                          const Progress* progress) {
  const Result<TileBox> box = box_of(object, options);
  if (!box) return box.error();
  return count_faces(InsideTiles(object, *box), options.threads, progress);
}

Result<ExplicitSurface> make_explicit_surface(const CellObject& object, const SurfaceOptions& options,
                                              const Progress* progress) {
  const Result<TileBox> box = box_of(object, options);
  if (!box) return box.error();
  if (options.normals == SurfaceNormals::kStored && !object.normals)
    return Error{ErrorCode::kUsage, "the object has no map of normals"};
  const InsideTiles tiles(object, *box);
  const Result<std::uint64_t> faces = count_faces(tiles, options.threads, progress);
  if (!faces) return faces.error();
  // So that numbers of vertices, of which each has at least three squares, fit 32 bits.
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  const std::uint64_t bytes_each =
      16 + 24 + (options.colors ? 15 : 0) + (options.normals != SurfaceNormals::kNone ? 24 : 0);
  if (*faces > std::min(options.max_faces, kMost))
    return Error{ErrorCode::kLimit,
                 "the surface has " + std::to_string(*faces) + " faces of voxels, " +
                     std::to_string(2 * *faces) + " triangles, which take about " +
                     std::to_string((*faces * bytes_each >> 20) + 1) + " MiB, and " +
                     std::to_string(std::min(options.max_faces, kMost)) +
                     " faces are allowed; allow more, or take a box of tiles or an object of fewer voxels"};
  Result<ExplicitSurface> surface = UnionMesher(tiles, options.threads, progress).mesh();
  if (!surface) return surface;
  const Status added = add_attributes(object, options, *surface, progress);
  if (!added) return added.error();
  return surface;
}

}  // namespace mesocell
