// The generalized winding number as the sum of all solid angles by 4π. [Jacobson 2013; van Oosterom 1983]
#include <array>
#include <cmath>
#include <numbers>

#include "converters/stability/voxelizer.h"
#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

/// Points that are evaluated side by side.
constexpr std::size_t kLanes = 8;
/// Makes a triangle of which the point is a vertex count for nothing; lost in all other sums.
constexpr double kTiny = 1e-300;
using Lanes = std::array<double, kLanes>;

/// Seen from each of the points.
struct SeenVertex {
  Lanes x, y, z, distance;
};

/// Winding numbers. Half a triangle's solid angle is the argument of a complex number; their sum is the
/// argument of the product, and how often that went around is counted.
Lanes winding_numbers(const TriangleMesh& mesh, const std::vector<SeenVertex>& seen) {
  Lanes re, im{}, turns{};
  re.fill(1);
  for (const Triangle& t : mesh.triangles) {
    const SeenVertex &a = seen[t[0]], &b = seen[t[1]], &c = seen[t[2]];
    for (std::size_t k = 0; k < kLanes; ++k) {
      const double det = a.x[k] * (b.y[k] * c.z[k] - b.z[k] * c.y[k]) +
                         a.y[k] * (b.z[k] * c.x[k] - b.x[k] * c.z[k]) +
                         a.z[k] * (b.x[k] * c.y[k] - b.y[k] * c.x[k]);
      const double ab = a.x[k] * b.x[k] + a.y[k] * b.y[k] + a.z[k] * b.z[k];
      const double bc = b.x[k] * c.x[k] + b.y[k] * c.y[k] + b.z[k] * c.z[k];
      const double ca = c.x[k] * a.x[k] + c.y[k] * a.y[k] + c.z[k] * a.z[k];
      const double rest = a.distance[k] * b.distance[k] * c.distance[k] + ab * c.distance[k] +
                          bc * a.distance[k] + ca * b.distance[k] + kTiny;
      const double new_re = re[k] * rest - im[k] * det, new_im = re[k] * det + im[k] * rest;
      // Twice positive gave negative: over half a turn; and the reverse. Signs as numbers, without branches.
      const double was = std::copysign(0.5, im[k]), by = std::copysign(0.5, det),
                   is = std::copysign(0.5, new_im);
      turns[k] += (0.5 + was) * (0.5 + by) * (0.5 - is) - (0.5 - was) * (0.5 - by) * (0.5 + is);
      const double scale = 1 / (std::abs(new_re) + std::abs(new_im));
      re[k] = new_re * scale;
      im[k] = new_im * scale;
    }
  }
  Lanes winding;
  for (std::size_t k = 0; k < kLanes; ++k)
    winding[k] = turns[k] + std::atan2(im[k], re[k]) / (2 * std::numbers::pi);
  return winding;
}

}  // namespace

Status voxelize_winding_exact(const TriangleMesh& mesh, BitGrid& out, unsigned threads) {
  const Index3& size = out.size();
  parallel_for(size[2], threads, [&](std::size_t z, unsigned) {
    std::vector<SeenVertex> seen(mesh.vertices.size());
    for (std::uint32_t y = 0; y < size[1]; ++y)
      for (std::uint32_t x = 0; x < size[0]; x += kLanes) {
        for (std::size_t v = 0; v < seen.size(); ++v)
          for (std::size_t k = 0; k < kLanes; ++k) {
            const Vec3 d = mesh.vertices[v] - Vec3{double(x + k) + 0.5, y + 0.5, double(z) + 0.5};
            seen[v].x[k] = d.x;
            seen[v].y[k] = d.y;
            seen[v].z[k] = d.z;
            seen[v].distance[k] = length(d);
          }
        const Lanes winding = winding_numbers(mesh, seen);
        for (std::uint32_t k = 0; k < kLanes && x + k < size[0]; ++k)
          if (std::abs(winding[k]) > 0.5) out.set(x + k, y, std::uint32_t(z));
      }
  });
  return {};
}

}  // namespace mesocell
