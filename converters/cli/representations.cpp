#include "converters/cli/representations.h"

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "converters/cli/cell_object_asset.h"
#include "converters/cli/commands.h"
#include "format/fourcc.h"
#include "format/representation.h"

namespace mesocell {
namespace {

/// What the command knows of a representation. Another representation is one more row.
struct Row {
  std::uint32_t code;
  Result<std::unique_ptr<Asset>> (*load)(const Container&, const ReadLimits&);
};

constexpr std::array<Row, 1> kRows = {{{fourcc("CELL"), load_cell_object}}};

}  // namespace

Result<AssetFile> read_asset(std::span<const std::byte> bytes, const ReadLimits& limits) {
  Result<Container> container = Container::open(bytes, limits);
  if (!container) return container.error();
  if (Status status = container->verify(); !status) return status.error();
  for (const Row& row : kRows) {
    if (row.code != container->representation()) continue;
    Result<std::unique_ptr<Asset>> asset = row.load(*container, limits);
    if (!asset) return asset.error();
    const Representation* representation = find_representation(row.code);
    AssetFile file;
    file.asset = std::move(*asset);
    file.format = "meso " + std::to_string(container->major()) + "." + std::to_string(container->minor());
    file.representation = representation ? std::string(representation->name) : fourcc_text(row.code);
    file.chunks.assign(container->chunks().begin(), container->chunks().end());
    file.file_bytes = container->file_bytes();
    return file;
  }
  return Error{ErrorCode::kInvalidInput, "this program does not know the representation " +
                                             fourcc_text(container->representation()) + "; use a newer one"};
}

Result<AssetFile> read_asset_file(const std::string& path, const ReadLimits& limits) {
  const Result<std::vector<std::byte>> bytes = read_input(path, limits.max_file_bytes);
  if (!bytes) return bytes.error();
  Result<AssetFile> file = read_asset(*bytes, limits);
  // A file that is a .meso at all may have more faults than the first.
  if (file || file.error().code != ErrorCode::kInvalidInput || file.error().id == "header-magic") return file;
  Error error = file.error();
  error.message += "; mesocell validate lists every fault of the file";
  return error;
}

nlohmann::ordered_json describe_asset(const AssetFile& file) {
  nlohmann::ordered_json info;
  info["format"] = file.format;
  info["representation"] = file.representation;
  file.asset->describe(info);
  info["chunks"] = nlohmann::ordered_json::array();
  for (const ChunkInfo& chunk : file.chunks)
    info["chunks"].push_back(
        {{"type", fourcc_text(chunk.type)}, {"bytes", chunk.decoded_bytes}, {"stored", chunk.stored_bytes}});
  info["file_bytes"] = file.file_bytes;
  return info;
}

std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace mesocell
