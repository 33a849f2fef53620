#include "format/validate.h"

#include <cstring>
#include <nlohmann/json.hpp>

#include "converters/cli/commands.h"
#include "converters/cli/representations.h"
#include "format/container_scan.h"
#include "format/fourcc.h"

namespace mesocell {
namespace {

bool is_meso(std::span<const std::byte> bytes) {
  return bytes.size() >= kMagic.size() && std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) == 0;
}

nlohmann::ordered_json report_json(const ValidationReport& report) {
  nlohmann::ordered_json json;
  json["valid"] = report.valid;
  json["issues"] = nlohmann::ordered_json::array();
  for (const Issue& issue : report.issues) {
    nlohmann::ordered_json entry;
    entry["id"] = issue.id;
    entry["severity"] = severity_name(issue.severity);
    entry["offset"] = issue.offset ? nlohmann::ordered_json(*issue.offset) : nlohmann::ordered_json(nullptr);
    entry["chunk"] =
        issue.chunk ? nlohmann::ordered_json(fourcc_text(issue.chunk)) : nlohmann::ordered_json(nullptr);
    entry["text"] = issue.text;
    json["issues"].push_back(entry);
  }
  json["errors"] = report.errors;
  json["warnings"] = report.warnings;
  json["capped"] = report.capped;
  return json;
}

std::string report_text(const ValidationReport& report, const std::string& path, bool quiet) {
  std::string text;
  for (const Issue& issue : report.issues) {
    text += std::string(severity_name(issue.severity)) + " " + std::string(issue.id);
    if (issue.chunk) text += ", chunk " + fourcc_text(issue.chunk);
    if (issue.offset) text += ", byte " + std::to_string(*issue.offset);
    text += ": " + printable(issue.text) + "\n";
  }
  if (report.capped) text += "and more\n";
  if (!quiet || !report.valid) text += printable(path) + (report.valid ? " is valid\n" : " is not valid\n");
  return text;
}

}  // namespace

int run_validate(const ValidateCommand& command) {
  const Console console(command.common);
  const ReadLimits limits;
  const Result<std::vector<std::byte>> bytes = read_input(command.input, limits.max_file_bytes);
  if (!bytes) return console.fail(bytes.error(), command.input);
  if (!is_meso(*bytes))
    return console.fail(Error{ErrorCode::kInvalidInput,
                              "it is not a .meso file; name a file that mesocell wrote", "header-magic", 0},
                        command.input);
  ValidationReport report = validate(*bytes, limits, command.max_issues);
  if (command.strict && report.warnings > 0) report.valid = false;
  return console.finish(
      console.json() ? json_text(report_json(report)) : report_text(report, command.input, console.quiet()),
      report.valid ? kExitDone : kExitCheckFailed);
}

}  // namespace mesocell
