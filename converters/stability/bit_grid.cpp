#include "converters/stability/bit_grid.h"

#include <sys/mman.h>

#include <algorithm>

namespace mesocell {

Result<BitGrid> BitGrid::create(const Index3& size) {
  constexpr std::uint64_t kMaxVoxels = std::uint64_t{1} << 34;
  const std::uint64_t slice = std::uint64_t{size[0]} * size[1];
  if (slice == 0 || size[2] == 0 || slice > kMaxVoxels || slice > kMaxVoxels / size[2])
    return Error{ErrorCode::kLimit,
                 "the grid would have no voxels, or more than 2^34; use another resolution"};
  BitGrid grid;
  grid.size_ = size;
  grid.words_per_row_ = (size[0] + 63) / 64;
  void* const memory = mmap(nullptr, grid.word_count() * 8, PROT_READ | PROT_WRITE,
                            MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED)
    return Error{ErrorCode::kLimit, "there is not enough memory for the grid; use a lower resolution"};
  grid.words_ = static_cast<std::uint64_t*>(memory);
  return grid;
}

BitGrid::~BitGrid() {
  if (words_) munmap(words_, word_count() * 8);
}

void BitGrid::set_run(std::uint32_t y, std::uint32_t z, std::uint32_t begin, std::uint32_t end) {
  if (begin >= end) return;
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  const std::span<std::uint64_t> words = row(y, z);
  const std::uint32_t first = begin / 64, last = (end - 1) / 64;
  const std::uint64_t head = kAll << (begin % 64), tail = kAll >> (63 - (end - 1) % 64);
  if (first == last) {
    words[first] |= head & tail;
    return;
  }
  words[first] |= head;
  std::fill(words.begin() + first + 1, words.begin() + last, kAll);
  words[last] |= tail;
}

void BitGrid::clear() { std::ranges::fill(words(), 0); }

}  // namespace mesocell
