#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sdk/core/vec.h"

namespace mesocell {

/// How steep the winding number of caps can be: of each cap the lesser of two bounds counts.
/// - Off the cap it is that of a dipole layer, whose gradient is at most 2 ∫ dA / r³ / 4π: good for small
///   caps and for slivers.
/// - It is harmonic off the loop, up to whole numbers, with the gradient (1/4π) ∮ r × dl / r³: good near a
///   large cap. [Biot-Savart; Jacobson 2013]
class CapGradient {
 public:
  /// One cap: its triangles and the segments of its loop.
  struct Cap {
    std::vector<std::array<Vec3, 3>> triangles;
    std::vector<std::array<Vec3, 2>> loop;
  };
  explicit CapGradient(const std::vector<Cap>& caps);

  /// The most that the gradient's length can be at any point of a box that meets no cap, per unit of length;
  /// for a box that meets one, of what the winding number is on either side. Infinite if a loop meets the
  /// box.
  [[nodiscard]] double bound(const Box3& box) const;

 private:
  /// Of caps, of a cap's triangles, or of its segments.
  struct Node {
    Box3 box;
    double area = 0, length = 0;
    std::uint32_t left = 0, right = 0;  ///< 0: a leaf
    std::uint32_t item = 0;             ///< of a leaf: the cap or the triangle
  };
  struct Roots {
    std::uint32_t triangles, loop;
  };
  std::uint32_t build(std::vector<Node>& items, std::size_t begin, std::size_t end);
  [[nodiscard]] double by_area(std::uint32_t root, const Box3& box, double enough) const;
  [[nodiscard]] double by_length(std::uint32_t root, const Box3& box) const;

  std::vector<Node> nodes_;
  std::vector<Roots> roots_;  ///< of each cap
  std::vector<std::array<Vec3, 3>> triangles_;
  std::uint32_t root_ = 0;
};

}  // namespace mesocell
