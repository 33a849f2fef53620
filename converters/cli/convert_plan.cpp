#include "converters/cli/convert_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "converters/cli/cell_object_asset.h"
#include "converters/cli/repack.h"
#include "converters/cli/shape_source.h"
#include "converters/cli/values.h"
#include "converters/import/mesh_file.h"
#ifdef MESOCELL_WRAP
#include "sdk/wrap/alpha_wrap.h"
#endif

namespace mesocell {
namespace {

struct RepairRow {
  std::string_view name;
  Repair repair;
};
constexpr std::array<RepairRow, 5> kRepairs = {{{"strict", Repair::kStrict},
                                                {"orient", Repair::kOrient},
                                                {"winding", Repair::kWinding},
                                                {"wrap", Repair::kWrap},
                                                {"auto", Repair::kAuto}}};

struct SolidRow {
  std::string_view name;
  SolidRule solid;
};
constexpr std::array<SolidRow, 3> kSolids = {
    {{"nonzero", SolidRule::kNonzero}, {"even-odd", SolidRule::kEvenOdd}, {"outer", SolidRule::kOuter}}};

struct VersionRow {
  std::string_view name;
  FormatVersion version;
};
constexpr std::array<VersionRow, 2> kVersions = {{{"1.0", {1, 0}}, {"1.1", {1, 1}}}};

std::optional<Failure> parse_tile(const ConvertCommand& command, ConvertPlan& plan) {
  const std::optional<std::string> shown = tile_of_input(command.input);
  const std::string option = shown ? command.input : "--tile";
  Result<TileSource> tile = parse_tile_source(shown ? *shown : command.tile.value_or(kDefaultTile), option);
  if (!tile) return Failure{tile.error(), option};
  plan.tile = std::move(*tile);
  plan.tile_options.threads = command.common.threads;
  const std::string percolating = command.percolating.value_or("cut");
  if (percolating != "cut" && percolating != "refuse")
    return usage("--percolating", "unknown choice '" + percolating + "'; there are: cut, refuse");
  if (percolating == "refuse") plan.tile_options.percolating = Percolating::kRefuse;
  return std::nullopt;
}

std::optional<Failure> parse_repair(const ConvertCommand& command, RepairOptions& options) {
  const std::string name = command.repair.value_or("auto");
  const auto row =
      std::find_if(kRepairs.begin(), kRepairs.end(), [&](const RepairRow& r) { return r.name == name; });
  if (row == kRepairs.end())
    return usage("--repair", "unknown choice '" + name + "'; there are: strict, orient, winding, wrap, auto");
  options.repair = row->repair;
#ifdef MESOCELL_WRAP
  options.wrapper = alpha_wrap;
#else
  if (options.repair == Repair::kWrap)
    return usage("--repair", "this command was built without wrap; use another choice");
#endif
  const auto length = [](const char* option, const std::optional<double>& given,
                         double& value) -> std::optional<Failure> {
    if (given && !(*given > 0 && std::isfinite(*given)))
      return usage(option, "it must be a finite number of metres above 0");
    value = given.value_or(0);
    return std::nullopt;
  };
  if (auto failure = length("--stitch", command.stitch, options.stitch_tolerance)) return failure;
  if (auto failure = length("--thicken", command.thicken, options.thickness)) return failure;
  if (auto failure = length("--wrap-alpha", command.wrap_alpha, options.wrap_alpha)) return failure;
  if (auto failure = length("--wrap-offset", command.wrap_offset, options.wrap_offset)) return failure;
  if (command.thicken && (options.repair == Repair::kStrict || options.repair == Repair::kWrap))
    return usage("--thicken", "it is a repair by itself, and --repair " + name +
                                  " asks for another; leave one of them out");
  return std::nullopt;
}

std::optional<Failure> parse_solid(const ConvertCommand& command, SolidRule& solid) {
  const std::string name = command.solid.value_or("nonzero");
  const auto row =
      std::find_if(kSolids.begin(), kSolids.end(), [&](const SolidRow& r) { return r.name == name; });
  if (row == kSolids.end())
    return usage("--solid", "unknown choice '" + name + "'; there are: nonzero, even-odd, outer");
  solid = row->solid;
  if (command.thicken && solid != SolidRule::kNonzero)
    return usage("--solid",
                 "what --thicken makes overlaps, so it is solid by nonzero alone; leave one of them out");
  return std::nullopt;
}

std::optional<Failure> parse_grid(const ConvertCommand& command, AuthorOptions& author) {
  const std::string rule_name = command.rule.value_or("centre");
  const std::optional<MembershipRule> rule = find_rule(rule_name);
  if (!rule) return usage("--rule", "unknown rule '" + rule_name + "'; there are: " + rule_names());
  author.rule = *rule;
  author.threads = command.common.threads;
  const std::int64_t tiles = command.tiles.value_or(kDefaultTiles);
  if (tiles <= 0) return usage("--tiles", "there must be at least one tile; give a number from 1");
  if (command.tile_size && !(*command.tile_size > 0 && std::isfinite(*command.tile_size)))
    return usage("--tile-size", "it must be a finite number of metres above 0; give the edge of a tile");
  if (tiles > 0xffff'ffff)
    return Failure{Error{ErrorCode::kLimit, "so many tiles are more than can be counted; use fewer"},
                   "--tiles"};
  author.grid.tiles = std::uint32_t(tiles);
  author.grid.tile_size = command.tile_size;
  if (command.box.empty()) return std::nullopt;
  const Result<std::array<double, 6>> box = parse_numbers<6>(command.box);
  if (!box) return Failure{box.error(), "--box"};
  const std::array<double, 6>& b = *box;
  if (!(b[0] < b[3] && b[1] < b[4] && b[2] < b[5]))
    return usage("--box", "the box has no room; write its lesser corner first: x0,y0,z0,x1,y1,z1");
  author.grid.box = Box3{};
  author.grid.box->add({b[0], b[1], b[2]});
  author.grid.box->add({b[3], b[4], b[5]});
  return std::nullopt;
}

/// Says of every option that was given and does nothing why that is so.
void find_unused(const ConvertCommand& command, ConvertPlan& plan) {
  const auto unused = [&](bool given, const char* option, const char* why) {
    if (given) plan.warnings.push_back({"option-unused", std::string(option) + " has no effect " + why});
  };
  if (tile_of_input(command.input)) {
    const char* why = "where the cells of a tile are shown by themselves";
    unused(command.tiles.has_value(), "--tiles", why);
    unused(command.tile_size.has_value(), "--tile-size", why);
    unused(!command.box.empty(), "--box", why);
    unused(command.tile.has_value(), "--tile", why);
    unused(command.rule.has_value(), "--rule", why);
    unused(command.repair.has_value(), "--repair", why);
    unused(command.solid.has_value(), "--solid", why);
    unused(command.thicken.has_value(), "--thicken", why);
  }
  const Repair repair = plan.author.repair.repair;
  const bool wraps = (repair == Repair::kWrap || repair == Repair::kAuto) && !tile_of_input(command.input);
  unused(command.wrap_alpha && !wraps, "--wrap-alpha", "where nothing is wrapped");
  unused(command.wrap_offset && !wraps, "--wrap-offset", "where nothing is wrapped");
  unused(command.stitch && (repair == Repair::kStrict || tile_of_input(command.input)), "--stitch",
         "where nothing is stitched");
  unused(command.percolating && !reads_labels(plan.tile), "--percolating",
         "on a tile that is not made of labels");
}

}  // namespace

std::optional<Failure> check_convert_files(const ConvertCommand& command, const std::string& more_input) {
  if (command.inputs.size() > 1 && !is_repack(command))
    return usage(command.inputs[1], "only .meso files can be put together; name one input and one output");
  if (!has_extension(command.output, ".meso"))
    return usage(command.output, "it can be converted to .meso alone; give the output that extension");
  std::vector<std::string> inputs = command.inputs;
  if (!more_input.empty()) inputs.push_back(more_input);
  for (const std::string& input : inputs)
    if (same_file(parse_asset_path(input).file, command.output))
      return usage(input, "input and output are the same file; name another output");
  if (Status status = check_output(command.output, command.no_clobber); !status)
    return Failure{status.error(), command.output};
  return std::nullopt;
}

std::optional<Failure> parse_write_options(const ConvertCommand& command, WriteOptions& options,
                                           Metadata& metadata) {
  const std::string codec = command.codec.value_or("zstd");
  if (codec != "zstd" && codec != "raw")
    return usage("--codec", "unknown choice '" + codec + "'; there are: zstd, raw");
  options.compress = codec == "zstd";
  if (command.target_version) {
    const auto row = std::find_if(kVersions.begin(), kVersions.end(),
                                  [&](const VersionRow& r) { return r.name == *command.target_version; });
    if (row == kVersions.end())
      return usage("--target-version", "there is no version '" + *command.target_version +
                                           "' that can be written; there are: 1.0, 1.1");
    options.version = row->version;
  }
  std::map<std::string, std::string> merged;
  for (const std::string& entry : command.meta) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos) return usage("--meta", "it has no value; write KEY=VALUE");
    merged[entry.substr(0, equals)] = entry.substr(equals + 1);
  }
  metadata.assign(merged.begin(), merged.end());
  if (Status status = check_metadata(metadata); !status) return Failure{status.error(), "--meta"};
  return std::nullopt;
}

std::optional<Failure> make_convert_plan(const ConvertCommand& command, ConvertPlan& plan) {
  if (auto failure = parse_tile(command, plan)) return failure;
  if (command.color) {
    Result<Recipe> color = parse_recipe(*command.color);
    if (!color) return Failure{color.error(), "--color"};
    plan.color = std::move(*color);
  }
  if (auto failure = parse_grid(command, plan.author)) return failure;
  if (auto failure = parse_repair(command, plan.author.repair)) return failure;
  if (auto failure = parse_solid(command, plan.author.solid)) return failure;
  if (auto failure = parse_write_options(command, plan.write, plan.metadata)) return failure;
  for (const auto& [key, value] : plan.metadata)
    if (key == "color" || key == "repair" || key == "solid" || key == "tile" || is_shape_key(key))
      return usage("--meta", "'" + key + "' is a key that mesocell writes itself; use another one");
  find_unused(command, plan);
  return check_convert_files(command, plan.tile.saved);
}

}  // namespace mesocell
