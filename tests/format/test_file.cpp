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
  object.membership.blocks.assign(o.tags, o.tags + std::size_t{o.mixed_count} * o.block_bytes);
  const auto colors = [](const std::uint8_t* bytes, std::uint64_t count) {
    std::vector<Rgb8> result(bytes ? count : 0);
    for (std::size_t i = 0; i < result.size(); ++i) std::copy_n(bytes + 3 * i, 3, result[i].begin());
    return result;
  };
  if (o.color) {
    ColorMap& color = object.color.emplace();
    std::copy_n(o.color_resolution, 3, color.resolution.begin());
    color.voxels =
        colors(o.color, std::uint64_t{o.color_resolution[0]} * o.color_resolution[1] * o.color_resolution[2]);
  }
  object.cell_colors = colors(o.cell_colors, o.cell_count);
  object.instance_colors = colors(o.instance_colors, o.inside);
  if (o.normals) {
    object.normals.emplace().normals.resize(o.normal_count);
    for (std::size_t i = 0; i < o.normal_count; ++i)
      object.normals->normals[i] = {o.normals[2 * i], o.normals[2 * i + 1]};
  }
  std::uint64_t cursor = 0;
  const char *key = nullptr, *value = nullptr;
  std::uint32_t key_bytes = 0, value_bytes = 0;
  while (mesocell_next_text(&o, &cursor, &key, &key_bytes, &value, &value_bytes) != 0)
    object.metadata.emplace_back(std::string(key, key_bytes), std::string(value, value_bytes));
  return object;
}

/// Whether each chunk holds what encoding the decoded object gives: all chunks have one encoding.
bool is_canonical(std::span<const std::byte> file, const CellObject& object) {
  const auto container = Container::open(file);
  const auto same = [&](std::uint32_t type, const Bytes& expected) {
    const auto bytes = container->read_chunk(type);
    return bytes.ok() && *bytes == expected;
  };
  const auto has = [&](std::uint32_t type) { return container->scan().find(type).has_value(); };
  return same(kGridChunk, encode_grid(object.grid)) && same(kTileChunk, encode_tile(object.tile)) &&
         same(kMembershipChunk, encode_membership(object.membership)) &&
         object.color.has_value() == has(kColorChunk) && object.normals.has_value() == has(kNormalChunk) &&
         (!object.color || same(kColorChunk, encode_color(*object.color))) &&
         (!has(kCellColorChunk) || same(kCellColorChunk, encode_colors(object.cell_colors))) &&
         (!has(kInstanceColorChunk) || same(kInstanceColorChunk, encode_colors(object.instance_colors))) &&
         (!object.normals || same(kNormalChunk, encode_normals(*object.normals))) &&
         (!has(kTextChunk) || same(kTextChunk, encode_text(object.metadata)));
}

std::size_t chunk_count_in(const Bytes& file) {
  if (file.size() < 128) return 0;
  return std::min<std::size_t>(get(file, 24), (file.size() - 64) / 64);
}

}  // namespace

TestFile TestFile::take_apart(std::span<const std::byte> file) {
  const auto container = Container::open(file);
  if (!container) throw std::runtime_error(container.error().message);
  TestFile parts;
  parts.representation = container->representation();
  for (const ChunkInfo& info : container->chunks()) {
    auto bytes = container->read_chunk(info.type);
    if (!bytes) throw std::runtime_error(bytes.error().message);
    parts.chunks.push_back({info.type, info.critical ? 1u : 0u, 0, bytes->size(), *bytes});
  }
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
  ByteWriter directory, body;
  const std::uint64_t body_at = 64 + 64 * chunks.size();
  for (const TestChunk& c : chunks) {
    directory.u32(c.type);
    directory.u32(c.flags);
    directory.u32(c.codec);
    directory.u32(0);
    directory.u64(body_at + body.size());
    directory.u64(c.stored.size());
    directory.u64(c.decoded_bytes);
    directory.u64(hash64(c.stored));
    directory.zeros(16);
    body.append(c.stored);
    body.pad_to(64);
  }
  ByteWriter out;
  out.append(std::string_view("\x89MESO\r\n\x1a", 8));
  out.u16(0);
  out.u16(9);
  out.u32(representation);
  out.u64(body_at + body.size());
  out.u32(std::uint32_t(chunks.size()));
  out.zeros(36);
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

void compress(TestChunk& chunk, int level) {
  chunk.codec = 1;
  chunk.decoded_bytes = chunk.stored.size();
  chunk.stored = zstd_frame(chunk.stored, level);
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
  if (const std::size_t count = chunk_count_in(file); count > 0)
    put(file, 32, hash64(std::span(file).subspan(64, count * 64)), 8);
  reseal_header(file);
}

void reseal_chunks(Bytes& file) {
  for (std::size_t i = 0, n = chunk_count_in(file); i < n; ++i) {
    const std::uint64_t offset = get(file, 64 + 64 * i + 16, 8), size = get(file, 64 + 64 * i + 24, 8);
    if (offset > file.size() || size > file.size() - offset) continue;
    put(file, 64 + 64 * i + 40, hash64(std::span(file).subspan(offset, size)), 8);
  }
  reseal_directory(file);
}

bool Verdicts::has(std::string_view id) const {
  return std::find(issues.begin(), issues.end(), id) != issues.end();
}

Verdicts verdicts(std::span<const std::byte> bytes, const ReadLimits& limits) {
  // Exact buffers of their own let the address sanitizer see a read of one byte too many.
  const auto copy = std::make_unique<std::byte[]>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), copy.get());
  const std::span<const std::byte> file(copy.get(), bytes.size());
  Verdicts v;
  const auto read = read_cell_object(file, limits);
  v.reader = read.ok();
  if (!read) {
    v.reader_id = read.error().id;
    v.limit = read.error().code == ErrorCode::kLimit;
  }
  const ValidationReport report = validate(file, limits);
  v.validator = report.valid;
  for (const Issue& issue : report.issues) v.issues.emplace_back(issue.id);

  const MesocellLimits l = {limits.max_file_bytes, limits.max_decoded_bytes, limits.max_tiles};
  std::size_t arena_bytes = 0;
  MesocellFault fault = {};
  MesocellObject object = {};
  std::unique_ptr<std::byte[]> arena;
  MesocellStatus status = mesocell_arena_bytes(file.data(), file.size(), &l, &arena_bytes, &fault);
  if (status == kMesocellOk) {
    arena.reset(new std::byte[arena_bytes]);  // not cleared: many tests ask for a lot
    status = mesocell_load(file.data(), file.size(), &l, arena.get(), arena_bytes, &object, &fault);
  }
  v.loader = status == kMesocellOk;
  v.loader_limit = status == kMesocellLimit;
  if (fault.text) v.loader_text = fault.text;

  if (v.reader != v.validator || v.reader != v.loader) {
    v.why = "reader: " + v.reader_id + ", loader: " + v.loader_text;
  } else if (v.limit != v.loader_limit) {
    v.why = "limit or fault; reader: " + v.reader_id + ", loader: " + v.loader_text;
  } else if (!v.reader && !v.has(v.reader_id) && !report.capped) {
    v.why = "the validator does not find " + v.reader_id;
  } else if (v.reader && !(to_cell_object(object) == *read)) {
    v.why = "reader and loader find different maps";
  } else if (v.reader && !is_canonical(file, *read)) {
    v.why = "a chunk is not in canonical form";
  }
  v.agree = v.why.empty();
  return v;
}

}  // namespace mesocell::test
