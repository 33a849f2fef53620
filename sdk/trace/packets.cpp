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

#include "sdk/trace/packet_lanes-inl.h"
#include "sdk/trace/packet_rays-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mesocell {
namespace HWY_NAMESPACE {

#if HWY_MAX_BYTES >= 32

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
  const MF active = to_halves(p.active);
  M in_grid = p.active;
  for (std::size_t a = 0; a < 3; ++a) {
    const F x = select(on[a], plane[a] + p.beyond[a], mul_add(t, p.direction[a], p.origin[a]));
    const F v = floor(x);
    p.doubt = select(active, max(p.doubt, distance_from_middle(x, v)), p.doubt);
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
      hit.level = 0;
    }
  }
  return left;
}

template <bool kCubes, bool kFlat>
HWY_INLINE std::uint64_t walk(const PacketScene& s, const BeamStart& start, const Rays& rays, StreamHit* hits,
                              std::uint64_t* steps) {
  std::uint64_t undecided = 0;
  // Several packets at a time: while one waits for memory, the others go on. Where one ends the next begins.
  Packet p[kPackets];
  std::size_t first[kPackets], next = 0;
  const auto begin_next = [&](std::size_t k) {
    first[k] = next;
    if (next < kPacketRays) begin(s, start, rays, next, p[k]);
    next = std::min(next + kLanes, kPacketRays);
    return first[k] < kPacketRays;
  };
  std::size_t left = 0;
  for (std::size_t k = 0; k < kPackets; ++k) left += begin_next(k);
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
  Eye eye;
  for (std::size_t a = 0; a < 3; ++a) {
    eye.metres[a] = rays_in[a];
    eye.voxels[a] = (rays_in[a] - s.corner[a]) / s.voxel_edge;
  }
  Bounds bounds;
  for (std::size_t first = 0; first < kPacketRays; first += kLanes)
    prepare(s, eye, rays_in, first, k, rays, first == 0, bounds);
  Beam beam;
  BeamStart start;
  if (make_beam(s, bounds, k, beam)) start = find_start(s, beam);
  if (start.misses) {
    for (std::size_t l = 0; l < kPacketRays; ++l) hits[l] = StreamHit{};
    return 0;
  }
  if (s.flat)
    return s.cubes ? walk<true, true>(s, start, rays, hits, steps)
                   : walk<false, true>(s, start, rays, hits, steps);
  return s.cubes ? walk<true, false>(s, start, rays, hits, steps)
                 : walk<false, false>(s, start, rays, hits, steps);
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
