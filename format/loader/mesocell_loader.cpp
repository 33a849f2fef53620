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
constexpr u32 kTypes[10] = {code('G', 'R', 'I', 'D'), code('T', 'I', 'L', 'E'), code('M', 'E', 'M', 'B'),
                            code('C', 'O', 'L', 'R'), code('C', 'C', 'O', 'L'), code('I', 'C', 'O', 'L'),
                            code('N', 'O', 'R', 'M'), code('T', 'E', 'X', 'T'), code('M', 'E', 'S', 'H'),
                            code('S', 'C', 'O', 'L')};
enum { kGrid, kTile, kMemb, kColr, kCcol, kIcol, kNorm, kText, kMesh, kScol, kUnknown };
constexpr u32 kNone = 0xffffffff;

inline u32 get16(const u8* p) { return p[0] | u32(p[1]) << 8; }
inline u32 get32(const u8* p) { return get16(p) | get16(p + 2) << 16; }
inline u64 get64(const u8* p) { return get32(p) | u64(get32(p + 4)) << 32; }
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

u32 bit_count(u32 byte) {
  byte -= byte >> 1 & 0x55;
  byte = (byte & 0x33) + (byte >> 2 & 0x33);
  return (byte + (byte >> 4)) & 0x0F;
}

// ---- State of one call

struct Chunk {
  bool there, critical;
  u32 type, codec, block;
  u64 offset, stored, decoded, hash;
  const u8* bytes;  // decoded; null until load_chunk()
  u64 blocks() const { return decoded / block + (decoded % block != 0); }
  u64 block_size(u64 b) const { return decoded - b * block < block ? decoded - b * block : block; }
  u64 data_at() const { return blocks() > 1 ? round_up(blocks() * 16, 64) : 0; }
};

struct Rows;

struct Loader {
  const u8* file;
  u64 size;
  MesocellOptions options;
  MesocellFault* fault;
  u32 minor = 0, asset_count = 0, chunk_count = 0;
  u64 directory = 0;         // where it begins
  u64 budget = 0;            // what is left of options.max_decoded_bytes
  Chunk chunks[kUnknown]{};  // of the asset, by kTypes
  u32 fault_chunk = 0;       // the chunk that is looked at
  u64 fault_at = 0;          // and where it is
  ZSTD_DCtx* zstd = nullptr;
  MesocellObject* object = nullptr;

  MesocellStatus fail(MesocellStatus status, const char* text, u64 offset) const {
    if (fault) *fault = {text, offset, fault_chunk};
    return status;
  }
  MesocellStatus invalid(const char* text, u64 at) const { return fail(kMesocellInvalid, text, at); }
  MesocellStatus bad(const char* text) const { return invalid(text, fault_at); }
  MesocellStatus over_limit(const char* text) const { return fail(kMesocellLimit, text, 0); }
  bool charge(u64 count, u64 each) {
    if (count != 0 && each > budget / count) return false;
    budget -= count * each;
    return true;
  }
  bool reserved(u64 at, u64 count) const { return all_zero(file + at, count); }
  bool ignorable(u64 at, u64 count) const { return minor > 1 || all_zero(file + at, count); }

  MesocellStatus check_header();
  MesocellStatus check_assets(bool names) const;
  MesocellStatus check_directory() const;
  MesocellStatus check_entry(u64 at, u64& expected) const;
  MesocellStatus check_block(const Chunk& chunk, u64 b, u64 stored) const;
  MesocellStatus open(bool names);
  MesocellStatus find_chunks(u32 asset);
  MesocellStatus verify(const Chunk& chunk) const;
  MesocellStatus decode_block(const u8* from, u64 stored, u8* to, u64 decoded) const;
  MesocellStatus load_chunk(Chunk& chunk, u8* to);
  MesocellStatus header(const Chunk& chunk, u64 fields) const;
  MesocellStatus stated_error(const u8* bytes, float& error) const;
  MesocellStatus load_grid();
  MesocellStatus load_tile(const Chunk& chunk, u32* first);
  MesocellStatus check_pieces() const;
  MesocellStatus check_homes(const u32* first) const;
  MesocellStatus load_membership(const Chunk& chunk, u32* entries);
  MesocellStatus check_tags(u64 counts[4]) const;
  MesocellStatus load_color(const Chunk& chunk);
  MesocellStatus load_colors(const Chunk& chunk, u64 count, const uint8_t*& colors, float& error);
  bool same_instance(u32 a, u32 b, int dx, int dy, int dz) const;
  u64 count_boundary_between(const Rows& rows, u32 begin, u32 end) const;
  u64 count_boundary_within(const Rows& rows) const;
  u64 count_boundary() const;
  MesocellStatus load_normals(const Chunk& chunk);
  MesocellStatus load_text(const Chunk& chunk);
  MesocellStatus load_mesh(const Chunk& chunk);
  MesocellStatus load_surface_colors(const Chunk& chunk, u8* bytes, u32* bricks, u32* first);
  MesocellStatus check_surface_masks(const Chunk& chunk, u64 masks_end, u32* first) const;
  void undo_differences(u8* color) const;
};

// Returns from the calling function unless the step succeeds.
#define MESOCELL_TRY(step) \
  if (const MesocellStatus status_ = (step); status_ != kMesocellOk) return status_

Chunk read_entry(const u8* p) {
  Chunk c = {};
  c.there = true;
  c.critical = (p[4] & 1) != 0;
  c.type = get32(p), c.codec = get32(p + 8), c.block = get32(p + 12);
  c.offset = get64(p + 16), c.stored = get64(p + 24), c.decoded = get64(p + 32), c.hash = get64(p + 40);
  return c;
}

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
    const u32 shorter = more == 1 ? 7 : 5 * more + 1;  // bits that fit in a shorter form
    if (point >> shorter == 0 || point > 0x10FFFF || (point >= 0xD800 && point <= 0xDFFF)) return false;
  }
  return true;
}

// ---- 3 Container

// 3.1
MesocellStatus Loader::check_header() {
  static const u8 magic[8] = {0x89, 0x4D, 0x45, 0x53, 0x4F, 0x0D, 0x0A, 0x1A};
  if (size > options.max_file_bytes) return over_limit("the file is too large");
  if (size < 64) return invalid("the file is shorter than its header", size);
  if (std::memcmp(file, magic, 8) != 0) return invalid("not a .meso file", 0);
  if (get64(file + 56) != hash64(file, 56)) return invalid("the header is damaged", 56);
  if (get16(file + 8) != 1) return invalid("unknown version", 8);
  minor = get16(file + 10);
  asset_count = get32(file + 12);
  chunk_count = get32(file + 24);
  if (get64(file + 16) != size) return invalid("the file has not the size that its header states", 16);
  if (asset_count < 1 || asset_count > 1024) return invalid("the number of assets is not in 1...1024", 12);
  if (chunk_count < 1 || chunk_count > 4096) return invalid("the number of chunks is not in 1...4096", 24);
  if (!reserved(28, 4) || !reserved(40, 8) || !ignorable(48, 8))
    return invalid("reserved bits are not zero", 28);
  directory = 64 + 64 * u64(asset_count);
  const u64 tables = 64 * (u64(asset_count) + chunk_count);
  if (tables > size - 64) return invalid("the file ends within its tables", size);
  if (get64(file + 32) != hash64(file + 64, tables)) return invalid("the tables are damaged", 32);
  return kMesocellOk;
}

// 3.2
MesocellStatus Loader::check_assets(bool names) const {
  u64 sum = 0;
  for (u32 i = 0; i < asset_count; ++i) {
    const u64 at = 64 + 64 * u64(i);
    const u8* name = file + at + 16;
    u64 name_bytes = 0;
    while (name_bytes < 40 && name[name_bytes] != 0) ++name_bytes;
    if (get16(file + at + 4) != 0) return invalid("unknown asset flags", at + 4);
    if (!ignorable(at + 6, 2) || !reserved(at + 12, 4) || !ignorable(at + 56, 8))
      return invalid("reserved bytes are not zero", at);
    if (!all_zero(name + name_bytes, 40 - name_bytes) || !is_utf8(name, name_bytes))
      return invalid("a bad name of an asset", at + 16);
    // Not again for every asset that is loaded: of a thousand, that would take seconds.
    for (u64 other = 64; names && name_bytes > 0 && other < at; other += 64)
      if (std::memcmp(file + other + 16, name, 40) == 0) return invalid("two assets have one name", at + 16);
    if (get32(file + at + 8) < 1) return invalid("an asset has no chunk", at + 8);
    sum += get32(file + at + 8);
  }
  return sum == chunk_count ? kMesocellOk : invalid("the assets have not the chunks of the directory", 64);
}

// 3.3 to 3.5, all but what is in the chunks
MesocellStatus Loader::check_directory() const {
  u64 expected = directory + 64 * u64(chunk_count);
  for (u32 i = 0; i < chunk_count; ++i) MESOCELL_TRY(check_entry(directory + 64 * u64(i), expected));
  return expected == size ? kMesocellOk : invalid("the file goes on after its last chunk", expected);
}

MesocellStatus Loader::check_entry(u64 at, u64& expected) const {
  const Chunk c = read_entry(file + at);
  if ((get16(file + at + 4) & 0xFFFE) != 0) return invalid("unknown chunk flags", at + 4);
  if (!ignorable(at + 6, 2) || !reserved(at + 48, 8) || !ignorable(at + 56, 8))
    return invalid("reserved bytes are not zero", at);
  if (c.codec > 1) return invalid("unknown codec", at + 8);
  if (c.block < 4096 || c.block > 8388608 || (c.block & (c.block - 1)) != 0)
    return invalid("a bad block size", at + 12);
  if (c.offset != expected) return invalid("a chunk is not in its place", at + 16);
  if (c.stored > size - c.offset) return invalid("a chunk reaches beyond the file", at + 24);
  if (c.data_at() > c.stored) return invalid("a chunk is too small for its block table", at + 24);
  if (c.codec == 0 && c.stored - c.data_at() != c.decoded)
    return invalid("a raw chunk has not the size that it should", at + 24);
  if (c.blocks() <= 1) MESOCELL_TRY(check_block(c, 0, c.stored));
  expected = round_up(c.offset + c.stored, 64);
  return expected <= size ? kMesocellOk : invalid("a chunk's padding reaches beyond the file", at + 24);
}

MesocellStatus Loader::check_block(const Chunk& c, u64 b, u64 stored) const {
  const u64 decoded = c.block_size(b);
  const bool right = c.codec == 0 ? stored == decoded : stored <= decoded && (stored > 0 || decoded == 0);
  if (!right || decoded / 32768 > stored) return invalid("a block has not a size that it can have", c.offset);
  return kMesocellOk;
}

MesocellStatus Loader::open(bool names) {
  MESOCELL_TRY(check_header());
  MESOCELL_TRY(check_assets(names));
  return check_directory();
}

// 3.3 and 4: the chunks of the asset
MesocellStatus Loader::find_chunks(u32 asset) {
  if (asset >= asset_count) return fail(kMesocellNoSuchAsset, "the file has no such asset", 12);
  if (get32(file + 64 + 64 * u64(asset)) != kCell)
    return invalid("unknown representation", 64 + 64 * u64(asset));
  const u8* first = file + directory;
  for (u32 i = 0; i < asset; ++i) first += 64 * u64(get32(file + 64 + 64 * u64(i) + 8));
  const u8* end = first + 64 * u64(get32(file + 64 + 64 * u64(asset) + 8));
  for (const u8* entry = first; entry < end; entry += 64) {
    const Chunk c = read_entry(entry);
    fault_chunk = c.type;
    fault_at = u64(entry - file);
    for (const u8* e = first; e < entry; e += 64)
      if (get32(e) == c.type) return bad("a chunk type occurs twice");
    int known = kGrid;
    while (known < kUnknown && kTypes[known] != c.type) ++known;
    if (known >= kMesh && minor == 0) known = kUnknown;  // 1.1 brought it
    if (c.critical != (known <= kMemb))
      return bad("a chunk is critical that is unknown or must not be, or is not");
    if (known == kGrid && c.codec != 0) return bad("GRID is not raw");
    if (known < kUnknown) chunks[known] = c;
    MESOCELL_TRY(verify(c));
  }
  fault_chunk = 0;
  for (int required = kGrid; required <= kMemb; ++required)
    if (!chunks[required].there) return invalid("a chunk is missing", u64(first - file));
  // No object has more bytes than this, so that what was charged fits in a size_t.
  budget = options.max_decoded_bytes < PTRDIFF_MAX ? options.max_decoded_bytes : PTRDIFF_MAX;
  for (const u8* entry = first; entry < end; entry += 64)
    if (!charge(1, get64(entry + 32))) return over_limit("the chunks decode to too many bytes");
  return kMesocellOk;
}

// 3.4 and 3.5: hashes, block table, padding
MesocellStatus Loader::verify(const Chunk& c) const {
  const u8* stored = file + c.offset;
  const u64 count = c.blocks();
  if (count <= 1) {
    if (hash64(stored, c.stored) != c.hash) return bad("a chunk is damaged");
  } else {
    if (hash64(stored, count * 16) != c.hash) return bad("a block table is damaged");
    const u64 data_at = c.data_at(), room = c.stored - data_at;
    if (!all_zero(stored + count * 16, data_at - count * 16)) return bad("padding is not zero");
    u64 begin = 0;
    for (u64 b = 0; b < count; ++b) {
      const u64 end = get64(stored + 16 * b);
      if (end < begin || end > room) return bad("a block is out of order or beyond its chunk");
      MESOCELL_TRY(check_block(c, b, end - begin));
      if (hash64(stored + data_at + begin, end - begin) != get64(stored + 16 * b + 8))
        return bad("a block is damaged");
      begin = end;
    }
    if (begin != room) return bad("a chunk goes on after its last block");
  }
  const u64 end = c.offset + c.stored;
  return all_zero(file + end, round_up(end, 64) - end) ? kMesocellOk : bad("padding is not zero");
}

// 3.6
MesocellStatus Loader::decode_block(const u8* from, u64 stored, u8* to, u64 decoded) const {
  if (stored == decoded) {
    if (stored > 0) std::memcpy(to, from, size_t(stored));
    return kMesocellOk;
  }
  // A zstd frame's header is 6 to 14 bytes here; a frame that is shorter fails below.
  u8 head[18] = {};
  std::memcpy(head, from, size_t(stored < sizeof head ? stored : sizeof head));
  const u32 descriptor = head[4], size_flag = descriptor >> 6;
  const bool single = (descriptor & 0x20) != 0;
  if (get32(head) != 0xFD2FB528 || (descriptor & 0x0B) != 0 || (size_flag == 0 && !single))
    return bad("not a zstd frame of the allowed kind");
  const u8* p = head + 5;
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
  if (content != decoded || window > u64(1) << 23) return bad("a zstd frame of the wrong size or window");
  if (ZSTD_findFrameCompressedSize(from, size_t(stored)) != stored)
    return bad("a zstd frame does not fill its block");
  if (ZSTD_decompressDCtx(zstd, to, size_t(decoded), from, size_t(stored)) != decoded)
    return bad("a zstd frame does not decode");
  return kMesocellOk;
}

// Decodes a chunk to `to`, or finds it in the file if `to` is null. What follows is about that chunk.
MesocellStatus Loader::load_chunk(Chunk& c, u8* to) {
  fault_chunk = c.type;
  fault_at = c.offset;
  const u8* from = file + c.offset + c.data_at();
  c.bytes = to ? to : from;
  const u64 count = to ? c.blocks() : 0;
  u64 begin = 0;
  for (u64 b = 0; b < count; ++b) {
    const u64 end = count > 1 ? get64(file + c.offset + 16 * b) : c.stored;
    MESOCELL_TRY(decode_block(from + begin, end - begin, to + b * c.block, c.block_size(b)));
    begin = end;
  }
  return kMesocellOk;
}

// ---- 4 Cell object

// 2.6: a chunk's header has 64 bytes, those after its fields are zero
MesocellStatus Loader::header(const Chunk& c, u64 fields) const {
  if (c.decoded < 64) return bad("a chunk ends in its header");
  return all_zero(c.bytes + fields, 64 - fields) ? kMesocellOk : bad("reserved bytes are not zero");
}

// 2.7
MesocellStatus Loader::stated_error(const u8* bytes, float& error) const {
  const u32 bits = get32(bytes);
  std::memcpy(&error, &bits, sizeof error);
  return bits < 0x7F800000 ? kMesocellOk : bad("a stated error is not a number of at least zero");
}

// 4.1
MesocellStatus Loader::load_grid() {
  MESOCELL_TRY(load_chunk(chunks[kGrid], nullptr));
  if (chunks[kGrid].decoded != 64) return bad("GRID has not 64 bytes");
  MESOCELL_TRY(header(chunks[kGrid], 44));
  const u8* bytes = chunks[kGrid].bytes;
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
  if (tiles > options.max_tiles) return over_limit("too many tiles");
  return kMesocellOk;
}

// The first voxel of each id, and kNone of those that no voxel has; false if one is too large.
template <typename Id>
bool find_first(const u8* ids, u64 voxels, u32 piece_count, u32* first) {
  const u64 step = 8 / sizeof(Id);
  for (u64 v = 0; v < voxels;) {
    // Most voxels have the id of the one before.
    while (v > 0 && voxels - v >= step && get64(ids + v * sizeof(Id)) == get64(ids + (v - 1) * sizeof(Id)))
      v += step;
    for (const u64 end = voxels - v >= step ? v + step : voxels; v < end; ++v) {
      u32 id = 0;
      for (u32 i = 0; i < sizeof(Id); ++i) id |= u32(ids[v * sizeof(Id) + i]) << (8 * i);
      if (id > piece_count) return false;
      if (first[id] == kNone) first[id] = u32(v);
    }
  }
  return true;
}

// 4.2. `first` has room for one number a piece and one more.
MesocellStatus Loader::load_tile(const Chunk& c, u32* first) {
  MesocellObject& o = *object;
  MESOCELL_TRY(header(c, 24));
  u64 voxels = 1;
  for (int a = 0; a < 3; ++a) {
    o.resolution[a] = get32(c.bytes + 4 * a);
    if (o.resolution[a] < 4 || o.resolution[a] > 1024) return bad("bad tile resolution");
    voxels *= o.resolution[a];
  }
  o.cell_count = get32(c.bytes + 12);
  o.piece_count = get32(c.bytes + 16);
  o.id_bytes = get32(c.bytes + 20);
  if (o.cell_count < 1 || o.cell_count > 65535) return bad("bad number of cells");
  if (o.piece_count < o.cell_count || o.piece_count > voxels) return bad("bad number of pieces");
  if (o.id_bytes != (o.piece_count <= 255 ? 1u : o.piece_count <= 65535 ? 2u : 4u))
    return bad("bad size of piece ids");
  const u64 pieces_end = 64 + u64(o.piece_count) * 8, ids_at = round_up(pieces_end, 64);
  if (c.decoded != ids_at + voxels * o.id_bytes) return bad("TILE has not the size that it should");
  if (!all_zero(c.bytes + pieces_end, ids_at - pieces_end)) return bad("bytes between parts are not zero");
  if (!charge(u64(o.piece_count) + 1, 10) || !charge(voxels, o.id_bytes))
    return over_limit("the tile is too large");
  o.pieces = c.bytes + 64;
  o.voxel_ids = c.bytes + ids_at;
  MESOCELL_TRY(check_pieces());

  for (u64 id = 0; id <= o.piece_count; ++id) first[id] = kNone;
  if (!(o.id_bytes == 1   ? find_first<uint8_t>(o.voxel_ids, voxels, o.piece_count, first)
        : o.id_bytes == 2 ? find_first<uint16_t>(o.voxel_ids, voxels, o.piece_count, first)
                          : find_first<uint32_t>(o.voxel_ids, voxels, o.piece_count, first)))
    return bad("a voxel is of no piece");
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

MesocellStatus Loader::check_pieces() const {
  const MesocellObject& o = *object;
  u32 last_cell = 0;
  int last_home[3] = {};
  for (u32 id = 1; id <= o.piece_count; ++id) {
    int home[3];
    const u32 cell = mesocell_piece(&o, id, home);
    if (!all_zero(o.pieces + u64(id - 1) * 8 + 5, 3)) return bad("reserved bytes are not zero");
    if (cell < 1 || cell > o.cell_count) return bad("a piece is of no cell");
    if (cell < last_cell || cell > last_cell + 1) return bad("pieces are not ascending, or a cell has none");
    if (cell == last_cell) {
      int order = 0;
      for (int a = 2; a >= 0 && order == 0; --a) order = home[a] - last_home[a];
      if (order <= 0) return bad("pieces are not ascending");
    }
    last_cell = cell;
    std::memcpy(last_home, home, sizeof home);
  }
  return last_cell == o.cell_count ? kMesocellOk : bad("a cell has no piece");
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
MesocellStatus Loader::load_membership(const Chunk& c, u32* entries) {
  MesocellObject& o = *object;
  MESOCELL_TRY(header(c, 36));
  o.rule = get32(c.bytes);
  o.inside = get64(c.bytes + 8);
  o.outside = get64(c.bytes + 16);
  o.intersected = get64(c.bytes + 24);
  o.mixed_count = get32(c.bytes + 32);
  o.tag_bytes = (o.cell_count + 3) / 4;
  if (o.rule > 1) return bad("unknown membership rule");
  if (get32(c.bytes + 4) != o.cell_count) return bad("MEMB and TILE differ in the number of cells");
  const u64 tile_count = u64(o.tiles[0]) * o.tiles[1] * o.tiles[2];
  const u64 states_end = 64 + (tile_count + 3) / 4, ranks_at = round_up(states_end, 64);
  const u64 ranks_end = ranks_at + (tile_count + 4095) / 4096 * 4, tags_at = round_up(ranks_end, 64);
  if (c.decoded != tags_at + u64(o.mixed_count) * o.tag_bytes)
    return bad("MEMB has not the size that it should");
  if (!all_zero(c.bytes + states_end, ranks_at - states_end) ||
      !all_zero(c.bytes + ranks_end, tags_at - ranks_end))
    return bad("bytes between parts are not zero");
  if (!charge(tile_count, 4) || !charge(o.mixed_count, o.tag_bytes)) return over_limit("too many tiles");
  o.tags = c.bytes + tags_at;
  o.entries = entries;

  u64 counts[4] = {};  // tiles, then instances, by state
  u32 mixed = 0;
  for (u64 tile = 0; tile < tile_count;) {
    if (tile % 4096 == 0 && get32(c.bytes + ranks_at + tile / 1024) != mixed) return bad("a wrong rank");
    u32 four = c.bytes[64 + tile / 4];
    if (tile_count - tile >= 4 && four % 0x55 == 0 && four != 0xFF) {  // all alike, the most frequent case
      const u32 state = four & 3;
      for (int k = 0; k < 4; ++k) entries[tile++] = state;
      counts[state] += 4;
      continue;
    }
    for (int k = 0; k < 4 && tile < tile_count; ++k, four >>= 2) {
      const u32 state = four & 3;
      entries[tile++] = state == 3 ? 3 + mixed++ : state;
      ++counts[state];
    }
    if (four != 0) return bad("bits after the last state are not zero");
  }
  if (mixed != o.mixed_count) return bad("a wrong number of mixed tiles");
  counts[3] = 0;
  for (int tag = 0; tag < 3; ++tag) counts[tag] *= o.cell_count;
  MESOCELL_TRY(check_tags(counts));
  if (counts[0] != o.outside || counts[1] != o.inside || counts[2] != o.intersected)
    return bad("wrong numbers of instances");
  return kMesocellOk;
}

// The tags of the mixed tiles, and adds how many instances have each.
MesocellStatus Loader::check_tags(u64 counts[4]) const {
  const MesocellObject& o = *object;
  const u32 in_last = (o.cell_count - 1) % 4 + 1, unused = 0xFFu << (2 * in_last) & 0xFF;
  for (u64 m = 0; m < o.mixed_count; ++m) {
    const u8* tags = o.tags + m * o.tag_bytes;
    u32 inside = 0, intersected = 0, both = 0;
    for (u32 i = 0; i < o.tag_bytes; ++i) {
      inside += bit_count(tags[i] & 0x55u);
      intersected += bit_count(tags[i] & 0xAAu);
      both |= tags[i] & tags[i] >> 1 & 0x55u;
    }
    if ((tags[o.tag_bytes - 1] & unused) != 0 || both != 0) return bad("unused bits, or a tag of the code 3");
    const u32 outside = o.cell_count - inside - intersected;
    if (inside == o.cell_count || outside == o.cell_count || intersected == o.cell_count)
      return bad("a mixed tile is uniform");
    counts[0] += outside;
    counts[1] += inside;
    counts[2] += intersected;
  }
  return kMesocellOk;
}

// 4.4
MesocellStatus Loader::load_text(const Chunk& c) {
  const u8* bytes = c.bytes;
  if (c.decoded < 4) return bad("TEXT ends early");
  object->text_count = get32(bytes);
  object->text = bytes + 4;
  object->text_bytes = c.decoded - 4;
  const u8* last_key = nullptr;
  u64 last_bytes = 0;
  u64 at = 4;
  for (u64 i = 0; i < object->text_count; ++i) {
    if (c.decoded - at < 8) return bad("TEXT ends early");
    const u64 key_bytes = get32(bytes + at), value_bytes = get32(bytes + at + 4);
    at += 8;
    if (key_bytes + value_bytes > c.decoded - at) return bad("TEXT ends early");
    if (!charge(1, 64 + key_bytes + value_bytes)) return over_limit("too much text");
    const u8* key = bytes + at;
    if (key_bytes < 1 || key_bytes > 256 || std::memchr(key, 0, size_t(key_bytes))) return bad("a bad key");
    if (!is_utf8(key, key_bytes) || !is_utf8(key + key_bytes, value_bytes)) return bad("not UTF-8");
    if (last_key) {
      const u64 shorter = last_bytes < key_bytes ? last_bytes : key_bytes;
      const int order = std::memcmp(last_key, key, size_t(shorter));
      if (order > 0 || (order == 0 && last_bytes >= key_bytes)) return bad("keys are not ascending");
    }
    last_key = key;
    last_bytes = key_bytes;
    at += key_bytes + value_bytes;
  }
  return at == c.decoded ? kMesocellOk : bad("TEXT goes on after its last entry");
}

// 4.5
MesocellStatus Loader::load_color(const Chunk& c) {
  MESOCELL_TRY(header(c, 16));
  u64 voxels = 1;
  for (int a = 0; a < 3; ++a) {
    const u32 r = object->color_resolution[a] = get32(c.bytes + 4 * a);
    if (r < 1 || r > 1024) return bad("bad color resolution");
    voxels *= r;
  }
  MESOCELL_TRY(stated_error(c.bytes + 12, object->color_error));
  if (c.decoded != 64 + voxels * 3) return bad("COLR has not the size that it should");
  object->color = c.bytes + 64;
  return charge(voxels, 3) ? kMesocellOk : over_limit("too many colors");
}

// 4.6 and 4.7
MesocellStatus Loader::load_colors(const Chunk& c, u64 count, const uint8_t*& colors, float& error) {
  MESOCELL_TRY(header(c, 4));
  MESOCELL_TRY(stated_error(c.bytes, error));
  if (c.decoded != 64 + count * 3) return bad("a chunk has not as many colors as it should");
  colors = c.bytes + 64;
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

// The rows of a row's neighbourhood, itself in the middle: where they begin, and the tiles that they are in.
struct Rows {
  u64 at[9];
  int dy[9], dz[9];
};

// Boundary voxels of row (y, z) with x in [begin, end), one by one.
u64 Loader::count_boundary_between(const Rows& rows, u32 begin, u32 end) const {
  const u32 rx = object->resolution[0];
  const auto id = [&](u32 x) { return mesocell_voxel_id(object, rows.at[4] + x); };
  // Whether the nine voxels of this x are of one instance; three such in a row make a voxel inner.
  const auto square = [&](u32 x) {
    const u32 centre = id(x);
    for (int k = 0; k < 9; ++k) {
      const u32 other = mesocell_voxel_id(object, rows.at[k] + x);
      // Ids in one tile tell all, and most of them are equal.
      const bool apart = rows.dy[k] != 0 || rows.dz[k] != 0;
      if (apart ? !same_instance(centre, other, 0, rows.dy[k], rows.dz[k]) : centre != other) return false;
    }
    return true;
  };
  const u32 left = begin == 0 ? rx - 1 : begin - 1;
  bool before = square(left), here = square(begin);
  bool same_before = same_instance(id(left), id(begin), begin == 0 ? 1 : 0, 0, 0);
  u64 count = 0;
  for (u32 x = begin; x < end; ++x) {
    const bool last = x + 1 == rx;
    const bool after = square(last ? 0 : x + 1);
    const bool same_after = same_instance(id(x), id(last ? 0 : x + 1), last ? 1 : 0, 0, 0);
    if (id(x) != 0 && !(before && here && after && same_before && same_after)) ++count;
    before = here;
    here = after;
    same_before = same_after;
  }
  return count;
}

// The same of a row within the tile, of all x but the first and the last: as many voxels at once as ids are
// in eight bytes. The row must have two more than that.
u64 Loader::count_boundary_within(const Rows& rows) const {
  const u64 width = object->id_bytes, bits = 8 * width, step = 8 / width, end = object->resolution[0] - 1;
  const u64 ones = width == 1 ? 0x0101010101010101 : width == 2 ? 0x0001000100010001 : 0x100000001;
  const u64 high = ones << (bits - 1), low = high - ones;
  const auto not_zero = [&](u64 ids) { return (((ids & low) + low) | ids) & high; };
  u64 count = 0;
  for (u64 next = 1; next < end;) {
    const u64 x = end - next < step ? end - step : next;  // the last time over some voxels again
    const u64 centre = get64(object->voxel_ids + (rows.at[4] + x) * width);
    u64 differs = 0;
    for (int k = 0; k < 9; ++k) {
      const u8* p = object->voxel_ids + (rows.at[k] + x) * width;
      differs |= (get64(p - width) ^ centre) | (get64(p) ^ centre) | (get64(p + width) ^ centre);
    }
    const u64 boundary = (not_zero(differs) & not_zero(centre)) >> (bits - 1) >> (bits * (next - x));
    count += boundary * ones >> (64 - bits);
    next = x + step;
  }
  return count;
}

u64 Loader::count_boundary() const {
  const u32 rx = object->resolution[0], ry = object->resolution[1], rz = object->resolution[2];
  u64 count = 0;
  for (u32 z = 0; z < rz; ++z) {
    for (u32 y = 0; y < ry; ++y) {
      Rows rows;
      for (int k = 0; k < 9; ++k) {
        const int64_t yk = int64_t(y) + k % 3 - 1, zk = int64_t(z) + k / 3 - 1;
        rows.dy[k] = yk < 0 ? -1 : yk >= int64_t(ry) ? 1 : 0;
        rows.dz[k] = zk < 0 ? -1 : zk >= int64_t(rz) ? 1 : 0;
        rows.at[k] = (u64(zk - rows.dz[k] * int64_t(rz)) * ry + u64(yk - rows.dy[k] * int64_t(ry))) * rx;
      }
      if (y > 0 && z > 0 && y + 1 < ry && z + 1 < rz && rx >= 8 / object->id_bytes + 2) {
        count += count_boundary_between(rows, 0, 1) + count_boundary_within(rows) +
                 count_boundary_between(rows, rx - 1, rx);
      } else {
        count += count_boundary_between(rows, 0, rx);
      }
    }
  }
  return count;
}

MesocellStatus Loader::load_normals(const Chunk& c) {
  MESOCELL_TRY(header(c, 8));
  if (get32(c.bytes) != 0) return bad("unknown encoding of normals");
  MESOCELL_TRY(stated_error(c.bytes + 4, object->normal_error));
  const u64 bytes = c.decoded - 64;
  if (!charge(u64(object->resolution[0]) * object->resolution[1], 8) || !charge(bytes, 1))
    return over_limit("too many normals");
  object->normals = c.bytes + 64;
  u32 too_large = 0;
  for (u64 i = 0; i < bytes; ++i) too_large |= object->normals[i] > 252;
  if (too_large != 0) return bad("a byte of a normal is above 252");
  object->normal_count = count_boundary();
  if (bytes != object->normal_count * 2) return bad("NORM has not one normal a boundary voxel");
  return kMesocellOk;
}

MesocellStatus Loader::load_mesh(const Chunk& c) {
  MESOCELL_TRY(header(c, 24));
  if (get32(c.bytes) != 0) return bad("unknown encoding of the basic mesh");
  MESOCELL_TRY(stated_error(c.bytes + 4, object->mesh_error));
  object->mesh_vertices = get32(c.bytes + 16), object->mesh_triangles = get32(c.bytes + 20);
  if (object->mesh_vertices < 3 || object->mesh_vertices > 0x7fffffff || object->mesh_triangles < 1 ||
      object->mesh_triangles > 0x7fffffff)
    return bad("bad numbers of vertices or triangles of the basic mesh");
  object->mesh_bytes = get64(c.bytes + 8);
  if (object->mesh_bytes != c.decoded - 64) return bad("the basic mesh has another number of bytes");
  if (!charge(object->mesh_bytes, 1)) return over_limit("too large a basic mesh");
  object->mesh = c.bytes + 64;
  return kMesocellOk;
}

// 4.11: where the masks of SCOL are
u64 scol_masks_at(u64 tile_count) {
  return 64 + round_up((tile_count + 7) / 8, 64) + round_up((tile_count + 4095) / 4096 * 8, 64);
}

// Most bricks that SCOL has: each has a byte of a mask and a color at least.
u64 most_bricks(const Chunk& c, u64 tile_count) {
  const u64 at = scol_masks_at(tile_count), most = c.decoded > at ? (c.decoded - at) / 4 : 0;
  return most < tile_count ? most : tile_count;
}

// 4.11. `bytes` are the chunk's, in the arena; `bricks` and `first` have room for one number a tile and as
// many as most_bricks().
MesocellStatus Loader::load_surface_colors(const Chunk& c, u8* bytes, u32* bricks, u32* first) {
  MesocellObject& o = *object;
  MESOCELL_TRY(header(c, 24));
  u64 voxels = 1;
  for (int a = 0; a < 3; ++a) {
    const u32 r = o.surface_resolution[a] = get32(bytes + 4 * a);
    if (r < 1 || r > 32 || r > o.resolution[a]) return bad("bad resolution of surface colors");
    voxels *= r;
  }
  MESOCELL_TRY(stated_error(bytes + 12, o.surface_color_error));
  o.surface_brick_count = get32(bytes + 16), o.surface_color_count = get32(bytes + 20);
  const u64 tile_count = u64(o.tiles[0]) * o.tiles[1] * o.tiles[2], mask_bytes = (voxels + 7) / 8;
  const u64 bits_end = 64 + (tile_count + 7) / 8, ranks_at = round_up(bits_end, 64);
  const u64 ranks_end = ranks_at + (tile_count + 4095) / 4096 * 8, masks_at = scol_masks_at(tile_count);
  const u64 masks_end = masks_at + o.surface_brick_count * mask_bytes, colors_at = round_up(masks_end, 64);
  if (c.decoded != colors_at + u64(o.surface_color_count) * 3)
    return bad("SCOL has not the size that it should");
  if (!all_zero(bytes + bits_end, ranks_at - bits_end) ||
      !all_zero(bytes + ranks_end, masks_at - ranks_end) ||
      !all_zero(bytes + masks_end, colors_at - masks_end))
    return bad("bytes between parts are not zero");
  u64 count = 0;
  for (u64 i = 64; i < bits_end; ++i) count += bit_count(bytes[i]);
  if (count != o.surface_brick_count || count == 0) return bad("a wrong number of bricks");
  if (tile_count % 8 != 0 && bytes[bits_end - 1] >> tile_count % 8 != 0)
    return bad("bits after the last tile are not zero");
  if (!charge(tile_count, 4) || !charge(count, 4) || !charge(count, mask_bytes) ||
      !charge(o.surface_color_count, 3))
    return over_limit("too many surface colors");
  o.surface_bricks = bricks, o.surface_first = first;
  o.surface_masks = bytes + masks_at, o.surface_colors = bytes + colors_at;
  if (count > most_bricks(c, tile_count)) return bad("a brick has no color");
  MESOCELL_TRY(check_surface_masks(c, masks_end, first));
  u32 brick = 0;
  for (u64 tile = 0; tile < tile_count; ++tile) {
    const u8* rank = bytes + ranks_at + tile / 4096 * 8;
    const u32 before = brick < count ? first[brick] : o.surface_color_count;
    if (tile % 4096 == 0 && (get32(rank) != brick || get32(rank + 4) != before)) return bad("a wrong rank");
    bricks[tile] = (bytes[64 + tile / 8] >> tile % 8 & 1) != 0 ? brick++ : kNone;
  }
  undo_differences(bytes + colors_at);
  return kMesocellOk;
}

// The masks, and where each brick's colors begin.
MesocellStatus Loader::check_surface_masks(const Chunk& c, u64 masks_end, u32* first) const {
  const u32* r = object->surface_resolution;
  const u32 voxels = r[0] * r[1] * r[2];
  const u8* const end = c.bytes + masks_end;
  u64 colors = 0;
  for (const u8* mask = object->surface_masks; mask < end; ++first) {
    const u64 before = colors;
    *first = u32(colors);
    for (u32 i = 0; i < voxels; i += 8) colors += bit_count(*mask++);
    if (colors == before) return bad("a brick has no color");
    if (voxels % 8 != 0 && mask[-1] >> voxels % 8 != 0) return bad("unused bits of a mask are not zero");
  }
  return colors == object->surface_color_count ? kMesocellOk : bad("a wrong number of surface colors");
}

// Each color is stored as its difference from the mean of those of the color voxels before it along each
// axis, or from the color before it.
void Loader::undo_differences(u8* color) const {
  const u32* r = object->surface_resolution;
  const u32 plane = r[0] * r[1], voxels = plane * r[2];
  const u8* mask = object->surface_masks;
  // The last color of each column along z, and a number of its voxel that no other brick has.
  struct {
    u64 voxel;
    const u8* color;
  } columns[32 * 32] = {};
  for (u64 brick = 1; brick <= object->surface_brick_count; ++brick) {
    static const u8 black[3] = {};
    const u8* before = black;
    for (u32 byte = 0; byte < voxels; byte += 8) {
      u32 v = byte;
      for (u32 bits = *mask++; bits != 0; bits >>= 1, ++v) {
        if ((bits & 1) == 0) continue;
        const u32 xy = v % plane;
        const u64 voxel = brick * voxels + v;
        const u8* near[3];
        int count = 0;
        const auto look = [&](u32 column, u32 back) {
          if (columns[column].voxel == voxel - back) near[count++] = columns[column].color;
        };
        if (xy % r[0] > 0) look(xy - 1, 1);
        if (xy >= r[0]) look(xy - r[0], r[0]);
        if (v >= plane) look(xy, plane);
        for (int k = 0; k < 3; ++k) {
          int sum = 0;
          for (int n = 0; n < count; ++n) sum += near[n][k];
          color[k] = u8(color[k] + (count > 0 ? sum / count : before[k]));
        }
        columns[xy] = {voxel, color};
        before = color;
        color += 3;
      }
    }
  }
}

// ---- The arena: decoder, chunks but GRID, a block that first serves TILE and then holds the entries, and
// numbers of bricks and of their first colors

struct Layout {
  u64 at[kUnknown] = {}, decoder = 0, block = 0, bricks = 0, total = 0;  // by kTypes; the decoder is at 0
};

// Raw chunks can be used where they are, but for SCOL, which is changed.
bool in_place(const Loader& loader, int type) {
  return loader.options.in_place != 0 && loader.chunks[type].codec == 0 && type != kScol;
}

// False if the arena would not fit in the address space.
bool lay_out(const Loader& loader, Layout& layout) {
  const MesocellObject& o = *loader.object;
  for (const Chunk& c : loader.chunks) {
    if (c.there && c.codec != 0) layout.decoder = round_up(ZSTD_estimateDCtxSize(), 64);
    if (c.decoded > u64(1) << 60) return false;  // so that no sum below overflows
  }
  const u64 tile_count = u64(o.tiles[0]) * o.tiles[1] * o.tiles[2];
  // A piece has 8 bytes of its own and a voxel of at least one byte.
  const u64 most_pieces = loader.chunks[kTile].decoded / 9;
  layout.block = layout.decoder;
  for (int i = kTile; i < kUnknown; ++i) {
    const Chunk& c = loader.chunks[i];
    if (!c.there || in_place(loader, i)) continue;
    layout.at[i] = layout.block;
    layout.block += round_up(c.decoded, 64);
  }
  layout.bricks = layout.block + 4 * (tile_count > most_pieces ? tile_count : most_pieces + 1);
  const Chunk& scol = loader.chunks[kScol];
  layout.total = layout.bricks + (scol.there ? 4 * (tile_count + most_bricks(scol, tile_count)) : 0);
  return layout.total <= PTRDIFF_MAX;
}

Loader begin(const void* file, size_t file_bytes, const MesocellOptions* options, MesocellFault* fault) {
  const MesocellOptions defaults = {u64(1) << 32, u64(1) << 33, u64(1) << 28, 0};
  if (fault) *fault = {nullptr, 0, 0};
  return Loader{static_cast<const u8*>(file), file_bytes, options ? *options : defaults, fault};
}

}  // namespace

MesocellStatus mesocell_open(const void* file, size_t file_bytes, const MesocellOptions* options,
                             MesocellFile* info, MesocellFault* fault) {
  Loader loader = begin(file, file_bytes, options, fault);
  MESOCELL_TRY(loader.open(true));
  *info = {1, uint16_t(loader.minor), loader.asset_count};
  return kMesocellOk;
}

void mesocell_asset_name(const void* file, uint32_t asset, char name[41]) {
  std::memcpy(name, static_cast<const u8*>(file) + 64 + 64 * u64(asset) + 16, 40);
  name[40] = 0;
}

MesocellStatus mesocell_arena_bytes(const void* file, size_t file_bytes, uint32_t asset,
                                    const MesocellOptions* options, size_t* arena_bytes,
                                    MesocellFault* fault) {
  MesocellObject object = {};
  Layout layout;
  Loader loader = begin(file, file_bytes, options, fault);
  loader.object = &object;
  MESOCELL_TRY(loader.open(false));
  MESOCELL_TRY(loader.find_chunks(asset));
  MESOCELL_TRY(loader.load_grid());
  // What mesocell_load() will take from the budget at least: an arena over the limit is not even asked for.
  const u64 tile_bytes = loader.chunks[kTile].decoded;
  const u64 tile_count = u64(object.tiles[0]) * object.tiles[1] * object.tiles[2];
  // Its first colors have no more bytes than masks and colors, but for the zeros between these.
  const Chunk& scol = loader.chunks[kScol];
  const u64 most = most_bricks(scol, tile_count);
  if (!loader.charge(tile_count, scol.there ? 8 : 4) ||
      !loader.charge(1, tile_bytes > 128 ? tile_bytes - 128 : 0) ||
      !loader.charge(scol.there && most > 16 ? most - 16 : 0, 4))
    return loader.over_limit("too many tiles or voxels");
  if (!lay_out(loader, layout)) return loader.over_limit("more than the address space");
  *arena_bytes = size_t(layout.total);
  return kMesocellOk;
}

MesocellStatus mesocell_load(const void* file, size_t file_bytes, uint32_t asset,
                             const MesocellOptions* options, void* arena, size_t arena_bytes,
                             MesocellObject* object, MesocellFault* fault) {
  *object = {};
  Layout layout;
  Loader loader = begin(file, file_bytes, options, fault);
  loader.object = object;
  MESOCELL_TRY(loader.open(false));
  MESOCELL_TRY(loader.find_chunks(asset));
  MESOCELL_TRY(loader.load_grid());
  if (!lay_out(loader, layout)) return loader.over_limit("more than the address space");
  if (layout.total > arena_bytes) return loader.fail(kMesocellArenaTooSmall, "the arena is too small", 0);

  u8* const base = static_cast<u8*>(arena);
  if (layout.decoder > 0) loader.zstd = ZSTD_initStaticDCtx(base, size_t(layout.decoder));
  u32* const block = reinterpret_cast<u32*>(base + layout.block);
  u32* const bricks = reinterpret_cast<u32*>(base + layout.bricks);
  const u64 tile_count = u64(object->tiles[0]) * object->tiles[1] * object->tiles[2];
  for (int i = kTile; i < kUnknown; ++i) {
    Chunk& c = loader.chunks[i];
    if (!c.there) continue;
    u8* const to = in_place(loader, i) ? nullptr : base + layout.at[i];
    MESOCELL_TRY(loader.load_chunk(c, to));
    MESOCELL_TRY(i == kTile   ? loader.load_tile(c, block)
                 : i == kMemb ? loader.load_membership(c, block)
                 : i == kColr ? loader.load_color(c)
                 : i == kCcol ? loader.load_colors(c, object->cell_count, object->cell_colors,
                                                   object->cell_color_error)
                 : i == kIcol ? loader.load_colors(c, object->inside, object->instance_colors,
                                                   object->instance_color_error)
                 : i == kNorm ? loader.load_normals(c)
                 : i == kText ? loader.load_text(c)
                 : i == kMesh ? loader.load_mesh(c)
                              : loader.load_surface_colors(c, to, bricks, bricks + tile_count));
  }
  return kMesocellOk;
}
