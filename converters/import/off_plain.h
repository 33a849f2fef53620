#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "converters/import/plain_mesh.h"

/// What the two encodings of OFF share.
namespace mesocell {

/// What follows the positions of the vertices.
struct OffKind {
  bool uvs = false, colors = false, normals = false;
};

/// Refuses counts that the rest of a file cannot hold. `vertex_bytes`, `face_bytes`: the fewest of each.
[[nodiscard]] std::optional<Error> check_off_counts(std::uint64_t vertices, std::uint64_t faces,
                                                    std::uint64_t bytes, std::uint64_t vertex_bytes,
                                                    std::uint64_t face_bytes);

/// Reads what comes after "OFF BINARY" and its line's end [Geomview, OFF]: big-endian, colors of 4 floats.
/// Untrusted input: safe. Errors: kInvalidInput, kCancelled.
[[nodiscard]] Result<PlainMesh> plain_off_binary(std::string_view body, OffKind kind,
                                                 const Progress* progress);

/// Puts vertices and faces in plain form together.
void finish_off(PlainMesh& mesh, const std::string& faces);

/// Colors of faces, one a triangle; none if vertices have some, which are finer.
void keep_face_colors(PlainMesh& mesh, std::vector<Rgb8> colors);

}  // namespace mesocell
