#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "format/api.h"
#include "format/container_scan.h"

namespace mesocell MESOCELL_API {

/// What a representation says of one of its chunks.
struct ChunkRule {
  std::uint32_t type = 0;
  bool critical = false;  ///< a chunk of this type must carry the critical flag, or must not
  bool required = false;
  bool raw = false;         ///< must be stored raw, so that it can be read before anything is decoded
  std::uint16_t minor = 0;  ///< version that brought it; in files of an older one its type is unknown
};

/// What container and validator know of a representation. Another representation is one more row.
struct Representation {
  std::uint32_t code = 0;  ///< the asset table's field
  std::string_view name;   ///< as people and scripts see it, e.g. "cell-object"
  std::span<const ChunkRule> chunks;
  /// Checks the content of all chunks of an asset that are usable and reports to the sink. Untrusted input:
  /// safe.
  void (*check)(std::span<const std::byte> file, const ContainerScan& scan, std::size_t asset,
                const ReadLimits& limits, MemoryBudget& budget, IssueSink& sink) = nullptr;

  /// The rule for a chunk type in a file of a minor version, null if the representation does not know it
  /// there.
  [[nodiscard]] const ChunkRule* find(std::uint32_t type, std::uint16_t minor) const;
};

/// All rows.
[[nodiscard]] std::span<const Representation> representations();
/// The row of a code, null if there is none.
[[nodiscard]] const Representation* find_representation(std::uint32_t code);

}  // namespace mesocell
