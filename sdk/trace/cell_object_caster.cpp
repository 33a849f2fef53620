#include "sdk/trace/cell_object_caster.h"

#include <charconv>
#include <optional>
#include <string>

#include "sdk/trace/distance.h"
#include "sdk/trace/exact.h"
#include "sdk/trace/linear.h"
#include "sdk/trace/lod.h"

namespace mesocell {
namespace {

std::optional<double> to_double(std::string_view text) {
  double x = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return x;
}

/// "1/512" or "0.002".
std::optional<double> to_step(std::string_view text) {
  const std::size_t slash = text.find('/');
  const auto above = to_double(text.substr(0, slash));
  const auto below = slash == std::string_view::npos ? 1.0 : to_double(text.substr(slash + 1));
  if (!above || !below) return std::nullopt;
  const double step = *above / *below;
  // Below a millionth of a tile a ray would take minutes.
  if (!(step >= 1e-6 && step <= 1)) return std::nullopt;
  return step;
}

using Made = Result<std::unique_ptr<Caster>>;

struct Method {
  std::string_view name;
  Made (*make)(const CellObject&, std::string_view parameter);
};

constexpr Method kMethods[] = {
    {"exact",
     [](const CellObject& object, std::string_view parameter) -> Made {
       if (!parameter.empty()) return Error{ErrorCode::kUsage, "method exact takes no parameter"};
       return make_exact_caster(object);
     }},
    {"linear",
     [](const CellObject& object, std::string_view parameter) -> Made {
       const std::size_t colon = parameter.find(':');
       const auto step = to_step(parameter.substr(0, colon));
       if (!step || (colon != std::string_view::npos && parameter.substr(colon) != ":angle"))
         return Error{
             ErrorCode::kUsage,
             "method linear needs a step in tile edges from 1e-6 to 1, as in linear:1/512 or, with the step "
             "shortened by the angle, linear:1/512:angle"};
       return make_linear_caster(object, *step,
                                 colon == std::string_view::npos ? LinearStep::kFixed : LinearStep::kByAngle);
     }},
    {"distance",
     [](const CellObject& object, std::string_view parameter) -> Made {
       if (!parameter.empty()) return Error{ErrorCode::kUsage, "method distance takes no parameter"};
       return make_distance_caster(object);
     }},
    {"lod",
     [](const CellObject& object, std::string_view parameter) -> Made {
       const auto pixels =
           parameter.ends_with("px") ? to_double(parameter.substr(0, parameter.size() - 2)) : std::nullopt;
       if (!pixels || !(*pixels >= 1e-3 && *pixels <= 1e3))
         return Error{
             ErrorCode::kUsage,
             "method lod needs the size of a voxel in the picture, from 0.001 to 1000 pixels, as in lod:1px"};
       return make_lod_caster(object, *pixels);
     }},
};

}  // namespace

Made make_cell_object_caster(const CellObject& object, std::string_view method) {
  const std::size_t colon = method.find(':');
  const std::string_view name = method.substr(0, colon);
  const std::string_view parameter = colon == std::string_view::npos ? "" : method.substr(colon + 1);
  std::string names;
  for (const Method& m : kMethods) {
    if (m.name == name) return m.make(object, parameter);
    names += (names.empty() ? "" : ", ") + std::string(m.name);
  }
  return Error{ErrorCode::kUsage, "unknown method '" + std::string(method) + "'; there are: " + names};
}

}  // namespace mesocell
