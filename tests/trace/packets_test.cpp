#include "sdk/trace/packets.h"

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "sdk/core/rng.h"
#include "sdk/shade/camera.h"
#include "sdk/trace/cell_scene.h"
#include "sdk/trace/exact.h"
#include "tests/support/catch.h"
#include "tests/support/guarded_copy.h"
#include "tests/support/objects.h"
#include "tests/support/sanitized.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

bool same_bits(const StreamHit& a, const StreamHit& b) {
  return std::bit_cast<std::uint64_t>(a.t) == std::bit_cast<std::uint64_t>(b.t) && a.element == b.element &&
         a.label == b.label && a.face == b.face;
}

/// Checks that first_hits() equals first_hit() to the last bit; returns how many rays hit.
std::size_t check(const Caster& caster, std::span<const Ray> rays) {
  std::vector<StreamHit> hits(rays.size());
  for (StreamHit& hit : hits) hit.label = 77;  // all must be written
  caster.first_hits(rays, hits);
  std::size_t count = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    Hit hit;
    const StreamHit truth = caster.first_hit(rays[k], hit) ? to_stream_hit(hit) : StreamHit{};
    if (!same_bits(hits[k], truth)) {
      const Ray& r = rays[k];
      INFO("ray " << k << ": " << r.origin.x << ' ' << r.origin.y << ' ' << r.origin.z << " to "
                  << r.direction.x << ' ' << r.direction.y << ' ' << r.direction.z << ", t " << hits[k].t
                  << " for " << truth.t);
      REQUIRE(same_bits(hits[k], truth));
    }
    count += truth.hit();
  }
  return count;
}

/// Lets packets be traced by one set of vector instructions, until it goes.
struct InstructionSet {
  explicit InstructionSet(std::int64_t target) { choose(target); }
  InstructionSet(const InstructionSet&) = delete;
  InstructionSet& operator=(const InstructionSet&) = delete;
  ~InstructionSet() { choose(0); }

  static void choose(std::int64_t target) {  // 0: what the machine has
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

/// Runs `body` with each set of vector instructions that this machine has.
template <class Body>
void with_each_instruction_set(Body&& body) {
  for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    const InstructionSet set(target);
    INFO("with " << hwy::TargetName(target));
    body();
  }
}

Vec3 random_point(Rng& rng, const Box3& box, double room) {
  Vec3 p;
  for (std::size_t a = 0; a < 3; ++a) {
    const double wide = room * (box.max[a] - box.min[a]);
    p[a] = rng.uniform(box.min[a] - wide, box.max[a] + wide);
  }
  return p;
}

/// A square of 8 × 8 pixels somewhere in a picture.
std::vector<Ray> square_of_pixels(Rng& rng, const Box3& box) {
  CameraOptions options;
  options.eye = random_point(rng, box, rng.below(2) ? 1 : 0);
  options.look = random_point(rng, box, 0);
  const std::size_t axis = rng.below(3);
  if (rng.below(3) == 0) {  // along an axis, so that slopes of the square's rays have both signs
    for (std::size_t a = 0; a < 3; ++a)
      if (a != axis) (*options.look)[a] = (*options.eye)[a];
    if ((*options.look)[axis] == (*options.eye)[axis]) (*options.look)[axis] += 1;
  }
  options.up = Vec3{};
  (*options.up)[(axis + 1) % 3] = 1;
  options.fov_degrees = rng.uniform(5, 120);
  const std::uint32_t width = 8 << rng.below(6);
  const Result<Camera> camera = Camera::make(box, options, width, width);
  REQUIRE(camera.ok());
  const double x0 = rng.below(2) ? width / 2.0 - 4 : rng.below(width - 7), y0 = rng.below(width - 7);
  std::vector<Ray> rays;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) rays.push_back(camera->ray(x0 + x + 0.5, y0 + y + 0.5));
  return rays;
}

/// Parallel rays, along an axis, a plane or neither, on edges and corners of voxels or within them.
std::vector<Ray> parallel_rays(Rng& rng, const Box3& box) {
  Vec3 direction, u, v;
  const std::size_t axis = rng.below(3);
  const std::uint32_t zeros = rng.below(3);
  for (std::size_t a = 0; a < 3; ++a)
    direction[a] = a == axis                                           ? (rng.below(2) ? 1 : -1)
                   : zeros == 2 || (zeros == 1 && a == (axis + 1) % 3) ? (rng.below(2) ? 0.0 : -0.0)
                                                                       : rng.uniform(-1, 1);
  u[(axis + 1) % 3] = std::ldexp(1.0, 1 - int(rng.below(6)));
  v[(axis + 2) % 3] = std::ldexp(1.0, 1 - int(rng.below(6)));
  Vec3 corner = random_point(rng, box, 0.25);
  if (rng.below(2))
    for (std::size_t a = 0; a < 3; ++a) corner[a] = std::floor(corner[a]) + (rng.below(2) ? 0.5 : 0);
  if (rng.below(3) == 0) corner[axis] = rng.below(2) ? box.min[axis] : box.max[axis];
  std::vector<Ray> rays;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) rays.push_back({corner + u * x + v * y, direction});
  return rays;
}

std::vector<Ray> rays_anywhere(Rng& rng, const Box3& box) {
  std::vector<Ray> rays(64);
  for (Ray& ray : rays) {
    ray.origin = random_point(rng, box, 0.5);
    for (std::size_t a = 0; a < 3; ++a) {
      if (rng.below(4) == 0) ray.origin[a] = std::floor(ray.origin[a]);
      if (rng.below(12) == 0) ray.origin[a] = rng.below(2) ? box.min[a] : box.max[a];
      ray.direction[a] = rng.below(8) == 0   ? 0
                         : rng.below(4) == 0 ? double(rng.below(5)) - 2
                                             : rng.uniform(-1, 1);
      if (rng.below(16) == 0) ray.direction[a] = std::ldexp(ray.direction[a], -int(rng.below(200)));
    }
    if (rng.below(8) == 0) ray.direction = ray.direction * std::ldexp(1.0, int(rng.below(400)) - 200);
  }
  return rays;
}

/// A ray that is none, or one that only the exact walk may trace.
Ray odd_ray(Rng& rng, const Ray& from) {
  static const double kOdd[] = {std::nan(""), kInf,     -kInf, 5e-324,   -5e-324, 1e-310, 0x1p-130,
                                0x1p-128,     0x1p-101, 1e300, -1.7e308, 1e308,   0x1p41, 0x1p46,
                                0x1p47,       -0.0,     0.0,   0x1p-61,  0x1p61,  1};
  Ray ray = from;
  const auto odd = [&] { return kOdd[rng.below(std::uint32_t(std::size(kOdd)))]; };
  switch (rng.below(5)) {
    case 0:
      ray.direction = {};
      break;
    case 1:
      ray.direction = {odd(), odd(), odd()};
      break;
    case 2:
      ray.origin[rng.below(3)] = odd();
      break;
    case 3:
      ray.direction[rng.below(3)] = odd();
      break;
    default:  // across the others
      ray.direction[rng.below(3)] = 0;
      break;
  }
  return ray;
}

std::vector<Ray> with_odd_rays(Rng& rng, std::vector<Ray> rays) {
  for (std::uint32_t k = 1 + rng.below(6); k > 0; --k) {
    Ray& ray = rays[rng.below(std::uint32_t(rays.size()))];
    ray = odd_ray(rng, ray);
  }
  return rays;
}

std::vector<Ray> block_of_rays(Rng& rng, const Box3& box) {
  switch (rng.below(4)) {
    case 0:
      return square_of_pixels(rng, box);
    case 1:
      return parallel_rays(rng, box);
    case 2:
      return rays_anywhere(rng, box);
    default:
      return with_odd_rays(rng, rng.below(2) ? square_of_pixels(rng, box) : parallel_rays(rng, box));
  }
}

std::size_t check_blocks(const CellObject& object, std::uint64_t seed, std::size_t blocks) {
  const auto caster = make_exact_caster(object);
  Rng rng(seed);
  std::size_t hits = 0;
  for (std::size_t k = 0; k < blocks; ++k) {
    INFO("block " << k);
    hits += check(*caster, block_of_rays(rng, caster->object_box()));
  }
  return hits;
}

struct Case {
  const char* recipe;
  Index3 tiles;
};
constexpr Case kCases[] = {
    {"voronoi:cells=40,resolution=4,seed=1", {9, 7, 8}},    // tiles of one block
    {"voronoi:cells=20,resolution=8,seed=1", {5, 4, 6}},    // no cubes for packets
    {"spheres:cells=20,resolution=16,seed=2", {5, 6, 4}},   // flat cubes
    {"voronoi:cells=150,resolution=32,seed=3", {3, 4, 3}},  // four bytes a voxel
    {"voronoi:cells=40,resolution=64,seed=4", {3, 3, 4}},   // cubes, not flat
    {"voronoi:cells=60,resolution=33,seed=5", {3, 3, 3}},   // padded, not flat
    {"voronoi:cells=30,resolution=7x9x5,seed=6", {5, 4, 6}},
    {"spheres:cells=20,resolution=13x20x11,seed=7", {4, 3, 5}},
    {"voronoi:cells=30,resolution=1024x4x4,seed=8", {2, 9, 8}},
    {"voronoi:cells=30,resolution=8x600x12,seed=9", {8, 2, 5}},
    {"spheres:cells=30,resolution=20,seed=10", {1, 1, 1}},
};

}  // namespace

TEST_CASE("packets find what single rays find, to the last bit") {
  std::uint64_t seed = 0;
  for (const Case& c : kCases)
    for (const double share : {0.05, 0.5}) {
      Rng rng(++seed);
      INFO(c.recipe << ", share " << share);
      const CellObject object = random_object(rng, c.recipe, c.tiles, share);
      with_each_instruction_set([&] {
        const std::size_t blocks = repetitions(60), hits = check_blocks(object, seed, blocks);
        CHECK(hits < blocks * 64);
        if (share > 0.1) CHECK(hits > 2 * blocks);
      });
    }
}

TEST_CASE("streams of every length are written whole") {
  Rng rng(1);
  const CellObject object = random_object(rng, kCases[2].recipe, {5, 6, 4}, 0.3);
  const auto caster = make_exact_caster(object);
  std::vector<Ray> rays;
  for (int k = 0; k < 3; ++k)
    for (const Ray& ray : square_of_pixels(rng, caster->object_box())) rays.push_back(ray);
  std::size_t hits = 0;
  for (std::size_t first = 0; first < 3; ++first)
    for (std::size_t count = 0; count <= 130; ++count)
      hits += check(*caster, std::span<const Ray>(rays).subspan(first, count));
  CHECK(hits > 1000);
}

TEST_CASE("a ray across a beam is traced, though one that is none stands beside it") {
  // The ray across has slopes without end, the one that is none has slopes that are no numbers; neither may
  // hide the other from the bounds of the beam.
  const CellObject object = make_blocks({8, 8, 8}, 16, [](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return x == 7 && y > 3 && z < 4;
  });
  with_each_instruction_set([&] {
    const auto caster = make_exact_caster(object);
    const Ray along{{10.5, 10.25, 80.5}, {0.01, 0.01, 1}}, across{{10.5, 100.25, 30.5}, {1, 0, 0}};
    const Ray none{{10.5, 10.25, 80.5}, {0, 0, 0}}, no_origin{{10.5, std::nan(""), 80.5}, {0.01, 0.01, 1}};
    for (const Ray& odd : {none, no_origin})
      for (std::size_t i = 1; i < 64; ++i)
        for (std::size_t j = 1; j < 64; j += sanitized() ? 7 : 1) {
          if (i == j) continue;
          std::vector<Ray> rays(64, along);
          rays[i] = across;
          rays[j] = odd;
          INFO("across " << i << ", none " << j);
          REQUIRE(check(*caster, rays) == 1);
        }
  });
}

TEST_CASE("packets in grids as long as they may be, and longer") {
  for (const std::uint32_t resolution : {4u, 5u, 16u, 1000u, 1024u})
    for (const std::size_t axis : {0, 2}) {
      const std::uint32_t fits = ((1u << 22) - 1) / resolution;
      for (const std::uint32_t tiles : {fits, fits + 1}) {
        Index3 size{1, 1, 1};
        size[axis] = tiles;
        CellObject object = make_blocks(size, 4, [](auto...) { return false; });
        object.tile.resolution[axis] = resolution;
        object.tile.voxel_ids.assign(object.tile.voxel_count(), 1);
        for (std::size_t k = 0; k < tiles; k += 3) object.membership.entries[k] = std::uint32_t(Tag::kInside);
        object.membership.entries.back() = std::uint32_t(Tag::kInside);
        const CellScene scene(object);
        PacketScene packets;
        INFO(tiles << " tiles of " << resolution);
        REQUIRE(scene.packets(packets) == (tiles == fits));
        const auto caster = make_exact_caster(object);
        Rng rng(resolution);
        const double longest = double(tiles) * resolution;
        std::size_t hits = 0;
        for (int k = 0; k < 30; ++k) {
          std::vector<Ray> rays(64);
          const bool near_end = rng.below(2);
          for (Ray& ray : rays) {
            for (std::size_t a = 0; a < 3; ++a) {
              ray.origin[a] = rng.uniform(-1, 5);
              ray.direction[a] = rng.uniform(-1, 1) * (k % 2 ? 1 : 1e-3);
            }
            ray.origin[axis] = near_end ? longest + rng.uniform(-3000, 10) : rng.uniform(-10, longest);
            ray.direction[axis] = rng.uniform(-1, 1);
          }
          hits += check(*caster, rays);
        }
        CHECK(hits > 200);
      }
    }
}

TEST_CASE("packets in grids of which nothing is INSIDE, and all") {
  for (const Tag tag : {Tag::kOutside, Tag::kInside})
    for (const Case& c : {kCases[0], kCases[2], kCases[10]}) {
      Rng rng(3);
      CellObject object = random_object(rng, c.recipe, c.tiles, 0);
      for (std::uint32_t& entry : object.membership.entries) entry = std::uint32_t(tag);
      INFO(c.recipe);
      const std::size_t hits = check_blocks(object, 4, repetitions(200));
      CHECK((hits > 0) == (tag == Tag::kInside));
    }
}

TEST_CASE("packets in metres, where the grid is not at the origin") {
  Rng rng(5);
  CellObject object = random_object(rng, kCases[1].recipe, kCases[1].tiles, 0.3);
  object.grid.box_min = {-3.7, 1e5, 0.3};
  object.grid.voxel_edge = 0.0123;
  CHECK(check_blocks(object, 6, 500) > 500);
}

TEST_CASE("packets read their tables and no byte beyond") {
  for (const Case& c : kCases) {
    Rng rng(1);
    const CellObject object = random_object(rng, c.recipe, c.tiles, 0.5);
    const CellScene scene(object);
    PacketScene packets;
    REQUIRE(scene.packets(packets));
    const InsidePieces inside(object.tile, object.membership);
    const TileBlocks blocks(object.tile);
    std::vector<GuardedCopy> copies;
    const auto guard = [&](auto*& table, std::size_t count) {
      copies.emplace_back(table, count * sizeof *table);
      table = static_cast<std::remove_reference_t<decltype(table)>>(copies.back().data());
    };
    copies.reserve(7);
    guard(packets.tile_records, object.grid.tile_count());
    guard(packets.parts, inside.set_count() * 8 * 64 + 3);
    guard(packets.occupied_parts, inside.set_count());
    guard(packets.block_records, blocks.records().size());
    guard(packets.bricks, blocks.bricks().size());
    guard(packets.sets, inside.sets().size());
    guard(packets.labels, object.tile.pieces.size() + 1);
    const auto caster = make_exact_caster(object);
    with_each_instruction_set([&] {
      if (!packets_supported()) return;
      INFO(c.recipe);
      Rng own(2);
      std::size_t undecided = 0, traced = 0;
      for (std::size_t k = 0; k < repetitions(200); ++k) {
        const std::vector<Ray> rays =
            k % 2 ? square_of_pixels(own, scene.object_box()) : block_of_rays(own, scene.object_box());
        std::vector<StreamHit> hits(rays.size()), truth(rays.size());
        caster->first_hits(rays, truth);
        std::uint64_t steps = 0;
        const std::uint64_t left = trace_packets(packets, rays, hits.data(), &steps);
        for (std::size_t r = 0; r < rays.size(); ++r)
          if (!(left >> r & 1)) REQUIRE(same_bits(hits[r], truth[r]));
        if (k % 2) undecided += std::size_t(std::popcount(left));
        if (k % 2) traced += rays.size();
      }
      // Nearly all rays of pictures are decided without the exact walk.
      CHECK(undecided * 50 < traced);
    });
  }
}
