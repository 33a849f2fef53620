#include "converters/bench/peers/vdb_module.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <string>

#include "converters/bench/peers/vdb_mask.h"

namespace mesocell {

bool VdbRay::set(const MesocellVdbRays& rays, std::uint64_t k, const std::int32_t (&size)[3]) {
  const double* r = rays.rays + 6 * k;
  double sum = 0;
  for (int n = 0; n < 6; ++n) sum += r[n];
  if (!(sum - sum == 0)) return false;  // the library's steps would not end
  t0 = 0;
  t1 = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a) {
    origin[a] = r[a] * rays.scale - rays.offset[a];
    direction[a] = r[3 + a];
    if (direction[a] == 0) {
      if (!(origin[a] >= 0 && origin[a] < size[a])) return false;
      continue;
    }
    const double inverse = 1 / direction[a], low = -origin[a] * inverse,
                 high = (size[a] - origin[a]) * inverse;
    t0 = std::max(t0, std::min(low, high));
    t1 = std::min(t1, std::max(low, high));
  }
  return t0 < t1 && t1 < std::numeric_limits<double>::infinity();
}

}  // namespace mesocell

namespace {

using mesocell::make_openvdb_mask;
using Leaf = openvdb::MaskTree::LeafNodeType;
static_assert(Leaf::DIM == 8, "a block is a leaf");

struct OverLimit {};

openvdb::MaskGrid::Ptr make_grid(const MesocellVdbInput& input) {
  const openvdb::MaskGrid::Ptr grid = openvdb::MaskGrid::create();
  openvdb::MaskTree& tree = grid->tree();
  std::uint64_t leaves = 0;
  std::int32_t origin[3] = {};
  for (origin[0] = 0; origin[0] < input.size[0]; origin[0] += 8)
    for (origin[1] = 0; origin[1] < input.size[1]; origin[1] += 8)
      for (origin[2] = 0; origin[2] < input.size[2]; origin[2] += 8) {
        std::uint64_t words[8] = {};
        const openvdb::Coord at(origin);
        switch (input.fill(input.user, origin, words)) {
          case MESOCELL_VDB_NONE:
            break;
          case MESOCELL_VDB_ALL:
            tree.addTile(1, at, true, true);
            break;
          case MESOCELL_VDB_MIXED: {
            if (++leaves * sizeof(Leaf) > input.max_bytes) throw OverLimit();
            auto* const leaf = new Leaf(at, false, false);
            openvdb::util::NodeMask<3> mask;
            for (openvdb::Index32 n = 0; n < 8; ++n) mask.getWord<openvdb::Index64>(n) = words[n];
            leaf->setValueMask(mask);
            tree.addLeaf(leaf);
          }
        }
      }
  tree.prune();
  return grid;
}

int create_mask(const MesocellVdbInput* input, MesocellVdbMask** mask, char* message, size_t message_bytes) {
  try {
    const openvdb::MaskGrid::Ptr grid = make_grid(*input);
    std::unique_ptr<MesocellVdbMask> made;
    if (!input->nano) {
      made = make_openvdb_mask(grid, input->size);
    } else {
#ifdef MESOCELL_NANOVDB
      made = mesocell::make_nanovdb_mask(grid, input->size);
#else
      std::snprintf(message, message_bytes,
                    "this program was built without NanoVDB; install libnanovdb-dev and build it again");
      return MESOCELL_VDB_FAILED;
#endif
    }
    if (made->memory_bytes() > input->max_bytes) throw OverLimit();
    *mask = made.release();
    return 0;
  } catch (const OverLimit&) {
    std::snprintf(message, message_bytes,
                  "its voxels would take more than %llu MiB; allow more, or take fewer tiles",
                  static_cast<unsigned long long>(input->max_bytes >> 20));
    return MESOCELL_VDB_LIMIT;
  } catch (const std::exception& exception) {
    std::snprintf(message, message_bytes, "%s", exception.what());
    return MESOCELL_VDB_FAILED;
  }
}

void destroy_mask(MesocellVdbMask* mask) { delete mask; }
uint64_t mask_memory(const MesocellVdbMask* mask) { return mask->memory_bytes(); }
void trace(const MesocellVdbMask* mask, const MesocellVdbRays* rays, MesocellVdbHit* hits) {
  mask->trace(*rays, hits);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const MesocellVdbPeers* mesocell_vdb_peers() {
  static constexpr MesocellVdbPeers kPeers = {MESOCELL_VDB_PEERS_VERSION,
                                              OPENVDB_LIBRARY_VERSION_STRING,
                                              create_mask,
                                              destroy_mask,
                                              mask_memory,
                                              trace};
  return &kPeers;
}
