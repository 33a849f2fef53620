#pragma once

#include <cstddef>
#include <vector>

#include "format/byte_reader.h"
#include "format/result.h"

/// The parts of mesocell_vdb_worker. They may throw what OpenVDB does, which serve_request() catches.
namespace mesocell {

[[nodiscard]] Result<std::vector<std::byte>> list_grids(ByteReader& request);
[[nodiscard]] Result<std::vector<std::byte>> read_grid(ByteReader& request);
[[nodiscard]] Result<std::vector<std::byte>> write_grids(ByteReader& request);

}  // namespace mesocell
