#include "converters/vdb/vdb_object.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "converters/vdb/assemble_object.h"
#include "converters/vdb/object_metadata.h"
#include "converters/vdb/vdb_header.h"

namespace mesocell {

bool is_vdb_object(const std::string& path) {
  const Result<std::vector<VdbGridHead>> grids = read_vdb_header(path);
  if (!grids) return false;
  const auto has = [&](const char* name, const char* type) {
    return std::any_of(grids->begin(), grids->end(), [&](const VdbGridHead& grid) {
      return grid.only && grid.name == name && grid.type == type;
    });
  };
  return has(kTileGrid, "int32_5_4_3") && has(kHomeGrid, "vec3i_5_4_3") &&
         has(kMembershipGrid, "int32_5_4_3");
}

Result<CellObject> read_vdb_object(const std::string& path, const VdbReadOptions& options, unsigned threads,
                                   const Progress* progress) {
  std::array<SparseVolume, 3> grids;
  constexpr std::array<const char*, 3> kNames = {kTileGrid, kHomeGrid, kMembershipGrid};
  for (std::size_t i = 0; i < grids.size(); ++i) {
    VdbReadOptions one = options;
    one.grid = kNames[i];
    one.purpose = VdbPurpose::kAny;
    Result<SparseVolume> volume = read_vdb(path, one, nullptr, progress);
    if (!volume) return volume.error();
    grids[i] = std::move(*volume);
  }
  return assemble_object(grids[0], grids[1], grids[2], threads, progress);
}

}  // namespace mesocell
