#include "sdk/membership/cap.h"

#include <algorithm>
#include <cstddef>
#include <queue>
#include <tuple>
#include <utility>

#include "sdk/membership/mesh_topology.h"

namespace mesocell {
namespace {

using Edge = std::array<std::uint32_t, 2>;

/// Squared, and four times that.
double area_of_ear(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = cross(b - a, c - a);
  return dot(normal, normal);
}

/// Covers one loop of at least three vertices, each of which is in it once.
std::vector<Triangle> cap_loop(std::span<const Vec3> vertices, const std::vector<std::uint32_t>& loop) {
  struct Ear {
    double area;
    std::uint32_t at, stamp;
    bool operator<(const Ear& e) const { return std::tie(e.area, e.at, e.stamp) < std::tie(area, at, stamp); }
  };
  std::vector<Triangle> out;
  const std::uint32_t n = std::uint32_t(loop.size());
  std::vector<std::uint32_t> before(n), after(n), stamps(n, 0);
  std::priority_queue<Ear> ears;
  const auto push = [&](std::uint32_t k) {
    ears.push({area_of_ear(vertices[loop[before[k]]], vertices[loop[k]], vertices[loop[after[k]]]), k,
               ++stamps[k]});
  };
  for (std::uint32_t k = 0; k < n; ++k) {
    before[k] = k == 0 ? n - 1 : k - 1;
    after[k] = k + 1 == n ? 0 : k + 1;
  }
  for (std::uint32_t k = 0; k < n; ++k) push(k);
  for (std::uint32_t left = n; left >= 3;) {
    const Ear ear = ears.top();
    ears.pop();
    if (ear.stamp != stamps[ear.at]) continue;
    const std::uint32_t p = before[ear.at], q = after[ear.at];
    // Against the boundary's direction.
    out.push_back({loop[q], loop[ear.at], loop[p]});
    stamps[ear.at] = 0;
    after[p] = q;
    before[q] = p;
    push(p);
    push(q);
    --left;
  }
  return out;
}

}  // namespace

std::vector<Edge> boundary_chain(std::span<const Triangle> corners) {
  const EdgeTable edges(corners);
  std::vector<Edge> chain;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::int64_t surplus = balance(edges[e]);
    const std::uint32_t low = edges[e][0].low, high = edges[e][0].high;
    for (std::int64_t k = 0; k < surplus; ++k) chain.push_back({low, high});
    for (std::int64_t k = 0; k < -surplus; ++k) chain.push_back({high, low});
  }
  return chain;
}

std::vector<Cap> cap_boundary(std::span<const Vec3> vertices, std::vector<Edge> chain) {
  std::vector<Cap> caps;
  std::sort(chain.begin(), chain.end());
  constexpr std::uint32_t kNot = 0xffff'ffff;
  // Of each vertex its next edge, and where it is on the path that is being followed.
  std::vector<std::uint32_t> next(vertices.size(), kNot), place(vertices.size(), kNot);
  for (std::uint32_t e = std::uint32_t(chain.size()); e-- > 0;) next[chain[e][0]] = e;
  std::vector<std::uint32_t> path;
  const auto unused = [&](std::uint32_t v) {
    return next[v] != kNot && next[v] < chain.size() && chain[next[v]][0] == v;
  };
  for (const Edge& edge : chain) {
    const std::uint32_t start = edge[0];
    if (!unused(start)) continue;
    path = {start};
    place[start] = 0;
    // As many edges begin at a vertex as end there, so the path is stuck nowhere but at its start.
    while (unused(path.back())) {
      const std::uint32_t to = chain[next[path.back()]++][1];
      if (place[to] == kNot) {
        place[to] = std::uint32_t(path.size());
        path.push_back(to);
        continue;
      }
      std::vector<std::uint32_t> loop(path.begin() + place[to], path.end());
      for (std::size_t k = 1; k < loop.size(); ++k) place[loop[k]] = kNot;
      path.resize(place[to] + 1);
      std::vector<Triangle> triangles = cap_loop(vertices, loop);
      caps.push_back({std::move(loop), std::move(triangles)});
    }
    place[start] = kNot;
  }
  return caps;
}

}  // namespace mesocell
