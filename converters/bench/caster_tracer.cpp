#include "converters/bench/caster_tracer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "sdk/trace/cell_object_caster.h"

namespace mesocell {
namespace {

constexpr std::array<std::string_view, 4> kPeers = {"embree-instanced", "embree-surface", "openvdb",
                                                    "nanovdb"};

class CasterTracer final : public Tracer {
 public:
  explicit CasterTracer(std::unique_ptr<Caster> caster) : caster_(std::move(caster)) {}

  void trace(std::span<const Ray> rays, std::span<StreamHit> hits, bool) const override {
    caster_->first_hits(rays, hits);
  }
  [[nodiscard]] std::uint64_t memory_bytes() const override { return caster_->memory_bytes(); }
  [[nodiscard]] std::uint64_t count_steps(std::span<const Ray> rays) const override {
    return caster_->count_steps(rays);
  }

 private:
  std::unique_ptr<Caster> caster_;
};

Result<std::unique_ptr<Tracer>> make_ours(const CellObject& object, std::string_view method) {
  Result<std::unique_ptr<Caster>> caster = make_cell_object_caster(object, method);
  if (!caster) {
    Error error = caster.error();
    const std::string_view name = method.substr(0, method.find(':'));
    const bool known = std::ranges::any_of(
        bench_methods(), [&](const std::string& m) { return std::string_view(m).starts_with(name); });
    if (!known)
      for (const std::string_view peer : kPeers) error.message += ", " + std::string(peer);
    return error;
  }
  return make_caster_tracer(std::move(*caster));
}

bool is_peer(std::string_view method) {
  for (const std::string_view peer : kPeers)
    if (peer == method) return true;
  return false;
}

/// One tile of one cell that is inside.
CellObject one_tile() {
  CellObject object;
  object.grid = {{0, 0, 0}, 0.25, {1, 1, 1}};
  object.tile.resolution = {4, 4, 4};
  object.tile.cell_count = 1;
  object.tile.pieces = {{1, {0, 0, 0}}};
  object.tile.voxel_ids.assign(64, 1);
  object.membership = {MembershipRule::kCentre, {1, 1, 1}, 1, {std::uint32_t(Tag::kInside)}, {}};
  return object;
}

}  // namespace

const std::vector<std::string>& bench_methods() {
  static const std::vector<std::string> methods = [] {
    std::vector<std::string> all = {"exact",    "linear:1/512", "linear:1/128", "linear:1/128:angle",
                                    "distance", "lod:1px"};
    all.insert(all.end(), kPeers.begin(), kPeers.end());
    return all;
  }();
  return methods;
}

std::unique_ptr<Tracer> make_caster_tracer(std::unique_ptr<Caster> caster) {
  return std::make_unique<CasterTracer>(std::move(caster));
}

Result<NamedTracer> make_tracer(const CellObject& object, std::string_view method, unsigned threads,
                                std::uint64_t max_bytes) {
  const auto start = std::chrono::steady_clock::now();
  Result<std::unique_ptr<Tracer>> tracer =
      is_peer(method) ? make_peer_tracer(object, method, threads, max_bytes) : make_ours(object, method);
  if (!tracer) return tracer.error();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  return NamedTracer{std::string(method), std::move(*tracer), took.count()};
}

Status try_method(std::string_view method) {
  const Result<NamedTracer> tracer = make_tracer(one_tile(), method, 1, std::uint64_t{1} << 30);
  return tracer ? Status{} : Status{tracer.error()};
}

}  // namespace mesocell
