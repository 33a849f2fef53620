#include "converters/cli/representations.h"

#include "format/cell_object_io.h"

#include <array>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "converters/cli/cell_object_asset.h"
#include "converters/cli/commands.h"
#include "format/fourcc.h"
#include "format/representation.h"

namespace mesocell {
namespace {

/// What the command knows of a representation. Another representation is one more row.
struct Loader {
  std::uint32_t code;
  Result<std::unique_ptr<Asset>> (*load)(const Container&, const ReadLimits&, std::size_t asset);
};

constexpr std::array<Loader, 1> kLoaders = {{{fourcc("CELL"), load_cell_object}}};

Result<NamedAsset> load(const Container& container, std::size_t index, const ReadLimits& limits) {
  if (Status status = container.verify(index); !status) return status.error();
  const AssetInfo& info = container.assets()[index];
  for (const Loader& row : kLoaders) {
    if (row.code != info.representation) continue;
    Result<std::unique_ptr<Asset>> asset = row.load(container, limits, index);
    if (!asset) return asset.error();
    NamedAsset named;
    named.asset = std::move(*asset);
    named.name = info.name;
    named.representation = info.rules ? std::string(info.rules->name) : fourcc_text(row.code);
    const auto chunks = container.chunks_of(index);
    named.chunks.assign(chunks.begin(), chunks.end());
    return named;
  }
  return Error{ErrorCode::kInvalidInput, "this program does not know the representation " +
                                             fourcc_text(info.representation) + "; use a newer one"};
}

Result<AssetFile> read_path(const std::string& path, bool whole, const ReadLimits& limits) {
  AssetPath place = parse_asset_path(path);
  const Result<std::vector<std::byte>> bytes = read_input(place.file, limits.max_file_bytes);
  if (!bytes) return bytes.error();
  if (!place.asset && !whole) place.asset = "0";
  Result<AssetFile> file = read_assets(*bytes, place.asset, limits);
  // A file that is a .meso at all may have more faults than the first.
  if (file || file.error().code != ErrorCode::kInvalidInput || file.error().id == "header-magic") return file;
  Error error = file.error();
  error.message += "; mesocell validate lists every fault of the file";
  return error;
}

nlohmann::ordered_json describe_chunks(const std::vector<ChunkInfo>& chunks) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ChunkInfo& chunk : chunks)
    list.push_back({{"type", fourcc_text(chunk.type)},
                    {"bytes", chunk.decoded_bytes},
                    {"stored", chunk.stored_bytes},
                    {"codec", chunk.codec == kCodecRaw ? "raw" : "zstd"},
                    {"blocks", chunk.block_count()}});
  return list;
}

void describe(const NamedAsset& asset, nlohmann::ordered_json& info) {
  info["representation"] = asset.representation;
  asset.asset->describe(info);
  info["chunks"] = describe_chunks(asset.chunks);
}

}  // namespace

AssetPath parse_asset_path(const std::string& text) {
  const std::size_t hash = text.rfind('#');
  std::error_code error;
  if (hash == std::string::npos || !has_extension(text.substr(0, hash), ".meso") ||
      std::filesystem::exists(text, error))
    return {text, std::nullopt};
  return {text.substr(0, hash), text.substr(hash + 1)};
}

bool is_asset_path(const std::string& text) { return has_extension(parse_asset_path(text).file, ".meso"); }

Result<std::size_t> find_asset(std::span<const AssetInfo> assets, const std::optional<std::string>& asset) {
  if (!asset) return std::size_t{0};
  std::string names;
  for (std::size_t i = 0; i < assets.size(); ++i) {
    if (!assets[i].name.empty() && assets[i].name == *asset) return i;
    if (names.size() < 200)
      names += (i > 0 ? ", " : "") + (assets[i].name.empty() ? std::to_string(i) : assets[i].name);
  }
  std::size_t index = 0;
  const auto [end, fault] = std::from_chars(asset->data(), asset->data() + asset->size(), index);
  if (fault == std::errc() && end == asset->data() + asset->size() && index < assets.size()) return index;
  return Error{ErrorCode::kUsage, "it has no asset '" + *asset + "'; it has " + names};
}

Result<AssetFile> read_assets(std::span<const std::byte> bytes, const std::optional<std::string>& asset,
                              const ReadLimits& limits) {
  Result<Container> container = Container::open(bytes, limits);
  if (!container) return container.error();
  const Result<std::size_t> wanted = find_asset(container->assets(), asset);
  if (!wanted) return wanted.error();
  AssetFile file;
  file.format = "meso " + std::to_string(container->major()) + "." + std::to_string(container->minor());
  file.file_bytes = container->file_bytes();
  for (std::size_t i = 0; i < container->assets().size(); ++i) {
    if (asset && i != *wanted) continue;
    Result<NamedAsset> loaded = load(*container, i, limits);
    if (!loaded) return loaded.error();
    file.assets.push_back(std::move(*loaded));
  }
  return file;
}

Result<AssetFile> read_asset_file(const std::string& path, const ReadLimits& limits) {
  return read_path(path, false, limits);
}

Result<AssetFile> read_whole_asset_file(const std::string& path, const ReadLimits& limits) {
  return read_path(path, true, limits);
}

nlohmann::ordered_json describe_assets(const AssetFile& file) {
  nlohmann::ordered_json info;
  info["format"] = file.format;
  describe(file.assets.front(), info);
  info["file_bytes"] = file.file_bytes;
  info["assets"] = nlohmann::ordered_json::array();
  for (const NamedAsset& asset : file.assets) {
    nlohmann::ordered_json entry;
    entry["name"] = asset.name;
    describe(asset, entry);
    info["assets"].push_back(std::move(entry));
  }
  return info;
}

std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::optional<Failure> read_named_object(const std::string& text, CellObject& object) {
  const AssetPath place = parse_asset_path(text);
  const Result<std::vector<std::byte>> bytes = read_input(place.file, ReadLimits{}.max_file_bytes);
  if (!bytes) return Failure{bytes.error(), place.file};
  const Result<Container> container = Container::open(*bytes);
  if (!container) return Failure{container.error(), place.file};
  const Result<std::size_t> index = find_asset(container->assets(), place.asset);
  if (!index) return Failure{index.error(), place.file};
  Result<CellObject> read = read_cell_object(*bytes, {}, *index);
  if (!read) return Failure{read.error(), text};
  object = std::move(*read);
  return std::nullopt;
}

}  // namespace mesocell
