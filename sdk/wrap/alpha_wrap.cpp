#include "sdk/wrap/alpha_wrap.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <new>
#include <vector>

// CGAL is not written for these warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#pragma GCC diagnostic pop

namespace mesocell {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

constexpr std::size_t kMostVertices = 500'000;
/// Of which half are thought of as half of the work; nobody knows how many there will be.
constexpr double kUsualVertices = 20'000;

struct Stopped {};
struct TooMany {};

/// Watches the insertion of vertices, which is nearly all of the work.
class Watch : public CGAL::Alpha_wraps_3::internal::Wrapping_default_visitor {
 public:
  explicit Watch(const Progress* progress) : progress_(progress) {}

  template <class Wrapper, class Gate>
  void before_facet_treatment(const Wrapper&, const Gate&) {
    if (++facets_ % 4096 == 0 && progress_ && progress_->cancelled()) throw Stopped{};
  }
  template <class Wrapper, class SteinerPoint>
  void before_Steiner_point_insertion(const Wrapper&, const SteinerPoint&) {
    if (++vertices_ > kMostVertices) throw TooMany{};
    if (vertices_ % 1024 != 0 || !progress_) return;
    if (progress_->cancelled()) throw Stopped{};
    const double n = double(vertices_);
    if (progress_->report) progress_->report("wrap", n / (n + kUsualVertices));
  }

 private:
  const Progress* progress_;
  std::size_t facets_ = 0, vertices_ = 0;
};

TriangleMesh to_mesh(const CGAL::Surface_mesh<Point>& wrap) {
  TriangleMesh mesh;
  mesh.vertices.reserve(wrap.number_of_vertices());
  mesh.triangles.reserve(wrap.number_of_faces());
  std::vector<std::uint32_t> place(wrap.num_vertices());
  for (const auto v : wrap.vertices()) {
    place[v.idx()] = std::uint32_t(mesh.vertices.size());
    const Point& p = wrap.point(v);
    mesh.vertices.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : wrap.faces()) {
    Triangle t{};
    std::size_t k = 0;
    for (const auto v : wrap.vertices_around_face(wrap.halfedge(f)))
      if (k < 3) t[k++] = place[v.idx()];
    mesh.triangles.push_back(t);
  }
  return mesh;
}

}  // namespace

Result<TriangleMesh> alpha_wrap(const TriangleMesh& mesh, double alpha, double offset,
                                const Progress* progress) {
  if (!(alpha > 0) || !(offset > 0) || !std::isfinite(alpha) || !std::isfinite(offset))
    return Error{ErrorCode::kUsage, "alpha and offset of a wrap must be finite numbers of metres above 0"};
  const Box3 box = bounding_box(mesh);
  if (box.empty() || !(length(box.extent()) > 0) || !std::isfinite(length(box.extent())))
    return Error{ErrorCode::kInvalidInput, "there is nothing to wrap: the mesh has no triangles of any size",
                 "mesh-flat"};
  if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  std::vector<Point> points;
  points.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices) points.emplace_back(v.x, v.y, v.z);
  std::vector<std::array<std::size_t, 3>> faces;
  faces.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) faces.push_back({t[0], t[1], t[2]});
  CGAL::Surface_mesh<Point> wrap;
  try {
    Watch watch(progress);
    CGAL::alpha_wrap_3(points, faces, alpha, offset, wrap, CGAL::parameters::default_values(),
                       CGAL::parameters::visitor(watch));
  } catch (const Stopped&) {
    return Error{ErrorCode::kCancelled, "cancelled"};
  } catch (const TooMany&) {
    return Error{ErrorCode::kLimit, "the wrap would have more than " + std::to_string(kMostVertices) +
                                        " vertices; use a greater alpha and offset"};
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimit, "there is no memory for so fine a wrap; use a greater alpha and offset"};
  } catch (const std::exception& e) {
    return Error{ErrorCode::kInvalidInput, std::string("the mesh cannot be wrapped (") + e.what() +
                                               "); use a greater alpha and offset"};
  }
  if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  if (wrap.number_of_faces() == 0)
    return Error{ErrorCode::kInvalidInput,
                 "its wrap is empty, as alpha or offset is too large for it; use smaller ones"};
  return to_mesh(wrap);
}

}  // namespace mesocell
