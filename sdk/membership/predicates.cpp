#include "sdk/membership/predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace mesocell {
namespace {
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
}

int orientation_2d(double px, double py, double qx, double qy, double rx, double ry) {
  return int(CGAL::orientation(Kernel::Point_2(px, py), Kernel::Point_2(qx, qy), Kernel::Point_2(rx, ry)));
}

int orientation_3d(Vec3 a, Vec3 b, Vec3 c, Vec3 p) {
  return int(CGAL::orientation(Kernel::Point_3(a.x, a.y, a.z), Kernel::Point_3(b.x, b.y, b.z),
                               Kernel::Point_3(c.x, c.y, c.z), Kernel::Point_3(p.x, p.y, p.z)));
}

}  // namespace mesocell
