#include "converters/bench/peers/embree_module.h"

#include <embree3/rtcore.h>
#include <malloc.h>
#include <xmmintrin.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <new>
#include <string>
#include <vector>

/// `heap_bytes`: what malloc had given out before it was built, then what it gave for it.
struct MesocellEmbreeScene {
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  bool instanced = false;
  std::uint64_t heap_bytes = 0, most_bytes = 0;
  std::atomic<std::int64_t> monitored{0};
  std::atomic<bool> over{false};
  /// Where rays begin to look, so that one that starts on a face does not meet it: what rounding moves
  /// origins by.
  float near = 0;

  ~MesocellEmbreeScene() {
    if (top) rtcReleaseScene(top);
    if (device) rtcReleaseDevice(device);
  }
};

namespace {

/// Denormals are zero while Embree traces, as it asks for, and never longer: exact predicates need them.
class FlushToZero {
 public:
  FlushToZero() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
  ~FlushToZero() { _mm_setcsr(before_); }
  FlushToZero(const FlushToZero&) = delete;
  FlushToZero& operator=(const FlushToZero&) = delete;

 private:
  unsigned before_;
};

struct Failed {
  int code;
  std::string message;
};

void check(const MesocellEmbreeScene& scene) {
  const RTCError error = rtcGetDeviceError(scene.device);
  if (scene.over.load() || error == RTC_ERROR_OUT_OF_MEMORY)
    throw Failed{MESOCELL_EMBREE_LIMIT, "Embree would take more than " +
                                            std::to_string(scene.most_bytes >> 20) +
                                            " MiB; allow more, or take fewer tiles"};
  if (error != RTC_ERROR_NONE)
    throw Failed{MESOCELL_EMBREE_FAILED, "Embree failed with its error " + std::to_string(int(error))};
}

bool monitor(void* user, ssize_t bytes, bool) {
  auto& scene = *static_cast<MesocellEmbreeScene*>(user);
  const std::int64_t now = scene.monitored.fetch_add(bytes) + bytes;
  if (bytes <= 0 || now <= std::int64_t(scene.most_bytes)) return true;
  scene.over = true;
  return false;
}

/// What malloc has given out.
std::uint64_t heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

RTCScene new_scene(const MesocellEmbreeScene& scene) {
  const RTCScene made = rtcNewScene(scene.device);
  rtcSetSceneBuildQuality(made, RTC_BUILD_QUALITY_HIGH);
  rtcSetSceneFlags(made, RTC_SCENE_FLAG_NONE);
  return made;
}

/// The scene of one mesh, committed. Pairs of triangles are as fast and take a little more room.
RTCScene mesh_scene(const MesocellEmbreeScene& scene, const MesocellEmbreeMesh& mesh) {
  const RTCScene made = new_scene(scene);
  const RTCGeometry geometry = rtcNewGeometry(scene.device, RTC_GEOMETRY_TYPE_QUAD);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
  void* const corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                3 * sizeof(float), mesh.corner_count);
  void* const quads = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4,
                                              4 * sizeof(std::uint32_t), mesh.quad_count);
  if (corners && quads) {
    std::copy_n(mesh.corners, 3 * mesh.corner_count, static_cast<float*>(corners));
    std::copy_n(mesh.quads, 4 * mesh.quad_count, static_cast<std::uint32_t*>(quads));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(made, geometry);
  }
  rtcReleaseGeometry(geometry);
  if (corners && quads) rtcCommitScene(made);
  return made;
}

/// Scenes of meshes, let go of when instances hold them.
struct Scenes {
  std::vector<RTCScene> all;
  ~Scenes() {
    for (const RTCScene scene : all)
      if (scene) rtcReleaseScene(scene);
  }
};

/// Embree tells of its trees' and buffers' blocks, which it also maps, malloc of all else, such as instances.
std::uint64_t scene_bytes(const MesocellEmbreeScene& scene) {
  return std::max(scene.heap_bytes, std::uint64_t(std::max<std::int64_t>(scene.monitored.load(), 0)));
}

void add_instances(MesocellEmbreeScene& scene, const MesocellEmbreeInput& input) {
  Scenes meshes;
  meshes.all.resize(input.mesh_count);
  scene.top = new_scene(scene);
  for (std::uint64_t k = 0; k < input.instance_count; ++k) {
    const MesocellEmbreeInstance& instance = input.instances[k];
    RTCScene& mesh = meshes.all[instance.mesh];
    if (!mesh) {
      mesh = mesh_scene(scene, input.meshes[instance.mesh]);
      check(scene);
    }
    const RTCGeometry geometry = rtcNewGeometry(scene.device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, mesh);
    const float* o = instance.offset;
    const float matrix[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, o[0], o[1], o[2]};
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene.top, geometry, unsigned(k));
    rtcReleaseGeometry(geometry);
    // What malloc has given out is slow to ask for.
    if (k % 65536 == 65535 && heap_bytes() > scene.heap_bytes + scene.most_bytes) scene.over = true;
    if (k % 65536 == 65535) check(scene);
  }
  rtcCommitScene(scene.top);
}

void create(const MesocellEmbreeInput& input, MesocellEmbreeScene& scene) {
  scene.most_bytes = input.max_bytes;
  scene.heap_bytes = heap_bytes();
  const std::string config = "threads=" + std::to_string(input.threads);
  scene.device = rtcNewDevice(config.c_str());
  if (!scene.device)
    throw Failed{MESOCELL_EMBREE_FAILED,
                 "Embree has no device, its error is " + std::to_string(int(rtcGetDeviceError(nullptr)))};
  rtcSetDeviceMemoryMonitorFunction(scene.device, monitor, &scene);
  scene.instanced = input.instances != nullptr;
  float most = 0;
  if (scene.instanced) {
    add_instances(scene, input);
    for (std::uint64_t k = 0; k < input.instance_count; ++k)
      for (const float x : input.instances[k].offset) most = std::max(most, std::abs(x));
  } else {
    scene.top = mesh_scene(scene, input.meshes[0]);
    for (std::uint64_t k = 0; k < 3 * input.meshes[0].corner_count; ++k)
      most = std::max(most, std::abs(input.meshes[0].corners[k]));
  }
  check(scene);
  scene.near = 4 * most * std::numeric_limits<float>::epsilon();
  const std::uint64_t now = heap_bytes();
  scene.heap_bytes = now > scene.heap_bytes ? now - scene.heap_bytes : 0;
  if (scene_bytes(scene) > scene.most_bytes) scene.over = true;
  check(scene);
}

/// Which of 64 rays, 8 × 8 pixels, are the lanes of packet p: 4 × 2 or 4 × 4 pixels.
template <unsigned kWidth>
constexpr unsigned ray_of(unsigned packet, unsigned lane) {
  constexpr unsigned kRows = kWidth / 4;
  return (packet / 2 * kRows + lane / 4) * 8 + packet % 2 * 4 + lane % 4;
}

class Tracing {
 public:
  Tracing(const MesocellEmbreeScene& scene, const MesocellEmbreeRays& rays, MesocellEmbreeHit* hits)
      : scene_(scene), rays_(rays), hits_(hits) {
    rtcInitIntersectContext(&context_);
    if (rays.coherent) context_.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  }

  void one() {
    for (std::uint64_t k = 0; k < rays_.count; ++k) {
      RTCRayHit ray;
      set(ray, k);
      rtcIntersect1(scene_.top, &context_, &ray);
      take(ray, k);
    }
  }

  void stream() {
    constexpr unsigned kRays = 64;
    RTCRayHit rays[kRays];
    for (std::uint64_t begin = 0; begin < rays_.count; begin += kRays) {
      const auto count = unsigned(std::min<std::uint64_t>(kRays, rays_.count - begin));
      for (unsigned k = 0; k < count; ++k) set(rays[k], begin + k);
      rtcIntersect1M(scene_.top, &context_, rays, count, sizeof(RTCRayHit));
      for (unsigned k = 0; k < count; ++k) take(rays[k], begin + k);
    }
  }

  template <unsigned kWidth, typename Packet, typename Intersect>
  void packets(Intersect intersect) {
    std::uint64_t begin = 0;
    alignas(64) int valid[kWidth];
    std::fill_n(valid, kWidth, -1);
    Packet packet;
    if (rays_.coherent)
      for (; begin + 64 <= rays_.count; begin += 64)
        for (unsigned p = 0; p < 64 / kWidth; ++p) {
          for (unsigned l = 0; l < kWidth; ++l) set(packet, l, begin + ray_of<kWidth>(p, l));
          intersect(valid, scene_.top, &context_, &packet);
          for (unsigned l = 0; l < kWidth; ++l) take(packet, l, begin + ray_of<kWidth>(p, l));
        }
    for (; begin < rays_.count; begin += kWidth) {
      const auto count = unsigned(std::min<std::uint64_t>(kWidth, rays_.count - begin));
      for (unsigned l = 0; l < kWidth; ++l) valid[l] = l < count ? -1 : 0;
      for (unsigned l = 0; l < kWidth; ++l) set(packet, l, begin + std::min(l, count - 1));
      intersect(valid, scene_.top, &context_, &packet);
      for (unsigned l = 0; l < count; ++l) take(packet, l, begin + l);
    }
  }

 private:
  /// A ray in Embree's space.
  struct Floats {
    float origin[3], direction[3], near, far;
  };
  [[nodiscard]] Floats floats(std::uint64_t k) const {
    const double* const r = rays_.rays + 6 * k;
    Floats f;
    float sum = 0;
    for (int a = 0; a < 3; ++a) {
      f.origin[a] = float(r[a] * rays_.scale - rays_.offset[a]);
      f.direction[a] = float(r[3 + a]);
      sum += std::abs(f.origin[a]) + std::abs(f.direction[a]);
    }
    f.near = scene_.near;
    f.far = std::numeric_limits<float>::infinity();
    // What is no ray, or beyond what Embree takes, is switched off by an empty interval.
    if (!(sum < 1e18f)) f = {{0, 0, 0}, {1, 0, 0}, 1, 0};
    return f;
  }

  void set(RTCRayHit& r, std::uint64_t k) const {
    const Floats f = floats(k);
    r.ray.org_x = f.origin[0];
    r.ray.org_y = f.origin[1];
    r.ray.org_z = f.origin[2];
    r.ray.dir_x = f.direction[0];
    r.ray.dir_y = f.direction[1];
    r.ray.dir_z = f.direction[2];
    r.ray.tnear = f.near;
    r.ray.tfar = f.far;
    r.ray.time = 0;
    r.ray.mask = ~0u;
    r.ray.id = 0;
    r.ray.flags = 0;
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  }
  template <typename Packet>
  void set(Packet& r, unsigned l, std::uint64_t k) const {
    const Floats f = floats(k);
    r.ray.org_x[l] = f.origin[0];
    r.ray.org_y[l] = f.origin[1];
    r.ray.org_z[l] = f.origin[2];
    r.ray.dir_x[l] = f.direction[0];
    r.ray.dir_y[l] = f.direction[1];
    r.ray.dir_z[l] = f.direction[2];
    r.ray.tnear[l] = f.near;
    r.ray.tfar[l] = f.far;
    r.ray.time[l] = 0;
    r.ray.mask[l] = ~0u;
    r.ray.id[l] = 0;
    r.ray.flags[l] = 0;
    r.hit.geomID[l] = RTC_INVALID_GEOMETRY_ID;
    r.hit.instID[0][l] = RTC_INVALID_GEOMETRY_ID;
  }
  void put(std::uint64_t k, float t, unsigned geometry, unsigned instance, unsigned quad) {
    hits_[k].t = geometry == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<float>::infinity() : t;
    hits_[k].instance = scene_.instanced ? instance : 0;
    hits_[k].quad = quad;
  }
  void take(const RTCRayHit& r, std::uint64_t k) {
    put(k, r.ray.tfar, r.hit.geomID, r.hit.instID[0], r.hit.primID);
  }
  template <typename Packet>
  void take(const Packet& r, unsigned l, std::uint64_t k) {
    put(k, r.ray.tfar[l], r.hit.geomID[l], r.hit.instID[0][l], r.hit.primID[l]);
  }

  const MesocellEmbreeScene& scene_;
  const MesocellEmbreeRays& rays_;
  MesocellEmbreeHit* hits_;
  RTCIntersectContext context_;
};

int create_scene(const MesocellEmbreeInput* input, MesocellEmbreeScene** scene, char* message,
                 size_t message_bytes) {
  MesocellEmbreeScene* made = nullptr;
  int code = 0;
  try {
    made = new MesocellEmbreeScene;
    create(*input, *made);
    *scene = made;
    return 0;
  } catch (const Failed& failed) {
    std::snprintf(message, message_bytes, "%s", failed.message.c_str());
    code = failed.code;
  } catch (const std::exception& exception) {
    std::snprintf(message, message_bytes, "%s", exception.what());
    code = MESOCELL_EMBREE_FAILED;
  }
  delete made;
  return code;
}

void destroy_scene(MesocellEmbreeScene* scene) { delete scene; }

uint64_t scene_memory(const MesocellEmbreeScene* scene) { return scene_bytes(*scene); }

void trace(const MesocellEmbreeScene* scene, MesocellEmbreeCall call, const MesocellEmbreeRays* rays,
           MesocellEmbreeHit* hits) {
  const FlushToZero flush;
  Tracing tracing(*scene, *rays, hits);
  switch (call) {
    case MESOCELL_EMBREE_8:
      tracing.packets<8, RTCRayHit8>(rtcIntersect8);
      break;
    case MESOCELL_EMBREE_16:
      tracing.packets<16, RTCRayHit16>(rtcIntersect16);
      break;
    case MESOCELL_EMBREE_STREAM:
      tracing.stream();
      break;
    default:
      tracing.one();
  }
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const MesocellEmbreeModule* mesocell_embree_module() {
  static constexpr MesocellEmbreeModule kModule = {
      MESOCELL_EMBREE_MODULE_VERSION, RTC_VERSION_STRING, create_scene, destroy_scene, scene_memory, trace};
  return &kModule;
}
