#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "format/cell_object.h"
#include "sdk/core/ray.h"

namespace mesocell {

/// What is asked of a caster.
enum class CastQuestion : std::uint8_t {
  kFirstHit,    ///< Caster::first_hit()
  kFirstExit,   ///< Caster::first_exit(), from inside
  kRefraction,  ///< the exit, and whether the ray leaves glass of index 1.5 there or is reflected within
  kReflections  ///< the last of several mirror reflections between two cells
};

/// Where the source says that its search fails.
enum class CastPrediction : std::uint8_t {
  kNone,
  /// What a ray passes through by less than a step is missed, thin cells and the outer parts of others.
  /// [Nürnberg 2011, 5.3]
  kThin,
  kGrazing  ///< a step that does not depend on the angle misses cells at grazing angles [Nürnberg
            ///< 2011, 3.2.2]
};

/// A question with its answer, in closed form.
struct CastProbe {
  Ray ray;                 ///< unit direction, but for directions whose numbers must be exact
  bool hit = false;        ///< of kRefraction: whether the ray leaves
  double t = 0;            ///< of the hit or exit; of kReflections unused
  std::uint32_t cell = 0;  ///< that is hit; 0 if it does not matter
  Vec3 last;               ///< of kReflections: where the last mirror is met
};

/// An object and questions about it.
struct CastCase {
  std::string group;     ///< "thin", "gaps", "grazing", "far", "along" or "light"
  std::string name;      ///< such as "needle"
  std::string strength;  ///< such as "1 voxel"; empty where there is none
  CastQuestion question = CastQuestion::kFirstHit;
  CastPrediction prediction = CastPrediction::kNone;
  CellObject object;
  std::vector<CastProbe> probes;
  std::uint32_t mirrors = 0;  ///< of kReflections: how many mirrors are met
  double slack = 0;           ///< voxels by which starts of further rays are moved, in all

  [[nodiscard]] std::string row() const { return strength.empty() ? name : name + " " + strength; }
};

/// Index of refraction of kRefraction.
inline constexpr double kCastIor = 1.5;
/// Starts of kReflections are moved off the mirror by this, voxels, as the renderer's are.
inline constexpr double kCastStart = 1e-5;

/// Thin walls, needles, checkerboards of cells, gaps of a voxel, sweeps from 0.01° to 90°, far and tiny
/// objects, rays along faces, edges and corners, the critical angle, mirrors. `rays` probes a case, 1 to
/// 2^20. The same on every machine.
[[nodiscard]] std::vector<CastCase> cast_cases(std::uint32_t rays);

}  // namespace mesocell
