#include "sdk/membership/scanline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sdk/membership/open_rows.h"
#include "sdk/membership/open_solid.h"
#include "sdk/membership/predicates.h"

namespace mesocell {
namespace {

constexpr double kUlp = std::numeric_limits<double>::epsilon();

/// The least whole number that is not below x, which is below 2^62 in magnitude. Without a call: std::ceil is
/// one where the processor is not known to round by itself.
std::int64_t ceil_of(double x) {
  const std::int64_t whole = std::int64_t(x);
  return whole + (double(whole) < x);
}

/// Sorts what is mostly few.
void sort_crossings(std::span<Scanline::Crossing> crossings) {
  constexpr std::size_t kFew = 16;
  if (crossings.size() > kFew) {
    std::sort(crossings.begin(), crossings.end());
    return;
  }
  for (std::size_t k = 1; k < crossings.size(); ++k) {
    const Scanline::Crossing crossing = crossings[k];
    std::size_t at = k;
    for (; at > 0 && crossing < crossings[at - 1]; --at) crossings[at] = crossings[at - 1];
    crossings[at] = crossing;
  }
}

/// Where an edge of a triangle crosses the plane z = centre of a row.
struct EdgeCrossing {
  double x, y;     ///< to within `error`
  double error;    ///< bounds the error of x and of y
  std::int64_t j;  ///< the first voxel row whose centre is beyond the edge or on it, exactly
  bool upward;     ///< the triangle runs along the edge towards greater z
};

/// The crossing of edge p q, one end of which is above the row's plane and the other is not.
EdgeCrossing cross_edge(const Vec3& p, const Vec3& q, double z) {
  const bool upward = p.z < q.z;
  const Vec3 &low = upward ? p : q, &high = upward ? q : p;
  const double t = (z - low.z) / (high.z - low.z);
  EdgeCrossing c{};
  c.upward = upward;
  c.y = low.y + t * (high.y - low.y);
  c.x = low.x + t * (high.x - low.x);
  // t is within 3 half ulps, product and sum add 3 of what is at most the sum of both magnitudes.
  c.error = 8 * kUlp * (std::abs(low.y) + std::abs(high.y) + std::abs(low.x) + std::abs(high.x) + 1);
  const double u = c.y - 0.5, nearest = std::nearbyint(u);
  if (std::abs(u - nearest) > c.error) {
    c.j = ceil_of(u);
  } else {
    // A centre on the edge counts as beyond it: the ε² in y moves it there, whatever the ε³ in z does.
    const double centre = nearest + 0.5;
    const bool beyond = orientation_2d(low.y, low.z, high.y, high.z, centre, z) <= 0;
    c.j = std::int64_t(nearest) + (beyond ? 0 : 1);
  }
  return c;
}

}  // namespace

Scanline::Scanline(const TriangleMesh& mesh, const Index3& resolution, const Index3& tiles,
                   const OpenSolid* open, SolidRule solid)
    : mesh_(mesh),
      open_(open),
      mask_(solid == SolidRule::kEvenOdd ? 1 : -1),
      resolution_(resolution),
      tiles_(tiles) {
  // Bundles that a triangle's box meets, generously: which rows it meets is decided exactly later.
  const auto range = [&](double low, double high, std::size_t a, std::int64_t& first, std::int64_t& last) {
    const double r = resolution_[a], n = tiles_[a];
    first = std::int64_t(std::clamp(std::floor((low - 1) / r), 0.0, n));
    last = std::int64_t(std::clamp(std::floor((high + 1) / r), -1.0, n - 1));
  };
  const auto for_bundles = [&](const Triangle& t, auto f) {
    Box3 box;
    for (const std::uint32_t v : t) box.add(mesh_.vertices[v]);
    std::int64_t y0, y1, z0, z1;
    range(box.min.y, box.max.y, 1, y0, y1);
    range(box.min.z, box.max.z, 2, z0, z1);
    for (std::int64_t z = z0; z <= z1; ++z)
      for (std::int64_t y = y0; y <= y1; ++y) f(std::size_t(y + std::int64_t{tiles_[1]} * z));
  };
  first_.assign(std::size_t{tiles_[1]} * tiles_[2] + 1, 0);
  for (const Triangle& t : mesh_.triangles) for_bundles(t, [&](std::size_t b) { ++first_[b + 1]; });
  for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
  triangles_.resize(first_.back());
  std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
    for_bundles(mesh_.triangles[t], [&](std::size_t b) { triangles_[next[b]++] = t; });
}

void Scanline::add_triangle(std::uint32_t index, const Rows& rows, std::vector<RowCrossing>& found) const {
  const Triangle& triangle = mesh_.triangles[index];
  const Vec3 v[3] = {mesh_.vertices[triangle[0]], mesh_.vertices[triangle[1]], mesh_.vertices[triangle[2]]};
  const double z_min = std::min({v[0].z, v[1].z, v[2].z}), z_max = std::max({v[0].z, v[1].z, v[2].z});
  const double z_first = std::max(std::ceil(z_min - 0.5), double(rows.z0));
  const double z_last = std::min(std::floor(z_max - 0.5), double(rows.z0) + resolution_[2] - 1);
  const std::int64_t y_first = rows.y0, y_end = std::int64_t{rows.y0} + resolution_[1];
  const std::int64_t x_end = std::int64_t{resolution_[0]} * tiles_[0];

  for (double k = z_first; k <= z_last; ++k) {
    const double z = k + 0.5;
    // The ε³ in z puts a vertex at the row's height below the row. Then either no edge spans it or two do.
    EdgeCrossing crossing[2];
    int count = 0;
    for (int e = 0; e < 3; ++e) {
      const Vec3 &p = v[e], &q = v[(e + 1) % 3];
      if ((p.z > z) != (q.z > z)) crossing[count++] = cross_edge(p, q, z);
    }
    if (count != 2 || crossing[0].j == crossing[1].j) continue;
    const bool swapped = crossing[0].j > crossing[1].j;
    const EdgeCrossing &left = crossing[swapped ? 1 : 0], &right = crossing[swapped ? 0 : 1];
    // Seen along -x with y to the right, a counter-clockwise triangle runs down on its left; its normal has
    // positive x then, and a ray along +x leaves the solid through it.
    const std::int32_t delta = left.upward ? 1 : -1;

    // x is interpolated between both ends. Their errors count once for x and once, times the slope, for the
    // place between them; where the ends are too near to tell, all that is known is that x lies between.
    const double ends = left.error + right.error, span = right.y - left.y;
    const double low = std::min(left.x, right.x) - ends, high = std::max(left.x, right.x) + ends;
    const bool interpolate = span > 64 * ends;
    const double slope = interpolate ? (right.x - left.x) / span : 0;
    const double error = interpolate ? 4 * ends * (1 + std::abs(slope)) : high - low;
    for (std::int64_t j = std::max(left.j, y_first), end = std::min(right.j, y_end); j < end; ++j) {
      const double y = double(j) + 0.5;
      const double x = std::clamp(left.x + (y - left.y) * slope, low, high);
      std::int64_t i = ceil_of(x - error - 0.5);
      const std::int64_t i_last = ceil_of(x + error - 0.5);
      if (i != i_last) {
        // The centre of voxel i may be before the surface, on it or beyond: exactly, and by bisection where a
        // sliver leaves many candidates. On it counts as beyond: the ε in x moves it there.
        std::int64_t beyond = i_last;
        while (i < beyond) {
          const std::int64_t middle = i + (beyond - i) / 2;
          const int side = orientation_3d(v[0], v[1], v[2], {double(middle) + 0.5, y, z});
          if (delta * side <= 0)
            beyond = middle;
          else
            i = middle + 1;
        }
      }
      if (i >= x_end) continue;
      const std::uint32_t row = std::uint32_t(j - y_first) + resolution_[1] * (std::uint32_t(k) - rows.z0);
      found.push_back({row, {std::uint32_t(std::max(i, std::int64_t{0})), delta}});
    }
  }
}

void Scanline::bundle(std::uint32_t ty, std::uint32_t tz, Scratch& scratch, RowIntervals& out) const {
  const std::size_t b = ty + std::size_t{tiles_[1]} * tz;
  const Rows rows{ty * resolution_[1], tz * resolution_[2]};
  const std::size_t row_count = std::size_t{resolution_[1]} * resolution_[2];
  std::vector<RowCrossing>& found = scratch.found;
  found.clear();
  for (std::uint64_t k = first_[b]; k < first_[b + 1]; ++k) add_triangle(triangles_[k], rows, found);

  // Counting sort by row, then each row's few crossings. Which is first at equal x does not matter.
  std::vector<std::uint32_t>& first = out.first;
  first.assign(row_count + 1, 0);
  for (const RowCrossing& c : found) ++first[c.row + 1];
  for (std::size_t r = 0; r < row_count; ++r) first[r + 1] += first[r];
  scratch.sorted.resize(found.size());
  for (const RowCrossing& c : found) scratch.sorted[first[c.row]++] = c.crossing;
  out.intervals.clear();
  const std::uint32_t x_end = resolution_[0] * tiles_[0];
  std::uint32_t begin = 0;
  for (std::size_t r = 0; r < row_count; ++r) {
    const std::uint32_t end = first[r];  // after the scatter, where the row ends
    first[r] = std::uint32_t(out.intervals.size());
    Crossing* const row = scratch.sorted.data();
    sort_crossings({row + begin, row + end});
    if (open_) {
      const std::uint32_t y = rows.y0 + std::uint32_t(r) % resolution_[1],
                          z = rows.z0 + std::uint32_t(r) / resolution_[1];
      if (!open_->is_plain(y, z)) {
        scratch.unsure +=
            decide_open_row(*open_, {row + begin, row + end}, y, z, x_end, mask_, out.intervals);
        begin = end;
        continue;
      }
    }
    std::int32_t winding = 0;
    std::uint32_t start = 0;
    for (std::uint32_t k = begin; k < end;) {
      const std::uint32_t x = row[k].x();
      const bool was_inside = (winding & mask_) != 0;
      for (; k < end && row[k].x() == x; ++k) winding += row[k].delta();
      const bool inside = (winding & mask_) != 0;
      if (!was_inside && inside) start = x;
      if (was_inside && !inside) out.intervals.push_back({start, x});
    }
    if ((winding & mask_) != 0) out.intervals.push_back({start, x_end});
    begin = end;
  }
  first[row_count] = std::uint32_t(out.intervals.size());
}

}  // namespace mesocell
