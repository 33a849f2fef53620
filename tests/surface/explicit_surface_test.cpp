#include "sdk/surface/explicit_surface.h"

#include <atomic>
#include <map>
#include <set>
#include <tuple>

#include "format/normal_map.h"
#include "sdk/core/srgb.h"
#include "sdk/surface/normals.h"
#include "sdk/trace/cell_object_caster.h"
#include "sdk/trace/inside_pieces.h"
#include "tests/support/catch.h"
#include "tests/support/objects.h"
#include "tests/support/voxel_objects.h"

using namespace mesocell;

namespace {

using Point = std::array<std::int32_t, 3>;
using Face = std::tuple<Point, int>;

/// Whether voxels of an object are INSIDE, one by one.
class Oracle {
 public:
  explicit Oracle(const CellObject& o, std::optional<TileBox> box = {})
      : o_(o), box_(box ? *box : TileBox{{0, 0, 0}, o.grid.tiles}) {}

  [[nodiscard]] bool inside(const Point& v) const {
    Index3 t{}, l{};
    for (std::size_t a = 0; a < 3; ++a) {
      const std::uint32_t r = o_.tile.resolution[a];
      if (v[a] < std::int32_t(box_.begin[a] * r) || v[a] >= std::int32_t(box_.end[a] * r)) return false;
      t[a] = std::uint32_t(v[a]) / r;
      l[a] = std::uint32_t(v[a]) % r;
    }
    const std::uint32_t id = o_.tile.id(o_.tile.voxel_index(l[0], l[1], l[2]));
    if (id == 0) return false;
    const Piece& p = o_.tile.pieces[id - 1];
    std::array<std::int64_t, 3> h{};
    for (std::size_t a = 0; a < 3; ++a) {
      h[a] = std::int64_t{t[a]} + p.home[a];
      if (h[a] < 0 || h[a] >= o_.grid.tiles[a]) return false;
    }
    const auto home = o_.grid.tile_index(std::uint32_t(h[0]), std::uint32_t(h[1]), std::uint32_t(h[2]));
    return o_.membership.tag(home, p.cell) == Tag::kInside;
  }

  /// Calls body(voxel) for those that are INSIDE.
  template <typename Body>
  void each(const Body& body) const {
    Point v{}, end{};
    for (std::size_t a = 0; a < 3; ++a) end[a] = std::int32_t(o_.grid.tiles[a] * o_.tile.resolution[a]);
    for (v[2] = 0; v[2] < end[2]; ++v[2])
      for (v[1] = 0; v[1] < end[1]; ++v[1])
        for (v[0] = 0; v[0] < end[0]; ++v[0])
          if (inside(v)) body(v);
  }

  [[nodiscard]] std::set<Face> faces() const {
    std::set<Face> out;
    each([&](const Point& v) {
      for (int face = 0; face < 6; ++face) {
        Point next = v;
        next[std::size_t(face / 2)] += face % 2 ? 1 : -1;
        if (!inside(next)) out.insert({v, face});
      }
    });
    return out;
  }

 private:
  const CellObject& o_;
  TileBox box_;
};

std::int64_t six_volumes(const ExplicitSurface& s) {
  std::int64_t sum = 0;
  for (std::uint64_t k = 0; k < s.triangle_count(); ++k) {
    const Triangle t = s.triangle(k);
    const auto at = [&](std::size_t c, std::size_t a) { return std::int64_t{s.vertices[t[c]][a]}; };
    sum += at(0, 0) * (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)) -
           at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0)) +
           at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0));
  }
  return sum;
}

/// Of what is wrong with it as a closed oriented manifold.
std::string manifold_faults(const ExplicitSurface& s) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> around;  // of a vertex: from, to
  for (std::uint64_t k = 0; k < s.triangle_count(); ++k) {
    const Triangle t = s.triangle(k);
    for (std::size_t c = 0; c < 3; ++c) {
      if (++edges[{t[c], t[(c + 1) % 3]}] > 1) return "an edge has two triangles on one side";
      around[t[c]][t[(c + 1) % 3]] = t[(c + 2) % 3];
    }
  }
  for (const auto& [edge, count] : edges)
    if (!edges.contains({edge.second, edge.first})) return "an edge has one triangle";
  if (around.size() != s.vertices.size()) return "a vertex has no triangle";
  for (const auto& [vertex, ring] : around) {
    std::size_t length = 0;
    std::uint32_t at = ring.begin()->first;
    do {
      at = ring.at(at);
      ++length;
    } while (at != ring.begin()->first && length <= ring.size());
    if (length != ring.size()) return "a vertex has several fans";
  }
  return "";
}

void check(const CellObject& o, const SurfaceOptions& options = {}) {
  const Oracle oracle(o, options.tiles);
  const auto made = make_explicit_surface(o, options);
  REQUIRE(made.ok());
  std::set<Face> faces;
  for (std::size_t k = 0; k < made->squares.size(); ++k) {
    const SquareFace f = face_of_square(*made, k);
    REQUIRE(faces.insert({f.voxel, f.face}).second);
    // Corners are those of the voxel's face, and turn about its normal.
    const auto axis = std::size_t(f.face / 2), u = (axis + 1) % 3, w = (axis + 2) % 3;
    Point low = f.voxel;
    low[axis] += f.face % 2;
    Point high = low;
    ++high[u];
    ++high[w];
    const auto& q = made->squares[k];
    REQUIRE(made->vertices[q[0]] == low);
    REQUIRE(made->vertices[q[2]] == high);
    Point second = low;
    ++second[f.face % 2 ? u : w];
    REQUIRE(made->vertices[q[1]] == second);
  }
  REQUIRE(faces == oracle.faces());
  REQUIRE(*count_surface_faces(o, options) == faces.size());
  std::int64_t voxels = 0;
  oracle.each([&](const Point&) { ++voxels; });
  REQUIRE(six_volumes(*made) == 6 * voxels);
  REQUIRE(manifold_faults(*made) == "");
  const std::set<Point> places(made->vertices.begin(), made->vertices.end());
  REQUIRE(made->split_vertices == made->vertices.size() - places.size());
}

}  // namespace

TEST_CASE("the surface of every 2 x 2 x 2 voxels is a closed manifold") {
  std::size_t split = 0;
  for (unsigned c = 0; c < 256; ++c) {
    INFO("configuration " << c);
    // In the middle of a tile, and around a corner of eight.
    for (const std::uint32_t low : {1u, 3u}) {
      const auto o = test::make_voxels({2, 2, 2}, [&](auto x, auto y, auto z) {
        const unsigned dx = x - low, dy = y - low, dz = z - low;
        return dx < 2 && dy < 2 && dz < 2 && (c >> (dx + 2 * dy + 4 * dz) & 1);
      });
      check(o);
      split += make_explicit_surface(o)->split_vertices;
    }
  }
  CHECK(split > 0);
}

TEST_CASE("an edge whose faces are of one fan at both ends is turned") {
  // Two voxels that take turns with empty ones, between two full layers.
  const auto o = test::make_voxels(
      {1, 1, 1}, [](auto x, auto y, auto z) { return x < 2 && y < 2 && z < 3 && (z != 1 || x == y); });
  check(o);
  CHECK(make_explicit_surface(o)->split_vertices == 2);
}

TEST_CASE("the surface of random voxels is each face once, closed, of the voxels' volume") {
  Rng rng(1);
  for (int round = 0; round < 40; ++round) {
    INFO("round " << round);
    const double share = rng.uniform(0.1, 0.9);
    const Index3 tiles{1 + rng.below(3), 1 + rng.below(3), 1 + rng.below(3)};
    check(test::make_voxels(tiles, [&](auto, auto, auto) { return rng.uniform() < share; }));
  }
}

TEST_CASE("the surface of cells that cross tiles, of empty space and of boxes of tiles") {
  Rng rng(2);
  for (const char* recipe :
       {"voronoi:cells=5,resolution=8,seed=3", "spheres:cells=3,resolution=7x8x9,seed=1"})
    for (int round = 0; round < 4; ++round) {
      INFO(recipe << ", round " << round);
      const CellObject o = test::random_object(rng, recipe, {3, 2, 4}, 0.7);
      check(o);
      SurfaceOptions options;
      options.tiles = TileBox{{1, 0, 1}, {3, 2, 3}};
      check(o, options);
    }
  // A file may say of instances that leave the grid that they are INSIDE.
  CellObject all = test::random_object(rng, "voronoi:cells=5,resolution=8,seed=3", {2, 3, 2}, 0.5);
  all.membership.entries.assign(12, std::uint32_t(Tag::kInside));
  all.membership.blocks.clear();
  check(all);
  CellObject none = all;
  none.membership.entries.assign(12, std::uint32_t(Tag::kOutside));
  CHECK(make_explicit_surface(none)->squares.empty());
}

TEST_CASE("the surface does not depend on threads, and is refused where it has too many faces") {
  Rng rng(3);
  CellObject o = test::random_object(rng, "voronoi:cells=6,resolution=16,seed=3", {5, 5, 5}, 0.6);
  o.cell_colors =
      ColorList{{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {10, 20, 30}, {200, 200, 0}, {9, 9, 9}}, 0};
  SurfaceOptions options;
  options.colors = true;
  options.normals = SurfaceNormals::kShading;
  options.threads = 1;
  const auto one = make_explicit_surface(o, options);
  options.threads = 3;
  const auto three = make_explicit_surface(o, options);
  REQUIRE(one.ok());
  REQUIRE(three.ok());
  CHECK(one->vertices == three->vertices);
  CHECK(one->squares == three->squares);
  CHECK(one->colors == three->colors);
  CHECK(one->normals == three->normals);

  options.max_faces = one->squares.size();
  CHECK(make_explicit_surface(o, options).ok());
  --options.max_faces;
  const auto refused = make_explicit_surface(o, options);
  REQUIRE(!refused.ok());
  CHECK(refused.error().code == ErrorCode::kLimit);
  CHECK(refused.error().message.find(std::to_string(one->squares.size())) != std::string::npos);
  CHECK(refused.error().message.find("MiB") != std::string::npos);

  options.tiles = TileBox{{0, 0, 0}, {6, 1, 1}};
  CHECK(make_explicit_surface(o, options).error().code == ErrorCode::kUsage);
  const std::atomic<bool> stop = true;
  Progress progress;
  progress.cancel = &stop;
  CHECK(make_explicit_surface(o, {}, &progress).error().code == ErrorCode::kCancelled);
}

TEST_CASE("vertices have the mean color and normal of the faces around them") {
  // One voxel alone, and a slab far from it, of two cells' colors.
  CellObject o = test::make_voxels(
      {3, 3, 3}, [](auto x, auto y, auto z) { return (x == 1 && y == 1 && z == 1) || (y == 8 && x > 1); });
  o.cell_colors = ColorList{std::vector<Rgb8>(64, Rgb8{255, 255, 255}), 0};
  o.cell_colors->colors[1 + 4 + 16] = {188, 0, 64};
  o.normals = make_normal_map(o.tile);
  SurfaceOptions options;
  options.colors = true;
  options.normals = SurfaceNormals::kShading;
  const auto shaded = make_explicit_surface(o, options);
  REQUIRE(shaded.ok());
  options.normals = SurfaceNormals::kStored;
  const auto stored = make_explicit_surface(o, options);
  REQUIRE(stored.ok());
  std::size_t single = 0, flat = 0;
  for (std::size_t v = 0; v < shaded->vertices.size(); ++v) {
    const Point& p = shaded->vertices[v];
    const auto& n = shaded->normals[v];
    CHECK(std::abs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-6f);
    CHECK(stored->normals[v].size() == 3);
    if (p[0] <= 2 && p[1] <= 2 && p[2] <= 2) {
      CHECK(shaded->colors[v] == Rgb8{188, 0, 64});
      ++single;
      // It is one voxel, whose gradient balances out: faces, three to a vertex.
      for (std::size_t a = 0; a < 3; ++a) CHECK(std::abs(n[a]) == Approx(1 / std::sqrt(3.0)));
    } else if (p[0] == 7 && p[2] == 6) {
      // As far from the rim as the gradient reaches, so that it balances out.
      ++flat;
      CHECK(n[1] == (p[1] == 8 ? -1.0f : 1.0f));
    }
  }
  CHECK(single == 8);
  CHECK(flat == 2);
  o.normals.reset();
  CHECK(make_explicit_surface(o, options).error().code == ErrorCode::kUsage);
}

TEST_CASE("colors of vertices are what a caster finds at faces of one color") {
  Rng rng(5);
  CellObject o = test::random_object(rng, "voronoi:cells=4,resolution=8,seed=1", {2, 2, 2}, 1.0);
  o.color = ColorMap{{2, 2, 2}, {}, 0};
  for (std::uint8_t k = 0; k < 8; ++k) o.color->voxels.push_back({std::uint8_t(30 * k), 255, 128});
  o.cell_colors = ColorList{{{255, 200, 0}, {1, 2, 3}, {9, 255, 7}, {255, 255, 255}}, 0};
  o.instance_colors = ColorList{{}, 0};
  for (std::uint64_t k = 0; k < count_instances(o.membership).inside; ++k)
    o.instance_colors->colors.push_back({std::uint8_t(40 * k), std::uint8_t(255 - k), 99});
  SurfaceOptions options;
  options.colors = true;
  const auto s = make_explicit_surface(o, options);
  REQUIRE(s.ok());
  const auto caster = make_cell_object_caster(o, "exact");
  std::map<std::uint32_t, std::pair<Vec3, int>> sums;
  for (std::size_t k = 0; k < s->squares.size(); ++k) {
    // A ray against the face, from half a voxel before it; it begins in a neighbour that is not inside.
    const SquareFace f = face_of_square(*s, k);
    const auto axis = std::size_t(f.face / 2);
    Ray ray;
    for (std::size_t a = 0; a < 3; ++a) ray.origin[a] = f.voxel[a] + 0.5;
    ray.origin[axis] += f.face % 2 ? 0.9 : -0.9;
    ray.direction[axis] = f.face % 2 ? -1 : 1;
    Hit hit;
    REQUIRE((*caster)->first_hit(ray, hit));
    const Vec3 color = (*caster)->color(hit, ray.origin + ray.direction * hit.t);
    for (const std::uint32_t v : s->squares[k]) {
      sums[v].first = sums[v].first + color;
      ++sums[v].second;
    }
  }
  for (const auto& [v, sum] : sums) {
    const Rgb8 expected = linear_to_srgb8(sum.first / sum.second);
    for (std::size_t a = 0; a < 3; ++a) CHECK(std::abs(int{expected[a]} - s->colors[v][a]) <= 1);
  }
}

TEST_CASE("surfaces of cells are those of one instance, across borders of tiles") {
  Rng rng(6);
  CellObject o = test::random_object(rng, "voronoi:cells=6,resolution=9x8x7,seed=2", {5, 5, 5}, 0.0);
  const auto cells = make_cell_surfaces(o.tile, 1 << 24);
  REQUIRE(cells.ok());
  REQUIRE(cells->size() == 6);
  for (std::uint16_t c = 1; c <= 6; ++c) {
    // The instance at home in the middle.
    o.membership.entries.assign(125, std::uint32_t(Tag::kOutside));
    o.membership.entries[62] = MembershipMap::kFirstBlock;
    o.membership.blocks.assign(o.membership.block_bytes(), 0);
    o.membership.blocks[(c - 1u) / 4] = std::uint8_t(1u << (2 * ((c - 1) % 4)));
    const auto whole = make_explicit_surface(o);
    REQUIRE(whole.ok());
    const ExplicitSurface& cell = (*cells)[c - 1];
    CHECK(manifold_faults(cell) == "");
    CHECK(six_volumes(cell) == six_volumes(*whole));
    std::set<Face> a, b;
    for (std::size_t k = 0; k < whole->squares.size(); ++k) {
      SquareFace f = face_of_square(*whole, k);
      for (std::size_t x = 0; x < 3; ++x) f.voxel[x] -= std::int32_t(2 * o.tile.resolution[x]);
      a.insert({f.voxel, f.face});
    }
    for (std::size_t k = 0; k < cell.squares.size(); ++k) {
      const SquareFace f = face_of_square(cell, k);
      b.insert({f.voxel, f.face});
    }
    CHECK(a == b);
  }
  CHECK(make_cell_surfaces(o.tile, 1000).error().code == ErrorCode::kLimit);
}

TEST_CASE("an instance is exposed if one of its faces is on the surface") {
  Rng rng(7);
  std::size_t buried = 0;
  for (int round = 0; round < 4; ++round) {
    CellObject o = round % 2
                       ? test::random_object(rng, "voronoi:cells=4,resolution=8,seed=2", {5, 5, 5}, 0.97)
                       : test::random_object(rng, "voronoi:cells=1,resolution=8,seed=2", {5, 5, 5}, 1.0);
    if (round < 2) {
      o.membership.entries.assign(125, std::uint32_t(Tag::kInside));
      o.membership.blocks.clear();
    }
    std::set<std::pair<std::uint64_t, std::uint32_t>> shown;
    for (const auto& [v, face] : Oracle(o).faces()) {
      Index3 t{}, l{};
      for (std::size_t a = 0; a < 3; ++a) {
        t[a] = std::uint32_t(v[a]) / 8;
        l[a] = std::uint32_t(v[a]) % 8;
      }
      const Piece& p = o.tile.pieces[o.tile.id(o.tile.voxel_index(l[0], l[1], l[2])) - 1];
      shown.insert({o.grid.tile_index(t[0] + std::uint32_t(p.home[0]), t[1] + std::uint32_t(p.home[1]),
                                      t[2] + std::uint32_t(p.home[2])),
                    p.cell});
    }
    const auto exposed = find_exposed_instances(o, 2);
    REQUIRE(exposed.ok());
    std::size_t k = 0;
    for (std::uint64_t t = 0; t < 125; ++t)
      for (std::uint32_t c = 1; c <= o.tile.cell_count; ++c) {
        if (o.membership.tag(t, c) != Tag::kInside) continue;
        REQUIRE(bool((*exposed)[k]) == shown.contains({t, c}));
        buried += !(*exposed)[k++];
      }
    REQUIRE(k == exposed->size());
  }
  CHECK(buried > 10);
}
