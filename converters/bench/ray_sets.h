#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "sdk/core/progress.h"
#include "sdk/core/ray.h"
#include "sdk/shade/camera.h"
#include "sdk/trace/caster.h"

namespace mesocell {

/// Rays of one kind. Those after the first hit start at it, a 1/64 voxel off its face, so that tracers in
/// single precision are not asked for what they cannot tell.
enum class RaySet : std::uint8_t {
  kPrimary,     ///< through the centres of pixels, squares of 8 × 8 of them, rows in turn
  kDiffuse,     ///< one from every hit of those, by the cosine to the shading normal
  kReflection,  ///< the same by the mirror
  kShadow,      ///< the same to a light off the box
};
[[nodiscard]] std::string_view ray_set_name(RaySet set);
[[nodiscard]] std::optional<RaySet> find_ray_set(std::string_view name);

/// Whether neighbours in the stream go nearly the same way.
[[nodiscard]] bool is_coherent(RaySet set);

/// The rays of a set, directions of length 1. The same seed gives the same rays for every number of threads.
/// Empty if cancelled.
[[nodiscard]] std::vector<Ray> make_rays(RaySet set, const Caster& exact, const Camera& camera,
                                         std::uint32_t width, std::uint32_t height, std::uint64_t seed,
                                         unsigned threads, const Progress& progress);

}  // namespace mesocell
