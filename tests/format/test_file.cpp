#include "tests/format/test_file.h"

#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"
#include "format/cell_object_io.h"
#include "format/hash.h"
#include "format/loader/mesocell_loader.h"
#include "format/validate.h"

namespace mesocell::test {
namespace {

/// The loader's object as the reader's.
CellObject to_cell_object(const MesocellObject& o) {
  CellObject object;
  std::copy_n(o.box_min, 3, object.grid.box_min.begin());
  object.grid.voxel_edge = o.voxel_edge;
  std::copy_n(o.tiles, 3, object.grid.tiles.begin());
  std::copy_n(o.resolution, 3, object.tile.resolution.begin());
  object.tile.cell_count = o.cell_count;
  object.tile.id_bytes = o.id_bytes;
  for (std::uint32_t id = 1; id <= o.piece_count; ++id) {
    int home[3];
    const std::uint32_t cell = mesocell_piece(&o, id, home);
    object.tile.pieces.push_back(
        {std::uint16_t(cell), {std::int8_t(home[0]), std::int8_t(home[1]), std::int8_t(home[2])}});
  }
  object.tile.voxel_ids.assign(o.voxel_ids, o.voxel_ids + object.tile.voxel_count() * o.id_bytes);
  object.membership.rule = MembershipRule(o.rule);
  object.membership.tiles = object.grid.tiles;
  object.membership.cell_count = o.cell_count;
  object.membership.entries.assign(o.entries, o.entries + object.grid.tile_count());
  object.membership.blocks.assign(o.tags, o.tags + std::size_t{o.mixed_count} * o.tag_bytes);
  const auto colors = [](const std::uint8_t* bytes, std::uint64_t count) {
    std::vector<Rgb8> result(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < result.size(); ++i) std::copy_n(bytes + 3 * i, 3, result[i].begin());
    return result;
  };
  if (o.color) {
    ColorMap& color = object.color.emplace();
    std::copy_n(o.color_resolution, 3, color.resolution.begin());
    color.voxels =
        colors(o.color, std::uint64_t{o.color_resolution[0]} * o.color_resolution[1] * o.color_resolution[2]);
    color.max_error = o.color_error;
  }
  if (o.cell_colors) object.cell_colors = ColorList{colors(o.cell_colors, o.cell_count), o.cell_color_error};
  if (o.instance_colors)
    object.instance_colors = ColorList{colors(o.instance_colors, o.inside), o.instance_color_error};
  if (o.normals) {
    object.normals.emplace().normals.resize(std::size_t(o.normal_count));
    object.normals->max_error_degrees = o.normal_error;
    for (std::size_t i = 0; i < o.normal_count; ++i)
      object.normals->normals[i] = {o.normals[2 * i], o.normals[2 * i + 1]};
  }
  if (o.mesh) {
    const auto* const bytes = reinterpret_cast<const std::byte*>(o.mesh);
    object.basic_mesh =
        BasicMesh{{bytes, bytes + o.mesh_bytes}, o.mesh_vertices, o.mesh_triangles, o.mesh_error};
  }
  if (o.surface_colors) {
    SurfaceColors& map = object.surface_colors.emplace();
    std::copy_n(o.surface_resolution, 3, map.resolution.begin());
    map.entries.assign(o.surface_bricks, o.surface_bricks + object.grid.tile_count());
    map.first.assign(o.surface_first, o.surface_first + o.surface_brick_count);
    map.masks.assign(o.surface_masks, o.surface_masks + o.surface_brick_count * map.mask_bytes());
    map.colors = colors(o.surface_colors, o.surface_color_count);
    map.max_error = o.surface_color_error;
  }
  std::uint64_t cursor = 0;
  const char *key = nullptr, *value = nullptr;
  std::uint32_t key_bytes = 0, value_bytes = 0;
  while (mesocell_next_text(&o, &cursor, &key, &key_bytes, &value, &value_bytes) != 0)
    object.metadata.emplace_back(std::string(key, key_bytes), std::string(value, value_bytes));
  return object;
}

/// Whether each chunk holds what encoding the decoded object gives: all chunks have one encoding.
bool is_canonical(std::span<const std::byte> file, std::size_t asset, const CellObject& object) {
  const auto container = Container::open(file);
  const auto same = [&](std::uint32_t type, const Bytes& expected) {
    const auto bytes = container->read_chunk(asset, type);
    return bytes.ok() && *bytes == expected;
  };
  const auto has = [&](std::uint32_t type) { return container->scan().find(asset, type).has_value(); };
  return same(kGridChunk, encode_grid(object.grid)) && same(kTileChunk, encode_tile(object.tile)) &&
         same(kMembershipChunk, encode_membership(object.membership)) &&
         object.color.has_value() == has(kColorChunk) && object.normals.has_value() == has(kNormalChunk) &&
         (!object.color || same(kColorChunk, encode_color(*object.color))) &&
         object.cell_colors.has_value() == has(kCellColorChunk) &&
         object.instance_colors.has_value() == has(kInstanceColorChunk) &&
         (!object.cell_colors || same(kCellColorChunk, encode_colors(*object.cell_colors))) &&
         (!object.instance_colors || same(kInstanceColorChunk, encode_colors(*object.instance_colors))) &&
         (!object.normals || same(kNormalChunk, encode_normals(*object.normals))) &&
         object.basic_mesh.has_value() == (container->minor() >= 1 && has(kBasicMeshChunk)) &&
         (!object.basic_mesh || same(kBasicMeshChunk, encode_basic_mesh(*object.basic_mesh))) &&
         object.surface_colors.has_value() == (container->minor() >= 1 && has(kSurfaceColorChunk)) &&
         (!object.surface_colors ||
          same(kSurfaceColorChunk, encode_surface_colors(*object.surface_colors))) &&
         (!has(kTextChunk) || same(kTextChunk, encode_text(object.metadata)));
}

/// Where header and tables end; 0 if the file has no room for them.
std::size_t tables_end(const Bytes& file) {
  if (file.size() < 64) return 0;
  const std::uint64_t end = 64 + 64 * (get(file, 12) + get(file, 24));
  return end <= file.size() ? std::size_t(end) : 0;
}

std::uint64_t block_count(std::uint64_t decoded, std::uint64_t block) {
  return block == 0 ? 0 : decoded / block + (decoded % block != 0);
}

}  // namespace

TestFile TestFile::take_apart(std::span<const std::byte> file) {
  const auto container = Container::open(file);
  if (!container) throw std::runtime_error(container.error().message);
  TestFile parts;
  parts.representation = container->assets()[0].representation;
  parts.name = container->assets()[0].name;
  parts.minor = container->minor();
  for (const ChunkInfo& info : container->chunks_of(0)) {
    auto bytes = container->read_chunk(0, info.type);
    if (!bytes) throw std::runtime_error(bytes.error().message);
    parts.chunks.push_back({info.type, info.critical ? 1u : 0u, 0, bytes->size(), *bytes, 1u << 20});
  }
  return parts;
}

TestFile TestFile::of(const CellObject& object) {
  TestFile parts;
  parts.representation = kCellObjectRepresentation;
  const auto add = [&](std::uint32_t type, const Bytes& bytes) {
    const bool critical = type == kGridChunk || type == kTileChunk || type == kMembershipChunk;
    parts.chunks.push_back({type, critical ? 1u : 0u, 0, bytes.size(), bytes, 1u << 20});
  };
  add(kGridChunk, encode_grid(object.grid));
  add(kTileChunk, encode_tile(object.tile));
  add(kMembershipChunk, encode_membership(object.membership));
  if (object.color) add(kColorChunk, encode_color(*object.color));
  if (object.cell_colors) add(kCellColorChunk, encode_colors(*object.cell_colors));
  if (object.instance_colors) add(kInstanceColorChunk, encode_colors(*object.instance_colors));
  if (object.normals) add(kNormalChunk, encode_normals(*object.normals));
  if (object.surface_colors) add(kSurfaceColorChunk, encode_surface_colors(*object.surface_colors));
  if (object.basic_mesh) add(kBasicMeshChunk, encode_basic_mesh(*object.basic_mesh));
  if (object.surface_colors || object.basic_mesh) parts.minor = 1;
  add(kTextChunk, encode_text(object.metadata));
  return parts;
}

TestChunk& TestFile::chunk(std::uint32_t type) {
  return *std::find_if(chunks.begin(), chunks.end(), [&](const TestChunk& c) { return c.type == type; });
}

void TestFile::set_payload(std::uint32_t type, Bytes payload) {
  TestChunk& c = chunk(type);
  c.codec = 0;
  c.decoded_bytes = payload.size();
  c.stored = std::move(payload);
}

Bytes TestFile::build() const {
  std::vector<const TestFile*> assets = {this};
  for (const TestFile& other : others) assets.push_back(&other);
  std::size_t count = 0;
  for (const TestFile* asset : assets) count += asset->chunks.size();
  ByteWriter tables, directory, body;
  const std::uint64_t body_at = 64 + 64 * (assets.size() + count);
  for (const TestFile* asset : assets) {
    tables.u32(asset->representation);
    tables.u32(0);
    tables.u32(std::uint32_t(asset->chunks.size()));
    tables.u32(0);
    tables.append(asset->name);
    tables.zeros(40 - asset->name.size() + 8);
    for (const TestChunk& c : asset->chunks) {
      const std::uint64_t blocks = block_count(c.decoded_bytes, c.block_bytes);
      const std::span stored(c.stored);
      directory.u32(c.type);
      directory.u32(c.flags);
      directory.u32(c.codec);
      directory.u32(c.block_bytes);
      directory.u64(body_at + body.size());
      directory.u64(c.stored.size());
      directory.u64(c.decoded_bytes);
      directory.u64(hash64(blocks > 1 && blocks * 16 <= stored.size() ? stored.first(std::size_t(blocks * 16))
                                                                      : stored));
      directory.zeros(16);
      body.append(c.stored);
      body.pad_to(64);
    }
  }
  ByteWriter out;
  out.append(std::string_view("\x89MESO\r\n\x1a", 8));
  out.u16(1);
  out.u16(minor);
  out.u32(std::uint32_t(assets.size()));
  out.u64(body_at + body.size());
  out.u32(std::uint32_t(count));
  out.zeros(36);
  out.append(tables.bytes());
  out.append(directory.bytes());
  out.append(body.bytes());
  Bytes file = out.release();
  reseal_directory(file);
  return file;
}

Bytes zstd_frame(std::span<const std::byte> payload, int level) {
  Bytes frame(ZSTD_compressBound(payload.size()));
  frame.resize(ZSTD_compress(frame.data(), frame.size(), payload.data(), payload.size(), level));
  return frame;
}

Bytes zstd_frame_with_header(std::span<const std::byte> payload, std::initializer_list<std::uint8_t> header) {
  const Bytes frame = zstd_frame(payload, 19);
  // The library makes a single segment with a content size of one byte, of two from 256 bytes on.
  const std::size_t old_header = payload.size() < 256 ? 2 : 3;
  Bytes result(frame.begin(), frame.begin() + 4);
  for (const std::uint8_t byte : header) result.push_back(std::byte(byte));
  result.insert(result.end(), frame.begin() + 4 + std::ptrdiff_t(old_header), frame.end());
  return result;
}

void compress(TestChunk& chunk, int level) {
  chunk.codec = 1;
  chunk.decoded_bytes = chunk.stored.size();
  while (chunk.block_bytes < chunk.decoded_bytes) chunk.block_bytes *= 2;
  Bytes frame = zstd_frame(chunk.stored, level);
  if (frame.size() < chunk.stored.size()) chunk.stored = std::move(frame);
}

void split(TestChunk& chunk, std::uint32_t block_bytes, bool compressed, int level) {
  const std::span payload(chunk.stored);
  chunk.codec = compressed ? 1 : 0;
  chunk.block_bytes = block_bytes;
  chunk.decoded_bytes = payload.size();
  ByteWriter table, blocks;
  const std::uint64_t count = block_count(payload.size(), block_bytes);
  for (std::size_t b = 0; b < count; ++b) {
    const auto block = payload.subspan(b * block_bytes,
                                       std::min<std::size_t>(block_bytes, payload.size() - b * block_bytes));
    const Bytes frame = zstd_frame(block, level);
    const auto stored = compressed && frame.size() < block.size() ? std::span<const std::byte>(frame) : block;
    blocks.append(stored);
    table.u64(blocks.size());
    table.u64(hash64(stored));
  }
  if (count > 1) {
    table.pad_to(64);
    table.append(blocks.bytes());
    chunk.stored = table.release();
  } else {
    chunk.stored = blocks.release();
  }
}

void put(Bytes& bytes, std::size_t at, std::uint64_t value, unsigned count) {
  for (unsigned i = 0; i < count; ++i) bytes.at(at + i) = std::byte(value >> (8 * i) & 0xff);
}

std::uint64_t get(const Bytes& bytes, std::size_t at, unsigned count) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < count; ++i) value |= std::to_integer<std::uint64_t>(bytes.at(at + i)) << (8 * i);
  return value;
}

void reseal_header(Bytes& file) {
  if (file.size() >= 64) put(file, 56, hash64(std::span(file).first(56)), 8);
}

void reseal_directory(Bytes& file) {
  if (const std::size_t end = tables_end(file); end > 0)
    put(file, 32, hash64(std::span(file).subspan(64, end - 64)), 8);
  reseal_header(file);
}

void reseal_chunks(Bytes& file) {
  const std::size_t end = tables_end(file);
  for (std::size_t at = end > 0 ? 64 + 64 * std::size_t(get(file, 12)) : 0; at < end; at += 64) {
    if (get(file, at + 16, 8) > file.size() || get(file, at + 24, 8) > file.size() - get(file, at + 16, 8))
      continue;
    const std::size_t offset = std::size_t(get(file, at + 16, 8)), size = std::size_t(get(file, at + 24, 8));
    const auto stored = std::span(file).subspan(offset, size);
    const std::uint64_t blocks = block_count(get(file, at + 32, 8), get(file, at + 12));
    if (blocks <= 1 || blocks > size / 16) {
      put(file, at + 40, hash64(stored), 8);
      continue;
    }
    const std::size_t data_at = std::size_t(blocks * 16 + 63) / 64 * 64;
    std::size_t begin = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::uint64_t end_of_block = get(file, offset + 16 * b, 8);
      if (data_at > size || end_of_block < begin || end_of_block > size - data_at) break;
      const std::size_t block_end = std::size_t(end_of_block);
      put(file, offset + 16 * b + 8, hash64(stored.subspan(data_at + begin, block_end - begin)), 8);
      begin = block_end;
    }
    put(file, at + 40, hash64(stored.first(std::size_t(blocks * 16))), 8);
  }
  reseal_directory(file);
}

bool Verdicts::has(std::string_view id) const {
  return std::find(issues.begin(), issues.end(), id) != issues.end();
}

namespace {

/// What the loader makes of an asset, in an arena of its own.
struct Loaded {
  MesocellStatus status = kMesocellOk;
  MesocellFault fault = {};
  MesocellObject object = {};
  std::unique_ptr<std::byte[]> arena;
};

Loaded load(std::span<const std::byte> file, std::size_t asset, const ReadLimits& limits, bool in_place) {
  const MesocellOptions o = {limits.max_file_bytes, limits.max_decoded_bytes, limits.max_tiles,
                             in_place ? 1 : 0};
  Loaded loaded;
  std::size_t arena_bytes = 0;
  const auto index = std::uint32_t(asset);
  loaded.status = mesocell_arena_bytes(file.data(), file.size(), index, &o, &arena_bytes, &loaded.fault);
  if (loaded.status != kMesocellOk) return loaded;
  loaded.arena.reset(new std::byte[arena_bytes]);  // not cleared: many tests ask for a lot
  loaded.status = mesocell_load(file.data(), file.size(), index, &o, loaded.arena.get(), arena_bytes,
                                &loaded.object, &loaded.fault);
  return loaded;
}

}  // namespace

Verdicts verdicts(std::span<const std::byte> bytes, const ReadLimits& limits) {
  // Exact buffers of their own let the address sanitizer see a read of one byte too many.
  const auto copy = std::make_unique<std::byte[]>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), copy.get());
  const std::span<const std::byte> file(copy.get(), bytes.size());
  Verdicts v;
  const auto disagree = [&](std::string why) {
    if (v.why.empty()) v.why = std::move(why) + ", reader: " + v.reader_id + ", loader: " + v.loader_text;
  };
  const ValidationReport report = validate(file, limits);
  v.validator = report.valid;
  for (const Issue& issue : report.issues) v.issues.emplace_back(issue.id);

  // The container itself, then each asset, until one is refused.
  const MesocellOptions o = {limits.max_file_bytes, limits.max_decoded_bytes, limits.max_tiles, 0};
  MesocellFile info = {};
  MesocellFault fault = {};
  const MesocellStatus opened = mesocell_open(file.data(), file.size(), &o, &info, &fault);
  v.loader = opened == kMesocellOk;
  v.loader_limit = opened == kMesocellLimit;
  if (fault.text) v.loader_text = fault.text;
  const auto container = Container::open(file, limits);
  v.reader = container.ok();
  const auto refuse = [&](const Error& error) {
    v.reader = false;
    v.reader_id = error.id;
    v.limit = error.code == ErrorCode::kLimit;
  };
  if (!container) refuse(container.error());
  const std::size_t count = container ? container->assets().size() : 0;
  if (v.reader && v.loader && info.asset_count != count) disagree("reader and loader find different assets");
  for (std::size_t i = 0; i < count && v.reader && v.loader; ++i) {
    const auto read = read_cell_object(file, limits, i);
    if (!read) refuse(read.error());
    for (const bool in_place : {true, false}) {
      const Loaded loaded = load(file, i, limits, in_place);
      v.loader = loaded.status == kMesocellOk;
      v.loader_limit = loaded.status == kMesocellLimit;
      if (loaded.fault.text) v.loader_text = loaded.fault.text;
      if (v.loader != v.reader) disagree("only one of reader and loader takes it");
      if (v.reader && v.loader && !(to_cell_object(loaded.object) == *read))
        disagree("reader and loader find different maps");
    }
    if (v.reader && !is_canonical(file, i, *read)) disagree("a chunk is not in canonical form");
  }
  if (v.reader != v.validator || v.reader != v.loader) disagree("verdicts");
  if (v.limit != v.loader_limit) disagree("limit or fault");
  if (!v.reader && !v.has(v.reader_id) && !report.capped) disagree("the validator does not find it");
  v.agree = v.why.empty();
  return v;
}

}  // namespace mesocell::test
