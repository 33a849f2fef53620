#include "sdk/surface/vertex_fans.h"

namespace mesocell {
namespace {

constexpr std::size_t kFaces = 12;

using Bits = std::array<std::size_t, 3>;  ///< of a voxel around the point

bool solid(std::uint8_t configuration, const Bits& d) {
  return configuration >> (d[0] + 2 * d[1] + 4 * d[2]) & 1;
}

/// The place of the face of voxel `d` towards the other side of the point on `axis`.
std::size_t face_of(std::size_t axis, const Bits& d) {
  return fan_face(axis, d[(axis + 1) % 3], d[(axis + 2) % 3]);
}

/// The edge from the point along an axis: the four voxels around it, in turn.
struct EdgeVoxels {
  std::array<Bits, 4> voxels;
  std::size_t u, w;  ///< the other axes

  EdgeVoxels(std::size_t axis, std::size_t up) : u((axis + 1) % 3), w((axis + 2) % 3) {
    constexpr std::size_t kAround[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (std::size_t k = 0; k < 4; ++k) {
      voxels[k][axis] = up;
      voxels[k][u] = kAround[k][0];
      voxels[k][w] = kAround[k][1];
    }
  }
  /// Four faces meet here.
  [[nodiscard]] bool crossed(std::uint8_t c) const {
    return solid(c, voxels[0]) == solid(c, voxels[2]) && solid(c, voxels[1]) == solid(c, voxels[3]) &&
           solid(c, voxels[0]) != solid(c, voxels[1]);
  }
};

/// Sets of faces: each has the least of its set.
class FaceSets {
 public:
  FaceSets() {
    for (std::size_t f = 0; f < kFaces; ++f) least_[f] = std::uint8_t(f);
  }
  [[nodiscard]] std::uint8_t operator[](std::size_t f) const { return least_[f]; }
  void join(std::size_t a, std::size_t b) {
    const std::uint8_t keep = least_[a] < least_[b] ? least_[a] : least_[b];
    const std::uint8_t gone = least_[a] < least_[b] ? least_[b] : least_[a];
    for (std::uint8_t& l : least_)
      if (l == gone) l = keep;
  }

 private:
  std::array<std::uint8_t, kFaces> least_{};
};

FaceSets join_faces(std::uint8_t c, std::uint8_t turned) {
  FaceSets sets;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t up = 0; up < 2; ++up) {
      const EdgeVoxels edge(axis, up);
      if (edge.crossed(c)) {
        const bool of_empty = turned >> (2 * axis + up) & 1;
        for (const Bits& d : edge.voxels)
          if (solid(c, d) != of_empty) sets.join(face_of(edge.u, d), face_of(edge.w, d));
        continue;
      }
      // The two faces that meet here, if there are any.
      std::size_t first = kFaces;
      for (std::size_t k = 0; k < 4; ++k) {
        const Bits &d = edge.voxels[k], &next = edge.voxels[(k + 1) % 4];
        if (solid(c, d) == solid(c, next)) continue;
        const std::size_t face = face_of(k % 2 == 0 ? edge.u : edge.w, d);
        if (first == kFaces)
          first = face;
        else
          sets.join(first, face);
      }
    }
  return sets;
}

/// Calls body(face) for the faces that are there.
template <typename Body>
void each_face(std::uint8_t c, const Body& body) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t quarter = 0; quarter < 4; ++quarter) {
      Bits low{}, high{};
      low[(axis + 1) % 3] = high[(axis + 1) % 3] = quarter & 1;
      low[(axis + 2) % 3] = high[(axis + 2) % 3] = quarter >> 1;
      high[axis] = 1;
      if (solid(c, low) != solid(c, high)) body(4 * axis + quarter);
    }
}

FanTable make_table() {
  FanTable table{};
  for (std::size_t k = 0; k < 256; ++k) {
    const auto c = std::uint8_t(k);
    const FaceSets sets = join_faces(c, 0);
    table.fans[k] = find_fans(c, 0);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t up = 0; up < 2; ++up) {
        const EdgeVoxels edge(axis, up);
        if (edge.crossed(c) && sets[face_of(edge.u, edge.voxels[0])] == sets[face_of(edge.u, edge.voxels[2])])
          table.doubled[k] = std::uint8_t(table.doubled[k] | 1u << (2 * axis + up));
      }
    table.plain[k] = table.fans[k].count == 1 && table.doubled[k] == 0;
  }
  return table;
}

}  // namespace

VertexFans find_fans(std::uint8_t configuration, std::uint8_t turned) {
  const FaceSets sets = join_faces(configuration, turned);
  VertexFans fans;
  std::array<std::uint8_t, kFaces> number{};
  each_face(configuration, [&](std::size_t face) {
    if (sets[face] == face) number[face] = fans.count++;
    fans.of_face[face] = number[sets[face]];
  });
  return fans;
}

const FanTable& fan_table() {
  static const FanTable table = make_table();
  return table;
}

}  // namespace mesocell
