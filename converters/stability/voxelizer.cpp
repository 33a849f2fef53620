#include "converters/stability/voxelizer.h"

#include <algorithm>
#include <array>

namespace mesocell {
namespace {

constexpr std::array kVoxelizers = {
    Voxelizer{"parity-x", "odd numbers of crossings along x", voxelize_parity_x, nullptr},
    Voxelizer{"parity-y", "odd numbers of crossings along y", voxelize_parity_y, nullptr},
    Voxelizer{"parity-z", "odd numbers of crossings along z", voxelize_parity_z, nullptr},
    Voxelizer{"signed-count", "front faces minus back faces beyond a slice along z, in a stencil of 8 bits",
              voxelize_signed_count, nullptr},
    Voxelizer{"winding-exact", "generalized winding number over 1/2, of all triangles, double precision",
              voxelize_winding_exact, nullptr},
    Voxelizer{"winding-fast", "the same with far triangles as dipoles, beta 2", voxelize_winding_fast,
              nullptr},
    Voxelizer{"openvdb",
              "OpenVDB meshToVolume, bands of 3 voxels, no flags: inside where the distance is below 0",
              voxelize_openvdb, prepare_openvdb},
#ifdef MESOCELL_WRAP
    Voxelizer{"alpha-wrap",
              "CGAL's alpha wrap, alpha a 20th and offset a 600th of the diagonal of the mesh's box, then "
              "its inside",
              voxelize_alpha_wrap, nullptr},
#endif
    Voxelizer{"ours", "as mesocell convert --repair auto", voxelize_ours, nullptr},
};

}  // namespace

std::span<const Voxelizer> voxelizers() { return kVoxelizers; }

std::string voxelizer_names() {
  std::string names;
  for (const Voxelizer& v : kVoxelizers) names += (names.empty() ? "" : ", ") + std::string(v.name);
  return names;
}

const Voxelizer* find_voxelizer(std::string_view name) {
  const auto found = std::ranges::find(kVoxelizers, name, &Voxelizer::name);
  return found == kVoxelizers.end() ? nullptr : &*found;
}

}  // namespace mesocell
