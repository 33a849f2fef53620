#pragma once

#include <string_view>

namespace mesocell {

inline constexpr std::string_view kPlyContent = "a PLY mesh", kOffContent = "an OFF mesh",
                                  kGlbContent = "a glTF scene", kGltfContent = "a glTF scene as JSON",
                                  kDracoContent = "a mesh compressed by Draco",
                                  kExrContent = "an OpenEXR image", kHdrContent = "a Radiance HDR image",
                                  kTiffContent = "a TIFF image";

/// What the first bytes of a file say it is: "a PNG image", "a PLY mesh", …; empty if they say nothing.
/// Untrusted input: safe.
[[nodiscard]] std::string_view sniff_content(std::string_view bytes);

}  // namespace mesocell
