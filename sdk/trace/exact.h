#pragma once

#include <memory>
#include <span>

#include "format/cell_object.h"
#include "sdk/trace/caster.h"

namespace mesocell {

/// Exact tracing: the first voxel that the ray visits which is of an INSIDE instance. [spec 4.9] Steps over
/// empty tiles, over instances that are not INSIDE and over empty space are as large as is known to be safe.
/// all_hits() is exact as well: a stretch is voxels that the ray visits one after the other. Where it is left
/// by an edge or a corner, the face is that of the first axis on which the ray rises, else of the first.
class ExactCaster : public Caster {
 public:
  [[nodiscard]] static std::unique_ptr<ExactCaster> make(const CellObject& object);

  /// How far all of the rays are known to go through empty tiles before any of them may hit, metres; infinite
  /// if none does, 0 if they begin at different points or go different ways.
  [[nodiscard]] virtual double empty_way(std::span<const Ray> rays) const = 0;
};

[[nodiscard]] std::unique_ptr<Caster> make_exact_caster(const CellObject& object);

}  // namespace mesocell
