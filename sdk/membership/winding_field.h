#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sdk/core/triangle_mesh.h"

namespace mesocell {

/// The winding number that an open surface contributes at a point: the sum of its triangles' solid angles by
/// 4π, positive where it is seen from behind. [Jacobson 2013; far parts by dipoles: Barill 2018]
///
/// A point on the surface counts as p + (ε, ε², ε³) with ε → 0+, exactly, as everywhere. Otherwise the sums
/// are of doubles. Thread safety: const.
class WindingField {
 public:
  explicit WindingField(const std::vector<std::array<Vec3, 3>>& triangles);

  struct Value {
    double winding = 0;
    double error = 0;  ///< bounds what is left out, rounding included
  };
  /// Far parts are taken as dipoles.
  [[nodiscard]] Value approximate(Vec3 p) const;
  /// All triangles one by one.
  [[nodiscard]] Value sum(Vec3 p) const;

  /// The most that the field can be in magnitude at any point of a box; the search ends beyond `enough`.
  [[nodiscard]] double bound(const Box3& box, double enough) const;
  /// Whether no triangle's box meets the box.
  [[nodiscard]] bool clear_of(const Box3& box) const;

 private:
  struct Node {
    Box3 box;
    Vec3 centre, dipole;  ///< of the areas
    double radius = 0, area = 0;
    std::uint32_t begin = 0, end = 0;   ///< triangles
    std::uint32_t left = 0, right = 0;  ///< 0: a leaf
  };
  std::uint32_t build(std::uint32_t begin, std::uint32_t end);

  std::vector<std::array<Vec3, 3>> triangles_;
  std::vector<Node> nodes_;
};

/// How fast the winding number of a surface can change with place: it is harmonic off the surface and its
/// gradient is an integral along the boundary, (1/4π) ∮ r × dl / r³. [Biot-Savart; Jacobson 2013]
class BoundaryGradient {
 public:
  /// Line segments, each as often as the boundary runs along it.
  explicit BoundaryGradient(const std::vector<std::array<Vec3, 2>>& segments);

  /// The most that the gradient's length can be at any point of a box, per unit of length; infinite if a
  /// segment meets the box. At most twice as large as the sum of the segments' own bounds.
  [[nodiscard]] double bound(const Box3& box) const;

 private:
  struct Node {
    Box3 box;
    double length = 0;
    std::uint32_t begin = 0, end = 0, left = 0, right = 0;
  };
  std::uint32_t build(std::uint32_t begin, std::uint32_t end);

  std::vector<std::array<Vec3, 2>> segments_;
  std::vector<Node> nodes_;
};

}  // namespace mesocell
