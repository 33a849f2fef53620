// Embree, given meshes of voxels' faces. [Wald et al. 2014]
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "converters/bench/peers/embree_module.h"
#include "converters/bench/peers/face_mesh.h"
#include "converters/bench/peers/peers.h"
#include "converters/image/module_loader.h"

namespace mesocell {
namespace {

const Result<const MesocellEmbreeModule*>& embree() {
  static const auto loaded = []() -> Result<const MesocellEmbreeModule*> {
#ifdef MESOCELL_EMBREE
    const Result<void*> handle = load_module("mesocell_embree");
    if (!handle) return handle.error();
    const auto get =
        reinterpret_cast<MesocellEmbreeModuleOf>(find_function(*handle, "mesocell_embree_module"));
    if (!get || get()->version != MESOCELL_EMBREE_MODULE_VERSION)
      return Error{ErrorCode::kOutput,
                   "the Embree module is of another version; install the one of this program"};
    return get();
#else
    return Error{ErrorCode::kUsage,
                 "this program was built without Embree; install libembree-dev and build it again"};
#endif
  }();
  return loaded;
}

/// Processor time of this thread: others do not disturb it.
double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

struct SceneDeleter {
  void operator()(MesocellEmbreeScene* scene) const { (*embree())->destroy(scene); }
};

constexpr std::array<std::string_view, MESOCELL_EMBREE_CALLS> kCalls = {"1", "8", "16", "stream"};

/// Where an instance's mesh has its first voxel, and what it is of.
struct InstancePlace {
  std::array<std::int32_t, 3> voxel{};
  std::uint32_t label = 0;
};

class EmbreeTracer final : public Tracer {
 public:
  EmbreeTracer(const CellObject& object, const std::array<std::int32_t, 3>& centre,
               std::optional<MesocellEmbreeCall> call)
      : edge_(object.grid.voxel_edge), call_(call) {
    rays_.scale = 1 / edge_;
    for (std::size_t a = 0; a < 3; ++a) {
      box_min_[a] = object.grid.box_min[a];
      size_[a] = std::int32_t(object.grid.tiles[a] * object.tile.resolution[a]);
      rays_.offset[a] = object.grid.box_min[a] / edge_ + centre[a];
    }
  }

  [[nodiscard]] Status build(std::vector<FaceMesh> meshes, std::span<const MesocellEmbreeInstance> instances,
                             std::vector<InstancePlace> places, unsigned threads, std::uint64_t max_bytes) {
    places_ = std::move(places);
    mesh_of_.reserve(instances.size());
    for (const MesocellEmbreeInstance& instance : instances) mesh_of_.push_back(std::uint16_t(instance.mesh));
    if (instances.empty()) mesh_of_.push_back(0);
    std::vector<MesocellEmbreeMesh> plain;
    for (const FaceMesh& mesh : meshes)
      plain.push_back({mesh.corners.data(), mesh.corners.size() / 3, mesh.quads.data(), mesh.faces.size()});
    const MesocellEmbreeInput input{
        plain.data(),     plain.size(), instances.empty() ? nullptr : instances.data(),
        instances.size(), threads,      max_bytes};
    MesocellEmbreeScene* scene = nullptr;
    char message[512] = "";
    const int failed = (*embree())->create(&input, &scene, message, sizeof message);
    if (failed)
      return Error{failed == MESOCELL_EMBREE_LIMIT ? ErrorCode::kLimit : ErrorCode::kOutput, message};
    scene_.reset(scene);
    for (FaceMesh& mesh : meshes) faces_.push_back(std::move(mesh.faces));
    return {};
  }

  void trace(std::span<const Ray> rays, std::span<StreamHit> hits, bool coherent) const override {
    trace_by(call_ ? *call_ : fastest(rays, coherent), rays, hits, coherent);
  }

  [[nodiscard]] std::uint64_t memory_bytes() const override {
    std::uint64_t bytes =
        places_.capacity() * sizeof(InstancePlace) + mesh_of_.capacity() * sizeof(mesh_of_[0]);
    for (const auto& faces : faces_) bytes += faces.capacity() * sizeof(PackedFace);
    return bytes + (scene_ ? (*embree())->memory(scene_.get()) : 0);
  }

 private:
  void trace_by(MesocellEmbreeCall call, std::span<const Ray> rays, std::span<StreamHit> hits,
                bool coherent) const {
    static_assert(sizeof(Ray) == 6 * sizeof(double));
    if (!scene_) {  // nothing is INSIDE
      std::fill(hits.begin(), hits.end(), StreamHit{});
      return;
    }
    constexpr std::size_t kBlock = 256;
    std::array<MesocellEmbreeHit, kBlock> found;
    MesocellEmbreeRays block = rays_;
    block.coherent = coherent;
    for (std::size_t begin = 0; begin < rays.size(); begin += kBlock) {
      block.count = std::min(kBlock, rays.size() - begin);
      block.rays = &rays[begin].origin.x;
      (*embree())->trace(scene_.get(), call, &block, found.data());
      for (std::size_t k = 0; k < block.count; ++k) hits[begin + k] = to_hit(rays[begin + k], found[k]);
    }
  }

  [[nodiscard]] StreamHit to_hit(const Ray& ray, const MesocellEmbreeHit& found) const {
    StreamHit hit;
    if (!(found.t < std::numeric_limits<float>::infinity())) return hit;
    const InstancePlace& place = places_[found.instance];
    const PackedFace face = faces_[mesh_of_[found.instance]][found.quad];
    hit.t = double{found.t} * edge_;
    hit.label = place.label;
    hit.element = face.voxel();
    for (std::size_t a = 0; a < 3; ++a) hit.element[a] += place.voxel[a];
    hit.face = std::int8_t(face.face());
    // A face that is met from behind: the ray began inside, unless it came through a crack.
    if ((ray.direction[std::size_t(face.face() / 2)] > 0) == (face.face() % 2 == 1)) began_inside(ray, hit);
    return hit;
  }

  void began_inside(const Ray& ray, StreamHit& hit) const {
    std::array<std::int32_t, 3> voxel{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = std::floor((ray.origin[a] - box_min_[a]) / edge_);
      if (!(x >= 0 && x < size_[a])) return;
      voxel[a] = std::int32_t(x);
    }
    hit.t = 0;
    hit.element = voxel;
    hit.face = StreamHit::kBegan;
  }

  /// The fastest call for rays like these, tried once.
  [[nodiscard]] MesocellEmbreeCall fastest(std::span<const Ray> rays, bool coherent) const {
    constexpr std::size_t kFew = 512, kMany = 8192;
    Choice& choice = choices_[coherent];
    const std::scoped_lock lock(choice.mutex);
    if (choice.made) return *choice.made;
    if (rays.size() < kFew) return MESOCELL_EMBREE_8;
    // From the middle, where pictures have something to see.
    const std::size_t count = std::min(rays.size(), kMany) / 64 * 64;
    const auto trial = rays.subspan((rays.size() - count) / 2 / 64 * 64, count);
    std::vector<StreamHit> hits(count);
    std::array<double, MESOCELL_EMBREE_CALLS> seconds;
    seconds.fill(std::numeric_limits<double>::infinity());
    for (int round = 0; round < 4; ++round)
      for (std::size_t call = 0; call < seconds.size(); ++call) {
        const double begin = thread_seconds();
        trace_by(MesocellEmbreeCall(call), trial, hits, coherent);
        seconds[call] = std::min(seconds[call], thread_seconds() - begin);
      }
    choice.made = MesocellEmbreeCall(std::min_element(seconds.begin(), seconds.end()) - seconds.begin());
    return *choice.made;
  }

  struct Choice {
    std::mutex mutex;
    std::optional<MesocellEmbreeCall> made;
  };

  double edge_;
  std::array<double, 3> box_min_{};
  std::array<std::int32_t, 3> size_{};
  MesocellEmbreeRays rays_{};
  std::unique_ptr<MesocellEmbreeScene, SceneDeleter> scene_;
  std::vector<std::vector<PackedFace>> faces_;  ///< of each mesh
  std::vector<InstancePlace> places_;
  std::vector<std::uint16_t> mesh_of_;  ///< of each instance
  std::optional<MesocellEmbreeCall> call_;
  mutable std::array<Choice, 2> choices_;
};

Error too_many(std::uint64_t max_bytes) {
  return Error{ErrorCode::kLimit, "Embree's instances would take more than " +
                                      std::to_string(max_bytes >> 20) +
                                      " MiB; allow more, or take fewer tiles"};
}

Status build_instanced(const CellObject& object, const std::array<std::int32_t, 3>& centre, unsigned threads,
                       std::uint64_t max_bytes, EmbreeTracer& tracer) {
  // What an instance takes here and in Embree is more than this.
  constexpr std::uint64_t kInstanceBytes = 256;
  const InstanceCounts counts = count_instances(object.membership);
  if (counts.inside > max_bytes / kInstanceBytes || counts.inside >= 0xffffffffu) return too_many(max_bytes);
  Result<std::vector<FaceMesh>> meshes = make_cell_meshes(object.tile, max_bytes);
  if (!meshes) return meshes.error();
  std::vector<MesocellEmbreeInstance> instances;
  std::vector<InstancePlace> places;
  instances.reserve(counts.inside);
  places.reserve(counts.inside);
  std::uint64_t index = 0;
  for (std::uint32_t z = 0; z < object.grid.tiles[2]; ++z)
    for (std::uint32_t y = 0; y < object.grid.tiles[1]; ++y)
      for (std::uint32_t x = 0; x < object.grid.tiles[0]; ++x, ++index)
        for (std::uint32_t cell = 1; cell <= object.tile.cell_count; ++cell) {
          if (object.membership.tag(index, cell) != Tag::kInside || (*meshes)[cell - 1].faces.empty())
            continue;
          const Index3& r = object.tile.resolution;
          const InstancePlace place{{std::int32_t(x * r[0]), std::int32_t(y * r[1]), std::int32_t(z * r[2])},
                                    cell};
          MesocellEmbreeInstance instance{cell - 1, {}};
          for (std::size_t a = 0; a < 3; ++a) instance.offset[a] = float(place.voxel[a] - centre[a]);
          instances.push_back(instance);
          places.push_back(place);
        }
  if (instances.empty()) return {};
  return tracer.build(std::move(*meshes), instances, std::move(places), threads, max_bytes);
}

Status build_surface(const CellObject& object, const std::array<std::int32_t, 3>& centre, unsigned threads,
                     std::uint64_t max_bytes, EmbreeTracer& tracer) {
  constexpr std::uint64_t kSquareBytes = 150;  // our mesh, Embree's copy and its tree, at the least
  Result<FaceMesh> mesh = make_union_mesh(object, centre, max_bytes / kSquareBytes);
  if (!mesh) return mesh.error();
  if (mesh->faces.empty()) return {};
  std::vector<FaceMesh> meshes;
  meshes.push_back(std::move(*mesh));
  return tracer.build(std::move(meshes), {}, {{centre, 0xffffffffu}}, threads, max_bytes);
}

}  // namespace

Result<std::unique_ptr<Tracer>> make_embree_tracer(const CellObject& object, bool instanced,
                                                   std::string_view call, unsigned threads,
                                                   std::uint64_t max_bytes) {
  std::optional<MesocellEmbreeCall> wanted;
  if (!call.empty()) {
    const auto found = std::ranges::find(kCalls, call);
    if (found == kCalls.end())
      return Error{ErrorCode::kUsage,
                   "Embree is not called by '" + std::string(call) + "'; there are :1, :8, :16 and :stream"};
    wanted = MesocellEmbreeCall(found - kCalls.begin());
  }
  if (!embree()) return embree().error();
  // Floats are finest around zero.
  std::array<std::int32_t, 3> centre{};
  for (std::size_t a = 0; a < 3; ++a)
    centre[a] = std::int32_t(std::uint64_t{object.grid.tiles[a]} * object.tile.resolution[a] / 2);
  auto tracer = std::make_unique<EmbreeTracer>(object, centre, wanted);
  const Status built =
      (instanced ? build_instanced : build_surface)(object, centre, threads, max_bytes, *tracer);
  if (!built) return built.error();
  return std::unique_ptr<Tracer>(std::move(tracer));
}

}  // namespace mesocell
