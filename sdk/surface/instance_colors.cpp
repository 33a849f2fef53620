#include "sdk/surface/instance_colors.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <string>

#include "format/limits.h"
#include "sdk/core/parallel.h"
#include "sdk/core/srgb.h"

namespace mesocell {
namespace {

/// Tiles that are colored in one go.
constexpr std::uint64_t kBlock = 64;

/// The centre of each cell, in voxels from the corner of its instance's home tile; [0] is not used.
std::vector<Vec3> cell_centres(const TileMap& tile) {
  // At most 2^30 voxels within 2^18 of the corner: sums fit with room to spare.
  std::vector<std::array<std::int64_t, 3>> sums(tile.cell_count + 1);
  std::vector<std::int64_t> voxels(tile.cell_count + 1);
  std::uint64_t i = 0;
  Index3 v{};
  for (v[2] = 0; v[2] < tile.resolution[2]; ++v[2])
    for (v[1] = 0; v[1] < tile.resolution[1]; ++v[1])
      for (v[0] = 0; v[0] < tile.resolution[0]; ++v[0], ++i) {
        const std::uint32_t id = tile.id(i);
        if (id == 0) continue;
        const Piece& piece = tile.pieces[id - 1];
        for (std::size_t a = 0; a < 3; ++a)
          sums[piece.cell][a] += std::int64_t{v[a]} - std::int64_t{piece.home[a]} * tile.resolution[a];
        ++voxels[piece.cell];
      }
  std::vector<Vec3> centres(tile.cell_count + 1);
  for (std::uint32_t c = 1; c <= tile.cell_count; ++c) {
    assert(voxels[c] > 0);
    for (std::size_t a = 0; a < 3; ++a)
      centres[c][a] = double(2 * sums[c][a] + voxels[c]) / double(2 * voxels[c]);
  }
  return centres;
}

std::uint64_t count_inside(const MembershipMap& membership, std::uint64_t tile) {
  const std::uint32_t entry = membership.entries[tile];
  if (entry < MembershipMap::kFirstBlock) return Tag(entry) == Tag::kInside ? membership.cell_count : 0;
  std::uint64_t count = 0;
  for (std::uint32_t c = 1; c <= membership.cell_count; ++c) count += membership.tag(tile, c) == Tag::kInside;
  return count;
}

}  // namespace

Result<std::vector<Rgb8>> make_instance_colors(const CellObject& object, const ColorField& field,
                                               unsigned threads, const Progress* progress) {
  const MembershipMap& membership = object.membership;
  const Index3& tiles = object.grid.tiles;
  const std::uint64_t tile_count = object.grid.tile_count();
  std::vector<std::uint64_t> first;  // INSIDE instances before each block
  std::uint64_t count = 0;
  for (std::uint64_t t = 0; t < tile_count; ++t) {
    if (t % kBlock == 0) first.push_back(count);
    count += count_inside(membership, t);
  }
  if (count > ReadLimits{}.max_decoded_bytes / sizeof(Rgb8))
    return Error{ErrorCode::kLimit, "the object has " + std::to_string(count) +
                                        " cells inside, too many for a color each; use fewer tiles or cells"};
  std::vector<Rgb8> colors(count);
  if (count == 0) return colors;
  const std::vector<Vec3> centres = cell_centres(object.tile);
  const bool done = parallel_for(
      first.size(), threads,
      [&](std::size_t block, unsigned) {
        std::uint64_t next = first[block];
        const std::uint64_t end = std::min(tile_count, (block + 1) * kBlock);
        for (std::uint64_t t = block * kBlock; t < end; ++t) {
          if (progress && progress->cancelled()) return;
          const std::uint32_t entry = membership.entries[t];
          if (entry < MembershipMap::kFirstBlock && Tag(entry) != Tag::kInside) continue;
          const Index3 at{std::uint32_t(t % tiles[0]), std::uint32_t(t / tiles[0] % tiles[1]),
                          std::uint32_t(t / tiles[0] / tiles[1])};
          Vec3 corner;  // exact: a grid has at most 2^30 voxels along an axis
          for (std::size_t a = 0; a < 3; ++a)
            corner[a] = double(std::uint64_t{at[a]} * object.tile.resolution[a]);
          for (std::uint32_t c = 1; c <= membership.cell_count; ++c)
            if (membership.tag(t, c) == Tag::kInside)
              colors[next++] = linear_to_srgb8(field(corner + centres[c]));
        }
      },
      progress, "colors");
  if (!done || (progress && progress->cancelled())) return Error{ErrorCode::kCancelled, "interrupted"};
  return colors;
}

Result<std::vector<Rgb8>> make_instance_colors(const CellObject& object, const TriangleMesh& mesh,
                                               const SurfacePaint& paint, unsigned threads,
                                               const Progress* progress) {
  if (mesh.colors.empty() && paint.empty()) return mesh_without_colors();
  if (count_instances(object.membership).inside == 0) return std::vector<Rgb8>();
  const Result<ColorField> field = make_mesh_color_field(object.grid, mesh, paint, threads);
  if (!field) return field.error();
  return make_instance_colors(object, *field, threads, progress);
}

Result<std::vector<Rgb8>> make_instance_colors(const CellObject& object, const TriangleMesh& mesh,
                                               unsigned threads, const Progress* progress) {
  return make_instance_colors(object, mesh, SurfacePaint{}, threads, progress);
}

}  // namespace mesocell
