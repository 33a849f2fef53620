#pragma once

/// The interface of the module of OpenVDB and NanoVDB, in C. It is loaded by what measures them alone.

#include <stddef.h>
#include <stdint.h>

extern "C" {

enum MesocellVdbFill { MESOCELL_VDB_NONE, MESOCELL_VDB_ALL, MESOCELL_VDB_MIXED };

struct MesocellVdbInput {
  int32_t size[3];  ///< voxels, the first is (0, 0, 0)
  /// Which voxels of the block of 8³ at `origin` are active; of a mixed block bit 8·y + z of words[x] is
  /// voxel (x, y, z) of it.
  enum MesocellVdbFill (*fill)(void* user, const int32_t origin[3], uint64_t words[8]);
  void* user;
  uint64_t max_bytes;
  int nano;  ///< 1: convert to NanoVDB
};

struct MesocellVdbMask;

/// Returns 0, MESOCELL_VDB_FAILED or MESOCELL_VDB_LIMIT with a text in `message`, cut to `message_bytes` and
/// ended by 0. Throws nothing.
typedef int (*MesocellVdbCreate)(const MesocellVdbInput* input, MesocellVdbMask** mask, char* message,
                                 size_t message_bytes);
#define MESOCELL_VDB_FAILED 1
#define MESOCELL_VDB_LIMIT 2

typedef void (*MesocellVdbDestroy)(MesocellVdbMask* mask);

/// What the library says its grid takes, bytes.
typedef uint64_t (*MesocellVdbMemory)(const MesocellVdbMask* mask);

struct MesocellVdbHit {
  int32_t voxel[3];
  int32_t found;  ///< 0 for a miss
};

/// Finds the first active voxels of rays of six doubles each, origin and direction: x in voxels is
/// x · scale - offset. Reentrant.
struct MesocellVdbRays {
  const double* rays;
  uint64_t count;
  double scale, offset[3];
};
typedef void (*MesocellVdbTrace)(const MesocellVdbMask* mask, const MesocellVdbRays* rays,
                                 MesocellVdbHit* hits);

/// Changes whenever this header does; a module of another version is not used.
#define MESOCELL_VDB_PEERS_VERSION 1u

struct MesocellVdbPeers {
  uint32_t version;
  const char* library;  ///< OpenVDB's own version
  MesocellVdbCreate create;
  MesocellVdbDestroy destroy;
  MesocellVdbMemory memory;
  MesocellVdbTrace trace;
};

/// The one function that the module has for others.
typedef const MesocellVdbPeers* (*MesocellVdbPeersOf)(void);
}
