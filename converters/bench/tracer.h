#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/ray.h"
#include "sdk/trace/caster.h"

namespace mesocell {

/// A way to find the first hits of rays on a cell object, ours or another program's, as a benchmark sees it.
/// Thread safety: trace() is const and reentrant.
class Tracer {
 public:
  virtual ~Tracer() = default;

  /// hits[k] of rays[k], metres along directions of length 1. A tracer that does not know the voxel says
  /// element
  /// {-1, -1, -1}, one that does not know the cell label 0xffffffff; `face` is by the normal it has.
  /// `coherent`: neighbours in the stream (squares of 8 × 8 pixels, rows in turn) go nearly the same way.
  virtual void trace(std::span<const Ray> rays, std::span<StreamHit> hits, bool coherent) const = 0;

  /// What scene and acceleration data take, bytes.
  [[nodiscard]] virtual std::uint64_t memory_bytes() const = 0;

  /// See Caster::count_steps().
  [[nodiscard]] virtual std::uint64_t count_steps(std::span<const Ray>) const { return 0; }
};

/// Prepares an object for a peer: "embree-instanced", "embree-surface", "openvdb" or "nanovdb". Errors:
/// kLimit (it would take more than `max_bytes`; says how much), kUsage (no such peer), kMissing-like errors
/// of a module that cannot be loaded.
[[nodiscard]] Result<std::unique_ptr<Tracer>> make_peer_tracer(const CellObject& object,
                                                               std::string_view name, unsigned threads,
                                                               std::uint64_t max_bytes);

}  // namespace mesocell
