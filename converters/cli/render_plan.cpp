#include "converters/cli/render_plan.h"

#include <array>
#include <cmath>

#include "converters/cli/values.h"

namespace mesocell {
namespace {

std::optional<Failure> parse_vector(const std::string& text, const char* option,
                                          std::optional<Vec3>& vector) {
  if (text.empty()) return std::nullopt;
  const Result<Vec3> parsed = parse_vec3(text);
  if (!parsed) return Failure{parsed.error(), option};
  vector = *parsed;
  return std::nullopt;
}

/// Whether a vector can be scaled to length 1.
bool has_direction(Vec3 v) { return length(v) > 0 && std::isfinite(length(v)); }

std::optional<Failure> parse_camera(const RenderCommand& command, CameraOptions& camera) {
  if (auto failure = parse_vector(command.eye, "--eye", camera.eye)) return failure;
  if (auto failure = parse_vector(command.look, "--look", camera.look)) return failure;
  if (auto failure = parse_vector(command.up, "--up", camera.up)) return failure;
  if (!command.fov) return std::nullopt;
  if (!(*command.fov > 0 && *command.fov < 180))
    return usage("--fov", "the angle must be above 0 and below 180 degrees");
  camera.fov_degrees = *command.fov;
  return std::nullopt;
}

std::optional<Failure> parse_lighting(const RenderCommand& command, Lighting& lighting) {
  lighting.bounces = command.bounces.value_or(lighting.bounces);
  lighting.events = command.events.value_or(lighting.events);
  lighting.occlusion_rays = command.ao.value_or(lighting.occlusion_rays);
  if (command.reflectivity) {
    if (!(*command.reflectivity >= 0 && *command.reflectivity <= 1))
      return usage("--reflectivity", "the share of the light must be from 0 to 1");
    lighting.reflectivity = *command.reflectivity;
  }
  if (command.ior) {
    if (!(*command.ior >= 1 && *command.ior <= 10))
      return usage("--ior", "the index of refraction must be from 1 to 10; glass has 1.5");
    lighting.ior = *command.ior;
  }
  if (auto failure = parse_vector(command.light, "--light", lighting.light)) return failure;
  if (lighting.light && !has_direction(*lighting.light))
    return usage("--light", "the light has no direction; give the one towards it, for example 1,2,1");
  return std::nullopt;
}

std::optional<Failure> parse_clip(const RenderCommand& command, std::optional<ClipPlane>& clip) {
  if (command.clip.empty()) return std::nullopt;
  const Result<std::array<double, 4>> numbers = parse_numbers<4>(command.clip);
  if (!numbers) return Failure{numbers.error(), "--clip"};
  const auto& [x, y, z, distance] = *numbers;
  clip = ClipPlane{{x, y, z}, distance};
  if (has_direction(clip->normal) && std::isfinite(distance / length(clip->normal))) return std::nullopt;
  return usage("--clip", "the plane has no normal; write NX,NY,NZ,D, for example 1,0,0,0.5");
}

/// Says of every option that was given and does nothing why that is so.
std::vector<Warning> find_unused(const RenderCommand& command, const RenderOptions& options) {
  std::vector<Warning> warnings;
  const auto unused = [&](bool given, const char* option, const std::string& why) {
    if (given) warnings.push_back({"option-unused", std::string(option) + " has no effect " + why});
  };
  const bool light = !command.light.empty(), ao = command.ao.has_value();
  if (options.mode != RenderMode::kFirstHit) {
    const std::string why = "in mode " + command.mode + "; it is for first-hit";
    unused(command.samples.has_value(), "--samples", why);
    unused(command.bounces.has_value(), "--bounces", why);
    unused(command.reflectivity.has_value(), "--reflectivity", why);
    unused(command.ior.has_value(), "--ior", why);
    unused(command.events.has_value(), "--events", why);
    unused(light, "--light", why);
    unused(ao, "--ao", why);
    unused(!command.env.empty(), "--env", why);
    return warnings;
  }
  if (command.ior) {
    const std::string why = "on a clear object; leave out --ior";
    unused(command.bounces.has_value(), "--bounces", why);
    unused(command.reflectivity.has_value(), "--reflectivity", why);
    unused(light, "--light", why);
    unused(ao, "--ao", why);
    return warnings;
  }
  unused(command.events.has_value(), "--events", "on an opaque object; give --ior too");
  if (options.lighting.bounces == 0) {
    unused(command.reflectivity.has_value(), "--reflectivity", "without reflections; give --bounces too");
    return warnings;
  }
  if (options.lighting.reflectivity == 1) {
    const std::string why = "on a mirror that reflects all light; give --reflectivity too";
    unused(light, "--light", why);
    unused(ao, "--ao", why);
  }
  return warnings;
}

}  // namespace

std::optional<Failure> make_render_plan(const RenderCommand& command, RenderPlan& plan) {
  RenderOptions& options = plan.options;
  const Result<RenderMode> mode = parse_render_mode(command.mode);
  if (!mode) return Failure{mode.error(), "--mode"};
  options.mode = *mode;
  const Result<std::array<std::uint32_t, 2>> size = parse_size(command.size);
  if (!size) return Failure{size.error(), "--size"};
  options.width = (*size)[0];
  options.height = (*size)[1];
  if (auto failure = parse_camera(command, options.camera)) return failure;
  if (auto failure = parse_lighting(command, options.lighting)) return failure;
  if (auto failure = parse_clip(command, plan.clip)) return failure;
  options.samples = command.samples.value_or(options.samples);
  options.threads = command.common.threads;
  options.layers = has_extension(command.output, ".exr");
  plan.uses_environment = !command.env.empty() && options.mode == RenderMode::kFirstHit;
  plan.warnings = find_unused(command, options);
  return std::nullopt;
}

}  // namespace mesocell
