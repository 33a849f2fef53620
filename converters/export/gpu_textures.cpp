#include "converters/export/gpu_textures.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "converters/image/extension.h"
#include "format/byte_writer.h"
#include "format/file.h"
#include "sdk/trace/gpu_maps.h"

namespace mesocell {

Status write_gpu_textures(const CellObject& object, const std::string& path, bool no_clobber,
                          std::uint64_t* bytes) {
  if (lower_extension(path) != ".json")
    return Error{ErrorCode::kUsage,
                 "textures for a GPU are raw files beside a .json; give the output that extension"};
  const Result<GpuMaps> maps = make_gpu_maps(object);
  if (!maps) return maps.error();
  const std::filesystem::path target = path;
  nlohmann::ordered_json json;
  json["generator"] = "mesocell";
  json["box_min"] = object.grid.box_min;
  json["box_max"] = object.box_max();
  json["voxel_edge"] = object.grid.voxel_edge;
  json["tiles"] = maps->tiles;
  json["tile_resolution"] = maps->resolution;
  json["split_cells"] = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < maps->cells.size(); ++k)
    json["split_cells"].push_back(
        {{"cell", maps->cells[k]}, {"home", object.tile.pieces[k].home}, {"faces", maps->face_codes[k]}});
  std::uint64_t total = 0;
  const auto write = [&](const char* key, const std::string& suffix, const char* format, const Index3& size,
                         std::span<const std::byte> data) -> Status {
    const std::string name = target.stem().string() + suffix;
    json["textures"][key] = {{"file", name}, {"format", format}, {"size", size}, {"bytes", data.size()}};
    total += data.size();
    return write_file((target.parent_path() / name).string(), data, no_clobber);
  };
  if (Status status =
          write("tile", ".tile.r8", "R8_UINT", maps->resolution, std::as_bytes(std::span(maps->split_cells)));
      !status)
    return status;
  ByteWriter codes;
  codes.reserve(maps->tile_codes.size() * 16);
  for (const auto& texel : maps->tile_codes)
    for (const std::uint32_t word : texel) codes.u32(word);
  if (Status status = write("membership", ".membership.rgba32ui", "RGBA32_UINT", maps->tiles, codes.bytes());
      !status)
    return status;
  if (object.color) {
    ByteWriter colors;
    colors.reserve(object.color->voxels.size() * 4);
    for (const Rgb8& c : object.color->voxels) {
      for (const std::uint8_t channel : c) colors.u8(channel);
      colors.u8(255);
    }
    if (Status status =
            write("color", ".color.rgba8", "RGBA8_SRGB", object.color->resolution, colors.bytes());
        !status)
      return status;
  }
  const std::string text = json.dump(2) + "\n";
  if (bytes) *bytes = total + text.size();
  return write_file(path, std::as_bytes(std::span(text)), no_clobber);
}

}  // namespace mesocell
