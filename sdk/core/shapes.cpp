#include "sdk/core/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "format/result.h"
#include "sdk/core/portable_math.h"
#include "sdk/core/primitives.h"

namespace mesocell {
namespace {

/// Fits a mesh into the cube about the origin whose half edge is `reach`.
void fit(TriangleMesh& mesh, double reach) {
  const Box3 box = bounding_box(mesh);
  const Vec3 centre = box.min + box.extent() * 0.5, extent = box.extent();
  const double scale = 2 * reach / std::max({extent.x, extent.y, extent.z});
  for (Vec3& v : mesh.vertices) v = (v - centre) * scale;
}

/// A sphere of radius R = 0.45 with bumps of 0.04 R: r + 0.04 R sin(8.19 x) sin(10.24 y) sin(12.29 z) ≤ R.
TriangleMesh make_wavy(std::uint32_t detail) {
  constexpr double kRadius = 0.45, kBump = 0.04 * kRadius;
  TriangleMesh mesh = make_sphere(1, 0, 192 * detail);
  for (Vec3& v : mesh.vertices) {
    const Vec3 d = normalize(v);
    const auto outside = [&](double r) {
      return r + kBump * portable_sine(8.19 * r * d.x) * portable_sine(10.24 * r * d.y) *
                     portable_sine(12.29 * r * d.z) >
             kRadius;
    };
    // The left side grows with r, for the slope of the bumps is below 0.6.
    double low = kRadius - kBump, high = kRadius + kBump;
    for (int i = 0; i < 50; ++i) {
      const double middle = (low + high) / 2;
      (outside(middle) ? high : low) = middle;
    }
    v = d * low;
  }
  return mesh;
}

TriangleMesh make_fitted_torus(std::uint32_t detail) {
  TriangleMesh mesh = make_torus(0.32, 0.13, 160 * detail, 80 * detail);
  fit(mesh, 0.45);
  return mesh;
}

TriangleMesh make_fitted_knot(std::uint32_t detail) {
  TriangleMesh mesh = make_knot(400 * detail, 48 * detail);
  fit(mesh, 0.47);
  return mesh;
}

/// A plate with low hills towards -z, 0.2 grid edges thick: what rays graze.
TriangleMesh make_slab(std::uint32_t) {
  constexpr std::uint32_t kQuads = 128, kRow = kQuads + 1;
  TriangleMesh mesh;
  for (const bool top : {false, true})
    for (std::uint32_t j = 0; j < kRow; ++j)
      for (std::uint32_t i = 0; i < kRow; ++i) {
        const double x = 0.96 * (double(i) / kQuads - 0.5), z = 0.96 * (double(j) / kQuads - 0.5);
        const double hill = 0.03 * x * (4 * x * x - 1) - 0.05 * z * (4 * z * z - 1) * (1 - x);
        // Laid out as the ground, then turned about x to stand upright.
        mesh.vertices.push_back({x, z, top ? -0.1 - hill : 0.1});
      }
  const auto at = [](std::uint32_t i, std::uint32_t j, bool top) {
    return (top ? kRow * kRow : 0) + j * kRow + i;
  };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (std::uint32_t j = 0; j < kQuads; ++j)
    for (std::uint32_t i = 0; i < kQuads; ++i) {
      quad(at(i, j, true), at(i, j + 1, true), at(i + 1, j + 1, true), at(i + 1, j, true));
      quad(at(i, j, false), at(i + 1, j, false), at(i + 1, j + 1, false), at(i, j + 1, false));
    }
  for (std::uint32_t k = 0; k < kQuads; ++k) {
    quad(at(k, 0, true), at(k + 1, 0, true), at(k + 1, 0, false), at(k, 0, false));
    quad(at(k + 1, kQuads, true), at(k, kQuads, true), at(k, kQuads, false), at(k + 1, kQuads, false));
    quad(at(0, k + 1, true), at(0, k, true), at(0, k, false), at(0, k + 1, false));
    quad(at(kQuads, k, true), at(kQuads, k + 1, true), at(kQuads, k + 1, false), at(kQuads, k, false));
  }
  return mesh;
}

/// Leaning needles, six-sided, 8 × 8 of them: mostly empty, with silhouettes everywhere.
TriangleMesh make_needles(std::uint32_t) {
  // Sines and cosines of a sixth of a turn.
  constexpr std::array<std::array<double, 2>, 6> kSides = {{{1, 0},
                                                            {0.5, 0.8660254037844386},
                                                            {-0.5, 0.8660254037844386},
                                                            {-1, 0},
                                                            {-0.5, -0.8660254037844386},
                                                            {0.5, -0.8660254037844386}}};
  constexpr double kBottomRadius = 0.045, kTopRadius = 0.028;
  TriangleMesh mesh;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) {
      TriangleMesh needle;
      // Neighbours lean alike, so that none meet.
      const Vec3 foot{(i - 3.5) * 0.115, -0.47, (j - 3.5) * 0.115};
      const Vec3 tip{foot.x + 0.04, 0.25 + 0.05 * ((3 * i + 5 * j) % 5), foot.z - 0.03};
      for (const auto& [at, radius] : {std::pair(foot, kBottomRadius), std::pair(tip, kTopRadius)})
        for (const auto& side : kSides) needle.vertices.push_back(at + Vec3{side[0], 0, side[1]} * radius);
      needle.vertices.push_back(foot);
      needle.vertices.push_back(tip);
      for (std::uint32_t k = 0; k < 6; ++k) {
        const std::uint32_t next = (k + 1) % 6;
        needle.triangles.push_back({k, k + 6, next});
        needle.triangles.push_back({next, k + 6, next + 6});
        needle.triangles.push_back({12, k, next});
        needle.triangles.push_back({13, next + 6, k + 6});
      }
      append(mesh, needle);
    }
  return mesh;
}

/// A Menger sponge of 9³ cubes: tunnels through and through, and faces along the axes.
TriangleMesh make_sponge(std::uint32_t) {
  constexpr int kCubes = 9;
  const auto solid = [](int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0 || x >= kCubes || y >= kCubes || z >= kCubes) return false;
    for (; x > 0 || y > 0 || z > 0; x /= 3, y /= 3, z /= 3)
      if ((x % 3 == 1) + (y % 3 == 1) + (z % 3 == 1) >= 2) return false;
    return true;
  };
  TriangleMesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> vertices;
  const auto vertex = [&](const std::array<int, 3>& p) {
    const auto [place, added] = vertices.try_emplace(p, std::uint32_t(mesh.vertices.size()));
    if (added)
      mesh.vertices.push_back(
          (Vec3{double(p[0]), double(p[1]), double(p[2])} / kCubes - Vec3{0.5, 0.5, 0.5}) * 0.92);
    return place->second;
  };
  for (int z = 0; z < kCubes; ++z)
    for (int y = 0; y < kCubes; ++y)
      for (int x = 0; x < kCubes; ++x) {
        if (!solid(x, y, z)) continue;
        for (std::size_t a = 0; a < 3; ++a)
          for (const int side : {0, 1}) {
            std::array<int, 3> next{x, y, z};
            next[a] += side ? 1 : -1;
            if (solid(next[0], next[1], next[2])) continue;
            std::array<std::uint32_t, 4> corner{};
            for (std::size_t k = 0; k < 4; ++k) {
              std::array<int, 3> p{x, y, z};
              p[a] += side;
              p[(a + 1) % 3] += k == 1 || k == 2;
              p[(a + 2) % 3] += k >= 2;
              corner[k] = vertex(p);
            }
            if (!side) std::swap(corner[1], corner[3]);
            mesh.triangles.push_back({corner[0], corner[1], corner[2]});
            mesh.triangles.push_back({corner[0], corner[2], corner[3]});
          }
      }
  return mesh;
}

TriangleMesh make_ball(std::uint32_t detail) { return make_sphere(0.45, 0, 64 * detail); }

TriangleMesh make_cube(std::uint32_t) { return make_box({-0.45, -0.45, -0.45}, {0.45, 0.45, 0.45}); }

TriangleMesh make_upright_cylinder(std::uint32_t detail) {
  TriangleMesh mesh = make_cylinder(0.3, 0.3, 0.9, 96 * detail);
  fit(mesh, 0.45);
  return mesh;
}

TriangleMesh make_cone(std::uint32_t detail) {
  TriangleMesh mesh = make_cylinder(0.4, 0, 0.9, 96 * detail);
  fit(mesh, 0.45);
  return mesh;
}

constexpr std::array<Shape, 10> kShapes = {{
    {"sphere", "a sphere", make_ball},
    {"box", "a cube", make_cube},
    {"cylinder", "an upright cylinder", make_upright_cylinder},
    {"cone", "an upright cone", make_cone},
    {"torus", "a torus about a tilted axis", make_fitted_torus},
    {"knot", "a tube along a trefoil knot", make_fitted_knot},
    {"wavy", "a sphere with bumps", make_wavy},
    {"slab", "a plate with low hills", make_slab},
    {"needles", "64 leaning needles", make_needles},
    {"sponge", "a Menger sponge of 9³ cubes", make_sponge},
}};

}  // namespace

std::span<const Shape> shapes() { return kShapes; }

const Shape* find_shape(std::string_view name) {
  for (const Shape& shape : kShapes)
    if (shape.name == name) return &shape;
  return nullptr;
}

Result<TriangleMesh> make_shape(const Recipe& recipe) {
  const Shape* const shape = find_shape(recipe.name);
  if (!shape) {
    std::string names;
    for (const Shape& s : kShapes) names += (names.empty() ? "" : ", ") + std::string(s.name);
    return Error{ErrorCode::kUsage, "there is no shape '" + recipe.name + "'; there are: " + names};
  }
  constexpr std::array<std::string_view, 2> kOptions = {"size", "detail"};
  if (const Status status = check_options(recipe, "shape", kOptions); !status) return status.error();
  const auto size = number_option(recipe, "size", 1, 1e-300, 1e300);
  if (!size) return size.error();
  const auto detail = whole_option(recipe, "detail", 1, 1, 16);
  if (!detail) return detail.error();
  TriangleMesh mesh = shape->make(std::uint32_t(*detail));
  fit(mesh, *size / 2);
  return mesh;
}

std::string shapes_help() {
  std::string text;
  for (const Shape& shape : kShapes)
    text += "shape:" + std::string(shape.name) + "   " + std::string(shape.description) + "\n";
  return text +
         "size: the longest side in metres [1]; detail: how finely round parts are cut, 1 to 16 [1]: "
         "shape:torus:size=2,detail=3\n";
}

}  // namespace mesocell
