#include "sdk/shade/render.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "converters/cli/commands.h"
#include "converters/cli/progress_bar.h"
#include "converters/cli/representations.h"
#include "converters/cli/values.h"
#include "converters/export/image_file.h"

namespace mesocell {
namespace {

struct Failure {
  Error error;
  std::string subject;
};

Failure usage(std::string subject, std::string message) {
  return {Error{ErrorCode::kUsage, std::move(message)}, std::move(subject)};
}

std::optional<Failure> parse_vector(const std::string& text, const char* option,
                                    std::optional<Vec3>& vector) {
  if (text.empty()) return std::nullopt;
  const Result<Vec3> parsed = parse_vec3(text);
  if (!parsed) return Failure{parsed.error(), option};
  vector = *parsed;
  return std::nullopt;
}

/// What the words of the command line mean; all of it is checked before the input is read.
std::optional<Failure> make_options(const RenderCommand& command, RenderOptions& options) {
  const Result<RenderMode> mode = parse_render_mode(command.mode);
  if (!mode) return Failure{mode.error(), "--mode"};
  options.mode = *mode;
  const Result<std::array<std::uint32_t, 2>> size = parse_size(command.size);
  if (!size) return Failure{size.error(), "--size"};
  options.width = (*size)[0];
  options.height = (*size)[1];
  if (auto failure = parse_vector(command.eye, "--eye", options.camera.eye)) return failure;
  if (auto failure = parse_vector(command.look, "--look", options.camera.look)) return failure;
  if (auto failure = parse_vector(command.up, "--up", options.camera.up)) return failure;
  if (command.fov) {
    if (!(*command.fov > 0 && *command.fov < 180))
      return usage("--fov", "the angle must be above 0 and below 180 degrees");
    options.camera.fov_degrees = *command.fov;
  }
  options.threads = command.common.threads;
  return std::nullopt;
}

std::optional<Failure> check_outputs(const RenderCommand& command) {
  if (Status status = check_image_path(command.output); !status)
    return Failure{status.error(), command.output};
  if (!command.depth.empty() && !has_extension(command.depth, ".exr"))
    return usage(command.depth, "depth is written as .exr alone; give it that extension");
  for (const std::string& output : {command.output, command.depth})
    if (!output.empty() && same_file(output, command.input))
      return usage(output, "input and output are the same file; name another output");
  if (!command.depth.empty() && same_file(command.depth, command.output))
    return usage(command.depth, "the picture and --depth are the same file; name another one");
  for (const std::string& output : {command.output, command.depth})
    if (!output.empty())
      if (Status status = check_output(output, command.no_clobber); !status)
        return Failure{status.error(), output};
  return std::nullopt;
}

const std::array<std::string, 3> kColor = {"R", "G", "B"};
const std::array<std::string, 1> kDepth = {"Z"};

std::optional<Failure> write_pictures(const RenderCommand& command, const RenderOptions& options,
                                      const RenderResult& picture) {
  const ImageView color{picture.width, picture.height, kColor, picture.rgb};
  const ImageView depth{picture.width, picture.height, kDepth, picture.depth};
  const ImageWriteOptions write{command.no_clobber};
  // Depth in a float file is the distance itself; in a PNG it is a picture of it.
  const bool distances = options.mode == RenderMode::kDepth && has_extension(command.output, ".exr");
  if (Status status = write_image_file(command.output, distances ? depth : color, write); !status)
    return Failure{status.error(), command.output};
  if (!command.depth.empty())
    if (Status status = write_image_file(command.depth, depth, write); !status)
      return Failure{status.error(), command.depth};
  return std::nullopt;
}

std::optional<Failure> render_file(const RenderCommand& command, const Progress& progress,
                                   RenderResult& picture) {
  RenderOptions options;
  if (auto failure = make_options(command, options)) return failure;
  if (auto failure = check_outputs(command)) return failure;
  const Result<AssetFile> file = read_asset_file(command.input);
  if (!file) return Failure{file.error(), command.input};
  const Result<std::unique_ptr<Caster>> caster = file->asset->make_caster(command.method);
  if (!caster) return Failure{caster.error(), "--method"};
  Result<RenderResult> rendered = render(**caster, options, &progress);
  if (!rendered) return Failure{rendered.error(), rendered.error().code == ErrorCode::kUsage ? "camera" : ""};
  if (progress.cancelled()) return Failure{Error{ErrorCode::kCancelled, "interrupted"}, {}};
  picture = std::move(*rendered);
  return write_pictures(command, options, picture);
}

}  // namespace

int run_render(const RenderCommand& command) {
  const Console console(command.common);
  ProgressBar bar(!console.quiet());
  RenderResult picture;
  const std::optional<Failure> failure = render_file(command, bar.progress(), picture);
  bar.finish();
  if (failure) return console.fail(failure->error, failure->subject);
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
