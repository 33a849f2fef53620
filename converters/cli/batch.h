#pragma once

#include "converters/cli/commands.h"

namespace mesocell {

/// `convert` of several files into a folder, each by a process of its own: one that crashes or takes all
/// memory costs one file. Returns the exit code, that of the first file which failed if there is one.
[[nodiscard]] int run_batch(const ConvertCommand& command);

/// Lets a process that a batch started end when the batch does, however that ends; nothing in any other.
void end_with_batch();

}  // namespace mesocell
