#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/helpers.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sdk/core/rng.h"
#include "sdk/surface/explicit_surface.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"
#include "tests/support/voxel_objects.h"

/// CGAL's own checks of explicit surfaces. They are of packages under the GPL, so this is a program of its own.

using namespace mesocell;
namespace pmp = CGAL::Polygon_mesh_processing;

namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

struct Checked {
  Mesh mesh;
  ExplicitSurface surface;
};

Checked check(const CellObject& o) {
  auto made = make_explicit_surface(o);
  REQUIRE(made.ok());
  std::vector<Kernel::Point_3> points;
  for (const auto& v : made->vertices) points.emplace_back(v[0], v[1], v[2]);
  std::vector<std::vector<std::size_t>> triangles;
  for (std::uint64_t k = 0; k < made->triangle_count(); ++k) {
    const Triangle t = made->triangle(k);
    triangles.push_back({t[0], t[1], t[2]});
  }
  REQUIRE(pmp::is_polygon_soup_a_polygon_mesh(triangles));
  Checked out;
  pmp::polygon_soup_to_polygon_mesh(points, triangles, out.mesh);
  REQUIRE(CGAL::is_valid_polygon_mesh(out.mesh));
  REQUIRE(CGAL::is_closed(out.mesh));
  REQUIRE(num_faces(out.mesh) == made->triangle_count());
  REQUIRE(num_vertices(out.mesh) == made->vertices.size());
  REQUIRE(pmp::volume(out.mesh) == double(count_inside_voxels(o)));
  out.surface = std::move(*made);
  return out;
}

}  // namespace

TEST_CASE("CGAL takes surfaces of 2 x 2 x 2 voxels for closed and outward-oriented meshes") {
  for (unsigned c = 1; c < 256; ++c) {
    INFO("configuration " << c);
    const auto o = test::make_voxels({1, 1, 1}, [&](auto x, auto y, auto z) {
      const unsigned dx = x - 1, dy = y - 1, dz = z - 1;
      return dx < 2 && dy < 2 && dz < 2 && (c >> (dx + 2 * dy + 4 * dz) & 1);
    });
    // Such few voxels enclose no cavity, so every component is outward.
    REQUIRE(pmp::is_outward_oriented(check(o).mesh));
  }
}

TEST_CASE("CGAL takes surfaces of random voxels and of cells for closed meshes of the voxels' volume") {
  Rng rng(11);
  for (const double share : {0.2, 0.5, 0.8})
    check(test::make_voxels({2, 2, 2}, [&](auto, auto, auto) { return rng.uniform() < share; }));
  for (const char* recipe : {"voronoi:cells=5,resolution=16,seed=3", "spheres:cells=3,resolution=16,seed=1"})
    for (const double share : {0.6, 1.0}) check(test::random_object(rng, recipe, {4, 3, 4}, share));
}

TEST_CASE("CGAL finds a solid with a cavity outward-oriented as it bounds a volume") {
  const auto o = test::make_voxels({2, 2, 2}, [](auto x, auto y, auto z) {
    return x > 0 && x < 7 && y > 0 && y < 7 && z > 0 && z < 7 && (x < 3 || x > 4 || y != 3 || z != 3);
  });
  const Checked made = check(o);
  CHECK(pmp::does_bound_a_volume(made.mesh));
  CHECK(pmp::is_outward_oriented(made.mesh));
}
