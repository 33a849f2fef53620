#include "sdk/surface/surface_paint.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "sdk/core/closest_point.h"
#include "sdk/core/srgb.h"

namespace mesocell {
namespace {

constexpr std::uint32_t kNone = 0xffff'ffff;

/// Texels away that a color is looked for where the chart has none at the place.
constexpr int kReach = 8;

/// A texel whose centre is this near to the chart is on it, in texels: no more than arithmetic rounds, since
/// what is beyond the border may be of the gap.
constexpr double kOnChart = 1e-9;

/// Of x from -π/4 to π/4, by their series: the maths library's may differ by machine.
std::pair<double, double> small_sine_cosine(double x) {
  double sine = 0, cosine = 0, term = 1;
  for (int n = 0; n < 20; n += 2) {
    const double sign = n % 4 == 0 ? 1 : -1;
    cosine += sign * term;
    term *= x / (n + 1);
    sine += sign * term;
    term *= x / (n + 2);
  }
  return {sine, cosine};
}

std::pair<double, double> sine_cosine(double angle) {
  constexpr double kQuarter = 1.57079632679489661923;
  const double turn = std::fmod(angle, 4 * kQuarter), quarters = std::floor(turn / kQuarter + 0.5);
  auto [sine, cosine] = small_sine_cosine(turn - quarters * kQuarter);
  for (int q = int(quarters) & 3; q > 0; --q) sine = std::exchange(cosine, -sine);
  return {sine, cosine};
}

/// Of texture coordinates into texels of a picture, whose centres are at whole numbers.
struct TexelMap {
  double ux = 0, vx = 0, x = 0, uy = 0, vy = 0, y = 0;

  TexelMap(const UvTransform& t, const TextureImage& image) {
    const auto [sine, cosine] = sine_cosine(t.rotation);
    const double w = image.width, h = image.height;
    ux = w * cosine * t.scale[0];
    vx = w * sine * t.scale[1];
    x = w * t.offset[0] - 0.5;
    uy = -h * sine * t.scale[0];
    vy = h * cosine * t.scale[1];
    y = h * t.offset[1] - 0.5;
  }
  [[nodiscard]] Vec3 at(double u, double v) const { return {ux * u + vx * v + x, uy * u + vy * v + y, 0}; }
};

/// The texel that stands for the one at `i`, a whole number. fmod is exact.
std::uint32_t wrapped(double i, std::uint32_t size, TextureWrap wrap) {
  const double n = size;
  if (wrap == TextureWrap::kClamp) return std::uint32_t(std::clamp(i, 0.0, n - 1));
  const double period = wrap == TextureWrap::kMirror ? 2 * n : n;
  double r = std::fmod(i, period);
  if (r < 0) r += period;
  if (r >= n) r = 2 * n - 1 - r;
  return std::uint32_t(std::clamp(r, 0.0, n - 1));
}

Vec3 texel(const TextureImage& image, const TextureUse& use, double x, double y) {
  const std::size_t column = wrapped(x, image.width, use.wrap[0]),
                    row = wrapped(y, image.height, use.wrap[1]);
  return srgb_to_linear(image.texels[row * image.width + column]);
}

/// Sets that are joined by and by.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// An edge with its texture coordinates; those that are equal join two triangles to a chart.
struct ChartEdge {
  std::array<std::uint32_t, 2> vertices;
  std::array<Uv, 2> uvs;
  std::uint32_t material, triangle;

  [[nodiscard]] auto key() const { return std::tie(vertices, uvs, material); }
  bool operator<(const ChartEdge& o) const {
    return key() != o.key() ? key() < o.key() : triangle < o.triangle;
  }
};

}  // namespace

/// The triangles that have textures, laid out in texels, a storey for each chart: so the nearest point of
/// all tells whether a place is on a chart.
class PaintSampler::Charts {
 public:
  Charts(const TriangleMesh& mesh, const SurfacePaint& paint, std::vector<std::uint32_t> textured,
         unsigned threads)
      : textured_(std::move(textured)), chart_(mesh.triangles.size(), kNone) {
    number_charts(mesh, paint);
    TriangleMesh flat;
    corners_.resize(textured_.size());
    place_.assign(mesh.triangles.size(), kNone);
    for (std::uint32_t i = 0; i < textured_.size(); ++i) {
      const std::uint32_t t = textured_[i];
      place_[t] = i;
      const TextureUse& use = *paint.materials[paint.material_indices[t]].texture;
      const TexelMap map(use.transform, paint.images[use.image]);
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3 corner = map.at(paint.uvs[t][k][0], paint.uvs[t][k][1]);
        for (std::size_t a = 0; a < 2; ++a) corner[a] = std::clamp(corner[a], -kFarthest, kFarthest);
        corner.z = chart_[t];
        corners_[i][k] = corner;
        flat.vertices.push_back(corner);
      }
      flat.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    surface_ = std::make_unique<ClosestPoint>(flat, threads);
  }

  /// A place of a textured triangle, in texels.
  [[nodiscard]] Vec3 place(std::uint32_t triangle, const std::array<double, 3>& barycentric) const {
    const std::array<Vec3, 3>& c = corners_[place_[triangle]];
    return c[0] * barycentric[0] + c[1] * barycentric[1] + c[2] * barycentric[2];
  }

  /// Whether the centre of a texel is on the chart of a textured triangle.
  [[nodiscard]] bool covers(std::uint32_t triangle, double x, double y) const {
    return within(corners_[place_[triangle]], x, y) ||
           surface_->query({x, y, double(chart_[triangle])}).distance <= kOnChart;
  }

 private:
  static constexpr double kFarthest = 1e15;  ///< texels; whole numbers are exact below

  /// Most texels around a place are within its own triangle.
  static bool within(const std::array<Vec3, 3>& c, double x, double y) {
    int left = 0, right = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = c[k], &b = c[(k + 1) % 3];
      const double side = (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
      left += side > 0;
      right += side < 0;
    }
    return left == 3 || right == 3;
  }

  void number_charts(const TriangleMesh& mesh, const SurfacePaint& paint) {
    const std::vector<std::uint32_t> first = merge_identical_vertices(mesh.vertices);
    std::vector<ChartEdge> edges;
    edges.reserve(3 * textured_.size());
    for (const std::uint32_t t : textured_)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3;
        ChartEdge edge{{first[mesh.triangles[t][k]], first[mesh.triangles[t][l]]},
                       {paint.uvs[t][k], paint.uvs[t][l]},
                       paint.material_indices[t],
                       t};
        if (edge.vertices[0] > edge.vertices[1]) {
          std::swap(edge.vertices[0], edge.vertices[1]);
          std::swap(edge.uvs[0], edge.uvs[1]);
        }
        edges.push_back(edge);
      }
    std::sort(edges.begin(), edges.end());
    Sets sets(mesh.triangles.size());
    for (std::size_t i = 1; i < edges.size(); ++i)
      if (edges[i].key() == edges[i - 1].key()) sets.join(edges[i].triangle, edges[i - 1].triangle);
    std::uint32_t charts = 0;
    // The first triangle of a set stands for it and comes first.
    for (const std::uint32_t t : textured_) chart_[t] = sets.find(t) == t ? charts++ : chart_[sets.find(t)];
  }

  std::vector<std::uint32_t> textured_;          ///< triangles of the mesh
  std::vector<std::uint32_t> chart_, place_;     ///< by triangle of the mesh
  std::vector<std::array<Vec3, 3>> corners_;     ///< by place
  std::unique_ptr<const ClosestPoint> surface_;  ///< of all charts
};

PaintSampler::PaintSampler(const TriangleMesh& mesh, const SurfacePaint& paint, unsigned threads)
    : mesh_(mesh), paint_(paint) {
  assert(mesh.colors.empty() || mesh.colors.size() == mesh.vertices.size());
  assert(paint.face_colors.empty() || paint.face_colors.size() == mesh.triangles.size());
  assert(paint.material_indices.empty() || paint.material_indices.size() == mesh.triangles.size());
  assert(paint.uvs.empty() || paint.uvs.size() == mesh.triangles.size());
  if (paint.uvs.empty()) return;
  std::vector<std::uint32_t> textured;
  for (std::uint32_t t = 0; t < paint.material_indices.size(); ++t)
    if (paint.material_indices[t] != SurfacePaint::kNoMaterial &&
        paint.materials[paint.material_indices[t]].texture)
      textured.push_back(t);
  if (!textured.empty()) charts_ = std::make_unique<Charts>(mesh, paint, std::move(textured), threads);
}

PaintSampler::~PaintSampler() = default;

Vec3 PaintSampler::texture_color(std::uint32_t triangle, const PaintMaterial& material,
                                 const std::array<double, 3>& barycentric) const {
  const TextureUse& use = *material.texture;
  const TextureImage& image = paint_.images[use.image];
  const Vec3 place = charts_->place(triangle, barycentric);
  const double x = std::floor(place.x), y = std::floor(place.y);
  const double fx = place.x - x, fy = place.y - y;
  Vec3 sum;
  double weights = 0;
  for (int k = 0; k < 4; ++k) {
    const double dx = k % 2, dy = k / 2;
    const double weight = (dx > 0 ? fx : 1 - fx) * (dy > 0 ? fy : 1 - fy);
    if (weight <= 0 || !charts_->covers(triangle, x + dx, y + dy)) continue;
    sum = sum + texel(image, use, x + dx, y + dy) * weight;
    weights += weight;
  }
  if (weights > 0) return sum / weights;

  const double cx = std::floor(place.x + 0.5), cy = std::floor(place.y + 0.5);
  double nearest = (kReach + 0.5) * (kReach + 0.5);
  std::array<double, 2> best{cx, cy};
  for (int dy = -kReach; dy <= kReach; ++dy)
    for (int dx = -kReach; dx <= kReach; ++dx) {
      const double ex = cx + dx - place.x, ey = cy + dy - place.y, distance = ex * ex + ey * ey;
      if (distance >= nearest || !charts_->covers(triangle, cx + dx, cy + dy)) continue;
      nearest = distance;
      best = {cx + dx, cy + dy};
    }
  return texel(image, use, best[0], best[1]);
}

Vec3 PaintSampler::color(std::uint32_t triangle, const std::array<double, 3>& barycentric) const {
  const auto times = [](Vec3 a, Vec3 b) { return Vec3{a.x * b.x, a.y * b.y, a.z * b.z}; };
  Vec3 color{1, 1, 1};
  if (!mesh_.colors.empty()) {
    color = {};
    for (std::size_t k = 0; k < 3; ++k)
      color = color + srgb_to_linear(mesh_.colors[mesh_.triangles[triangle][k]]) * barycentric[k];
  }
  if (!paint_.face_colors.empty()) color = times(color, srgb_to_linear(paint_.face_colors[triangle]));
  if (paint_.material_indices.empty() || paint_.material_indices[triangle] == SurfacePaint::kNoMaterial)
    return color;
  const PaintMaterial& material = paint_.materials[paint_.material_indices[triangle]];
  color = times(color, material.base_color);
  if (charts_ && material.texture) color = times(color, texture_color(triangle, material, barycentric));
  return color;
}

}  // namespace mesocell
