#pragma once

#include <optional>

#include "converters/cli/commands.h"
#include "converters/cli/representations.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// Whether the input of `convert` is a .vdb file of labels that holds an asset, of which no grid was asked
/// for.
[[nodiscard]] bool is_restore(const ConvertCommand& command);

/// `convert` of such a file: writes the asset that it was made from, but for what it does not keep. Untrusted
/// input: safe.
[[nodiscard]] std::optional<Failure> restore(const ConvertCommand& command, const Progress& progress,
                                             AssetFile& written);

}  // namespace mesocell
