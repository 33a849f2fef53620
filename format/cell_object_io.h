#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/container.h"
#include "format/limits.h"
#include "format/result.h"

namespace mesocell MESOCELL_API {

/// The bytes of a .meso file that holds the object. The same object gives the same bytes. [spec 4]
/// The maps must satisfy what format/cell_object.h says of them (assert; a debug build reads the bytes back).
/// Errors: kLimit where the grid or the tile is larger than the format allows, kUsage where metadata is not
/// valid UTF-8, not in ascending order of keys or has an empty or too long key, or where the version is none.
[[nodiscard]] Result<std::vector<std::byte>> encode_cell_object(const CellObject& object,
                                                                const WriteOptions& options = {});

/// An asset of a file of several.
struct NamedCellObject {
  const CellObject* object = nullptr;  ///< not null (assert)
  std::string name;                    ///< UTF-8, at most 40 bytes, not that of another one; may be empty
};

/// The bytes of a file that holds these objects, at least one (assert). Errors: as encode_cell_object(), and
/// kUsage for a name that is not allowed, kLimit for more than 1024 objects.
[[nodiscard]] Result<std::vector<std::byte>> encode_cell_objects(std::span<const NamedCellObject> objects,
                                                                 const WriteOptions& options = {});

/// Decodes the chunks of one asset of an opened container and checks every rule of [spec 4]. Chunks that it
/// does not need are not looked at: see Container::verify(). Untrusted input: safe.
/// Errors: kInvalidInput with the issue's id, chunk and offset; kLimit; kUsage if there is no such asset.
[[nodiscard]] Result<CellObject> decode_cell_object(const Container& container, const ReadLimits& limits = {},
                                                    std::size_t asset = 0);

/// Opens the file, and verifies and decodes one asset of it: what most callers want. It accepts exactly the
/// assets in which validate() finds no fault. Untrusted input: safe. Errors: as Container::open and
/// decode_cell_object.
[[nodiscard]] Result<CellObject> read_cell_object(std::span<const std::byte> file,
                                                  const ReadLimits& limits = {}, std::size_t asset = 0);

/// Decodes and checks the chunks of a cell object, reporting to `sink`; those not `usable` are passed over.
/// Empty after an error. For readers and the validator. Untrusted input: safe.
[[nodiscard]] std::optional<CellObject> check_cell_object(std::span<const std::byte> file,
                                                          const ContainerScan& scan, std::size_t asset,
                                                          const ReadLimits& limits, MemoryBudget& budget,
                                                          IssueSink& sink);

}  // namespace mesocell
