#include "converters/cli/repack.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "converters/cli/convert_plan.h"
#include "converters/cli/shape_source.h"
#include "format/container.h"
#include "format/file.h"
#include "format/representation.h"
#include "format/text_chunk.h"

namespace mesocell {
namespace {

using Importance = ContainerWriter::Importance;

/// A name that no asset has yet: the asset's own or its file's, cut to what fits, with a number where it is
/// taken.
std::string free_name(const std::string& own, const std::string& file, std::set<std::string>& taken) {
  std::string base = own.empty() ? std::filesystem::path(file).stem().string() : own;
  const auto cut = [&](std::size_t bytes) {
    std::string text = base.substr(0, bytes);
    // Not within a character.
    while (text.size() < base.size() && !text.empty() && (base[text.size()] & 0xc0) == 0x80) text.pop_back();
    return text;
  };
  std::string name = cut(kMaxNameBytes);
  for (int i = 2; !taken.insert(name).second; ++i) {
    const std::string suffix = "-" + std::to_string(i);
    name = cut(kMaxNameBytes - suffix.size()) + suffix;
  }
  return name;
}

/// The asset's text with the keys of --meta added or replaced.
Result<std::vector<std::byte>> merged_text(const Container& container, std::size_t asset,
                                           const Metadata& more) {
  std::map<std::string, std::string> merged;
  if (container.scan().find(asset, kTextChunk)) {
    const Result<std::vector<std::byte>> bytes = container.read_chunk(asset, kTextChunk);
    if (!bytes) return bytes.error();
    IssueSink sink = IssueSink::first_error();
    MemoryBudget budget({});
    const auto text = decode_text({kTextChunk, *bytes, 0, true}, budget, sink);
    if (!text) return sink.first_error_as_result();
    merged.insert(text->begin(), text->end());
  }
  for (const auto& [key, value] : more) merged[key] = value;
  return encode_text({merged.begin(), merged.end()});
}

/// Whether a chunk is of a type that a newer version brought than the one to be written.
bool is_newer(std::uint32_t representation, std::uint32_t chunk, const FormatVersion& version) {
  const Representation* const rules = find_representation(representation);
  return rules && rules->find(chunk, kFormatMinor) && !rules->find(chunk, version.minor);
}

/// Adds an asset that was read whole before, so its chunks are right.
std::optional<Failure> add_asset(const Container& container, std::size_t asset, const std::string& name,
                                 const Metadata& meta, const std::string& input, const FormatVersion& version,
                                 ContainerWriter& writer) {
  const std::uint32_t representation = container.assets()[asset].representation;
  writer.begin_asset(representation, name);
  for (const ChunkInfo& chunk : container.chunks_of(asset)) {
    if (is_newer(representation, chunk.type, version)) continue;
    if (chunk.type == kTextChunk && !meta.empty()) continue;
    const Result<std::vector<std::byte>> bytes = container.read_chunk(asset, chunk.type);
    if (!bytes) return Failure{bytes.error(), input};
    writer.add_chunk(chunk.type, chunk.critical ? Importance::kCritical : Importance::kSkippable, *bytes,
                     chunk.block_bytes);
  }
  if (meta.empty()) return std::nullopt;
  const Result<std::vector<std::byte>> text = merged_text(container, asset, meta);
  if (!text) return Failure{text.error(), input};
  writer.add_chunk(kTextChunk, Importance::kSkippable, *text);
  return std::nullopt;
}

}  // namespace

bool is_repack(const ConvertCommand& command) {
  return std::all_of(command.inputs.begin(), command.inputs.end(),
                     [](const std::string& input) { return is_asset_path(input) && !tile_of_input(input); });
}

std::optional<Failure> repack(const ConvertCommand& command, const Progress& progress, AssetFile& written) {
  Metadata meta;
  WriteOptions options;
  if (auto failure = parse_write_options(command, options, meta)) return failure;
  if (auto failure = check_convert_files(command, {})) return failure;

  // How many assets there will be decides whether they need names.
  struct Source {
    std::vector<std::byte> bytes;
    AssetPath path;
    std::vector<std::size_t> assets;
  };
  std::vector<Source> sources;
  std::size_t count = 0;
  for (const std::string& input : command.inputs) {
    Source source;
    source.path = parse_asset_path(input);
    Result<std::vector<std::byte>> bytes = read_input(source.path.file, ReadLimits{}.max_file_bytes);
    if (!bytes) return Failure{bytes.error(), source.path.file};
    source.bytes = std::move(*bytes);
    const Result<AssetFile> file = read_assets(source.bytes, source.path.asset);
    if (!file) return Failure{file.error(), source.path.file};
    const Result<Container> container = Container::open(source.bytes);
    if (!container) return Failure{container.error(), source.path.file};
    const Result<std::size_t> wanted = find_asset(container->assets(), source.path.asset);
    if (!wanted) return Failure{wanted.error(), source.path.file};
    for (std::size_t i = 0; i < container->assets().size(); ++i)
      if (!source.path.asset || i == *wanted) source.assets.push_back(i);
    count += source.assets.size();
    sources.push_back(std::move(source));
    if (progress.cancelled()) return Failure{Error{ErrorCode::kCancelled, "interrupted"}, {}};
  }

  ContainerWriter writer(options);
  std::set<std::string> taken;
  for (const Source& source : sources) {
    const Result<Container> container = Container::open(source.bytes);
    if (!container) return Failure{container.error(), source.path.file};
    for (const std::size_t asset : source.assets) {
      const std::string& own = container->assets()[asset].name;
      const std::string name = count > 1 ? free_name(own, source.path.file, taken) : own;
      if (auto failure = add_asset(*container, asset, name, meta, source.path.file, options.version, writer)) return failure;
      if (progress.cancelled()) return Failure{Error{ErrorCode::kCancelled, "interrupted"}, {}};
    }
  }
  const Result<std::vector<std::byte>> bytes = writer.finish();
  if (!bytes) return Failure{bytes.error(), command.output};
  Result<AssetFile> file = read_assets(*bytes);
  if (!file) return Failure{file.error(), command.output};
  if (Status status = write_file(command.output, *bytes, command.no_clobber); !status)
    return Failure{status.error(), command.output};
  written = std::move(*file);
  return std::nullopt;
}

}  // namespace mesocell
