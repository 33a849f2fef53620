#include "converters/cli/export.h"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "converters/cli/cell_object_exports.h"
#include "converters/cli/progress_bar.h"
#include "converters/cli/repack.h"
#include "converters/cli/representations.h"
#include "converters/image/extension.h"
#include "sdk/author/repair.h"

namespace mesocell {
namespace {

/// Whether a space-separated list has the word.
bool lists(std::string_view list, std::string_view word) {
  const std::string padded = " " + std::string(list) + " ";
  return padded.find(" " + std::string(word) + " ") != padded.npos;
}

/// The extension of an output as ExportKind::extensions has it.
std::string output_extension(const std::string& output) {
  std::error_code error;
  if (output.ends_with('/') || std::filesystem::is_directory(output, error)) return "/";
  return lower_extension(output);
}

std::optional<Failure> find_kind(const ConvertCommand& command, const ExportKind*& kind) {
  const std::string extension = output_extension(command.output);
  std::string of_extension, all;
  const ExportKind* named = nullptr;
  for (const ExportKind& k : cell_object_exports()) {
    all += (all.empty() ? "" : ", ") + std::string(k.name);
    if (command.as && k.name == *command.as) named = &k;
    if (!lists(k.extensions, extension)) continue;
    of_extension += (of_extension.empty() ? "" : ", ") + std::string(k.name);
    if (!kind && (!command.as || k.name == *command.as)) kind = &k;
  }
  if (kind) return std::nullopt;
  if (command.as && !named) return usage("--as", "unknown kind '" + *command.as + "'; there are: " + all);
  if (named)
    return usage(command.output, "as " + *command.as + " an asset is written to " +
                                     std::string(named->extensions) +
                                     " alone (/ is a folder); give the output such an extension");
  return usage(command.output,
               "an asset cannot be converted to that; see mesocell convert --help for what it can be");
}

std::vector<Warning> unused_options(const ConvertCommand& command, const ExportKind& kind) {
  std::vector<Warning> warnings;
  const auto given = [&](bool is_given, std::string_view option) {
    if (is_given && !lists(kind.options, option))
      warnings.push_back({"option-unused",
                          std::string(option) + " has no effect on an output as " + std::string(kind.name)});
  };
  given(command.side.has_value(), "--side");
  given(command.size.has_value(), "--size");
  given(command.region.has_value(), "--region");
  given(command.max_faces.has_value(), "--max-faces");
  given(command.normals, "--normals");
  given(command.draco, "--draco");
  given(command.drop_buried, "--drop-buried");
  const bool authoring = command.tiles || command.tile_size || !command.box.empty() || command.tile ||
                         command.rule || command.percolating || command.repair || command.solid ||
                         command.stitch || command.thicken || command.wrap_alpha || command.wrap_offset ||
                         command.color || command.heights || command.codec || command.target_version ||
                         !command.meta.empty();
  if (authoring)
    warnings.push_back(
        {"option-unused", "options that make or write .meso files have no effect on another output"});
  return warnings;
}

}  // namespace

bool is_export(const ConvertCommand& command) {
  return is_repack(command) && output_extension(command.output) != ".meso";
}

int run_export(const ConvertCommand& command) {
  const Console console(command.common);
  if (command.inputs.size() > 1)
    return console.fail(
        usage(command.inputs[1], "one asset is converted at a time; name one input and one output"));
  const ExportKind* kind = nullptr;
  if (auto failure = find_kind(command, kind)) return console.fail(*failure);
  if (same_file(parse_asset_path(command.input).file, command.output))
    return console.fail(usage(command.input, "input and output are the same file; name another output"));
  const auto start = std::chrono::steady_clock::now();
  CellObject object;
  if (auto failure = read_named_object(command.input, object)) return console.fail(*failure);
  ProgressBar bar(!console.quiet());
  nlohmann::ordered_json report;
  report["as"] = std::string(kind->name);
  std::vector<std::string> losses;
  const Status status = kind->run({command, object, bar.progress(), report, losses});
  bar.finish();
  if (!status)
    return console.fail(status.error(), status.error().code == ErrorCode::kUsage ? "" : command.output);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::vector<Warning> warnings = unused_options(command, *kind);
  for (const Warning& warning : warnings) console.warn(command.input, warning.text);
  report["losses"] = losses;
  report["seconds"]["total"] = seconds;
  report["warnings"] = nlohmann::ordered_json::array();
  for (const Warning& warning : warnings)
    report["warnings"].push_back({{"id", warning.id}, {"text", warning.text}});
  if (console.json()) return console.finish(json_text(report));
  if (console.quiet()) return kExitDone;
  char text[96];
  std::snprintf(text, sizeof text, ": %.2f MB in %.1f s, as ",
                double(report.value("bytes", std::uint64_t{0})) * 1e-6, seconds);
  std::string lines = printable(command.output) + text + std::string(kind->name) + "\n";
  for (const std::string& loss : losses) lines += "  not kept: " + loss + "\n";
  return console.finish(lines);
}

std::string exports_help() {
  std::string text;
  for (const ExportKind& kind : cell_object_exports()) {
    text +=
        std::string(kind.name) + "   " + std::string(kind.extensions) + "   " + std::string(kind.help) + "\n";
  }
  return text +
         "Of several kinds with one extension the first is taken unless --as names another; / is a folder.\n";
}

}  // namespace mesocell
