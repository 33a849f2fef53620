// First active voxels by NanoVDB's hierarchical differential analyzer. [Museth 2021]
#include <nanovdb/util/HDDA.h>
#include <nanovdb/util/OpenToNanoVDB.h>

#include "converters/bench/peers/vdb_mask.h"

namespace mesocell {
namespace {

/// What nanovdb::HDDA asks of a ray. nanovdb::Ray rounds all points to floats, which in a grid of a thousand
/// voxels turns a tenth of the hits into misses.
class Ray {
 public:
  using RealType = double;
  using Vec3Type = nanovdb::Vec3<double>;

  explicit Ray(const VdbRay& ray)
      : origin_(ray.origin[0], ray.origin[1], ray.origin[2]),
        direction_(ray.direction[0], ray.direction[1], ray.direction[2]),
        inverse_(1 / direction_[0], 1 / direction_[1], 1 / direction_[2]),
        t0_(ray.t0),
        t1_(ray.t1) {}

  [[nodiscard]] Vec3Type operator()(double t) const { return origin_ + direction_ * t; }
  [[nodiscard]] const Vec3Type& dir() const { return direction_; }
  [[nodiscard]] const Vec3Type& invDir() const { return inverse_; }
  [[nodiscard]] double t0() const { return t0_; }
  [[nodiscard]] double t1() const { return t1_; }

 private:
  Vec3Type origin_, direction_, inverse_;
  double t0_, t1_;
};

/// As nanovdb::firstActive(), which looks a whole voxel beyond where a node begins and so misses those that
/// are only grazed; here it is a ten-millionth of one.
template <typename Accessor>
bool first_active(const Ray& ray, const Accessor& accessor, nanovdb::Coord& voxel) {
  constexpr double kDelta = 1e-7;
  voxel = nanovdb::RoundDown<nanovdb::Coord>(ray(ray.t0() + kDelta));
  nanovdb::HDDA<Ray, nanovdb::Coord> hdda(ray, int(accessor.getDim(voxel, ray)));
  while (!accessor.isActive(voxel)) {
    hdda.update(ray, int(accessor.getDim(voxel, ray)));
    if (!hdda.step()) return false;
    voxel = nanovdb::RoundDown<nanovdb::Coord>(ray(hdda.time() + kDelta));
  }
  return true;
}

class NanoVdbMask final : public MesocellVdbMask {
 public:
  NanoVdbMask(nanovdb::GridHandle<nanovdb::HostBuffer> handle, const std::int32_t (&size)[3])
      : handle_(std::move(handle)), grid_(handle_.grid<nanovdb::ValueMask>()) {
    std::copy_n(size, 3, size_);
    if (!grid_) throw std::runtime_error("NanoVDB made no mask");
  }
  [[nodiscard]] std::uint64_t memory_bytes() const override { return handle_.size(); }

  void trace(const MesocellVdbRays& rays, MesocellVdbHit* hits) const override {
    const auto accessor = grid_->getAccessor();
    for (std::uint64_t k = 0; k < rays.count; ++k) {
      VdbRay cut;
      hits[k].found = 0;
      if (!cut.set(rays, k, size_)) continue;
      nanovdb::Coord voxel;
      if (!first_active(Ray(cut), accessor, voxel)) continue;
      hits[k].found = 1;
      for (int a = 0; a < 3; ++a) hits[k].voxel[a] = voxel[a];
    }
  }

 private:
  nanovdb::GridHandle<nanovdb::HostBuffer> handle_;
  const nanovdb::NanoGrid<nanovdb::ValueMask>* grid_;
  std::int32_t size_[3];
};

}  // namespace

std::unique_ptr<MesocellVdbMask> make_nanovdb_mask(const openvdb::MaskGrid::Ptr& grid,
                                                   const std::int32_t (&size)[3]) {
  return std::make_unique<NanoVdbMask>(nanovdb::openToNanoVDB(*grid), size);
}

}  // namespace mesocell
