#include "sdk/membership/stitch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "sdk/core/box_tree.h"
#include "sdk/membership/mesh_topology.h"

namespace mesocell {
namespace {

/// Of the diagonal; some hundred times what single precision makes of coordinates.
constexpr double kDefaultTolerance = 1e-5;
/// A vertex may move by this share of its shortest edge: both ends of an edge together by half of it.
constexpr double kOfShortestEdge = 0.25;
/// Cuts can make way for others, as where edges overlap in turn; few rounds do in practice.
constexpr int kMostRounds = 8;
constexpr std::uint64_t kNeighboursPerEdge = 256;
/// Vertices that may become one.
constexpr std::size_t kMostMerged = 64;

constexpr std::uint32_t kNone = 0xffff'ffff;

struct BoundaryEdge {
  std::uint32_t from, to;  ///< as its triangle runs
  std::uint32_t triangle;
};

/// Boundary edges and their vertices, named by places in `vertices`.
struct Boundary {
  std::vector<BoundaryEdge> edges;
  std::vector<std::uint32_t> vertices;  ///< of the mesh, ascending
  std::vector<bool> has_copies;         ///< triangles that others coincide with
  // Edges at the vertex of place v: edges_at[first[v]] … edges_at[first[v + 1]].
  std::vector<std::uint32_t> first, edges_at;

  [[nodiscard]] std::span<const std::uint32_t> at(std::uint32_t v) const {
    return std::span(edges_at).subspan(first[v], first[v + 1] - first[v]);
  }
};

Boundary find_boundary(std::span<const Triangle> triangles) {
  Boundary b;
  b.has_copies.assign(triangles.size(), false);
  std::vector<Triangle> distinct(triangles.begin(), triangles.end());
  for (const CoincidentTriangles& set : coincident_triangles(triangles))
    for (std::size_t k = 0; k < set.triangles.size(); ++k) {
      b.has_copies[set.triangles[k]] = true;
      if (k > 0) distinct[set.triangles[k]] = {0, 0, 0};  // left out of edges
    }
  const EdgeTable table(distinct);
  for (std::size_t e = 0; e < table.size(); ++e) {
    if (table[e].size() != 1) continue;
    const EdgeUse& use = table[e][0];
    b.edges.push_back(use.direction > 0 ? BoundaryEdge{use.low, use.high, use.triangle}
                                        : BoundaryEdge{use.high, use.low, use.triangle});
    b.vertices.insert(b.vertices.end(), {use.low, use.high});
  }
  std::sort(b.vertices.begin(), b.vertices.end());
  b.vertices.erase(std::unique(b.vertices.begin(), b.vertices.end()), b.vertices.end());
  const auto place = [&](std::uint32_t v) {
    return std::uint32_t(std::lower_bound(b.vertices.begin(), b.vertices.end(), v) - b.vertices.begin());
  };
  b.first.assign(b.vertices.size() + 1, 0);
  for (BoundaryEdge& e : b.edges) {
    e.from = place(e.from);
    e.to = place(e.to);
    ++b.first[e.from + 1];
    ++b.first[e.to + 1];
  }
  for (std::size_t v = 0; v < b.vertices.size(); ++v) b.first[v + 1] += b.first[v];
  b.edges_at.resize(2 * b.edges.size());
  std::vector<std::uint32_t> next(b.first.begin(), b.first.end() - 1);
  for (std::uint32_t e = 0; e < b.edges.size(); ++e) {
    b.edges_at[next[b.edges[e].from]++] = e;
    b.edges_at[next[b.edges[e].to]++] = e;
  }
  return b;
}

/// A point's foot on a segment, if it is between its ends.
struct Foot {
  double t;         ///< 0 at p, 1 at q
  double distance;  ///< from the line
};

Foot foot(Vec3 p, Vec3 q, Vec3 m) {
  const Vec3 d = q - p;
  const double t = dot(m - p, d) / dot(d, d);
  return {t, length(m - (p + d * t))};
}

class Stitcher {
 public:
  Stitcher(StitchedMesh& out, const Progress* progress)
      : out_(out),
        progress_(progress),
        vertices_(out.mesh.vertices),
        merged_(merge_identical_vertices(vertices_)) {
    for (const Triangle& t : out.mesh.triangles)
      triangles_.push_back({merged_[t[0]], merged_[t[1]], merged_[t[2]]});
  }

  void run() {
    boundary_ = find_boundary(triangles_);
    if (boundary_.edges.empty()) return;
    budget_ = kNeighboursPerEdge * (boundary_.edges.size() + 64);
    measure_tolerances();
    const std::size_t before = boundary_.edges.size();
    for (int round = 0; round < kMostRounds && cut_edges(); ++round) boundary_ = find_boundary(triangles_);
    merge_edges();
    out_.stitched_edges = before + out_.inserted_vertices - find_boundary(triangles_).edges.size();
  }

 private:
  /// How far each vertex may be from one that it becomes one with.
  void measure_tolerances() {
    tolerance_.assign(vertices_.size(), out_.tolerance);
    for (const Triangle& t : triangles_)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t p = t[k], q = t[(k + 1) % 3];
        if (p == q) continue;
        const double most = kOfShortestEdge * length(vertices_[q] - vertices_[p]);
        tolerance_[p] = std::min(tolerance_[p], most);
        tolerance_[q] = std::min(tolerance_[q], most);
      }
  }

  [[nodiscard]] Vec3 point(std::uint32_t place) const { return vertices_[boundary_.vertices[place]]; }
  [[nodiscard]] double tolerance(std::uint32_t place) const { return tolerance_[boundary_.vertices[place]]; }
  /// Whether two vertices of the boundary may become one.
  [[nodiscard]] bool near(std::uint32_t a, std::uint32_t b) const {
    return length(point(a) - point(b)) <= std::min(tolerance(a), tolerance(b));
  }

  [[nodiscard]] BoxTree vertex_tree() const {
    std::vector<Box3> boxes(boundary_.vertices.size());
    for (std::uint32_t v = 0; v < boxes.size(); ++v) boxes[v].add(point(v));
    return BoxTree(boxes);
  }

  /// Calls `visit(place)` for the boundary's vertices in a box until the budget is spent.
  template <class Visit>
  void visit_near(const BoxTree& tree, Box3 box, Visit&& visit) {
    const Vec3 room{out_.tolerance, out_.tolerance, out_.tolerance};
    box.min = box.min - room;
    box.max = box.max + room;
    tree.visit_overlapping(box, [&](std::uint32_t k) {
      if (budget_ == 0) return false;
      --budget_;
      visit(tree.order()[k]);
      return true;
    });
  }

  // Cutting edges.

  /// The vertices that lie along an edge, between its ends, and belong to edges that run along it.
  struct Cut {
    std::uint32_t edge;
    std::vector<std::uint32_t> at;  ///< places, from the edge's first end on
    double bend = 0;                ///< the most that the edge is bent, metres
  };

  bool cut_edges() {
    const BoxTree tree = vertex_tree();
    double total = 0;
    for (const BoundaryEdge& e : boundary_.edges) total += length(point(e.to) - point(e.from));
    // Boxes of long slanted edges would hold nearly everything, so they are looked at in pieces.
    const double piece = total / (4.0 * double(boundary_.edges.size()));
    std::vector<Cut> cuts;
    for (std::uint32_t e = 0; e < boundary_.edges.size(); ++e) {
      if (e % 1024 == 0 && progress_ && progress_->cancelled()) return false;
      Cut cut = find_cut(tree, e, piece);
      if (!cut.at.empty()) cuts.push_back(std::move(cut));
    }
    // A triangle is cut from one edge a round, so pieces are triangles with the vertex opposite.
    std::vector<std::uint32_t> best(triangles_.size(), kNone);
    for (std::uint32_t c = 0; c < cuts.size(); ++c) {
      std::uint32_t& b = best[boundary_.edges[cuts[c].edge].triangle];
      if (b == kNone || cuts[c].at.size() > cuts[b].at.size()) b = c;
    }
    bool changed = false;
    for (std::uint32_t c = 0; c < cuts.size(); ++c) {
      if (best[boundary_.edges[cuts[c].edge].triangle] != c) continue;
      apply(cuts[c]);
      changed = true;
    }
    return changed;
  }

  Cut find_cut(const BoxTree& tree, std::uint32_t edge, double piece) {
    Cut cut{edge, {}, 0};
    const BoundaryEdge& e = boundary_.edges[edge];
    if (boundary_.has_copies[e.triangle]) return cut;
    const Vec3 p = point(e.from), q = point(e.to);
    const double size = length(q - p);
    std::uint32_t opposite = 0;
    for (const std::uint32_t v : triangles_[e.triangle])
      if (v != boundary_.vertices[e.from] && v != boundary_.vertices[e.to]) opposite = v;
    const double height = foot(p, q, vertices_[opposite]).distance;
    const double most = std::min({out_.tolerance, kOfShortestEdge * size, kOfShortestEdge * height});
    if (!(most > 0)) return cut;

    std::vector<std::uint32_t> near_edge;
    const auto pieces = std::uint32_t(std::min(65536.0, std::ceil(size / piece)));
    for (std::uint32_t k = 0; k < pieces; ++k) {
      Box3 box;
      box.add(p + (q - p) * (double(k) / pieces));
      box.add(p + (q - p) * (double(k + 1) / pieces));
      visit_near(tree, box, [&](std::uint32_t v) { near_edge.push_back(v); });
    }
    std::sort(near_edge.begin(), near_edge.end());
    near_edge.erase(std::unique(near_edge.begin(), near_edge.end()), near_edge.end());

    struct Along {
      double t;
      std::uint32_t vertex;
      double distance;
    };
    std::vector<Along> between;
    for (const std::uint32_t v : near_edge) {
      const Foot f = foot(p, q, point(v));
      if (v == e.from || v == e.to || near(v, e.from) || near(v, e.to)) continue;
      if (f.t > 0 && f.t < 1 && f.distance <= std::min(most, tolerance(v)) && runs_along(v, edge, most))
        between.push_back({f.t, v, f.distance});
    }
    std::sort(between.begin(), between.end(), [](const Along& a, const Along& b) {
      return std::tie(a.t, a.vertex) < std::tie(b.t, b.vertex);
    });
    for (const Along& a : between) {
      // The other of two that are near becomes one with the first later.
      if (!cut.at.empty() && near(a.vertex, cut.at.back())) continue;
      cut.at.push_back(a.vertex);
      cut.bend = std::max(cut.bend, a.distance);
    }
    return cut;
  }

  /// Whether a boundary edge at `v` overlaps `edge`: its other end is along it, or one of its ends along
  /// that.
  [[nodiscard]] bool runs_along(std::uint32_t v, std::uint32_t edge, double most) const {
    const BoundaryEdge& e = boundary_.edges[edge];
    const auto along = [&](std::uint32_t a, std::uint32_t b, std::uint32_t m) {
      if (m == a || m == b || near(m, a) || near(m, b)) return true;
      const Foot f = foot(point(a), point(b), point(m));
      return f.t > 0 && f.t < 1 && f.distance <= most;
    };
    return std::any_of(boundary_.at(v).begin(), boundary_.at(v).end(), [&](std::uint32_t other) {
      const BoundaryEdge& f = boundary_.edges[other];
      if (other == edge || f.triangle == e.triangle) return false;
      const std::uint32_t end = f.from == v ? f.to : f.from;
      return along(e.from, e.to, end) || along(v, end, e.from) || along(v, end, e.to);
    });
  }

  void apply(const Cut& cut) {
    const BoundaryEdge& e = boundary_.edges[cut.edge];
    // Both lists, as the mesh keeps the vertices that it names.
    const Triangle merged = triangles_[e.triangle], own = out_.mesh.triangles[e.triangle];
    std::size_t k = 0;
    while (merged[k] != boundary_.vertices[e.from]) ++k;
    const std::size_t to = (k + 1) % 3, apex = (k + 2) % 3;
    std::uint32_t own_last = own[k], merged_last = merged[k];
    const auto add = [&](std::uint32_t own_next, std::uint32_t merged_next) {
      const Triangle own_piece{own_last, own_next, own[apex]};
      const Triangle merged_piece{merged_last, merged_next, merged[apex]};
      if (merged_last == merged[k]) {
        out_.mesh.triangles[e.triangle] = own_piece;
        triangles_[e.triangle] = merged_piece;
      } else {
        out_.mesh.triangles.push_back(own_piece);
        triangles_.push_back(merged_piece);
      }
      own_last = own_next;
      merged_last = merged_next;
    };
    for (const std::uint32_t v : cut.at) add(boundary_.vertices[v], boundary_.vertices[v]);
    add(own[to], merged[to]);
    out_.inserted_vertices += cut.at.size();
    out_.largest_move = std::max(out_.largest_move, cut.bend);
  }

  // Merging edges.

  struct Pair {
    bool same_way;
    double distance;  ///< the greater of the two between their ends
    std::uint32_t a, b;
  };

  void merge_edges() {
    const std::vector<Pair> pairs = find_pairs();
    std::vector<bool> paired(boundary_.edges.size(), false);
    sets_.assign(boundary_.vertices.size(), {});
    set_of_.resize(boundary_.vertices.size());
    for (std::uint32_t v = 0; v < sets_.size(); ++v) {
      sets_[v] = {v};
      set_of_[v] = v;
    }
    for (const Pair& pair : pairs) {
      if (paired[pair.a] || paired[pair.b]) continue;
      const BoundaryEdge &a = boundary_.edges[pair.a], &b = boundary_.edges[pair.b];
      const std::uint32_t from = pair.same_way ? b.from : b.to, to = pair.same_way ? b.to : b.from;
      if (!can_join(a.from, from) || !can_join(a.to, to)) continue;
      join(a.from, from);
      join(a.to, to);
      paired[pair.a] = paired[pair.b] = true;
    }
    move_vertices();
  }

  std::vector<Pair> find_pairs() {
    const BoxTree tree = vertex_tree();
    std::vector<Pair> pairs;
    for (std::uint32_t e = 0; e < boundary_.edges.size(); ++e) {
      const BoundaryEdge& a = boundary_.edges[e];
      Box3 box;
      box.add(point(a.from));
      visit_near(tree, box, [&](std::uint32_t v) {
        if (v != a.from && !near(v, a.from)) return;
        for (const std::uint32_t other : boundary_.at(v)) {
          const BoundaryEdge& b = boundary_.edges[other];
          // The budget is for hubs, too.
          if (budget_ > 0) --budget_;
          if (budget_ == 0 || other <= e || b.triangle == a.triangle) continue;
          const bool same_way = b.from == v;
          const std::uint32_t end = same_way ? b.to : b.from;
          if (end != a.to && !near(end, a.to)) continue;
          pairs.push_back({same_way,
                           std::max(length(point(v) - point(a.from)), length(point(end) - point(a.to))), e,
                           other});
        }
      });
    }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) {
      return std::tie(x.same_way, x.distance, x.a, x.b) < std::tie(y.same_way, y.distance, y.a, y.b);
    });
    return pairs;
  }

  [[nodiscard]] bool can_join(std::uint32_t a, std::uint32_t b) const {
    const std::vector<std::uint32_t>&p = sets_[set_of_[a]], &q = sets_[set_of_[b]];
    if (&p == &q) return true;
    if (p.size() + q.size() > kMostMerged) return false;
    return std::all_of(p.begin(), p.end(), [&](std::uint32_t x) {
      return std::all_of(q.begin(), q.end(), [&](std::uint32_t y) { return near(x, y); });
    });
  }

  void join(std::uint32_t a, std::uint32_t b) {
    std::uint32_t into = set_of_[a], from = set_of_[b];
    if (into == from) return;
    if (from < into) std::swap(into, from);
    for (const std::uint32_t v : sets_[from]) set_of_[v] = into;
    sets_[into].insert(sets_[into].end(), sets_[from].begin(), sets_[from].end());
    sets_[from].clear();
  }

  void move_vertices() {
    std::vector<std::uint32_t> target(vertices_.size(), kNone);
    for (std::uint32_t s = 0; s < sets_.size(); ++s)
      for (const std::uint32_t v : sets_[s]) {
        if (v == s) continue;
        target[boundary_.vertices[v]] = boundary_.vertices[s];
        out_.largest_move = std::max(out_.largest_move, length(point(v) - point(s)));
      }
    // Targets stay where they are, so the order does not matter.
    for (std::size_t v = 0; v < vertices_.size(); ++v)
      if (target[merged_[v]] != kNone) vertices_[v] = vertices_[target[merged_[v]]];
    for (Triangle& t : triangles_)
      for (std::uint32_t& v : t)
        if (target[v] != kNone) v = target[v];
  }

  StitchedMesh& out_;
  const Progress* progress_;
  std::vector<Vec3>& vertices_;
  std::vector<std::uint32_t> merged_;
  std::vector<Triangle> triangles_;  ///< with merged vertices
  std::vector<double> tolerance_;    ///< of every vertex that stands for those at its place
  Boundary boundary_;
  std::uint64_t budget_ = 0;
  std::vector<std::vector<std::uint32_t>> sets_;  ///< of places that become one, by the least of them
  std::vector<std::uint32_t> set_of_;
};

}  // namespace

StitchedMesh stitch(const TriangleMesh& mesh, const StitchOptions& options, const Progress* progress) {
  StitchedMesh out;
  out.mesh = mesh;
  const Box3 box = bounding_box(mesh);
  if (box.empty()) return out;
  out.tolerance = options.tolerance > 0 ? options.tolerance : kDefaultTolerance * length(box.extent());
  if (!(out.tolerance > 0) || !std::isfinite(out.tolerance)) return out;
  Stitcher(out, progress).run();
  if (!progress || !progress->cancelled()) return out;
  StitchedMesh unchanged;
  unchanged.mesh = mesh;
  unchanged.tolerance = out.tolerance;
  unchanged.interrupted = true;
  return unchanged;
}

}  // namespace mesocell
