#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/result.h"
#include "sdk/shade/camera.h"
#include "sdk/trace/caster.h"

namespace mesocell {

/// A place to look at an object from:
/// - "full": from 1.1 edges (of the longest side of its box) before its centre on -z, 48.46° high;
/// - "cover90": from the same place, the largest window of which nine tenths are covered;
/// - "close": from 1.5 tiles before what is in the middle of that window;
/// - "grazing-A": at A degrees, 0.1 to 90, to the plane through what is around there; "grazing" is
/// "grazing-5";
/// - "inside": from the empty place in the box from which the most is seen.
struct BenchView {
  std::string name;
  double graze_degrees = 0;  ///< of a grazing view
};

struct PlacedView {
  Camera camera;
  std::optional<Vec3> plane;  ///< the unit normal of the plane that a grazing view grazes
};

/// Errors: kUsage with the names there are.
[[nodiscard]] Result<BenchView> parse_view(std::string_view name);

/// Lays the view on an object by its exact caster. `tile_edge`: metres. Errors: kInvalidInput if there is no
/// such place, as nothing is seen of the object, or no empty one is in its box.
[[nodiscard]] Result<PlacedView> make_view(const BenchView& view, const Caster& exact, double tile_edge,
                                           std::uint32_t width, std::uint32_t height);

}  // namespace mesocell
