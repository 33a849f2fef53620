#include "sdk/core/gradient_kernel.h"

namespace mesocell {

const std::vector<KernelVoxel>& gradient_kernel() {
  static const std::vector<KernelVoxel> kernel = [] {
    constexpr std::int32_t r = 4;
    std::vector<KernelVoxel> list;
    for (std::int32_t z = -r; z <= r; ++z)
      for (std::int32_t y = -r; y <= r; ++y)
        for (std::int32_t x = -r; x <= r; ++x) {
          const std::int32_t d2 = x * x + y * y + z * z;
          if (d2 == 0 || d2 > r * r) continue;
          const double u = 1 - d2 / ((r + 0.5) * (r + 0.5));
          list.push_back({{x, y, z}, Vec3{double(x), double(y), double(z)} * (u * u)});
        }
    return list;
  }();
  return kernel;
}

}  // namespace mesocell
