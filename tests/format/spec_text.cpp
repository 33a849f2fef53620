#include "tests/format/spec_text.h"

#include <cstddef>
#include <cstdio>
#include <vector>

#include "tests/format/test_objects.h"

namespace mesocell::test {
namespace {

struct Part {
  const char* title;
  const char* note;
  std::size_t begin, end;
};

/// All of the file, in its order.
constexpr Part kParts[] = {
    {"Header", "magic, 0.9, `CELL`, 640 bytes, 4 chunks; hash of the directory; hash of the header", 0, 64},
    {"Directory: `GRID`", "critical, raw, 64 bytes at 320, hash", 64, 128},
    {"Directory: `TILE`", "critical, raw, 112 bytes at 384, hash", 128, 192},
    {"Directory: `MEMB`", "critical, raw, 49 bytes at 512, hash", 192, 256},
    {"Directory: `TEXT`", "skippable, raw, 20 bytes at 576, hash", 256, 320},
    {"`GRID`", "box_min (0, 0, 0), voxel_edge 0.25, tiles 2 × 1 × 1", 320, 384},
    {"`TILE`, fields", "resolution 4 × 4 × 4, 2 cells, 3 pieces, 1 byte an id", 384, 408},
    {"`TILE`, pieces", "cell 1 at home; cell 2 with home (−1, 0, 0); cell 2 at home", 408, 432},
    {"`TILE`, voxel ids", "a row of four for each y, then z; the upper half is empty", 432, 496},
    {"Padding", "", 496, 512},
    {"`MEMB`, fields", "rule centre, 2 cells; 3 inside, 0 outside, 1 intersected; 2 runs, 1 mixed tile", 512,
     552},
    {"`MEMB`, runs", "1 tile INSIDE, 1 tile mixed", 552, 560},
    {"`MEMB`, tags", "cell 1 INSIDE, cell 2 INTERSECTED", 560, 561},
    {"Padding", "", 561, 576},
    {"`TEXT`", "1 entry, 4 and 4 bytes, `name`, `tiny`", 576, 596},
    {"Padding", "", 596, 640},
};

}  // namespace

std::string walkthrough_markdown() {
  const auto file = encoded(walkthrough_object());
  std::string text;
  for (const Part& part : kParts) {
    text.append("\n**").append(part.title).append("**");
    if (*part.note != '\0') text.append(": ").append(part.note);
    text += "\n\n";
    for (std::size_t at = part.begin; at < part.end; at += 16) {
      char buffer[32];
      std::snprintf(buffer, sizeof buffer, "    %04zx ", at);
      text += buffer;
      for (std::size_t i = at; i < at + 16 && i < part.end; ++i) {
        std::snprintf(buffer, sizeof buffer, " %02x", std::to_integer<unsigned>(file.at(i)));
        text += buffer;
      }
      text += "\n";
    }
  }
  text += "\n";
  return text;
}

}  // namespace mesocell::test
