#ifndef MESOCELL_LOADER_H
#define MESOCELL_LOADER_H

/* The compact reference loader of .meso files, versions 1.0 and 1.1: this header, mesocell_loader.cpp and
 * zstd are all that an engine needs. It is written in the order of spec/mesocell-1.md, in C++17 without
 * exceptions and RTTI, is callable from C, and accepts exactly the assets that the spec calls valid.
 *
 * Untrusted input: safe. Nothing is read outside the file or written outside the arena; sizes are checked
 * against the file and the caller's limits before they are used. It allocates nothing and has no global
 * state: any thread, any number at once.
 *
 *   size_t need;
 *   if (mesocell_arena_bytes(file, size, 0, NULL, &need, &fault) != kMesocellOk) ...
 *   void* arena = malloc(need);
 *   MesocellObject object;
 *   if (mesocell_load(file, size, 0, NULL, arena, need, &object, &fault) != kMesocellOk) ...
 */

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum MesocellStatus {
  kMesocellOk = 0,
  kMesocellInvalid = 1,       /* the file breaks a rule of the format, or is of another version */
  kMesocellLimit = 2,         /* well-formed so far, but over a limit or the machine's address space */
  kMesocellArenaTooSmall = 3, /* the arena has fewer bytes than mesocell_arena_bytes() said */
  kMesocellNoSuchAsset = 4,   /* the file has fewer assets */
} MesocellStatus;

/* The limits' meaning is in section 6 of the spec. */
typedef struct MesocellOptions {
  uint64_t max_file_bytes;    /* default 2^32 */
  uint64_t max_decoded_bytes; /* of one asset; default 2^33 */
  uint64_t max_tiles;         /* default 2^28 */
  /* Not 0: raw chunks are used where they are in the file, which must then stay as it is while the object is
   * used, as in a memory map; they take no room in the arena, but for SCOL, whose colors are stored as
   * differences. Default 0. */
  int in_place;
} MesocellOptions;

typedef struct MesocellFault {
  const char* text; /* what is wrong, a static string; NULL if nothing is */
  uint64_t offset;  /* byte in the file that it was found at, the chunk's first byte inside chunks */
  uint32_t chunk;   /* four-character code, 0 outside chunks */
} MesocellFault;

/* What header and asset table say. */
typedef struct MesocellFile {
  uint16_t major, minor;
  uint32_t asset_count;
} MesocellFile;

/* A cell object. Pointers lead into the arena, or into the file if that was asked for. Arrays over tiles and
 * voxels are x fastest, then y, then z. */
typedef struct MesocellObject {
  double box_min[3], box_max[3]; /* metres */
  double voxel_edge;             /* metres */
  uint32_t tiles[3];

  uint32_t resolution[3]; /* voxels of the tile */
  uint32_t cell_count, piece_count, id_bytes;
  const uint8_t* pieces; /* 8 bytes each as in the file: cell u16, home i8[3]; piece id k is number k - 1 */
  const uint8_t*
      voxel_ids; /* id_bytes each, little-endian, 0 where empty; as aligned as the arena, up to 64 */

  uint32_t rule; /* 0 centre, 1 conservative */
  uint64_t inside, outside, intersected;
  const uint32_t*
      entries;         /* one a tile: 0 outside, 1 inside, 2 intersected, else 3 + number of a mixed tile */
  const uint8_t* tags; /* mixed_count × tag_bytes; cell c at bits 2·((c-1) mod 4) of byte (c-1) / 4 */
  uint32_t mixed_count, tag_bytes;

  /* sRGB, three bytes a color; NULL where the file has none, which stands for white */
  uint32_t color_resolution[3];   /* of `color`, 0 if there is none */
  const uint8_t* color;           /* a solid texture of the tile, x fastest */
  const uint8_t* cell_colors;     /* one a cell */
  const uint8_t* instance_colors; /* one an INSIDE instance, by home tile, then cell */
  /* stated errors of these three, in steps of 1/255, and of the normals in degrees */
  float color_error, cell_color_error, instance_color_error, normal_error;

  /* Colors at the surface, which stand for those of instances: see mesocell_surface_color(). NULL if there
   * are none. A brick's mask has (voxels + 7) / 8 bytes: bit v mod 8 of byte v / 8 says whether color voxel
   * v, x fastest, has a color. */
  uint32_t surface_resolution[3]; /* color voxels of a tile */
  const uint32_t* surface_bricks; /* one a tile: the number of its brick, 0xffffffff if it has none */
  const uint32_t* surface_first;  /* one a brick: how many colors are before its own */
  const uint8_t* surface_masks;   /* of all bricks */
  const uint8_t* surface_colors;  /* three bytes each, by brick, then by color voxel */
  uint32_t surface_brick_count, surface_color_count;
  float surface_color_error;

  const uint8_t* normals; /* two bytes a boundary voxel, in storage order; NULL if there are none */
  uint64_t normal_count;

  uint32_t text_count;
  const uint8_t* text; /* entries as in the file: see mesocell_next_text() */
  uint64_t text_bytes;

  /* The basic mesh as a Draco bitstream, which is not looked into; NULL if there is none. What it states:
   * numbers of vertices and triangles, and how far a vertex was moved at most, metres. */
  const uint8_t* mesh;
  uint64_t mesh_bytes;
  uint32_t mesh_vertices, mesh_triangles;
  float mesh_error;
} MesocellObject;

/* Checks header, asset table and directory; it alone looks whether two assets have the same name. `options`
 * may be NULL for the defaults, `fault` may be NULL; so below. */
MesocellStatus mesocell_open(const void* file, size_t file_bytes, const MesocellOptions* options,
                             MesocellFile* info, MesocellFault* fault);

/* The name of an asset of a file that mesocell_open() found right, UTF-8, with a zero after it. */
void mesocell_asset_name(const void* file, uint32_t asset, char name[41]);

/* How many bytes of arena an asset (from 0) needs. Looks at header, asset table, directory and GRID. */
MesocellStatus mesocell_arena_bytes(const void* file, size_t file_bytes, uint32_t asset,
                                    const MesocellOptions* options, size_t* arena_bytes,
                                    MesocellFault* fault);

/* Checks one asset whole and loads it into the arena, which must be aligned to 8 bytes. The file is not
 * referred to afterwards, but in place. On failure `object` and arena are unspecified. */
MesocellStatus mesocell_load(const void* file, size_t file_bytes, uint32_t asset,
                             const MesocellOptions* options, void* arena, size_t arena_bytes,
                             MesocellObject* object, MesocellFault* fault);

/* Piece id of voxel `i` of the tile, 0 where empty. */
static inline uint32_t mesocell_voxel_id(const MesocellObject* object, uint64_t i) {
  const uint8_t* p = object->voxel_ids + i * object->id_bytes;
  uint32_t v = p[0];
  if (object->id_bytes >= 2) v |= (uint32_t)p[1] << 8;
  if (object->id_bytes == 4) v |= (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
  return v;
}

/* Cell (from 1) and home, home tile minus tile, of piece `id` (from 1). */
static inline uint32_t mesocell_piece(const MesocellObject* object, uint32_t id, int home[3]) {
  const uint8_t* p = object->pieces + (uint64_t)(id - 1) * 8;
  for (int a = 0; a < 3; ++a) home[a] = p[2 + a] < 128 ? p[2 + a] : p[2 + a] - 256;
  return p[0] | (uint32_t)p[1] << 8;
}

/* Tag of the instance of `cell` (from 1) whose home is `tile`: 0 outside, 1 inside, 2 intersected. */
static inline uint32_t mesocell_tag(const MesocellObject* object, uint64_t tile, uint32_t cell) {
  const uint32_t entry = object->entries[tile];
  if (entry < 3) return entry;
  return object->tags[(uint64_t)(entry - 3) * object->tag_bytes + (cell - 1) / 4] >> 2 * ((cell - 1) % 4) &
         3u;
}

/* The surface color of voxel `voxel` of tile `tile`, three bytes; NULL if it has none. Takes as long as the
 * tile's mask, up to 4096 bytes of it, 64 for color voxels of 8 x 8 x 8. */
static inline const uint8_t* mesocell_surface_color(const MesocellObject* object, uint64_t tile,
                                                    const uint32_t voxel[3]) {
  const uint32_t* r = object->surface_resolution;
  uint32_t brick, at[3], v, bytes, i;
  uint64_t color, eight;
  const uint8_t* mask;
  if (!object->surface_colors || (brick = object->surface_bricks[tile]) == 0xffffffffu) return NULL;
  for (i = 0; i < 3; ++i) at[i] = (2 * voxel[i] + 1) * r[i] / (2 * object->resolution[i]);
  v = at[0] + r[0] * (at[1] + r[1] * at[2]);
  bytes = (r[0] * r[1] * r[2] + 7) / 8;
  mask = object->surface_masks + (uint64_t)brick * bytes;
  if ((mask[v / 8] >> (v % 8) & 1) == 0) return NULL;
  color = object->surface_first[brick];
  for (i = 0; i <= v / 8; i += 8) { /* bits set before that of v, eight bytes at once */
    const uint32_t whole = v / 8 - i < 8 ? v / 8 - i : 8;
    uint8_t part[8] = {0};
    memcpy(part, mask + i, whole);
    if (whole < 8) part[whole] = (uint8_t)(mask[i + whole] & ((1u << v % 8) - 1));
    memcpy(&eight, part, 8);
    eight -= eight >> 1 & 0x5555555555555555u;
    eight = (eight & 0x3333333333333333u) + (eight >> 2 & 0x3333333333333333u);
    color += ((eight + (eight >> 4)) & 0x0f0f0f0f0f0f0f0fu) * 0x0101010101010101u >> 56;
  }
  return object->surface_colors + 3 * color;
}

/* Steps through the text. Begin with *cursor = 0; returns 0 at the end. Strings are UTF-8 and not terminated.
 */
static inline int mesocell_next_text(const MesocellObject* object, uint64_t* cursor, const char** key,
                                     uint32_t* key_bytes, const char** value, uint32_t* value_bytes) {
  uint32_t sizes[2] = {0, 0};
  if (*cursor >= object->text_bytes) return 0;
  for (int i = 0; i < 8; ++i) sizes[i / 4] |= (uint32_t)object->text[*cursor + (uint64_t)i] << 8 * (i % 4);
  *key_bytes = sizes[0];
  *value_bytes = sizes[1];
  *key = (const char*)object->text + *cursor + 8;
  *value = *key + sizes[0];
  *cursor += (uint64_t)8 + sizes[0] + sizes[1];
  return 1;
}

#ifdef __cplusplus
}
#endif

#endif
