#pragma once

#include <span>
#include <string_view>

#include "sdk/core/triangle_mesh.h"

namespace mesocell {

/// A shape that scenes of the benchmark are made of: a closed mesh in [-0.5, 0.5]³, grid edges.
struct BenchShape {
  std::string_view name, description;
  TriangleMesh (*make)();
};

/// Six that differ in what they ask of a caster.
[[nodiscard]] std::span<const BenchShape> bench_shapes();

}  // namespace mesocell
