#include "converters/import/mesh_message.h"

#include <algorithm>
#include <cmath>

#include "format/byte_reader.h"
#include "format/byte_writer.h"

namespace mesocell {
namespace {

constexpr std::uint32_t kMagic = 0x4853'4d50;  // "PMSH"

enum Part : std::uint32_t { kVertexColors = 1, kFaceColors = 2, kUvs = 4, kMaterials = 8, kAllParts = 15 };

void write_text(const std::string& text, ByteWriter& out) {
  out.u32(std::uint32_t(text.size()));
  out.append(text);
}

void write_colors(const std::vector<Rgb8>& colors, ByteWriter& out) {
  out.append(std::as_bytes(std::span(colors)));
}

void write_image(const TextureImage& image, ByteWriter& out) {
  out.u32(image.width);
  out.u32(image.height);
  write_colors(image.texels, out);
}

void write_material(const PaintMaterial& material, ByteWriter& out) {
  for (std::size_t k = 0; k < 3; ++k) out.f64(material.base_color[k]);
  out.u8(material.texture ? 1 : 0);
  const TextureUse use = material.texture.value_or(TextureUse{});
  out.u32(use.image);
  for (const TextureWrap wrap : use.wrap) out.u8(std::uint8_t(wrap));
  for (const double x : {use.transform.offset[0], use.transform.offset[1], use.transform.scale[0],
                         use.transform.scale[1], use.transform.rotation})
    out.f64(x);
}

Error damaged() {
  return {ErrorCode::kInvalidInput,
          "the program that read it gave an answer that makes no sense, so the file is damaged; fetch or "
          "export it again"};
}

/// Reads what was written. The first fault makes all that follows zero.
class MessageReader {
 public:
  explicit MessageReader(std::span<const std::byte> bytes) : in_(bytes) {}

  [[nodiscard]] bool failed() const { return failed_ || in_.overrun(); }
  [[nodiscard]] bool done() const { return !failed() && in_.remaining() == 0; }

  std::uint8_t u8() { return in_.u8(); }
  std::uint32_t u32() { return in_.u32(); }
  std::uint64_t u64() { return in_.u64(); }
  /// A count of things of `bytes` each, all of which are there.
  std::size_t count(std::uint64_t n, std::uint64_t bytes) {
    if (failed() || n > in_.remaining() / bytes) {
      failed_ = true;
      return 0;
    }
    return std::size_t(n);
  }
  double number() {
    const double x = in_.f64();
    failed_ = failed_ || !std::isfinite(x);
    return failed() ? 0 : x;
  }
  float single() {
    const float x = in_.f32();
    failed_ = failed_ || !std::isfinite(x);
    return failed() ? 0 : x;
  }
  std::uint32_t below(std::uint64_t limit) {
    const std::uint32_t x = in_.u32();
    failed_ = failed_ || x >= limit;
    return x;
  }
  std::string text() {
    const auto bytes = in_.take(count(in_.u32(), 1));
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  std::vector<Rgb8> colors(std::uint64_t n) {
    std::vector<Rgb8> colors(count(n, 3));
    for (Rgb8& color : colors)
      for (std::uint8_t& channel : color) channel = in_.u8();
    return colors;
  }
  TextureImage image() {
    TextureImage image;
    image.width = in_.u32();
    image.height = in_.u32();
    failed_ = failed_ || image.width == 0 || image.height == 0 || image.width > kMaxTextureSide ||
              image.height > kMaxTextureSide;
    image.texels = colors(std::uint64_t{image.width} * image.height);
    return image;
  }
  PaintMaterial material(std::uint32_t images) {
    PaintMaterial material;
    for (std::size_t k = 0; k < 3; ++k) {
      material.base_color[k] = number();
      failed_ = failed_ || !(material.base_color[k] >= 0 && material.base_color[k] <= 1);
    }
    const bool has_texture = in_.u8() != 0;
    TextureUse use;
    use.image = in_.u32();
    failed_ = failed_ || (has_texture && use.image >= images);
    for (TextureWrap& wrap : use.wrap) {
      const std::uint8_t value = in_.u8();
      failed_ = failed_ || value > std::uint8_t(TextureWrap::kClamp);
      wrap = TextureWrap(value);
    }
    for (double* x : {&use.transform.offset[0], &use.transform.offset[1], &use.transform.scale[0],
                      &use.transform.scale[1], &use.transform.rotation})
      *x = number();
    if (has_texture) material.texture = use;
    return material;
  }

 private:
  ByteReader in_;
  bool failed_ = false;
};

void read_arrays(MessageReader& in, std::uint32_t parts, WorkerMesh& read) {
  TriangleMesh& mesh = read.painted.mesh;
  SurfacePaint& paint = read.painted.paint;
  mesh.vertices.resize(in.count(in.u64(), 24));
  for (Vec3& v : mesh.vertices)
    for (std::size_t a = 0; a < 3; ++a) v[a] = in.number();
  mesh.triangles.resize(in.count(in.u64(), 12));
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = in.below(mesh.vertices.size());
  const std::size_t triangles = mesh.triangles.size();
  if (parts & kVertexColors) mesh.colors = in.colors(mesh.vertices.size());
  if (parts & kFaceColors) paint.face_colors = in.colors(triangles);
  if (parts & kUvs) {
    paint.uvs.resize(in.count(triangles, 24));
    for (std::array<Uv, 3>& corners : paint.uvs)
      for (Uv& uv : corners)
        for (float& x : uv) x = in.single();
  }
  if (parts & kMaterials) {
    paint.material_indices.resize(in.count(triangles, 4));
    for (std::uint32_t& index : paint.material_indices) index = in.u32();
  }
}

}  // namespace

std::vector<std::byte> write_mesh_message(const WorkerMesh& mesh) {
  const auto& [triangles, paint] = mesh.painted;
  ByteWriter out;
  out.reserve(24 * triangles.vertices.size() + 44 * triangles.triangles.size() + 4096);
  out.u32(kMagic);
  out.u64(mesh.polygons);
  out.u64(mesh.dropped_faces);
  out.u32(std::uint32_t(mesh.warnings.size()));
  for (const MeshWarning& warning : mesh.warnings) {
    write_text(warning.id, out);
    write_text(warning.text, out);
  }
  out.u32((triangles.colors.empty() ? 0u : kVertexColors) | (paint.face_colors.empty() ? 0u : kFaceColors) |
          (paint.uvs.empty() ? 0u : kUvs) | (paint.material_indices.empty() ? 0u : kMaterials));
  out.u64(triangles.vertices.size());
  for (const Vec3& v : triangles.vertices)
    for (std::size_t a = 0; a < 3; ++a) out.f64(v[a]);
  out.u64(triangles.triangles.size());
  for (const Triangle& t : triangles.triangles)
    for (const std::uint32_t v : t) out.u32(v);
  write_colors(triangles.colors, out);
  write_colors(paint.face_colors, out);
  for (const std::array<Uv, 3>& corners : paint.uvs)
    for (const Uv& uv : corners)
      for (const float x : uv) out.f32(x);
  for (const std::uint32_t index : paint.material_indices) out.u32(index);
  out.u32(std::uint32_t(paint.images.size()));
  for (const TextureImage& image : paint.images) write_image(image, out);
  out.u32(std::uint32_t(paint.materials.size()));
  for (const PaintMaterial& material : paint.materials) write_material(material, out);
  out.u32(std::uint32_t(mesh.notes.losses.size()));
  for (const std::string& loss : mesh.notes.losses) write_text(loss, out);
  return out.release();
}

std::vector<std::byte> write_image_message(const TextureImage& image) {
  ByteWriter out;
  write_image(image, out);
  return out.release();
}

Result<WorkerMesh> read_mesh_message(std::span<const std::byte> bytes) {
  MessageReader in(bytes);
  WorkerMesh read;
  if (in.u32() != kMagic) return damaged();
  read.polygons = in.u64();
  read.dropped_faces = in.u64();
  read.warnings.resize(in.count(in.u32(), 8));
  for (MeshWarning& warning : read.warnings) {
    warning.id = in.text();
    warning.text = in.text();
  }
  const std::uint32_t parts = in.u32();
  if (parts > kAllParts || in.failed()) return damaged();
  read_arrays(in, parts, read);
  SurfacePaint& paint = read.painted.paint;
  paint.images.resize(in.count(in.u32(), 11));
  for (TextureImage& image : paint.images) image = in.image();
  paint.materials.resize(in.count(in.u32(), 71));
  for (PaintMaterial& material : paint.materials) material = in.material(std::uint32_t(paint.images.size()));
  for (std::size_t n = in.count(in.u32(), 4); n > 0; --n) read.notes.lose(in.text());
  if (!in.done()) return damaged();
  for (const std::uint32_t index : paint.material_indices)
    if (index != SurfacePaint::kNoMaterial && index >= paint.materials.size()) return damaged();
  return read;
}

Result<TextureImage> read_image_message(std::span<const std::byte> bytes) {
  MessageReader in(bytes);
  TextureImage image = in.image();
  if (!in.done()) return damaged();
  return image;
}

}  // namespace mesocell
