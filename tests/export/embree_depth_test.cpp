#include <embree3/rtcore.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>

#include "converters/export/mesh_export.h"
#include "converters/import/mesh_file.h"
#include "sdk/author/cell_object.h"
#include "sdk/shade/camera.h"
#include "sdk/tiles/tile_spec.h"
#include "sdk/trace/cell_object_caster.h"
#include "tests/support/catch.h"
#include "tests/support/folder.h"
#include "tests/support/shapes.h"

/// An exported surface is traced by Embree, and depths compared with the exact caster's of the object.

using namespace mesocell;
using namespace mesocell::test;

namespace {

constexpr std::uint32_t kWidth = 256, kHeight = 192;
constexpr double kMiss = std::numeric_limits<double>::infinity();

/// A mesh in Embree, in voxels from the middle of a grid, where single precision is finest.
class EmbreeMesh {
 public:
  EmbreeMesh(const TriangleMesh& mesh, const CellObject& o) : device_(rtcNewDevice("threads=1")) {
    REQUIRE(device_);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* const at = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.vertices.size()));
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      for (std::size_t a = 0; a < 3; ++a)
        at[3 * v + a] = float((mesh.vertices[v][a] - middle(o)[a]) / o.grid.voxel_edge);
    auto* const corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                                  mesh.triangles.size());
    std::memcpy(corners, mesh.triangles.data(), 12 * mesh.triangles.size());
    rtcCommitGeometry(geometry);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~EmbreeMesh() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeMesh(const EmbreeMesh&) = delete;
  EmbreeMesh& operator=(const EmbreeMesh&) = delete;

  static Vec3 middle(const CellObject& o) {
    Vec3 m;
    for (std::size_t a = 0; a < 3; ++a)
      m[a] = o.grid.box_min[a] + double(o.grid.tiles[a] / 2 * o.tile.resolution[a]) * o.grid.voxel_edge;
    return m;
  }

  /// Of a ray in voxels from the middle.
  [[nodiscard]] double t(const std::array<float, 3>& origin, const std::array<float, 3>& direction) const {
    RTCRayHit hit{};
    hit.ray = {origin[0],
               origin[1],
               origin[2],
               0,
               direction[0],
               direction[1],
               direction[2],
               0,
               std::numeric_limits<float>::infinity(),
               0xffffffffu,
               0,
               0};
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &hit);
    return hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? kMiss : double(hit.ray.tfar);
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace

TEST_CASE("Embree's depth of an exported surface is the exact caster's") {
  const Folder folder(in_memory());
  AuthorOptions options;
  options.grid.tiles = 12;
  const auto object =
      author_cell_object(make_torus({1, 2, -3}, 1, 0.4, 96, 48),
                         *make_tile(*parse_recipe("voronoi:cells=8,resolution=32,seed=1")), options);
  REQUIRE(object.ok());
  MeshExportReport report;
  REQUIRE(write_mesh_export(*object, folder / "a.ply", {}, &report).ok());
  const auto mesh = read_mesh_file(folder / "a.ply");
  REQUIRE(mesh.ok());
  const EmbreeMesh embree(*mesh, *object);
  const auto caster = make_cell_object_caster(*object, "exact");
  const Vec3 middle = EmbreeMesh::middle(*object);
  const double edge = object->grid.voxel_edge;
  for (const Vec3 from : {Vec3{1, -2, 1.5}, Vec3{-0.3, 0.2, 3}, Vec3{2.9, 0.4, 0.1}}) {
    CameraOptions view;
    view.eye = middle + from;
    const auto camera = Camera::make((*caster)->object_box(), view, kWidth, kHeight);
    REQUIRE(camera.ok());
    std::vector<double> exact(kWidth * kHeight), found(kWidth * kHeight);
    for (std::uint32_t k = 0; k < kWidth * kHeight; ++k) {
      // Both are given the same ray, one of single precision.
      const Ray wanted = camera->ray(k % kWidth + 0.5, k / kWidth + 0.5);
      std::array<float, 3> origin{}, direction{};
      Ray ray;
      for (std::size_t a = 0; a < 3; ++a) {
        origin[a] = float((wanted.origin[a] - middle[a]) / edge);
        direction[a] = float(wanted.direction[a]);
        ray.origin[a] = middle[a] + double(origin[a]) * edge;
        ray.direction[a] = direction[a];
      }
      Hit hit;
      const double metres = (*caster)->first_hit(ray, hit) ? hit.t : kMiss;
      exact[k] = metres * length(ray.direction) / edge;
      found[k] = embree.t(origin, direction) * length(ray.direction);
    }
    std::size_t hits = 0, off = 0, off_silhouettes = 0;
    double largest = 0;
    for (std::uint32_t k = 0; k < kWidth * kHeight; ++k) {
      hits += exact[k] < kMiss;
      if (exact[k] == found[k]) continue;
      const double difference = std::abs(exact[k] - found[k]);
      if (difference <= 1e-3) {
        largest = std::max(largest, difference);
        continue;
      }
      ++off;
      // On a silhouette the pixels around it are not at one depth.
      double low = kMiss, high = 0;
      for (std::int64_t dy = -1; dy <= 1; ++dy)
        for (std::int64_t dx = -1; dx <= 1; ++dx) {
          const std::int64_t x = k % kWidth + dx, y = k / kWidth + dy;
          if (x < 0 || y < 0 || x >= kWidth || y >= kHeight) continue;
          low = std::min(low, exact[std::size_t(x + y * kWidth)]);
          high = std::max(high, exact[std::size_t(x + y * kWidth)]);
        }
      off_silhouettes += high - low <= 0.5;
    }
    std::printf(
        "%zu of %u pixels hit, %zu more than 1e-3 voxel off, the others at most %.2g; %zu off silhouettes\n",
        hits, kWidth * kHeight, off, largest, off_silhouettes);
    CHECK(hits > kWidth * kHeight / 8);
    CHECK(off * 10000 <= kWidth * kHeight);
    CHECK(off_silhouettes == 0);
  }
  std::printf("%llu faces, %llu vertices\n", static_cast<unsigned long long>(report.faces),
              static_cast<unsigned long long>(report.vertices));
}
