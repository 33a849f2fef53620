#include <nlohmann/json.hpp>

#include "converters/cli/commands.h"
#include "converters/cli/representations.h"

namespace mesocell {
namespace {

/// A value on one line: "[64, 63, 50]", "min [0, 0, 0], max [1, 1, 1]".
std::string value_text(const nlohmann::ordered_json& value) {
  std::string text;
  if (value.is_string()) return printable(value.get<std::string>());
  if (!value.is_structured()) return value.dump();
  for (const auto& [key, item] : value.items()) {
    if (!text.empty()) text += ", ";
    if (value.is_object()) text += printable(key) + " ";
    text += value_text(item);
  }
  return value.is_array() ? "[" + text + "]" : text;
}

/// A line for each entry; the elements of an array of objects get a line each.
std::string info_text(const nlohmann::ordered_json& info) {
  std::string text;
  for (const auto& [key, value] : info.items()) {
    if (value.is_null() || (value.is_structured() && value.empty())) continue;
    const std::string name = key + std::string(key.size() < 16 ? 16 - key.size() : 1, ' ');
    if (value.is_array() && value.front().is_object()) {
      for (const nlohmann::ordered_json& item : value) text += name + value_text(item) + "\n";
    } else {
      text += name + value_text(value) + "\n";
    }
  }
  return text;
}

}  // namespace

int run_info(const InfoCommand& command) {
  const Console console(command.common);
  const Result<AssetFile> file = read_asset_file(command.input);
  if (!file) return console.fail(file.error(), command.input);
  const nlohmann::ordered_json info = describe_asset(*file);
  return console.finish(console.json() ? json_text(info) : info_text(info));
}

}  // namespace mesocell
