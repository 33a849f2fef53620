#include "sdk/membership/tag_instances.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "sdk/core/parallel.h"
#include "sdk/membership/touch.h"

namespace mesocell {
namespace {

/// What is known of a set of voxels, as bits: some are inside, some are not.
using Seen = std::uint8_t;
constexpr Seen kNothing = 0, kIn = 1, kOut = 2, kBoth = 3;
static_assert(kBoth == TouchFinder::kTouched);

/// A run of one piece in a row of the tile, up to voxel `end`.
struct Run {
  std::uint32_t end, piece;
};

/// A part of a set of pieces: piece p is bit p % 64 of word p / 64.
struct PieceBits {
  std::uint32_t word;
  std::uint64_t bits;
};

/// The tile's rows as runs; row r has runs[first[r]] … runs[first[r + 1]], and the pieces of these are
/// sets[first_set[r]] … sets[first_set[r + 1]].
struct TileRows {
  std::vector<std::uint32_t> first, first_set;
  std::vector<Run> runs;
  std::vector<PieceBits> sets;
  std::vector<std::uint64_t> only_word;  ///< of each row, if the pieces fit in one word
};

/// Adds what the runs of the last row have in them.
void add_set(TileRows& rows) {
  const std::size_t begin = rows.sets.size();
  rows.first_set.push_back(std::uint32_t(begin));
  for (std::size_t k = rows.first.back(); k < rows.runs.size(); ++k) {
    const std::uint32_t word = rows.runs[k].piece / 64;
    std::size_t set = begin;
    while (set < rows.sets.size() && rows.sets[set].word != word) ++set;
    if (set == rows.sets.size()) rows.sets.push_back({word, 0});
    rows.sets[set].bits |= std::uint64_t{1} << (rows.runs[k].piece % 64);
  }
}

TileRows rows_of(const TileMap& tile) {
  TileRows rows;
  const std::uint32_t width = tile.resolution[0];
  const std::uint64_t count = tile.voxel_count() / width;
  for (std::uint64_t r = 0; r < count; ++r) {
    rows.first.push_back(std::uint32_t(rows.runs.size()));
    std::uint32_t piece = tile.id(r * width);
    for (std::uint32_t x = 1; x < width; ++x) {
      const std::uint32_t next = tile.id(r * width + x);
      if (next == piece) continue;
      rows.runs.push_back({x, piece});
      piece = next;
    }
    rows.runs.push_back({width, piece});
    add_set(rows);
  }
  rows.first.push_back(std::uint32_t(rows.runs.size()));
  rows.first_set.push_back(std::uint32_t(rows.sets.size()));
  if (tile.pieces.size() < 64)
    for (const PieceBits& set : rows.sets) rows.only_word.push_back(set.bits);
  return rows;
}

/// What the surface does to one tile: the same for all its voxels, or what was seen of each piece.
struct TileState {
  Seen uniform = kNothing;   ///< kIn, kOut, or kBoth if `pieces` tells
  std::vector<Seen> pieces;  ///< by piece id; entry 0, the empty space, is not used
};

/// Voxelizes the tiles (·, ty, tz) and notes what is seen of every piece.
class Bundle {
 public:
  Bundle(const TileMap& tile, const TileRows& rows, std::uint32_t tiles) : tile_(tile), rows_(rows) {
    states_.resize(tiles);
    inside_.resize(tiles);
    place_.resize(tiles);
    covered_.resize((tiles + 63) / 64 * kRowsAtOnce);
    cut_.resize(covered_.size());
  }

  std::span<TileState> run(const RowIntervals& intervals) {
    count(intervals);
    const std::uint64_t all = tile_.voxel_count();
    mixed_.clear();
    for (std::uint32_t t = 0; t < states_.size(); ++t) {
      states_[t].uniform = inside_[t] == 0 ? kOut : inside_[t] == all ? kIn : kBoth;
      states_[t].pieces.clear();
      if (states_[t].uniform != kBoth) continue;
      states_[t].pieces.assign(tile_.pieces.size() + 1, kNothing);
      place_[t] = std::uint32_t(mixed_.size());
      mixed_.push_back(t);
    }
    if (mixed_.empty()) return states_;
    const std::size_t words = tile_.pieces.size() / 64 + 1;
    seen_.assign(2 * words * mixed_.size(), 0);
    const std::size_t rows = rows_.first.size() - 1;
    for (std::size_t begin = 0; begin < rows; begin += kRowsAtOnce) {
      const std::size_t end = std::min(begin + kRowsAtOnce, rows);
      std::fill(covered_.begin(), covered_.end(), 0);
      std::fill(cut_.begin(), cut_.end(), 0);
      for (std::size_t r = begin; r < end; ++r) mark_cut_tiles(r, r - begin, words, intervals.row(r));
      mark_whole_tiles(begin, end, words);
    }
    for (std::size_t m = 0; m < mixed_.size(); ++m) {
      const std::uint64_t* const out = &seen_[2 * words * m];
      const std::uint64_t* const in = out + words;
      std::vector<Seen>& pieces = states_[mixed_[m]].pieces;
      for (std::size_t p = 1; p < pieces.size(); ++p)
        pieces[p] = Seen((in[p / 64] >> (p % 64) & 1) * kIn | (out[p / 64] >> (p % 64) & 1) * kOut);
    }
    return states_;
  }

  /// Notes as seen both ways the pieces that a triangle (voxel units) touches, in the tiles (·, ty, tz).
  void touch(const TouchFinder& finder, const std::array<Vec3, 3>& triangle, std::uint32_t ty,
             std::uint32_t tz) {
    const double width = tile_.resolution[0], last = double(states_.size()) - 1;
    const double low = std::min({triangle[0].x, triangle[1].x, triangle[2].x});
    const double high = std::max({triangle[0].x, triangle[1].x, triangle[2].x});
    if (high < -1 || low > width * (last + 1) + 1) return;
    // Generous by a voxel: a box that ends where the triangle begins meets it.
    const std::uint32_t first_tile = std::uint32_t(std::clamp(std::floor((low - 1) / width), 0.0, last));
    const std::uint32_t last_tile = std::uint32_t(std::clamp(std::floor((high + 1) / width), 0.0, last));
    for (std::uint32_t t = first_tile; t <= last_tile; ++t) {
      TileState& state = states_[t];
      const Seen before = state.uniform;
      if (state.pieces.empty()) state.pieces.assign(tile_.pieces.size() + 1, before);
      finder.mark(triangle,
                  {std::int64_t{t} * tile_.resolution[0], std::int64_t{ty} * tile_.resolution[1],
                   std::int64_t{tz} * tile_.resolution[2]},
                  state.pieces);
      if (before != kBoth &&
          std::find(state.pieces.begin() + 1, state.pieces.end(), kBoth) != state.pieces.end())
        state.uniform = kBoth;
    }
  }

  [[nodiscard]] std::uint64_t inside_voxels() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t n : inside_) sum += n;
    return sum;
  }

 private:
  /// Counts the inside voxels of every tile.
  void count(const RowIntervals& intervals) {
    const std::uint32_t width = tile_.resolution[0];
    std::fill(inside_.begin(), inside_.end(), 0);
    // Tiles wholly covered by an interval are counted by where such stretches begin and end.
    std::vector<std::int64_t> covered(states_.size() + 1, 0);
    for (const Interval& i : intervals.intervals) {
      const std::uint32_t a = i.begin / width, b = (i.end - 1) / width;
      if (a == b) {
        inside_[a] += i.end - i.begin;
        continue;
      }
      inside_[a] += (a + 1) * width - i.begin;
      inside_[b] += i.end - b * width;
      ++covered[a + 1];
      --covered[b];
    }
    std::int64_t rows = 0;
    for (std::size_t t = 0; t < states_.size(); ++t) {
      rows += covered[t];
      inside_[t] += std::uint64_t(rows) * width;
    }
  }

  /// Notes which tiles the inside covers wholly in row r, the k-th of those at hand, and which it cuts; marks
  /// the pieces in the latter.
  void mark_cut_tiles(std::size_t r, std::size_t k, std::size_t words, std::span<const Interval> intervals) {
    const std::uint32_t width = tile_.resolution[0];
    std::uint32_t next = 0;  // tiles before it are done
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      const auto& [begin, end] = intervals[i];
      const std::uint32_t a = begin / width, b = end / width, whole = a + (begin != a * width);
      for (std::uint32_t t = whole; t < b; t = (t / 64 + 1) * 64) {
        const std::uint32_t last = std::min(b, (t / 64 + 1) * 64);
        covered_[k + kRowsAtOnce * (t / 64)] |= ~std::uint64_t{0} >> (64 - (last - t)) << (t % 64);
      }
      const auto cut = [&](std::uint32_t t) {
        if (t < next) return;
        next = t + 1;
        cut_[k + kRowsAtOnce * (t / 64)] |= std::uint64_t{1} << (t % 64);
        mark_tile(r, t, words, intervals.subspan(i));
      };
      // It cuts the tile that it begins in and the one that it ends in, unless at the tile's border.
      if (whole != a || a == b) cut(a);
      if (end != b * width) cut(b);
    }
  }

  /// Marks the pieces of row r in tile t, which the first of the intervals cuts.
  void mark_tile(std::size_t r, std::uint32_t t, std::size_t words, std::span<const Interval> intervals) {
    const std::uint32_t width = tile_.resolution[0], begin = t * width, end = begin + width;
    std::uint64_t* const out = &seen_[2 * words * place_[t]];
    std::uint64_t* const in = out + words;
    const std::span<const Run> runs{rows_.runs.data() + rows_.first[r],
                                    rows_.runs.data() + rows_.first[r + 1]};
    const bool once = intervals.size() == 1 || intervals[1].begin >= end;
    if (once && intervals[0].begin <= begin)
      mark_cut(runs, intervals[0].end - begin, words, in, out);
    else if (once && intervals[0].end >= end)
      mark_cut(runs, intervals[0].begin - begin, words, out, in);
    else
      mark_stretches(runs, intervals, begin, end, in, out);
  }

  /// Marks the pieces of rows [begin, end) in the mixed tiles that are not cut there: all are on one side.
  void mark_whole_tiles(std::size_t begin, std::size_t end, std::size_t words) {
    for (std::size_t m = 0; m < mixed_.size(); ++m) {
      const std::uint32_t t = mixed_[m], shift = t % 64;
      const std::uint64_t* const covered = &covered_[kRowsAtOnce * (t / 64)];
      const std::uint64_t* const cut = &cut_[kRowsAtOnce * (t / 64)];
      std::uint64_t* const out = &seen_[2 * words * m];
      if (words == 1) {
        // Without a branch, several rows at a time.
        const std::uint64_t* const sets = &rows_.only_word[begin];
        std::uint64_t in_set = 0, out_set = 0;
        for (std::size_t k = 0; k < end - begin; ++k) {
          const std::uint64_t is_in = covered[k] >> shift & 1, is_cut = cut[k] >> shift & 1;
          in_set |= sets[k] & (0 - is_in);
          out_set |= sets[k] & ((is_in | is_cut) - 1);
        }
        out[0] |= out_set;
        out[1] |= in_set;
        continue;
      }
      for (std::size_t r = begin; r < end; ++r) {
        if (cut[r - begin] >> shift & 1) continue;
        std::uint64_t* const side = covered[r - begin] >> shift & 1 ? out + words : out;
        for (std::uint32_t k = rows_.first_set[r]; k < rows_.first_set[r + 1]; ++k)
          side[rows_.sets[k].word] |= rows_.sets[k].bits;
      }
    }
  }

  /// Marks the pieces of a row's voxels before `cut` and of those from there on.
  static void mark_cut(std::span<const Run> runs, std::uint32_t cut, std::size_t words, std::uint64_t* before,
                       std::uint64_t* beyond) {
    // Without a branch on where the cut is, which nobody could predict.
    std::uint32_t begin = 0;
    if (words == 1) {
      std::uint64_t low = 0, high = 0;
      for (const Run& run : runs) {
        low |= std::uint64_t{begin < cut} << run.piece;
        high |= std::uint64_t{run.end > cut} << run.piece;
        begin = run.end;
      }
      *before |= low;
      *beyond |= high;
      return;
    }
    for (const Run& run : runs) {
      before[run.piece / 64] |= std::uint64_t{begin < cut} << (run.piece % 64);
      beyond[run.piece / 64] |= std::uint64_t{run.end > cut} << (run.piece % 64);
      begin = run.end;
    }
  }

  /// Marks the pieces of a row's voxels by the tile's stretches, alternately outside and inside.
  static void mark_stretches(std::span<const Run> runs, std::span<const Interval> intervals,
                             std::uint32_t begin, std::uint32_t end, std::uint64_t* in, std::uint64_t* out) {
    std::size_t run = 0;
    std::uint32_t at = 0;
    const auto mark = [&](std::uint32_t to, std::uint64_t* side) {
      while (at < to) {
        side[runs[run].piece / 64] |= std::uint64_t{1} << (runs[run].piece % 64);
        at = std::min(runs[run].end, to);
        if (at == runs[run].end) ++run;
      }
    };
    for (std::size_t i = 0; i < intervals.size() && intervals[i].begin < end; ++i) {
      mark(std::max(intervals[i].begin, begin) - begin, out);
      mark(std::min(intervals[i].end, end) - begin, in);
    }
    mark(end - begin, out);
  }

  const TileMap& tile_;
  const TileRows& rows_;
  std::vector<TileState> states_;
  std::vector<std::uint64_t> inside_;
  static constexpr std::size_t kRowsAtOnce = 1024;  ///< their bits fit in the fastest cache
  std::vector<std::uint32_t> mixed_;                ///< tiles
  std::vector<std::uint32_t> place_;                ///< of a mixed tile in mixed_
  /// Bit t % 64 of [k + kRowsAtOnce · (t / 64)]: whether the inside covers row k of tile t wholly, or cuts
  /// it.
  std::vector<std::uint64_t> covered_, cut_;
  std::vector<std::uint64_t> seen_;  ///< of each mixed tile the pieces seen outside, then those seen inside
};

Tag tag_of(Seen seen) {
  return seen == kIn ? Tag::kInside : seen == kOut ? Tag::kOutside : Tag::kIntersected;
}

/// Joins what was seen of the pieces to what is seen of whole instances.
class Merger {
 public:
  Merger(const TileMap& tile, const Index3& tiles, const std::vector<TileState>& states)
      : tile_(tile), tiles_(tiles), states_(states) {
    for (const Piece& p : tile.pieces)
      for (std::size_t a = 0; a < 3; ++a) {
        low_[a] = std::min<std::int64_t>(low_[a], -p.home[a]);
        high_[a] = std::max<std::int64_t>(high_[a], -p.home[a]);
      }
  }

  /// Tags of the instances at home in tile (x, y, z), one a cell. Returns true if all are alike; then only
  /// tags[0] is set.
  bool tags(std::int64_t x, std::int64_t y, std::int64_t z, std::vector<Tag>& tags) const {
    const Seen around = neighbourhood(x, y, z);
    if (around == kIn || around == kOut) {
      tags[0] = tag_of(around);
      return true;
    }
    std::size_t k = 0;
    bool alike = true;
    for (std::uint32_t cell = 1; cell <= tile_.cell_count; ++cell) {
      Seen seen = kNothing;
      for (; k < tile_.pieces.size() && tile_.pieces[k].cell == cell; ++k) {
        const auto& h = tile_.pieces[k].home;
        const TileState* s = state(x - h[0], y - h[1], z - h[2]);
        seen |= !s ? kOut : s->uniform != kBoth ? s->uniform : s->pieces[k + 1];
      }
      tags[cell - 1] = tag_of(seen);
      alike = alike && tags[cell - 1] == tags[0];
    }
    return alike;
  }

 private:
  [[nodiscard]] const TileState* state(std::int64_t x, std::int64_t y, std::int64_t z) const {
    if (x < 0 || y < 0 || z < 0 || x >= tiles_[0] || y >= tiles_[1] || z >= tiles_[2]) return nullptr;
    return &states_[std::size_t(x + tiles_[0] * (y + std::int64_t{tiles_[1]} * z))];
  }

  /// What is seen of all tiles that instances at home here can reach.
  [[nodiscard]] Seen neighbourhood(std::int64_t x, std::int64_t y, std::int64_t z) const {
    Seen seen = kNothing;
    for (std::int64_t dz = low_[2]; dz <= high_[2]; ++dz)
      for (std::int64_t dy = low_[1]; dy <= high_[1]; ++dy)
        for (std::int64_t dx = low_[0]; dx <= high_[0]; ++dx) {
          const TileState* s = state(x + dx, y + dy, z + dz);
          seen |= s ? s->uniform : kOut;
          if (seen == kBoth) return seen;
        }
    return seen;
  }

  const TileMap& tile_;
  const Index3& tiles_;
  const std::vector<TileState>& states_;
  std::array<std::int64_t, 3> low_{}, high_{};
};

/// One layer of tiles of a membership map; block numbers count from the layer's first.
struct Layer {
  std::vector<std::uint32_t> entries;
  std::vector<std::uint8_t> blocks;
};

Layer merge_layer(const Merger& merger, const MembershipMap& map, std::uint32_t z) {
  Layer layer;
  std::vector<Tag> tags(map.cell_count);
  std::uint32_t count = 0;
  for (std::uint32_t y = 0; y < map.tiles[1]; ++y)
    for (std::uint32_t x = 0; x < map.tiles[0]; ++x) {
      if (merger.tags(x, y, z, tags)) {
        layer.entries.push_back(std::uint32_t(tags[0]));
        continue;
      }
      layer.entries.push_back(MembershipMap::kFirstBlock + count++);
      const std::size_t at = layer.blocks.size();
      layer.blocks.resize(at + map.block_bytes());
      for (std::uint32_t c = 0; c < map.cell_count; ++c)
        layer.blocks[at + c / 4] |= std::uint8_t(std::uint32_t(tags[c]) << (2 * (c % 4)));
    }
  return layer;
}

}  // namespace

Result<MembershipMap> tag_instances(const RowSource& source, const Index3& tiles, const TileMap& tile,
                                    const MembershipOptions& options, MembershipReport& report,
                                    const Progress* progress) {
  const Error cancelled{ErrorCode::kCancelled, "cancelled"};
  const TileRows rows = rows_of(tile);
  std::optional<TouchFinder> finder;
  if (options.rule == MembershipRule::kConservative) finder.emplace(tile);
  std::vector<TileState> states(std::size_t{tiles[0]} * tiles[1] * tiles[2]);
  const std::size_t bundles = std::size_t{tiles[1]} * tiles[2];

  struct Worker {
    Scanline::Scratch scratch;
    RowIntervals intervals;
    Bundle bundle;
  };
  const unsigned threads = unsigned(std::min<std::size_t>(resolve_threads(options.threads), bundles));
  std::vector<Worker> workers(threads, {{}, {}, Bundle(tile, rows, tiles[0])});
  std::atomic<std::uint64_t> inside{0}, mixed{0};
  std::atomic<bool> over{false};
  const std::uint64_t max_mixed = options.max_bytes / (tile.pieces.size() + 1);
  const bool done = parallel_for(
      bundles, threads,
      [&](std::size_t b, unsigned w) {
        if (over) return;
        Worker& worker = workers[w];
        const auto ty = std::uint32_t(b % tiles[1]), tz = std::uint32_t(b / tiles[1]);
        source.bundle(ty, tz, worker.scratch, worker.intervals);
        const std::span<TileState> found = worker.bundle.run(worker.intervals);
        if (finder)
          source.triangles(ty, tz, [&](const std::array<Vec3, 3>& triangle) {
            worker.bundle.touch(*finder, triangle, ty, tz);
          });
        inside += worker.bundle.inside_voxels();
        for (std::size_t t = 0; t < found.size(); ++t) {
          if (found[t].uniform == kBoth && ++mixed > max_mixed) over = true;
          if (found[t].uniform != kBoth) found[t].pieces = {};
          states[b * tiles[0] + t] = std::move(found[t]);
        }
      },
      progress, "voxelize");
  if (over)
    return Error{
        ErrorCode::kLimit,
        "the surface meets more than " + std::to_string(max_mixed) +
            " tiles, which would take more memory than allowed; use fewer tiles, or a tile of fewer cells"};
  if (!done) return cancelled;

  MembershipMap map;
  map.rule = options.rule;
  map.tiles = tiles;
  map.cell_count = tile.cell_count;
  const Merger merger(tile, tiles, states);
  std::vector<Layer> layers(tiles[2]);
  if (!parallel_for(
          tiles[2], threads,
          [&](std::size_t z, unsigned) { layers[z] = merge_layer(merger, map, std::uint32_t(z)); }, progress,
          "merge"))
    return cancelled;
  map.entries.reserve(states.size());
  std::uint32_t first_block = 0;
  for (const Layer& layer : layers) {
    std::uint32_t next = first_block;
    for (const std::uint32_t e : layer.entries) {
      map.entries.push_back(e < MembershipMap::kFirstBlock ? e : e + first_block);
      next += e >= MembershipMap::kFirstBlock;
    }
    map.blocks.insert(map.blocks.end(), layer.blocks.begin(), layer.blocks.end());
    first_block = next;
  }
  report.inside_voxels = inside;
  report.mixed_tiles = mixed;
  for (const Worker& worker : workers) report.unsure_voxels += worker.scratch.unsure;
  return map;
}

}  // namespace mesocell
