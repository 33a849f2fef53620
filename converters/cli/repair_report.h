#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sdk/author/repair.h"
#include "sdk/membership/diagnose.h"

namespace mesocell {

/// What is amiss with a mesh: {depth, closed, triangles, components, closed_components, cavities, findings
/// [{id, count, at_least, example [x, y, z] or null, text}]}.
[[nodiscard]] nlohmann::ordered_json diagnosis_json(const MeshDiagnosis& diagnosis);

/// All of a report.
[[nodiscard]] nlohmann::ordered_json repair_json(const RepairReport& report);

/// What is kept in an asset of a repair: the rung that decided, how many voxels it was unsure of, and what
/// was changed, such as "winding, 12 voxels unsure, 8 edges stitched". Lengths in metres.
[[nodiscard]] std::string repair_text(const RepairReport& report);

}  // namespace mesocell
