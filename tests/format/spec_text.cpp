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
    {"Header", "magic, 1.0, 1 asset, 960 bytes, 4 chunks; hash of the tables; hash of the header", 0, 64},
    {"Asset table", "`CELL`, no flags, 4 chunks, no name", 64, 128},
    {"Directory: `GRID`", "critical, raw, blocks of 1 MiB, at 384 with 64 bytes, hash", 128, 192},
    {"Directory: `TILE`", "critical, raw, blocks of 1 MiB, at 448 with 192 bytes, hash", 192, 256},
    {"Directory: `MEMB`", "critical, raw, blocks of 256 KiB, at 640 with 193 bytes, hash", 256, 320},
    {"Directory: `TEXT`", "skippable, raw, blocks of 1 MiB, at 896 with 20 bytes, hash", 320, 384},
    {"`GRID`", "box_min (0, 0, 0), voxel_edge 0.25, tiles 2 × 1 × 1", 384, 448},
    {"`TILE`, header", "resolution 4 × 4 × 4, 2 cells, 3 pieces, 1 byte an id", 448, 512},
    {"`TILE`, pieces", "cell 1 at home; cell 2 with home (−1, 0, 0); cell 2 at home", 512, 536},
    {"`TILE`, to the next part", "", 536, 576},
    {"`TILE`, voxel ids", "a row of four for each y, then z; the upper half is empty", 576, 640},
    {"`MEMB`, header", "rule centre, 2 cells; 3 inside, 0 outside, 1 intersected; 1 mixed tile", 640, 704},
    {"`MEMB`, states", "1 tile INSIDE, 1 tile mixed; to the next part", 704, 768},
    {"`MEMB`, ranks", "no mixed tile before the first page; to the next part", 768, 832},
    {"`MEMB`, tags", "of the mixed tile: cell 1 INSIDE, cell 2 INTERSECTED", 832, 833},
    {"Padding", "", 833, 896},
    {"`TEXT`", "1 entry, 4 and 4 bytes, `name`, `tiny`", 896, 916},
    {"Padding", "", 916, 960},
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
