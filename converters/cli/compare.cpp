#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "converters/cli/comparison.h"
#include "converters/cli/progress_bar.h"
#include "converters/cli/representations.h"
#include "converters/image/image_reader.h"
#include "converters/import/mesh_file.h"

namespace mesocell {
namespace {

using Json = nlohmann::ordered_json;

/// Differences over all channels of all pixels.
struct Figures {
  double max = 0, mean = 0, rmse = 0;
  /// dB, of a peak of 1; infinite for equal pictures.
  [[nodiscard]] double psnr() const { return -20 * std::log10(rmse); }
};

/// What is infinite, or not a number, on both sides is equal.
double difference(float a, float b) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
  const double d = std::abs(double{a} - double{b});
  return std::isnan(d) ? std::numeric_limits<double>::infinity() : d;
}

/// `of_b`: for each channel of `a` the one of `b` of the same name.
Figures compare_values(const Image& a, const Image& b, const std::vector<std::size_t>& of_b) {
  Figures figures;
  const std::size_t channels = a.channels.size();
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < a.pixels.size(); i += channels)
    for (std::size_t c = 0; c < channels; ++c) {
      const double d = difference(a.pixels[i + c], b.pixels[i + of_b[c]]);
      figures.max = std::max(figures.max, d);
      sum += d;
      squares += d * d;
    }
  figures.mean = sum / double(a.pixels.size());
  figures.rmse = std::sqrt(squares / double(a.pixels.size()));
  return figures;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Result<std::vector<std::size_t>> match_channels(const Image& a, const Image& b) {
  const auto names = [](const Image& image) {
    std::string text;
    for (const std::string& name : image.channels) text += (text.empty() ? "" : ", ") + name;
    return text;
  };
  std::vector<std::size_t> of_b;
  for (const std::string& name : a.channels)
    if (const auto channel = find_channel(b, name)) of_b.push_back(*channel);
  if (of_b.size() == a.channels.size() && of_b.size() == b.channels.size()) return of_b;
  return Error{ErrorCode::kInvalidInput, "the channels differ: " + names(a) + " and " + names(b)};
}

std::string size_text(const Image& image) {
  return std::to_string(image.width) + " x " + std::to_string(image.height);
}

Comparison compare_images(Image a, Image b, double tolerance) {
  if (a.encoding != b.encoding) {
    to_linear(a);
    to_linear(b);
  }
  Comparison result;
  Json& json = result.json;
  json = {{"kind", "picture"},      {"equal", false},     {"differences", Json::array()},
          {"width", a.width},       {"height", a.height}, {"channels", a.channels},
          {"tolerance", tolerance}, {"max", nullptr},     {"mean", nullptr},
          {"rmse", nullptr},        {"psnr", nullptr}};
  if (a.width != b.width || a.height != b.height) {
    json["differences"].push_back("size");
    result.text = "the sizes differ: " + size_text(a) + " and " + size_text(b) + "\n";
    return result;
  }
  const Result<std::vector<std::size_t>> of_b = match_channels(a, b);
  if (!of_b) {
    json["differences"].push_back("channels");
    result.text = of_b.error().message + "\n";
    return result;
  }
  const Figures figures = compare_values(a, b, *of_b);
  const bool equal = figures.max <= tolerance;
  if (!equal) json["differences"].push_back("values");
  json["equal"] = equal;
  json["max"] = number(figures.max);
  json["mean"] = number(figures.mean);
  json["rmse"] = number(figures.rmse);
  json["psnr"] = number(figures.psnr());
  char text[256];
  std::snprintf(text, sizeof text, "max %.6g, mean %.6g, RMSE %.6g, PSNR %.2f dB; %s the tolerance of %g\n",
                figures.max, figures.mean, figures.rmse, figures.psnr(), equal ? "within" : "over",
                tolerance);
  result.text = text;
  return result;
}

Json compare_asset(const NamedAsset& a, const NamedAsset& b) {
  Json json = {{"differences", Json::array()}};
  if (a.representation != b.representation) {
    json["differences"].push_back("representation");
  } else {
    a.asset->compare(*b.asset, json);
  }
  return json;
}

/// Assets by their order; those of the first pair are told in full.
Comparison compare_assets(const AssetFile& a, const AssetFile& b) {
  Comparison result;
  Json& json = result.json;
  json = {{"kind", "asset"}, {"equal", false}};
  json.update(compare_asset(a.assets.front(), b.assets.front()));
  bool others_equal = a.assets.size() == b.assets.size();
  for (std::size_t i = 0; i < a.assets.size() && others_equal; ++i) {
    others_equal = (a.assets.size() == 1 || a.assets[i].name == b.assets[i].name) &&
                   (i == 0 || compare_asset(a.assets[i], b.assets[i])["differences"].empty());
  }
  if (!others_equal) json["differences"].push_back("assets");
  json["equal"] = json["differences"].empty();
  if (json["equal"]) {
    result.text = "the assets are equal\n";
    return result;
  }
  result.text = "the assets differ\n";
  for (const auto& [key, value] : json.items())
    if (key != "kind" && key != "equal")
      result.text +=
          "  " + key + " " + printable(value.dump(-1, ' ', false, Json::error_handler_t::replace)) + "\n";
  return result;
}

std::optional<Failure> compare_pictures(const CompareCommand& command, const Progress&, Comparison& result) {
  const double tolerance = command.tolerance.value_or(0);
  if (!(tolerance >= 0 && tolerance <= 1))
    return usage("--tolerance", "the tolerance of pictures must be from 0 to 1");
  Result<Image> a = read_image_file(command.a);
  if (!a) return Failure{a.error(), command.a};
  Result<Image> b = read_image_file(command.b);
  if (!b) return Failure{b.error(), command.b};
  result = compare_images(std::move(*a), std::move(*b), tolerance);
  return std::nullopt;
}

std::optional<Failure> compare_two_assets(const CompareCommand& command, const Progress&,
                                          Comparison& result) {
  const Result<AssetFile> a = read_whole_asset_file(command.a);
  if (!a) return Failure{a.error(), command.a};
  const Result<AssetFile> b = read_whole_asset_file(command.b);
  if (!b) return Failure{b.error(), command.b};
  result = compare_assets(*a, *b);
  return std::nullopt;
}

bool is_asset(const std::string& path) { return is_asset_path(path); }

/// What can be compared with what, and which options have an effect on it.
struct Row {
  bool (*is_a)(const std::string& path);
  bool (*is_b)(const std::string& path);
  std::optional<Failure> (*compare)(const CompareCommand&, const Progress&, Comparison&);
  bool tolerance, samples;
};
constexpr Row kRows[] = {
    {is_readable_image, is_readable_image, compare_pictures, true, false},
    {is_asset, is_asset, compare_two_assets, false, false},
    {is_asset, is_readable_mesh, compare_with_mesh, true, true},
};

/// The row for two paths; a failure if there is none.
std::optional<Failure> find_row(const CompareCommand& command, const Row*& found) {
  for (const std::string& path : {command.a, command.b})
    if (!is_asset(path) && !is_readable_image(path) && !is_readable_mesh(path))
      return usage(path, std::string("it is neither .meso nor a picture nor a mesh; use .meso, ") +
                             kReadableImages + ", " + kMeshExtensions);
  for (const Row& row : kRows)
    if (row.is_a(command.a) && row.is_b(command.b)) found = &row;
  if (found) return std::nullopt;
  return usage(command.a + ", " + command.b,
               "these cannot be compared; name two pictures, two assets, or an asset and then a mesh");
}

}  // namespace

int run_compare(const CompareCommand& command) {
  const Console console(command.common);
  const Row* row = nullptr;
  if (const std::optional<Failure> failure = find_row(command, row)) return console.fail(*failure);
  ProgressBar bar(!console.quiet());
  Comparison result;
  const std::optional<Failure> failure = row->compare(command, bar.progress(), result);
  bar.finish();
  if (failure) return console.fail(*failure);
  if (command.tolerance && !row->tolerance)
    console.warn("--tolerance",
                 "it has no effect on two assets; it is for pictures, and an asset and a mesh");
  for (const auto& [name, given] :
       {std::pair("--samples", command.samples.has_value()), std::pair("--seed", command.seed.has_value())})
    if (given && !row->samples) console.warn(name, "it has no effect here; it is for an asset and a mesh");
  const int code = result.json["equal"] ? kExitDone : kExitCheckFailed;
  if (console.json()) return console.finish(json_text(result.json), code);
  if (console.quiet() && code == kExitDone) return code;
  return console.finish(printable(command.a) + ", " + printable(command.b) + ": " + result.text, code);
}

}  // namespace mesocell
