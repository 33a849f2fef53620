#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sdk/core/triangle_mesh.h"

namespace mesocell {

/// The winding number that an open surface contributes at a point: the sum of its triangles' solid angles by
/// 4π, positive where it is seen from behind. [Jacobson 2013; far parts by their moments: Barill 2018]
///
/// A point on the surface counts as p + (ε, ε², ε³) with ε → 0+, exactly, as everywhere. Otherwise the sums
/// are of doubles. Thread safety: const.
class WindingField {
 public:
  explicit WindingField(const std::vector<std::array<Vec3, 3>>& triangles);

  struct Value {
    double winding = 0;
    double error = 0;  ///< bounds what is left out, rounding included; above 0.1 if the point is on an edge
  };
  /// Far parts are taken by their first and second moments, where that is off by less than `tolerance`.
  [[nodiscard]] Value approximate(Vec3 p, double tolerance) const;
  /// All triangles one by one.
  [[nodiscard]] Value sum(Vec3 p) const;

  /// The field in a box: far parts by what they and their gradients are at its centre, near triangles by
  /// themselves.
  struct Local {
    Vec3 centre, gradient;
    double winding = 0, error = 0;
    std::vector<std::uint32_t> near;
  };
  /// Far are those that are off by less than `tolerance` in the whole box. `local` is overwritten.
  void localize(const Box3& box, double tolerance, Local& local) const;
  /// At a point of the box.
  [[nodiscard]] Value at(const Local& local, Vec3 p) const;

  /// The most that the field can be in magnitude at any point of a box; the search ends beyond `enough`.
  [[nodiscard]] double bound(const Box3& box, double enough) const;
  /// Whether the box meets no triangle for certain.
  [[nodiscard]] bool clear_of(const Box3& box) const;

 private:
  struct Node {
    Box3 box;
    Vec3 centre, dipole;                 ///< of the areas
    std::array<double, 9> quadrupole{};  ///< Σ area · normal ⊗ (place - centre)
    double radius = 0, area = 0;
    double moment_root =
        0;  ///< at a gap g from the radius the expansion is off by (moment_root / g)⁴ at most
    std::uint32_t begin = 0, end = 0;   ///< triangles
    std::uint32_t left = 0, right = 0;  ///< 0: a leaf
  };
  std::uint32_t build(std::uint32_t begin, std::uint32_t end);

  std::vector<std::array<Vec3, 3>> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace mesocell
