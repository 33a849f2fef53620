#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/shade/camera.h"
#include "sdk/trace/caster.h"

namespace mesocell {

enum class RenderMode : std::uint8_t { kFirstHit, kDepth, kCell };

/// Parses "first-hit", "depth" or "cell". Errors: kUsage.
[[nodiscard]] Result<RenderMode> parse_render_mode(std::string_view text);

struct RenderOptions {
  RenderMode mode = RenderMode::kFirstHit;
  std::uint32_t width = 1024, height = 768;
  CameraOptions camera = {};
  unsigned threads = 0;
};

/// A picture, rows from the top, and what it cost.
struct RenderResult {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgb;    ///< linear light, 3 a pixel
  std::vector<float> depth;  ///< metres along the unit ray; +inf is a miss
  std::uint64_t rays = 0, hits = 0;
  double seconds = 0;  ///< tracing and shading alone
};

/// Renders one ray a pixel, through its centre. Errors: kUsage (camera has no direction), kCancelled.
[[nodiscard]] Result<RenderResult> render(const Caster& caster, const RenderOptions& options,
                                          const Progress* progress = nullptr);

}  // namespace mesocell
