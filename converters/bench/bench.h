#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "converters/bench/measure.h"
#include "converters/bench/ray_sets.h"
#include "converters/bench/scene.h"
#include "converters/bench/views.h"

namespace mesocell {

/// What is measured together: a scene, a view of it and a kind of rays. Those of one scene, and in it those
/// of one view, should follow each other.
struct BenchCase {
  std::string scene;  ///< the name of a scene; empty for the object that is given
  BenchView view;
  RaySet rays = RaySet::kPrimary;
};

struct BenchOptions {
  std::vector<std::string> methods;
  bool skip_missing = false;  ///< methods that cannot be had are left out with a note; else they are errors
  std::array<std::uint32_t, 2> size{1024, 768};  ///< pixels
  TimingOptions timing;
  std::uint64_t seed = 1;
  std::size_t oracle_rays = 1024;    ///< of every case, traced by brute force to check exact tracing
  double max_seconds = 0;            ///< cases that are not begun by then are left out; 0: no limit
  std::uint64_t max_peer_bytes = 0;  ///< memory that a peer may take
};

/// A line of the result.
struct BenchRow {
  std::string scene, shape, tile;
  std::uint32_t tiles = 0, resolution = 0;  ///< along the longest side; of the tile
  std::string camera, rays;
  double angle_degrees =
      0;  ///< mean angle between a ray and the surface that it hits; of a grazing view the plane it grazes
  std::uint32_t repeats = 0;
  TracerFigures figures;  ///< the errors of "exact" are against the oracle, on a sample
};

struct BenchResult {
  std::vector<BenchRow> rows;
  std::vector<std::string> notes;  ///< what was left out, and why
  /// Rays for which exact tracing did not find what the oracle did, or not the same every time: must be 0.
  std::uint64_t exact_differs = 0;
};

/// An object of the user's to measure on instead of scenes.
struct BenchObject {
  std::string name;
  CellObject object;
};

/// Measures all cases. Errors: kCancelled; kUsage for a method that cannot be had; those of make_scene() and
/// make_view(); kInvalidInput for an object of which nothing is seen.
[[nodiscard]] Result<BenchResult> run_bench(std::span<const BenchCase> cases,
                                            const std::optional<BenchObject>& object,
                                            const BenchOptions& options, const Progress& progress);

}  // namespace mesocell
