// Rays of a packet: how they are made fit for the walk, bounded by a beam, and begun.
// Included once for each instruction set, by packets.cpp alone.
#if defined(MESOCELL_PACKET_RAYS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MESOCELL_PACKET_RAYS_INL_H
#undef MESOCELL_PACKET_RAYS_INL_H
#else
#define MESOCELL_PACKET_RAYS_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sdk/trace/beam.h"
#include "sdk/trace/packet_lanes-inl.h"
#include "sdk/trace/packets.h"

HWY_BEFORE_NAMESPACE();
namespace mesocell {
namespace HWY_NAMESPACE {

#if HWY_MAX_BYTES >= 32

/// The rays of a call, made fit for the walk: a row of lanes for each coordinate.
struct Rays {
  HWY_ALIGN double origin[3][kPacketRays], direction[3][kPacketRays];  ///< in voxels; as given
  HWY_ALIGN double inverse[3][kPacketRays];                            ///< infinite where the direction is 0
  HWY_ALIGN double doubtful[kPacketRays];  ///< see Packet; negative if only the exact walk may trace the ray
};

/// Rays of one packet and where they are.
struct Packet {
  F origin[3], direction[3], inverse[3];
  F beyond[3];  ///< 1/2 on axes on which the ray rises, -1/2 on others: from a plane to the voxel beyond
  /// A coordinate says which voxel it is in if it is not nearer to an integer than rounding may move it: if
  /// its distance from the middle between two is not over `doubtful`. The greatest met so far.
  F doubtful, doubt;
  I voxel[3];
  I falls[3];  ///< -1 on axes on which the ray falls, else 0
  I octant;
  I id;  ///< of the piece that was hit, else 0
  M active;
};

HWY_INLINE F distance_from_middle(F x, F floor_x) { return abs((x - floor_x) - real(0.5)); }

/// Where the ray of a lane stands in a square of 8 × 8: packets are of 4 × 2 of them, which go more alike
/// than rows do, and two packets of 4 × 4.
HWY_INLINE std::size_t place_of(std::size_t k) { return (k & 0x23) | (k & 0xc) << 1 | (k & 0x10) >> 2; }

/// Least and greatest of what lanes hold.
struct Range {
  F low, high;

  HWY_INLINE void begin(F x) { low = high = x; }
  HWY_INLINE void add(F x) {
    low = min(low, x);
    high = max(high, x);
  }
  HWY_INLINE double least() const {
    const auto v = kHalves == 1 ? low.v[0] : hn::Min(low.v[0], low.v[kHalves - 1]);
    return hn::GetLane(hn::MinOfLanes(d, v));
  }
  HWY_INLINE double greatest() const {
    const auto v = kHalves == 1 ? high.v[0] : hn::Max(high.v[0], high.v[kHalves - 1]);
    return hn::GetLane(hn::MaxOfLanes(d, v));
  }
};

/// Origins and directions of the rays of a packet, as they were given.
HWY_INLINE void load_rays(const double* rays, std::size_t first, F (&o)[3], F (&r)[3]) {
  constexpr std::size_t kN = hn::MaxLanes(d);
  for (std::size_t h = 0; h < kHalves; ++h) {
    hn::Vec<D> low[3], high[3];  // of half the lanes, origins and directions in turn
    hn::LoadInterleaved3(d, rays + 6 * place_of(first + h * kN), low[0], low[1], low[2]);
    hn::LoadInterleaved3(d, rays + 6 * place_of(first + h * kN + kN / 2), high[0], high[1], high[2]);
    for (std::size_t a = 0; a < 3; ++a) {
      o[a].v[h] = hn::ConcatEven(d, high[a], low[a]);
      r[a].v[h] = hn::ConcatOdd(d, high[a], low[a]);
    }
  }
}

/// What bounds the rays of a beam.
struct Bounds {
  Range origin[3], slope[3];
};

/// A point that many rays begin at, in metres and in voxels.
struct Eye {
  double metres[3], voxels[3];
};

/// Prepares the rays of a packet; the first one of a beam begins its bounds. `k`: the axis of slopes.
HWY_INLINE void prepare(const PacketScene& s, const Eye& eye, const double* rays, std::size_t first,
                        std::size_t k, Rays& out, bool begins, Bounds& bounds) {
  const F zero = real(0), one = real(1);
  const double longest = std::max({s.size[0], s.size[1], s.size[2]});
  F o[3], r[3], inverse[3];
  load_rays(rays, first, o, r);
  F fastest = zero, farthest = zero;
  // The same operations as in the scalar walk; divisions take long, so those of the eye are made once.
  const MF together =
      (o[0] == real(eye.metres[0])) & (o[1] == real(eye.metres[1])) & (o[2] == real(eye.metres[2]));
  if (all_true(together)) {
    for (std::size_t a = 0; a < 3; ++a) o[a] = real(eye.voxels[a]);
  } else {
    for (std::size_t a = 0; a < 3; ++a) o[a] = (o[a] - real(s.corner[a])) / real(s.voxel_edge);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    fastest = max(fastest, abs(r[a]));
    farthest = max(farthest, abs(o[a]));
  }
  // What the scalar walk refuses or rounds to 0 is left to it, and so are all that come near; comparisons are
  // false for what is no number.
  const F least = fastest * real(0x1p-100), tiny = real(0x1p-100);
  MF good = (real(0x1p-60) <= fastest) & (fastest <= real(0x1p60));
  for (std::size_t a = 0; a < 3; ++a) {
    const F way = abs(o[a]), speed = abs(r[a]);
    const MF still = speed == zero;
    good = good & (way <= real(0x1p40)) & (still | (least <= speed)) & ((way == zero) | (tiny <= way));
    inverse[a] = select(still, real(HUGE_VAL), one / r[a]);
  }
  // |t·d| is at most what a coordinate in the grid and the origin differ by.
  const F doubtful =
      select(good, real(0.5) - (farthest + farthest + real(longest)) * real(0x1p-47), real(-1));
  for (std::size_t a = 0; a < 3; ++a) {
    // A minimum may pass over what is no number, and then over what was met before: infinity stands for it.
    F origin = o[a], slope = r[a] * abs(inverse[k]);
    origin = select(abs(origin) < real(0x1p40), origin, real(HUGE_VAL));
    slope = select(abs(slope) < real(16), slope, real(HUGE_VAL));
    if (begins) {
      bounds.origin[a].begin(origin);
      bounds.slope[a].begin(slope);
    } else {
      bounds.origin[a].add(origin);
      bounds.slope[a].add(slope);
    }
    store(o[a], out.origin[a] + first);
    store(r[a], out.direction[a] + first);
    store(inverse[a], out.inverse[a] + first);
  }
  store(doubtful, out.doubtful + first);
}

/// Makes a beam of bounds; false if the rays are none.
HWY_INLINE bool make_beam(const PacketScene& s, const Bounds& bounds, std::size_t k, Beam& beam) {
  beam.axis = unsigned(k);
  beam.octant = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double slowest = bounds.slope[a].least(), fastest = bounds.slope[a].greatest();
    const double low = bounds.origin[a].least(), high = bounds.origin[a].greatest();
    // On axis k slopes are 1 or -1.
    if (!(slowest >= 0 || fastest <= 0) || !(fastest < 16) || !(high < 0x1p40)) return false;
    const bool rises = fastest > 0;
    beam.octant |= unsigned{rises} << a;
    // Rounding is far less, of the positions and of the slopes.
    const double room = 0x1p-20 * (1 + 0x1p-20 * (std::abs(low) + std::abs(high)));
    beam.low[a] = (rises ? low : s.size[a] - high) - room;
    beam.high[a] = (rises ? high : s.size[a] - low) + room;
    beam.slope_low[a] = std::min(std::abs(slowest), std::abs(fastest)) * (1 - 0x1p-40);
    beam.slope_high[a] = std::max(std::abs(slowest), std::abs(fastest)) * (1 + 0x1p-40);
  }
  return true;
}

/// Puts rays first… in a packet, at the origin or where they enter the grid, and not before `start`.
HWY_INLINE void begin(const PacketScene& s, const BeamStart& start, const Rays& rays, std::size_t first,
                      Packet& p) {
  const F zero = real(0);
  p.octant = integer(7);
  p.doubtful = load(rays.doubtful + first);
  F t = real(-1), passage[3];
  MF outside[3], in_grid = p.doubtful == p.doubtful;
  for (std::size_t a = 0; a < 3; ++a) {
    p.origin[a] = load(rays.origin[a] + first);
    p.direction[a] = load(rays.direction[a] + first);
    p.inverse[a] = load(rays.inverse[a] + first);
    const MF falls = p.direction[a] < zero;
    p.beyond[a] = select(falls, real(-0.5), real(0.5));
    p.falls[a] = to_integer(select(falls, real(-1), zero));
    p.octant = hn::Add(p.octant, hn::ShiftLeftSame(p.falls[a], int(a)));
    const MF under = p.origin[a] < zero;
    outside[a] = under | (real(s.size[a]) <= p.origin[a]);
    passage[a] = (select(under, zero, real(s.size[a])) - p.origin[a]) * p.inverse[a];
    t = select(outside[a], max(t, passage[a]), t);
    // A ray outside that goes away, or nowhere on the axis, never is in the grid; one on the border is for
    // the exact walk.
    in_grid = in_grid & (~outside[a] | ((zero <= passage[a]) & (passage[a] < real(0x1p500))));
    p.doubtful = select(p.origin[a] == real(s.size[a]), real(-1), p.doubtful);
  }
  // On which axis the grid is entered, if it is.
  MF on[3];
  for (std::size_t a = 0; a < 3; ++a) on[a] = outside[a] & (passage[a] == t);
  on[1] = on[1] & ~on[0];
  on[2] = on[2] & ~(on[0] | on[1]);
  if (start.axis < 3) {
    const F later = (real(start.plane) - p.origin[start.axis]) * p.inverse[start.axis];
    const MF is_later = t < later;
    for (std::size_t a = 0; a < 3; ++a) on[a] = on[a] & ~is_later;
    t = max(t, later);
  }
  const MF moved = zero < t;
  t = max(t, zero);
  p.doubt = zero;
  for (std::size_t a = 0; a < 3; ++a) {
    const F border = select(p.origin[a] < zero, real(0.5), real(s.size[a] - 0.5));
    const F x = select(on[a], border, mul_add(t, p.direction[a], p.origin[a]));
    const F v = floor(x);
    p.doubt = max(p.doubt, select(moved, distance_from_middle(x, v), zero));
    in_grid = in_grid & (zero <= v) & (v < real(s.size[a]));
    p.voxel[a] = to_integer(v);
  }
  p.active = to_lanes(in_grid & (p.doubt <= p.doubtful));
  p.id = hn::Zero(di);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace mesocell
HWY_AFTER_NAMESPACE();

#endif
