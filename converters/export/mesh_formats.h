#pragma once

#include "converters/export/file_stream.h"
#include "converters/export/mesh_writer.h"

/// One writer a format. Each writes to `out`, and stops where `keep_on` says so; the caller finishes the
/// file.
namespace mesocell {

/// Counts what has been written, of vertices and triangles together, and tells whether to go on.
class WriteProgress {
 public:
  WriteProgress(const MeshView& mesh, const FileStream& out, const Progress* progress)
      : total_(mesh.vertex_count + mesh.triangle_count), out_(out), progress_(progress) {}
  [[nodiscard]] bool keep_on() {
    if ((done_++ & 0xffff) != 0) return true;
    if (progress_ && progress_->report) progress_->report("writing", double(done_) / double(total_ + 1));
    return out_.ok() && !(progress_ && progress_->cancelled());
  }

 private:
  std::uint64_t done_ = 0, total_;
  const FileStream& out_;
  const Progress* progress_;
};

void write_obj(const MeshView& mesh, FileStream& out, WriteProgress& progress);
void write_off(const MeshView& mesh, FileStream& out, WriteProgress& progress);
void write_ply(const MeshView& mesh, FileStream& out, WriteProgress& progress);
void write_stl(const MeshView& mesh, FileStream& out, WriteProgress& progress);

/// What single precision does to positions.
struct SingleRounding {
  double greatest_move = 0;  ///< of a vertex, metres
  bool merges = false;       ///< vertices at different places are at one
};
[[nodiscard]] SingleRounding round_to_single(const MeshView& mesh);

}  // namespace mesocell
