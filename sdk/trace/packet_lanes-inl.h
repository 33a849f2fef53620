// Numbers of all lanes of a packet of rays, and what is done with them.
// Included once for each instruction set, by packets.cpp alone.
#if defined(MESOCELL_PACKET_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MESOCELL_PACKET_LANES_INL_H
#undef MESOCELL_PACKET_LANES_INL_H
#else
#define MESOCELL_PACKET_LANES_INL_H
#endif

#include <cstdint>

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
HWY_INLINE bool all_true(MF a) {
  bool all = true;
  for (std::size_t h = 0; h < kHalves; ++h) all = all && hn::AllTrue(d, a.m[h]);
  return all;
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
HWY_INLINE MF to_halves(M m) {
  MF r;
#if MESOCELL_HALVES
  const F sign = to_real(hn::VecFromMask(di, m));
  for (std::size_t h = 0; h < kHalves; ++h) r.m[h] = hn::Lt(sign.v[h], hn::Zero(d));
#else
  r.m[0].raw = m.raw;  // both are a bit a lane
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

#endif

}  // namespace HWY_NAMESPACE
}  // namespace mesocell
HWY_AFTER_NAMESPACE();

#endif
