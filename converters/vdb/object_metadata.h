#pragma once

#include <string>
#include <utility>
#include <vector>

#include "format/cell_object.h"
#include "format/result.h"

/// What a .vdb file of labels says, in the metadata of its grid kTileGrid, of the asset that it holds.
namespace mesocell {

inline constexpr const char* kCellGrid = "cell";
inline constexpr const char* kMembershipGrid = "membership";
inline constexpr const char* kTileGrid = "tile";
inline constexpr const char* kHomeGrid = "tile_home";

using TextPairs = std::vector<std::pair<std::string, std::string>>;

/// The asset's layout: keys mesocell:version, box_min, voxel_edge, tiles, resolution, rule, cells. Numbers
/// are decimal, and the shortest that are read back exactly.
[[nodiscard]] TextPairs object_metadata(const CellObject& object);

/// What these texts say.
struct ObjectLayout {
  GridLayout grid;
  Index3 resolution{};
  MembershipRule rule = MembershipRule::kCentre;
  std::uint32_t cells = 0;
};

/// Whether the texts are of an asset at all.
[[nodiscard]] bool has_object_metadata(const TextPairs& texts);

/// Reads them back. Untrusted input: safe. What is returned is in the format's bounds: a finite box, an edge
/// above 0, resolutions 4…1024, at most 2^26 tiles, 1…65535 cells. Errors: kInvalidInput.
[[nodiscard]] Result<ObjectLayout> parse_object_metadata(const TextPairs& texts);

}  // namespace mesocell
