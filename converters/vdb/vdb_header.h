#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "format/result.h"

namespace mesocell {

/// What the head of a .vdb file says of one grid.
struct VdbGridHead {
  std::string key;  ///< by which OpenVDB finds it
  std::string name;
  std::uint32_t index = 0;  ///< among the grids of that name, in the order of the file
  bool only = true;         ///< whether no other grid has the name
  std::string type;         ///< "float_5_4_3"
  bool half = false;        ///< floats have 16 bits in the file

  /// As --grid takes it: the name, with its index if it is not the only one.
  [[nodiscard]] std::string label() const { return only ? name : name + "[" + std::to_string(index) + "]"; }
};

/// Whether a file begins as OpenVDB's do; false if it cannot be read.
[[nodiscard]] bool is_vdb_file(const std::string& path);

/// Reads and checks all that stands outside of the grids themselves: version, metadata, and of each grid its
/// name, type and place, which must be within the file and behind the one before. So much is sound of what
/// OpenVDB is given. Untrusted input: safe, memory is at most a small multiple of what is read, 16 MiB.
/// Errors: kUnreadable, kInvalidInput (no VDB, versions before 222 or after 224, no grids, written as a
/// stream without an index, damaged), kLimit.
[[nodiscard]] Result<std::vector<VdbGridHead>> read_vdb_header(const std::string& path,
                                                               std::uint64_t max_file_bytes = std::uint64_t{1}
                                                                                              << 36);

}  // namespace mesocell
