#pragma once

#include <cstdint>
#include <string>

#include "converters/vdb/sparse_volume.h"
#include "sdk/core/rng.h"

namespace mesocell::test {

/// A volume with leaves and tiles of all sizes at random places about the origin, whose numbers are random:
/// of floats in [-1, 1), of whole numbers 0 to 3. The background is 1 for level sets, else 0.
[[nodiscard]] SparseVolume random_volume(Rng& rng, VolumeType type, VolumeClass volume_class);

/// A map that turns, shears and scales each axis otherwise.
[[nodiscard]] Transform random_transform(Rng& rng);

/// A level set of a ball about the origin, exact within a band of three voxels, of `edge` each.
[[nodiscard]] SparseVolume ball_volume(double radius, double edge);

/// All bytes of a file.
[[nodiscard]] std::string content(const std::string& path);

}  // namespace mesocell::test
