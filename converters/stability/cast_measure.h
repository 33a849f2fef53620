#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "converters/stability/cast_catalogue.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/trace/caster.h"

namespace mesocell {

/// A method of tracing in the tables.
struct CastMethod {
  const char* name;         ///< as make_cell_object_caster() takes it
  const char* description;  ///< one line
  bool exact;               ///< whether it must answer every probe
  /// Whether the source predicts its failures, see CastPrediction. Of a step by the angle it says that it
  /// avoids those at grazing angles.
  bool fails_on_thin, fails_at_grazing;
};

/// Those that are measured if none is named, in the order of the tables.
[[nodiscard]] std::span<const CastMethod> cast_methods();

enum class CastVerdict : std::uint8_t { kHolds, kFails, kFailsAsPredicted };
[[nodiscard]] const char* verdict_name(CastVerdict verdict);

/// How a method answers the probes of a case.
struct CastErrors {
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;        ///< by the truth; so the next ones' shares
  std::uint64_t missed = 0;      ///< hits that the method does not find
  std::uint64_t wrong_cell = 0;  ///< hits of another cell
  std::uint64_t off = 0;         ///< hits of the right cell, but farther from the truth than is tolerated
  std::uint64_t false_hits = 0;  ///< rays that hit nothing, for which it finds something
  /// Distance of found hits from true ones, voxels, those of wrong cells too.
  double depth_mean = 0, depth_p99 = 0, depth_max = 0;
  std::uint64_t steps = 0;  ///< Caster::count_steps() of the rays of first hits; 0 if not counted

  [[nodiscard]] std::uint64_t wrong() const { return missed + wrong_cell + off + false_hits; }
  [[nodiscard]] double wrong_percent() const { return rays == 0 ? 0 : 100 * double(wrong()) / double(rays); }
  [[nodiscard]] double miss_rate() const { return hits == 0 ? 0 : double(missed) / double(hits); }
  /// Of the rays that truly hit nothing.
  [[nodiscard]] double false_hit_rate() const {
    return rays == hits ? 0 : double(false_hits) / double(rays - hits);
  }
};

/// One method on one case.
struct CastResult {
  std::string group, name, strength, method;
  CastErrors errors;
  CastVerdict verdict = CastVerdict::kHolds;
  bool exact = false;

  [[nodiscard]] std::string row() const { return strength.empty() ? name : name + " " + strength; }
};

/// How far a hit may be from the truth, voxels: of an approximate method, for each mirror on the way. An exact one
/// has rounding alone, and kCastStart off each mirror.
inline constexpr double kCastTolerance = 1.0 / 16;

/// Asks a caster of the case's object all its probes.
[[nodiscard]] CastErrors measure_case(const CastCase& c, const Caster& caster, bool exact, unsigned threads);

/// All cases with all methods. Errors: kCancelled; those of make_cell_object_caster().
[[nodiscard]] Result<std::vector<CastResult>> measure_cast_stability(std::span<const CastCase> cases,
                                                                     std::span<const CastMethod> methods,
                                                                     unsigned threads,
                                                                     const Progress* progress);

}  // namespace mesocell
