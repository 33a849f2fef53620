#include <algorithm>
#include <memory>
#include <string>

#include "format/cell_object_chunks.h"
#include "format/cell_object_io.h"
#include "format/loader/mesocell_loader.h"
#include "format/validate.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

MesocellStatus load(const Bytes& file, const ReadLimits& limits, std::size_t* need = nullptr) {
  const MesocellOptions l = {limits.max_file_bytes, limits.max_decoded_bytes, limits.max_tiles, 0};
  std::size_t arena_bytes = 0;
  if (const auto s = mesocell_arena_bytes(file.data(), file.size(), 0, &l, &arena_bytes, nullptr);
      s != kMesocellOk)
    return s;
  if (need) *need = arena_bytes;
  const std::unique_ptr<std::byte[]> arena(new std::byte[arena_bytes]);
  MesocellObject object;
  return mesocell_load(file.data(), file.size(), 0, &l, arena.get(), arena_bytes, &object, nullptr);
}

/// The least value of a limit with which each reader takes the file.
template <typename Accepts>
std::uint64_t threshold(std::uint64_t high, const Accepts& accepts) {
  std::uint64_t low = 0;
  REQUIRE(accepts(high));
  while (low < high) {
    const std::uint64_t mid = low + (high - low) / 2;
    accepts(mid) ? high = mid : low = mid + 1;
  }
  return low;
}

}  // namespace

TEST_CASE("format: reader, loader and validator draw each limit at the same place") {
  auto files = small_files();
  for (std::uint64_t seed = 1; seed < 20; ++seed) files.push_back(encoded(random_small_object(seed)));
  for (const Bytes& file : files) {
    for (std::uint64_t ReadLimits::*field :
         {&ReadLimits::max_file_bytes, &ReadLimits::max_decoded_bytes, &ReadLimits::max_tiles}) {
      const auto with = [&](std::uint64_t v) {
        ReadLimits limits;
        limits.*field = v;
        return limits;
      };
      const auto reader = threshold(1 << 20, [&](std::uint64_t v) {
        const auto read = read_cell_object(file, with(v));
        if (!read) REQUIRE(read.error().code == ErrorCode::kLimit);
        return read.ok();
      });
      const auto loader = threshold(1 << 20, [&](std::uint64_t v) {
        const auto status = load(file, with(v));
        if (status != kMesocellOk) REQUIRE(status == kMesocellLimit);
        return status == kMesocellOk;
      });
      const auto validator =
          threshold(1 << 20, [&](std::uint64_t v) { return validate(file, with(v)).valid; });
      CHECK(reader == loader);
      CHECK(reader == validator);
      if (field == &ReadLimits::max_file_bytes) CHECK(reader == file.size());
    }
  }
}

TEST_CASE("format: the loader asks for no more memory than the limit allows, whatever the file says") {
  Rng rng(77);
  int asked = 0, refused = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const TestFile original = TestFile::take_apart(encoded(random_small_object(seed)));
    for (int i = 0; i < 100; ++i) {
      // Sizes that nothing has looked into when memory is asked for.
      TestFile parts = original;
      for (TestChunk& chunk : parts.chunks) {
        if (chunk.type == kGridChunk || rng.below(2) == 0) continue;
        compress(chunk);
        chunk.block_bytes = 1u << 23;
        if (chunk.codec == 1 && chunk.stored.size() < chunk.decoded_bytes)
          chunk.decoded_bytes =
              std::min<std::uint64_t>(chunk.stored.size() * 32768ull, 1u << (10 + rng.below(13)));
        chunk.decoded_bytes = std::max<std::uint64_t>(chunk.decoded_bytes, chunk.stored.size());
      }
      Bytes grid = parts.payload(kGridChunk);
      if (rng.below(2) == 0) put(grid, 32, 1 + rng.below(1u << 22), 4);
      parts.set_payload(kGridChunk, grid);
      const Bytes file = parts.build();
      const std::uint64_t limit = std::uint64_t{1} << (8 + rng.below(20));
      const MesocellOptions options = {1u << 20, limit, 1u << 28, int(rng.below(2))};
      std::size_t arena_bytes = 0;
      const auto status = mesocell_arena_bytes(file.data(), file.size(), 0, &options, &arena_bytes, nullptr);
      if (status != kMesocellOk) {
        ++refused;
        continue;
      }
      ++asked;
      // zstd's own state and the chunks' alignment are not of the file's making.
      if (arena_bytes > limit + (256u << 10)) CHECK(arena_bytes <= limit + (256u << 10));
    }
  }
  CHECK(asked > 500);
  CHECK(refused > 500);
}

TEST_CASE("format: huge counts in a small file are refused before memory is taken") {
  // 2^31 - 1 tiles: 8 GiB of entries and half a GiB of states from a file of less than 100 kB.
  CellObject object = walkthrough_object();
  TestFile parts = TestFile::take_apart(encoded(object));
  Bytes grid = parts.payload(kGridChunk), memb = parts.payload(kMembershipChunk);
  put(grid, 32, 0x7fffffff / 1024, 4);
  put(grid, 36, 32, 4);
  put(grid, 40, 32, 4);
  const std::uint64_t tiles = 0x7fffffffull / 1024 * 1024;
  // All OUTSIDE: half a gigabyte of zeros, a block of which is some hundred bytes when compressed.
  memb.resize(64);
  put(memb, 8, 0, 8);
  put(memb, 16, tiles * 2, 8);
  put(memb, 24, 0, 8);
  put(memb, 32, 0, 4);
  const std::size_t states = (tiles / 4 + 63) / 64 * 64, ranks = ((tiles + 4095) / 4096 * 4 + 63) / 64 * 64;
  memb.resize(64 + states + ranks);
  parts.set_payload(kGridChunk, grid);
  parts.set_payload(kMembershipChunk, memb);
  split(parts.chunk(kMembershipChunk), 1u << 23, true);
  const Bytes file = parts.build();
  CHECK(file.size() < 100000);
  ReadLimits limits;
  CHECK(read_cell_object(file, limits).error().code == ErrorCode::kLimit);
  CHECK(load(file, limits) == kMesocellLimit);
  limits.max_tiles = ~std::uint64_t{0};
  limits.max_decoded_bytes = std::uint64_t{1} << 32;
  const auto error = read_cell_object(file, limits).error();
  CHECK(error.code == ErrorCode::kLimit);
  CHECK(error.chunk == kMembershipChunk);
  CHECK(load(file, limits) == kMesocellLimit);
  CHECK(validate(file, limits).issues.back().id == "limit-exceeded");

  // Counts beyond the file's end are faults, not limits.
  for (const auto& [type, at] : {std::pair{kTileChunk, std::size_t{0}},
                                 {kMembershipChunk, std::size_t{32}},
                                 {kColorChunk, std::size_t{0}},
                                 {kTextChunk, std::size_t{0}}}) {
    TestFile p = TestFile::take_apart(small_files()[3]);
    Bytes bytes = p.payload(type);
    const bool is_map = type == kTileChunk || type == kColorChunk;
    put(bytes, at, is_map ? 1024 : 0xffffffff, 4);
    if (is_map) put(bytes, at + 4, 1024 | std::uint64_t{1024} << 32, 8);
    p.set_payload(type, bytes);
    const Verdicts v = verdicts(p.build());
    CHECK(v.agree);
    CHECK_FALSE(v.limit);
    CHECK(v.reader_id == "payload-truncated");
  }
}

TEST_CASE("format: a zstd bomb costs nothing over the limit") {
  TestFile parts = TestFile::take_apart(encoded(walkthrough_object()));
  parts.set_payload(kTileChunk, Bytes(std::size_t{6} << 20));
  compress(parts.chunk(kTileChunk), 19);
  const Bytes file = parts.build();
  CHECK(file.size() < 2000);
  ReadLimits limits;
  limits.max_decoded_bytes = 1 << 20;
  CHECK(read_cell_object(file, limits).error().code == ErrorCode::kLimit);
  CHECK(Container::open(file, limits)->read_chunk(0, kTileChunk).error().code == ErrorCode::kLimit);
  CHECK(load(file, limits) == kMesocellLimit);
  CHECK(validate(file, limits).issues.back().id == "limit-exceeded");
  CHECK_FALSE(read_cell_object(file).ok());
}

TEST_CASE("format: the loader wants the arena that it asked for") {
  const Bytes file = small_files()[2];
  std::size_t need = 0;
  REQUIRE(load(file, {}, &need) == kMesocellOk);
  for (const std::size_t have : {std::size_t{0}, std::size_t{1000}, need / 2, need - 1}) {
    const auto arena = std::make_unique<std::byte[]>(have);
    MesocellObject object;
    MesocellFault fault;
    CHECK(mesocell_load(file.data(), file.size(), 0, nullptr, arena.get(), have, &object, &fault) ==
          kMesocellArenaTooSmall);
    CHECK(fault.text != nullptr);
  }
}
