#include "converters/stability/damage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "sdk/core/rng.h"

namespace mesocell {
namespace {

constexpr const char* kOfArea = "of the area";
constexpr const char* kOfTriangles = "of the triangles";
constexpr const char* kOfDiagonal = "of the diagonal";

constexpr std::array kDamages = {
    Damage{"holes", "up to three connected holes", kOfArea, punch_holes},
    Damage{"removed", "triangles here and there taken out", kOfTriangles, remove_triangles},
    Damage{"flipped", "triangles here and there turned", kOfTriangles, flip_triangles},
    Damage{"duplicated", "triangles given twice", kOfTriangles, duplicate_triangles},
    Damage{"duplicated-turned", "triangles given again, turned", kOfTriangles, duplicate_turned},
    Damage{"jittered", "vertices moved, the mesh stays closed", kOfDiagonal, jitter_vertices},
    Damage{"torn", "corners of triangles moved one by one", kOfDiagonal, jitter_corners},
    Damage{"cracks", "twelve patches moved apart", kOfDiagonal, crack},
    Damage{"spikes", "one corner of triangles thrown away", kOfTriangles, add_spikes},
    Damage{"slivers", "triangles cut in two, cracks filled without area", kOfTriangles, add_slivers},
    Damage{"internal-faces", "copies of patches inside", kOfArea, add_internal_faces},
};

double diagonal(const TriangleMesh& mesh) { return length(bounding_box(mesh).extent()); }

double area_of(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  return length(cross(b - a, c - a)) / 2;
}

Vec3 random_offset(Rng& rng, double amount) {
  const double x = rng.uniform(-amount, amount), y = rng.uniform(-amount, amount);
  return {x, y, rng.uniform(-amount, amount)};
}

/// A share of the triangles, rounded to the nearest number but at least one, ascending.
std::vector<std::uint32_t> pick(const TriangleMesh& mesh, double share, Rng& rng) {
  const std::uint32_t all = std::uint32_t(mesh.triangles.size());
  std::vector<std::uint32_t> order(all);
  std::iota(order.begin(), order.end(), 0u);
  const std::uint32_t count = std::min(all, std::max(1u, std::uint32_t(std::lround(share * all))));
  for (std::uint32_t k = 0; k < count; ++k) std::swap(order[k], order[k + rng.below(all - k)]);
  order.resize(count);
  std::ranges::sort(order);
  return order;
}

TriangleMesh without(const TriangleMesh& mesh, const std::vector<std::uint32_t>& removed) {
  std::vector<bool> gone(mesh.triangles.size(), false);
  for (const std::uint32_t t : removed) gone[t] = true;
  TriangleMesh out{mesh.vertices, {}, {}};
  for (std::size_t t = 0; t < gone.size(); ++t)
    if (!gone[t]) out.triangles.push_back(mesh.triangles[t]);
  return out;
}

/// For each triangle those that share an edge with it.
std::vector<std::vector<std::uint32_t>> neighbours_of(const TriangleMesh& mesh) {
  struct Side {
    std::uint32_t low, high, triangle;
    auto operator<=>(const Side&) const = default;
  };
  const std::vector<std::uint32_t> merged = merge_identical_vertices(mesh.vertices);
  std::vector<Side> sides;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t p = merged[mesh.triangles[t][e]], q = merged[mesh.triangles[t][(e + 1) % 3]];
      sides.push_back({std::min(p, q), std::max(p, q), t});
    }
  std::ranges::sort(sides);
  std::vector<std::vector<std::uint32_t>> neighbours(mesh.triangles.size());
  for (std::size_t k = 1; k < sides.size(); ++k)
    for (std::size_t i = k; i-- > 0 && sides[i].low == sides[k].low && sides[i].high == sides[k].high;) {
      neighbours[sides[k].triangle].push_back(sides[i].triangle);
      neighbours[sides[i].triangle].push_back(sides[k].triangle);
    }
  return neighbours;
}

}  // namespace

std::span<const Damage> damages() { return kDamages; }

std::vector<std::uint32_t> connected_patches(const TriangleMesh& mesh, double share, std::uint32_t patches,
                                             std::uint64_t seed) {
  Rng rng(seed);
  double total = 0;
  for (const Triangle& t : mesh.triangles) total += area_of(mesh, t);
  const auto neighbours = neighbours_of(mesh);
  std::vector<bool> seen(mesh.triangles.size(), false);
  std::vector<std::uint32_t> out;
  for (std::uint32_t patch = 0; patch < patches; ++patch) {
    const std::uint32_t start = rng.below(std::uint32_t(mesh.triangles.size()));
    if (seen[start]) continue;
    const double wanted = share * total / patches;
    double area = 0;
    std::vector<std::uint32_t> queue{start};
    seen[start] = true;
    for (std::size_t k = 0; k < queue.size(); ++k) {
      if (area >= wanted) {
        seen[queue[k]] = false;  // it was only to be reached
        continue;
      }
      area += area_of(mesh, mesh.triangles[queue[k]]);
      out.push_back(queue[k]);
      for (const std::uint32_t n : neighbours[queue[k]])
        if (!seen[n]) {
          seen[n] = true;
          queue.push_back(n);
        }
    }
  }
  std::ranges::sort(out);
  return out;
}

TriangleMesh punch_holes(const TriangleMesh& mesh, double share, std::uint64_t seed) {
  return without(mesh, connected_patches(mesh, share, 3, seed));
}

TriangleMesh remove_triangles(const TriangleMesh& mesh, double share, std::uint64_t seed) {
  Rng rng(seed);
  return without(mesh, pick(mesh, share, rng));
}

TriangleMesh flip_triangles(const TriangleMesh& mesh, double share, std::uint64_t seed) {
  Rng rng(seed);
  TriangleMesh out = mesh;
  for (const std::uint32_t t : pick(mesh, share, rng)) std::swap(out.triangles[t][1], out.triangles[t][2]);
  return out;
}

TriangleMesh duplicate_triangles(const TriangleMesh& mesh, double share, std::uint64_t seed) {
  Rng rng(seed);
  TriangleMesh out = mesh;
  for (const std::uint32_t t : pick(mesh, share, rng)) out.triangles.push_back(mesh.triangles[t]);
  return out;
}

TriangleMesh duplicate_turned(const TriangleMesh& mesh, double share, std::uint64_t seed) {
  TriangleMesh out = duplicate_triangles(mesh, share, seed);
  for (std::size_t t = mesh.triangles.size(); t < out.triangles.size(); ++t)
    std::swap(out.triangles[t][1], out.triangles[t][2]);
  return out;
}

TriangleMesh jitter_vertices(const TriangleMesh& mesh, double amount, std::uint64_t seed) {
  Rng rng(seed);
  const double most = amount * diagonal(mesh);
  const std::vector<std::uint32_t> merged = merge_identical_vertices(mesh.vertices);
  TriangleMesh out = mesh;
  for (std::size_t v = 0; v < out.vertices.size(); ++v)
    out.vertices[v] = merged[v] == v ? out.vertices[v] + random_offset(rng, most) : out.vertices[merged[v]];
  return out;
}

TriangleMesh jitter_corners(const TriangleMesh& mesh, double amount, std::uint64_t seed) {
  Rng rng(seed);
  const double most = amount * diagonal(mesh);
  TriangleMesh out;
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t first = std::uint32_t(out.vertices.size());
    for (const std::uint32_t v : t) out.vertices.push_back(mesh.vertices[v] + random_offset(rng, most));
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

TriangleMesh crack(const TriangleMesh& mesh, double amount, std::uint64_t seed) {
  constexpr std::uint32_t kPatches = 12;
  Rng rng(seed);
  const double most = amount * diagonal(mesh);
  // Grown around twelve triangles at once; what no patch reaches is one more.
  const auto neighbours = neighbours_of(mesh);
  std::vector<std::uint32_t> patch(mesh.triangles.size(), kPatches), queue;
  for (std::uint32_t p = 0; p < kPatches; ++p) {
    const std::uint32_t start = rng.below(std::uint32_t(mesh.triangles.size()));
    if (patch[start] != kPatches) continue;
    patch[start] = p;
    queue.push_back(start);
  }
  for (std::size_t k = 0; k < queue.size(); ++k)
    for (const std::uint32_t n : neighbours[queue[k]])
      if (patch[n] == kPatches) {
        patch[n] = patch[queue[k]];
        queue.push_back(n);
      }
  std::array<Vec3, kPatches + 1> offsets;
  for (Vec3& offset : offsets) offset = random_offset(rng, most);
  TriangleMesh out;
  for (std::uint32_t p = 0; p <= kPatches; ++p) {
    std::vector<std::optional<std::uint32_t>> copy(mesh.vertices.size());
    for (std::size_t t = 0; t < patch.size(); ++t) {
      if (patch[t] != p) continue;
      Triangle triangle{};
      for (std::size_t e = 0; e < 3; ++e) {
        const std::uint32_t v = mesh.triangles[t][e];
        if (!copy[v]) {
          copy[v] = std::uint32_t(out.vertices.size());
          out.vertices.push_back(mesh.vertices[v] + offsets[p]);
        }
        triangle[e] = *copy[v];
      }
      out.triangles.push_back(triangle);
    }
  }
  return out;
}

TriangleMesh add_spikes(const TriangleMesh& mesh, double share, std::uint64_t seed) {
  Rng rng(seed);
  const double far = diagonal(mesh) / 2;
  TriangleMesh out = mesh;
  for (const std::uint32_t t : pick(mesh, share, rng)) {
    std::uint32_t& corner = out.triangles[t][rng.below(3)];
    Vec3 direction;
    // Uniform on the sphere: points of the cube beyond the ball are thrown again.
    do direction = random_offset(rng, 1);
    while (dot(direction, direction) > 1 || dot(direction, direction) < 0.01);
    out.vertices.push_back(out.vertices[corner] + normalize(direction) * far);
    corner = std::uint32_t(out.vertices.size() - 1);
  }
  return out;
}

TriangleMesh add_slivers(const TriangleMesh& mesh, double share, std::uint64_t seed) {
  Rng rng(seed);
  TriangleMesh out = mesh;
  for (const std::uint32_t t : pick(mesh, share, rng)) {
    const std::size_t e = rng.below(3);
    const std::uint32_t a = mesh.triangles[t][e], b = mesh.triangles[t][(e + 1) % 3],
                        c = mesh.triangles[t][(e + 2) % 3];
    const std::uint32_t middle = std::uint32_t(out.vertices.size());
    out.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]) / 2);
    out.triangles[t] = {a, middle, c};
    out.triangles.push_back({middle, b, c});
    out.triangles.push_back({a, b, middle});
  }
  return out;
}

TriangleMesh add_internal_faces(const TriangleMesh& mesh, double share, std::uint64_t seed) {
  const double depth = diagonal(mesh) / 50;
  std::vector<Vec3> normals(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    for (const std::uint32_t v : t) normals[v] = normals[v] + cross(b - a, c - a);
  }
  TriangleMesh out = mesh;
  std::vector<std::optional<std::uint32_t>> copy(mesh.vertices.size());
  for (const std::uint32_t t : connected_patches(mesh, share, 3, seed)) {
    Triangle triangle{};
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t v = mesh.triangles[t][e];
      if (!copy[v]) {
        copy[v] = std::uint32_t(out.vertices.size());
        out.vertices.push_back(mesh.vertices[v] - normalize(normals[v]) * depth);
      }
      triangle[e] = *copy[v];
    }
    out.triangles.push_back(triangle);
  }
  return out;
}

}  // namespace mesocell
