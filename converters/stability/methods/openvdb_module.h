#pragma once

/// The interface of the OpenVDB module, in C. Linked into the program it would cost 45 ms at every start.

#include <stddef.h>
#include <stdint.h>

extern "C" {

/// Triangles to voxelize, in voxel units.
struct MesocellVdbMesh {
  const double* coordinates;  ///< three a vertex
  uint64_t vertex_count;
  const uint32_t* indices;  ///< three a triangle
  uint64_t triangle_count;
};

/// Voxels to set, a bit each, rows of whole words along x.
struct MesocellVdbVoxels {
  uint32_t size[3];
  uint32_t words_per_row;
  uint64_t* words;
};

/// Sets the voxels whose centres have a negative distance by openvdb::tools::meshToVolume. Returns 0, or 1
/// with a text in `message`, cut to `message_bytes` and ended by 0. Throws nothing. `threads`: 0 for the
/// machine's.
typedef int (*MesocellVdbVoxelize)(const MesocellVdbMesh* mesh, const MesocellVdbVoxels* voxels,
                                   uint32_t threads, char* message, size_t message_bytes);

/// Changes whenever this header does; a module of another version is not used.
#define MESOCELL_VDB_MODULE_VERSION 1u
typedef uint32_t (*MesocellVdbModuleVersion)(void);
}
