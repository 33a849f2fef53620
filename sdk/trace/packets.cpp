#include "sdk/trace/packets.h"

#include <algorithm>
#include <cmath>

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdk/trace/packets.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace mesocell {
namespace HWY_NAMESPACE {

#if HWY_MAX_BYTES >= 32

namespace hn = hwy::HWY_NAMESPACE;

// A packet has up to eight lanes: one vector of their integers, and one or two of their coordinates.
using DI = hn::CappedTag<std::int32_t, 8>;
using DU = hn::RebindToUnsigned<DI>;
using D = hn::CappedTag<double, hn::MaxLanes(DI())>;
using DH = hn::Rebind<std::int32_t, D>;
using I = hn::Vec<DI>;
using U = hn::Vec<DU>;
using M = hn::Mask<DI>;
constexpr DI di;
constexpr DU du;
constexpr D d;
constexpr DH dh;
constexpr std::size_t kLanes = hn::MaxLanes(di);
/// Packets that are walked together.
constexpr std::size_t kPackets = 2;
constexpr std::size_t kHalves = kLanes / hn::MaxLanes(d);
// As the preprocessor knows it: of vectors of 64 bytes integers fill a half.
#undef MESOCELL_HALVES
#define MESOCELL_HALVES (HWY_MAX_BYTES == 32)
static_assert(kHalves == 1 + MESOCELL_HALVES);

struct MF {
  hn::Mask<D> m[kHalves];
};
/// A coordinate of all lanes.
struct F {
  hn::Vec<D> v[kHalves];
};

#define MESOCELL_LANES(expression)                      \
  for (std::size_t h = 0; h < kHalves; ++h) expression; \
  return r

HWY_INLINE F real(double x) {
  F r;
  MESOCELL_LANES(r.v[h] = hn::Set(d, x));
}
HWY_INLINE F load(const double* p) {
  F r;
  MESOCELL_LANES(r.v[h] = hn::Load(d, p + h * hn::MaxLanes(d)));
}
HWY_INLINE void store(F a, double* p) {
  for (std::size_t h = 0; h < kHalves; ++h) hn::Store(a.v[h], d, p + h * hn::MaxLanes(d));
}
HWY_INLINE F operator+(F a, F b) {
  F r;
  MESOCELL_LANES(r.v[h] = hn::Add(a.v[h], b.v[h]));
}
HWY_INLINE F operator-(F a, F b) {
  F r;
  MESOCELL_LANES(r.v[h] = hn::Sub(a.v[h], b.v[h]));
}
HWY_INLINE F operator*(F a, F b) {
  F r;
  MESOCELL_LANES(r.v[h] = hn::Mul(a.v[h], b.v[h]));
}
HWY_INLINE F operator/(F a, F b) {
  F r;
  MESOCELL_LANES(r.v[h] = hn::Div(a.v[h], b.v[h]));
}
HWY_INLINE F mul_add(F a, F b, F c) {
  F r;
  MESOCELL_LANES(r.v[h] = hn::MulAdd(a.v[h], b.v[h], c.v[h]));
}
HWY_INLINE F min(F a, F b) {
  F r;
  MESOCELL_LANES(r.v[h] = hn::Min(a.v[h], b.v[h]));
}
HWY_INLINE F max(F a, F b) {
  F r;
  MESOCELL_LANES(r.v[h] = hn::Max(a.v[h], b.v[h]));
}
HWY_INLINE F abs(F a) {
  F r;
  MESOCELL_LANES(r.v[h] = hn::Abs(a.v[h]));
}
HWY_INLINE F floor(F a) {
  F r;
  MESOCELL_LANES(r.v[h] = hn::Floor(a.v[h]));
}
HWY_INLINE MF operator==(F a, F b) {
  MF r;
  MESOCELL_LANES(r.m[h] = hn::Eq(a.v[h], b.v[h]));
}
HWY_INLINE MF operator<(F a, F b) {
  MF r;
  MESOCELL_LANES(r.m[h] = hn::Lt(a.v[h], b.v[h]));
}
HWY_INLINE MF operator<=(F a, F b) {
  MF r;
  MESOCELL_LANES(r.m[h] = hn::Le(a.v[h], b.v[h]));
}
HWY_INLINE MF operator&(MF a, MF b) {
  MF r;
  MESOCELL_LANES(r.m[h] = hn::And(a.m[h], b.m[h]));
}
HWY_INLINE MF operator|(MF a, MF b) {
  MF r;
  MESOCELL_LANES(r.m[h] = hn::Or(a.m[h], b.m[h]));
}
HWY_INLINE MF operator~(MF a) {
  MF r;
  MESOCELL_LANES(r.m[h] = hn::Not(a.m[h]));
}
HWY_INLINE F select(MF m, F a, F b) {
  F r;
  MESOCELL_LANES(r.v[h] = hn::IfThenElse(m.m[h], a.v[h], b.v[h]));
}
#undef MESOCELL_LANES

HWY_INLINE I integer(std::int32_t i) { return hn::Set(di, i); }
HWY_INLINE I to_integer(F a) {
#if MESOCELL_HALVES
  return hn::Combine(di, hn::DemoteTo(dh, a.v[1]), hn::DemoteTo(dh, a.v[0]));
#else
  return hn::DemoteTo(di, a.v[0]);
#endif
}
HWY_INLINE F to_real(I a) {
  F r;
#if MESOCELL_HALVES
  r.v[0] = hn::PromoteTo(d, hn::LowerHalf(dh, a));
  r.v[1] = hn::PromoteTo(d, hn::UpperHalf(dh, a));
#else
  r.v[0] = hn::PromoteTo(d, a);
#endif
  return r;
}
HWY_INLINE M to_lanes(MF m) { return hn::Ne(to_integer(select(m, real(1), real(0))), hn::Zero(di)); }
HWY_INLINE I bits_of(U u) { return hn::BitCast(di, u); }
HWY_INLINE I gather(const std::uint32_t* base, I index) { return bits_of(hn::GatherIndex(du, base, index)); }
/// Four bytes each, from any address.
HWY_INLINE I gather_bytes(const std::uint8_t* base, I offset) {
  return bits_of(hn::GatherOffset(du, reinterpret_cast<const std::uint32_t*>(base), offset));
}
HWY_INLINE I shift_right(I a, I bits) { return bits_of(hn::Shr(hn::BitCast(du, a), hn::BitCast(du, bits))); }
HWY_INLINE I shift_left(I a, I bits) { return hn::Shl(a, bits); }
HWY_INLINE M below(I v, std::int32_t n) {
  return hn::RebindMask(di, hn::Lt(hn::BitCast(du, v), hn::Set(du, std::uint32_t(n))));
}

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

/// Prepares the rays of a packet; the first one of a beam begins its bounds. `k`: the axis of slopes.
HWY_INLINE void prepare(const PacketScene& s, const double* rays, std::size_t first, std::size_t k, Rays& out,
                        bool begins, Bounds& bounds) {
  const F zero = real(0), one = real(1), edge = real(s.voxel_edge);
  const double longest = std::max({s.size[0], s.size[1], s.size[2]});
  F o[3], r[3], inverse[3];
  load_rays(rays, first, o, r);
  F fastest = zero, farthest = zero;
  for (std::size_t a = 0; a < 3; ++a) {
    // The same operations in the same order as in the scalar walk.
    o[a] = (o[a] - real(s.corner[a])) / edge;
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

/// What a step looks up for a packet.
struct Look {
  I tile[3], at[3], end[3];  ///< the tile; in it, mirrored on axes on which the ray falls; where it ends
  I record, set, found, id;
  I edge;                      ///< of a cube of tiles, parts or blocks
  I to[3];                     ///< where the box ends
  M in_full, by_voxel, mixed;  ///< in a tile that is not empty; not in an empty part; in a brick
};

template <bool kCubes>
HWY_INLINE void look_up_tile(const PacketScene& s, const Packet& p, Look& l) {
  const I one = integer(1);
  for (std::size_t a = 0; a < 3; ++a) {
    const I n = integer(s.resolution[a]);
    if constexpr (kCubes) {
      l.tile[a] = hn::ShiftRightSame(p.voxel[a], s.log2_resolution);
      l.at[a] = hn::And(hn::Xor(p.voxel[a], p.falls[a]), integer(s.resolution[0] - 1));
      l.end[a] = n;
    } else {
      const hn::Rebind<float, DI> df;
      const auto middle = hn::Add(hn::ConvertTo(df, p.voxel[a]), hn::Set(df, 0.5f));
      l.tile[a] = hn::ConvertTo(di, hn::Mul(middle, hn::Set(df, s.inverse_resolution[a])));
      const I in = hn::Sub(p.voxel[a], hn::Mul(l.tile[a], n)), pad = hn::And(p.falls[a], integer(s.pad[a]));
      l.end[a] = hn::Add(n, pad);
      l.at[a] = hn::IfThenElse(hn::MaskFromVec(p.falls[a]), hn::Sub(hn::Sub(l.end[a], in), one), in);
    }
  }
  const I row = hn::Add(l.tile[1], hn::Mul(integer(s.tiles[1]), l.tile[2]));
  const I index = hn::Add(l.tile[0], hn::Mul(integer(s.tiles[0]), row));
  l.record = gather(s.tile_records, hn::IfThenElseZero(p.active, index));
}

template <bool kCubes>
HWY_INLINE void use_tile(const PacketScene& s, const Packet& p, Look& l) {
  const I one = integer(1);
  l.in_full = hn::And(p.active, hn::Eq(hn::ShiftRight<28>(l.record), integer(-1)));
  const I digit = hn::And(shift_right(l.record, hn::ShiftLeft<2>(p.octant)), integer(15));
  const I edge = hn::Sub(shift_left(hn::Or(integer(2), hn::And(digit, one)), hn::ShiftRight<1>(digit)), one);
  if constexpr (kCubes) {
    l.to[0] = l.to[1] = l.to[2] = hn::ShiftLeftSame(edge, s.log2_resolution);
  } else {
    for (std::size_t a = 0; a < 3; ++a)
      l.to[a] = hn::Add(hn::Mul(hn::Sub(edge, one), integer(s.resolution[a])), l.end[a]);
  }
}

HWY_INLINE void look_up_part(const PacketScene& s, const Packet& p, Look& l) {
  l.set = hn::And(l.record, integer(0x0fffffff));
  const I part = hn::Add(hn::ShiftRightSame(l.at[0], s.part_shift[0]),
                         hn::Add(hn::ShiftLeft<2>(hn::ShiftRightSame(l.at[1], s.part_shift[1])),
                                 hn::ShiftLeft<4>(hn::ShiftRightSame(l.at[2], s.part_shift[2]))));
  const I offset = hn::Add(hn::ShiftLeft<6>(hn::Add(hn::ShiftLeft<3>(l.set), p.octant)), part);
  l.edge = gather_bytes(s.parts, hn::IfThenElseZero(l.in_full, offset));
}

template <bool kCubes>
HWY_INLINE void use_part(const PacketScene& s, Look& l) {
  l.edge = hn::And(l.edge, integer(0xff));
  l.by_voxel = hn::And(l.in_full, hn::Eq(l.edge, hn::Zero(di)));
  for (std::size_t a = 0; a < 3; ++a) {
    const int shift = s.part_shift[a];
    const I to = hn::ShiftLeftSame(hn::Add(hn::ShiftRightSame(l.at[a], shift), l.edge), shift);
    l.to[a] = hn::IfThenElse(l.in_full, hn::Min(to, l.end[a]), l.to[a]);
  }
}

/// The number of the block, in the mirrored tile, of all octants' blocks.
template <bool kCubes>
HWY_INLINE I block_of(const PacketScene& s, const Packet& p, const Look& l) {
  if constexpr (kCubes) {
    const int log2 = s.log2_resolution - 2;
    const I upper = hn::Or(hn::ShiftRight<2>(l.at[1]), hn::ShiftLeftSame(hn::ShiftRight<2>(l.at[2]), log2));
    const I block = hn::Or(hn::ShiftRight<2>(l.at[0]), hn::ShiftLeftSame(upper, log2));
    return hn::Or(block, hn::ShiftLeftSame(p.octant, 3 * log2));
  } else {
    const I row =
        hn::Add(hn::ShiftRight<2>(l.at[1]), hn::Mul(integer(s.blocks[1]), hn::ShiftRight<2>(l.at[2])));
    const I block = hn::Add(hn::ShiftRight<2>(l.at[0]), hn::Mul(integer(s.blocks[0]), row));
    return hn::Add(block, hn::Mul(p.octant, integer(s.block_count)));
  }
}

template <bool kCubes>
HWY_INLINE void look_up_block(const PacketScene& s, const Packet& p, Look& l) {
  l.found = gather(s.block_records, hn::IfThenElseZero(l.by_voxel, block_of<kCubes>(s, p, l)));
}

template <bool kCubes>
HWY_INLINE void use_block(const PacketScene& s, Look& l) {
  l.mixed = hn::And(l.by_voxel, hn::Lt(l.found, hn::Zero(di)));
  l.id = hn::And(l.found, integer(0xffffff));
  const I edge = hn::And(hn::ShiftRight<24>(l.found), integer(127));
  for (std::size_t a = 0; a < 3; ++a) {
    I to = hn::ShiftLeft<2>(hn::Add(hn::ShiftRight<2>(l.at[a]), edge));
    if constexpr (!kCubes) to = hn::Min(to, hn::Add(integer(s.end[a] - s.resolution[a]), l.end[a]));
    l.to[a] = hn::IfThenElse(l.by_voxel, to, l.to[a]);
  }
}

template <bool kCubes, bool kFlat>
HWY_INLINE void look_up_voxel(const PacketScene& s, const Packet& p, Look& l) {
  const I three = integer(3);
  const I voxel = hn::Or(hn::And(l.at[0], three), hn::Or(hn::ShiftLeft<2>(hn::And(l.at[1], three)),
                                                         hn::ShiftLeft<4>(hn::And(l.at[2], three))));
  I brick;
  if constexpr (kFlat) {
    brick = block_of<kCubes>(s, p, l);
  } else {
    brick = hn::Add(l.found, hn::Mul(p.octant, integer(s.brick_count)));  // the next shift drops kMixed
  }
  const I offset = hn::ShiftLeftSame(hn::Add(hn::ShiftLeft<6>(brick), voxel), s.voxel_shift);
  l.found = gather_bytes(s.bricks, hn::IfThenElseZero(l.mixed, offset));
}

template <bool kFlat>
HWY_INLINE void use_voxel(const PacketScene& s, Look& l) {
  const I id = hn::And(l.found, integer((1 << s.id_bits) - 1));
  l.id = kFlat ? id : hn::IfThenElse(l.mixed, id, l.id);
  const I most = integer((1 << s.edge_bits) - 1);
  for (std::size_t a = 0; a < 3; ++a) {
    const I more = hn::And(hn::ShiftRightSame(l.found, s.id_bits + int(a) * s.edge_bits), most);
    l.to[a] = hn::IfThenElse(l.mixed, hn::Add(hn::Add(l.at[a], more), integer(1)), l.to[a]);
  }
}

HWY_INLINE void look_up_set(const PacketScene& s, Look& l) {
  const I word = hn::Add(hn::Mul(l.set, integer(s.set_words)), hn::ShiftRight<5>(l.id));
  l.found = gather(s.sets, hn::IfThenElseZero(l.by_voxel, word));
}

HWY_INLINE void use_set(Packet& p, const Look& l) {
  const I inside = hn::And(shift_right(l.found, hn::And(l.id, integer(31))), integer(1));
  const M hit = hn::And(l.by_voxel, hn::Ne(inside, hn::Zero(di)));
  p.id = hn::IfThenElse(hit, l.id, p.id);
  p.active = hn::AndNot(hit, p.active);
}

/// On to the first voxel beyond the box.
HWY_INLINE void move(const PacketScene& s, Packet& p, const Look& l) {
  F plane[3], passage[3];
  for (std::size_t a = 0; a < 3; ++a) {
    const I way = hn::Xor(hn::Sub(l.to[a], l.at[a]), p.falls[a]);
    plane[a] = to_real(hn::Add(hn::Add(p.voxel[a], way), hn::And(p.falls[a], integer(2))));
    passage[a] = (plane[a] - p.origin[a]) * p.inverse[a];
  }
  const F t = min(min(passage[0], passage[1]), passage[2]);
  const MF on_x = passage[0] == t, on_y = passage[1] == t;
  const MF on[3] = {on_x, on_y & ~on_x, ~(on_x | on_y)};
  M in_grid = p.active;
  for (std::size_t a = 0; a < 3; ++a) {
    const F x = select(on[a], plane[a] + p.beyond[a], mul_add(t, p.direction[a], p.origin[a]));
    const F v = floor(x);
    p.doubt = max(p.doubt, distance_from_middle(x, v));
    const I next = to_integer(v);
    p.voxel[a] = hn::IfThenElse(p.active, next, p.voxel[a]);
    in_grid = hn::And(in_grid, below(next, s.tiles[a] * s.resolution[a]));
  }
  p.active = in_grid;
}

/// One step of all active rays of some packets, whose lookups wait for memory together. kCubes: tiles are
/// cubes of 16, 32, 64, … voxels. kFlat: see TileBlocks.
template <bool kCubes, bool kFlat>
HWY_INLINE void step(const PacketScene& s, Packet (&p)[kPackets]) {
  Look l[kPackets];
  for (std::size_t k = 0; k < kPackets; ++k) look_up_tile<kCubes>(s, p[k], l[k]);
  for (std::size_t k = 0; k < kPackets; ++k) use_tile<kCubes>(s, p[k], l[k]);
  const auto any = [&](M Look::*mask) {
    M m = l[0].*mask;
    for (std::size_t k = 1; k < kPackets; ++k) m = hn::Or(m, l[k].*mask);
    return !hn::AllFalse(di, m);
  };
  if (any(&Look::in_full)) {
    for (std::size_t k = 0; k < kPackets; ++k) look_up_part(s, p[k], l[k]);
    for (std::size_t k = 0; k < kPackets; ++k) use_part<kCubes>(s, l[k]);
    if (any(&Look::by_voxel)) {
      if constexpr (kFlat) {
        for (std::size_t k = 0; k < kPackets; ++k) l[k].mixed = l[k].by_voxel;
      } else {
        for (std::size_t k = 0; k < kPackets; ++k) look_up_block<kCubes>(s, p[k], l[k]);
        for (std::size_t k = 0; k < kPackets; ++k) use_block<kCubes>(s, l[k]);
      }
      if (kFlat || any(&Look::mixed)) {
        for (std::size_t k = 0; k < kPackets; ++k) look_up_voxel<kCubes, kFlat>(s, p[k], l[k]);
        for (std::size_t k = 0; k < kPackets; ++k) use_voxel<kFlat>(s, l[k]);
      }
      for (std::size_t k = 0; k < kPackets; ++k) look_up_set(s, l[k]);
      for (std::size_t k = 0; k < kPackets; ++k) use_set(p[k], l[k]);
    }
  }
  for (std::size_t k = 0; k < kPackets; ++k) move(s, p[k], l[k]);
}

/// Writes what a packet found; returns which rays are undecided.
HWY_INLINE std::uint64_t finish(const PacketScene& s, const Packet& p, std::size_t first, StreamHit* hits) {
  // The voxel was entered by the last of the planes that it lies behind, unless the ray began in it.
  F t = real(-HUGE_VAL), axis = real(0);
  MF began = t == t;
  for (std::size_t a = 0; a < 3; ++a) {
    const F passage = (to_real(hn::Sub(p.voxel[a], p.falls[a])) - p.origin[a]) * p.inverse[a];
    const MF later = (t < passage) & ~(p.direction[a] == real(0));
    t = select(later, passage, t);
    axis = select(later, real(double(a)), axis);
    began = began & (floor(p.origin[a]) == to_real(p.voxel[a]));
  }
  t = select(began, real(0), t * real(s.voxel_edge));
  const I on = to_integer(axis);
  // Up the axis if the ray falls on it.
  const I falls = hn::IfThenElse(hn::Eq(on, integer(0)), p.falls[0],
                                 hn::IfThenElse(hn::Eq(on, integer(1)), p.falls[1], p.falls[2]));
  const I face = hn::IfThenElse(to_lanes(began), integer(StreamHit::kBegan), hn::Sub(hn::Add(on, on), falls));
  const M undecided = to_lanes(~(p.doubt <= p.doubtful));
  HWY_ALIGN double out_t[kLanes];
  HWY_ALIGN std::int32_t out_voxel[3][kLanes], out_label[kLanes], out_face[kLanes], out_state[kLanes];
  store(t, out_t);
  for (std::size_t a = 0; a < 3; ++a) hn::Store(p.voxel[a], di, out_voxel[a]);
  hn::Store(gather(s.labels, p.id), di, out_label);
  hn::Store(face, di, out_face);
  hn::Store(hn::IfThenElse(undecided, integer(-1), p.id), di, out_state);
  std::uint64_t left = 0;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const std::size_t at = place_of(first + k);
    StreamHit& hit = hits[at];
    if (out_state[k] < 0) {
      left |= std::uint64_t{1} << at;
    } else if (out_state[k] == 0) {
      hit = StreamHit{};
    } else {
      hit.t = out_t[k];
      hit.element = {out_voxel[0][k], out_voxel[1][k], out_voxel[2][k]};
      hit.label = std::uint32_t(out_label[k]);
      hit.face = std::int8_t(out_face[k]);
    }
  }
  return left;
}

/// Rays of a beam of its own: a square of 4 × 4.
constexpr std::size_t kBeamRays = 16;
constexpr std::size_t kBeams = kPacketRays / kBeamRays;

template <bool kCubes, bool kFlat>
HWY_INLINE std::uint64_t walk(const PacketScene& s, const BeamStart* starts, const Rays& rays,
                              StreamHit* hits, std::uint64_t* steps) {
  std::uint64_t undecided = 0;
  // Several packets at a time: while one waits for memory, the others go on. Where one ends the next begins.
  Packet p[kPackets];
  std::size_t first[kPackets], next = 0;
  const auto begin_next = [&](std::size_t k) {
    for (; next < kPacketRays; next += kLanes) {
      const BeamStart& start = starts[next / kBeamRays];
      if (start.misses) continue;
      first[k] = next;
      begin(s, start, rays, next, p[k]);
      next += kLanes;
      return true;
    }
    first[k] = kPacketRays;
    p[k].active = hn::FirstN(di, 0);
    return false;
  };
  std::size_t left = 0;
  for (std::size_t k = 0; k < kPackets; ++k) left += begin_next(k);
  if (left > 0 && left < kPackets)
    for (std::size_t k = left; k < kPackets; ++k) {
      p[k] = p[0];
      p[k].active = hn::FirstN(di, 0);
    }
  for (unsigned round = 1; left > 0; ++round) {
    if (steps)
      for (const Packet& packet : p) *steps += hn::CountTrue(di, packet.active);
    step<kCubes, kFlat>(s, p);
    // Rays in doubt may go to and fro.
    if (round % 32 == 0)
      for (Packet& packet : p)
        packet.active = hn::And(packet.active, to_lanes(packet.doubt <= packet.doubtful));
    for (std::size_t k = 0; k < kPackets; ++k)
      if (hn::AllFalse(di, p[k].active) && first[k] < kPacketRays) {
        undecided |= finish(s, p[k], first[k], hits);
        left -= !begin_next(k);
      }
  }
  return undecided;
}

std::uint64_t Trace(const PacketScene& s, const double* rays_in, StreamHit* hits, std::uint64_t* steps) {
  Rays rays;
  std::size_t k = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(rays_in[3 + a]) > std::abs(rays_in[3 + k])) k = a;
  Beam beams[kBeams], all;
  BeamStart starts[kBeams];
  bool is_beam = true;
  for (std::size_t b = 0; b < kBeams; ++b) {
    Bounds bounds;
    for (std::size_t first = 0; first < kBeamRays; first += kLanes)
      prepare(s, rays_in, b * kBeamRays + first, k, rays, first == 0, bounds);
    is_beam = is_beam && make_beam(s, bounds, k, beams[b]);
    if (!is_beam) continue;
    if (b == 0)
      all = beams[0];
    else
      is_beam = add_to_beam(all, beams[b]);
  }
  if (is_beam) find_starts(s, all, beams, kBeams, starts);
  for (std::size_t b = 0; b < kBeams; ++b)
    if (starts[b].misses)
      for (std::size_t l = 0; l < kBeamRays; ++l) hits[place_of(b * kBeamRays + l)] = StreamHit{};
  if (s.flat)
    return s.cubes ? walk<true, true>(s, starts, rays, hits, steps)
                   : walk<false, true>(s, starts, rays, hits, steps);
  return s.cubes ? walk<true, false>(s, starts, rays, hits, steps)
                 : walk<false, false>(s, starts, rays, hits, steps);
}

std::size_t LaneCount() { return kLanes; }

#else

// Vectors of two coordinates are no faster than the scalar walk.
std::uint64_t Trace(const PacketScene&, const double*, StreamHit*, std::uint64_t*) {
  return ~std::uint64_t{0};
}

std::size_t LaneCount() { return 1; }

#endif

}  // namespace HWY_NAMESPACE
}  // namespace mesocell
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mesocell {

HWY_EXPORT(Trace);
HWY_EXPORT(LaneCount);

bool packets_supported() { return HWY_DYNAMIC_DISPATCH(LaneCount)() >= 8; }

std::uint64_t trace_packets(const PacketScene& scene, std::span<const Ray> rays, StreamHit* hits,
                            std::uint64_t* steps) {
  static_assert(sizeof(Ray) == 6 * sizeof(double));
  const auto trace = HWY_DYNAMIC_DISPATCH(Trace);
  if (rays.size() == kPacketRays) return trace(scene, &rays[0].origin.x, hits, steps);
  if (rays.empty()) return 0;
  std::array<Ray, kPacketRays> padded;
  std::array<StreamHit, kPacketRays> found;
  for (std::size_t k = 0; k < kPacketRays; ++k) padded[k] = rays[std::min(k, rays.size() - 1)];
  const std::uint64_t undecided = trace(scene, &padded[0].origin.x, found.data(), steps);
  std::copy_n(found.begin(), rays.size(), hits);
  return rays.size() < 64 ? undecided & ((std::uint64_t{1} << rays.size()) - 1) : undecided;
}

}  // namespace mesocell
#endif
