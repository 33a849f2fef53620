#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "format/hash.h"
#include "format/normal_map.h"
#include "sdk/core/rng.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

using Vec = std::array<double, 3>;
using Code = std::array<std::uint8_t, 2>;

double angle_degrees(const Vec& a, const Vec& b) {
  const Vec c = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  const double sine = std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
  return std::atan2(sine, a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * 180 / 3.14159265358979323846;
}

Vec random_direction(Rng& rng) {
  for (;;) {
    const Vec v = {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    const double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (square > 1 || square < 1e-6) continue;
    const double length = std::sqrt(square);
    return {v[0] / length, v[1] / length, v[2] / length};
  }
}

/// The definition, word for word: the instance of a voxel of the endless tile is a cell and a home tile.
std::vector<std::uint8_t> boundary_by_definition(const TileMap& tile) {
  const auto instance = [&](std::array<int, 3> p) {
    std::array<int, 4> result{};  // cell, home; zeros where empty
    std::array<int, 3> t{};
    for (std::size_t a = 0; a < 3; ++a) {
      const int r = int(tile.resolution[a]);
      t[a] = p[a] < 0 ? -1 : p[a] >= r ? 1 : 0;
      p[a] -= t[a] * r;
    }
    const auto id = tile.id(tile.voxel_index(std::uint32_t(p[0]), std::uint32_t(p[1]), std::uint32_t(p[2])));
    if (id == 0) return result;
    const Piece& piece = tile.pieces[id - 1];
    result = {piece.cell, piece.home[0] + t[0], piece.home[1] + t[1], piece.home[2] + t[2]};
    return result;
  };
  std::vector<std::uint8_t> boundary;
  for (int z = 0; z < int(tile.resolution[2]); ++z) {
    for (int y = 0; y < int(tile.resolution[1]); ++y) {
      for (int x = 0; x < int(tile.resolution[0]); ++x) {
        const auto here = instance({x, y, z});
        bool differs = false;
        for (int k = 0; k < 27; ++k)
          differs |= instance({x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1}) != here;
        boundary.push_back(here[0] != 0 && differs);
      }
    }
  }
  return boundary;
}

}  // namespace

TEST_CASE("normal map: boundary voxels are those of the definition") {
  Rng rng(11);
  std::size_t inner = 0, boundary = 0;
  for (int i = 0; i < 200; ++i) {
    CAPTURE(i);
    RandomObjectOptions options;
    for (std::uint32_t& r : options.resolution) r = 4 + rng.below(9);
    options.cells = 1 + rng.below(i % 4 == 0 ? 300 : 3);
    options.block = 1 + rng.below(12);
    options.reach = int(rng.below(2));
    const TileMap tile = random_tile(rng, options);
    const auto found = boundary_voxels(tile);
    REQUIRE(found == boundary_by_definition(tile));
    std::size_t count = 0;
    for (const std::uint8_t b : found) count += b;
    CHECK(count_boundary_voxels(tile) == count);
    boundary += count;
    for (std::size_t v = 0; v < found.size(); ++v) inner += found[v] == 0 && tile.id(v) != 0;
  }
  // The tiles show both kinds.
  CHECK(boundary > 10000);
  CHECK(inner > 500);
}

TEST_CASE("normal map: ids of four bytes are read whole") {
  RandomObjectOptions options;
  options.resolution = {64, 40, 40};
  options.cells = 65535;
  options.reach = 63;
  Rng rng(12);
  const TileMap tile = random_tile(rng, options);
  REQUIRE(tile.id_bytes == 4);
  CHECK(boundary_voxels(tile) == boundary_by_definition(tile));
}

TEST_CASE("normal map: where an instance goes on through a face of the tile there is no boundary") {
  // One cell of a tile's size that is half a tile off on one axis: its two pieces meet within the tile, where
  // they are two instances, and go on through its face, where they are one.
  for (std::size_t a = 0; a < 3; ++a) {
    TileMap tile;
    tile.resolution = {8, 8, 8};
    tile.cell_count = 1;
    Piece back{1, {0, 0, 0}};
    back.home[a] = -1;
    tile.pieces = {back, {1, {0, 0, 0}}};
    for (std::uint32_t v = 0; v < 512; ++v)
      tile.voxel_ids.push_back((std::array{v % 8, v / 8 % 8, v / 64}[a] < 4) ? 1 : 2);
    const auto found = boundary_voxels(tile);
    CHECK(found == boundary_by_definition(tile));
    for (std::uint32_t v = 0; v < 512; ++v) {
      const std::array<std::uint32_t, 3> p = {v % 8, v / 8 % 8, v / 64};
      bool expected = p[a] == 3 || p[a] == 4;
      for (std::size_t b = 0; b < 3; ++b) expected |= b != a && (p[b] == 0 || p[b] == 7);
      CHECK(bool(found[v]) == expected);
    }
  }
}

TEST_CASE("normal map: a code is off by no more than the spec says") {
  Rng rng(13);
  double worst = 0;
  for (int i = 0; i < 1000000; ++i) {
    const Vec v = random_direction(rng);
    worst = std::max(worst, angle_degrees(v, decode_normal(encode_normal(v))));
  }
  CHECK(worst <= kNormalCodeErrorDegrees);
  CHECK(worst > kNormalCodeErrorDegrees - 0.01);  // the bound is not idle
}

TEST_CASE("normal map: axes and diagonals are exact") {
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const int parts = std::abs(x) + std::abs(y) + std::abs(z);
        if (parts == 0) continue;
        const double length = std::sqrt(double(parts));
        const Vec v = {x / length, y / length, z / length};
        const Vec d = decode_normal(encode_normal(v));
        if (parts == 1) CHECK(d == v);
        CHECK(angle_degrees(v, d) < 1e-13);
      }
    }
  }
  CHECK(encode_normal({0, 0, 1}) == Code{126, 126});
  CHECK(encode_normal({1, 0, 0}) == Code{252, 126});
  CHECK(encode_normal({0, -1, 0}) == Code{126, 0});
}

TEST_CASE("normal map: every code is a unit vector and comes back as the same one") {
  for (unsigned a = 0; a <= kMaxNormalByte; ++a) {
    for (unsigned b = 0; b <= kMaxNormalByte; ++b) {
      const Vec v = decode_normal({std::uint8_t(a), std::uint8_t(b)});
      const Code again = encode_normal(v);
      const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
      if (std::abs(length - 1) < 1e-15 * 4 && decode_normal(again) == v && again[0] <= kMaxNormalByte &&
          again[1] <= kMaxNormalByte)
        continue;
      CAPTURE(a, b, length, int(again[0]), int(again[1]));
      FAIL_CHECK("a code does not come back");
    }
  }
}

TEST_CASE("normal map: codes are the same on every machine, and there is one for what is no direction") {
  // Directions of small integers: only exact operations and one square root and division lead to them.
  std::vector<std::uint8_t> codes;
  for (int x = -12; x <= 12; ++x) {
    for (int y = -12; y <= 12; ++y) {
      for (int z = -12; z <= 12; ++z) {
        const double length = std::sqrt(double(x * x + y * y + z * z));
        const Code code = length > 0 ? encode_normal({x / length, y / length, z / length}) : Code{};
        codes.insert(codes.end(), code.begin(), code.end());
      }
    }
  }
  CHECK(hash64(std::as_bytes(std::span(codes))) == 0x32d4a9a7854c8472);

  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const Vec& none : {Vec{0, 0, 0}, Vec{kNan, 0, 0}, Vec{0, kInf, 1}, Vec{1e-9, 0, 0}})
    CHECK(encode_normal(none) == Code{126, 126});
  CHECK(decode_normal({255, 126}) == decode_normal({252, 126}));
}
