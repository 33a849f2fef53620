#pragma once

#include <cstdint>
#include <vector>

#include "format/api.h"
#include "format/result.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/membership/solid_shape.h"
#include "sdk/tiles/labels.h"

namespace mesocell MESOCELL_API {

/// Heights over a rectangle of the ground, as a picture of the ground seen from above has them: x from the
/// left, z from the top row, y up. Sample (i, j) is at x = (i + ½) · spacing, z = (j + ½) · spacing; between
/// samples heights are bilinear, and beyond the outermost ones, half a spacing wide, they stay.
struct HeightField {
  std::uint32_t width = 0, depth = 0;  ///< samples along x and z
  std::vector<float> samples = {};     ///< width × depth, a row along x after the other; NaN: there is none
  double spacing = 0;                  ///< metres between samples, above 0
  double scale = 1, zero = 0;          ///< the height of a sample s is scale · (s - zero) metres
  double floor = 0;                    ///< metres; the ground is solid from there up to its height

  [[nodiscard]] double height(float sample) const { return scale * (double(sample) - zero); }
};

/// What the samples of a field are; those that are none do not count.
struct HeightRange {
  float low = 0, high = 0;  ///< least and greatest sample, as stored
  std::uint64_t missing = 0;
};
[[nodiscard]] HeightRange height_range(const HeightField& field);

/// The ground as a solid block: a point is inside if its y is at least the floor and below the height there,
/// and the sample nearest to it is there. Missing samples next to it take part with the nearest one's height.
class HeightBlock final : public SolidShape {
 public:
  /// The field is checked by check_height_field() (assert).
  explicit HeightBlock(HeightField field);

  [[nodiscard]] Box3 box() const override;
  [[nodiscard]] bool inside(Vec3 point) const override;
  [[nodiscard]] BoxSide side(const Box3& box) const override;

  [[nodiscard]] const HeightField& field() const { return field_; }
  /// Metres, at a place where the nearest sample is there; NaN elsewhere.
  [[nodiscard]] double height_at(double x, double z) const;

 private:
  /// Of a square of samples: the range of those that are there, and whether there is any, and any missing.
  struct Range {
    float low, high;
    bool any, missing;
  };
  struct Level {
    std::uint32_t width, depth;
    std::vector<Range> ranges;
  };
  [[nodiscard]] Range range(std::uint32_t i0, std::uint32_t i1, std::uint32_t j0, std::uint32_t j1) const;

  HeightField field_;
  std::vector<Level> levels_;  ///< of squares of 2, 4, 8, … samples
};

/// Errors: kInvalidInput (no samples, all missing, infinite ones), kUsage (spacing, scale, zero or floor that
/// are not finite or make heights that are not).
[[nodiscard]] Status check_height_field(const HeightField& field);

/// The block as a closed mesh: a vertex at each sample, two triangles a square of four samples that are all
/// there, walls, and a flat bottom at the floor. It lies half a spacing within the block, and differs from it
/// within a square as two triangles do from a bilinear patch. Errors: kInvalidInput (no square is whole, or
/// one is not above the floor), kLimit (more than 2³¹ vertices).
[[nodiscard]] Result<TriangleMesh> make_height_mesh(const HeightField& field);

struct HeightTileOptions {
  Index3 resolution{64, 32, 64};  ///< voxels; y is up
  double gap = 0;                 ///< columns whose height is below it are empty, 0 to 1
  /// Heights of the tile's bottom and top, 0 the lowest sample, 1 the highest. Above it there must be room,
  /// or the layer meets the next one.
  double low = 0, high = 1.25;
};

/// A layer of cells that tiles: voxels below the height are label 1, so that make_label_tile() makes a cell
/// of each part that hangs together, as bricks do above their mortar by a gap. A voxel column has the mean of
/// the samples in it, or the bilinear height at its centre where they are fewer than one, around the torus;
/// missing samples are the lowest. The field's metres mean nothing here. Errors: kInvalidInput (all samples
/// equal).
[[nodiscard]] Result<LabelVolume> height_labels(const HeightField& field, const HeightTileOptions& options);

}  // namespace mesocell
