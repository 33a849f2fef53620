#include "format/representation.h"

#include <algorithm>
#include <array>

#include "format/cell_object_chunks.h"
#include "format/cell_object_io.h"

namespace mesocell {
namespace {

constexpr std::array kCellObjectRules = {
    ChunkRule{kGridChunk, true, true, true},
    ChunkRule{kTileChunk, true, true},
    ChunkRule{kMembershipChunk, true, true},
    ChunkRule{kColorChunk, false, false},
    ChunkRule{kCellColorChunk, false, false},
    ChunkRule{kInstanceColorChunk, false, false},
    ChunkRule{kNormalChunk, false, false},
    ChunkRule{kTextChunk, false, false},
    ChunkRule{kBasicMeshChunk, false, false, false, 1},
    ChunkRule{kSurfaceColorChunk, false, false, false, 1},
};

constexpr std::array kRepresentations = {
    Representation{kCellObjectRepresentation, "cell-object", kCellObjectRules,
                   [](std::span<const std::byte> file, const ContainerScan& scan, std::size_t asset,
                      const ReadLimits& limits, MemoryBudget& budget,
                      IssueSink& sink) { (void)check_cell_object(file, scan, asset, limits, budget, sink); }},
};

}  // namespace

const ChunkRule* Representation::find(std::uint32_t type, std::uint16_t minor) const {
  const auto at = std::find_if(chunks.begin(), chunks.end(),
                               [&](const ChunkRule& r) { return r.type == type && r.minor <= minor; });
  return at == chunks.end() ? nullptr : &*at;
}

std::span<const Representation> representations() { return kRepresentations; }

const Representation* find_representation(std::uint32_t code) {
  const auto at = std::find_if(kRepresentations.begin(), kRepresentations.end(),
                               [&](const Representation& r) { return r.code == code; });
  return at == kRepresentations.end() ? nullptr : &*at;
}

}  // namespace mesocell
