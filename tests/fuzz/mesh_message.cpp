#include "converters/import/mesh_message.h"

#include "tests/fuzz/fuzz.h"

// Input: what a worker replied.

using namespace mesocell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::Exact exact(fuzz::Input(data, size).rest());
  if (const Result<TextureImage> image = read_image_message(exact.bytes())) {
    MESOCELL_FUZZ_CHECK(image->texels.size() == std::size_t{image->width} * image->height);
    const fuzz::Bytes again = write_image_message(*image);
    MESOCELL_FUZZ_CHECK(std::equal(again.begin(), again.end(), exact.bytes().begin(), exact.bytes().end()));
  }
  const Result<WorkerMesh> mesh = read_mesh_message(exact.bytes());
  if (!mesh) return 0;
  const TriangleMesh& triangles = mesh->painted.mesh;
  const SurfacePaint& paint = mesh->painted.paint;
  for (const Triangle& t : triangles.triangles)
    for (const std::uint32_t v : t) MESOCELL_FUZZ_CHECK(v < triangles.vertices.size());
  const auto fits = [&](std::size_t n) { return n == 0 || n == triangles.triangles.size(); };
  MESOCELL_FUZZ_CHECK(triangles.colors.empty() || triangles.colors.size() == triangles.vertices.size());
  MESOCELL_FUZZ_CHECK(fits(paint.face_colors.size()) && fits(paint.uvs.size()));
  MESOCELL_FUZZ_CHECK(fits(paint.material_indices.size()));
  for (const std::uint32_t index : paint.material_indices)
    MESOCELL_FUZZ_CHECK(index == SurfacePaint::kNoMaterial || index < paint.materials.size());
  for (const PaintMaterial& material : paint.materials)
    MESOCELL_FUZZ_CHECK(!material.texture || material.texture->image < paint.images.size());
  const fuzz::Bytes once = write_mesh_message(*mesh);
  const Result<WorkerMesh> again = read_mesh_message(once);
  MESOCELL_FUZZ_CHECK(again.ok() && write_mesh_message(*again) == once);
  return 0;
}

std::vector<fuzz::Bytes> fuzz::seeds() {
  WorkerMesh mesh;
  const std::vector<std::byte> nothing = write_mesh_message(mesh);
  mesh.warnings = {{"renamed", "it is"}};
  mesh.notes.losses = {"alpha", "normals"};
  mesh.painted.mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}};
  SurfacePaint& paint = mesh.painted.paint;
  paint.face_colors = {{9, 9, 9}};
  paint.uvs = {{Uv{0, 0}, Uv{1, 0}, Uv{0, 1}}};
  paint.material_indices = {0};
  paint.materials = {{{1, 1, 1}, TextureUse{}}};
  paint.images = {{2, 1, {{1, 1, 1}, {2, 2, 2}}}};
  return {nothing, write_mesh_message(mesh), write_image_message(paint.images[0])};
}
