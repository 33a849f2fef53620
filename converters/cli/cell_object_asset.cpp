#include "converters/cli/cell_object_asset.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "format/cell_object_io.h"
#include "sdk/trace/cell_object_caster.h"

namespace mesocell {
namespace {

using Json = nlohmann::ordered_json;

struct RuleRow {
  MembershipRule rule;
  std::string_view name;
};
constexpr std::array<RuleRow, 2> kRules = {
    {{MembershipRule::kCentre, "centre"}, {MembershipRule::kConservative, "conservative"}}};

std::string rule_name(MembershipRule rule) {
  for (const RuleRow& row : kRules)
    if (row.rule == rule) return std::string(row.name);
  return {};
}

Json counts_json(const MembershipMap& membership) {
  const InstanceCounts counts = count_instances(membership);
  return {{"inside", counts.inside}, {"outside", counts.outside}, {"intersected", counts.intersected}};
}

/// A binary32 in as few digits as tell it from others.
double shortest(float value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  double number = 0;
  std::from_chars(text.data(), end, number);
  return number;
}

/// How far maps that were rounded are off at most: channels in steps of 1/255, normals in degrees.
Json stated_errors(const CellObject& object) {
  Json errors = Json::object();
  if (object.color) errors["color"] = shortest(object.color->max_error);
  if (object.cell_colors) errors["cell_colors"] = shortest(object.cell_colors->max_error);
  if (object.instance_colors) errors["instance_colors"] = shortest(object.instance_colors->max_error);
  if (object.surface_colors) errors["surface_colors"] = shortest(object.surface_colors->max_error);
  if (object.normals) errors["normals"] = shortest(object.normals->max_error_degrees);
  return errors;
}

/// Instances of unequal tag; null if the maps are not of the same instances.
Json tags_differing(const MembershipMap& a, const MembershipMap& b) {
  if (a.tiles != b.tiles || a.cell_count != b.cell_count) return nullptr;
  std::uint64_t differing = 0;
  for (std::size_t tile = 0; tile < a.entries.size(); ++tile) {
    if (std::max(a.entries[tile], b.entries[tile]) < MembershipMap::kFirstBlock) {
      differing += a.entries[tile] == b.entries[tile] ? 0 : a.cell_count;
      continue;
    }
    for (std::uint32_t cell = 1; cell <= a.cell_count; ++cell)
      differing += a.tag(tile, cell) != b.tag(tile, cell);
  }
  return differing;
}

/// Voxels of the tile of unequal instance; null if the resolutions differ.
Json voxels_differing(const TileMap& a, const TileMap& b) {
  if (a.resolution != b.resolution) return nullptr;
  const auto piece = [](const TileMap& tile, std::uint64_t voxel) {
    const std::uint32_t id = tile.id(voxel);
    return id == 0 ? Piece{} : tile.pieces[id - 1];
  };
  std::uint64_t differing = 0;
  for (std::uint64_t voxel = 0; voxel < a.voxel_count(); ++voxel)
    differing += !(piece(a, voxel) == piece(b, voxel));
  return differing;
}

/// The greatest distance along an axis between the corners of the boxes, metres.
double box_distance(const CellObject& a, const CellObject& b) {
  double distance = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    distance = std::max({distance, std::abs(a.grid.box_min[axis] - b.grid.box_min[axis]),
                         std::abs(a.box_max()[axis] - b.box_max()[axis])});
  return distance;
}

Json metadata_differing(const CellObject& a, const CellObject& b) {
  const std::map<std::string, std::string> of_a(a.metadata.begin(), a.metadata.end()),
      of_b(b.metadata.begin(), b.metadata.end());
  std::set<std::string> keys;
  for (const auto& [map, other] : {std::pair(&of_a, &of_b), std::pair(&of_b, &of_a)})
    for (const auto& [key, value] : *map)
      if (const auto found = other->find(key); found == other->end() || found->second != value)
        keys.insert(key);
  return Json(keys);
}

class CellObjectAsset final : public Asset {
 public:
  explicit CellObjectAsset(CellObject object) : object_(std::move(object)) {}

  void describe(Json& info) const override {
    info["tiles"] = object_.grid.tiles;
    info["tile_resolution"] = object_.tile.resolution;
    info["cells"] = object_.tile.cell_count;
    info["instances"] = counts_json(object_.membership);
    info["object_box"]["min"] = object_.grid.box_min;
    info["object_box"]["max"] = object_.box_max();
    info["voxel_edge"] = object_.grid.voxel_edge;
    info["rule"] = rule_name(object_.membership.rule);
    info["color_resolution"] = object_.color ? Json(object_.color->resolution) : Json(nullptr);
    info["cell_colors"] = object_.cell_colors ? object_.cell_colors->colors.size() : 0;
    info["instance_colors"] = object_.instance_colors ? object_.instance_colors->colors.size() : 0;
    info["surface_color_resolution"] =
        object_.surface_colors ? Json(object_.surface_colors->resolution) : Json(nullptr);
    info["surface_colors"] = object_.surface_colors ? object_.surface_colors->colors.size() : 0;
    info["normals"] = object_.normals ? object_.normals->normals.size() : 0;
    info["max_error"] = stated_errors(object_);
    info["metadata"] = Json::object();
    for (const auto& [key, value] : object_.metadata) info["metadata"][key] = value;
  }

  void compare(const Asset& other, Json& result) const override {
    const CellObject &a = object_, &b = dynamic_cast<const CellObjectAsset&>(other).object_;
    // A reference to the array would not outlast the next key.
    const auto part = [&](const char* name, bool equal) {
      if (!equal) result["differences"].push_back(name);
    };
    part("tiles", a.grid.tiles == b.grid.tiles);
    part("object_box", a.grid.box_min == b.grid.box_min && a.box_max() == b.box_max());
    part("voxel_edge", a.grid.voxel_edge == b.grid.voxel_edge);
    part("tile", a.tile == b.tile);
    part("rule", a.membership.rule == b.membership.rule);
    result["instances"]["a"] = counts_json(a.membership);
    result["instances"]["b"] = counts_json(b.membership);
    result["tags_differing"] = tags_differing(a.membership, b.membership);
    part("tags", result["tags_differing"] == 0);
    result["voxels_differing"] = voxels_differing(a.tile, b.tile);
    result["box_distance"] = box_distance(a, b);
    part("color", a.color == b.color);
    part("cell_colors", a.cell_colors == b.cell_colors);
    part("instance_colors", a.instance_colors == b.instance_colors);
    part("surface_colors", a.surface_colors == b.surface_colors);
    part("normals", a.normals == b.normals);
    result["metadata_differing"] = metadata_differing(a, b);
    part("metadata", result["metadata_differing"].empty());
  }

  Result<std::unique_ptr<Caster>> make_caster(std::string_view method) const override {
    return make_cell_object_caster(object_, method);
  }

  Result<SurfaceDistance> surface_distance(const TriangleMesh& mesh, const SurfaceDistanceOptions& options,
                                           const Progress& progress) const override {
    return measure_surface_distance(object_, mesh, options, &progress);
  }

  double volume() const override { return inside_volume(object_); }

 private:
  CellObject object_;
};

}  // namespace

Result<std::unique_ptr<Asset>> load_cell_object(const Container& container, const ReadLimits& limits,
                                                std::size_t asset) {
  Result<CellObject> object = decode_cell_object(container, limits, asset);
  if (!object) return object.error();
  return std::unique_ptr<Asset>(std::make_unique<CellObjectAsset>(std::move(*object)));
}

std::optional<MembershipRule> find_rule(std::string_view name) {
  for (const RuleRow& row : kRules)
    if (row.name == name) return row.rule;
  return std::nullopt;
}

std::string rule_names() {
  std::string names;
  for (const RuleRow& row : kRules) names += (names.empty() ? "" : ", ") + std::string(row.name);
  return names;
}

const char* cell_object_comparison_help() {
  return "instances {a, b} {inside, outside, intersected}, tags_differing (null if the tiles or cells differ "
         "in "
         "number), voxels_differing (of the tile; null if the resolutions differ), box_distance (metres), "
         "metadata_differing [keys]; the parts are tiles, object_box, voxel_edge, tile, rule, tags, color, "
         "cell_colors, instance_colors, surface_colors, normals, metadata";
}

}  // namespace mesocell
