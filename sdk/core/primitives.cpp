#include "sdk/core/primitives.h"

#include <array>
#include <cmath>
#include <numbers>

namespace mesocell {
namespace {

/// Sine and cosine by their series, without the machine's library, whose
/// last digits differ.
struct SinCos {
  double sin, cos;
};

/// `x` in [-π, π].
SinCos sin_cos_series(double x) {
  double sin = 0, cos = 0, term = 1;
  for (int i = 0; i < 32; i += 2) {
    cos += i % 4 == 0 ? term : -term;
    term *= x / (i + 1);
    sin += i % 4 == 0 ? term : -term;
    term *= x / (i + 2);
  }
  return {sin, cos};
}

SinCos sin_cos(std::int64_t k, std::uint32_t n) {
  const std::int64_t turn = (k % n + n) % n;
  const double x = 2 * std::numbers::pi * (double(turn) / n);
  return sin_cos_series(x > std::numbers::pi ? x - 2 * std::numbers::pi : x);
}

/// Quads of a grid that closes in both directions.
void add_tube_triangles(TriangleMesh& mesh, std::uint32_t around, std::uint32_t across) {
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i % around * across + j % across; };
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
    }
}

void make_outward(TriangleMesh& mesh) {
  if (signed_volume(mesh) < 0) turn(mesh);
}

}  // namespace

TriangleMesh make_cylinder(double lower_radius, double upper_radius, double height, std::uint32_t around) {
  TriangleMesh mesh;
  const bool cone = upper_radius == 0;
  for (std::uint32_t k = 0; k < around; ++k) {
    const SinCos a = sin_cos(k, around);
    mesh.vertices.push_back({lower_radius * a.cos, 0, lower_radius * a.sin});
  }
  for (std::uint32_t k = 0; k < around && !cone; ++k) {
    const SinCos a = sin_cos(k, around);
    mesh.vertices.push_back({upper_radius * a.cos, height, upper_radius * a.sin});
  }
  const auto bottom = std::uint32_t(mesh.vertices.size()), top = bottom + 1;
  mesh.vertices.push_back({0, 0, 0});
  mesh.vertices.push_back({0, height, 0});
  for (std::uint32_t k = 0; k < around; ++k) {
    const std::uint32_t next = (k + 1) % around;
    mesh.triangles.push_back({bottom, k, next});
    if (cone) {
      mesh.triangles.push_back({k, top, next});
      continue;
    }
    mesh.triangles.push_back({k, k + around, next});
    mesh.triangles.push_back({next, k + around, next + around});
    mesh.triangles.push_back({top, next + around, k + around});
  }
  return mesh;
}

TriangleMesh make_knot(std::uint32_t around, std::uint32_t across) {
  constexpr double kRadius = 0.45;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < around; ++i) {
    const SinCos t = sin_cos(i, around), t2 = sin_cos(2 * i, around), t3 = sin_cos(3 * i, around);
    const Vec3 centre{t.sin + 2 * t2.sin, t.cos - 2 * t2.cos, -t3.sin};
    const Vec3 along = normalize({t.cos + 4 * t2.cos, -t.sin + 4 * t2.sin, -3 * t3.cos});
    // The knot never runs along z, so this frame turns without a jump and closes.
    const Vec3 side = normalize(cross(along, {0, 0, 1})), up = cross(side, along);
    for (std::uint32_t j = 0; j < across; ++j) {
      const SinCos a = sin_cos(j, across);
      mesh.vertices.push_back(centre + kRadius * (a.cos * side + a.sin * up));
    }
  }
  add_tube_triangles(mesh, around, across);
  make_outward(mesh);
  tilt(mesh);
  return mesh;
}

TriangleMesh make_torus(double major, double minor, std::uint32_t around, std::uint32_t across) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const SinCos a = sin_cos(i, around), b = sin_cos(j, across);
      const double r = major + minor * b.cos;
      mesh.vertices.push_back({r * a.cos, r * a.sin, minor * b.sin});
    }
  add_tube_triangles(mesh, around, across);
  make_outward(mesh);
  tilt(mesh);
  return mesh;
}

TriangleMesh make_sphere(double radius, double height, std::uint32_t cells) {
  TriangleMesh mesh;
  for (std::size_t face = 0; face < 6; ++face) {
    const std::size_t axis = face / 2;
    for (std::uint32_t i = 0; i <= cells; ++i)
      for (std::uint32_t j = 0; j <= cells; ++j) {
        Vec3 p;
        p[axis] = face % 2 ? 1 : -1;
        p[(axis + 1) % 3] = 2.0 * i / cells - 1;
        p[(axis + 2) % 3] = 2.0 * j / cells - 1;
        p = normalize(p);
        // A polynomial without symmetry for bumps.
        const double bump = 4 * p.x * p.y * p.z + 2 * p.x * (p.x * p.x - p.y * p.y) + p.z * p.z * p.y;
        mesh.vertices.push_back(p * (radius * (1 + height * bump)));
      }
    const std::uint32_t first = std::uint32_t(face) * (cells + 1) * (cells + 1);
    for (std::uint32_t i = 0; i < cells; ++i)
      for (std::uint32_t j = 0; j < cells; ++j) {
        const std::uint32_t a = first + i * (cells + 1) + j, b = a + cells + 1;
        if (face % 2) {
          mesh.triangles.push_back({a, b, b + 1});
          mesh.triangles.push_back({a, b + 1, a + 1});
        } else {
          mesh.triangles.push_back({a, b + 1, b});
          mesh.triangles.push_back({a, a + 1, b + 1});
        }
      }
  }
  // The faces of the cube share their rims.
  const std::vector<std::uint32_t> merged = merge_identical_vertices(mesh.vertices);
  std::vector<std::uint32_t> index(mesh.vertices.size(), 0);
  std::vector<Vec3> kept;
  for (std::uint32_t v = 0; v < merged.size(); ++v) {
    if (merged[v] == v) {
      index[v] = std::uint32_t(kept.size());
      kept.push_back(mesh.vertices[v]);
    } else {
      index[v] = index[merged[v]];
    }
  }
  mesh.vertices = std::move(kept);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = index[v];
  make_outward(mesh);
  tilt(mesh);
  return mesh;
}

TriangleMesh make_box(Vec3 low, Vec3 high) {
  TriangleMesh mesh;
  for (unsigned i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const std::uint32_t first = std::uint32_t(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& t : other.triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

void turn(TriangleMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

void translate(TriangleMesh& mesh, Vec3 by) {
  for (Vec3& v : mesh.vertices) v = v + by;
}

void tilt(TriangleMesh& mesh) {
  constexpr double s1 = 20.0 / 101, c1 = 99.0 / 101, s2 = 48.0 / 73, c2 = 55.0 / 73;
  for (Vec3& v : mesh.vertices) {
    v = {c1 * v.x - s1 * v.y, s1 * v.x + c1 * v.y, v.z};
    v = {v.x, c2 * v.y - s2 * v.z, s2 * v.y + c2 * v.z};
  }
}

}  // namespace mesocell
