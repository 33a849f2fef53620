#pragma once

#include <memory>

#include "converters/bench/tracer.h"

/// The peers, one function each; make_peer_tracer() chooses.
namespace mesocell {

/// Meshes of cells, instanced, or the surface of the union as one mesh, in Embree. `call`: which of its calls
/// traces: "1", "8", "16" or "stream"; empty for the fastest of them, for coherent rays and others, which a
/// trial on the first rays that come tells. Of cells that touch each other a ray that begins in one may be
/// said to meet the next.
[[nodiscard]] Result<std::unique_ptr<Tracer>> make_embree_tracer(const CellObject& object, bool instanced,
                                                                 std::string_view call, unsigned threads,
                                                                 std::uint64_t max_bytes);

/// INSIDE voxels as active ones of a mask, in OpenVDB or, converted, in NanoVDB.
[[nodiscard]] Result<std::unique_ptr<Tracer>> make_vdb_tracer(const CellObject& object, bool nano,
                                                              std::uint64_t max_bytes);

}  // namespace mesocell
