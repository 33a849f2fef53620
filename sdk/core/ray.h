#pragma once

#include "sdk/core/vec.h"

namespace mesocell {

/// The points origin + t·direction, t ≥ 0. The direction need not have length 1.
struct Ray {
  Vec3 origin;
  Vec3 direction;
};

}  // namespace mesocell
