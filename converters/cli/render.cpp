#include "sdk/shade/render.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "converters/cli/commands.h"
#include "converters/cli/progress_bar.h"
#include "converters/cli/render_plan.h"
#include "converters/cli/representations.h"
#include "converters/image/image_file.h"
#include "converters/image/image_reader.h"
#include "sdk/shade/clip.h"

namespace mesocell {
namespace {

/// An --env that is no file.
constexpr std::string_view kSkyName = "sky";

std::optional<Failure> check_outputs(const RenderCommand& command) {
  if (Status status = check_image_path(command.output); !status)
    return Failure{status.error(), command.output};
  if (!command.depth.empty() && !has_extension(command.depth, ".exr"))
    return usage(command.depth, "depth is written as .exr alone; give it that extension");
  for (const std::string& output : {command.output, command.depth})
    for (const std::string& input : {command.input, command.env})
      if (!output.empty() && !input.empty() && same_file(output, input))
        return usage(output, "input and output are the same file; name another output");
  if (!command.depth.empty() && same_file(command.depth, command.output))
    return usage(command.depth, "the picture and --depth are the same file; name another one");
  for (const std::string& output : {command.output, command.depth})
    if (!output.empty())
      if (Status status = check_output(output, command.no_clobber); !status)
        return Failure{status.error(), output};
  return std::nullopt;
}

struct Layer {
  const std::vector<float>* values;
  std::vector<std::string> channels;
};

/// All that is known of each pixel, channels side by side.
std::optional<Failure> write_layers(const std::string& path, const RenderResult& picture,
                                    const ImageWriteOptions& options) {
  const std::vector<Layer> layers = {{&picture.rgb, {"R", "G", "B"}},
                                     {&picture.depth, {"depth.Z"}},
                                     {&picture.normal, {"normal.X", "normal.Y", "normal.Z"}},
                                     {&picture.color, {"color.R", "color.G", "color.B"}},
                                     {&picture.cell, {"cell.id"}}};
  std::vector<std::string> channels;
  for (const Layer& layer : layers)
    channels.insert(channels.end(), layer.channels.begin(), layer.channels.end());
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  std::vector<float> values;
  values.reserve(pixels * channels.size());
  for (std::size_t i = 0; i < pixels; ++i)
    for (const Layer& layer : layers) {
      const auto first = layer.values->begin() + std::ptrdiff_t(i * layer.channels.size());
      values.insert(values.end(), first, first + std::ptrdiff_t(layer.channels.size()));
    }
  const ImageView image{picture.width, picture.height, channels, values};
  if (Status status = write_image_file(path, image, options); !status) return Failure{status.error(), path};
  return std::nullopt;
}

std::optional<Failure> write_pictures(const RenderCommand& command, const RenderResult& picture) {
  static const std::array<std::string, 3> color = {"R", "G", "B"};
  static const std::array<std::string, 1> depth = {"Z"};
  const ImageWriteOptions write{command.no_clobber};
  if (has_extension(command.output, ".exr")) {
    if (auto failure = write_layers(command.output, picture, write)) return failure;
  } else if (Status status =
                 write_image_file(command.output, {picture.width, picture.height, color, picture.rgb}, write);
             !status) {
    return Failure{status.error(), command.output};
  }
  if (command.depth.empty()) return std::nullopt;
  const ImageView distances{picture.width, picture.height, depth, picture.depth};
  if (Status status = write_image_file(command.depth, distances, write); !status)
    return Failure{status.error(), command.depth};
  return std::nullopt;
}

/// A picture as what surrounds the object, or the sky; gray pictures have one channel for all three colors.
std::optional<Failure> read_environment(const std::string& path, std::optional<Environment>& environment) {
  if (path == kSkyName) {
    environment.emplace(make_sky());
    return std::nullopt;
  }
  Result<Image> image = read_image_file(path);
  if (!image) return Failure{image.error(), path};
  to_linear(*image);
  std::array<std::size_t, 3> from{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::array<std::string_view, 3> names = {"R", "G", "B"};
    const std::optional<std::size_t> color = find_channel(*image, names[c]), gray = find_channel(*image, "Y");
    if (!color && !gray)
      return Failure{Error{ErrorCode::kInvalidInput,
                           "it has neither channels R, G, B nor Y; use a picture that has colors"},
                     path};
    from[c] = color ? *color : *gray;
  }
  const std::size_t pixels = std::size_t{image->width} * image->height, stride = image->channels.size();
  std::vector<float> rgb;
  rgb.reserve(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i)
    for (const std::size_t c : from) {
      const float value = image->pixels[i * stride + c];
      if (!(value >= 0 && std::isfinite(value)))
        return Failure{
            Error{ErrorCode::kInvalidInput,
                  "a pixel is negative, infinite or not a number, which no light is; use a picture "
                  "of light"},
            path};
      rgb.push_back(value);
    }
  environment.emplace(std::move(rgb), image->width, image->height);
  return std::nullopt;
}

std::optional<Failure> render_file(const RenderCommand& command, const Progress& progress, RenderPlan& plan,
                                   RenderResult& picture) {
  if (auto failure = make_render_plan(command, plan)) return failure;
  if (auto failure = check_outputs(command)) return failure;
  std::optional<Environment> environment;
  if (plan.uses_environment) {
    if (auto failure = read_environment(command.env, environment)) return failure;
    plan.options.environment = &*environment;
  }
  const Result<AssetFile> file = read_asset_file(command.input);
  if (!file) return Failure{file.error(), command.input};
  const Result<std::unique_ptr<Caster>> whole = file->first().make_caster(command.method);
  if (!whole) return Failure{whole.error(), "--method"};
  std::optional<ClippedCaster> clipped;
  if (plan.clip) clipped.emplace(**whole, plan.clip->normal, plan.clip->distance);
  const Caster& caster = clipped ? static_cast<const Caster&>(*clipped) : **whole;
  Result<RenderResult> rendered = render(caster, plan.options, &progress);
  plan.options.environment = nullptr;  // it ends with this call
  if (!rendered) return Failure{rendered.error(), rendered.error().code == ErrorCode::kUsage ? "camera" : ""};
  if (progress.cancelled()) return Failure{Error{ErrorCode::kCancelled, "interrupted"}, {}};
  picture = std::move(*rendered);
  return write_pictures(command, picture);
}

}  // namespace

int run_render(const RenderCommand& command) {
  const Console console(command.common);
  ProgressBar bar(!console.quiet());
  RenderPlan plan;
  RenderResult picture;
  const std::optional<Failure> failure = render_file(command, bar.progress(), plan, picture);
  bar.finish();
  if (failure) return console.fail(*failure);
  for (const Warning& warning : plan.warnings) console.warn(command.output, warning.text);
  const double rate = picture.seconds > 0 ? double(picture.rays) / picture.seconds : 0;
  if (console.json()) {
    nlohmann::ordered_json json;
    json["width"] = picture.width;
    json["height"] = picture.height;
    json["rays"] = picture.rays;
    json["hits"] = picture.hits;
    json["seconds"] = picture.seconds;
    json["rays_per_second"] = rate;
    json["method"] = command.method;
    json["mode"] = command.mode;
    json["warnings"] = nlohmann::ordered_json::array();
    for (const Warning& warning : plan.warnings)
      json["warnings"].push_back({{"id", warning.id}, {"text", warning.text}});
    return console.finish(json_text(json));
  }
  if (console.quiet()) return kExitDone;
  char text[160];
  std::snprintf(text, sizeof text, ": %u x %u, %.1f %% of the rays hit, %.2f s, %.2f million rays/s\n",
                picture.width, picture.height, 100 * double(picture.hits) / double(picture.rays),
                picture.seconds, rate * 1e-6);
  return console.finish(printable(command.output) + text);
}

}  // namespace mesocell
