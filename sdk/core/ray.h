#pragma once

#include "format/api.h"
#include "sdk/core/vec.h"

namespace mesocell MESOCELL_API {

/// The points origin + t·direction, t ≥ 0. The direction need not have length 1.
struct Ray {
  Vec3 origin;
  Vec3 direction;
};

}  // namespace mesocell
