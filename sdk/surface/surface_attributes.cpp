#include "sdk/surface/surface_attributes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "format/normal_map.h"
#include "sdk/core/parallel.h"
#include "sdk/core/srgb.h"
#include "sdk/trace/cell_object_caster.h"

namespace mesocell {
namespace {

using Vec3f = std::array<float, 3>;

/// What a face has, as a ray that enters by it would be told.
struct FaceAttributes {
  Vec3 color, normal;
};

/// The stored normals by voxel of the tile.
class StoredNormals {
 public:
  explicit StoredNormals(const CellObject& object) : map_(*object.normals) {
    const std::vector<std::uint8_t> boundary = boundary_voxels(object.tile);
    constexpr std::size_t kEvery = 64;
    marks_.resize(boundary.size() / kEvery + 1);
    std::uint64_t rank = 0;
    for (std::size_t i = 0; i < boundary.size(); ++i) {
      if (i % kEvery == 0) marks_[i / kEvery].rank = rank;
      marks_[i / kEvery].bits |= std::uint64_t{boundary[i]} << (i % kEvery);
      rank += boundary[i];
    }
  }
  [[nodiscard]] Vec3 at(std::uint64_t voxel, Vec3 otherwise) const {
    const Marks& m = marks_[std::size_t(voxel / 64)];
    if (!(m.bits >> (voxel % 64) & 1)) return otherwise;
    const std::uint64_t before = m.bits & ((std::uint64_t{1} << (voxel % 64)) - 1);
    return to_vec3(
        decode_normal(map_.normals[std::size_t(m.rank + std::uint64_t(__builtin_popcountll(before)))]));
  }

 private:
  struct Marks {
    std::uint64_t bits = 0, rank = 0;
  };
  const NormalMap& map_;
  std::vector<Marks> marks_;
};

class FaceReader {
 public:
  FaceReader(const CellObject& object, const SurfaceOptions& options, const Caster& caster)
      : object_(object), options_(options), caster_(caster) {
    if (options.normals == SurfaceNormals::kStored) stored_ = std::make_unique<StoredNormals>(object);
  }

  [[nodiscard]] FaceAttributes read(const SquareFace& square) const {
    const TileMap& tile = object_.tile;
    Hit hit;
    std::array<std::uint32_t, 3> in_tile{};
    std::array<std::int64_t, 3> place{};
    Vec3 middle;
    const auto axis = std::size_t(square.face / 2);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto v = std::uint32_t(square.voxel[a]);
      hit.element[a] = v;
      in_tile[a] = v % tile.resolution[a];
      place[a] = v / tile.resolution[a];
      const double share = a == axis ? (square.face % 2 ? 1.0 : 0.0) : 0.5;
      middle[a] = object_.grid.box_min[a] + (v + share) * object_.grid.voxel_edge;
    }
    hit.face_normal[axis] = square.face % 2 ? 1 : -1;
    const std::uint64_t index = tile.voxel_index(in_tile[0], in_tile[1], in_tile[2]);
    const Piece& piece = tile.pieces[tile.id(index) - 1];
    hit.label = piece.cell;
    hit.instance = std::int64_t(object_.grid.tile_index(std::uint32_t(place[0] + piece.home[0]),
                                                        std::uint32_t(place[1] + piece.home[1]),
                                                        std::uint32_t(place[2] + piece.home[2])));
    FaceAttributes out;
    if (options_.colors) out.color = caster_.color(hit, middle);
    if (stored_)
      out.normal = stored_->at(index, hit.face_normal);
    else if (options_.normals == SurfaceNormals::kShading)
      out.normal = caster_.shading_normal(hit);
    return out;
  }

 private:
  const CellObject& object_;
  const SurfaceOptions& options_;
  const Caster& caster_;
  std::unique_ptr<StoredNormals> stored_;
};

void add(Vec3f& sum, Vec3 v) {
  for (std::size_t a = 0; a < 3; ++a) sum[a] += float(v[a]);
}

}  // namespace

Status add_attributes(const CellObject& object, const SurfaceOptions& options, ExplicitSurface& surface,
                      const Progress* progress) {
  const bool normals = options.normals != SurfaceNormals::kNone;
  if ((!options.colors && !normals) || surface.squares.empty()) return {};
  const Result<std::unique_ptr<Caster>> caster = make_cell_object_caster(object, "exact");
  if (!caster) return caster.error();
  const FaceReader reader(object, options, **caster);
  std::vector<Vec3f> colors(options.colors ? surface.vertices.size() : 0);
  std::vector<std::uint8_t> counts(colors.size(), 0);
  if (normals) surface.normals.resize(surface.vertices.size());
  // Faces are looked at in parallel and summed in turn, a part of them at a time, so that sums do not depend
  // on threads.
  constexpr std::size_t kPart = std::size_t{1} << 18, kChunk = 1024;
  std::vector<FaceAttributes> part(std::min(kPart, surface.squares.size()));
  for (std::size_t begin = 0; begin < surface.squares.size(); begin += kPart) {
    if (progress && progress->report)
      progress->report("coloring faces", double(begin) / double(surface.squares.size()));
    const std::size_t count = std::min(kPart, surface.squares.size() - begin);
    Progress inner;
    if (progress) inner.cancel = progress->cancel;
    const bool done =
        parallel_for((count + kChunk - 1) / kChunk, options.threads,
                     [&](std::size_t chunk, unsigned) {
                       for (std::size_t k = chunk * kChunk; k < std::min(count, (chunk + 1) * kChunk); ++k)
                         part[k] = reader.read(face_of_square(surface, begin + k));
                     },
                     &inner);
    if (!done) return Error{ErrorCode::kCancelled, "cancelled"};
    for (std::size_t k = 0; k < count; ++k)
      for (const std::uint32_t v : surface.squares[begin + k]) {
        if (options.colors) {
          add(colors[v], part[k].color);
          ++counts[v];
        }
        if (normals) add(surface.normals[v], part[k].normal);
      }
  }
  surface.colors.resize(colors.size());
  for (std::size_t v = 0; v < colors.size(); ++v)
    surface.colors[v] = linear_to_srgb8(Vec3{colors[v][0], colors[v][1], colors[v][2]} / counts[v]);
  if (!normals) return {};
  // Normals that balance out are those of a face.
  std::vector<std::uint8_t> zero(surface.vertices.size(), 0);
  bool any_zero = false;
  for (std::size_t v = 0; v < surface.normals.size(); ++v) {
    Vec3f& n = surface.normals[v];
    const Vec3 sum{n[0], n[1], n[2]};
    const double l = length(sum);
    if (l > 1e-3)
      n = {float(sum.x / l), float(sum.y / l), float(sum.z / l)};
    else
      zero[v] = 1;
    any_zero = any_zero || zero[v];
  }
  for (std::size_t k = 0; any_zero && k < surface.squares.size(); ++k) {
    const int face = face_of_square(surface, k).face;
    for (const std::uint32_t v : surface.squares[k])
      if (zero[v]) {
        surface.normals[v] = {};
        surface.normals[v][std::size_t(face / 2)] = face % 2 ? 1.0f : -1.0f;
      }
  }
  return {};
}

}  // namespace mesocell
