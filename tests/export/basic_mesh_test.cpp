#include "converters/export/basic_mesh.h"

#include <set>

#include "format/cell_object_io.h"
#include "sdk/core/rng.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"
#include "tests/support/voxel_objects.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// Through a file and the worker.
TriangleMesh through_file(const BasicMesh& mesh) {
  CellObject o = make_voxels({1, 1, 1}, [](auto, auto, auto) { return true; });
  o.basic_mesh = mesh;
  const auto bytes = encode_cell_object(o);
  REQUIRE(bytes.ok());
  const auto back = read_cell_object(*bytes);
  REQUIRE(back.ok());
  REQUIRE(back->basic_mesh == mesh);
  auto out = read_basic_mesh(*back->basic_mesh);
  if (!out) FAIL(out.error().message);
  return std::move(*out);
}

/// Each triangle of `out` is one of `in`, and the other way round, but for moves of vertices; returns the
/// largest.
double compare(const TriangleMesh& in, const TriangleMesh& out, double max_error) {
  REQUIRE(out.triangles.size() == in.triangles.size());
  REQUIRE(out.vertices.size() == in.vertices.size());
  // Of each vertex the one that it came from: the nearest, for errors are small against distances.
  std::vector<std::uint32_t> from(out.vertices.size());
  double largest = 0;
  for (std::size_t v = 0; v < out.vertices.size(); ++v) {
    double best = 1e300;
    for (std::size_t u = 0; u < in.vertices.size(); ++u)
      if (const double d = length(in.vertices[u] - out.vertices[v]); d < best) {
        best = d;
        from[v] = std::uint32_t(u);
      }
    largest = std::max(largest, best);
    REQUIRE(best <= max_error);
    if (!in.colors.empty()) REQUIRE(out.colors[v] == in.colors[from[v]]);
  }
  const auto turned = [](Triangle t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  std::multiset<Triangle> expected, found;
  for (const Triangle& t : in.triangles) expected.insert(turned(t));
  for (const Triangle& t : out.triangles) found.insert(turned({from[t[0]], from[t[1]], from[t[2]]}));
  REQUIRE(found == expected);
  return largest;
}

}  // namespace

TEST_CASE("a basic mesh comes out of a file as it went in, but for the stated error") {
  for (const Vec3 centre : {Vec3{0, 0, 0}, Vec3{1000.25, -7, 3e4}}) {
    TriangleMesh mesh = make_torus(centre, 3, 1.2, 40, 20);
    for (const bool colored : {false, true}) {
      if (colored)
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
          mesh.colors.push_back({std::uint8_t(v), std::uint8_t(v / 3), std::uint8_t(255 - v)});
      for (const int bits : {12, 20}) {
        const auto packed = compress_basic_mesh(mesh, bits);
        REQUIRE(packed.ok());
        CHECK(packed->vertices == mesh.vertices.size());
        const double moved = compare(mesh, through_file(*packed), packed->max_error);
        CHECK(moved > 0.1 * packed->max_error);  // the bound is not idle
      }
    }
  }
}

TEST_CASE("what of a mesh is no triangle is left out of the basic mesh") {
  TriangleMesh mesh = make_sphere({1, 2, 3}, 1, 8);
  const TriangleMesh clean = mesh;
  mesh.vertices.push_back({1e6, 0, 0});
  mesh.triangles.push_back({0, 0, 1});
  const auto packed = compress_basic_mesh(mesh);
  REQUIRE(packed.ok());
  CHECK(packed->max_error < 1e-5);
  compare(clean, through_file(*packed), packed->max_error);
  CHECK(compress_basic_mesh({}).error().code == ErrorCode::kInvalidInput);
  CHECK(compress_basic_mesh(mesh, 40).error().code == ErrorCode::kUsage);
}

TEST_CASE("hostile basic meshes end as errors") {
  const auto good = compress_basic_mesh(make_sphere({}, 1, 6));
  REQUIRE(good.ok());
  BasicMesh bad = *good;
  bad.draco.clear();
  CHECK(read_basic_mesh(bad).error().code == ErrorCode::kInvalidInput);
  bad = *good;
  ++bad.vertices;
  CHECK(read_basic_mesh(bad).error().code == ErrorCode::kInvalidInput);
  bad = *good;
  bad.triangles = 1;
  CHECK(read_basic_mesh(bad).error().code == ErrorCode::kInvalidInput);
  Rng rng(1);
  std::size_t refused = 0;
  for (int round = 0; round < 40; ++round) {
    bad = *good;
    if (round % 4 == 0)
      bad.draco.resize(rng.below(std::uint32_t(bad.draco.size())));
    else
      for (int k = 0; k < 1 + round % 5; ++k)
        bad.draco[rng.below(std::uint32_t(bad.draco.size()))] = std::byte(rng.bits(8));
    // Draco has no checksum: damage may go unnoticed, but what comes is a mesh.
    const auto mesh = read_basic_mesh(bad);
    refused += !mesh.ok();
    if (!mesh.ok()) continue;
    for (const Triangle& t : mesh->triangles)
      for (const std::uint32_t v : t) REQUIRE(v < mesh->vertices.size());
  }
  CHECK(refused > 10);
}
