#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "format/cell_object.h"
#include "format/result.h"

namespace mesocell {

/// A bit a voxel, 0 at first; rows run along x and begin at a word. The memory is shared with child
/// processes, so that what a child voxelizes is seen by its parent, and a page costs nothing until it is
/// written.
class BitGrid {
 public:
  /// Errors: kLimit (over 2^34 voxels, a size of 0, no memory).
  [[nodiscard]] static Result<BitGrid> create(const Index3& size);

  BitGrid(BitGrid&& other) noexcept { *this = std::move(other); }
  BitGrid& operator=(BitGrid&& other) noexcept {
    std::swap(size_, other.size_);
    std::swap(words_per_row_, other.words_per_row_);
    std::swap(words_, other.words_);
    return *this;
  }
  BitGrid(const BitGrid&) = delete;
  BitGrid& operator=(const BitGrid&) = delete;
  ~BitGrid();

  [[nodiscard]] const Index3& size() const { return size_; }
  [[nodiscard]] std::uint64_t voxels() const { return std::uint64_t{size_[0]} * size_[1] * size_[2]; }
  [[nodiscard]] std::uint32_t words_per_row() const { return words_per_row_; }
  /// All words; bits beyond a row's end stay 0.
  [[nodiscard]] std::span<std::uint64_t> words() { return {words_, word_count()}; }
  [[nodiscard]] std::span<const std::uint64_t> words() const { return {words_, word_count()}; }
  [[nodiscard]] std::span<std::uint64_t> row(std::uint32_t y, std::uint32_t z) {
    return {words_ + words_per_row_ * (y + std::size_t{size_[1]} * z), words_per_row_};
  }
  [[nodiscard]] std::span<const std::uint64_t> row(std::uint32_t y, std::uint32_t z) const {
    return {words_ + words_per_row_ * (y + std::size_t{size_[1]} * z), words_per_row_};
  }
  [[nodiscard]] bool get(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return row(y, z)[x / 64] >> (x % 64) & 1;
  }
  void set(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    row(y, z)[x / 64] |= std::uint64_t{1} << (x % 64);
  }
  void toggle(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    row(y, z)[x / 64] ^= std::uint64_t{1} << (x % 64);
  }
  /// Sets voxels [begin, end) of a row.
  void set_run(std::uint32_t y, std::uint32_t z, std::uint32_t begin, std::uint32_t end);
  void clear();

 private:
  BitGrid() = default;
  [[nodiscard]] std::size_t word_count() const { return std::size_t{words_per_row_} * size_[1] * size_[2]; }

  Index3 size_{};
  std::uint32_t words_per_row_ = 0;
  std::uint64_t* words_ = nullptr;
};

}  // namespace mesocell
