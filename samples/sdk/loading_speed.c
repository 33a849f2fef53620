/* Tells which assets are in a .meso file, by the compact loader alone, and how fast each loads from memory:
 * `loading_speed FILE.meso [TIMES]`. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "format/loader/mesocell_loader.h"

static void* read_file(const char* path, size_t* size) {
  FILE* file = fopen(path, "rb");
  void* bytes = NULL;
  if (!file) return NULL;
  if (fseek(file, 0, SEEK_END) == 0) {
    const long end = ftell(file);
    *size = end > 0 ? (size_t)end : 0;
    bytes = malloc(*size + 1);
    if (bytes && (fseek(file, 0, SEEK_SET) != 0 || fread(bytes, 1, *size, file) != *size)) {
      free(bytes);
      bytes = NULL;
    }
  }
  fclose(file);
  return bytes;
}

static double seconds(void) {
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int refuse(const char* path, const char* text) {
  fprintf(stderr, "%s: %s\n", path, text);
  return 3;
}

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    fprintf(stderr, "usage: loading_speed FILE.meso [TIMES]\n");
    return 2;
  }
  const int times = argc == 3 && atoi(argv[2]) > 0 ? atoi(argv[2]) : 1;
  size_t size = 0;
  void* file = read_file(argv[1], &size);
  if (!file) return refuse(argv[1], "it cannot be read");
  MesocellFile info;
  MesocellFault fault;
  if (mesocell_open(file, size, NULL, &info, &fault) != kMesocellOk) return refuse(argv[1], fault.text);
  for (uint32_t asset = 0; asset < info.asset_count; ++asset) {
    char name[41];
    size_t need = 0;
    mesocell_asset_name(file, asset, name);
    if (mesocell_arena_bytes(file, size, asset, NULL, &need, &fault) != kMesocellOk)
      return refuse(argv[1], fault.text);
    void* arena = malloc(need);
    if (!arena) return refuse(argv[1], "there is not enough memory");
    MesocellObject o;
    double least = 1e9;
    for (int i = 0; i < times; ++i) {
      const double begin = seconds();
      if (mesocell_load(file, size, asset, NULL, arena, need, &o, &fault) != kMesocellOk)
        return refuse(argv[1], fault.text);
      if (seconds() - begin < least) least = seconds() - begin;
    }
    /* Tags of each tile, voxels and normals; colors come on top. */
    const double bytes = 4.0 * o.tiles[0] * o.tiles[1] * o.tiles[2] + (double)o.mixed_count * o.tag_bytes +
                         (double)o.id_bytes * o.resolution[0] * o.resolution[1] * o.resolution[2] +
                         2.0 * (double)o.normal_count;
    printf("asset %u '%s': %u cells, %llu instances inside; %.3f ms, %.2f GB/s, arena %.2f MB\n", asset, name,
           o.cell_count, (unsigned long long)o.inside, 1e3 * least, 1e-9 * bytes / least,
           1e-6 * (double)need);
    free(arena);
  }
  free(file);
  return 0;
}
