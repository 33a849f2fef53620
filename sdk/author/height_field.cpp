#include "sdk/author/height_field.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace mesocell {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Where a coordinate, in samples, lies between two of them.
struct Between {
  std::uint32_t low, high;
  double share;  ///< of the higher one
  std::uint32_t nearest;
};

Between between(double at, std::uint32_t count) {
  const double last = double(count) - 1, c = std::clamp(at, 0.0, last);
  const auto low = std::uint32_t(std::min(std::floor(c), std::max(last - 1, 0.0)));
  const double share = c - double(low);
  const std::uint32_t high = std::min(low + 1, count - 1);
  return {low, high, share, share < 0.5 ? low : high};
}

}  // namespace

HeightRange height_range(const HeightField& field) {
  HeightRange range{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(), 0};
  for (const float s : field.samples) {
    if (std::isnan(s)) {
      ++range.missing;
      continue;
    }
    range.low = std::min(range.low, s);
    range.high = std::max(range.high, s);
  }
  return range;
}

Status check_height_field(const HeightField& field) {
  const auto invalid = [](const char* text) { return Error{ErrorCode::kInvalidInput, text}; };
  if (field.width == 0 || field.depth == 0 ||
      field.samples.size() != std::uint64_t{field.width} * field.depth)
    return invalid("there are no heights in it");
  if (!(field.spacing > 0 && std::isfinite(field.spacing * std::max(field.width, field.depth))))
    return Error{ErrorCode::kUsage, "the distance between heights is not a number of metres above 0"};
  const HeightRange range = height_range(field);
  if (range.missing == field.samples.size())
    return invalid("all its heights are missing (not a number, or the no-data value)");
  if (!std::isfinite(range.low) || !std::isfinite(range.high))
    return invalid("a height in it is infinite; repair the file, or name that value as no data");
  if (!std::isfinite(field.scale) || !std::isfinite(field.zero) || !std::isfinite(field.floor))
    return Error{ErrorCode::kUsage, "scale, zero and floor of the heights must be finite"};
  if (!std::isfinite(field.height(range.low)) || !std::isfinite(field.height(range.high)))
    return Error{ErrorCode::kUsage, "its heights are beyond double precision; use a smaller scale"};
  return {};
}

HeightBlock::HeightBlock(HeightField field) : field_(std::move(field)) {
  assert(check_height_field(field_));
  const auto join = [](Range& to, const Range& r) {
    to.missing = to.missing || r.missing;
    if (!r.any) return;
    to.low = to.any ? std::min(to.low, r.low) : r.low;
    to.high = to.any ? std::max(to.high, r.high) : r.high;
    to.any = true;
  };
  const auto halve = [](std::uint32_t n) { return (n + 1) / 2; };
  Level level{halve(field_.width), halve(field_.depth), {}};
  level.ranges.assign(std::size_t{level.width} * level.depth, {0, 0, false, false});
  for (std::uint32_t j = 0; j < field_.depth; ++j)
    for (std::uint32_t i = 0; i < field_.width; ++i) {
      const float s = field_.samples[i + std::size_t{field_.width} * j];
      join(level.ranges[i / 2 + std::size_t{level.width} * (j / 2)],
           std::isnan(s) ? Range{0, 0, false, true} : Range{s, s, true, false});
    }
  levels_.push_back(std::move(level));
  while (levels_.back().width > 1 || levels_.back().depth > 1) {
    const Level& fine = levels_.back();
    Level coarse{halve(fine.width), halve(fine.depth), {}};
    coarse.ranges.assign(std::size_t{coarse.width} * coarse.depth, {0, 0, false, false});
    for (std::uint32_t j = 0; j < fine.depth; ++j)
      for (std::uint32_t i = 0; i < fine.width; ++i)
        join(coarse.ranges[i / 2 + std::size_t{coarse.width} * (j / 2)],
             fine.ranges[i + std::size_t{fine.width} * j]);
    levels_.push_back(std::move(coarse));
  }
}

HeightBlock::Range HeightBlock::range(std::uint32_t i0, std::uint32_t i1, std::uint32_t j0,
                                      std::uint32_t j1) const {
  // The finest level on which they are three squares wide at most.
  std::size_t k = 0;
  while (k + 1 < levels_.size() && std::max(i1 - i0, j1 - j0) >> (k + 1) > 1) ++k;
  const Level& level = levels_[k];
  Range found{0, 0, false, false};
  for (std::uint32_t j = j0 >> (k + 1); j <= j1 >> (k + 1); ++j)
    for (std::uint32_t i = i0 >> (k + 1); i <= i1 >> (k + 1); ++i) {
      const Range& r = level.ranges[i + std::size_t{level.width} * j];
      found.missing = found.missing || r.missing;
      if (!r.any) continue;
      found.low = found.any ? std::min(found.low, r.low) : r.low;
      found.high = found.any ? std::max(found.high, r.high) : r.high;
      found.any = true;
    }
  return found;
}

Box3 HeightBlock::box() const {
  const Range& all = levels_.back().ranges[0];
  const double top = std::max(field_.height(all.low), field_.height(all.high));
  Box3 box;
  if (!(top > field_.floor)) return box;
  box.add({0, field_.floor, 0});
  box.add({field_.width * field_.spacing, top, field_.depth * field_.spacing});
  return box;
}

double HeightBlock::height_at(double x, double z) const {
  const Between i = between(x / field_.spacing - 0.5, field_.width);
  const Between j = between(z / field_.spacing - 0.5, field_.depth);
  const auto sample = [&](std::uint32_t a, std::uint32_t b) {
    return field_.samples[a + std::size_t{field_.width} * b];
  };
  const float nearest = sample(i.nearest, j.nearest);
  if (std::isnan(nearest)) return kNone;
  const auto height = [&](std::uint32_t a, std::uint32_t b) {
    const float s = sample(a, b);
    return field_.height(std::isnan(s) ? nearest : s);
  };
  const double near = height(i.low, j.low) * (1 - i.share) + height(i.high, j.low) * i.share;
  const double far = height(i.low, j.high) * (1 - i.share) + height(i.high, j.high) * i.share;
  return near * (1 - j.share) + far * j.share;
}

bool HeightBlock::inside(Vec3 point) const {
  if (!(point.x >= 0 && point.x < field_.width * field_.spacing && point.z >= 0 &&
        point.z < field_.depth * field_.spacing && point.y >= field_.floor))
    return false;
  return point.y < height_at(point.x, point.z);  // false for NaN
}

BoxSide HeightBlock::side(const Box3& box) const {
  const double width = field_.width * field_.spacing, depth = field_.depth * field_.spacing;
  if (box.max.y < field_.floor || box.max.x < 0 || box.max.z < 0 || box.min.x >= width || box.min.z >= depth)
    return BoxSide::kOutside;
  // The samples that heights in the box are made of; one more, as a quotient may round to the next.
  const auto first = [&](double at, std::uint32_t count) {
    return std::uint32_t(std::clamp(std::floor(at / field_.spacing - 0.5) - 1, 0.0, double(count) - 1));
  };
  const auto last = [&](double at, std::uint32_t count) {
    return std::uint32_t(std::clamp(std::floor(at / field_.spacing - 0.5) + 2, 0.0, double(count) - 1));
  };
  const Range r = range(first(box.min.x, field_.width), last(box.max.x, field_.width),
                        first(box.min.z, field_.depth), last(box.max.z, field_.depth));
  if (!r.any) return BoxSide::kOutside;
  const double a = field_.height(r.low), b = field_.height(r.high);
  // Mixing heights rounds.
  const double slack = 1e-12 * (std::abs(a) + std::abs(b));
  if (box.min.y >= std::max(a, b) + slack) return BoxSide::kOutside;
  if (!r.missing && box.min.y >= field_.floor && box.max.y < std::min(a, b) - slack && box.min.x >= 0 &&
      box.min.z >= 0 && box.max.x < width && box.max.z < depth)
    return BoxSide::kInside;
  return BoxSide::kMixed;
}

Result<TriangleMesh> make_height_mesh(const HeightField& field) {
  if (Status status = check_height_field(field); !status) return status.error();
  const std::uint64_t count = std::uint64_t{field.width} * field.depth;
  if (count > 0x4000'0000)
    return Error{ErrorCode::kLimit,
                 "a mesh of so many heights has more vertices than can be counted; use the "
                 "solid block, or fewer heights"};
  const auto whole = [&](std::int64_t i, std::int64_t j) {
    if (i < 0 || j < 0 || i + 1 >= field.width || j + 1 >= field.depth) return false;
    for (const std::int64_t k :
         {std::int64_t{0}, std::int64_t{1}, std::int64_t{field.width}, std::int64_t{field.width} + 1})
      if (std::isnan(field.samples[std::size_t(i + field.width * j + k)])) return false;
    return true;
  };
  TriangleMesh mesh;
  // Numbers of the vertices on top, from 1; the one below is the next.
  std::vector<std::uint32_t> number(count, 0);
  bool sunk = false;
  const auto vertex = [&](std::int64_t i, std::int64_t j, bool top) {
    const auto at = std::size_t(i + field.width * j);
    if (number[at] == 0) {
      number[at] = std::uint32_t(mesh.vertices.size()) + 1;
      const double x = (double(i) + 0.5) * field.spacing, z = (double(j) + 0.5) * field.spacing;
      const double y = field.height(field.samples[at]);
      sunk = sunk || !(y > field.floor);
      mesh.vertices.push_back({x, y, z});
      mesh.vertices.push_back({x, field.floor, z});
    }
    return number[at] - (top ? 1 : 0);
  };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (std::int64_t j = 0; j + 1 < field.depth; ++j)
    for (std::int64_t i = 0; i + 1 < field.width; ++i) {
      if (!whole(i, j)) continue;
      // Seen from above, z comes towards the viewer, so counter-clockwise is down, right, up.
      const std::array<std::array<std::int64_t, 2>, 4> corner = {
          {{i, j}, {i, j + 1}, {i + 1, j + 1}, {i + 1, j}}};
      std::array<std::uint32_t, 4> top{}, bottom{};
      for (std::size_t k = 0; k < 4; ++k) {
        top[k] = vertex(corner[k][0], corner[k][1], true);
        bottom[k] = vertex(corner[k][0], corner[k][1], false);
      }
      quad(top[0], top[1], top[2], top[3]);
      quad(bottom[3], bottom[2], bottom[1], bottom[0]);
      const std::array<bool, 4> open = {!whole(i - 1, j), !whole(i, j + 1), !whole(i + 1, j),
                                        !whole(i, j - 1)};
      for (std::size_t k = 0; k < 4; ++k)
        if (open[k]) quad(top[k], bottom[k], bottom[(k + 1) % 4], top[(k + 1) % 4]);
    }
  if (mesh.triangles.empty())
    return Error{ErrorCode::kInvalidInput,
                 "no four neighbouring heights are there to make a surface of; use the solid block"};
  if (sunk) return Error{ErrorCode::kInvalidInput, "a height is not above the floor; give a lower floor"};
  return mesh;
}

Result<LabelVolume> height_labels(const HeightField& field, const HeightTileOptions& options) {
  if (Status status = check_height_field(field); !status) return status.error();
  const HeightRange range = height_range(field);
  if (!(range.high > range.low))
    return Error{ErrorCode::kInvalidInput, "all its heights are equal, so there is no layer to make of them"};
  const Index3& n = options.resolution;
  // From 0 for the lowest to 1 for the highest, whichever way the scale turns them.
  const auto share = [&](float s) {
    if (std::isnan(s)) return 0.0;
    const double v = (double(s) - range.low) / (double(range.high) - range.low);
    return field.scale < 0 ? 1 - v : v;
  };
  const auto sample = [&](std::int64_t i, std::int64_t j) {
    const std::int64_t w = field.width, d = field.depth;
    return share(field.samples[std::size_t((i % w + w) % w + w * ((j % d + d) % d))]);
  };
  const auto bilinear = [&](double x, double z) {
    const double fx = std::floor(x), fz = std::floor(z);
    const auto i = std::int64_t(fx), j = std::int64_t(fz);
    const double near = sample(i, j) * (1 - (x - fx)) + sample(i + 1, j) * (x - fx);
    const double far = sample(i, j + 1) * (1 - (x - fx)) + sample(i + 1, j + 1) * (x - fx);
    return near * (1 - (z - fz)) + far * (z - fz);
  };
  LabelVolume volume;
  volume.resolution = n;
  volume.labels.assign(volume.voxel_count(), 0);
  for (std::uint32_t z = 0; z < n[2]; ++z)
    for (std::uint32_t x = 0; x < n[0]; ++x) {
      const std::uint64_t i0 = std::uint64_t{x} * field.width / n[0],
                          i1 = (x + std::uint64_t{1}) * field.width / n[0];
      const std::uint64_t j0 = std::uint64_t{z} * field.depth / n[2],
                          j1 = (z + std::uint64_t{1}) * field.depth / n[2];
      double height = 0;
      if (i1 > i0 && j1 > j0) {
        for (std::uint64_t j = j0; j < j1; ++j)
          for (std::uint64_t i = i0; i < i1; ++i) height += sample(std::int64_t(i), std::int64_t(j));
        height /= double((i1 - i0) * (j1 - j0));
      } else {
        height = bilinear((x + 0.5) / n[0] * field.width - 0.5, (z + 0.5) / n[2] * field.depth - 0.5);
      }
      if (height < options.gap) continue;
      const double level = (height - options.low) / (options.high - options.low) * n[1];
      for (std::uint32_t y = 0; y < n[1] && y + 0.5 < level; ++y)
        volume.labels[x + std::size_t{n[0]} * (y + std::size_t{n[1]} * z)] = 1;
    }
  return volume;
}

}  // namespace mesocell
