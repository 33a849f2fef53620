#include "converters/stability/catalogue.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>

#include "converters/stability/damage.h"
#include "sdk/core/primitives.h"

namespace mesocell {
namespace {

constexpr double kMarginVoxels = 3;  ///< voxels

/// "0.1 %", "1e-4".
std::string strength_text(const Damage& damage, double strength) {
  char text[32];
  if (std::string_view(damage.unit) == "of the diagonal")
    std::snprintf(text, sizeof text, "1e%d", int(std::lround(std::log10(strength))));
  else
    std::snprintf(text, sizeof text, "%g %%", 100 * strength);
  return text;
}

std::span<const double> strengths_of(const Damage& damage) {
  static constexpr std::array kAreas = {0.001, 0.005, 0.01, 0.02, 0.05, 0.1};
  static constexpr std::array kTriangles = {0.001, 0.01, 0.02, 0.1};
  static constexpr std::array kMany = {0.01, 0.1, 0.5};
  static constexpr std::array kDistances = {1e-6, 1e-4, 1e-3, 1e-2};
  const std::string_view name = damage.name, unit = damage.unit;
  if (name == "holes") return kAreas;
  if (name == "flipped" || name.starts_with("duplicated") || name == "slivers") return kMany;
  if (unit == "of the diagonal") return kDistances;
  return kTriangles;
}

StabilityCase clean_case(const NamedMesh& mesh, std::uint32_t resolution) {
  const VoxelFrame frame = frame_of(mesh.mesh, resolution);
  const TriangleMesh voxels = frame.to_voxels(mesh.mesh);
  return {"clean", "clean", "", mesh.name, voxels, voxels, frame.size};
}

StabilityCase damage_case(const NamedMesh& mesh, std::uint32_t resolution, const Damage& damage,
                          double strength, std::uint64_t seed) {
  const VoxelFrame frame = frame_of(mesh.mesh, resolution);
  return {"damage",
          damage.name,
          strength_text(damage, strength),
          mesh.name,
          frame.to_voxels(damage.apply(mesh.mesh, strength, seed)),
          frame.to_voxels(mesh.mesh),
          frame.size};
}

class GeometryCases {
 public:
  explicit GeometryCases(std::uint32_t resolution) : n_(resolution), middle_{n_ / 2.0, n_ / 2.0, n_ / 2.0} {}

  void add(const char* name, std::string strength, TriangleMesh mesh) {
    StabilityCase c;
    c.group = "geometry";
    c.name = name;
    c.strength = std::move(strength);
    c.mesh = "own";
    c.broken = c.sound = std::move(mesh);
    c.size = {n_, n_, n_};
    cases_.push_back(std::move(c));
  }

  /// About the middle of the grid, radius in shares of its side.
  [[nodiscard]] TriangleMesh sphere(double radius, Vec3 shift = {}) const {
    TriangleMesh mesh = make_sphere(radius * n_, 0, 10);
    translate(mesh, middle_ + shift * n_);
    return mesh;
  }

  std::vector<StabilityCase> make() {
    nested();
    TriangleMesh overlap = sphere(0.25, {-0.12, 0, 0});
    append(overlap, sphere(0.25, {0.12, 0.03, 0.01}));
    add("overlapping solids", "", overlap);
    special_places();
    thin_walls();
    return std::move(cases_);
  }

 private:
  void nested() {
    TriangleMesh same = sphere(0.4);
    append(same, sphere(0.2));
    add("nested shell, same sign", "", same);
    TriangleMesh inner = sphere(0.2), cavity = sphere(0.4);
    turn(inner);
    append(cavity, inner);
    add("nested shell, cavity", "", cavity);
    append(cavity, sphere(0.1));
    add("nested shells, solid in cavity", "", cavity);
    TriangleMesh turned = sphere(0.4);
    turn(turned);
    add("inside out", "", turned);
  }

  void special_places() {
    const double low = std::floor(n_ * 0.2), high = std::floor(n_ * 0.8);
    const auto cube = [](double a, double b) { return make_box({a, a, a}, {b, b, b}); };
    add("planes on voxel faces", "", cube(low, high));
    add("planes on voxel centres", "", cube(low + 0.5, high + 0.5));
    for (const double shift : {0.0, 0.5}) {
      TriangleMesh snapped = make_sphere(0.4 * n_, 0.1, 6);
      for (Vec3& v : snapped.vertices)
        for (std::size_t a = 0; a < 3; ++a) v[a] = std::floor(v[a] + middle_[a]) + shift;
      add(shift == 0 ? "vertices on voxel corners" : "vertices on voxel centres", "", snapped);
    }
  }

  void thin_walls() {
    const double half = 0.38 * n_;
    for (const double thickness : {0.1, 0.3, 0.5, 1.0, 2.0, 3.0}) {
      TriangleMesh wall = make_box({-half, -half, -thickness / 2}, {half, half, thickness / 2});
      tilt(wall);
      translate(wall, middle_);
      char text[32];
      std::snprintf(text, sizeof text, "%g voxels", thickness);
      add("thin wall", text, wall);
    }
  }

  std::uint32_t n_;
  Vec3 middle_;
  std::vector<StabilityCase> cases_;
};

}  // namespace

std::vector<NamedMesh> clean_meshes(std::uint32_t detail) {
  return {{"knot", make_knot(90 * detail, 12 * detail)},
          {"bumps", make_sphere(1, 0.12, 13 * detail)},
          {"torus", make_torus(1, 0.4, 50 * detail, 20 * detail)}};
}

VoxelFrame frame_of(const TriangleMesh& mesh, std::uint32_t resolution) {
  assert(resolution >= 8);
  const Box3 box = bounding_box(mesh);
  const Vec3 extent = box.extent();
  const double side = std::max({extent.x, extent.y, extent.z});
  VoxelFrame frame;
  frame.voxel_edge = side / (resolution - 2 * kMarginVoxels);
  for (std::size_t a = 0; a < 3; ++a) {
    const double voxels =
        extent[a] == side ? resolution : std::ceil(extent[a] / frame.voxel_edge + 2 * kMarginVoxels);
    frame.size[a] = std::uint32_t(voxels);
    frame.origin[a] = box.min[a] + extent[a] / 2 - voxels * frame.voxel_edge / 2;
  }
  return frame;
}

TriangleMesh VoxelFrame::to_voxels(const TriangleMesh& mesh) const {
  TriangleMesh out{mesh.vertices, mesh.triangles, {}};
  for (Vec3& v : out.vertices) v = (v - origin) / voxel_edge;
  return out;
}

std::vector<StabilityCase> damage_cases(std::span<const NamedMesh> meshes, std::uint32_t resolution) {
  std::vector<StabilityCase> cases;
  for (const NamedMesh& mesh : meshes) cases.push_back(clean_case(mesh, resolution));
  for (const Damage& damage : damages())
    for (const double strength : strengths_of(damage))
      for (std::size_t m = 0; m < meshes.size(); ++m)
        cases.push_back(damage_case(meshes[m], resolution, damage, strength, m + 1));
  return cases;
}

std::vector<StabilityCase> benchmark_cases(std::span<const NamedMesh> meshes, std::uint32_t resolution) {
  std::vector<StabilityCase> cases;
  for (const NamedMesh& mesh : meshes) {
    cases.push_back(clean_case(mesh, resolution));
    cases.push_back(damage_case(mesh, resolution, damages().front(), 0.01, 1));
  }
  return cases;
}

std::vector<StabilityCase> geometry_cases(std::uint32_t resolution) {
  return GeometryCases(resolution).make();
}

StabilityCase pair_case(const MeshPair& pair, std::uint32_t resolution) {
  const VoxelFrame frame = frame_of(pair.sound, resolution);
  return {"pair",    pair.name, "", pair.name, frame.to_voxels(pair.broken), frame.to_voxels(pair.sound),
          frame.size};
}

}  // namespace mesocell
