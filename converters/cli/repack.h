#pragma once

#include <optional>

#include "converters/cli/commands.h"
#include "converters/cli/representations.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// Whether `convert` has .meso files alone as its inputs.
[[nodiscard]] bool is_repack(const ConvertCommand& command);

/// `convert` of .meso files: puts their assets, or those that the inputs name, into one file, each chunk as
/// it was but for codec and metadata. An asset without a name gets that of its file where there are several.
[[nodiscard]] std::optional<Failure> repack(const ConvertCommand& command, const Progress& progress,
                                            AssetFile& written);

}  // namespace mesocell
