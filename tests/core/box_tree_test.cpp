#include "sdk/core/box_tree.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "sdk/core/rng.h"
#include "tests/support/catch.h"

using namespace mesocell;

TEST_CASE("boxes that overlap a box are all visited") {
  Rng rng(1);
  // Corners on a lattice, so that many boxes touch, coincide or are flat.
  const auto box = [&](std::uint32_t size) {
    const Vec3 low{double(rng.below(20)), double(rng.below(20)), double(rng.below(20))};
    return Box3{low, low + Vec3{double(rng.below(size)), double(rng.below(size)), double(rng.below(size))}};
  };
  for (const std::size_t count : {0, 1, 5, 3000}) {
    std::vector<Box3> boxes;
    for (std::size_t k = 0; k < count; ++k) boxes.push_back(box(4));
    const BoxTree tree(boxes);
    std::size_t hits = 0;
    for (int k = 0; k < 200; ++k) {
      Box3 query = box(6);
      if (k % 4 == 0) query.max.z = std::numeric_limits<double>::infinity();
      std::vector<std::uint32_t> expected, found;
      for (std::uint32_t i = 0; i < count; ++i)
        if (overlap(boxes[i], query)) expected.push_back(i);
      tree.visit_overlapping(query, [&](std::uint32_t place) {
        if (overlap(boxes[tree.order()[place]], query)) found.push_back(tree.order()[place]);
        return true;
      });
      std::sort(found.begin(), found.end());
      REQUIRE(found == expected);
      hits += found.size();

      std::size_t visits = 0;
      tree.visit_overlapping(query, [&](std::uint32_t) { return ++visits < 3; });
      CHECK(visits <= 3);
    }
    CHECK((count < 3000 || hits > 1000));
  }
}
