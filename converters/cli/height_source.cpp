#include "converters/cli/height_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "converters/import/height_file.h"
#include "sdk/author/height_field.h"
#include "sdk/core/number_text.h"
#include "sdk/core/portable_math.h"
#include "sdk/core/recipe.h"

namespace mesocell {
namespace {

constexpr const char* kHeightsOption = "--heights";

Result<std::optional<double>> optional_number(const Recipe& recipe, const std::string& name, double low) {
  if (!recipe.options.contains(name)) return std::optional<double>();
  const auto value = number_option(recipe, name, 0, low, 1e300);
  if (!value) return value.error();
  return std::optional<double>(*value);
}

/// The ground as it is, a solid block.
class HeightShape final : public ShapeSource {
 public:
  HeightShape(HeightField field, std::string text) : block_(std::move(field)), text_(std::move(text)) {}
  [[nodiscard]] Result<CellObject> fill(TileMap tile, const AuthorOptions& options, AuthorReport& report,
                                        const Progress& progress) const override {
    return author_cell_object(block_, std::move(tile), options, &report, &progress);
  }
  [[nodiscard]] const TriangleMesh& surface() const override { return none_; }
  [[nodiscard]] Metadata metadata() const override { return {{"heights", text_}}; }
  [[nodiscard]] Status check_colors() const override { return mesh_without_colors(); }

 private:
  HeightBlock block_;
  std::string text_;
  TriangleMesh none_;
};

/// The field in metres, with all that the plan leaves open filled in.
Result<HeightField> lay_field(HeightSamples samples, const HeightPlan& plan) {
  HeightField field{.width = samples.width, .depth = samples.depth, .samples = std::move(samples.samples)};
  const double longest = std::max(field.width, field.depth);
  field.spacing = plan.spacing.value_or(1 / longest);
  // Samples are as they are stored; values are what the words of the plan are about.
  const double full = plan.scaled ? double(samples.full) : 1.0;
  if (plan.gamma)
    for (float& s : field.samples) {
      if (s < 0) return Error{ErrorCode::kUsage, "a value below 0 has no power; leave gamma out"};
      s = float(portable_power(double(s) / full, *plan.gamma) * full);
    }
  const double sign = plan.black_up ? -1 : 1;
  const HeightRange range = height_range(field);
  const double low = double(range.low) / full, high = double(range.high) / full;
  const double rise = high > low ? high - low : 1;
  const double scale = plan.scale.value_or(longest * field.spacing / 5 / rise);
  field.scale = sign * scale / full;
  field.zero = plan.zero.value_or(plan.black_up ? high : low) * full;
  const double bottom = std::min(field.height(range.low), field.height(range.high));
  const double top = std::max(field.height(range.low), field.height(range.high));
  field.floor =
      plan.floor.value_or(bottom - (top > bottom ? (top - bottom) / 10 : longest * field.spacing / 50));
  if (Status status = check_height_field(field); !status) return status.error();
  if (!(top > field.floor))
    return Error{ErrorCode::kUsage, "the floor of " + number_text(field.floor) +
                                        " m is not below the highest point, which is at " + number_text(top) +
                                        " m; give a lower floor"};
  return field;
}

std::string field_text(const HeightField& field, const HeightSamples& samples, const HeightPlan& plan) {
  Recipe recipe;
  recipe.name = "heights";
  const double full = plan.scaled ? double(samples.full) : 1.0;
  recipe.options = {
      {"as", plan.as_mesh ? "mesh" : "block"},       {"channel", samples.channel},
      {"floor", number_text(field.floor)},           {"scale", number_text(std::abs(field.scale) * full)},
      {"spacing", number_text(field.spacing)},       {"up", plan.black_up ? "black" : "white"},
      {"values", plan.scaled ? "scaled" : "stored"}, {"zero", number_text(field.zero / full)}};
  if (plan.gamma) recipe.options["gamma"] = number_text(*plan.gamma);
  if (plan.no_data) recipe.options["nodata"] = number_text(*plan.no_data);
  return to_text(recipe);
}

}  // namespace

Result<HeightPlan> parse_height_plan(const std::string& text) {
  const Result<Recipe> recipe = parse_recipe(text.empty() ? "heights" : "heights:" + text);
  if (!recipe) return recipe.error();
  constexpr std::array<std::string_view, 10> kKeys = {"gamma", "as",      "channel", "floor",  "nodata",
                                                      "scale", "spacing", "up",      "values", "zero"};
  if (const Status status = check_options(*recipe, "heights", kKeys); !status) return status.error();
  HeightPlan plan;
  const auto as = choice_option(*recipe, "as", {"block", "mesh"});
  if (!as) return as.error();
  plan.as_mesh = *as == 1;
  const auto up = choice_option(*recipe, "up", {"white", "black"});
  if (!up) return up.error();
  plan.black_up = *up == 1;
  const auto values = choice_option(*recipe, "values", {"scaled", "stored"});
  if (!values) return values.error();
  plan.scaled = *values == 0;
  if (const auto channel = recipe->options.find("channel"); channel != recipe->options.end())
    plan.channel = channel->second;
  const auto take = [&](const char* name, double low, std::optional<double>& to) -> Status {
    const auto value = optional_number(*recipe, name, low);
    if (!value) return value.error();
    to = *value;
    return {};
  };
  if (Status status = take("spacing", 1e-300, plan.spacing); !status) return status.error();
  if (Status status = take("scale", 1e-300, plan.scale); !status) return status.error();
  if (Status status = take("zero", -1e300, plan.zero); !status) return status.error();
  if (Status status = take("floor", -1e300, plan.floor); !status) return status.error();
  if (Status status = take("gamma", 0.01, plan.gamma); !status) return status.error();
  if (plan.gamma && *plan.gamma > 100)
    return Error{ErrorCode::kUsage, "option gamma is not a number from 0.01 to 100"};
  if (Status status = take("nodata", -1e300, plan.no_data); !status) return status.error();
  return plan;
}

std::optional<Failure> read_heights(const std::string& input, const HeightPlan& plan,
                                    const Progress& progress, std::unique_ptr<ShapeSource>& shape,
                                    std::vector<Warning>& warnings, ReadNotes& notes) {
  Result<HeightSamples> samples =
      read_height_file(input, {.channel = plan.channel, .no_data = plan.no_data}, &progress);
  if (!samples)
    return Failure{samples.error(), samples.error().code == ErrorCode::kUsage ? kHeightsOption : input};
  notes.add(samples->notes);
  HeightSamples facts = *samples;
  facts.samples.clear();
  Result<HeightField> field = lay_field(std::move(*samples), plan);
  if (!field) return Failure{field.error(), field.error().code == ErrorCode::kUsage ? kHeightsOption : input};
  if (!facts.exact)
    warnings.push_back(
        {"heights-lossy",
         "a lossy compression left its marks on these heights; better take them from a PNG, TIFF or "
         "EXR"});
  if (const std::uint64_t missing = height_range(*field).missing; missing > 0)
    warnings.push_back(
        {"heights-missing", std::to_string(missing) + " heights are missing; there is a hole at each"});
  std::string text = field_text(*field, facts, plan);
  if (!plan.as_mesh) {
    shape = std::make_unique<HeightShape>(std::move(*field), std::move(text));
    return std::nullopt;
  }
  Result<TriangleMesh> mesh = make_height_mesh(*field);
  if (!mesh) return Failure{mesh.error(), input};
  shape = make_mesh_shape(std::move(*mesh), {{"heights", std::move(text)}});
  return std::nullopt;
}

std::string heights_help() {
  return "as=block|mesh: the solid ground, or a closed mesh with a vertex at each height [block]; spacing: "
         "metres "
         "between heights [the longest side is 1 m]; values=scaled|stored: integers from 0 to 1, or as they "
         "stand "
         "[scaled]; scale: metres for a value of 1 [the heights rise by a fifth of the longest side]; zero: "
         "the "
         "value at a height of 0 m [the lowest]; up=white|black: what is high [white]; floor: where the "
         "ground "
         "ends below, metres [a tenth of the rise below the lowest]; nodata: the stored value of a missing "
         "height "
         "(not a number is one, too); gamma: values are raised to that power, for pictures that were saved "
         "with a tone curve [1]; channel: by its name [the first]. x runs along the rows, z down the "
         "columns, y is up.\n";
}

}  // namespace mesocell
