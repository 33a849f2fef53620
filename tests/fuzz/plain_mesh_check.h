#pragma once

#include <cmath>
#include <string>
#include <string_view>

#include "converters/import/plain_mesh.h"
#include "tests/fuzz/fuzz.h"

/// What the parsers of mesh files promise of any bytes.
namespace mesocell::fuzz {

inline void check_plain_mesh(std::span<const std::byte> bytes,
                             Result<PlainMesh> (*parse)(std::string_view, const Progress*)) {
  const Exact exact(bytes);
  const std::string_view text(reinterpret_cast<const char*>(exact.bytes().data()), exact.bytes().size());
  const Result<PlainMesh> mesh = parse(text, nullptr);
  if (!mesh) {
    MESOCELL_FUZZ_CHECK(mesh.error().code == ErrorCode::kInvalidInput);
    MESOCELL_FUZZ_CHECK(!mesh.error().message.empty());
    return;
  }
  const auto fits = [&](std::size_t size) { return size == 0 || size == mesh->triangles; };
  MESOCELL_FUZZ_CHECK(mesh->colors.empty() || mesh->colors.size() == mesh->positions.size());
  MESOCELL_FUZZ_CHECK(mesh->polygons <= bytes.size());
  const SurfacePaint& paint = mesh->paint;
  MESOCELL_FUZZ_CHECK(fits(paint.face_colors.size()) && fits(paint.uvs.size()));
  MESOCELL_FUZZ_CHECK(fits(paint.material_indices.size()));
  for (const std::uint32_t index : paint.material_indices)
    MESOCELL_FUZZ_CHECK(index == SurfacePaint::kNoMaterial || index < mesh->materials.size());
  for (const auto& corners : paint.uvs)
    for (const Uv& uv : corners) MESOCELL_FUZZ_CHECK(std::isfinite(uv[0]) && std::isfinite(uv[1]));
  // A small multiple of the file, whatever it says.
  MESOCELL_FUZZ_CHECK(mesh->bytes.size() <= 40 * bytes.size() + 1000);
}

[[nodiscard]] inline Bytes to_bytes(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

}  // namespace mesocell::fuzz
