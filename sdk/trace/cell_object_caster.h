#pragma once

#include <memory>
#include <string_view>

#include "format/api.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/trace/caster.h"

namespace mesocell MESOCELL_API {

/// Prepares a cell object for a method: "exact"; "linear:S" with the step S in tile edges, written as a
/// fraction ("linear:1/512") or a decimal; "linear:S:angle", whose step is shorter for rays along the
/// surface; "distance". Errors: kUsage (unknown method, step not in (0, 1]). `object` is copied where it is
/// needed; it may be destroyed afterwards.
[[nodiscard]] Result<std::unique_ptr<Caster>> make_cell_object_caster(const CellObject& object,
                                                                      std::string_view method);

}  // namespace mesocell
