// OpenVDB and NanoVDB, given INSIDE voxels as a mask.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "converters/bench/peers/peers.h"
#include "converters/bench/peers/vdb_module.h"
#include "converters/image/module_loader.h"
#include "sdk/trace/inside_pieces.h"

namespace mesocell {
namespace {

const Result<const MesocellVdbPeers*>& vdb() {
  static const auto loaded = []() -> Result<const MesocellVdbPeers*> {
    const Result<void*> handle = load_module("mesocell_volume_peers");
    if (!handle) return handle.error();
    const auto get = reinterpret_cast<MesocellVdbPeersOf>(find_function(*handle, "mesocell_vdb_peers"));
    if (!get || get()->version != MESOCELL_VDB_PEERS_VERSION)
      return Error{ErrorCode::kOutput,
                   "the OpenVDB module is of another version; install the one of this program"};
    return get();
  }();
  return loaded;
}

/// The INSIDE voxels of an object, in blocks of 8³.
class BlockSource {
 public:
  explicit BlockSource(const CellObject& object)
      : tile_(object.tile), tiles_(object.grid.tiles), pieces_(object.tile, object.membership) {
    const std::uint64_t count = tile_.voxel_count();
    for (std::uint64_t i = 0; i < count && solid_; ++i) solid_ = tile_.id(i) != 0;
    bool whole = true;
    for (std::size_t a = 0; a < 3; ++a) whole = whole && tile_.resolution[a] % 8 == 0;
    if (whole && !solid_) known_.resize(std::size_t(count / 512));
  }

  static MesocellVdbFill fill(void* user, const std::int32_t origin[3], std::uint64_t words[8]) {
    return static_cast<BlockSource*>(user)->fill_block(origin, words);
  }

 private:
  struct Block {
    bool known = false;
    MesocellVdbFill fill = MESOCELL_VDB_NONE;
    std::array<std::uint64_t, 8> words{};
  };

  MesocellVdbFill fill_block(const std::int32_t origin[3], std::uint64_t words[8]) {
    std::array<std::uint32_t, 3> first{}, last{};
    bool within = true;
    for (std::size_t a = 0; a < 3; ++a) {
      first[a] = std::uint32_t(origin[a]) / tile_.resolution[a];
      last[a] = (std::uint32_t(origin[a]) + 7) / tile_.resolution[a];
      within = within && last[a] < tiles_[a];
      last[a] = std::min(last[a], tiles_[a] - 1);
    }
    bool none = true, all = within;
    for (std::uint32_t z = first[2]; z <= last[2]; ++z)
      for (std::uint32_t y = first[1]; y <= last[1]; ++y)
        for (std::uint32_t x = first[0]; x <= last[0]; ++x) {
          const std::uint32_t entry = pieces_.entry(index(x, y, z));
          none = none && entry == InsidePieces::kNone;
          all = all && entry == InsidePieces::kAll;
        }
    if (none) return MESOCELL_VDB_NONE;
    if (all && solid_) return MESOCELL_VDB_ALL;
    if (!all || known_.empty()) return look(origin, words);
    std::array<std::uint32_t, 3> in{};
    for (std::size_t a = 0; a < 3; ++a) in[a] = std::uint32_t(origin[a]) % tile_.resolution[a] / 8;
    Block& block =
        known_[in[0] + tile_.resolution[0] / 8 * (in[1] + std::size_t{tile_.resolution[1] / 8} * in[2])];
    if (!block.known) block = {true, look(origin, block.words.data()), block.words};
    std::copy(block.words.begin(), block.words.end(), words);
    return block.fill;
  }

  /// Voxel by voxel.
  [[nodiscard]] MesocellVdbFill look(const std::int32_t origin[3], std::uint64_t words[8]) const {
    std::uint64_t any = 0, every = ~std::uint64_t{0};
    for (std::uint32_t x = 0; x < 8; ++x) {
      std::uint64_t word = 0;
      for (std::uint32_t bit = 0; bit < 64; ++bit)
        word |= std::uint64_t{inside(std::uint32_t(origin[0]) + x, std::uint32_t(origin[1]) + bit / 8,
                                     std::uint32_t(origin[2]) + bit % 8)}
                << bit;
      words[x] = word;
      any |= word;
      every &= word;
    }
    return any == 0 ? MESOCELL_VDB_NONE : every == ~std::uint64_t{0} ? MESOCELL_VDB_ALL : MESOCELL_VDB_MIXED;
  }

  [[nodiscard]] bool inside(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    const Index3& r = tile_.resolution;
    const std::uint32_t tx = x / r[0], ty = y / r[1], tz = z / r[2];
    if (tx >= tiles_[0] || ty >= tiles_[1] || tz >= tiles_[2]) return false;
    const std::uint32_t entry = pieces_.entry(index(tx, ty, tz));
    return entry != InsidePieces::kNone &&
           pieces_.has(entry, tile_.id(tile_.voxel_index(x - tx * r[0], y - ty * r[1], z - tz * r[2])));
  }

  [[nodiscard]] std::uint64_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return x + std::uint64_t{tiles_[0]} * (y + std::uint64_t{tiles_[1]} * z);
  }

  const TileMap& tile_;
  Index3 tiles_;
  InsidePieces pieces_;
  bool solid_ = true;         ///< no voxel of the tile is empty
  std::vector<Block> known_;  ///< blocks of a tile all of whose instances are INSIDE, where blocks fit it
};

struct MaskDeleter {
  void operator()(MesocellVdbMask* mask) const { (*vdb())->destroy(mask); }
};

class VdbTracer final : public Tracer {
 public:
  VdbTracer(const GridLayout& grid, MesocellVdbMask* mask) : edge_(grid.voxel_edge), mask_(mask) {
    rays_.scale = 1 / edge_;
    for (std::size_t a = 0; a < 3; ++a) rays_.offset[a] = grid.box_min[a] / edge_;
  }

  void trace(std::span<const Ray> rays, std::span<StreamHit> hits, bool) const override {
    static_assert(sizeof(Ray) == 6 * sizeof(double));
    constexpr std::size_t kBlock = 256;
    std::array<MesocellVdbHit, kBlock> found;
    MesocellVdbRays block = rays_;
    for (std::size_t begin = 0; begin < rays.size(); begin += kBlock) {
      block.count = std::min(kBlock, rays.size() - begin);
      block.rays = &rays[begin].origin.x;
      (*vdb())->trace(mask_.get(), &block, found.data());
      for (std::size_t k = 0; k < block.count; ++k) hits[begin + k] = to_hit(rays[begin + k], found[k]);
    }
  }

  [[nodiscard]] std::uint64_t memory_bytes() const override { return (*vdb())->memory(mask_.get()); }

 private:
  [[nodiscard]] StreamHit to_hit(const Ray& ray, const MesocellVdbHit& found) const {
    StreamHit hit;
    if (!found.found) return hit;
    hit.label = 0xffffffffu;
    // The ray enters by the face whose plane it meets last.
    hit.t = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      hit.element[a] = found.voxel[a];
      if (ray.direction[a] == 0) continue;
      const bool up = ray.direction[a] < 0;
      const double plane = (found.voxel[a] + up + rays_.offset[a]) * edge_;
      const double t = (plane - ray.origin[a]) / ray.direction[a];
      if (t <= hit.t) continue;
      hit.t = t;
      hit.face = std::int8_t(2 * a + up);
    }
    return hit;
  }

  double edge_;
  MesocellVdbRays rays_{};
  std::unique_ptr<MesocellVdbMask, MaskDeleter> mask_;
};

}  // namespace

Result<std::unique_ptr<Tracer>> make_vdb_tracer(const CellObject& object, bool nano,
                                                std::uint64_t max_bytes) {
  if (!vdb()) return vdb().error();
  MesocellVdbInput input{};
  std::uint64_t blocks = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint64_t size = std::uint64_t{object.grid.tiles[a]} * object.tile.resolution[a];
    input.size[a] = std::int32_t(size);
    blocks *= size / 8 + 1;
    // To look at so many blocks alone would take minutes.
    if (blocks > std::uint64_t{1} << 30)
      return Error{ErrorCode::kLimit,
                   "a grid of more than 2^30 blocks of 8³ voxels is too large for it; take "
                   "fewer tiles"};
  }
  BlockSource source(object);
  input.fill = BlockSource::fill;
  input.user = &source;
  input.max_bytes = max_bytes;
  input.nano = nano;
  MesocellVdbMask* mask = nullptr;
  char message[512] = "";
  const int failed = (*vdb())->create(&input, &mask, message, sizeof message);
  if (failed) return Error{failed == MESOCELL_VDB_LIMIT ? ErrorCode::kLimit : ErrorCode::kOutput, message};
  return std::unique_ptr<Tracer>(std::make_unique<VdbTracer>(object.grid, mask));
}

}  // namespace mesocell
