#include "converters/stability/methods/openvdb_module.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdio>
#include <optional>

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
static_assert(Leaf::DIM == 8, "eight voxels are a byte of a row");

/// Copies signs, a leaf of the tree at a time; where there is none a constant fills its place.
void copy_signs(const openvdb::FloatGrid& grid, const MesocellVdbVoxels& voxels) {
  const auto leaves = [](uint32_t n) { return int(n / Leaf::DIM + (n % Leaf::DIM ? 1 : 0)); };
  tbb::parallel_for(0, leaves(voxels.size[2]), [&](int lz) {
    const auto accessor = grid.getConstAccessor();
    for (int ly = 0; ly < leaves(voxels.size[1]); ++ly)
      for (int lx = 0; lx < leaves(voxels.size[0]); ++lx) {
        const openvdb::Coord origin(8 * lx, 8 * ly, 8 * lz);
        const Leaf* const leaf = accessor.probeConstLeaf(origin);
        const bool constant = !leaf && accessor.getValue(origin) < 0;
        if (!leaf && !constant) continue;
        const uint32_t count = std::min(8u, voxels.size[0] - uint32_t(8 * lx));
        for (int dz = 0; dz < 8 && uint32_t(8 * lz + dz) < voxels.size[2]; ++dz)
          for (int dy = 0; dy < 8 && uint32_t(8 * ly + dy) < voxels.size[1]; ++dy) {
            uint64_t bits = 0;
            for (uint32_t dx = 0; dx < count; ++dx) {
              // In a leaf z is fastest.
              const bool inside =
                  leaf ? leaf->getValue(openvdb::Index(int(dx) * 64 + dy * 8 + dz)) < 0 : constant;
              bits |= uint64_t{inside} << dx;
            }
            const size_t row = uint32_t(8 * ly + dy) + size_t{voxels.size[1]} * uint32_t(8 * lz + dz);
            voxels.words[row * voxels.words_per_row + uint32_t(lx) / 8] |= bits << (8 * (uint32_t(lx) % 8));
          }
      }
  });
}

void voxelize(const MesocellVdbMesh& mesh, const MesocellVdbVoxels& voxels, uint32_t threads) {
  std::optional<tbb::global_control> control;
  if (threads) control.emplace(tbb::global_control::max_allowed_parallelism, threads);
  openvdb::initialize();
  // Its samples are at whole coordinates, voxel centres half a voxel off them.
  std::vector<openvdb::Vec3s> points(mesh.vertex_count);
  for (size_t v = 0; v < points.size(); ++v)
    for (int a = 0; a < 3; ++a) points[v][a] = float(mesh.coordinates[3 * v + size_t(a)] - 0.5);
  std::vector<openvdb::Vec3I> triangles(mesh.triangle_count);
  for (size_t t = 0; t < triangles.size(); ++t)
    for (int a = 0; a < 3; ++a) triangles[t][a] = mesh.indices[3 * t + size_t(a)];
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(points, triangles);
  openvdb::util::NullInterrupter none;
  const openvdb::FloatGrid::Ptr grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      none, adapter, openvdb::math::Transform(), 3.0f, 3.0f, 0, nullptr);
  copy_signs(*grid, voxels);
}

}  // namespace

extern "C" {

__attribute__((visibility("default"))) int mesocell_vdb_voxelize(const MesocellVdbMesh* mesh,
                                                                 const MesocellVdbVoxels* voxels,
                                                                 uint32_t threads, char* message,
                                                                 size_t message_bytes) {
  try {
    voxelize(*mesh, *voxels, threads);
    return 0;
  } catch (const std::exception& exception) {
    std::snprintf(message, message_bytes, "%s", exception.what());
    return 1;
  }
}

__attribute__((visibility("default"))) uint32_t mesocell_vdb_module_version() {
  return MESOCELL_VDB_MODULE_VERSION;
}
}
