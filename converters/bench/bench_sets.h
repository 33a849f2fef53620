#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "converters/bench/bench.h"

namespace mesocell {

/// What is measured unless words on the command line say else.
struct BenchSet {
  std::vector<std::string> scenes = {}, views = {};  ///< names, each with each
  std::vector<RaySet> rays = {};                     ///< of each view
  std::vector<RaySet> first_rays = {};               ///< more of them, of the first scene
  /// Views whose other rays than primary ones are left out.
  std::vector<std::string> primary_only = {};
  /// More scenes with views of their own, primary rays.
  std::vector<std::string> more_scenes = {}, more_views = {};
  std::vector<std::string> methods = {};
  double pass_seconds = 0, max_seconds = 0;  ///< see TimingOptions and BenchOptions
  /// Peers that would take more memory are left out: making the surface of 64³ tiles, or the volume of 128³, takes half
  /// a minute.
  std::uint64_t max_peer_bytes = std::uint64_t{384} << 20;
};

/// "quick", below a minute; "default", below ten; "full". Errors: kUsage.
[[nodiscard]] Result<BenchSet> find_bench_set(std::string_view name);

/// The cases of a set, in order. Errors: kUsage (a scene or a view that there is not).
[[nodiscard]] Result<std::vector<BenchCase>> bench_cases(const BenchSet& set);

}  // namespace mesocell
