#pragma once

#include <cstdint>
#include <functional>

#include "sdk/core/triangle_mesh.h"

/// Closed meshes with outward orientation, for tests.
namespace mesocell::test {

[[nodiscard]] TriangleMesh make_box(Vec3 low, Vec3 high);
[[nodiscard]] TriangleMesh make_tetrahedron(Vec3 a, Vec3 b, Vec3 c, Vec3 d);
/// A sphere of `rings` circles of latitude.
[[nodiscard]] TriangleMesh make_sphere(Vec3 centre, double radius, std::uint32_t rings);
/// A torus about the z axis, `around` × `across` quads, each two triangles.
[[nodiscard]] TriangleMesh make_torus(Vec3 centre, double major, double minor, std::uint32_t around,
                                      std::uint32_t across);
/// The second mesh beside the first, as one soup.
void append(TriangleMesh& mesh, const TriangleMesh& other);
void flip(TriangleMesh& mesh);

}  // namespace mesocell::test
