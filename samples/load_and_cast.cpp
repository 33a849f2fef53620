// Loads a .meso file and casts one ray at it: `load_and_cast bunny.meso`.
#include <cstdio>

#include "format/cell_object_io.h"
#include "format/file.h"
#include "sdk/trace/cell_object_caster.h"

int main(int argc, char** argv) {
  using namespace mesocell;
  const auto bytes = read_file(argc > 1 ? argv[1] : "bunny.meso", ReadLimits{}.max_file_bytes);
  if (!bytes) return std::fprintf(stderr, "%s\n", bytes.error().message.c_str()), 3;
  const auto object = read_cell_object(*bytes);  // any bytes: an object or a typed error
  if (!object) return std::fprintf(stderr, "%s\n", object.error().message.c_str()), 3;
  const auto caster = make_cell_object_caster(*object, "exact");
  const Box3 box = (*caster)->object_box();
  const Vec3 centre = (box.min + box.max) * 0.5, direction{0, 0, -1};
  Hit hit;
  if ((*caster)->first_hit({centre - direction * (2 * length(box.extent())), direction}, hit))
    std::printf("cell %u of tile %lld at %g m\n", hit.label, static_cast<long long>(hit.instance), hit.t);
  else
    std::puts("no hit");
}
