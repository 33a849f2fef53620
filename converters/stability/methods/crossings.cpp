#include "converters/stability/methods/crossings.h"

#include <algorithm>
#include <cmath>

namespace mesocell {
namespace {

/// The first of `count` voxels whose centre is at `x` or beyond.
std::uint32_t first_centre(double x, std::uint32_t count) {
  return std::uint32_t(std::clamp(std::ceil(x - 0.5), 0.0, double(count)));
}

}  // namespace

CrossingFinder::CrossingFinder(const TriangleMesh& mesh, std::size_t axis, const Index3& size)
    : mesh_(mesh), axis_(axis), u_(axis == 0 ? 1 : 0), v_(axis == 2 ? 1 : 2), size_(size) {
  const std::uint32_t chunks = (size[v_] + kRows - 1) / kRows;
  const auto for_chunks = [&](const Triangle& t, auto f) {
    const double a = mesh.vertices[t[0]][v_], b = mesh.vertices[t[1]][v_], c = mesh.vertices[t[2]][v_];
    const std::uint32_t begin = first_centre(std::min({a, b, c}), size_[v_]),
                        end = first_centre(std::max({a, b, c}), size_[v_]);
    if (begin < end)
      for (std::uint32_t k = begin / kRows; k <= (end - 1) / kRows; ++k) f(k);
  };
  first_.assign(chunks + 1, 0);
  for (const Triangle& t : mesh.triangles) for_chunks(t, [&](std::uint32_t c) { ++first_[c + 1]; });
  for (std::size_t c = 0; c < chunks; ++c) first_[c + 1] += first_[c];
  triangles_.resize(first_.back());
  std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for_chunks(mesh.triangles[t], [&](std::uint32_t c) { triangles_[next[c]++] = t; });
}

std::array<std::uint32_t, 2> CrossingFinder::rows(std::size_t chunk) const {
  const std::uint32_t begin = std::uint32_t(chunk) * kRows;
  return {begin, std::min(begin + kRows, size_[v_])};
}

void CrossingFinder::find(std::size_t chunk, std::vector<Crossing>& out) const {
  out.clear();
  const auto [row_begin, row_end] = rows(chunk);
  for (std::uint64_t k = first_[chunk]; k < first_[chunk + 1]; ++k) {
    const Triangle& t = mesh_.triangles[triangles_[k]];
    const Vec3 p[3] = {mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]};
    const double low = std::min({p[0][v_], p[1][v_], p[2][v_]});
    const double high = std::max({p[0][v_], p[1][v_], p[2][v_]});
    const std::uint32_t begin = std::max(first_centre(low, size_[v_]), row_begin),
                        end = std::min(first_centre(high, size_[v_]), row_end);
    for (std::uint32_t v = begin; v < end; ++v) {
      const double centre = v + 0.5;
      struct Cut {
        double u, depth;
        bool rising;
      } cut[2];
      int count = 0;
      for (int e = 0; e < 3 && count < 2; ++e) {
        const Vec3 &a = p[e], &b = p[(e + 1) % 3];
        if ((a[v_] > centre) == (b[v_] > centre)) continue;
        // From the lower end whichever way the triangle runs, so that neighbours find the same.
        const bool rising = a[v_] < b[v_];
        const Vec3 &from = rising ? a : b, &to = rising ? b : a;
        const double s = (centre - from[v_]) / (to[v_] - from[v_]);
        cut[count++] = {from[u_] + s * (to[u_] - from[u_]), from[axis_] + s * (to[axis_] - from[axis_]),
                        rising};
      }
      if (count != 2) continue;
      const Cut &left = cut[cut[0].u <= cut[1].u ? 0 : 1], &right = cut[cut[0].u <= cut[1].u ? 1 : 0];
      const std::uint32_t u_end = first_centre(right.u, size_[u_]);
      for (std::uint32_t u = first_centre(left.u, size_[u_]); u < u_end; ++u) {
        const double s = (u + 0.5 - left.u) / (right.u - left.u);
        const double depth = left.depth + s * (right.depth - left.depth);
        out.push_back({u, v, first_centre(depth, size_[axis_]), std::int8_t(left.rising ? -1 : 1)});
      }
    }
  }
}

}  // namespace mesocell
