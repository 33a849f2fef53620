#include "sdk/membership/thicken.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sdk/membership/mesh_topology.h"

namespace mesocell {
namespace {

constexpr std::size_t kMostTriangles = std::size_t{1} << 25;
/// Wedges are divided until they are no wider than 45°, whose cosine this is less rounding: their chords are
/// then at least cos 22.5° = 0.924 of the radius away.
constexpr double kWidestWedge = 0.7;
/// A bend that leaves a slit narrower than this share of the radius is none.
constexpr double kNoBend = 1e-9;

/// The icosahedron with its edges halved, on the unit sphere: 42 vertices, 80 triangles. Its planes are at
/// least 0.934 away from the centre.
TriangleMesh make_ball() {
  const double golden = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh ball;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-golden, golden}) {
      ball.vertices.push_back(normalize({0, a, b}));
      ball.vertices.push_back(normalize({a, b, 0}));
      ball.vertices.push_back(normalize({b, 0, a}));
    }
  // The faces are the triples of vertices that are an edge apart: at 63.4°, of a cosine of 1/√5.
  const auto neighbours = [&](std::uint32_t i, std::uint32_t k) {
    return dot(ball.vertices[i], ball.vertices[k]) > 0.4;
  };
  std::vector<Triangle> faces;
  for (std::uint32_t i = 0; i < 12; ++i)
    for (std::uint32_t j = i + 1; j < 12; ++j)
      for (std::uint32_t k = j + 1; k < 12; ++k) {
        if (!neighbours(i, j) || !neighbours(j, k) || !neighbours(i, k)) continue;
        const std::vector<Vec3>& v = ball.vertices;
        const bool outward = dot(v[i], cross(v[j], v[k])) > 0;
        faces.push_back(outward ? Triangle{i, j, k} : Triangle{i, k, j});
      }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t i, std::uint32_t k) {
    const auto [at, added] = middles.try_emplace(std::minmax(i, k), std::uint32_t(ball.vertices.size()));
    if (added) ball.vertices.push_back(normalize(ball.vertices[i] + ball.vertices[k]));
    return at->second;
  };
  for (const Triangle& f : faces) {
    const std::uint32_t a = middle(f[0], f[1]), b = middle(f[1], f[2]), c = middle(f[2], f[0]);
    ball.triangles.insert(ball.triangles.end(), {{f[0], a, c}, {f[1], b, a}, {f[2], c, b}, {a, b, c}});
  }
  return ball;
}

class Thickener {
 public:
  Thickener(const TriangleMesh& mesh, double radius, ThickenedMesh& out)
      : vertices_(mesh.vertices),
        triangles_(merge_corners(mesh)),
        edges_(triangles_),
        radius_(radius),
        out_(out.mesh) {
    const Components components = edge_components(triangles_, edges_);
    std::vector<bool> open(components.count, false);
    for (std::size_t e = 0; e < edges_.size(); ++e)
      if (balance(edges_[e]) != 0) open[components.of_triangle[edges_[e][0].triangle]] = true;
    out.thickened_components = std::uint64_t(std::count(open.begin(), open.end(), true));
    open_.assign(triangles_.size(), false);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const std::uint32_t c = components.of_triangle[t];
      open_[t] = c != kNoComponent && open[c];
      if (open_[t]) ++out.thickened_triangles;
      if (c != kNoComponent && !open_[t]) out_.triangles.push_back(mesh.triangles[t]);
    }
    if (!out_.triangles.empty()) out_.vertices = mesh.vertices;
  }

  Status run(const Progress* progress) {
    std::size_t done = 0;
    const std::size_t all = triangles_.size() + edges_.size() + vertices_.size();
    const auto stop = [&]() -> Status {
      if (out_.triangles.size() > kMostTriangles)
        return Error{ErrorCode::kLimit, "its thickened surface would have more than " +
                                            std::to_string(kMostTriangles) +
                                            " triangles; simplify the mesh in a mesh editor"};
      if (done++ % 4096 != 0 || !progress) return {};
      if (progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
      if (progress->report) progress->report("thicken", double(done) / double(all));
      return {};
    };
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (Status status = stop(); !status) return status;
      if (open_[t]) add_plate(triangles_[t]);
    }
    std::vector<bool> bends(vertices_.size(), false);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (Status status = stop(); !status) return status;
      const EdgeUse& use = edges_[e][0];
      if (open_[use.triangle] && add_wedges(edges_[e])) bends[use.low] = bends[use.high] = true;
    }
    const TriangleMesh ball = make_ball();
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      if (Status status = stop(); !status) return status;
      if (bends[v]) add_ball(ball, vertices_[v]);
    }
    return {};
  }

 private:
  /// A closed prism; both triangles turn counter-clockwise seen from where `b` is.
  void add_prism(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
    const auto v = std::uint32_t(out_.vertices.size());
    out_.vertices.insert(out_.vertices.end(), a.begin(), a.end());
    out_.vertices.insert(out_.vertices.end(), b.begin(), b.end());
    out_.triangles.push_back({v, v + 2, v + 1});
    out_.triangles.push_back({v + 3, v + 4, v + 5});
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t p = v + k, q = v + (k + 1) % 3;
      out_.triangles.push_back({p, q, q + 3});
      out_.triangles.push_back({p, q + 3, p + 3});
    }
  }

  /// The unit normal; zero for a triangle without area.
  [[nodiscard]] Vec3 normal(const Triangle& t) const {
    const Vec3 a = vertices_[t[0]], u = vertices_[t[1]] - a, v = vertices_[t[2]] - a;
    // Scaled, so that the product of tiny or huge sides is still a number.
    const double size = std::max(length(u), length(v));
    return size > 0 ? normalize(cross(u / size, v / size)) : Vec3{};
  }

  void add_plate(const Triangle& t) {
    const Vec3 up = normal(t) * radius_;
    if (up == Vec3{}) return;
    const std::array<Vec3, 3> p{vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
    add_prism({p[0] - up, p[1] - up, p[2] - up}, {p[0] + up, p[1] + up, p[2] + up});
  }

  /// What is nearest to an edge: seen along it, the directions at a right angle or more from all its
  /// triangles, which is one wedge or nothing. Whether there is one.
  bool add_wedges(std::span<const EdgeUse> uses) {
    const Vec3 p = vertices_[uses[0].low], q = vertices_[uses[0].high];
    const Vec3 along = normalize(q - p);
    std::vector<Vec3> into;  // from the edge into its triangles, at right angles to it
    for (const EdgeUse& use : uses) {
      // The edge as the triangle runs along it has the triangle on its left, seen from where its normal is.
      const Vec3 u = cross(normal(triangles_[use.triangle]), along * double(use.direction));
      if (u != Vec3{}) into.push_back(normalize(u));
    }
    if (into.empty()) {
      const std::size_t axis = std::abs(along.x) < 0.5   ? 0
                               : std::abs(along.y) < 0.5 ? 1
                                                         : 2;  // not both are greater
      Vec3 other;
      other[axis] = 1;
      const Vec3 x = normalize(cross(along, other)), y = cross(along, x);
      for (const auto& [from, to] : {std::pair{x, y}, {y, -x}, {-x, -y}, {-y, x}}) divide(p, q, from, to, {});
      return true;
    }
    // By angle from the first, counter-clockwise about the edge.
    const Vec3 x = into[0], y = cross(along, x);
    const auto half = [&](Vec3 u) {
      const double s = dot(u, y);
      return s > 0 || (s == 0 && dot(u, x) > 0) ? 0 : 1;
    };
    std::sort(into.begin() + 1, into.end(), [&](Vec3 a, Vec3 b) {
      if (half(a) != half(b)) return half(a) < half(b);
      return dot(along, cross(a, b)) > 0;
    });
    // Triangles that lie on each other count as one, also where the circle begins.
    const auto same = [](Vec3 a, Vec3 b) { return length(a - b) <= kNoBend; };
    into.erase(std::unique(into.begin(), into.end(), same), into.end());
    while (into.size() > 1 && same(into.back(), into.front())) into.pop_back();
    for (std::size_t k = 0; k < into.size(); ++k) {
      const Vec3 u = into[k], v = into[(k + 1) % into.size()];
      // The angle from one to the next is over 180°, or all of 360°.
      const bool wide = into.size() == 1 || dot(along, cross(u, v)) < 0;
      if (!wide) continue;
      const Vec3 from = cross(along, u), to = -cross(along, v);
      if (length(from - to) <= kNoBend && dot(u, v) < 0) continue;
      divide(p, q, from, to, normalize(-(u + v)));
      return true;
    }
    return false;
  }

  /// Wedges from one direction to another, counter-clockwise about the edge. `middle` is used where their sum
  /// is a poor one.
  void divide(Vec3 p, Vec3 q, Vec3 from, Vec3 to, Vec3 middle) {
    const double cosine = dot(from, to);
    if (cosine >= kWidestWedge) {
      const Vec3 a = from * radius_, b = to * radius_;
      add_prism({p, p + a, p + b}, {q, q + a, q + b});
      return;
    }
    const Vec3 half = cosine > -0.5 ? normalize(from + to) : middle;
    divide(p, q, from, half, {});
    divide(p, q, half, to, {});
  }

  void add_ball(const TriangleMesh& ball, Vec3 centre) {
    const auto first = std::uint32_t(out_.vertices.size());
    for (const Vec3& v : ball.vertices) out_.vertices.push_back(centre + v * radius_);
    for (const Triangle& t : ball.triangles)
      out_.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }

  const std::vector<Vec3>& vertices_;
  const std::vector<Triangle> triangles_;
  const EdgeTable edges_;
  const double radius_;
  TriangleMesh& out_;
  std::vector<bool> open_;  ///< triangles of open components
};

}  // namespace

Result<ThickenedMesh> thicken(const TriangleMesh& mesh, double thickness, const Progress* progress) {
  if (!(thickness > 0) || !std::isfinite(thickness))
    return Error{ErrorCode::kUsage, "the thickness must be a finite number of metres above 0"};
  ThickenedMesh out;
  if (Status status = Thickener(mesh, thickness / 2, out).run(progress); !status) return status.error();
  return out;
}

}  // namespace mesocell
