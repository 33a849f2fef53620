// The alpha wrap, a closed surface around the mesh, and what is inside of it. [Portaneri 2022]
#include "sdk/wrap/alpha_wrap.h"

#include "converters/stability/voxelizer.h"

namespace mesocell {

Status voxelize_alpha_wrap(const TriangleMesh& mesh, BitGrid& out, unsigned threads) {
  const double diagonal = length(bounding_box(mesh).extent());
  const Result<TriangleMesh> wrapped = alpha_wrap(mesh, diagonal / 20, diagonal / 600);
  if (!wrapped) return wrapped.error();
  return voxelize_ours(*wrapped, out, threads);
}

}  // namespace mesocell
