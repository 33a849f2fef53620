#pragma once

#include <cstdint>
#include <vector>

namespace mesocell {

/// Cuts a polygon into a fan about its first corner. Triangles with two equal corners enclose nothing and are
/// counted in `dropped`. Calls `emit(a, b, c, i)` for the others, which are of the corners 0, i - 1 and i.
template <typename Emit>
void cut_into_fan(const std::vector<std::uint32_t>& polygon, std::uint64_t& dropped, Emit emit) {
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const std::uint32_t a = polygon[0], b = polygon[i - 1], c = polygon[i];
    if (a == b || b == c || c == a)
      ++dropped;
    else
      emit(a, b, c, i);
  }
}

/// More vertices or faces than this cannot be indexed by the library.
inline constexpr std::uint64_t kMaxMeshElements = 0x7fff'fff0;

}  // namespace mesocell
