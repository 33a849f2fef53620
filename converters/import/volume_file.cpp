#include "converters/import/volume_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "converters/image/extension.h"
#include "converters/image/input_file.h"
#include "converters/import/dds_pages.h"
#include "converters/import/picture_file.h"
#include "converters/import/slice_stack.h"
#include "converters/import/volume_slices.h"

namespace mesocell {
namespace {

constexpr std::uint32_t kMaxSide = 1024;
/// With that many channels a slice has 64 MB at most.
constexpr std::size_t kMaxChannels = 16;

Error invalid(std::string message) { return Error{ErrorCode::kInvalidInput, std::move(message)}; }

std::string sizes(const Index3& n) {
  return std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " + std::to_string(n[2]);
}

Status check_resolution(const Index3& n, std::uint32_t least, const VolumeReadOptions& options) {
  if (*std::min_element(n.begin(), n.end()) < least)
    return invalid(
        "the volume has " + sizes(n) + " voxels; at least " + std::to_string(least) +
        " are needed along each axis" +
        (n[2] == 1 ? ", and a picture is one slice: give a folder of them or a TIFF of several pages" : ""));
  if (*std::max_element(n.begin(), n.end()) > kMaxSide || n[2] > options.max_slices ||
      std::uint64_t{n[0]} * n[1] * n[2] > options.max_voxels)
    return Error{ErrorCode::kLimit,
                 "the volume has " + sizes(n) + " voxels; at most " + std::to_string(kMaxSide) +
                     " along each axis, " + std::to_string(options.max_slices) + " slices and " +
                     std::to_string(options.max_voxels) + " voxels are read, make it smaller"};
  return {};
}

PictureLimits limits(const VolumeReadOptions& options) {
  return {.max_file_bytes = options.max_file_bytes, .max_pages = options.max_slices, .max_side = kMaxSide};
}

/// Of a picture that is no slice.
Error in_volume(Error error) {
  if (error.code == ErrorCode::kInvalidInput && error.message.find("; ") == std::string::npos)
    error.message += std::string("; volumes are read from ") + kVolumeSources;
  return error;
}

/// What reading a volume needs all along.
struct Reading {
  const VolumeReadOptions& options;
  const Progress* progress;
  VolumeSlices& slices;
  ReadNotes* notes;        ///< may be null
  Index3 resolution{};     ///< z is known from the start, x and y from the first slice
  std::uint32_t done = 0;  ///< slices

  Status begin(std::uint32_t width, std::uint32_t height) {
    resolution[0] = width;
    resolution[1] = height;
    if (Status status = check_resolution(resolution, slices.least_side(), options); !status) return status;
    return slices.begin(resolution);
  }
  Status next() {
    if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
    if (progress && progress->report) progress->report("read slices", double(done) / resolution[2]);
    ++done;
    return {};
  }
};

/// Makes voxels of pages, each a slice; the reading lasts longer.
PageSink make_sink(Reading& reading, std::uint32_t stored_bits) {
  PageSink sink;
  sink.as_floats = reading.slices.as_floats();
  sink.begin = [&reading, stored_bits](const PageHeader& header) -> Status {
    if (header.channels.size() > kMaxChannels)
      return Error{ErrorCode::kLimit,
                   "it has " + std::to_string(header.channels.size()) + " channels; save it as gray or RGB"};
    if (reading.done == 0) {
      if (Status status = reading.begin(header.width, header.height); !status) return status;
    } else if (header.width != reading.resolution[0] || header.height != reading.resolution[1]) {
      return invalid("it has " + std::to_string(header.width) + " x " + std::to_string(header.height) +
                     " pixels, the first slice " + std::to_string(reading.resolution[0]) + " x " +
                     std::to_string(reading.resolution[1]) + "; all must have the same size");
    }
    if (Status status = reading.slices.check(header, stored_bits); !status) return status;
    if (reading.notes) reading.slices.note_losses(header, *reading.notes);
    return {};
  };
  sink.take = [&reading](std::uint32_t, PageSamples samples) -> Status {
    if (Status status = reading.next(); !status) return status;
    return reading.slices.append(samples);
  };
  return sink;
}

/// Reads all pages of a picture.
Status read_picture(const std::string& path, const PictureFile& picture, Reading& reading) {
  return read_pages(path, picture.format, picture.pages, make_sink(reading, picture.stored_bits));
}

/// The first bytes of a file, as many as there are.
std::string head_of(const std::string& path, std::size_t count) {
  const Result<InputFile> file = InputFile::open(path, UINT64_MAX);
  if (!file) return {};
  std::string head(std::size_t(std::min<std::uint64_t>(file->size(), count)), 0);
  if (!file->read_at(0, std::as_writable_bytes(std::span(head)))) return {};
  return head;
}

Status read_dds(const std::string& path, const std::string& head, Reading& reading) {
  const Result<DdsLayout> layout = parse_dds_header(head);
  if (!layout) return layout.error();
  reading.resolution[2] = layout->depth;
  if (reading.notes && layout->has_levels) reading.notes->lose("levels of detail");
  if (reading.notes && layout->has_alpha) reading.notes->lose("alpha");
  return read_dds_pages(path, reading.options.max_file_bytes, make_sink(reading, 8));
}

Status read_stack(const std::string& folder, Reading& reading) {
  const Result<std::vector<std::string>> names =
      list_slices(folder, {".png", ".tif", ".tiff", ".exr", ".hdr", ".jpg"}, reading.options.max_slices);
  if (!names) return names.error();
  reading.resolution[2] = std::uint32_t(names->size());
  for (const std::string& name : *names) {
    const auto in_slice = [&](Error error) {
      error.message = "slice '" + name + "': " + error.message;
      return error;
    };
    const std::string path = (std::filesystem::path(folder) / name).string();
    if (reading.notes) reading.notes->files.insert(path);
    const Result<PictureFile> picture = examine_picture(path, limits(reading.options));
    if (!picture) return in_slice(in_volume(picture.error()));
    if (picture->pages != 1)
      return in_slice(
          invalid("it has " + std::to_string(picture->pages) +
                  " pages, of which a slice has one; give the file without the folder, or take it apart"));
    if (Status status = read_picture(path, *picture, reading); !status) return in_slice(status.error());
  }
  return {};
}

/// Reads a .raw file of `unit_bytes`, one of the sizes that a voxel may have; `append` takes a slice's bytes.
template <typename Append>
Status read_raw(const std::string& path, Reading& reading, std::span<const std::uint32_t> voxel_bytes,
                const Append& append) {
  const Result<InputFile> file = InputFile::open(path, reading.options.max_file_bytes);
  if (!file) return file.error();
  if (!reading.options.raw_resolution)
    return Error{ErrorCode::kUsage,
                 "a .raw file does not say how many voxels it has along x, y and z; give its resolution"};
  const Index3 n = *reading.options.raw_resolution;
  reading.resolution = n;
  // Before the sizes are multiplied.
  if (Status status = check_resolution(n, reading.slices.least_side(), reading.options); !status)
    return status;
  const std::uint64_t voxels = std::uint64_t{n[0]} * n[1] * n[2];
  std::uint32_t bytes = 0;
  std::string possible;
  for (const std::uint32_t size : voxel_bytes) {
    if (file->size() == voxels * size) bytes = size;
    possible += (possible.empty() ? "" : " or ") + std::to_string(voxels * size);
  }
  if (bytes == 0)
    return invalid("it has " + std::to_string(file->size()) + " bytes; with " + sizes(n) +
                   " voxels it would have " + possible +
                   ", so the resolution is another, or the file has a header or is cut off");
  if (Status status = reading.begin(n[0], n[1]); !status) return status;
  std::vector<std::byte> slice(std::size_t{n[0]} * n[1] * bytes);
  for (std::uint32_t z = 0; z < n[2]; ++z) {
    if (Status status = reading.next(); !status) return status;
    if (!file->read_at(std::uint64_t{z} * slice.size(), slice))
      return Error{ErrorCode::kUnreadable, "it cannot be read to its end; check the disk"};
    append(slice, bytes);
  }
  return {};
}

/// Reads pictures, in a folder or as pages of a file.
Status read_pictures(const std::string& path, Reading& reading) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return read_stack(path, reading);
  if (const std::string head = head_of(path, 128); is_dds(head)) return read_dds(path, head, reading);
  const Result<PictureFile> picture = examine_picture(path, limits(reading.options));
  if (!picture) return in_volume(picture.error());
  reading.resolution[2] = picture->pages;
  return read_picture(path, *picture, reading);
}

}  // namespace

bool is_raw_volume(const std::string& path) {
  std::error_code error;
  return lower_extension(path) == ".raw" && !std::filesystem::is_directory(path, error);
}

Result<LabelVolume> read_label_volume(const std::string& path, const VolumeReadOptions& options,
                                      const Progress* progress, ReadNotes* notes) {
  LabelSlices slices;
  Reading reading{options, progress, slices, notes};
  const auto append = [&](std::span<const std::byte> bytes, std::uint32_t size) {
    for (std::size_t i = 0; i < bytes.size(); i += size) {
      std::uint32_t label = 0;
      for (std::uint32_t k = 0; k < size; ++k) label |= std::uint32_t(bytes[i + k]) << (8 * k);
      slices.volume.labels.push_back(label);
    }
  };
  constexpr std::array<std::uint32_t, 3> sizes_of_labels = {1, 2, 4};
  Status status =
      is_raw_volume(path) ? read_raw(path, reading, sizes_of_labels, append) : read_pictures(path, reading);
  if (!status) return status.error();
  return std::move(slices.volume);
}

Result<ColorMap> read_color_volume(const std::string& path, const VolumeReadOptions& options,
                                   const Progress* progress, ReadNotes* notes) {
  ColorSlices slices;
  Reading reading{options, progress, slices, notes};
  const auto append = [&](std::span<const std::byte> bytes, std::uint32_t size) {
    for (std::size_t i = 0; i < bytes.size(); i += size) {
      const auto channel = [&](std::size_t k) { return std::uint8_t(bytes[i + (size == 3 ? k : 0)]); };
      slices.map.voxels.push_back({channel(0), channel(1), channel(2)});
    }
  };
  constexpr std::array<std::uint32_t, 2> sizes_of_colors = {1, 3};
  Status status =
      is_raw_volume(path) ? read_raw(path, reading, sizes_of_colors, append) : read_pictures(path, reading);
  if (!status) return status.error();
  return std::move(slices.map);
}

Result<ScalarVolume> read_scalar_volume(const std::string& path, const VolumeReadOptions& options,
                                        const Progress* progress, ReadNotes* notes) {
  ScalarSlices slices;
  Reading reading{options, progress, slices, notes};
  const auto append = [&](std::span<const std::byte> bytes, std::uint32_t size) {
    for (std::size_t i = 0; i < bytes.size(); i += size) {
      std::uint32_t value = 0;
      for (std::uint32_t k = 0; k < size; ++k) value |= std::uint32_t(bytes[i + k]) << (8 * k);
      slices.values.push_back(size == 4 ? float_sample(value) : float(value));
    }
  };
  constexpr std::array<std::uint32_t, 3> sizes_of_numbers = {1, 2, 4};
  Status status =
      is_raw_volume(path) ? read_raw(path, reading, sizes_of_numbers, append) : read_pictures(path, reading);
  if (!status) return status.error();
  return ScalarVolume{slices.resolution, std::move(slices.values)};
}

bool is_slice_stack(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return true;
  if (is_dds(head_of(path, 128))) return true;
  const Result<PictureFile> picture = examine_picture(path, limits({}));
  return picture && picture->pages > 1;
}

}  // namespace mesocell
