// Signed counting slice by slice, on the processor. [Nürnberg 2011, 3.1.4]
//
// There each slice is a rendering of all that lies beyond it into a stencil buffer, which front faces
// decrement and back faces increment; where the stencil is not 0 the voxel is inside. Here the slices are
// gone through once, from the far end: the stencil is kept and takes in the faces between a slice and the
// next.
#include <array>
#include <bit>
#include <cstring>
#include <numeric>

#include "converters/stability/methods/crossings.h"
#include "converters/stability/voxelizer.h"
#include "sdk/core/parallel.h"

namespace mesocell {
namespace {

/// Which of 64 counters are not 0.
std::uint64_t nonzero(const std::uint8_t* counters) {
  std::uint64_t bits = 0;
  if constexpr (std::endian::native == std::endian::little) {
    for (int k = 0; k < 8; ++k) {
      std::uint64_t eight;
      std::memcpy(&eight, counters + 8 * k, 8);
      // The upper bit of each byte that has any bit; then the eight side by side.
      constexpr std::uint64_t kLow = 0x7f7f7f7f7f7f7f7f;
      const std::uint64_t marks = (((eight & kLow) + kLow) | eight) & ~kLow;
      bits |= ((marks >> 7) * 0x0102040810204080 >> 56) << (8 * k);
    }
  } else {
    for (int k = 0; k < 64; ++k) bits |= std::uint64_t{counters[k] != 0} << k;
  }
  return bits;
}

}  // namespace

Status voxelize_signed_count(const TriangleMesh& mesh, BitGrid& out, unsigned threads) {
  const Index3& size = out.size();
  const CrossingFinder finder(mesh, 2, size);
  parallel_for(finder.chunks(), threads, [&](std::size_t chunk, unsigned) {
    std::vector<Crossing> crossings;
    finder.find(chunk, crossings);
    // By slice.
    std::vector<std::uint32_t> first(size[2] + 2, 0), order(crossings.size());
    for (const Crossing& c : crossings) ++first[c.slice + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t k = 0; k < crossings.size(); ++k) order[next[crossings[k].slice]++] = k;

    const auto [begin, end] = finder.rows(chunk);
    const std::size_t width = std::size_t{out.words_per_row()} * 64;
    std::vector<std::uint8_t> stencil(width * (end - begin), 0);
    for (std::uint32_t z = size[2]; z-- > 0;) {
      for (std::uint32_t k = first[z + 1]; k < first[z + 2]; ++k) {
        const Crossing& c = crossings[order[k]];
        std::uint8_t& count = stencil[width * (c.v - begin) + c.u];
        count = std::uint8_t(count + c.sign);
      }
      for (std::uint32_t y = begin; y < end; ++y) {
        const std::span<std::uint64_t> row = out.row(y, z);
        for (std::size_t w = 0; w < row.size(); ++w)
          row[w] = nonzero(stencil.data() + width * (y - begin) + 64 * w);
      }
    }
  });
  return {};
}

}  // namespace mesocell
