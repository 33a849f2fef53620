#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "converters/cli/commands.h"
#include "converters/cli/console.h"
#include "converters/cli/shape_source.h"
#include "converters/vdb/volume_shape.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// Whether an input is a volume, by what it begins with, else by its extension: a VDB or a scan.
[[nodiscard]] bool is_volume_input(const std::string& path);

/// Reads a volume as the shape of `convert`: the grid and the value of the surface that the command says.
/// Untrusted input: safe.
[[nodiscard]] std::optional<Failure> read_volume_shape(const ConvertCommand& command,
                                                       const Progress& progress,
                                                       std::unique_ptr<ShapeSource>& shape,
                                                       std::vector<Warning>& warnings, ReadNotes& notes);

/// Notes the grids of a .vdb file but those that were taken, by their labels.
void note_other_grids(const std::string& path, const std::vector<std::string>& taken, ReadNotes& notes);

/// Reads the colors of a grid of a .vdb file, the first one of colors if none is named. Untrusted input:
/// safe.
[[nodiscard]] Result<std::shared_ptr<const VolumeColors>> read_volume_colors(const std::string& path,
                                                                             const std::string& grid,
                                                                             const Progress* progress);

/// What `info` tells of a volume: format, and of each grid name, type, class, active voxels, transform, box.
/// Untrusted input: safe.
[[nodiscard]] Result<nlohmann::ordered_json> describe_volume(const std::string& path,
                                                             const Progress& progress);

/// What volumes are read and how, for help texts.
[[nodiscard]] std::string volumes_help();

}  // namespace mesocell
