#pragma once

#include <span>
#include <string>
#include <string_view>

#include "converters/stability/bit_grid.h"
#include "format/result.h"
#include "sdk/core/triangle_mesh.h"

namespace mesocell {

/// A method that tells inside from outside. It runs in a process of its own (isolated_run.h), which is killed
/// when it takes too long or the user interrupts, so it need neither report nor look for a cancellation.
struct Voxelizer {
  const char* name;         ///< for options and tables, such as "parity-x"
  const char* description;  ///< one line
  /// Sets the voxels of `out`, which is clear, whose centres are inside. `mesh`: in voxel units, voxel (x, y,
  /// z) of `out` has its centre at (x, y, z) + 1/2; no coordinate beyond 2^20. `threads`: 0 for the
  /// machine's.
  Status (*run)(const TriangleMesh& mesh, BitGrid& out, unsigned threads);
  /// Loads what the method needs, such as a module, so that its time is not the method's; null if nothing.
  Status (*prepare)();
};

/// All methods, in the order of the tables; ours is the last.
[[nodiscard]] std::span<const Voxelizer> voxelizers();

/// Names, for messages.
[[nodiscard]] std::string voxelizer_names();

/// By name; null if there is none.
[[nodiscard]] const Voxelizer* find_voxelizer(std::string_view name);

// The methods. methods/*.cpp says how each works.
Status voxelize_parity_x(const TriangleMesh& mesh, BitGrid& out, unsigned threads);
Status voxelize_parity_y(const TriangleMesh& mesh, BitGrid& out, unsigned threads);
Status voxelize_parity_z(const TriangleMesh& mesh, BitGrid& out, unsigned threads);
Status voxelize_signed_count(const TriangleMesh& mesh, BitGrid& out, unsigned threads);
Status voxelize_winding_exact(const TriangleMesh& mesh, BitGrid& out, unsigned threads);
Status voxelize_winding_fast(const TriangleMesh& mesh, BitGrid& out, unsigned threads);
Status voxelize_openvdb(const TriangleMesh& mesh, BitGrid& out, unsigned threads);
Status prepare_openvdb();
Status voxelize_alpha_wrap(const TriangleMesh& mesh, BitGrid& out, unsigned threads);
Status voxelize_ours(const TriangleMesh& mesh, BitGrid& out, unsigned threads);

}  // namespace mesocell
