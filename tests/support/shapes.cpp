#include "tests/support/shapes.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace mesocell::test {
namespace {
constexpr double kTurn = 2 * std::numbers::pi;
}

TriangleMesh make_box(Vec3 low, Vec3 high) {
  TriangleMesh m;
  for (int k = 0; k < 8; ++k)
    m.vertices.push_back({k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z});
  m.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return m;
}

TriangleMesh make_tetrahedron(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  if (dot(cross(b - a, c - a), d - a) < 0) std::swap(b, c);
  return {{a, b, c, d}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

TriangleMesh make_sphere(Vec3 centre, double radius, std::uint32_t rings) {
  TriangleMesh m;
  const std::uint32_t sides = 2 * rings;
  m.vertices = {centre + Vec3{0, 0, -radius}, centre + Vec3{0, 0, radius}};
  for (std::uint32_t i = 1; i < rings; ++i)
    for (std::uint32_t j = 0; j < sides; ++j) {
      const double v = kTurn / 2 * i / rings - kTurn / 4, u = kTurn * j / sides;
      m.vertices.push_back(centre +
                           Vec3{std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v)} * radius);
    }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return 2 + (i - 1) * sides + j % sides; };
  for (std::uint32_t j = 0; j < sides; ++j) {
    m.triangles.push_back({0, at(1, j + 1), at(1, j)});
    m.triangles.push_back({1, at(rings - 1, j), at(rings - 1, j + 1)});
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      m.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  }
  return m;
}

TriangleMesh make_torus(Vec3 centre, double major, double minor, std::uint32_t around, std::uint32_t across) {
  TriangleMesh m;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = kTurn * i / around, v = kTurn * j / across;
      const double r = major + minor * std::cos(v);
      m.vertices.push_back(centre + Vec3{r * std::cos(u), r * std::sin(u), minor * std::sin(v)});
    }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i % around * across + j % across; };
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return m;
}

void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const std::uint32_t base = std::uint32_t(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

void flip(TriangleMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

}  // namespace mesocell::test
