#pragma once

#include <cstdint>

#include "format/api.h"
#include "sdk/core/triangle_mesh.h"

/// Meshes of simple shapes: closed, without self-intersections, outward; the same on every machine.
namespace mesocell MESOCELL_API {

/// A tube along a trefoil knot, about 6 across, `around` × `across` quads of two triangles.
[[nodiscard]] TriangleMesh make_knot(std::uint32_t around, std::uint32_t across);

/// A torus about a tilted axis, so that nothing is aligned with the grid.
[[nodiscard]] TriangleMesh make_torus(double major, double minor, std::uint32_t around, std::uint32_t across);

/// A cube's faces of `cells`² quads, blown up to a sphere about the origin, tilted, with bumps of `height`
/// times the radius; 0 is a sphere.
[[nodiscard]] TriangleMesh make_sphere(double radius, double height, std::uint32_t cells);

/// A box of twelve triangles.
[[nodiscard]] TriangleMesh make_box(Vec3 low, Vec3 high);

/// A cylinder about the y axis from y = 0 up, or a cone if its upper radius is 0; `around` sides.
[[nodiscard]] TriangleMesh make_cylinder(double lower_radius, double upper_radius, double height,
                                         std::uint32_t around);

/// The second mesh beside the first.
void append(TriangleMesh& mesh, const TriangleMesh& other);
/// Turns a mesh inside out.
void turn(TriangleMesh& mesh);
/// Moves all vertices.
void translate(TriangleMesh& mesh, Vec3 by);
/// Turns about two axes by angles with rational sines, so that no face is aligned with the grid.
void tilt(TriangleMesh& mesh);

}  // namespace mesocell
