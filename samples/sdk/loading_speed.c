/* Tells what is in a .meso file by the compact loader alone, and how fast its first asset loads from memory:
 * `loading_speed FILE.meso [TIMES]`. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "format/loader/mesocell_loader.h"

static void* read_file(const char* path, size_t* size) {
  FILE* file = fopen(path, "rb");
  void* bytes = NULL;
  long end;
  if (!file) return NULL;
  if (fseek(file, 0, SEEK_END) == 0 && (end = ftell(file)) >= 0 && fseek(file, 0, SEEK_SET) == 0) {
    *size = (size_t)end;
    bytes = malloc(*size + 1);
    if (bytes && fread(bytes, 1, *size, file) != *size) {
      free(bytes);
      bytes = NULL;
    }
  }
  fclose(file);
  return bytes;
}

static int refuse(const char* path, const MesocellFault* fault) {
  fprintf(stderr, "%s: %s (byte %llu)\n", path, fault->text, (unsigned long long)fault->offset);
  return 3;
}

static double seconds(void) {
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Bytes that the object's maps take. */
static double map_bytes(const MesocellObject* o) {
  const double voxels = (double)o->resolution[0] * o->resolution[1] * o->resolution[2];
  const double colors = (double)o->color_resolution[0] * o->color_resolution[1] * o->color_resolution[2];
  const double tiles = (double)o->tiles[0] * o->tiles[1] * o->tiles[2];
  return voxels * o->id_bytes + 8.0 * o->piece_count + 4 * tiles + (double)o->mixed_count * o->tag_bytes +
         3 * colors + (o->cell_colors ? 3.0 * o->cell_count : 0) +
         (o->instance_colors ? 3.0 * (double)o->inside : 0) + 2.0 * (double)o->normal_count +
         (double)o->text_bytes;
}

int main(int argc, char** argv) {
  size_t size = 0, need = 0;
  MesocellFile info;
  MesocellFault fault;
  MesocellObject object;
  void *file, *arena = NULL;
  uint32_t i;
  if (argc < 2 || argc > 3) {
    fprintf(stderr, "usage: loading_speed FILE.meso [TIMES]\n");
    return 2;
  }
  file = read_file(argv[1], &size);
  if (!file) {
    fprintf(stderr, "%s: it cannot be read\n", argv[1]);
    return 3;
  }
  if (mesocell_open(file, size, NULL, &info, &fault) != kMesocellOk) return refuse(argv[1], &fault);
  for (i = 0; i < info.asset_count; ++i) {
    char name[41];
    uint64_t cursor = 0;
    const char *key, *value;
    uint32_t key_bytes, value_bytes;
    mesocell_asset_name(file, i, name);
    if (mesocell_arena_bytes(file, size, i, NULL, &need, &fault) != kMesocellOk) return refuse(argv[1], &fault);
    free(arena);
    arena = malloc(need);
    if (!arena) return 5;
    if (mesocell_load(file, size, i, NULL, arena, need, &object, &fault) != kMesocellOk)
      return refuse(argv[1], &fault);
    printf("asset %u '%s': %u x %u x %u tiles of %u x %u x %u voxels, %u cells, %llu instances inside, arena %zu\n",
           i, name, object.tiles[0], object.tiles[1], object.tiles[2], object.resolution[0], object.resolution[1],
           object.resolution[2], object.cell_count, (unsigned long long)object.inside, need);
    while (mesocell_next_text(&object, &cursor, &key, &key_bytes, &value, &value_bytes))
      printf("  %.*s: %.*s\n", (int)key_bytes, key, (int)value_bytes, value);
  }
  if (argc == 3) {
    const int times = atoi(argv[2]) > 0 ? atoi(argv[2]) : 1;
    double best = 1e9;
    int k;
    if (mesocell_arena_bytes(file, size, 0, NULL, &need, &fault) != kMesocellOk) return refuse(argv[1], &fault);
    free(arena);
    arena = malloc(need);
    if (!arena) return 5;
    for (k = 0; k < times; ++k) {
      const double begin = seconds();
      if (mesocell_load(file, size, 0, NULL, arena, need, &object, &fault) != kMesocellOk)
        return refuse(argv[1], &fault);
      if (seconds() - begin < best) best = seconds() - begin;
    }
    printf("least of %d: %.3f ms, %.2f GB/s of %.0f bytes\n", times, 1e3 * best, 1e-9 * map_bytes(&object) / best,
           map_bytes(&object));
  }
  free(arena);
  free(file);
  return 0;
}
