/* Loads a .meso file with the compact loader alone and walks one ray through its voxels: `loader_alone
 * bunny.meso`. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "format/loader/mesocell_loader.h"

/* The first voxel of an INSIDE instance that the ray origin + t·direction, t >= 0, meets: 1 and cell, home
 * tile, t. */
static int first_hit(const MesocellObject* object, const double origin[3], const double direction[3],
                     uint32_t* cell, uint64_t* home_tile, double* t) {
  double enter = 0, leave = INFINITY;
  for (int a = 0; a < 3; ++a) {
    if (direction[a] == 0) {
      if (origin[a] < object->box_min[a] || origin[a] >= object->box_max[a]) return 0;
      continue;
    }
    const double t0 = (object->box_min[a] - origin[a]) / direction[a];
    const double t1 = (object->box_max[a] - origin[a]) / direction[a];
    enter = fmax(enter, fmin(t0, t1));
    leave = fmin(leave, fmax(t0, t1));
  }
  if (!(enter <= leave)) return 0;

  int64_t voxel[3], voxels[3];
  double next[3], step[3]; /* t of the next face on each axis, and from face to face */
  for (int a = 0; a < 3; ++a) {
    const double d = direction[a] / object->voxel_edge;
    const double at = (origin[a] - object->box_min[a]) / object->voxel_edge;
    voxels[a] = (int64_t)object->tiles[a] * object->resolution[a];
    voxel[a] = (int64_t)floor(at + enter * d);
    if (voxel[a] < 0) voxel[a] = 0;
    if (voxel[a] >= voxels[a]) voxel[a] = voxels[a] - 1;
    step[a] = d == 0 ? INFINITY : 1 / fabs(d);
    next[a] = d == 0 ? INFINITY : ((double)(voxel[a] + (d > 0)) - at) / d;
  }
  for (*t = enter;;) {
    int64_t tile[3];
    uint64_t index = 0;
    for (int a = 2; a >= 0; --a) {
      tile[a] = voxel[a] / object->resolution[a];
      index = index * object->resolution[a] + (uint64_t)(voxel[a] % object->resolution[a]);
    }
    const uint32_t piece = mesocell_voxel_id(object, index);
    if (piece) {
      int home[3], in_grid = 1;
      *cell = mesocell_piece(object, piece, home);
      *home_tile = 0;
      for (int a = 2; a >= 0; --a) {
        const int64_t h = tile[a] + home[a];
        in_grid &= h >= 0 && h < object->tiles[a];
        *home_tile = *home_tile * object->tiles[a] + (uint64_t)h;
      }
      if (in_grid && mesocell_tag(object, *home_tile, *cell) == 1) return 1;
    }
    const int a = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    *t = next[a];
    next[a] += step[a];
    voxel[a] += direction[a] > 0 ? 1 : -1;
    if (voxel[a] < 0 || voxel[a] >= voxels[a]) return 0;
  }
}

int main(int argc, char** argv) {
  static unsigned char file[1 << 24]; /* an engine reads or maps the file as it likes */
  FILE* in = fopen(argc > 1 ? argv[1] : "bunny.meso", "rb");
  if (!in) return perror(argc > 1 ? argv[1] : "bunny.meso"), 3;
  const size_t size = fread(file, 1, sizeof file, in);
  fclose(in);

  size_t need = 0;
  MesocellObject object;
  MesocellFault fault = {0};
  MesocellStatus status = mesocell_arena_bytes(file, size, 0, NULL, &need, &fault);
  void* arena = status == kMesocellOk ? malloc(need) : NULL;
  if (arena) status = mesocell_load(file, size, 0, NULL, arena, need, &object, &fault);
  if (!arena || status != kMesocellOk)
    return fprintf(stderr, "%s\n", fault.text ? fault.text : "no memory"), free(arena), 3;

  double origin[3], diagonal = 0;
  const double direction[3] = {0, 0, -1};
  for (int a = 0; a < 3; ++a) diagonal += pow(object.box_max[a] - object.box_min[a], 2);
  for (int a = 0; a < 3; ++a)
    origin[a] = (object.box_min[a] + object.box_max[a]) / 2 - direction[a] * 2 * sqrt(diagonal);
  uint32_t cell;
  uint64_t tile;
  double t;
  if (first_hit(&object, origin, direction, &cell, &tile, &t))
    printf("cell %u of tile %llu at %g m\n", cell, (unsigned long long)tile, t);
  else
    puts("no hit");
  free(arena);
  return 0;
}
