#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "format/api.h"
#include "sdk/core/progress.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/membership/open_solid.h"
#include "sdk/membership/scanline.h"
#include "sdk/membership/solid.h"

namespace mesocell MESOCELL_INTERNAL_API {

/// Inside and outside of any mesh at voxel centres, row by row: a Scanline over the mesh, turned and closed
/// as it needs. [spec 4.3]
class SolidScan {
 public:
  /// As Scanline and OpenSolid have it; `mesh` may be open, and is kept by reference. Cancelled, what it says
  /// means nothing.
  SolidScan(const TriangleMesh& mesh, const Index3& resolution, const Index3& tiles,
            SolidRule solid = SolidRule::kNonzero, unsigned threads = 0, const Progress* progress = nullptr);
  SolidScan(const SolidScan&) = delete;
  SolidScan& operator=(const SolidScan&) = delete;

  /// The rows of the tiles (·, ty, tz). Thread safety: const; the rest belongs to the caller.
  void bundle(std::uint32_t ty, std::uint32_t tz, Scanline::Scratch& scratch, RowIntervals& out) const {
    scanline_->bundle(ty, tz, scratch, out);
  }
  /// See Scanline::triangles(); those from mesh.triangles.size() on are caps.
  [[nodiscard]] std::span<const std::uint32_t> triangles(std::uint32_t ty, std::uint32_t tz) const {
    return scanline_->triangles(ty, tz);
  }
  /// Of the mesh, as often as its boundary runs along them.
  [[nodiscard]] std::uint64_t boundary_edges() const { return boundary_edges_; }

 private:
  std::optional<TriangleMesh> outward_;
  std::uint64_t boundary_edges_ = 0;
  std::optional<OpenSolid> open_;
  std::optional<Scanline> scanline_;
};

}  // namespace mesocell
