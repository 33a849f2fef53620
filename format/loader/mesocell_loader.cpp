#include "mesocell_loader.h"

#define ZSTD_STATIC_LINKING_ONLY  // for a decoder that lives in the arena
#include <zstd.h>

#include <cmath>
#include <cstring>

namespace {

using u8 = uint8_t;
using u32 = uint32_t;
using u64 = uint64_t;

// ---- 2 Conventions

constexpr u32 code(char a, char b, char c, char d) {
  return u32(u8(a)) | u32(u8(b)) << 8 | u32(u8(c)) << 16 | u32(u8(d)) << 24;
}
constexpr u32 kCell = code('C', 'E', 'L', 'L');
constexpr u32 kTypes[8] = {code('G', 'R', 'I', 'D'), code('T', 'I', 'L', 'E'), code('M', 'E', 'M', 'B'),
                           code('C', 'O', 'L', 'R'), code('C', 'C', 'O', 'L'), code('I', 'C', 'O', 'L'),
                           code('N', 'O', 'R', 'M'), code('T', 'E', 'X', 'T')};
enum { kGrid, kTile, kMemb, kColr, kCcol, kIcol, kNorm, kText, kUnknown };
constexpr u32 kNone = 0xffffffff;

u32 get16(const u8* p) { return p[0] | u32(p[1]) << 8; }
u32 get32(const u8* p) { return get16(p) | get16(p + 2) << 16; }
u64 get64(const u8* p) { return get32(p) | u64(get32(p + 4)) << 32; }
double get_f64(const u8* p) {
  const u64 bits = get64(p);
  double v;
  std::memcpy(&v, &bits, sizeof v);
  return v;
}
bool all_zero(const u8* p, u64 count) {
  for (u64 i = 0; i < count; ++i)
    if (p[i] != 0) return false;
  return true;
}
u64 round_up(u64 v, u64 step) { return (v + step - 1) / step * step; }

// 2.4: XXH64, seed 0
constexpr u64 kP1 = 0x9E3779B185EBCA87, kP2 = 0xC2B2AE3D27D4EB4F, kP3 = 0x165667B19E3779F9,
              kP4 = 0x85EBCA77C2B2AE63, kP5 = 0x27D4EB2F165667C5;
u64 rotl(u64 v, int n) { return v << n | v >> (64 - n); }
u64 hash_round(u64 acc, u64 lane) { return rotl(acc + lane * kP2, 31) * kP1; }

u64 hash64(const u8* p, u64 size) {
  const u8* const end = p + size;
  u64 h = kP5;
  if (size >= 32) {
    u64 acc[4] = {kP1 + kP2, kP2, 0, 0 - kP1};
    for (; end - p >= 32; p += 32)
      for (int i = 0; i < 4; ++i) acc[i] = hash_round(acc[i], get64(p + 8 * i));
    h = rotl(acc[0], 1) + rotl(acc[1], 7) + rotl(acc[2], 12) + rotl(acc[3], 18);
    for (int i = 0; i < 4; ++i) h = (h ^ hash_round(0, acc[i])) * kP1 + kP4;
  }
  h += size;
  for (; end - p >= 8; p += 8) h = rotl(h ^ hash_round(0, get64(p)), 27) * kP1 + kP4;
  for (; end - p >= 4; p += 4) h = rotl(h ^ get32(p) * kP1, 23) * kP2 + kP3;
  for (; end - p >= 1; ++p) h = rotl(h ^ *p * kP5, 11) * kP1;
  h = (h ^ h >> 33) * kP2;
  h = (h ^ h >> 29) * kP3;
  return h ^ h >> 32;
}

// ---- State of one call

struct Chunk {
  u32 type;  // 0: the chunk is not in the file
  u32 codec;
  u64 offset, stored, decoded;
};

struct Loader {
  const u8* file;
  u64 size;
  MesocellLimits limits;
  MesocellFault* fault;
  u64 budget = 0;                // what is left of limits.max_decoded_bytes
  Chunk chunks[9]{};             // by kTypes, then the last unknown one
  const Chunk* chunk = nullptr;  // the one that is read
  ZSTD_DCtx* zstd = nullptr;
  MesocellObject* object = nullptr;

  MesocellStatus fail(MesocellStatus status, const char* text, u64 offset) const {
    if (fault) *fault = {text, offset, chunk->type};
    return status;
  }
  MesocellStatus invalid(const char* text, u64 at) const { return fail(kMesocellInvalid, text, at); }
  MesocellStatus bad(const char* text) const { return invalid(text, chunk->offset); }
  MesocellStatus over_limit(const char* text) const { return fail(kMesocellLimit, text, 0); }
  bool charge(u64 count, u64 each) {
    if (count != 0 && each > budget / count) return false;
    budget -= count * each;
    return true;
  }

  MesocellStatus check_container();
  MesocellStatus check_entry(const u8* entry, u64& expected);
  MesocellStatus decode(int index, u8* to);
  MesocellStatus load_grid();
  MesocellStatus load_tile(const u8* bytes, u32* first);
  MesocellStatus check_homes(const u32* first) const;
  MesocellStatus load_membership(const u8* bytes, u32* entries);
  MesocellStatus load_color(const u8* bytes);
  MesocellStatus load_colors(const u8* bytes, u64 count, const uint8_t*& colors);
  bool same_instance(u32 a, u32 b, int dx, int dy, int dz) const;
  u64 count_boundary() const;
  MesocellStatus load_normals(const u8* bytes);
  MesocellStatus load_text(const u8* bytes);
};

// Returns from the calling function unless the step succeeds.
#define MESOCELL_TRY(step) \
  if (const MesocellStatus status_ = (step); status_ != kMesocellOk) return status_

// ---- 3 Container

MesocellStatus Loader::check_container() {
  // 3.1
  chunk = chunks;
  static const u8 magic[8] = {0x89, 0x4D, 0x45, 0x53, 0x4F, 0x0D, 0x0A, 0x1A};
  if (size > limits.max_file_bytes) return over_limit("the file is too large");
  if (size < 64) return invalid("the file is shorter than its header", size);
  if (std::memcmp(file, magic, 8) != 0) return invalid("not a .meso file", 0);
  if (get64(file + 56) != hash64(file, 56)) return invalid("the header is damaged", 56);
  if (get16(file + 8) != 0 || get16(file + 10) != 9) return invalid("unknown version", 8);
  if (get32(file + 12) != kCell) return invalid("unknown representation", 12);
  if (get64(file + 16) != size) return invalid("the file has not the size that its header states", 16);
  const u64 count = get32(file + 24);
  if (count < 1 || count > 1024) return invalid("the number of chunks is not in 1...1024", 24);
  if (get32(file + 28) != 0) return invalid("flags are not zero", 28);
  if (!all_zero(file + 40, 16)) return invalid("reserved bytes are not zero", 40);
  if (count * 64 > size - 64) return invalid("the file ends within the directory", size);
  if (get64(file + 32) != hash64(file + 64, count * 64)) return invalid("the directory is damaged", 32);

  // 3.2 and 3.3
  u64 expected = 64 + 64 * count;
  budget = limits.max_decoded_bytes;
  for (u64 i = 0; i < count; ++i) {
    const u8* entry = file + 64 + 64 * i;
    for (const u8* e = file + 64; e < entry; e += 64)
      if (get32(e) == get32(entry)) return invalid("a chunk type occurs twice", 64 + 64 * i);
    MESOCELL_TRY(check_entry(entry, expected));
  }
  if (expected != size) return invalid("the file goes on after its last chunk", expected);
  for (int required = kGrid; required <= kMemb; ++required)
    if (chunks[required].type == 0) return invalid("a chunk is missing", 64);
  // Once more over all entries: over a limit only if there is no fault in the directory.
  for (u64 i = 0; i < count; ++i)
    if (!charge(1, get64(file + 64 + 64 * i + 32))) return over_limit("the chunks decode to too many bytes");
  return kMesocellOk;
}

MesocellStatus Loader::check_entry(const u8* entry, u64& expected) {
  const u64 at = u64(entry - file);
  const u32 flags = get32(entry + 4);
  int known = kGrid;
  while (known < kUnknown && kTypes[known] != get32(entry)) ++known;
  chunk = &chunks[known];
  chunks[known] = {get32(entry), get32(entry + 8), get64(entry + 16), get64(entry + 24), get64(entry + 32)};
  if (flags > 1) return invalid("unknown chunk flags", at + 4);
  if (chunk->codec > 1) return invalid("unknown codec", at + 8);
  if (get32(entry + 12) != 0 || !all_zero(entry + 48, 16)) return invalid("reserved bytes are not zero", at);
  if (chunk->offset != expected) return invalid("a chunk is not in its place", at + 16);
  if (chunk->codec == 0 ? chunk->decoded != chunk->stored : chunk->decoded / 32768 > chunk->stored)
    return invalid("a chunk cannot decode to so many bytes", at + 32);
  if (chunk->offset > size || chunk->stored > size - chunk->offset)
    return invalid("a chunk reaches beyond the file", at + 24);
  const u64 end = chunk->offset + chunk->stored;
  expected = round_up(end, 64);
  if (expected > size) return invalid("a chunk's padding reaches beyond the file", at + 24);
  if (!all_zero(file + end, expected - end)) return invalid("padding is not zero", end);
  if (hash64(file + chunk->offset, chunk->stored) != get64(entry + 40)) return bad("a chunk is damaged");

  // 4: the chunk types of a cell object
  if (known == kUnknown && flags == 1) return invalid("unknown critical chunk", at);
  if (known != kUnknown && (flags == 1) != (known <= kMemb))
    return invalid("a chunk has the wrong critical flag", at + 4);
  return kMesocellOk;
}

// 3.4: decodes chunk `index` to its decoded bytes at `to`; what follows is about that chunk
MesocellStatus Loader::decode(int index, u8* to) {
  chunk = &chunks[index];
  const u8* from = file + chunk->offset;
  if (chunk->codec == 0) {
    if (chunk->stored > 0) std::memcpy(to, from, chunk->stored);
    return kMesocellOk;
  }
  // A zstd frame's header is 6 to 14 bytes here; a frame that is shorter fails below.
  u8 header[18] = {};
  std::memcpy(header, from, chunk->stored < sizeof header ? chunk->stored : sizeof header);
  const u32 descriptor = header[4], size_flag = descriptor >> 6;
  const bool single = (descriptor & 0x20) != 0;
  if (get32(header) != 0xFD2FB528 || (descriptor & 0x0B) != 0 || (size_flag == 0 && !single))
    return bad("not a zstd frame of the allowed kind");
  const u8* p = header + 5;
  u64 window = 0;
  if (!single) {
    window = u64(1) << (10 + (*p >> 3));
    window += window / 8 * (*p++ & 7);
  }
  const u64 content = size_flag == 0   ? *p
                      : size_flag == 1 ? get16(p) + 256
                      : size_flag == 2 ? get32(p)
                                       : get64(p);
  if (single) window = content;
  if (content != chunk->decoded) return bad("a zstd frame has the wrong content size");
  if (window > u64(1) << 23) return bad("a zstd frame needs too large a window");
  if (ZSTD_findFrameCompressedSize(from, chunk->stored) != chunk->stored)
    return bad("a zstd frame does not fill its chunk");
  const size_t made = zstd ? ZSTD_decompressDCtx(zstd, to, chunk->decoded, from, chunk->stored)
                           : ZSTD_decompress(to, chunk->decoded, from, chunk->stored);
  if (made != chunk->decoded) return bad("a zstd frame does not decode");
  return kMesocellOk;
}

// ---- 4 Cell object

// 4.1
MesocellStatus Loader::load_grid() {
  u8 bytes[64];
  if (chunks[kGrid].decoded != sizeof bytes) return invalid("GRID has not 64 bytes", 64);
  MESOCELL_TRY(decode(kGrid, bytes));
  object->voxel_edge = get_f64(bytes + 24);
  if (!std::isfinite(object->voxel_edge) || !(object->voxel_edge > 0)) return bad("bad voxel edge");
  u64 tiles = 1;
  for (int a = 0; a < 3; ++a) {
    object->box_min[a] = get_f64(bytes + 8 * a);
    object->tiles[a] = get32(bytes + 32 + 4 * a);
    tiles *= object->tiles[a];
    if (!std::isfinite(object->box_min[a])) return bad("box_min is not finite");
    if (tiles < 1 || tiles > 0x7fffffff) return bad("bad number of tiles");
  }
  if (!all_zero(bytes + 44, 20)) return bad("reserved bytes are not zero");
  if (tiles > limits.max_tiles) return over_limit("too many tiles");
  return kMesocellOk;
}

// 4.2. `first` has room for one number a piece and one more.
MesocellStatus Loader::load_tile(const u8* bytes, u32* first) {
  MesocellObject& o = *object;
  if (chunk->decoded < 24) return bad("TILE ends early");
  u64 voxels = 1;
  for (int a = 0; a < 3; ++a) {
    o.resolution[a] = get32(bytes + 4 * a);
    if (o.resolution[a] < 4 || o.resolution[a] > 1024) return bad("bad tile resolution");
    voxels *= o.resolution[a];
  }
  o.cell_count = get32(bytes + 12);
  o.piece_count = get32(bytes + 16);
  o.id_bytes = get32(bytes + 20);
  if (o.cell_count < 1 || o.cell_count > 65535) return bad("bad number of cells");
  if (o.piece_count < o.cell_count || o.piece_count > voxels) return bad("bad number of pieces");
  if (o.id_bytes != (o.piece_count <= 255 ? 1u : o.piece_count <= 65535 ? 2u : 4u))
    return bad("bad size of piece ids");
  const u64 ids_at = 24 + u64(o.piece_count) * 8;
  if (chunk->decoded != ids_at + voxels * o.id_bytes) return bad("TILE has not the size that it should");
  if (!charge(u64(o.piece_count) + 1, 10) || !charge(voxels, o.id_bytes))
    return over_limit("the tile is too large");
  o.pieces = bytes + 24;
  o.voxel_ids = bytes + ids_at;

  u32 last_cell = 0;
  int last_home[3] = {};
  for (u32 id = 1; id <= o.piece_count; ++id) {
    int home[3];
    const u32 cell = mesocell_piece(&o, id, home);
    if (!all_zero(o.pieces + u64(id - 1) * 8 + 5, 3)) return bad("reserved bytes are not zero");
    if (cell < 1 || cell > o.cell_count) return bad("a piece is of no cell");
    if (cell < last_cell) return bad("pieces are not ascending");
    if (cell > last_cell + 1) return bad("a cell has no piece");
    if (cell == last_cell) {
      int order = 0;
      for (int a = 2; a >= 0 && order == 0; --a) order = home[a] - last_home[a];
      if (order <= 0) return bad("pieces are not ascending");
    }
    last_cell = cell;
    std::memcpy(last_home, home, sizeof home);
  }
  if (last_cell != o.cell_count) return bad("a cell has no piece");

  for (u64 id = 0; id <= o.piece_count; ++id) first[id] = kNone;
  for (u64 v = 0; v < voxels; ++v) {
    const u32 id = mesocell_voxel_id(&o, v);
    if (id > o.piece_count) return bad("a voxel is of no piece");
    if (first[id] == kNone) first[id] = u32(v);
  }
  for (u32 id = 1; id <= o.piece_count; ++id)
    if (first[id] == kNone) return bad("a piece has no voxel");
  MESOCELL_TRY(check_homes(first));

  for (int a = 0; a < 3; ++a) {  // 4.1, with the resolution
    const u64 along = u64(o.tiles[a]) * o.resolution[a];
    if (along > u64(1) << 30) return bad("an axis has too many voxels");
    o.box_max[a] = o.box_min[a] + double(along) * o.voxel_edge;
    if (!std::isfinite(o.box_max[a]) || !(o.box_max[a] > o.box_min[a]))
      return bad("the box is not finite or has no extent");
  }
  return kMesocellOk;
}

// 4.2, home rule: of each cell, the first voxel has home (0,0,0)
MesocellStatus Loader::check_homes(const u32* first) const {
  const MesocellObject& o = *object;
  u32 last_cell = 0;
  int64_t best[3] = {};
  bool best_is_home = true;
  for (u32 id = 1; id <= o.piece_count; ++id) {
    int home[3];
    const u32 cell = mesocell_piece(&o, id, home);
    const u32 rx = o.resolution[0], ry = o.resolution[1];
    const int64_t u[3] = {int64_t(first[id] / rx / ry) - int64_t(o.resolution[2]) * home[2],
                          int64_t(first[id] / rx % ry) - int64_t(ry) * home[1],
                          int64_t(first[id] % rx) - int64_t(rx) * home[0]};
    const bool before = u[0] != best[0] ? u[0] < best[0] : u[1] != best[1] ? u[1] < best[1] : u[2] < best[2];
    if (cell != last_cell && !best_is_home) return bad("a cell does not begin in its home tile");
    if (cell != last_cell || before) {
      std::memcpy(best, u, sizeof best);
      best_is_home = home[0] == 0 && home[1] == 0 && home[2] == 0;
    }
    last_cell = cell;
  }
  return best_is_home ? kMesocellOk : bad("a cell does not begin in its home tile");
}

// 4.3. `entries` has room for one number a tile.
MesocellStatus Loader::load_membership(const u8* bytes, u32* entries) {
  MesocellObject& o = *object;
  if (chunk->decoded < 40) return bad("MEMB ends early");
  o.rule = get32(bytes);
  o.inside = get64(bytes + 8);
  o.outside = get64(bytes + 16);
  o.intersected = get64(bytes + 24);
  const u64 run_count = get32(bytes + 32);
  o.mixed_count = get32(bytes + 36);
  o.block_bytes = (o.cell_count + 3) / 4;
  if (o.rule > 1) return bad("unknown membership rule");
  if (get32(bytes + 4) != o.cell_count) return bad("MEMB and TILE differ in the number of cells");
  const u64 tags_at = 40 + run_count * 4;
  if (chunk->decoded != tags_at + u64(o.mixed_count) * o.block_bytes)
    return bad("MEMB has not the size that it should");
  o.tags = bytes + tags_at;
  o.entries = entries;

  const u64 tile_count = u64(o.tiles[0]) * o.tiles[1] * o.tiles[2];
  if (!charge(tile_count, 4) || !charge(o.mixed_count, o.block_bytes)) return over_limit("too many tiles");
  u64 counts[4] = {};  // instances by tag; 3 counts the faulty ones
  u64 tile = 0;
  u32 mixed = 0;
  for (u64 i = 0; i < run_count; ++i) {
    const u32 run = get32(bytes + 40 + 4 * i), state = run & 3, length = run >> 2;
    const u32 previous = i > 0 ? get32(bytes + 36 + 4 * i) : 0;
    if (length < 1) return bad("an empty run");
    if (i > 0 && (previous & 3) == state && previous >> 2 != 0x3fffffff)
      return bad("two runs that should be one");
    if (length > tile_count - tile) return bad("runs cover too many tiles");
    if (state == 3 && length > o.mixed_count - mixed) return bad("too many mixed tiles");
    for (u32 k = 0; k < length; ++k) entries[tile++] = state == 3 ? 3 + mixed++ : state;
    if (state != 3) counts[state] += u64(length) * o.cell_count;
  }
  if (tile != tile_count) return bad("runs cover too few tiles");
  if (mixed != o.mixed_count) return bad("too few mixed tiles");

  for (u64 m = 0; m < o.mixed_count; ++m) {
    const u8* block = o.tags + m * o.block_bytes;
    u32 here[4] = {};
    for (u32 cell = 0; cell < o.cell_count; ++cell) ++here[block[cell / 4] >> 2 * (cell % 4) & 3];
    for (u32 cell = o.cell_count; cell < o.block_bytes * 4; ++cell)
      if ((block[cell / 4] >> 2 * (cell % 4) & 3) != 0) return bad("unused bits are not zero");
    for (int tag = 0; tag < 3; ++tag) {
      if (here[tag] == o.cell_count) return bad("a mixed tile is uniform");
      counts[tag] += here[tag];
    }
    if (here[3] != 0) return bad("a tag has the code 3");
  }
  if (counts[0] != o.outside || counts[1] != o.inside || counts[2] != o.intersected)
    return bad("wrong numbers of instances");
  return kMesocellOk;
}

// 4.4
bool is_utf8(const u8* p, u64 size) {
  for (u64 i = 0; i < size;) {
    const u32 lead = p[i++];
    if (lead < 0x80) continue;
    const u32 more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : 1;
    if (lead < 0xC0 || lead > 0xF7 || more > size - i) return false;
    u32 point = lead & (0x3Fu >> more);
    for (u32 k = 0; k < more; ++k, ++i) {
      if ((p[i] & 0xC0) != 0x80) return false;
      point = point << 6 | (p[i] & 0x3F);
    }
    static const u32 least[4] = {0, 0x80, 0x800, 0x10000};
    if (point < least[more] || point > 0x10FFFF || (point >= 0xD800 && point <= 0xDFFF)) return false;
  }
  return true;
}

MesocellStatus Loader::load_text(const u8* bytes) {
  if (chunk->decoded < 4) return bad("TEXT ends early");
  object->text_count = get32(bytes);
  object->text = bytes + 4;
  object->text_bytes = chunk->decoded - 4;
  const u8* last_key = nullptr;
  u64 last_bytes = 0;
  u64 at = 4;
  for (u64 i = 0; i < object->text_count; ++i) {
    if (chunk->decoded - at < 8) return bad("TEXT ends early");
    const u64 key_bytes = get32(bytes + at), value_bytes = get32(bytes + at + 4);
    at += 8;
    if (key_bytes + value_bytes > chunk->decoded - at) return bad("TEXT ends early");
    if (!charge(1, 64 + key_bytes + value_bytes)) return over_limit("too much text");
    const u8* key = bytes + at;
    if (key_bytes < 1 || key_bytes > 256 || std::memchr(key, 0, key_bytes)) return bad("a bad key");
    if (!is_utf8(key, key_bytes) || !is_utf8(key + key_bytes, value_bytes)) return bad("not UTF-8");
    if (last_key) {
      const int order = std::memcmp(last_key, key, last_bytes < key_bytes ? last_bytes : key_bytes);
      if (order > 0 || (order == 0 && last_bytes >= key_bytes)) return bad("keys are not ascending");
    }
    last_key = key;
    last_bytes = key_bytes;
    at += key_bytes + value_bytes;
  }
  return at == chunk->decoded ? kMesocellOk : bad("TEXT goes on after its last entry");
}

// 4.5
MesocellStatus Loader::load_color(const u8* bytes) {
  if (chunk->decoded < 16) return bad("COLR ends early");
  u64 voxels = 1;
  for (int a = 0; a < 3; ++a) {
    const u32 r = object->color_resolution[a] = get32(bytes + 4 * a);
    if (r < 1 || r > 1024) return bad("bad color resolution");
    voxels *= r;
  }
  if (!all_zero(bytes + 12, 4)) return bad("reserved bytes are not zero");
  if (chunk->decoded != 16 + voxels * 3) return bad("COLR has not the size that it should");
  object->color = bytes + 16;
  return charge(voxels, 3) ? kMesocellOk : over_limit("too many colors");
}

// 4.6 and 4.7
MesocellStatus Loader::load_colors(const u8* bytes, u64 count, const uint8_t*& colors) {
  if (chunk->decoded != count * 3) return bad("a chunk has not as many colors as it should");
  colors = bytes;
  return charge(count, 3) ? kMesocellOk : over_limit("too many colors");
}

// 4.8: whether pieces `a` and `b`, ids or 0, are of one instance if b is in the tile that is (dx, dy, dz)
// further
bool Loader::same_instance(u32 a, u32 b, int dx, int dy, int dz) const {
  if (a == 0 || b == 0 || (dx == 0 && dy == 0 && dz == 0)) return a == b;
  int p[3], q[3];
  if (mesocell_piece(object, a, p) != mesocell_piece(object, b, q)) return false;
  return p[0] == q[0] + dx && p[1] == q[1] + dy && p[2] == q[2] + dz;
}

u64 Loader::count_boundary() const {
  const u32 rx = object->resolution[0], ry = object->resolution[1], rz = object->resolution[2];
  u64 count = 0;
  for (u32 z = 0; z < rz; ++z) {
    for (u32 y = 0; y < ry; ++y) {
      u64 rows[9];  // the first voxels of the rows around this one, and the tiles that those are in
      int dy[9], dz[9];
      for (int k = 0; k < 9; ++k) {
        const int64_t yk = int64_t(y) + k % 3 - 1, zk = int64_t(z) + k / 3 - 1;
        dy[k] = yk < 0 ? -1 : yk >= int64_t(ry) ? 1 : 0;
        dz[k] = zk < 0 ? -1 : zk >= int64_t(rz) ? 1 : 0;
        rows[k] = (u64(zk - dz[k] * int64_t(rz)) * ry + u64(yk - dy[k] * int64_t(ry))) * rx;
      }
      const auto id = [&](u32 x) { return mesocell_voxel_id(object, rows[4] + x); };
      // Whether the nine voxels of this x are of one instance; three such in a row make a voxel inner.
      const auto square = [&](u32 x) {
        const u32 centre = id(x);
        for (int k = 0; k < 9; ++k) {
          const u32 other = mesocell_voxel_id(object, rows[k] + x);
          // Ids in one tile tell all, and most of them are equal.
          const bool apart = dy[k] != 0 || dz[k] != 0;
          if (apart ? !same_instance(centre, other, 0, dy[k], dz[k]) : centre != other) return false;
        }
        return true;
      };
      const bool first = square(0);
      bool before = square(rx - 1), here = first;
      bool same_before = same_instance(id(rx - 1), id(0), 1, 0, 0);
      for (u32 x = 0; x < rx; ++x) {
        const bool last = x + 1 == rx;
        const bool after = last ? first : square(x + 1);
        const bool same_after = same_instance(id(x), id(last ? 0 : x + 1), last ? 1 : 0, 0, 0);
        if (id(x) != 0 && !(before && here && after && same_before && same_after)) ++count;
        before = here;
        here = after;
        same_before = same_after;
      }
    }
  }
  return count;
}

MesocellStatus Loader::load_normals(const u8* bytes) {
  if (!charge(u64(object->resolution[0]) * object->resolution[1], 8) || !charge(chunk->decoded, 1))
    return over_limit("too many normals");
  for (u64 i = 0; i < chunk->decoded; ++i)
    if (bytes[i] > 252) return bad("a byte of a normal is above 252");
  object->normals = bytes;
  object->normal_count = count_boundary();
  if (chunk->decoded != object->normal_count * 2) return bad("NORM has not one normal a boundary voxel");
  return kMesocellOk;
}

// ---- The arena: decoder, chunks but GRID, and a block that first serves TILE and then holds the entries

struct Layout {
  u64 at[kUnknown] = {}, block = 0, total = 0;  // by kTypes; the decoder is at 0 and ends at at[kTile]
};

// False if the arena would not fit in the address space. `tile_count` is 0 while GRID has not been read.
bool lay_out(const Loader& loader, Layout& layout) {
  bool compressed = false;
  for (const Chunk& chunk : loader.chunks) {
    compressed |= chunk.codec == 1;
    if (chunk.decoded > u64(1) << 60) return false;  // so that no sum below overflows
  }
  const MesocellObject& o = *loader.object;
  const u64 tile_count = u64(o.tiles[0]) * o.tiles[1] * o.tiles[2];
  // A piece has 8 bytes of its own and a voxel of at least one byte.
  const u64 most_pieces = loader.chunks[kTile].decoded / 9;
  layout.block = compressed ? round_up(ZSTD_estimateDCtxSize(), 8) : 0;
  for (int i = kTile; i < kUnknown; ++i) {
    layout.at[i] = layout.block;
    layout.block += round_up(loader.chunks[i].decoded, 8);
  }
  layout.total = layout.block + 4 * (tile_count > most_pieces ? tile_count : most_pieces + 1);
  return layout.total <= SIZE_MAX;
}

Loader begin(const void* file, size_t file_bytes, const MesocellLimits* limits, MesocellFault* fault) {
  const MesocellLimits defaults = {u64(1) << 32, u64(1) << 33, u64(1) << 28};
  Loader loader{static_cast<const u8*>(file), file_bytes, limits ? *limits : defaults, fault};
  if (fault) *fault = {nullptr, 0, 0};
  return loader;
}

}  // namespace

MesocellStatus mesocell_arena_bytes(const void* file, size_t file_bytes, const MesocellLimits* limits,
                                    size_t* arena_bytes, MesocellFault* fault) {
  MesocellObject object = {};
  Layout layout;
  Loader loader = begin(file, file_bytes, limits, fault);
  loader.object = &object;
  MESOCELL_TRY(loader.check_container());
  MESOCELL_TRY(loader.load_grid());
  // What mesocell_load() takes from the budget last: an arena over the limit is not even asked for.
  if (!loader.charge(u64(object.tiles[0]) * object.tiles[1] * object.tiles[2], 4))
    return loader.over_limit("too many tiles");
  if (!lay_out(loader, layout)) return loader.over_limit("more than the address space");
  *arena_bytes = size_t(layout.total);
  return kMesocellOk;
}

MesocellStatus mesocell_load(const void* file, size_t file_bytes, const MesocellLimits* limits, void* arena,
                             size_t arena_bytes, MesocellObject* object, MesocellFault* fault) {
  *object = {};
  Layout layout;
  Loader loader = begin(file, file_bytes, limits, fault);
  loader.object = object;
  u8* const base = static_cast<u8*>(arena);
  MESOCELL_TRY(loader.check_container());
  // Without GRID the arena's end is not known, but the decoder's is.
  if (lay_out(loader, layout) && layout.at[kTile] > 0 && layout.at[kTile] <= arena_bytes)
    loader.zstd = ZSTD_initStaticDCtx(base, size_t(layout.at[kTile]));
  MESOCELL_TRY(loader.load_grid());
  if (!lay_out(loader, layout)) return loader.over_limit("more than the address space");
  if (layout.total > arena_bytes) return loader.fail(kMesocellArenaTooSmall, "the arena is too small", 0);

  u32* const block = reinterpret_cast<u32*>(base + layout.block);
  for (int i = kTile; i < kUnknown; ++i) {
    if (loader.chunks[i].type == 0) continue;
    u8* const bytes = base + layout.at[i];
    MESOCELL_TRY(loader.decode(i, bytes));
    MESOCELL_TRY(i == kTile   ? loader.load_tile(bytes, block)
                 : i == kMemb ? loader.load_membership(bytes, block)
                 : i == kColr ? loader.load_color(bytes)
                 : i == kCcol ? loader.load_colors(bytes, object->cell_count, object->cell_colors)
                 : i == kIcol ? loader.load_colors(bytes, object->inside, object->instance_colors)
                 : i == kNorm ? loader.load_normals(bytes)
                              : loader.load_text(bytes));
  }
  return kMesocellOk;
}
