#include "converters/export/height_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "converters/image/extension.h"
#include "converters/image/page_writer.h"
#include "format/file.h"
#include "sdk/core/number_text.h"
#include "sdk/core/parallel.h"
#include "sdk/trace/cell_object_caster.h"

namespace mesocell {
namespace {

/// Which way a picture lies: the axis of its columns and that of its rows, and whether they rise.
struct Sheet {
  std::size_t across, down;
  bool across_rises, down_rises;
};

Sheet sheet_of(int axis, bool from_low) {
  switch (axis) {
    case 0:
      return {2, 1, from_low, false};
    case 1:
      return {0, 2, true, !from_low};
    default:
      return {0, 1, !from_low, false};
  }
}

}  // namespace

Status write_height_map(const CellObject& object, const std::string& path, const HeightMapOptions& options,
                        HeightMapReport* report, const Progress* progress) {
  const bool integers = lower_extension(path) == ".png";
  if (Status status = check_page_path(path, integers ? PageSampleType::kUint16 : PageSampleType::kFloat, 1);
      !status)
    return status;
  const auto axis = std::size_t(options.axis);
  const Sheet sheet = sheet_of(options.axis, options.from_low);
  const auto voxels = [&](std::size_t a) { return object.grid.tiles[a] * object.tile.resolution[a]; };
  const std::uint32_t width = options.size ? (*options.size)[0] : voxels(sheet.across);
  const std::uint32_t height = options.size ? (*options.size)[1] : voxels(sheet.down);
  if (std::uint64_t{width} * height > options.max_pixels)
    return Error{ErrorCode::kLimit, "a pixel a voxel makes " + std::to_string(width) + " x " +
                                        std::to_string(height) + " pixels, more than " +
                                        std::to_string(options.max_pixels) + "; give a smaller size"};
  Result<std::unique_ptr<Caster>> caster = make_cell_object_caster(object, "exact");
  if (!caster) return caster.error();
  const Vec3 low = to_vec3(object.grid.box_min), high = to_vec3(object.box_max());
  const double extent = high[axis] - low[axis];
  std::vector<float> heights(std::size_t{width} * height);
  const auto at = [&](std::size_t a, bool rises, std::uint32_t k, std::uint32_t count) {
    const double share = (double(rises ? k : count - 1 - k) + 0.5) / count;
    return low[a] + share * (high[a] - low[a]);
  };
  const bool done = parallel_for(
      height, options.threads,
      [&](std::size_t row, unsigned) {
        std::vector<Ray> rays(width);
        std::vector<StreamHit> hits(width);
        for (std::uint32_t x = 0; x < width; ++x) {
          Vec3 o, d;
          o[sheet.across] = at(sheet.across, sheet.across_rises, x, width);
          o[sheet.down] = at(sheet.down, sheet.down_rises, std::uint32_t(row), height);
          // Half a box away, so that no ray begins inside.
          o[axis] = options.from_low ? low[axis] - extent / 2 : high[axis] + extent / 2;
          d[axis] = options.from_low ? 1 : -1;
          rays[x] = {o, d};
        }
        (*caster)->first_hits(rays, hits);
        for (std::uint32_t x = 0; x < width; ++x)
          heights[row * width + x] =
              hits[x].hit() ? float(1.5 * extent - hits[x].t) : std::numeric_limits<float>::quiet_NaN();
      },
      progress, "heights");
  if (!done) return Error{ErrorCode::kCancelled, "interrupted"};

  HeightMapReport unused;
  HeightMapReport& out = report ? *report : unused;
  out = {};
  out.width = width;
  out.height = height;
  out.spacing = (high[sheet.across] - low[sheet.across]) / width;
  for (const float h : heights) out.missing += std::isnan(h);
  const std::string spacing = "spacing=" + number_text(out.spacing);
  PageStack stack{.width = width, .height = height, .pages = 1, .channels = {"Y"}};
  std::vector<std::uint16_t> levels;
  if (integers) {
    for (const float h : heights)
      levels.push_back(
          std::uint16_t(std::isnan(h) ? 0 : 1 + std::lround(65534 * std::clamp(h / extent, 0.0, 1.0))));
    stack.type = PageSampleType::kUint16;
    stack.samples = std::as_bytes(std::span(levels));
    out.heights =
        "floor=0,nodata=0,scale=" + number_text(extent / 65534) + "," + spacing + ",values=stored,zero=1";
    out.losses.push_back("heights were rounded to " + number_text(extent / 65534) + " m");
  } else {
    stack.type = PageSampleType::kFloat;
    stack.samples = std::as_bytes(std::span(heights));
    out.heights = "floor=0,scale=1," + spacing + ",zero=0";
  }
  out.losses.emplace_back("what lies behind the first surface");
  const Result<std::vector<std::byte>> bytes = encode_pages(path, stack);
  if (!bytes) return bytes.error();
  out.bytes = bytes->size();
  return write_file(path, *bytes, options.no_clobber);
}

}  // namespace mesocell
