// The compact loader as the suite asks it, and nothing else of the library. What goes into the digest is made
// of the loaded object; of the file itself only the order of the chunks is taken.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "format/loader/mesocell_loader.h"
#include "tests/conformance/protocol.h"

namespace {

using Bytes = std::vector<unsigned char>;

struct Writer {
  Bytes bytes;
  void number(std::uint64_t v, int count) {
    for (int i = 0; i < count; ++i) bytes.push_back(static_cast<unsigned char>(v >> (8 * i) & 0xff));
  }
  void real(float v) { number(std::bit_cast<std::uint32_t>(v), 4); }
  void real(double v) { number(std::bit_cast<std::uint64_t>(v), 8); }
  void append(const void* data, std::uint64_t count) {
    const auto* p = static_cast<const unsigned char*>(data);
    bytes.insert(bytes.end(), p, p + count);
  }
  void pad(std::size_t begin) {
    while ((bytes.size() - begin) % 64 != 0) bytes.push_back(0);
  }
};

void write_grid(const MesocellObject& o, Writer& out) {
  const std::size_t begin = out.bytes.size();
  for (const double v : o.box_min) out.real(v);
  out.real(o.voxel_edge);
  for (const std::uint32_t n : o.tiles) out.number(n, 4);
  out.pad(begin);
}

void write_tile(const MesocellObject& o, Writer& out) {
  const std::size_t begin = out.bytes.size();
  std::uint64_t voxels = 1;
  for (const std::uint32_t r : o.resolution) {
    out.number(r, 4);
    voxels *= r;
  }
  out.number(o.cell_count, 4);
  out.number(o.piece_count, 4);
  out.number(o.id_bytes, 4);
  out.pad(begin);
  for (std::uint32_t id = 1; id <= o.piece_count; ++id) {
    int home[3];
    out.number(mesocell_piece(&o, id, home), 2);
    for (const int h : home) out.number(static_cast<std::uint64_t>(h), 1);
    out.number(0, 3);
  }
  out.pad(begin);
  for (std::uint64_t v = 0; v < voxels; ++v) out.number(mesocell_voxel_id(&o, v), int(o.id_bytes));
}

void write_membership(const MesocellObject& o, Writer& out) {
  const std::size_t begin = out.bytes.size();
  out.number(o.rule, 4);
  out.number(o.cell_count, 4);
  out.number(o.inside, 8);
  out.number(o.outside, 8);
  out.number(o.intersected, 8);
  out.number(o.mixed_count, 4);
  out.pad(begin);
  const std::uint64_t tiles = std::uint64_t{o.tiles[0]} * o.tiles[1] * o.tiles[2];
  std::vector<std::uint32_t> ranks;
  std::uint32_t mixed = 0;
  unsigned four = 0;
  for (std::uint64_t t = 0; t < tiles; ++t) {
    if (t % 4096 == 0) ranks.push_back(mixed);
    const std::uint32_t state = o.entries[t] < 3 ? o.entries[t] : 3;
    mixed += state == 3;
    four |= state << 2 * (t % 4);
    if (t % 4 != 3 && t + 1 != tiles) continue;
    out.number(four, 1);
    four = 0;
  }
  out.pad(begin);
  for (const std::uint32_t rank : ranks) out.number(rank, 4);
  out.pad(begin);
  // Tag by tag, as a caller sees them.
  for (std::uint64_t t = 0; t < tiles; ++t) {
    if (o.entries[t] < 3) continue;
    for (std::uint32_t cell = 1; cell <= o.cell_count; ++cell) {
      four |= mesocell_tag(&o, t, cell) << 2 * ((cell - 1) % 4);
      if (cell % 4 != 0 && cell != o.cell_count) continue;
      out.number(four, 1);
      four = 0;
    }
  }
}

void write_colors(float error, const std::uint8_t* colors, std::uint64_t count, Writer& out) {
  const std::size_t begin = out.bytes.size();
  out.real(error);
  out.pad(begin);
  out.append(colors, 3 * count);
}

/// The colors of a tile, null where there is none, color voxel by color voxel as a caller finds them.
std::vector<const std::uint8_t*> surface_colors(const MesocellObject& o, std::uint64_t tile) {
  const std::uint32_t* const r = o.surface_resolution;
  std::vector<const std::uint8_t*> colors;
  for (std::uint32_t c = 0; c < r[0] * r[1] * r[2]; ++c) {
    const std::uint32_t at[3] = {c % r[0], c / r[0] % r[1], c / r[0] / r[1]};
    std::uint32_t voxel[3] = {};  // the first of which it is the color
    for (int a = 0; a < 3; ++a)
      while ((2 * voxel[a] + 1) * r[a] / (2 * o.resolution[a]) < at[a]) ++voxel[a];
    colors.push_back(mesocell_surface_color(&o, tile, voxel));
  }
  return colors;
}

void write_differences(const std::uint32_t r[3], const std::vector<const std::uint8_t*>& colors,
                       Writer& out) {
  const std::uint8_t black[3] = {};
  const std::uint8_t* before = black;
  for (std::size_t c = 0; c < colors.size(); ++c) {
    if (!colors[c]) continue;
    std::vector<const std::uint8_t*> near;
    const auto look = [&](bool there, std::size_t back) {
      if (there && colors[c - back]) near.push_back(colors[c - back]);
    };
    look(c % r[0] > 0, 1);
    look(c / r[0] % r[1] > 0, r[0]);
    look(c / r[0] / r[1] > 0, std::size_t{r[0]} * r[1]);
    for (int channel = 0; channel < 3; ++channel) {
      unsigned sum = 0;
      for (const std::uint8_t* n : near) sum += n[channel];
      const unsigned predicted = near.empty() ? before[channel] : sum / unsigned(near.size());
      out.number((colors[c][channel] - predicted) & 255, 1);
    }
    before = colors[c];
  }
}

void write_surface_colors(const MesocellObject& o, Writer& out) {
  const std::size_t begin = out.bytes.size();
  for (const std::uint32_t r : o.surface_resolution) out.number(r, 4);
  out.real(o.surface_color_error);
  out.number(o.surface_brick_count, 4);
  out.number(o.surface_color_count, 4);
  out.pad(begin);
  Writer ranks, masks, differences;
  std::uint32_t bricks = 0, count = 0;
  unsigned eight = 0;
  const std::uint64_t tiles = std::uint64_t{o.tiles[0]} * o.tiles[1] * o.tiles[2];
  for (std::uint64_t tile = 0; tile < tiles; ++tile) {
    if (tile % 4096 == 0) {
      ranks.number(bricks, 4);
      ranks.number(count, 4);
    }
    if (o.surface_bricks[tile] != 0xffffffff) {
      ++bricks;
      eight |= 1u << tile % 8;
      const auto colors = surface_colors(o, tile);
      unsigned bits = 0;
      for (std::size_t c = 0; c < colors.size(); ++c) {
        count += colors[c] != nullptr;
        bits |= (colors[c] ? 1u : 0u) << c % 8;
        if (c % 8 != 7 && c + 1 != colors.size()) continue;
        masks.number(bits, 1);
        bits = 0;
      }
      write_differences(o.surface_resolution, colors, differences);
    }
    if (tile % 8 != 7 && tile + 1 != tiles) continue;
    out.number(eight, 1);
    eight = 0;
  }
  for (const Writer* part : {&ranks, &masks, &differences}) {
    out.pad(begin);
    out.append(part->bytes.data(), part->bytes.size());
  }
}

void write_chunk(const MesocellObject& o, std::string_view type, Writer& out) {
  const std::size_t begin = out.bytes.size() + 4;
  out.append(type.data(), 4);
  if (type == "GRID") write_grid(o, out);
  if (type == "TILE") write_tile(o, out);
  if (type == "MEMB") write_membership(o, out);
  if (type == "CCOL") write_colors(o.cell_color_error, o.cell_colors, o.cell_count, out);
  if (type == "ICOL") write_colors(o.instance_color_error, o.instance_colors, o.inside, out);
  if (type == "COLR") {
    std::uint64_t voxels = 1;
    for (const std::uint32_t r : o.color_resolution) {
      out.number(r, 4);
      voxels *= r;
    }
    out.real(o.color_error);
    out.pad(begin);
    out.append(o.color, 3 * voxels);
  }
  if (type == "NORM") {
    out.number(0, 4);
    out.real(o.normal_error);
    out.pad(begin);
    out.append(o.normals, 2 * o.normal_count);
  }
  if (type == "MESH") {
    out.number(0, 4);
    out.real(o.mesh_error);
    out.number(o.mesh_bytes, 8);
    out.number(o.mesh_vertices, 4);
    out.number(o.mesh_triangles, 4);
    out.pad(begin);
    out.append(o.mesh, o.mesh_bytes);
  }
  if (type == "SCOL") write_surface_colors(o, out);
  if (type == "TEXT") {
    out.number(o.text_count, 4);
    std::uint64_t cursor = 0;
    const char *key = nullptr, *value = nullptr;
    std::uint32_t key_bytes = 0, value_bytes = 0;
    while (mesocell_next_text(&o, &cursor, &key, &key_bytes, &value, &value_bytes) != 0) {
      out.number(key_bytes, 4);
      out.number(value_bytes, 4);
      out.append(key, key_bytes);
      out.append(value, value_bytes);
    }
  }
}

bool is_known(std::string_view type, unsigned minor) {
  if (type == "MESH" || type == "SCOL") return minor > 0;
  for (const char* known : {"GRID", "TILE", "MEMB", "COLR", "CCOL", "ICOL", "NORM", "TEXT"})
    if (type == known) return true;
  return false;
}

std::uint32_t number_at(const char* p) {
  std::uint32_t v = 0;
  for (int i = 0; i < 4; ++i) v |= std::uint32_t(static_cast<unsigned char>(p[i])) << (8 * i);
  return v;
}

std::string refusal(MesocellStatus status) { return status == kMesocellLimit ? "limit" : "invalid"; }

std::string answer(const std::vector<char>& file) {
  MesocellFile info = {};
  if (const MesocellStatus s = mesocell_open(file.data(), file.size(), nullptr, &info, nullptr);
      s != kMesocellOk)
    return refusal(s);
  Writer out;
  const char* entry = file.data() + 64 + 64 * std::size_t{info.asset_count};
  for (std::uint32_t asset = 0; asset < info.asset_count; ++asset) {
    std::size_t need = 0;
    MesocellStatus status = mesocell_arena_bytes(file.data(), file.size(), asset, nullptr, &need, nullptr);
    if (status != kMesocellOk) return refusal(status);
    const std::unique_ptr<void, void (*)(void*)> arena(std::malloc(need), std::free);
    if (!arena) return "limit";
    MesocellObject object;
    status = mesocell_load(file.data(), file.size(), asset, nullptr, arena.get(), need, &object, nullptr);
    if (status != kMesocellOk) return refusal(status);
    const std::uint32_t chunks = number_at(file.data() + 64 + 64 * std::size_t{asset} + 8);
    for (std::uint32_t i = 0; i < chunks; ++i, entry += 64)
      if (is_known({entry, 4}, info.minor)) write_chunk(object, {entry, 4}, out);
  }
  char digest[17];
  std::snprintf(digest, sizeof digest, "%016llx",
                static_cast<unsigned long long>(XXH64(out.bytes.data(), out.bytes.size(), 0)));
  return "valid " + std::string(digest);
}

}  // namespace

int main() { return mesocell::conformance::serve(answer); }
