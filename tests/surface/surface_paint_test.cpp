#include "sdk/surface/surface_paint.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sdk/core/rng.h"
#include "sdk/core/srgb.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr Rgb8 kGarish{255, 0, 255};

double distance(Vec3 a, Vec3 b) { return length(a - b); }

/// A quad of two triangles, textured: corners (0,0), (1,0), (1,1), (0,1) of the plane at `uvs`.
struct Quad {
  TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}};
  SurfacePaint paint;

  Quad(std::uint32_t width, std::uint32_t height, std::array<Uv, 4> uvs) {
    paint.uvs = {{uvs[0], uvs[1], uvs[2]}, {uvs[0], uvs[2], uvs[3]}};
    paint.material_indices = {0, 0};
    paint.materials = {{{1, 1, 1}, TextureUse{}}};
    paint.images = {{width, height, std::vector<Rgb8>(std::size_t{width} * height, Rgb8{0, 0, 0})}};
  }
  Rgb8& texel(std::uint32_t x, std::uint32_t y) {
    return paint.images[0].texels[std::size_t{y} * paint.images[0].width + x];
  }
  /// At a place of the plane.
  [[nodiscard]] Vec3 at(double x, double y) const {
    const PaintSampler sampler(mesh, paint, 1);
    if (x >= y) return sampler.color(0, {1 - x, x - y, y});
    return sampler.color(1, {1 - y, x, y - x});
  }
};

/// What a renderer would do: the four texels around, whatever they are.
Vec3 naive(const TextureImage& image, double u, double v) {
  const double x = u * image.width - 0.5, y = v * image.height - 0.5;
  Vec3 sum;
  for (int k = 0; k < 4; ++k) {
    const double cx = std::floor(x) + k % 2, cy = std::floor(y) + k / 2;
    const double weight = (1 - std::abs(x - cx)) * (1 - std::abs(y - cy));
    const auto column = std::size_t(std::clamp(cx, 0.0, image.width - 1.0)),
               row = std::size_t(std::clamp(cy, 0.0, image.height - 1.0));
    sum = sum + srgb_to_linear(image.texels[row * image.width + column]) * weight;
  }
  return sum;
}

/// A fan of triangles around a centre of the atlas, whose texels are painted by their centres alone.
struct Atlas {
  TriangleMesh mesh;
  SurfacePaint paint;
  std::vector<Vec3> chart_colors;  ///< by triangle

  explicit Atlas(std::uint64_t seed) {
    constexpr std::uint32_t kSize = 64;
    Rng rng(seed);
    paint.materials = {{{1, 1, 1}, TextureUse{}}};
    paint.images = {{kSize, kSize, std::vector<Rgb8>(kSize * kSize, kGarish)}};
    constexpr std::array<Rgb8, 4> kColors = {{{0, 200, 0}, {20, 90, 0}, {0, 255, 10}, {10, 60, 0}}};
    for (std::uint32_t chart = 0; chart < 4; ++chart) {
      const double cu = 0.25 + 0.5 * (chart % 2), cv = 0.25 + 0.5 * (chart / 2);
      const std::uint32_t corners = 5 + rng.below(4), base = std::uint32_t(mesh.vertices.size());
      std::vector<Uv> ring;
      for (std::uint32_t i = 0; i < corners; ++i) {
        const double angle = 2 * kPi * i / corners, radius = rng.uniform(0.06, 0.22);
        ring.push_back({float(cu + radius * std::cos(angle)), float(cv + radius * std::sin(angle))});
        // All charts share their border in space, so only texture coordinates tell them apart.
        mesh.vertices.push_back({std::cos(angle), std::sin(angle), double(chart) * 0.1});
      }
      mesh.vertices.push_back({0, 0, double(chart)});
      for (std::uint32_t i = 0; i < corners; ++i) {
        const std::uint32_t j = (i + 1) % corners;
        mesh.triangles.push_back({base + corners, base + i, base + j});
        paint.uvs.push_back({Uv{float(cu), float(cv)}, ring[i], ring[j]});
        paint.material_indices.push_back(0);
        chart_colors.push_back(srgb_to_linear(kColors[chart]));
        fill(paint.uvs.back(), kColors[chart]);
      }
    }
  }

 private:
  void fill(const std::array<Uv, 3>& uv, Rgb8 color) {
    TextureImage& image = paint.images[0];
    const auto side = [](const Uv& a, const Uv& b, double x, double y) {
      return (double{b[0]} - a[0]) * (y - a[1]) - (double{b[1]} - a[1]) * (x - a[0]);
    };
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x) {
        const double u = (x + 0.5) / image.width, v = (y + 0.5) / image.height;
        const double a = side(uv[0], uv[1], u, v), b = side(uv[1], uv[2], u, v), c = side(uv[2], uv[0], u, v);
        if (a >= 0 && b >= 0 && c >= 0) image.texels[std::size_t{y} * image.width + x] = color;
      }
  }
};

}  // namespace

TEST_CASE("within a chart a texture is interpolated in linear light") {
  Quad quad(2, 1, {{{0.25f, 0.5f}, {0.75f, 0.5f}, {0.75f, 0.5f}, {0.25f, 0.5f}}});
  quad.texel(0, 0) = {255, 0, 0};
  quad.texel(1, 0) = {0, 0, 255};
  CHECK(distance(quad.at(0, 0), {1, 0, 0}) < 1e-6);
  CHECK(distance(quad.at(1, 0.5), {0, 0, 1}) < 1e-6);
  CHECK(distance(quad.at(0.25, 0.1), {0.75, 0, 0.25}) < 1e-6);
}

TEST_CASE("vertices, faces, base color and texture are multiplied") {
  Quad quad(1, 1, {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}});
  quad.texel(0, 0) = {188, 188, 188};
  quad.mesh.colors.assign(4, {255, 128, 255});
  quad.paint.face_colors = {{255, 255, 128}, {255, 255, 128}};
  quad.paint.materials[0].base_color = {0.5, 1, 1};
  const double gray = srgb_to_linear(188), half = srgb_to_linear(128);
  CHECK(distance(quad.at(0.3, 0.2), {0.5 * gray, half * gray, half * gray}) < 1e-12);
  quad.paint.material_indices = {0, SurfacePaint::kNoMaterial};
  CHECK(distance(quad.at(0.2, 0.3), {1, half, half}) < 1e-12);
}

TEST_CASE("beyond its border a texture repeats, mirrors or stays") {
  // Twice as wide as the picture: texels 0 1 2 3 | 0 1 2 3, or 3 2 1 0, or 3 3 3 3.
  const auto row = [](TextureWrap wrap, float first) {
    Quad quad(4, 1, {{{first, 0.5f}, {first + 2, 0.5f}, {first + 2, 0.5f}, {first, 0.5f}}});
    for (std::uint32_t x = 0; x < 4; ++x) quad.texel(x, 0) = {std::uint8_t(40 * x + 40), 0, 0};
    quad.paint.materials[0].texture->wrap = {wrap, TextureWrap::kRepeat};
    std::vector<int> texels;
    for (int i = 0; i < 8; ++i) texels.push_back(int(linear_to_srgb8(quad.at((i + 0.5) / 8, 0).x)) / 40 - 1);
    return texels;
  };
  CHECK(row(TextureWrap::kRepeat, 0) == std::vector<int>{0, 1, 2, 3, 0, 1, 2, 3});
  CHECK(row(TextureWrap::kMirror, 0) == std::vector<int>{0, 1, 2, 3, 3, 2, 1, 0});
  CHECK(row(TextureWrap::kClamp, 0) == std::vector<int>{0, 1, 2, 3, 3, 3, 3, 3});
  CHECK(row(TextureWrap::kRepeat, -1) == std::vector<int>{0, 1, 2, 3, 0, 1, 2, 3});
  CHECK(row(TextureWrap::kMirror, -1) == std::vector<int>{3, 2, 1, 0, 0, 1, 2, 3});
  CHECK(row(TextureWrap::kClamp, -1) == std::vector<int>{0, 0, 0, 0, 0, 1, 2, 3});
  // Far out, where texels are few to single precision, too.
  CHECK(row(TextureWrap::kRepeat, 1e30f).size() == 8);
  CHECK(row(TextureWrap::kClamp, -1e30f) == std::vector<int>(8, 0));
}

TEST_CASE("texture coordinates are scaled, turned and moved") {
  // The example of KHR_texture_transform: the lower left quadrant, turned by 90 degrees.
  Quad quad(2, 2, {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}});
  quad.texel(0, 1) = {0, 255, 0};
  quad.texel(0, 0) = quad.texel(1, 0) = quad.texel(1, 1) = {255, 0, 0};
  quad.paint.materials[0].texture->transform = {{0, 1}, {0.5, 0.5}, kPi / 2};
  Rng rng(3);
  for (int i = 0; i < 200; ++i) CHECK(distance(quad.at(rng.uniform(), rng.uniform()), {0, 1, 0}) < 1e-9);

  // By any angle, against the maths library: rows of the picture are 100 apart.
  for (int i = 0; i < 500; ++i) {
    const double angle = rng.uniform(-20, 20), u = rng.uniform(), v = rng.uniform();
    Quad spot(64, 64,
              {{{float(u), float(v)}, {float(u), float(v)}, {float(u), float(v)}, {float(u), float(v)}}});
    for (std::uint32_t y = 0; y < 64; ++y)
      for (std::uint32_t x = 0; x < 64; ++x) spot.texel(x, y) = {std::uint8_t(4 * x), std::uint8_t(4 * y), 0};
    spot.paint.materials[0].texture->transform = {{0.5, 0.25}, {0.1, 0.2}, angle};
    spot.paint.materials[0].texture->wrap = {TextureWrap::kClamp, TextureWrap::kClamp};
    const double su = 0.1 * double(float(u)), sv = 0.2 * double(float(v));
    const double tu = std::cos(angle) * su + std::sin(angle) * sv + 0.5,
                 tv = -std::sin(angle) * su + std::cos(angle) * sv + 0.25;
    const Rgb8 color = linear_to_srgb8(spot.at(0.5, 0.25));
    // A point has no chart: the texel under it counts.
    CHECK(color[0] / 4 == std::clamp(int(std::floor(tu * 64)), 0, 63));
    CHECK(color[1] / 4 == std::clamp(int(std::floor(tv * 64)), 0, 63));
  }
}

TEST_CASE("nothing of the gap between charts is seen at their seams, as it is by plain interpolation") {
  std::size_t samples = 0, wrong = 0;
  double worst = 0, worst_naive = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Atlas atlas(seed);
    const PaintSampler sampler(atlas.mesh, atlas.paint, 1);
    Rng rng(seed);
    for (std::uint32_t t = 0; t < atlas.mesh.triangles.size(); ++t)
      for (int k = 0; k < 60; ++k) {
        // On the seam, and just within.
        const double s = k / 59.0, in = k % 3 == 0 ? 0 : rng.uniform(0, 0.1);
        const std::array<double, 3> at = {in, (1 - in) * (1 - s), (1 - in) * s};
        const double off = distance(sampler.color(t, at), atlas.chart_colors[t]);
        double uv[2] = {0, 0};
        for (std::size_t c = 0; c < 3; ++c)
          for (std::size_t a = 0; a < 2; ++a) uv[a] += at[c] * double{atlas.paint.uvs[t][c][a]};
        const double plain = distance(naive(atlas.paint.images[0], uv[0], uv[1]), atlas.chart_colors[t]);
        ++samples;
        wrong += off > 1e-9;
        worst = std::max(worst, off);
        worst_naive = std::max(worst_naive, plain);
      }
  }
  INFO(samples << " samples, " << wrong << " off, at most " << worst << "; naive " << worst_naive);
  CHECK(wrong == 0);
  CHECK(worst_naive > 0.5);
}

TEST_CASE("a chart too small for a texel takes the one under it") {
  Quad quad(8, 8, {{{0.51f, 0.51f}, {0.52f, 0.51f}, {0.52f, 0.52f}, {0.51f, 0.52f}}});
  quad.texel(4, 4) = {0, 255, 0};
  CHECK(distance(quad.at(0.5, 0.4), {0, 1, 0}) < 1e-12);
}

TEST_CASE("triangles joined at the same place are one chart, though their vertices are doubled") {
  // A seam in the index only, as glTF has it at hard edges.
  Quad quad(4, 4, {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}});
  for (std::uint32_t i = 0; i < 16; ++i) quad.texel(i % 4, i / 4) = {std::uint8_t(i * 16), 0, 0};
  Quad split = quad;
  split.mesh.vertices.push_back(quad.mesh.vertices[0]);
  split.mesh.vertices.push_back(quad.mesh.vertices[2]);
  split.mesh.triangles[1] = {4, 5, 3};
  Rng rng(5);
  for (int i = 0; i < 100; ++i) {
    const double x = rng.uniform(), y = rng.uniform();
    CHECK(distance(split.at(x, y), quad.at(x, y)) == 0);
  }
}
