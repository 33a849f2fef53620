#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "format/api.h"
#include "format/cell_object.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/core/vec.h"

namespace mesocell MESOCELL_API {

/// A place in a texture: (0, 0) is the upper left corner of the picture, (1, 1) the lower right.
using Uv = std::array<float, 2>;

/// What a texture is beyond its picture, along one axis.
enum class TextureWrap : std::uint8_t { kRepeat, kMirror, kClamp };

/// A picture: rows from the top, sRGB.
struct TextureImage {
  std::uint32_t width = 0, height = 0;  ///< at least 1 each
  std::vector<Rgb8> texels;             ///< width × height
};

/// Scales, then rotates by radians, then moves [KHR_texture_transform].
struct UvTransform {
  std::array<double, 2> offset{0, 0}, scale{1, 1};
  double rotation = 0;
  bool operator==(const UvTransform&) const = default;
};

/// How a material looks into a picture.
struct TextureUse {
  std::uint32_t image = 0;  ///< of SurfacePaint::images
  std::array<TextureWrap, 2> wrap{};
  UvTransform transform;
};

struct PaintMaterial {
  Vec3 base_color{1, 1, 1};  ///< linear light, 0 to 1
  std::optional<TextureUse> texture;
};

/// All that colors a triangle mesh beside the colors of its vertices. Arrays have one entry a triangle, or
/// are empty. Whoever makes it from untrusted data has checked indices, sizes of pictures, and that numbers
/// are finite.
struct SurfacePaint {
  static constexpr std::uint32_t kNoMaterial = 0xffff'ffff;

  std::vector<Rgb8> face_colors;
  std::vector<std::array<Uv, 3>> uvs;           ///< of the three corners
  std::vector<std::uint32_t> material_indices;  ///< of `materials`, or kNoMaterial
  std::vector<PaintMaterial> materials;
  std::vector<TextureImage> images;

  [[nodiscard]] bool empty() const { return face_colors.empty() && material_indices.empty(); }
};

/// The color of a painted mesh at any place of it: the product, in linear light, of vertex colors (mixed by
/// barycentric coordinates), face color, base color and texture, as far as there are such.
///
/// Textures are interpolated between the four texels around, in linear light, but only between those whose
/// centres are on the chart that the triangle belongs to: a chart is of triangles of one material that share
/// an edge with the same texture coordinates at both of its ends (vertices at the same place are the same).
/// So nothing of what lies between charts gets into the colors at their seams, whatever the gap is painted
/// with. Where none of the four is on the chart, the nearest texel within 8 that is counts alone; where there
/// is none either, that under the point. Thread safety: const.
class PaintSampler {
 public:
  /// `mesh` and `paint` must outlive it. `threads`: 0 for the machine's.
  PaintSampler(const TriangleMesh& mesh, const SurfacePaint& paint, unsigned threads = 0);
  ~PaintSampler();
  PaintSampler(const PaintSampler&) = delete;
  PaintSampler& operator=(const PaintSampler&) = delete;

  /// Linear light. `barycentric`: shares of the triangle's corners.
  [[nodiscard]] Vec3 color(std::uint32_t triangle, const std::array<double, 3>& barycentric) const;

 private:
  class Charts;
  [[nodiscard]] Vec3 texture_color(std::uint32_t triangle, const PaintMaterial& material,
                                   const std::array<double, 3>& barycentric) const;

  const TriangleMesh& mesh_;
  const SurfacePaint& paint_;
  std::unique_ptr<const Charts> charts_;  ///< null: no triangle has a texture
};

}  // namespace mesocell
