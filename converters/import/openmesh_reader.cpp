#include "converters/import/openmesh_reader.h"

#include <istream>
#include <locale>
#include <mutex>
#include <new>
#include <streambuf>

#include "converters/import/mesh_text.h"
// The library's headers are not written for our warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <OpenMesh/Core/IO/IOInstances.hh>
#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/System/omstream.hh>
#pragma GCC diagnostic pop

namespace mesocell {
namespace {

/// Thrown through the library to end its reading; it has no other way to stop.
struct StopReading {
  Error error;
};

/// A stream over bytes that stay where they are.
class ByteStream : public std::streambuf {
 public:
  explicit ByteStream(const std::string& bytes) {
    // streambuf takes no const pointers, but is only read from.
    char* begin = const_cast<char*>(bytes.data());
    setg(begin, begin, begin + bytes.size());
  }

 protected:
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type base = from == std::ios_base::beg   ? 0
                          : from == std::ios_base::cur ? gptr() - eback()
                                                       : egptr() - eback();
    const off_type target = base + offset;
    if (target < 0 || target > egptr() - eback()) return pos_type(off_type(-1));
    setg(eback(), eback() + target, egptr());
    return pos_type(target);
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode mode) override {
    return seekoff(off_type(position), std::ios_base::beg, mode);
  }
};

using namespace OpenMesh;

/// Takes vertices and faces as they come and nothing else.
class SoupImporter final : public IO::BaseImporter {
 public:
  SoupImporter(const PlainMesh& mesh, const Progress* progress)
      : max_points_(mesh.positions.empty() ? 3 * mesh.polygons : mesh.positions.size()),
        max_triangles_(mesh.triangles),
        progress_(progress) {}

  LibraryMesh result;

  VertexHandle add_vertex(const Vec3f& point) override {
    if (stop_at(progress_, result.points.size())) throw StopReading{cancelled()};
    if (result.points.size() >= max_points_) stop("more vertices than expected");
    result.points.push_back({point[0], point[1], point[2]});
    return VertexHandle(int(result.points.size() - 1));
  }
  VertexHandle add_vertex() override { return add_vertex(Vec3f(0, 0, 0)); }
  void set_point(VertexHandle vertex, const Vec3f& point) override {
    if (!vertex.is_valid() || std::size_t(vertex.idx()) >= result.points.size())
      stop("a vertex that is not there");
    result.points[std::size_t(vertex.idx())] = {point[0], point[1], point[2]};
  }
  FaceHandle add_face(const VHandles& corners) override {
    if (stop_at(progress_, result.triangles.size())) throw StopReading{cancelled()};
    if (corners.size() != 3 || result.triangles.size() >= max_triangles_) stop("more faces than expected");
    Triangle triangle{};
    for (std::size_t i = 0; i < 3; ++i) {
      if (!corners[i].is_valid() || std::size_t(corners[i].idx()) >= result.points.size())
        stop("a face with a vertex that is not there");
      triangle[i] = std::uint32_t(corners[i].idx());
    }
    result.triangles.push_back(triangle);
    return FaceHandle(int(result.triangles.size() - 1));
  }

  // No half-edges, properties, textures or colours are asked for.
  HalfedgeHandle add_edge(VertexHandle, VertexHandle) override { return HalfedgeHandle(); }
  FaceHandle add_face(HalfedgeHandle) override { return FaceHandle(); }
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec2f>&) override {}
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec3f>&) override {}
  void set_face_texindex(FaceHandle, int) override {}
  void set_halfedge(VertexHandle, HalfedgeHandle) override {}
  void set_normal(VertexHandle, const Vec3f&) override {}
  void set_normal(VertexHandle, const Vec3d&) override {}
  void set_color(VertexHandle, const Vec3uc&) override {}
  void set_color(VertexHandle, const Vec4uc&) override {}
  void set_color(VertexHandle, const Vec3f&) override {}
  void set_color(VertexHandle, const Vec4f&) override {}
  void set_texcoord(VertexHandle, const Vec2f&) override {}
  void set_status(VertexHandle, const Attributes::StatusInfo&) override {}
  void set_next(HalfedgeHandle, HalfedgeHandle) override {}
  void set_face(HalfedgeHandle, FaceHandle) override {}
  void request_face_texcoords2D() override {}
  void set_texcoord(HalfedgeHandle, const Vec2f&) override {}
  void set_texcoord(VertexHandle, const Vec3f&) override {}
  void set_texcoord(HalfedgeHandle, const Vec3f&) override {}
  void set_status(HalfedgeHandle, const Attributes::StatusInfo&) override {}
  void set_color(EdgeHandle, const Vec3uc&) override {}
  void set_color(EdgeHandle, const Vec4uc&) override {}
  void set_color(EdgeHandle, const Vec3f&) override {}
  void set_color(EdgeHandle, const Vec4f&) override {}
  void set_status(EdgeHandle, const Attributes::StatusInfo&) override {}
  void set_normal(FaceHandle, const Vec3f&) override {}
  void set_normal(FaceHandle, const Vec3d&) override {}
  void set_color(FaceHandle, const Vec3uc&) override {}
  void set_color(FaceHandle, const Vec4uc&) override {}
  void set_color(FaceHandle, const Vec3f&) override {}
  void set_color(FaceHandle, const Vec4f&) override {}
  void set_status(FaceHandle, const Attributes::StatusInfo&) override {}
  void add_texture_information(int, std::string) override {}
  bool is_triangle_mesh() const override { return true; }
  size_t n_vertices() const override { return result.points.size(); }
  size_t n_faces() const override { return result.triangles.size(); }
  size_t n_edges() const override { return 0; }

 private:
  [[noreturn]] static void stop(const char* what) {
    throw StopReading{invalid_mesh(std::string("the mesh library found ") + what +
                                   " in the file; export the mesh again, in another format")};
  }

  std::uint64_t max_points_, max_triangles_;
  const Progress* progress_;
};

/// The library logs to the terminal; its messages say less than ours.
void silence() {
  omlog().disable();
  omout().disable();
  omerr().disable();
}

}  // namespace

Result<LibraryMesh> read_with_openmesh(const PlainMesh& mesh, const Progress* progress) {
  static std::mutex mutex;
  const std::lock_guard<std::mutex> lock(mutex);
  silence();
  SoupImporter importer(mesh, progress);
  IO::Options options = mesh.binary ? IO::Options::Binary : IO::Options::Default;
  try {
    ByteStream buffer(mesh.bytes);
    std::istream stream(&buffer);
    stream.imbue(std::locale::classic());
    if (!IO::IOManager().read(stream, mesh.extension, importer, options))
      return invalid_mesh("the mesh library cannot read the file; export the mesh again, in another format");
  } catch (const StopReading& reason) {
    return reason.error;
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimit, "there is not enough memory to read the mesh; use a smaller one"};
  } catch (const std::exception& exception) {
    return invalid_mesh(std::string("the mesh library gave up (") + exception.what() +
                        "); export the mesh again, in another format");
  }
  return std::move(importer.result);
}

}  // namespace mesocell
