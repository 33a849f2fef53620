#include "converters/export/image_stack.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <system_error>

#include "converters/export/output_folder.h"
#include "converters/image/extension.h"
#include "converters/image/page_writer.h"
#include "format/file.h"
#include "format/normal_map.h"
#include "sdk/core/srgb.h"

namespace mesocell {
namespace {

/// A stack's samples, before they have a place in a file.
struct Stack {
  Index3 resolution{};
  std::vector<std::string> channels;
  PageSampleType type = PageSampleType::kUint8;
  std::vector<std::byte> samples;
  std::vector<std::string> losses;
};

template <typename T>
void store(T value, std::byte* to) {
  std::memcpy(to, &value, sizeof(T));
}

/// Fills the samples: `put(voxel, to)` writes those of a voxel in storage order at `to`; rows go from the
/// top.
void fill(Stack& stack, const std::function<void(std::uint64_t voxel, std::byte* to)>& put) {
  const Index3& n = stack.resolution;
  const std::size_t pixel = stack.channels.size() * page_sample_bytes(stack.type);
  stack.samples.resize(std::size_t{n[0]} * n[1] * n[2] * pixel);
  std::byte* to = stack.samples.data();
  for (std::uint32_t z = 0; z < n[2]; ++z)
    for (std::uint32_t row = 0; row < n[1]; ++row)
      for (std::uint32_t x = 0; x < n[0]; ++x, to += pixel)
        put(x + std::uint64_t{n[0]} * ((n[1] - 1 - row) + std::uint64_t{n[1]} * z), to);
}

Stack cell_stack(const TileMap& tile, bool floats) {
  Stack stack;
  stack.resolution = tile.resolution;
  stack.channels = {"Y"};
  stack.type = floats                    ? PageSampleType::kFloat
               : tile.cell_count <= 0xff ? PageSampleType::kUint8
                                         : PageSampleType::kUint16;
  fill(stack, [&](std::uint64_t voxel, std::byte* to) {
    const std::uint32_t id = tile.id(voxel), cell = id == 0 ? 0 : tile.pieces[id - 1].cell;
    if (stack.type == PageSampleType::kFloat)
      store(float(cell), to);
    else if (stack.type == PageSampleType::kUint8)
      store(std::uint8_t(cell), to);
    else
      store(std::uint16_t(cell), to);
  });
  stack.losses.emplace_back(
      "to which tile a cell belongs; parts that touch as one cell, around the tile, stay one");
  return stack;
}

Stack color_stack(const ColorMap& map, bool floats) {
  Stack stack;
  stack.resolution = map.resolution;
  stack.channels = {"R", "G", "B"};
  stack.type = floats ? PageSampleType::kFloat : PageSampleType::kSrgb8;
  fill(stack, [&](std::uint64_t voxel, std::byte* to) {
    const Rgb8& color = map.voxels[voxel];
    const Vec3 linear = srgb_to_linear(color);
    for (std::size_t c = 0; c < 3; ++c) {
      if (floats)
        store(float(linear[c]), to + c * sizeof(float));
      else
        store(color[c], to + c);
    }
  });
  return stack;
}

Stack normal_stack(const TileMap& tile, const NormalMap& normals, bool floats) {
  Stack stack;
  stack.resolution = tile.resolution;
  stack.channels = {"R", "G", "B"};
  stack.type = floats ? PageSampleType::kFloat : PageSampleType::kUint8;
  const std::vector<std::uint8_t> boundary = boundary_voxels(tile);
  std::vector<std::uint32_t> number(boundary.size());
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < boundary.size(); ++i) {
    number[i] = next;
    next += boundary[i];
  }
  fill(stack, [&](std::uint64_t voxel, std::byte* to) {
    std::array<double, 3> n{};
    if (boundary[voxel]) n = decode_normal(normals.normals[number[voxel]]);
    for (std::size_t c = 0; c < 3; ++c) {
      if (floats)
        store(float(n[c]), to + c * sizeof(float));
      else
        store(std::uint8_t(boundary[voxel] ? std::lround(128 + 127 * n[c]) : 0), to + c);
    }
  });
  if (!floats) stack.losses.emplace_back("normals were rounded to 1/127 of each component");
  return stack;
}

Result<Stack> make_stack(const CellObject& object, StackMap map, bool floats) {
  switch (map) {
    case StackMap::kCells:
      return cell_stack(object.tile, floats);
    case StackMap::kColors:
      if (!object.color)
        return Error{ErrorCode::kUsage,
                     "the object has no colors in its tile; convert with --color marble, …"};
      return color_stack(*object.color, floats);
    case StackMap::kNormals:
      break;
  }
  if (!object.normals) return Error{ErrorCode::kUsage, "the object has no normals; convert with --normals"};
  return normal_stack(object.tile, *object.normals, floats);
}

PageStack pages_of(const Stack& stack, std::uint32_t first, std::uint32_t count) {
  const std::size_t page = stack.samples.size() / stack.resolution[2];
  return {.width = stack.resolution[0],
          .height = stack.resolution[1],
          .pages = count,
          .channels = stack.channels,
          .type = stack.type,
          .samples = std::span(stack.samples).subspan(first * page, count * page)};
}

Status write_folder(const Stack& stack, const std::string& path, bool no_clobber, StackExportReport& report,
                    const Progress* progress) {
  Result<OutputFolder> folder = OutputFolder::create(path, no_clobber);
  if (!folder) return folder.error();
  const char* extension = stack.type == PageSampleType::kFloat ? ".exr" : ".png";
  for (std::uint32_t z = 0; z < stack.resolution[2]; ++z) {
    if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "interrupted"};
    if (progress && progress->report) progress->report("write slices", double(z) / stack.resolution[2]);
    char name[32];
    std::snprintf(name, sizeof name, "%04u%s", z, extension);
    const Result<std::vector<std::byte>> bytes = encode_pages(name, pages_of(stack, z, 1));
    if (!bytes) return bytes.error();
    if (Status status = folder->write(name, *bytes); !status) return status;
    report.bytes += bytes->size();
  }
  return folder->commit();
}

}  // namespace

Status write_image_stack(const CellObject& object, StackMap map, const std::string& path, bool no_clobber,
                         StackExportReport* report, const Progress* progress) {
  StackExportReport unused;
  StackExportReport& out = report ? *report : unused;
  out = {};
  std::error_code error;
  const std::string extension = lower_extension(path);
  const bool folder = path.ends_with('/') || extension.empty() || std::filesystem::is_directory(path, error);
  if (!folder && extension != ".tif" && extension != ".tiff" && extension != ".exr")
    return Error{ErrorCode::kUsage,
                 "a stack of pictures is a folder, a .tif of several pages or an .exr of several parts"};
  const bool floats = extension == ".exr" || (folder && map == StackMap::kNormals);
  const Result<Stack> stack = make_stack(object, map, floats);
  if (!stack) return stack.error();
  out.slices = stack->resolution[2];
  out.losses = stack->losses;
  if (folder) return write_folder(*stack, path, no_clobber, out, progress);
  const Result<std::vector<std::byte>> bytes = encode_pages(path, pages_of(*stack, 0, stack->resolution[2]));
  if (!bytes) return bytes.error();
  out.bytes = bytes->size();
  return write_file(path, *bytes, no_clobber);
}

}  // namespace mesocell
