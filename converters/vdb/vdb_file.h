#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "converters/vdb/sparse_volume.h"
#include "converters/vdb/vdb_header.h"
#include "converters/vdb/vdb_wire.h"
#include "converters/worker/worker.h"
#include "format/result.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// What a grid is wanted for; it says which types are usable.
enum class VdbPurpose : std::uint8_t {
  kShape,   ///< float, double, bool, mask, int32, int64
  kColors,  ///< vec3s, vec3d
  kLabels,  ///< int32, int64, bool, mask
  kAny,     ///< all of these, and vec3i
};

struct VdbReadOptions {
  /// NAME, or NAME[INDEX] for the INDEX-th grid of that name in the file, from 0; empty for the first one
  /// that is usable.
  std::string grid;
  VdbPurpose purpose = VdbPurpose::kShape;
  std::uint64_t max_file_bytes = std::uint64_t{1} << 36;
  std::uint64_t max_voxels = std::uint64_t{1} << 28;  ///< in leaves; tiles of one value do not count
  std::uint64_t max_bytes = std::uint64_t{2} << 30;   ///< of what is read of the grid
  WorkerLimits worker;
};

struct VdbReadReport {
  std::string grid;                 ///< which was read, as --grid takes it
  std::vector<std::string> others;  ///< that were not, where none was asked for
};

/// Reads one grid of a .vdb file. Half floats and doubles become floats, colors of doubles too, labels have
/// 32 bits, a bool grid is a mask of its true voxels. Untrusted input: safe. read_vdb_header() checks the
/// head; OpenVDB runs in a program of its own, see run_worker(), which reads trees first and values only
/// after their number is in the limits; its reply is checked by read_volume(). Errors: those of these two;
/// kUsage (no such grid), kInvalidInput (a type that is not usable, by name; a frustum), kLimit.
[[nodiscard]] Result<SparseVolume> read_vdb(const std::string& path, const VdbReadOptions& options = {},
                                            VdbReadReport* report = nullptr,
                                            const Progress* progress = nullptr);

/// A grid of a file and what is known of it without its values.
struct VdbGridInfo {
  VdbGridHead head;
  VdbGridFacts facts;   ///< with a transform that is sound, or marked as not linear
  bool usable = false;  ///< as a shape, colors or labels
};

/// Lists the grids of a .vdb file, in its order. Untrusted input: safe. Errors: as of read_vdb().
[[nodiscard]] Result<std::vector<VdbGridInfo>> list_vdb(const std::string& path,
                                                        const WorkerLimits& limits = {},
                                                        const Progress* progress = nullptr);

/// Writes volumes as grids of a .vdb file, in their order, which appears whole or not at all. The same
/// volumes give the same bytes. Errors: kOutput, kLimit, kCancelled.
[[nodiscard]] Status write_vdb(const std::string& path, std::span<const SparseVolume> volumes,
                               bool no_clobber = false, const WorkerLimits& limits = {},
                               const Progress* progress = nullptr);

}  // namespace mesocell
