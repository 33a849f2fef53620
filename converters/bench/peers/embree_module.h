#pragma once

/// The interface of the Embree module, in C. It is loaded by what measures it alone.

#include <stddef.h>
#include <stdint.h>

extern "C" {

struct MesocellEmbreeMesh {
  const float* corners;  ///< three a corner
  uint64_t corner_count;
  const uint32_t* quads;  ///< four corners a square
  uint64_t quad_count;
};

struct MesocellEmbreeInstance {
  uint32_t mesh;
  float offset[3];
};

struct MesocellEmbreeInput {
  const MesocellEmbreeMesh* meshes;
  uint64_t mesh_count;
  const MesocellEmbreeInstance* instances;  ///< null: the first mesh stands alone, as it is
  uint64_t instance_count;
  uint32_t threads;  ///< to build with; 0 for the machine's
  uint64_t max_bytes;
};

struct MesocellEmbreeScene;

/// Returns 0, MESOCELL_EMBREE_FAILED or MESOCELL_EMBREE_LIMIT with a text in `message`, cut to
/// `message_bytes` and ended by 0. Throws nothing. What is in `input` is copied.
typedef int (*MesocellEmbreeCreate)(const MesocellEmbreeInput* input, MesocellEmbreeScene** scene,
                                    char* message, size_t message_bytes);
#define MESOCELL_EMBREE_FAILED 1
#define MESOCELL_EMBREE_LIMIT 2

typedef void (*MesocellEmbreeDestroy)(MesocellEmbreeScene* scene);

/// What Embree has taken for a scene, bytes.
typedef uint64_t (*MesocellEmbreeMemory)(const MesocellEmbreeScene* scene);

struct MesocellEmbreeHit {
  float t;  ///< infinite for a miss
  uint32_t instance, quad;
};

/// Calls of Embree that find the nearest hits.
enum MesocellEmbreeCall {
  MESOCELL_EMBREE_1,       ///< rtcIntersect1
  MESOCELL_EMBREE_8,       ///< rtcIntersect8
  MESOCELL_EMBREE_16,      ///< rtcIntersect16
  MESOCELL_EMBREE_STREAM,  ///< rtcIntersect1M
  MESOCELL_EMBREE_CALLS
};

/// Traces rays of six doubles each, origin and direction: x of Embree's space is x · scale - offset. Of
/// coherent rays each 64 are 8 × 8 pixels, rows in turn. Reentrant.
struct MesocellEmbreeRays {
  const double* rays;
  uint64_t count;
  double scale, offset[3];
  int coherent;
};
typedef void (*MesocellEmbreeTrace)(const MesocellEmbreeScene* scene, enum MesocellEmbreeCall call,
                                    const MesocellEmbreeRays* rays, MesocellEmbreeHit* hits);

/// Changes whenever this header does; a module of another version is not used.
#define MESOCELL_EMBREE_MODULE_VERSION 1u

struct MesocellEmbreeModule {
  uint32_t version;
  const char* library;  ///< Embree's own version
  MesocellEmbreeCreate create;
  MesocellEmbreeDestroy destroy;
  MesocellEmbreeMemory memory;
  MesocellEmbreeTrace trace;
};

/// The one function that the module has for others.
typedef const MesocellEmbreeModule* (*MesocellEmbreeModuleOf)(void);
}
