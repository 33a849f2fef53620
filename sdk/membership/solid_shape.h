#pragma once

#include <cstdint>

#include "format/api.h"
#include "sdk/core/vec.h"

namespace mesocell MESOCELL_API {

/// On which side of a shape's surface all of a box is.
enum class BoxSide : std::uint8_t {
  kOutside,
  kInside,
  kMixed,  ///< or not known
};

/// A shape that says of any point whether it is inside, with no mesh in between: a volume, a field of
/// heights, a formula. Thread safety: const.
class SolidShape {
 public:
  virtual ~SolidShape() = default;
  /// The box beyond which nothing is inside, metres; empty if nothing is at all.
  [[nodiscard]] virtual Box3 box() const = 0;
  /// Whether a point is inside, metres.
  [[nodiscard]] virtual bool inside(Vec3 point) const = 0;
  /// The side of all points of a closed box, so that most of them need not be asked for: it may be kMixed
  /// where it is not, and must not be kInside or kOutside where inside() says else of one of them.
  [[nodiscard]] virtual BoxSide side(const Box3& box) const = 0;
};

}  // namespace mesocell
