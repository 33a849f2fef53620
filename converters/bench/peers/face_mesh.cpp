#include "converters/bench/peers/face_mesh.h"

#include <algorithm>
#include <string>

namespace mesocell {
namespace {

using Voxel = std::array<std::int32_t, 3>;

/// A box of voxels, a byte each, with a layer around it that belongs to what is beyond.
class PaddedBox {
 public:
  void reset(const Voxel& size) {
    size_ = size;
    row_ = size[0] + 2;
    layer_ = row_ * (size[1] + 2);
    inside_.assign(std::size_t(layer_ * (size[2] + 2)), 0);
  }
  /// Coordinates from -1 to the size.
  [[nodiscard]] std::size_t index(const Voxel& v) const {
    return std::size_t(v[0] + 1 + row_ * (v[1] + 1) + layer_ * (v[2] + 1));
  }
  [[nodiscard]] std::uint8_t& at(const Voxel& v) { return inside_[index(v)]; }
  [[nodiscard]] const Voxel& size() const { return size_; }
  [[nodiscard]] const std::uint8_t* data() const { return inside_.data(); }
  [[nodiscard]] std::array<std::ptrdiff_t, 3> strides() const { return {1, row_, layer_}; }

 private:
  Voxel size_{};
  std::int64_t row_ = 0, layer_ = 0;
  std::vector<std::uint8_t> inside_;
};

/// Adds the faces of boxes of voxels to a mesh.
class Mesher {
 public:
  explicit Mesher(FaceMesh& mesh) : mesh_(mesh) {}

  /// The box's first voxel is `base` of the mesh. Corners are shared in the box.
  void add(const PaddedBox& box, const Voxel& base) {
    base_ = base;
    row_ = std::size_t(box.size()[0]) + 1;
    for (auto& plane : planes_) plane.assign(row_ * (std::size_t(box.size()[1]) + 1), kNone);
    const auto strides = box.strides();
    Voxel v{};
    for (v[2] = 0; v[2] < box.size()[2]; ++v[2]) {
      for (v[1] = 0; v[1] < box.size()[1]; ++v[1]) {
        v[0] = 0;
        const std::uint8_t* const row = box.data() + box.index(v);
        for (; v[0] < box.size()[0]; ++v[0]) {
          if (!row[v[0]]) continue;
          for (int face = 0; face < 6; ++face)
            if (!row[v[0] + (face & 1 ? 1 : -1) * strides[std::size_t(face / 2)]]) add_face(v, face);
        }
      }
      planes_[0].swap(planes_[1]);
      std::fill(planes_[1].begin(), planes_[1].end(), kNone);
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;

  void add_face(const Voxel& v, int face) {
    const auto axis = std::size_t(face / 2), u = (axis + 1) % 3, w = (axis + 2) % 3;
    Voxel corner{};
    corner[axis] = face & 1;
    constexpr int kAround[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (const auto& [du, dw] : kAround) {
      corner[u] = du;
      corner[w] = dw;
      mesh_.quads.push_back(corner_id(v, corner));
    }
    mesh_.faces.push_back(PackedFace({base_[0] + v[0], base_[1] + v[1], base_[2] + v[2]}, face));
  }

  std::uint32_t corner_id(const Voxel& v, const Voxel& corner) {
    std::uint32_t& id =
        planes_[std::size_t(corner[2])][std::size_t(v[0] + corner[0]) + row_ * std::size_t(v[1] + corner[1])];
    if (id == kNone) {
      id = std::uint32_t(mesh_.corners.size() / 3);
      for (std::size_t a = 0; a < 3; ++a) mesh_.corners.push_back(float(base_[a] + v[a] + corner[a]));
    }
    return id;
  }

  FaceMesh& mesh_;
  Voxel base_{};
  std::size_t row_ = 0;
  std::array<std::vector<std::uint32_t>, 2> planes_;  ///< ids of corners below and above a layer
};

/// The voxels of each cell, by the place of its home tile.
struct CellVoxels {
  std::vector<std::uint64_t> begin;  ///< of each cell's part of `voxels`; one more than cells
  std::vector<std::uint32_t> voxels;
  std::vector<Voxel> low, high;  ///< of each cell, in voxels from its home
};

class CellSorter {
 public:
  explicit CellSorter(const TileMap& tile) : tile_(tile) {}

  /// Calls body(voxel index, cell, place from home) for all that is not empty.
  template <typename Body>
  void each(const Body& body) const {
    std::uint32_t index = 0;
    for (std::uint32_t z = 0; z < tile_.resolution[2]; ++z)
      for (std::uint32_t y = 0; y < tile_.resolution[1]; ++y)
        for (std::uint32_t x = 0; x < tile_.resolution[0]; ++x, ++index)
          if (const std::uint32_t id = tile_.id(index))
            body(index, tile_.pieces[id - 1].cell - 1u, place(index, id));
  }

  [[nodiscard]] Voxel place(std::uint32_t index, std::uint32_t id) const {
    const Index3& r = tile_.resolution;
    const Voxel v{std::int32_t(index % r[0]), std::int32_t(index / r[0] % r[1]),
                  std::int32_t(index / r[0] / r[1])};
    const Piece& piece = tile_.pieces[id - 1];
    return {v[0] - piece.home[0] * std::int32_t(r[0]), v[1] - piece.home[1] * std::int32_t(r[1]),
            v[2] - piece.home[2] * std::int32_t(r[2])};
  }

  [[nodiscard]] CellVoxels sort() const {
    CellVoxels out;
    out.begin.assign(tile_.cell_count + std::size_t{2}, 0);
    out.low.assign(tile_.cell_count, {PackedFace::kLimit, PackedFace::kLimit, PackedFace::kLimit});
    out.high.assign(tile_.cell_count, {-PackedFace::kLimit, -PackedFace::kLimit, -PackedFace::kLimit});
    each([&](std::uint32_t, std::uint32_t cell, const Voxel& v) {
      ++out.begin[cell + std::size_t{2}];
      for (std::size_t a = 0; a < 3; ++a) {
        out.low[cell][a] = std::min(out.low[cell][a], v[a]);
        out.high[cell][a] = std::max(out.high[cell][a], v[a] + 1);
      }
    });
    for (std::size_t k = 2; k < out.begin.size(); ++k) out.begin[k] += out.begin[k - 1];
    out.voxels.resize(out.begin.back());
    // The place of the next one of cell c is at begin[c + 1], which so becomes the end of its part.
    each([&](std::uint32_t index, std::uint32_t cell, const Voxel&) {
      out.voxels[out.begin[cell + std::size_t{1}]++] = index;
    });
    return out;
  }

 private:
  const TileMap& tile_;
};

Error too_much(const std::string& what, std::uint64_t max_bytes) {
  return Error{ErrorCode::kLimit, what + " would take more than " + std::to_string(max_bytes >> 20) +
                                      " MiB; allow more, or take fewer voxels"};
}

/// The faces of tiles in a grid.
class UnionMesher {
 public:
  explicit UnionMesher(const CellObject& object)
      : tile_(object.tile), tiles_(object.grid.tiles), pieces_(object.tile, object.membership) {
    const std::uint64_t count = tile_.voxel_count();
    for (std::uint64_t i = 0; i < count && solid_; ++i) solid_ = tile_.id(i) != 0;
  }

  /// Whether no face of a tile is one of the union, as far as that is quickly told.
  [[nodiscard]] bool hidden(const Voxel& t) const {
    if (entry(t) == InsidePieces::kNone) return true;
    if (!solid_ || entry(t) != InsidePieces::kAll) return false;
    for (std::size_t a = 0; a < 3; ++a)
      for (const int step : {-1, 1}) {
        Voxel other = t;
        other[a] += step;
        if (entry(other) != InsidePieces::kAll) return false;
      }
    return true;
  }

  void fill(const Voxel& t, PaddedBox& box) const {
    const Voxel r{std::int32_t(tile_.resolution[0]), std::int32_t(tile_.resolution[1]),
                  std::int32_t(tile_.resolution[2])};
    box.reset(r);
    const std::uint32_t own = entry(t);
    std::uint64_t index = 0;
    for (Voxel v{}; v[2] < r[2]; ++v[2])
      for (v[1] = 0; v[1] < r[1]; ++v[1]) {
        v[0] = 0;
        for (std::uint8_t* out = &box.at(v); v[0] < r[0]; ++v[0])
          *out++ = pieces_.has(own, tile_.id(index++));
      }
    for (std::size_t a = 0; a < 3; ++a)
      for (const int step : {-1, 1}) {
        Voxel other = t;
        other[a] += step;
        fill_side(entry(other), a, step, r, box);
      }
  }

 private:
  [[nodiscard]] std::uint32_t entry(const Voxel& t) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (t[a] < 0 || t[a] >= std::int32_t(tiles_[a])) return InsidePieces::kNone;
    return pieces_.entry(std::uint64_t(t[0]) +
                         tiles_[0] * (std::uint64_t(t[1]) + std::uint64_t{tiles_[1]} * std::uint64_t(t[2])));
  }

  /// The layer of the box that is of the next tile along an axis.
  void fill_side(std::uint32_t other, std::size_t a, int step, const Voxel& r, PaddedBox& box) const {
    if (other == InsidePieces::kNone) return;
    const std::size_t u = (a + 1) % 3, w = (a + 2) % 3;
    Voxel at{}, from{};
    at[a] = step < 0 ? -1 : r[a];
    from[a] = step < 0 ? r[a] - 1 : 0;
    for (at[w] = 0; at[w] < r[w]; ++at[w])
      for (at[u] = 0; at[u] < r[u]; ++at[u]) {
        from[u] = at[u];
        from[w] = at[w];
        const auto index =
            tile_.voxel_index(std::uint32_t(from[0]), std::uint32_t(from[1]), std::uint32_t(from[2]));
        box.at(at) = pieces_.has(other, tile_.id(index));
      }
  }

  const TileMap& tile_;
  Index3 tiles_;
  InsidePieces pieces_;
  bool solid_ = true;
};

}  // namespace

Result<std::vector<FaceMesh>> make_cell_meshes(const TileMap& tile, std::uint64_t max_bytes) {
  if (tile.voxel_count() * sizeof(std::uint32_t) > max_bytes)
    return too_much("a mesh of each cell", max_bytes);
  const CellSorter sorter(tile);
  const CellVoxels cells = sorter.sort();
  std::vector<FaceMesh> meshes(tile.cell_count);
  std::uint64_t bytes = 0;
  PaddedBox box;
  for (std::uint32_t c = 0; c < tile.cell_count; ++c) {
    if (cells.begin[c] == cells.begin[c + std::size_t{1}]) continue;
    Voxel size{};
    std::uint64_t padded = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      size[a] = cells.high[c][a] - cells.low[c][a];
      padded *= std::uint64_t(size[a]) + 2;
    }
    if (padded > max_bytes) return too_much("a mesh of each cell", max_bytes);
    box.reset(size);
    for (std::uint64_t k = cells.begin[c]; k < cells.begin[c + std::size_t{1}]; ++k) {
      const std::uint32_t index = cells.voxels[k];
      Voxel v = sorter.place(index, tile.id(index));
      for (std::size_t a = 0; a < 3; ++a) v[a] -= cells.low[c][a];
      box.at(v) = 1;
    }
    Mesher(meshes[c]).add(box, cells.low[c]);
    bytes += meshes[c].memory_bytes();
    if (bytes > max_bytes) return too_much("a mesh of each cell", max_bytes);
  }
  return meshes;
}

Result<FaceMesh> make_union_mesh(const CellObject& object, const Voxel& centre, std::uint64_t max_faces) {
  for (std::size_t a = 0; a < 3; ++a)
    if (std::uint64_t{object.grid.tiles[a]} * object.tile.resolution[a] > std::uint64_t(PackedFace::kLimit))
      return Error{ErrorCode::kLimit, "a mesh of the whole surface takes at most " +
                                          std::to_string(PackedFace::kLimit) + " voxels along an axis"};
  const UnionMesher tiles(object);
  FaceMesh mesh;
  Mesher mesher(mesh);
  PaddedBox box;
  for (Voxel t{}; t[2] < std::int32_t(object.grid.tiles[2]); ++t[2])
    for (t[1] = 0; t[1] < std::int32_t(object.grid.tiles[1]); ++t[1])
      for (t[0] = 0; t[0] < std::int32_t(object.grid.tiles[0]); ++t[0]) {
        if (tiles.hidden(t)) continue;
        tiles.fill(t, box);
        Voxel base{};
        for (std::size_t a = 0; a < 3; ++a)
          base[a] = t[a] * std::int32_t(object.tile.resolution[a]) - centre[a];
        mesher.add(box, base);
        if (mesh.faces.size() > max_faces)
          return Error{ErrorCode::kLimit, "a mesh of the whole surface would take more than the " +
                                              std::to_string(max_faces) +
                                              " squares that there is room for; allow more memory, or take "
                                              "fewer tiles"};
      }
  return mesh;
}

}  // namespace mesocell
