#include "converters/vdb/object_metadata.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace mesocell {
namespace {

constexpr std::string_view kPrefix = "mesocell:", kVersion = "1";
constexpr std::uint64_t kMaxTiles = std::uint64_t{1} << 26;

template <typename T, std::size_t N>
std::string text_of(const std::array<T, N>& values) {
  std::string text;
  for (const T v : values) {
    char number[40];
    const auto [end, status] = std::to_chars(number, number + sizeof number, v);
    text += (text.empty() ? "" : " ") + (status == std::errc() ? std::string(number, end) : std::string());
  }
  return text;
}

template <typename T, std::size_t N>
std::optional<std::array<T, N>> parse(std::string_view text) {
  std::array<T, N> values{};
  const char *at = text.data(), *const end = at + text.size();
  for (std::size_t i = 0; i < N; ++i) {
    if (i > 0 && (at == end || *at++ != ' ')) return std::nullopt;
    const auto [stop, status] = std::from_chars(at, end, values[i]);
    if (status != std::errc()) return std::nullopt;
    at = stop;
  }
  if (at != end) return std::nullopt;
  return values;
}

const std::string* find(const TextPairs& texts, std::string_view key) {
  for (const auto& [name, value] : texts)
    if (std::string_view(name).starts_with(kPrefix) && std::string_view(name).substr(kPrefix.size()) == key)
      return &value;
  return nullptr;
}

Error wrong(const char* what) {
  return {ErrorCode::kInvalidInput,
          std::string("what the volume says of its asset is wrong (mesocell:") + what + "); export it again"};
}

}  // namespace

TextPairs object_metadata(const CellObject& object) {
  const std::string prefix(kPrefix);
  return {{prefix + "version", std::string(kVersion)},
          {prefix + "box_min", text_of(object.grid.box_min)},
          {prefix + "voxel_edge", text_of(std::array<double, 1>{object.grid.voxel_edge})},
          {prefix + "tiles", text_of(object.grid.tiles)},
          {prefix + "resolution", text_of(object.tile.resolution)},
          {prefix + "rule", object.membership.rule == MembershipRule::kCentre ? "centre" : "conservative"},
          {prefix + "cells", text_of(std::array<std::uint32_t, 1>{object.tile.cell_count})}};
}

bool has_object_metadata(const TextPairs& texts) { return find(texts, "version") != nullptr; }

Result<ObjectLayout> parse_object_metadata(const TextPairs& texts) {
  const auto text = [&](std::string_view key) {
    const std::string* const value = find(texts, key);
    return value ? std::string_view(*value) : std::string_view();
  };
  if (text("version") != kVersion) return wrong("version");
  ObjectLayout layout;
  const auto box_min = parse<double, 3>(text("box_min"));
  if (!box_min) return wrong("box_min");
  const auto edge = parse<double, 1>(text("voxel_edge"));
  if (!edge || !((*edge)[0] > 0) || !std::isfinite((*edge)[0])) return wrong("voxel_edge");
  layout.grid.box_min = *box_min;
  layout.grid.voxel_edge = (*edge)[0];
  const auto tiles = parse<std::uint32_t, 3>(text("tiles"));
  const auto resolution = parse<std::uint32_t, 3>(text("resolution"));
  if (!tiles) return wrong("tiles");
  if (!resolution) return wrong("resolution");
  layout.grid.tiles = *tiles;
  layout.resolution = *resolution;
  std::uint64_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if ((*resolution)[a] < 4 || (*resolution)[a] > 1024) return wrong("resolution");
    if ((*tiles)[a] < 1 || (*tiles)[a] > kMaxTiles / count) return wrong("tiles");
    count *= (*tiles)[a];
    const double end =
        (*box_min)[a] + double((*tiles)[a]) * double((*resolution)[a]) * layout.grid.voxel_edge;
    if (!std::isfinite((*box_min)[a]) || !std::isfinite(end)) return wrong("box_min");
  }
  if (text("rule") != "centre" && text("rule") != "conservative") return wrong("rule");
  layout.rule = text("rule") == "centre" ? MembershipRule::kCentre : MembershipRule::kConservative;
  const auto cells = parse<std::uint32_t, 1>(text("cells"));
  if (!cells || (*cells)[0] < 1 || (*cells)[0] > 65535) return wrong("cells");
  layout.cells = (*cells)[0];
  return layout;
}

}  // namespace mesocell
