#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "converters/import/read_notes.h"
#include "format/cell_object.h"
#include "format/result.h"
#include "sdk/core/progress.h"
#include "sdk/tiles/labels.h"

namespace mesocell {

struct VolumeReadOptions {
  std::optional<Index3> raw_resolution;  ///< voxels along x, y, z of a .raw file; of no meaning for others
  std::uint64_t max_file_bytes = std::uint64_t{1} << 32;  ///< of each file
  std::uint64_t max_voxels = std::uint64_t{1} << 30;
  std::uint32_t max_slices = 1024;
};

/// What volumes are read from, for messages and help texts.
inline constexpr const char* kVolumeSources =
    "a folder of pictures (.png, .tif, .tiff, .exr, .hdr, .jpg), each a slice; a TIFF, each page a slice; a "
    "volume texture .dds; or a .raw file with its resolution";
/// How a volume's axes lie, for help texts.
inline constexpr const char* kVolumeAxes =
    "The slices of a folder are z = 0, 1, 2, … in the natural order of their names (slice2 before slice10), "
    "the pages "
    "of a TIFF in their order. The columns of a slice are x from the left, its rows y from the bottom: the "
    "top row is "
    "the largest y. A .raw file has x fastest, then y, then z, from the minimum corner, little-endian.";

/// Whether a path is read as a .raw file, which needs VolumeReadOptions::raw_resolution: by its extension,
/// any case.
[[nodiscard]] bool is_raw_volume(const std::string& path);

/// Reads a volume of labels, 4 to 1024 voxels along each axis, exactly.
/// - A folder is a stack of slices, all of one extension and size, a page each; hidden files (.name) are
/// passed over,
///   whatever else is in it is refused. A picture is what its content says, whatever its extension.
/// - Gray pictures of integers (of 1 to 32 bits; negative ones are refused): the value is the label. Of
/// floats: the
///   same if all are whole numbers. Slices must have equal bits.
/// - Colors of 8 bits a channel, also from a palette: the label is r + 256 g + 65536 b. So each color is a
/// label, and
///   black is empty. Alpha is ignored.
/// - .raw: 8, 16 or 32 bits a label, as the file's size tells; its size must fit exactly.
/// - Axes: kVolumeAxes.
/// Untrusted input: sizes are checked before memory is taken; directories of TIFF and headers of EXR files
/// are checked in full before the image library sees them; the decoders are those of the image library. A
/// page takes at most 64 MB, the volume 4 bytes a voxel. Errors, all with a remedy: kUsage (.raw without a
/// resolution), kUnreadable (missing, no plain file, no image module), kInvalidInput (not one of the above,
/// damaged, too few slices, sizes that differ, values that are not labels, lossy compression), kLimit,
/// kCancelled (found between slices). `notes`: the files of a folder.
[[nodiscard]] Result<LabelVolume> read_label_volume(const std::string& path,
                                                    const VolumeReadOptions& options = {},
                                                    const Progress* progress = nullptr,
                                                    ReadNotes* notes = nullptr);

/// Reads a volume of colors, 1 to 1024 voxels along each axis; a single picture is one slice. Sources, axes
/// and errors are those of read_label_volume(), but: gray becomes R = G = B; alpha is ignored; sRGB of 8 bits
/// a channel stays as it is, other depths are rounded to it; linear light (floats, and files that say that
/// they are linear) is turned to sRGB, clamped to 0…1. .raw: 8 bits a channel, gray or RGB as the file's size
/// tells.
[[nodiscard]] Result<ColorMap> read_color_volume(const std::string& path,
                                                 const VolumeReadOptions& options = {},
                                                 const Progress* progress = nullptr,
                                                 ReadNotes* notes = nullptr);

/// Numbers on a grid, of which a surface can be taken.
struct ScalarVolume {
  Index3 resolution{};        ///< voxels along x, y, z
  std::vector<float> values;  ///< x fastest; integers as they stand
};

/// Reads a volume of numbers, 2 to 1024 voxels along each axis: the first channel of what read_label_volume()
/// is given, also where its compression is lossy; .raw: 8 or 16 bits, or floats of 32, as the file's size
/// tells. Errors are those.
[[nodiscard]] Result<ScalarVolume> read_scalar_volume(const std::string& path,
                                                      const VolumeReadOptions& options = {},
                                                      const Progress* progress = nullptr,
                                                      ReadNotes* notes = nullptr);

/// Whether a path is several slices, by what is there: a folder, a TIFF of several pages or a volume texture.
[[nodiscard]] bool is_slice_stack(const std::string& path);

}  // namespace mesocell
