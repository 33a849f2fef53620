#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/helpers.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "converters/import/mesh_file.h"
#include "sdk/core/rng.h"
#include "sdk/membership/winding_number.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"
#include "tests/support/shapes.h"

/// Points against CGAL's Side_of_triangle_mesh, with exact constructions: another algorithm by other people.
/// A program of its own, for that package is under the GPL.

using namespace mesocell;
using namespace mesocell::test;

namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

Mesh to_cgal(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> merged = merge_identical_vertices(mesh.vertices);
  Mesh out;
  std::vector<Mesh::Vertex_index> vertices(mesh.vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v)
    if (merged[v] == v)
      vertices[v] = out.add_vertex({mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z});
  for (const Triangle& t : mesh.triangles)
    REQUIRE(out.add_face(vertices[merged[t[0]]], vertices[merged[t[1]]], vertices[merged[t[2]]]) !=
            Mesh::null_face());
  REQUIRE(CGAL::is_closed(out));
  return out;
}

/// Anywhere in the mesh's box, a tenth larger, and beside the surface: by 1e-3 to 1e-15 of the diagonal.
std::vector<Vec3> points(const TriangleMesh& mesh, std::size_t anywhere, std::size_t near) {
  Rng rng(314);
  const Box3 box = bounding_box(mesh);
  const Vec3 extent = box.extent();
  std::vector<Vec3> all;
  for (std::size_t k = 0; k < anywhere; ++k)
    all.push_back(box.min - extent * 0.05 +
                  Vec3{extent.x * rng.uniform(), extent.y * rng.uniform(), extent.z * rng.uniform()} * 1.1);
  for (std::size_t k = 0; k < near; ++k) {
    const Triangle& t = mesh.triangles[rng.below(std::uint32_t(mesh.triangles.size()))];
    double a = rng.uniform(), b = rng.uniform();
    if (a + b > 1) {
      a = 1 - a;
      b = 1 - b;
    }
    // A third is on edges or vertices but for rounding.
    if (rng.below(6) == 0) a = 0;
    if (rng.below(6) == 0) b = a == 0 ? 0 : 1 - a;
    const Vec3 o = mesh.vertices[t[0]];
    const Vec3 on = o + (mesh.vertices[t[1]] - o) * a + (mesh.vertices[t[2]] - o) * b;
    const double off = length(extent) * std::pow(10.0, -rng.uniform(3, 15));
    all.push_back(on + Vec3{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)} * off);
  }
  return all;
}

/// How many points of a mesh are compared. All of what is claimed takes minutes; a part of it is always done.
std::size_t scaled(std::size_t all) {
  const char* share = std::getenv("MESOCELL_TEST_SHARE");
  return std::size_t(double(all) * (share ? std::atof(share) : 0.01));
}

void compare(const std::string& name, const TriangleMesh& mesh) {
  const Mesh other = to_cgal(mesh);
  const WindingNumber winding(mesh);
  const std::vector<Vec3> all = points(mesh, scaled(1'000'000), scaled(100'000));
  // One thread: numbers of the kernel count their users without locks.
  const CGAL::Side_of_triangle_mesh<Mesh, Kernel> side(other);
  std::uint64_t wrong = 0, inside = 0, on = 0;
  for (const Vec3& p : all) {
    const CGAL::Bounded_side expected = side({p.x, p.y, p.z});
    if (expected == CGAL::ON_BOUNDARY) {
      ++on;
      continue;
    }
    const bool is = winding.at(p) != 0;
    wrong += is != (expected == CGAL::ON_BOUNDED_SIDE);
    inside += is;
  }
  std::printf("%s: %zu points, %zu inside, %zu on the surface, %zu wrong\n", name.c_str(), all.size(),
              std::size_t(inside), std::size_t(on), std::size_t(wrong));
  CHECK(wrong == 0);
  CHECK(inside > all.size() / 50);
}

TriangleMesh moved(TriangleMesh mesh, Vec3 by, double scale = 1) {
  for (Vec3& v : mesh.vertices) v = v * scale + by;
  return mesh;
}

TriangleMesh bumpy(double strength, std::uint32_t rings) {
  TriangleMesh mesh = make_sphere({0, 0, 0}, 1, rings);
  for (Vec3& v : mesh.vertices)
    v = v * (1 + strength * std::sin(7 * v.x) * std::sin(9 * v.y + 1) * std::sin(8 * v.z + 2));
  return mesh;
}

}  // namespace

TEST_CASE("points of generated meshes are on the side that CGAL says") {
  compare("box", make_box({-1, -2, -3}, {3, 2, 1}));
  compare("box far away", make_box({1e6, 1e6, 1e6}, {1e6 + 1, 1e6 + 2, 1e6 + 3}));
  compare("tetrahedron", make_tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  compare("sliver", make_tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1e-9}));
  compare("sphere", make_sphere({0.1, 0.2, 0.3}, 1, 40));
  compare("small sphere", moved(make_sphere({0, 0, 0}, 1, 20), {0.3, 0.3, 0.3}, 1e-6));
  compare("torus", make_torus({0, 0, 0}, 3, 1, 60, 30));
  compare("thin torus", make_torus({0, 0, 0}, 3, 0.01, 200, 6));
  compare("bumpy sphere", bumpy(0.3, 60));
  compare("flat ellipsoid", [] {
    TriangleMesh mesh = make_sphere({0, 0, 0}, 1, 50);
    for (Vec3& v : mesh.vertices) v.z *= 1e-5;
    return mesh;
  }());
}

TEST_CASE("points of real meshes are on the side that CGAL says") {
  for (const char* name : {"armadillo.obj", "spot.obj", "rocker-arm.obj", "fandisk.off", "knot1.off",
                           "lucy.ply", "knot_orig_metro.ply"}) {
    const auto path = find_data(std::string("meshes/") + name);
    if (!path) {
      WARN(name << " is not here; skipped");
      continue;
    }
    const Result<TriangleMesh> mesh = read_mesh_file(*path);
    REQUIRE(mesh.ok());
    compare(name, *mesh);
  }
}
