#include "converters/vdb/volume_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "sdk/core/number_text.h"
#include "sdk/core/srgb.h"

namespace mesocell {
namespace {

/// How far a position in samples may be off, by rounding, relative to its parts.
constexpr double kSlack = 1e-12;

/// By how much an interpolated value may leave the range of those it lies between, relative to them.
double value_slack(const VolumeLookup::Range& range) {
  return 1e-12 * std::max(std::abs(range.low), std::abs(range.high));
}

Error nothing_inside(const std::string& why) {
  return {ErrorCode::kInvalidInput, "nothing is inside of the volume: " + why};
}

/// Whether there are so few samples from `low` to `high` that each can be asked for.
bool few(const VoxelCoord& low, const VoxelCoord& high) {
  bool few = true;
  for (std::size_t a = 0; a < 3; ++a) few = few && high[a] - low[a] < 4;
  return few;
}

/// The greatest value of all samples.
double greatest(const SparseVolume& volume) {
  double most = volume.background[0];
  for (const VolumeTile& tile : volume.tiles) most = std::max(most, tile.value[0]);
  for (const float v : volume.floats) most = std::max(most, double(v));
  return most;
}

/// The box, in samples, around the image of a box in metres, and a little more than rounding may do.
Box3 image(const Transform& world_to_index, const Box3& box) {
  const Vec3 centre = (box.min + box.max) * 0.5, half = (box.max - box.min) * 0.5;
  const Vec3 c = world_to_index.point(centre);
  Vec3 reach;
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3& row = world_to_index.rows[a];
    double size = std::abs(world_to_index.move[a]);
    for (std::size_t b = 0; b < 3; ++b) {
      reach[a] += std::abs(row[b]) * half[b];
      size += std::abs(row[b]) * (std::abs(centre[b]) + half[b]);
    }
    reach[a] += kSlack * size;
  }
  Box3 result;
  result.add(c - reach);
  result.add(c + reach);
  return result;
}

}  // namespace

VolumeShape::VolumeShape(SparseVolume volume, const Transform& world_to_index)
    : volume_(std::move(volume)), lookup_(volume_), world_to_index_(world_to_index) {}

Result<std::unique_ptr<VolumeShape>> VolumeShape::make(SparseVolume volume, std::optional<double> iso) {
  if (volume.type == VolumeType::kFloat3 || volume.type == VolumeType::kInt3)
    return Error{ErrorCode::kInvalidInput,
                 "the grid has three numbers a voxel, which are no shape; choose another one by --grid"};
  const std::optional<Transform> inverse = volume.index_to_world.inverse();
  if (!inverse) return Error{ErrorCode::kInvalidInput, "the volume's transform cannot be undone"};
  std::unique_ptr<VolumeShape> shape(new VolumeShape(std::move(volume), *inverse));
  const SparseVolume& v = shape->volume_;
  const double background = v.background[0];
  if (v.type != VolumeType::kFloat) {
    if (iso)
      return Error{ErrorCode::kUsage,
                   "the grid holds no numbers between which a value could lie; leave it out"};
  } else if (v.volume_class == VolumeClass::kLevelSet) {
    shape->iso_ = iso.value_or(0);
    if (background < *shape->iso_)
      return Error{ErrorCode::kInvalidInput,
                   "all of space would be inside, as the level set's background is " +
                       number_text(background) + "; use a lower --iso"};
  } else {
    const double most = greatest(v);
    shape->iso_ = iso.value_or(most / 2);
    if (most < *shape->iso_ || (!iso && most <= 0))
      return nothing_inside("its greatest value is " + number_text(most) +
                            "; give the value of the surface by --iso");
    if (background >= *shape->iso_)
      return Error{ErrorCode::kInvalidInput, "all of space would be inside, as the volume's background is " +
                                                 number_text(background) + "; use a greater --iso"};
  }
  if (v.type != VolumeType::kFloat && background != 0)
    return Error{ErrorCode::kInvalidInput,
                 "all of space would be inside, as the grid's background is; choose another one by --grid"};
  shape->find_box();
  if (shape->box_.empty())
    return nothing_inside("it has no voxel that is; give the value of the surface by --iso, or another grid");
  if (!is_finite(shape->box_.min) || !is_finite(shape->box_.max))
    return Error{ErrorCode::kInvalidInput,
                 "the volume's transform makes it infinite; export it with another one"};
  return shape;
}

bool VolumeShape::solid(double value) const {
  if (!iso_) return value != 0;
  return volume_.volume_class == VolumeClass::kLevelSet ? value < *iso_ : value >= *iso_;
}

bool VolumeShape::inside(Vec3 point) const {
  const Vec3 at = world_to_index_.point(point);
  return solid(interpolates() ? lookup_.interpolate(at) : lookup_.nearest(at));
}

BoxSide VolumeShape::side(const Box3& box) const {
  const Box3 samples = image(world_to_index_, box);
  VoxelCoord low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    constexpr double kReach = SparseVolume::kReach;
    // The samples that are interpolated between, or the nearest ones. Beyond the reach there is the
    // background, and what is asked for there is held to it.
    const double first = interpolates() ? std::floor(samples.min[a]) : std::floor(samples.min[a] + 0.5);
    const double last = interpolates() ? std::floor(samples.max[a]) + 1 : std::floor(samples.max[a] + 0.5);
    if (!(first <= last)) return BoxSide::kMixed;
    low[a] = std::int32_t(std::clamp(first, -kReach, kReach - 2));
    high[a] = std::int32_t(std::clamp(last, -kReach, kReach - 1));
  }
  if (!interpolates()) {
    const VolumeLookup::Range found = lookup_.range(low, high, {0, 0});
    if (found.low <= 0 && found.high >= 0 && few(low, high)) return side_of_samples(low, high);
    if (found.low == 0 && found.high == 0) return BoxSide::kOutside;
    return found.low > 0 || found.high < 0 ? BoxSide::kInside : BoxSide::kMixed;
  }
  const std::optional<VolumeLookup::Range> fine = lookup_.fine_range(samples, {*iso_, *iso_});
  const VolumeLookup::Range found = fine ? *fine : lookup_.range(low, high, {*iso_, *iso_});
  const double slack = value_slack(found);
  const bool below = found.high + slack < *iso_, above = found.low - slack >= *iso_;
  if (!below && !above) return BoxSide::kMixed;
  return below == (volume_.volume_class == VolumeClass::kLevelSet) ? BoxSide::kInside : BoxSide::kOutside;
}

BoxSide VolumeShape::side_of_samples(const VoxelCoord& low, const VoxelCoord& high) const {
  bool in = false, out = false;
  VoxelCoord at;
  for (at[2] = low[2]; at[2] <= high[2]; ++at[2])
    for (at[1] = low[1]; at[1] <= high[1]; ++at[1])
      for (at[0] = low[0]; at[0] <= high[0]; ++at[0]) {
        (solid(lookup_.value(at)) ? in : out) = true;
        if (in && out) return BoxSide::kMixed;
      }
  return in ? BoxSide::kInside : BoxSide::kOutside;
}

void VolumeShape::find_box() {
  // Inside is only what lies less than a sample's distance from one that is solid; of a nearest sample half
  // of that.
  const double margin = interpolates() ? 1 : 0.5;
  const auto add = [&](const VoxelCoord& low, const VoxelCoord& high) {
    Box3 samples;
    for (const int corner : {0, 1}) {
      const VoxelCoord& c = corner ? high : low;
      const double m = corner ? margin : -margin;
      samples.add({c[0] + m, c[1] + m, c[2] + m});
    }
    const Box3 world = image(volume_.index_to_world, samples);
    box_.add(world.min);
    box_.add(world.max);
  };
  for (const VolumeTile& tile : volume_.tiles) {
    const std::int32_t reach = (1 << tile.log2_edge) - 1;
    if (solid(tile.value[0]))
      add(tile.origin, {tile.origin[0] + reach, tile.origin[1] + reach, tile.origin[2] + reach});
  }
  for (std::size_t i = 0; i < volume_.leaves.size(); ++i) {
    const VolumeLookup::Range& range = lookup_.leaf_range(i);
    if (iso_ && !solid(range.low) && !solid(range.high)) continue;
    const VoxelCoord& origin = volume_.leaves[i].origin;
    VoxelCoord low{8, 8, 8}, high{-1, -1, -1};
    for (std::int32_t z = 0; z < 8; ++z)
      for (std::int32_t y = 0; y < 8; ++y)
        for (std::int32_t x = 0; x < 8; ++x) {
          if (!solid(lookup_.value({origin[0] + x, origin[1] + y, origin[2] + z}))) continue;
          low = {std::min(low[0], x), std::min(low[1], y), std::min(low[2], z)};
          high = {std::max(high[0], x), std::max(high[1], y), std::max(high[2], z)};
        }
    if (high[0] < 0) continue;
    for (std::size_t a = 0; a < 3; ++a) low[a] += origin[a], high[a] += origin[a];
    add(low, high);
  }
}

VolumeColors::VolumeColors(SparseVolume volume, const Transform& world_to_index)
    : volume_(std::move(volume)), lookup_(volume_), world_to_index_(world_to_index) {}

Result<std::shared_ptr<const VolumeColors>> VolumeColors::make(SparseVolume volume) {
  if (volume.type != VolumeType::kFloat3)
    return Error{ErrorCode::kInvalidInput,
                 "the grid has no colors, which are three floats a voxel; name one that has by grid=NAME"};
  const std::optional<Transform> inverse = volume.index_to_world.inverse();
  if (!inverse) return Error{ErrorCode::kInvalidInput, "the volume's transform cannot be undone"};
  return std::shared_ptr<const VolumeColors>(new VolumeColors(std::move(volume), *inverse));
}

Rgb8 VolumeColors::at(Vec3 point) const {
  return linear_to_srgb8(to_vec3(lookup_.interpolate_numbers(world_to_index_.point(point))));
}

Result<LabelVolume> labels_of(const SparseVolume& volume) {
  if (volume.type != VolumeType::kInt && volume.type != VolumeType::kMask)
    return Error{ErrorCode::kInvalidInput,
                 "the grid has no labels, which are whole numbers; name one that has by grid=NAME"};
  VoxelCoord low, high;
  if (!active_range(volume, low, high))
    return Error{ErrorCode::kInvalidInput, "the grid has no active voxel, so there are no cells in it"};
  for (const auto& [key, value] : volume.metadata) {
    if (key != "mesocell:resolution") continue;
    VoxelCoord size{};
    const char* next = value.data();
    const char* const end = next + value.size();
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [stop, status] = std::from_chars(next, end, size[a]);
      const bool last = a == 2;
      if (status != std::errc() || size[a] < 1 || size[a] > 1024 || (stop == end) != last ||
          (!last && *stop != ' '))
        return Error{ErrorCode::kInvalidInput, "the resolution in the grid's metadata is none; remove it"};
      next = stop + 1;
    }
    low = {0, 0, 0};
    high = {size[0] - 1, size[1] - 1, size[2] - 1};
  }
  LabelVolume labels;
  for (std::size_t a = 0; a < 3; ++a) {
    if (std::int64_t{high[a]} - low[a] >= 1024)
      return Error{ErrorCode::kLimit, "its active voxels span " +
                                          std::to_string(std::int64_t{high[a]} - low[a] + 1) +
                                          " voxels along an axis, a tile has at most 1024; crop it"};
    labels.resolution[a] = std::uint32_t(high[a] - low[a] + 1);
  }
  constexpr std::uint64_t kMaxVoxels = std::uint64_t{1} << 28;
  if (labels.voxel_count() > kMaxVoxels)
    return Error{ErrorCode::kLimit, "its active voxels are in a box of more than 2^28 voxels; crop it"};
  const VolumeLookup lookup(volume);
  labels.labels.reserve(labels.voxel_count());
  VoxelCoord at;
  for (at[2] = low[2]; at[2] <= high[2]; ++at[2])
    for (at[1] = low[1]; at[1] <= high[1]; ++at[1])
      for (at[0] = low[0]; at[0] <= high[0]; ++at[0])
        labels.labels.push_back(std::uint32_t(std::max(lookup.value(at), 0.0)));
  return labels;
}

}  // namespace mesocell
