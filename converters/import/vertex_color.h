#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "converters/import/plain_mesh.h"

namespace mesocell {

/// Of a vertex without a color where others have one.
inline constexpr Rgb8 kMissingColor{255, 255, 255};

/// The color of three channels, of which `full` is the full value. Channels beyond 0…`full` are held to it; a
/// channel that is no number makes no color.
inline std::optional<Rgb8> make_color(const std::array<double, 3>& channels, double full) {
  Rgb8 color{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::isnan(channels[k])) return std::nullopt;
    color[k] = std::uint8_t(std::clamp(channels[k] / full, 0.0, 1.0) * 255 + 0.5);
  }
  return color;
}

/// Adds a vertex to a mesh in whose file colors may be given for some vertices only.
inline void add_vertex(PlainMesh& mesh, const Vec3& position, const std::optional<Rgb8>& color) {
  if (color && mesh.colors.empty()) mesh.colors.assign(mesh.positions.size(), kMissingColor);
  mesh.positions.push_back(position);
  if (!mesh.colors.empty() || color) mesh.colors.push_back(color.value_or(kMissingColor));
}

/// Where vertices have colors as well, which go before.
inline void pass_over_face_colors(PlainMesh& mesh) {
  mesh.notes.lose("colors of faces");
  mesh.warnings.push_back({"face-colors", "vertices and faces have colors; those of the vertices are taken"});
}

}  // namespace mesocell
