#pragma once

#include <cstdint>

#include "converters/image/input_file.h"
#include "format/result.h"

namespace mesocell {

/// Checks the headers of an OpenEXR file before the image library sees it, which takes memory of the sizes
/// that stand in them: all attributes must lie within the file, and data windows and tiles have at most
/// `max_side` pixels along each side [OpenEXR, File Layout]. Untrusted input: safe. Errors: kInvalidInput,
/// kLimit.
[[nodiscard]] Status check_exr(const InputFile& file, std::uint32_t max_side);

}  // namespace mesocell
