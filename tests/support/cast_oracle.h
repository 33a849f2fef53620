#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "format/cell_object.h"
#include "sdk/trace/walk.h"

/// The definition of the exact hit [spec 4.9], evaluated without rounding. Slow and obvious: every time at
/// which the ray meets a plane between voxels, and a time between each two, says which voxels it visits.
namespace mesocell::test {

__extension__ typedef __int128 Wide;

/// A quotient of integers that fit 128 bits through the few operations of a walk.
struct WideRational {
  Wide num = 0, den = 1;  ///< den > 0

  WideRational() = default;
  WideRational(Wide n, Wide d) : num(d < 0 ? -n : n), den(d < 0 ? -d : d) {}
};
inline WideRational operator+(const WideRational& a, const WideRational& b) {
  return {a.num * b.den + b.num * a.den, a.den * b.den};
}
inline WideRational operator*(const WideRational& a, const WideRational& b) {
  return {a.num * b.num, a.den * b.den};
}
inline bool operator<(const WideRational& a, const WideRational& b) { return a.num * b.den < b.num * a.den; }
inline bool operator==(const WideRational& a, const WideRational& b) {
  return a.num * b.den == b.num * a.den;
}
inline std::int64_t floor_of(const WideRational& a) {
  return std::int64_t(a.num >= 0 ? a.num / a.den : -((-a.num + a.den - 1) / a.den));
}
inline double to_double(const WideRational& a) { return double(a.num) / double(a.den); }
inline WideRational middle(const WideRational& a, const WideRational& b) {
  return {a.num * b.den + b.num * a.den, 2 * a.den * b.den};
}

template <typename Q>
struct OracleHit {
  Voxel voxel{};
  Q t{};          ///< the first time at, or right after, which the voxel is visited
  int face = -1;  ///< by which it is entered: 2 · axis, + 1 if the normal points up the axis; -1: the ray
                  ///< begins there
};

/// A cell and the index of the home tile of one of its instances.
struct OracleInstance {
  std::uint32_t cell = 0;
  std::int64_t home = 0;
};

/// The INSIDE instance that voxel `v` of the grid is of, if there is one.
inline std::optional<OracleInstance> instance_at(const CellObject& o, const Voxel& v) {
  std::array<std::int64_t, 3> tile{}, at{}, home{};
  for (std::size_t a = 0; a < 3; ++a) {
    tile[a] = v[a] / o.tile.resolution[a];
    at[a] = v[a] % o.tile.resolution[a];
  }
  const std::uint32_t id =
      o.tile.id(o.tile.voxel_index(std::uint32_t(at[0]), std::uint32_t(at[1]), std::uint32_t(at[2])));
  if (id == 0) return std::nullopt;
  const Piece& p = o.tile.pieces[id - 1];
  for (std::size_t a = 0; a < 3; ++a) {
    home[a] = tile[a] + p.home[a];
    if (home[a] < 0 || home[a] >= o.grid.tiles[a]) return std::nullopt;
  }
  const std::uint64_t index =
      o.grid.tile_index(std::uint32_t(home[0]), std::uint32_t(home[1]), std::uint32_t(home[2]));
  if (o.membership.tag(index, p.cell) != Tag::kInside) return std::nullopt;
  return OracleInstance{p.cell, std::int64_t(index)};
}

/// Whether voxel `v` of the grid is of an INSIDE instance.
inline bool is_inside(const CellObject& o, const Voxel& v) { return instance_at(o, v).has_value(); }

/// By which face a ray enters voxel `v` at `t`. [spec 4.9, Face] -1 if it begins there.
template <typename Q>
int face_by_definition(const std::array<Q, 3>& origin, const std::array<Q, 3>& direction,
                       const std::array<Q, 3>& inverse, const Voxel& v, const Q& t) {
  const Q zero{};
  bool begins = true;
  int rising = -1, falling = -1;
  for (std::size_t a = 3; a-- > 0;) {
    begins = begins && floor_of(origin[a]) == v[a];
    const bool rises = zero < direction[a];
    if (direction[a] == zero || !((Q(v[a] + !rises, 1) + Q(-1, 1) * origin[a]) * inverse[a] == t)) continue;
    (rises ? rising : falling) = int(2 * a) + !rises;
  }
  return begins ? -1 : falling >= 0 ? falling : rising;
}

/// The first visited voxel of an INSIDE instance, for a ray in voxel units.
template <typename Q>
std::optional<OracleHit<Q>> first_hit_by_definition(const CellObject& object, const std::array<Q, 3>& origin,
                                                    const std::array<Q, 3>& direction,
                                                    const std::array<Q, 3>& inverse) {
  const Q zero{};
  const auto voxel_at = [&](const Q& t) {
    Voxel v{};
    for (std::size_t a = 0; a < 3; ++a) v[a] = floor_of(origin[a] + direction[a] * t);
    return v;
  };
  const auto hits = [&](const Voxel& v) {
    for (std::size_t a = 0; a < 3; ++a)
      if (v[a] < 0 || v[a] >= std::int64_t(object.grid.tiles[a]) * object.tile.resolution[a]) return false;
    return is_inside(object, v);
  };
  struct Event {
    Q t;
    std::size_t axis;
  };
  std::vector<Event> events;
  for (std::size_t a = 0; a < 3; ++a) {
    if (direction[a] == zero) continue;
    const std::int64_t n = std::int64_t(object.grid.tiles[a]) * object.tile.resolution[a];
    for (std::int64_t k = 0; k <= n; ++k) {
      const Q t = (Q(k, 1) + Q(-1, 1) * origin[a]) * inverse[a];
      if (!(t < zero)) events.push_back({t, a});
    }
  }
  std::sort(events.begin(), events.end(), [](const Event& p, const Event& q) { return p.t < q.t; });
  const auto hit = [&](const Voxel& v, const Q& t) {
    return OracleHit<Q>{v, t, face_by_definition(origin, direction, inverse, v, t)};
  };
  if (const Voxel v = voxel_at(zero); hits(v)) return hit(v, zero);
  for (std::size_t k = 0; k < events.size(); ++k) {
    const Q& t = events[k].t;
    if (k > 0 && t == events[k - 1].t) continue;
    if (k == 0 && zero < t)
      if (const Voxel v = voxel_at(middle(zero, t)); hits(v)) return hit(v, zero);
    if (const Voxel v = voxel_at(t); hits(v)) return hit(v, t);
    std::size_t next = k + 1;
    while (next < events.size() && events[next].t == t) ++next;
    const Q after = next < events.size() ? middle(t, events[next].t) : t + Q(1, 1);
    if (const Voxel v = voxel_at(after); hits(v)) return hit(v, t);
  }
  return std::nullopt;
}

}  // namespace mesocell::test
