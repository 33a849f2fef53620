#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "format/api.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/shade/camera.h"
#include "sdk/shade/environment.h"
#include "sdk/shade/radiance.h"
#include "sdk/trace/caster.h"

namespace mesocell MESOCELL_API {

enum class RenderMode : std::uint8_t { kFirstHit, kDepth, kCell, kNormal, kColor };

/// Parses "first-hit", "depth", "cell", "normal" or "color". Errors: kUsage.
[[nodiscard]] Result<RenderMode> parse_render_mode(std::string_view text);

struct RenderOptions {
  RenderMode mode = RenderMode::kFirstHit;
  std::uint32_t width = 1024, height = 768;
  CameraOptions camera = {};
  Lighting lighting = {};
  const Environment* environment = nullptr;  ///< an even, light sky if there is none
  bool layers = false;                       ///< fill normal and color of the result in every mode
  std::uint32_t samples = 1;                 ///< rays a pixel, for the picture alone; 1…4096
  unsigned threads = 0;                      ///< 0: the machine's; the result does not depend on it
};

/// A picture, rows from the top, and what it cost. All but the picture is of the ray through a pixel's
/// centre.
struct RenderResult {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgb;     ///< linear light, 3 a pixel
  std::vector<float> depth;   ///< metres along the unit ray; +inf is a miss
  std::vector<float> normal;  ///< shading normals, 3 a pixel; 0 is a miss; empty if not asked for
  std::vector<float> color;   ///< of the object, linear light, 3 a pixel; 0 is a miss; empty if not asked for
  std::vector<float> cell;    ///< label; 0 is a miss
  std::uint64_t rays = 0, hits = 0;  ///< primary rays through the pixels' centres
  double seconds = 0;                ///< tracing and shading alone
};

/// Renders a picture. Errors: kUsage (camera without direction, lighting out of range), kCancelled.
[[nodiscard]] Result<RenderResult> render(const Caster& caster, const RenderOptions& options,
                                          const Progress* progress = nullptr);

}  // namespace mesocell
