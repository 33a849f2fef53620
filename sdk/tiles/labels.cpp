#include "sdk/tiles/labels.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "sdk/tiles/assemble.h"

namespace mesocell {
namespace {

using Shift = std::array<std::int32_t, 3>;

constexpr std::size_t kMaxCells = 0xffff;
/// Tiles from a cell's home to its farthest piece; a piece's offset has 8 bits in the file.
constexpr std::int32_t kMaxReach = 100;
/// More runs than this are noise, and would take gigabytes.
constexpr std::size_t kMaxRuns = std::size_t{1} << 27;

/// Voxels [begin, end) of a row along x, all of one label that is not 0.
struct Run {
  std::uint16_t begin, end;
  std::uint32_t label;
};

/// All runs of a volume, row by row; row y + height·z has runs[first[row]] … runs[first[row + 1]].
struct Runs {
  std::vector<Run> runs;
  std::vector<std::uint32_t> first;

  [[nodiscard]] std::span<const Run> row(std::size_t r) const {
    return {runs.data() + first[r], runs.data() + first[r + 1]};
  }
};

/// Which runs are connected, as a union-find. Every run carries the tiles that it is moved by to lie beside
/// its root, the first run of its set; a set whose runs disagree about that meets its own copy.
class Connections {
 public:
  explicit Connections(std::size_t runs) : parents_(runs), shifts_(runs), percolates_(runs, 0) {
    for (std::size_t i = 0; i < runs; ++i) parents_[i] = std::uint32_t(i);
  }

  struct Place {
    std::uint32_t root;
    Shift shift;
  };
  Place find(std::uint32_t run) {
    Place place{run, {}};
    for (; parents_[place.root] != place.root; place.root = parents_[place.root])
      place.shift = sum(place.shift, shifts_[place.root], 1);
    // Whatever was passed is hung on the root.
    for (Shift rest = place.shift; parents_[run] != place.root && run != place.root;) {
      const std::uint32_t parent = std::exchange(parents_[run], place.root);
      const Shift own = std::exchange(shifts_[run], rest);
      rest = sum(rest, own, -1);
      run = parent;
    }
    return place;
  }

  /// Run `b`, moved by `step` tiles, touches run `a`.
  void join(std::uint32_t a, std::uint32_t b, const Shift& step) {
    const Place at = find(a), other = find(b);
    const Shift expected = sum(at.shift, step, 1), differs = sum(expected, other.shift, -1);
    if (at.root == other.root) {
      if (differs != Shift{}) percolates_[at.root] = 1;
      return;
    }
    const bool first = at.root < other.root;
    const std::uint32_t root = first ? at.root : other.root, child = first ? other.root : at.root;
    parents_[child] = root;
    shifts_[child] = first ? differs : sum({}, differs, -1);
    percolates_[root] |= percolates_[child];
  }

  [[nodiscard]] bool percolates(std::uint32_t root) const { return percolates_[root] != 0; }

 private:
  static Shift sum(const Shift& a, const Shift& b, std::int32_t sign) {
    return {a[0] + sign * b[0], a[1] + sign * b[1], a[2] + sign * b[2]};
  }

  std::vector<std::uint32_t> parents_;
  std::vector<Shift> shifts_;
  std::vector<std::uint8_t> percolates_;
};

Error limit(std::string text) { return {ErrorCode::kLimit, std::move(text)}; }
Error invalid(std::string text, std::string_view id = {}) {
  return {ErrorCode::kInvalidInput, std::move(text), id};
}

std::optional<Runs> find_runs(const LabelVolume& volume) {
  const Index3& n = volume.resolution;
  Runs found;
  found.first.push_back(0);
  for (std::size_t row = 0; row < std::size_t{n[1]} * n[2]; ++row) {
    const std::uint32_t* labels = volume.labels.data() + row * n[0];
    for (std::uint32_t x = 0; x < n[0];) {
      std::uint32_t end = x + 1;
      while (end < n[0] && labels[end] == labels[x]) ++end;
      if (labels[x] != 0) found.runs.push_back({std::uint16_t(x), std::uint16_t(end), labels[x]});
      x = end;
    }
    if (found.runs.size() > kMaxRuns) return std::nullopt;
    found.first.push_back(std::uint32_t(found.runs.size()));
  }
  return found;
}

/// Joins what touches in two rows, of which the second is moved by `step` tiles along y and z: across the
/// border along x only, or everywhere else.
void join_rows(const Runs& runs, std::size_t row, std::size_t other, const Shift& step, bool across_x,
               std::uint32_t width, Connections& connections) {
  const std::span<const Run> a = runs.row(row), b = runs.row(other);
  if (a.empty() || b.empty()) return;
  const std::uint32_t a0 = runs.first[row], b0 = runs.first[other];
  if (across_x) {
    const auto touches = [&](const Run& left, const Run& right) {
      return left.begin == 0 && right.end == width && left.label == right.label;
    };
    if (touches(b.front(), a.back()))
      connections.join(a0 + std::uint32_t(a.size() - 1), b0, {1, step[1], step[2]});
    if (row != other && touches(a.front(), b.back()))
      connections.join(a0, b0 + std::uint32_t(b.size() - 1), {-1, step[1], step[2]});
    return;
  }
  if (row == other) return;
  std::size_t from = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    // Corners touch too: runs need not overlap, they may lie side by side.
    while (from < b.size() && b[from].end < a[i].begin) ++from;
    for (std::size_t j = from; j < b.size() && b[j].begin <= a[i].end; ++j)
      if (a[i].label == b[j].label) connections.join(a0 + std::uint32_t(i), b0 + std::uint32_t(j), step);
  }
}

/// Joins each row with those after it: first what touches within the tile, then across its borders, so that a
/// cell that meets its own copy is laid out from the inside. False if cancelled.
bool connect(const Runs& runs, const Index3& n, Connections& connections, const Progress* progress) {
  constexpr std::int32_t kNext[5][2] = {{0, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}};
  for (const bool borders : {false, true})
    for (std::uint32_t z = 0; z < n[2]; ++z) {
      if (progress && progress->cancelled()) return false;
      for (std::uint32_t y = 0; y < n[1]; ++y)
        for (const auto& [dy, dz] : kNext) {
          const std::int64_t to_y = std::int64_t{y} + dy, to_z = std::int64_t{z} + dz;
          const Shift step{0, to_y < 0 ? -1 : to_y >= n[1] ? 1 : 0, to_z >= n[2] ? 1 : 0};
          const std::size_t row = y + std::size_t{n[1]} * z;
          const std::size_t other = std::size_t(to_y - step[1] * std::int64_t{n[1]}) +
                                    std::size_t{n[1]} * std::size_t(to_z - step[2] * std::int64_t{n[2]});
          const bool wraps = step != Shift{};
          if (borders == wraps) join_rows(runs, row, other, step, false, n[0], connections);
          if (borders) join_rows(runs, row, other, step, true, n[0], connections);
        }
    }
  return true;
}

/// One cell: a set of runs.
struct Cell {
  std::uint32_t label = 0, root = 0;
  bool percolates = false;
  std::int64_t voxels = 0;
  std::array<std::int64_t, 3> sum{};  ///< of the voxels' places, laid out
};

std::int64_t floor_divide(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

/// Tiles that a voxel coordinate is moved by to lie nearest to the centroid, at a tie the greater. Whole
/// numbers: voxel + s·n ≤ sum / voxels + n / 2.
std::int32_t nearest_shift(const Cell& cell, std::size_t axis, std::int64_t voxel, std::int64_t n) {
  return std::int32_t(floor_divide(2 * cell.sum[axis] + (n - 2 * voxel) * cell.voxels, 2 * n * cell.voxels));
}

/// What the import knows of a volume before the tile is put together.
class LabelCells {
 public:
  LabelCells(const Runs& runs, const Index3& n, Connections& connections)
      : runs_(runs), n_(n), connections_(connections), cell_of_root_(runs.runs.size(), 0) {}

  /// Finds the cells, in order. False if they are too many.
  bool find() {
    for (std::uint32_t r = 0; r < runs_.runs.size(); ++r)
      if (connections_.find(r).root == r) {
        if (cells_.size() == kMaxCells) return false;
        cells_.push_back({runs_.runs[r].label, r, connections_.percolates(r), 0, {}});
      }
    std::sort(cells_.begin(), cells_.end(), [](const Cell& a, const Cell& b) {
      return std::tie(a.label, a.root) < std::tie(b.label, b.root);
    });
    for (std::size_t c = 0; c < cells_.size(); ++c) cell_of_root_[cells_[c].root] = std::uint32_t(c);
    for_each_run([&](std::uint32_t r, std::uint32_t y, std::uint32_t z) {
      const Connections::Place place = connections_.find(r);
      Cell& cell = cells_[cell_of_root_[place.root]];
      const Run& run = runs_.runs[r];
      const std::int64_t count = run.end - run.begin;
      const auto at = [&](std::size_t axis, std::int64_t v) {
        return v + place.shift[axis] * std::int64_t{n_[axis]};
      };
      cell.voxels += count;
      cell.sum[0] += count * at(0, 0) + (std::int64_t{run.begin} + run.end - 1) * count / 2;
      cell.sum[1] += count * at(1, y);
      cell.sum[2] += count * at(2, z);
    });
    return true;
  }

  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }

  /// Calls `body(owner, row, begin, end)` for pieces of runs that belong to one image of a cell.
  template <typename Body>
  void for_each_piece(Body body) {
    for_each_run([&](std::uint32_t r, std::uint32_t y, std::uint32_t z) {
      const Connections::Place place = connections_.find(r);
      const std::uint32_t index = cell_of_root_[place.root];
      const Cell& cell = cells_[index];
      const std::size_t row = y + std::size_t{n_[1]} * z;
      const auto give = [&](const Shift& s, std::uint32_t begin, std::uint32_t end) {
        body(CodeOwner{index + 1, {-s[0], -s[1], -s[2]}}, row, begin, end);
      };
      const Run& run = runs_.runs[r];
      if (!cell.percolates) {
        give(place.shift, run.begin, run.end);
        return;
      }
      const std::int32_t sy = nearest_shift(cell, 1, y, n_[1]), sz = nearest_shift(cell, 2, z, n_[2]);
      for (std::uint32_t x = run.begin; x < run.end;) {
        const std::int32_t sx = nearest_shift(cell, 0, x, n_[0]);
        std::uint32_t end = x + 1;
        while (end < run.end && nearest_shift(cell, 0, end, n_[0]) == sx) ++end;
        give({sx, sy, sz}, x, end);
        x = end;
      }
    });
  }

 private:
  template <typename Body>
  void for_each_run(Body body) {
    for (std::uint32_t z = 0; z < n_[2]; ++z)
      for (std::uint32_t y = 0; y < n_[1]; ++y) {
        const std::size_t row = y + std::size_t{n_[1]} * z;
        for (std::uint32_t r = runs_.first[row]; r < runs_.first[row + 1]; ++r) body(r, y, z);
      }
  }

  const Runs& runs_;
  const Index3& n_;
  Connections& connections_;
  std::vector<std::uint32_t> cell_of_root_;
  std::vector<Cell> cells_;
};

bool before(const CodeOwner& a, const CodeOwner& b) {
  const auto key = [](const CodeOwner& o) { return std::tie(o.cell, o.shift[2], o.shift[1], o.shift[0]); };
  return key(a) < key(b);
}

/// The images of cells that occur, sorted; none if a cell is too long.
std::vector<CodeOwner> find_owners(LabelCells& cells) {
  std::vector<CodeOwner> owners;
  cells.for_each_piece([&](const CodeOwner& owner, std::size_t, std::uint32_t, std::uint32_t) {
    if (owners.empty() || !(owners.back() == owner)) owners.push_back(owner);
    // Most repeat, so sort before they pile up.
    if (owners.size() >= 1u << 20 && owners.size() == owners.capacity()) {
      std::sort(owners.begin(), owners.end(), before);
      owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
    }
  });
  std::sort(owners.begin(), owners.end(), before);
  owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
  for (std::size_t begin = 0, end = 0; begin < owners.size(); begin = end) {
    Shift low = owners[begin].shift, high = low;
    for (; end < owners.size() && owners[end].cell == owners[begin].cell; ++end)
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], owners[end].shift[a]);
        high[a] = std::max(high[a], owners[end].shift[a]);
      }
    for (std::size_t a = 0; a < 3; ++a)
      if (high[a] - low[a] > kMaxReach) return {};
  }
  return owners;
}

}  // namespace

Result<TileMap> make_label_tile(const LabelVolume& volume, Percolating percolating, unsigned threads,
                                TileReport* report, const Progress* progress) {
  const Index3& n = volume.resolution;
  for (const std::uint32_t edge : n)
    if (edge < 4 || edge > 1024)
      return invalid("a volume of " + std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " +
                     std::to_string(n[2]) +
                     " voxels is no tile, which has 4 to 1024 along each axis; crop or resample it");
  assert(volume.labels.size() == volume.voxel_count());

  const std::optional<Runs> runs = find_runs(volume);
  if (!runs) return limit("the labels change almost from voxel to voxel, which is noise; smooth them");
  if (runs->runs.empty())
    return invalid("all voxels are 0, which is empty space; a tile needs at least one voxel of a cell");
  Connections connections(runs->runs.size());
  if (!connect(*runs, n, connections, progress)) return Error{ErrorCode::kCancelled, "cancelled"};
  LabelCells cells(*runs, n, connections);
  if (!cells.find())
    return limit(
        "its labels fall into more than 65535 parts that are not connected, each of which is a cell; "
        "remove specks or use a smaller volume");

  std::uint32_t cut = 0;
  for (const Cell& cell : cells.cells()) {
    if (!cell.percolates) continue;
    ++cut;
    if (percolating == Percolating::kRefuse)
      return invalid("label " + std::to_string(cell.label) +
                         " meets its own copy through the tile's border, so its cell has no end; separate "
                         "the copies, or let them be cut",
                     "tile-percolates");
  }
  const std::vector<CodeOwner> owners = find_owners(cells);
  if (owners.empty())
    return limit("a cell winds through more than " + std::to_string(kMaxReach) + " tiles; cut it into parts");

  VoxelCodes codes(volume.voxel_count(), owners.size());
  CodeOwner last;
  std::uint32_t code = 0;
  cells.for_each_piece([&](const CodeOwner& owner, std::size_t row, std::uint32_t begin, std::uint32_t end) {
    if (!(owner == last)) {
      last = owner;
      code =
          std::uint32_t(std::lower_bound(owners.begin(), owners.end(), owner, before) - owners.begin()) + 1;
    }
    for (std::uint32_t x = begin; x < end; ++x) codes.set(row * n[0] + x, code);
  });
  if (report) report->percolating_cells = cut;
  return assemble_tile(n, codes, owners, threads);
}

}  // namespace mesocell
