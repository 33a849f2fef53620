#include "converters/cli/batch_plan.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "converters/cli/representations.h"
#include "converters/cli/shape_source.h"
#include "format/file.h"

namespace mesocell {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecordName = ".mesocell-batch.json";
constexpr std::uint64_t kMaxListBytes = std::uint64_t{64} << 20;

/// A folder that is named as an asset's file is taken for a mistake.
bool is_folder(const std::string& path) {
  std::error_code error;
  return path.ends_with('/') || (!has_extension(path, ".meso") && fs::is_directory(path, error));
}

std::optional<Failure> read_list(const std::string& path, std::vector<std::string>& inputs) {
  const Result<std::vector<std::byte>> bytes = read_input(path, kMaxListBytes);
  if (!bytes) return Failure{bytes.error(), path};
  const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    if (line.empty() || line.front() == '#') continue;
    if (line.find('\0') != line.npos)
      return Failure{Error{ErrorCode::kInvalidInput, "it is no list of names, one on each line"}, path};
    inputs.emplace_back(line);
  }
  return std::nullopt;
}

/// The name of an input without its folders; of "shape:torus:size=2" what stands there, made fit for a file.
std::string name_of(const std::string& input) {
  std::string name = fs::path(parse_asset_path(input).file).filename().string();
  if (name.empty()) name = fs::path(input).parent_path().filename().string();
  if (const auto asset = parse_asset_path(input).asset) name += "-" + *asset;
  for (char& c : name)
    if (c == ':' || c == '=' || c == ',') c = '-';
  return name;
}

/// Size and time of a file, in words; empty if it is not there.
std::string stamp_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return {};
  return std::to_string(status.st_size) + " bytes, " + std::to_string(status.st_mtim.tv_sec) + "." +
         std::to_string(status.st_mtim.tv_nsec);
}

/// Of a record's file. Records of older versions know nothing of files beside the input, and do not count.
std::optional<std::pair<std::string, std::map<std::string, std::string>>> read_entry(
    const nlohmann::json& value) {
  if (!value.is_object() || !value.contains("of") || !value.contains("files") || !value["of"].is_string() ||
      !value["files"].is_object())
    return std::nullopt;
  std::map<std::string, std::string> files;
  for (const auto& [path, stamp] : value["files"].items()) {
    if (!stamp.is_string()) return std::nullopt;
    files[path] = stamp.get<std::string>();
  }
  return std::pair(value["of"].get<std::string>(), std::move(files));
}

std::string fingerprint(const BatchFile& file, const std::string& words) {
  return std::string(MESOCELL_VERSION) + "; " + file.input + "; " +
         stamp_of(parse_asset_path(file.input).file) + "; " + words + "; " + stamp_of(file.output);
}

}  // namespace

bool is_batch(const ConvertCommand& command) {
  const bool lists = std::any_of(command.inputs.begin(), command.inputs.end(),
                                 [](const std::string& input) { return input.starts_with('@'); });
  if (lists) return true;
  if (!is_folder(command.output)) return false;
  const bool one_asset =
      command.inputs.size() == 1 && is_asset_path(command.input) && !tile_of_input(command.input);
  return !one_asset || command.to;
}

std::optional<Failure> plan_batch(const ConvertCommand& command, std::vector<BatchFile>& files) {
  if (!is_folder(command.output))
    return usage(command.output, "a batch goes into a folder; end its name with /");
  std::string extension = command.to.value_or(".meso");
  if (!extension.empty() && extension.front() != '.') extension.insert(0, ".");
  if (extension.size() < 2 || extension.find('/') != extension.npos)
    return usage("--to", "it is no extension; write for example .glb");
  std::vector<std::string> inputs;
  for (const std::string& input : command.inputs) {
    if (!input.starts_with('@')) {
      inputs.push_back(input);
      continue;
    }
    if (auto failure = read_list(input.substr(1), inputs)) return failure;
  }
  if (inputs.empty()) return usage(command.input, "the list names no file");
  std::map<std::string, int> stems, names;
  for (const std::string& input : inputs) {
    const std::string name = name_of(input);
    ++stems[fs::path(name).stem().string()];
    ++names[name];
  }
  std::set<std::string> taken;
  for (const std::string& input : inputs) {
    const std::string whole = name_of(input), stem = fs::path(whole).stem().string();
    const std::string base = stems[stem] == 1 ? stem : whole;
    std::string name = base + extension;
    for (int i = 2; !taken.insert(name).second; ++i) name = base + "-" + std::to_string(i) + extension;
    files.push_back({input, (fs::path(command.output) / name).string()});
  }
  return std::nullopt;
}

BatchRecord BatchRecord::load(const std::string& folder) {
  BatchRecord record;
  const Result<std::vector<std::byte>> bytes =
      read_file((fs::path(folder) / kRecordName).string(), kMaxListBytes);
  if (!bytes) return record;
  const auto* begin = reinterpret_cast<const char*>(bytes->data());
  const nlohmann::json json = nlohmann::json::parse(begin, begin + bytes->size(), nullptr, false);
  if (!json.is_object() || !json.contains("made") || !json["made"].is_object()) return record;
  for (const auto& [name, value] : json["made"].items())
    if (auto entry = read_entry(value))
      record.made_[name] = {std::move(entry->first), std::move(entry->second)};
  return record;
}

Status BatchRecord::save(const std::string& folder) const {
  nlohmann::ordered_json json;
  json["made"] = nlohmann::ordered_json::object();
  for (const auto& [name, entry] : made_) json["made"][name] = {{"of", entry.made}, {"files", entry.files}};
  const std::string text = json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  return write_file((fs::path(folder) / kRecordName).string(), std::as_bytes(std::span(text)));
}

bool BatchRecord::up_to_date(const BatchFile& file, const std::string& words) const {
  const auto found = made_.find(fs::path(file.output).filename().string());
  std::error_code error;
  if (found == made_.end() || !fs::exists(file.output, error)) return false;
  const Entry& entry = found->second;
  return entry.made == fingerprint(file, words) &&
         std::all_of(entry.files.begin(), entry.files.end(),
                     [](const auto& beside) { return beside.second == stamp_of(beside.first); });
}

void BatchRecord::note(const BatchFile& file, const std::string& words,
                       const std::vector<std::string>& beside) {
  const std::string name = fs::path(file.output).filename().string();
  made_.erase(name);
  Entry entry{fingerprint(file, words), {}};
  for (const std::string& path : beside) {
    // Bytes that are no text were replaced on their way here: no such file would ever be found to change.
    if (path.find("\xef\xbf\xbd") != path.npos) return;
    entry.files[path] = stamp_of(path);
  }
  made_[name] = std::move(entry);
}

}  // namespace mesocell
