#include "converters/export/basic_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "converters/export/draco_encoder.h"
#include "converters/import/gltf_file.h"

namespace mesocell {
namespace {

/// No less than `x`.
float round_up(double x) {
  const auto f = float(x);
  return double(f) >= x ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
}

}  // namespace

Result<BasicMesh> compress_basic_mesh(const TriangleMesh& mesh, int position_bits) {
  if (position_bits < 8 || position_bits > 24)
    return Error{ErrorCode::kUsage, "positions of a basic mesh have 8 to 24 bits"};
  // Vertices that no triangle uses would widen the box.
  std::vector<std::uint32_t> number(mesh.vertices.size(), 0xffffffff), used;
  std::vector<Triangle> triangles;
  for (const Triangle& t : mesh.triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    Triangle& out = triangles.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint32_t& n = number[t[c]];
      if (n == 0xffffffff) {
        n = std::uint32_t(used.size());
        used.push_back(t[c]);
      }
      out[c] = n;
    }
  }
  if (triangles.empty()) return Error{ErrorCode::kInvalidInput, "the basic mesh has no triangles"};
  std::array<float, 3> low{}, high{};
  double largest = 0;
  for (std::size_t k = 0; k < used.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = mesh.vertices[used[k]][a];
      largest = std::max(largest, std::abs(x));
      low[a] = k == 0 ? float(x) : std::min(low[a], float(x));
      high[a] = k == 0 ? float(x) : std::max(high[a], float(x));
    }
  if (!(largest < 1e37))
    return Error{ErrorCode::kInvalidInput, "the basic mesh has a coordinate beyond single precision"};
  DracoInput in;
  in.vertex_count = std::uint32_t(used.size());
  in.triangle_count = triangles.size();
  in.position = [&](std::uint32_t v) {
    const Vec3& p = mesh.vertices[used[v]];
    return std::array<float, 3>{float(p.x), float(p.y), float(p.z)};
  };
  in.triangle = [&](std::uint64_t k) { return triangles[std::size_t(k)]; };
  std::vector<std::array<std::uint16_t, 4>> colors;
  if (!mesh.colors.empty())
    for (const std::uint32_t v : used) {
      const Rgb8& c = mesh.colors[v];
      colors.push_back(
          {std::uint16_t(c[0] * 257), std::uint16_t(c[1] * 257), std::uint16_t(c[2] * 257), 65535});
    }
  in.colors = colors;
  in.position_bits = position_bits;
  in.origin = low;
  // A little more than the extent, for what differences round to.
  double extent = 0;
  for (std::size_t a = 0; a < 3; ++a) extent = std::max(extent, double(high[a]) - double(low[a]));
  in.range = round_up(std::max(extent * (1 + 0x1p-20), 1e-30));
  const Result<DracoMesh> made = encode_draco(in);
  if (!made) return made.error();
  if (made->triangles == 0 || made->vertices < 3)
    return Error{ErrorCode::kInvalidInput, "the basic mesh has no triangles"};
  BasicMesh out;
  out.draco = made->bytes;
  out.vertices = std::uint32_t(made->vertices);
  out.triangles = std::uint32_t(made->triangles);
  // Along an axis, half a step; what rounding a coordinate to single precision adds, before and after; and
  // what it adds to Draco's differences and products, which are no greater than the range.
  const double step = double(in.range) / (std::ldexp(1.0, position_bits) - 1);
  Vec3 moves;
  for (std::size_t a = 0; a < 3; ++a)
    moves[a] =
        0.5 * step + 0x1p-23 * std::max(std::abs(low[a]), std::abs(high[a])) + 0x1p-21 * double(in.range);
  out.max_error = round_up(length(moves));
  return out;
}

Result<TriangleMesh> read_basic_mesh(const BasicMesh& mesh, const Progress* progress) {
  Result<WorkerMesh> read = read_draco(mesh.draco, progress);
  if (!read) return read.error();
  TriangleMesh& out = read->painted.mesh;
  if (out.vertices.size() != mesh.vertices || out.triangles.size() + read->dropped_faces != mesh.triangles)
    return Error{
        ErrorCode::kInvalidInput,
        "the basic mesh in the file has other numbers of vertices and triangles than stated; convert "
        "again from the mesh itself"};
  return std::move(out);
}

}  // namespace mesocell
