#pragma once

#include <cstdint>
#include <string_view>

namespace mesocell {

inline constexpr std::string_view kPlyContent = "a PLY mesh", kOffContent = "an OFF mesh",
                                  kGlbContent = "a glTF scene", kGltfContent = "a glTF scene as JSON",
                                  kDracoContent = "a mesh compressed by Draco",
                                  kExrContent = "an OpenEXR image", kHdrContent = "a Radiance HDR image",
                                  kTiffContent = "a TIFF image";

/// What the first bytes of a file say it is: "a PNG image", "a PLY mesh", …; empty if they say nothing. A
/// thousand bytes suffice, but for a glTF scene as JSON. Untrusted input: safe.
[[nodiscard]] std::string_view sniff_content(std::string_view bytes);

/// The same of a file whose bytes say nothing, by its extension (lower case, with the dot) and its size.
[[nodiscard]] std::string_view sniff_name(std::string_view extension, std::uint64_t bytes);

/// What to do with terrain that is not read, by what it is called above: "convert it …"; empty if it is none.
[[nodiscard]] std::string_view terrain_remedy(std::string_view content);

}  // namespace mesocell
