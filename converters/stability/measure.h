#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "converters/stability/catalogue.h"
#include "converters/stability/isolated_run.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// Voxels that a method got wrong, and what they are shares of.
struct WrongVoxels {
  std::uint64_t wrong = 0;      ///< that are not as in the truth
  std::uint64_t wrong_far = 0;  ///< of them those whose centres are over two voxels from the true surface
  std::uint64_t inside = 0;     ///< of the grid that are truly inside
  std::uint64_t far = 0;        ///< of the grid whose centres are over two voxels from the true surface
  std::uint64_t voxels = 0;     ///< of the grid

  /// In per cent of those truly inside; may be over 100. If nothing is inside, of the grid.
  [[nodiscard]] double wrong_percent() const {
    return wrong == 0 ? 0 : 100 * double(wrong) / double(inside > 0 ? inside : voxels);
  }
  /// Those that are far and wrong, in per cent of all that are far.
  [[nodiscard]] double wrong_far_percent() const {
    return far == 0 ? 0 : 100 * double(wrong_far) / double(far);
  }

  WrongVoxels& operator+=(const WrongVoxels& other);
};

/// One method on one case.
struct StabilityResult {
  std::string group, name, strength, mesh, method;
  Index3 size{};
  IsolatedRun run;
  WrongVoxels voxels;  ///< wrong ones counted only if the run is done

  [[nodiscard]] std::string row() const { return strength.empty() ? name : name + " " + strength; }
};

/// What is truly inside and near the surface.
struct Truth {
  BitGrid inside;
  BitGrid near;  ///< centres at most two voxels from the surface
};

/// By the exact definition of the format on the sound mesh. [spec 4.3] Errors: kInvalidInput if it is not
/// closed; kLimit.
[[nodiscard]] Result<Truth> find_truth(const TriangleMesh& sound, const Index3& size, unsigned threads);

/// `found` has the truth's size (assert).
[[nodiscard]] WrongVoxels compare_with_truth(const BitGrid& found, const Truth& truth);

struct MeasureOptions {
  unsigned threads = 0;
  double max_seconds = 20;  ///< of processor time, for each run
  unsigned repeat = 1;      ///< runs of each method on each case; the median of their times is kept
};

/// Runs methods on cases, one after the other. Errors: kCancelled, kLimit, those of find_truth() and of
/// run_isolated().
[[nodiscard]] Result<std::vector<StabilityResult>> measure_stability(
    std::span<const StabilityCase> cases, std::span<const Voxelizer* const> methods,
    const MeasureOptions& options, const Progress* progress);

}  // namespace mesocell
