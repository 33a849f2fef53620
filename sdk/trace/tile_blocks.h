#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "format/cell_object.h"
#include "sdk/trace/octant_cubes.h"

namespace mesocell {

/// The voxels of a tile in blocks of 4 × 4 × 4, and how far each lets a ray go. A block that is of one
/// instance is a number; the voxels of the others stand together, so that a walk through them stays in a line
/// or two of the cache.
///
/// A ray of an octant sees the tile *mirrored* on the axes on which it falls, so that it always goes up:
/// voxel l of n is then n - 1 - l, plus `pad`, so that blocks begin at multiples of 4 on both sides. All
/// places below are such. Boxes that are told end at `end` at the latest, if the tile does not end with a
/// block.
class TileBlocks {
 public:
  static constexpr std::uint32_t kMixed = 0x80000000;
  static constexpr unsigned kEdgeShift = 24;
  static constexpr std::uint32_t kIdMask = (1u << kEdgeShift) - 1;

  explicit TileBlocks(const TileMap& tile);

  /// Record of a block for an octant. Either kMixed + brick, or the id of its piece + edge << kEdgeShift,
  /// where the cube of `edge` blocks upward from this one is all of the same instance, across the tile's end
  /// too.
  [[nodiscard]] std::uint32_t record(unsigned octant, std::uint64_t block) const {
    return flat_ ? kMixed + std::uint32_t(block) : records_[octant * block_count_ + block];
  }
  /// A voxel of a brick as rays of an octant see it: the id of its piece and the edges of a box upward from
  /// it that is all of the same instance, across the tile's end too. id() and edge() take it apart; what is
  /// above is not its own.
  [[nodiscard]] std::uint32_t voxel(unsigned octant, std::uint32_t brick, std::uint32_t at) const {
    std::uint32_t v = 0;
    const std::size_t index = (std::size_t{octant} * brick_count_ + brick) * 64 + at;
    std::memcpy(&v, bricks_.data() + (index << voxel_shift_), sizeof v);
    return v;
  }
  [[nodiscard]] std::uint32_t id(std::uint32_t voxel) const { return voxel & ((1u << id_bits_) - 1); }
  [[nodiscard]] std::uint32_t edge(std::uint32_t voxel, std::size_t axis) const {
    return 1 + (voxel >> (id_bits_ + axis * edge_bits_) & ((1u << edge_bits_) - 1));
  }

  /// Piece id of a voxel of the tile, not mirrored.
  [[nodiscard]] std::uint32_t id_at(const std::array<std::uint32_t, 3>& l) const {
    const std::uint32_t r = record(7, block_of(l));
    return r & kMixed ? id(voxel(7, r & ~kMixed, voxel_of(l))) : r & kIdMask;
  }

  [[nodiscard]] std::uint64_t block_of(const std::array<std::uint32_t, 3>& l) const {
    return (l[0] >> 2) + std::uint64_t{blocks_[0]} * ((l[1] >> 2) + std::uint64_t{blocks_[1]} * (l[2] >> 2));
  }
  [[nodiscard]] static std::uint32_t voxel_of(const std::array<std::uint32_t, 3>& l) {
    return (l[0] & 3) | (l[1] & 3) << 2 | (l[2] & 3) << 4;
  }
  /// The tile is also cut into 4 × 4 × 4 *parts* at most; the parts that a piece has voxels in, not mirrored.
  [[nodiscard]] Bits64 parts_of(std::uint32_t piece_id) const { return parts_of_[piece_id]; }
  /// A part's edge on an axis is 1 << part_shift voxels.
  [[nodiscard]] unsigned part_shift(std::size_t axis) const { return part_shift_[axis]; }
  /// The parts of a mirrored tile are moved as a whole, so that they begin with part 0: by so many from that
  /// of mirrored().
  [[nodiscard]] Bits64 mirrored_parts(Bits64 parts, unsigned octant) const;

  [[nodiscard]] std::uint32_t resolution(std::size_t axis) const { return resolution_[axis]; }
  [[nodiscard]] std::uint32_t pad(std::size_t axis) const { return pad_[axis]; }
  /// Where boxes end that are told by a record without a brick: the tile's end, or beyond all where the tile
  /// ends with a block.
  [[nodiscard]] std::uint32_t end(std::size_t axis) const { return end_[axis]; }
  /// Whether each block is a brick, of its own number, as it is in small tiles: then no record is looked up.
  [[nodiscard]] bool flat() const { return flat_; }

  // What packets of rays look up by themselves.
  [[nodiscard]] const std::vector<std::uint32_t>& records() const { return records_; }
  /// 1 << voxel_shift() bytes a voxel, in the machine's byte order.
  [[nodiscard]] const std::vector<std::uint8_t>& bricks() const { return bricks_; }
  [[nodiscard]] unsigned voxel_shift() const { return voxel_shift_; }
  [[nodiscard]] std::uint32_t blocks(std::size_t axis) const { return blocks_[axis]; }
  [[nodiscard]] std::uint64_t block_count() const { return block_count_; }
  [[nodiscard]] std::uint32_t brick_count() const { return brick_count_; }
  [[nodiscard]] unsigned id_bits() const { return id_bits_; }
  [[nodiscard]] unsigned edge_bits() const { return edge_bits_; }

  [[nodiscard]] std::uint64_t memory_bytes() const {
    return records_.capacity() * sizeof(std::uint32_t) + bricks_.capacity() +
           parts_of_.capacity() * sizeof(Bits64);
  }

 private:
  void find_blocks(const TileMap& tile);
  void make_records(const TileMap& tile, unsigned octant);
  struct Runs;
  void make_bricks(const Runs& runs, unsigned octant);

  std::array<std::uint32_t, 3> resolution_{}, blocks_{}, pad_{}, end_{};
  std::array<unsigned, 3> part_shift_{};
  std::uint64_t block_count_ = 0;
  bool flat_ = false;
  unsigned id_bits_ = 7, edge_bits_ = 3, voxel_shift_ = 1;
  std::uint32_t brick_count_ = 0;
  std::vector<std::uint32_t> plain_;  ///< of each block its piece, or kMixed + brick; while tables are made
  std::vector<std::array<std::uint32_t, 3>> mixed_;  ///< the first voxel of each brick; while tables are made
  std::vector<std::uint32_t> records_;
  std::vector<std::uint8_t> bricks_;
  std::vector<Bits64> parts_of_;
};

}  // namespace mesocell
