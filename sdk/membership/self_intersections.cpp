#include "sdk/membership/self_intersections.h"

#include <algorithm>
#include <vector>

#include "sdk/core/box_tree.h"
#include "sdk/core/parallel.h"
#include "sdk/membership/triangle_triangle.h"

namespace mesocell {
namespace {

/// What one triangle found among those after it.
struct Search {
  std::uint64_t pairs = 0, tests = 0;
  std::uint32_t other = 0;  ///< of the first pair, its place
};

}  // namespace

SelfIntersections find_self_intersections(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                          const SelfIntersectionLimits& limits, unsigned threads,
                                          const Progress* progress) {
  std::vector<std::array<Vec3, 3>> all;
  std::vector<Box3> boxes;
  for (const Triangle& t : triangles) {
    const std::array<Vec3, 3> corners{vertices[t[0]], vertices[t[1]], vertices[t[2]]};
    if (collinear(corners[0], corners[1], corners[2])) continue;
    all.push_back(corners);
    Box3& box = boxes.emplace_back();
    for (const Vec3 corner : corners) box.add(corner);
  }
  const BoxTree tree(boxes, threads);
  const std::span<const std::uint32_t> order = tree.order();

  const Progress stop{{}, progress ? progress->cancel : nullptr};
  SelfIntersections found;
  std::uint64_t tests = 0;
  std::vector<Search> searches;
  // Batches grow, so a mesh that meets itself everywhere, or nearly does, is left after a few triangles. A
  // limit ends the search after a whole batch, whatever thread reaches it.
  for (std::size_t first = 0, size = 64; first < all.size();
       first += size, size = std::min(2 * size, 8192ul)) {
    searches.assign(std::min(size, all.size() - first), {});
    const bool done = parallel_for(
        searches.size(), threads,
        [&](std::size_t k, unsigned) {
          Search& search = searches[k];
          const std::uint32_t place = std::uint32_t(first + k), a = order[place];
          tree.visit_overlapping(boxes[a], [&](std::uint32_t other) {
            const std::uint32_t b = order[other];
            if (other <= place || !overlap(boxes[a], boxes[b])) return true;
            ++search.tests;
            if (triangles_intersect(all[a], all[b]) && search.pairs++ == 0) search.other = other;
            return search.pairs <= limits.max_pairs && search.tests <= limits.max_tests;
          });
        },
        &stop);
    for (std::size_t k = 0; k < searches.size(); ++k) {
      tests += searches[k].tests;
      if (searches[k].pairs > 0 && !found.example) {
        const Box3 &a = boxes[order[first + k]], &b = boxes[order[searches[k].other]];
        const Vec3 low = max(a.min, b.min);
        found.example = low + (min(a.max, b.max) - low) * 0.5;
      }
      found.pairs += searches[k].pairs;
    }
    if (!done || found.pairs > limits.max_pairs || tests > limits.max_tests) {
      found.pairs = std::min(found.pairs, limits.max_pairs);
      found.at_least = true;
      break;
    }
    if (progress && progress->report)
      progress->report("self-intersections", double(first + searches.size()) / double(all.size()));
  }
  return found;
}

}  // namespace mesocell
