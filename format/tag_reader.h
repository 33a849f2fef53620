#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "format/api.h"
#include "format/byte_source.h"
#include "format/cell_object.h"
#include "format/limits.h"
#include "format/result.h"

namespace mesocell MESOCELL_API {

/// Tags of a cell object, read tile by tile from a file of which nothing else is read: for assets of many
/// tiles that are streamed. [spec 3.5, 4.3] Untrusted input: safe. What is read is checked, what is not read
/// may be wrong.
class TagReader {
 public:
  /// Reads the head of the file, GRID and the header of MEMB. The source must outlive it. Errors: those of
  /// the source; kInvalidInput with the id; kLimit; kUsage if there is no such asset or it is no cell
  /// object.
  [[nodiscard]] static Result<TagReader> open(ByteSource& source, std::size_t asset = 0,
                                              const ReadLimits& limits = {});
  TagReader(TagReader&&) noexcept;
  TagReader& operator=(TagReader&&) noexcept;
  ~TagReader();

  [[nodiscard]] const GridLayout& grid() const;
  [[nodiscard]] std::uint32_t cell_count() const;
  /// The tags of all cells whose home is the tile, cell 1 first. Each coordinate must be in the grid
  /// (assert). Errors: as open().
  [[nodiscard]] Result<std::vector<Tag>> tags(const Index3& tile);

 private:
  struct State;
  explicit TagReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mesocell
