#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "format/result.h"

/// Values of a JSON that may hold anything. A fault is thrown as a GltfFault, which does not leave
/// normalize_gltf().
namespace mesocell {

struct GltfFault {
  Error error;
};

/// "accessor 3"
inline std::string numbered(const char* what, std::size_t i) {
  return std::string(what) + " " + std::to_string(i);
}

/// `where`: as numbered() gives it.
[[noreturn]] inline void gltf_fault(const std::string& where, const std::string& what) {
  throw GltfFault{{ErrorCode::kInvalidInput, where + " " + what + "; export the scene again"}};
}

using Json = nlohmann::json;

/// A member of an object, or null.
inline const Json* member(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

/// An array that may be missing: then, an empty one.
inline const Json& array_member(const Json& object, const char* key) {
  static const Json none = Json::array();
  const Json* found = member(object, key);
  if (!found) return none;
  if (!found->is_array()) gltf_fault(key, "is not an array");
  return *found;
}

/// A whole number up to `most`; some programs write 4.0 for 4.
inline std::uint64_t whole(const Json& value, const std::string& where, const char* key, std::uint64_t most) {
  std::uint64_t n = 0;
  bool good = value.is_number();
  if (value.is_number_unsigned()) {
    n = value.get<std::uint64_t>();
  } else if (value.is_number_integer()) {
    good = value.get<std::int64_t>() >= 0;
    if (good) n = std::uint64_t(value.get<std::int64_t>());
  } else if (good) {
    const double x = value.get<double>();
    good = x >= 0 && x <= 9e15 && x == double(std::uint64_t(x));
    if (good) n = std::uint64_t(x);
  }
  if (!good || n > most)
    gltf_fault(where, std::string("has a '") + key + "' that is not a whole number from 0 to " +
                          std::to_string(most));
  return n;
}

inline std::optional<std::uint64_t> whole_member(const Json& object, const std::string& where,
                                                 const char* key, std::uint64_t most = 0xffff'ffff) {
  const Json* found = member(object, key);
  if (!found) return std::nullopt;
  return whole(*found, where, key, most);
}

/// The index of something of which there are `count`.
inline std::optional<std::size_t> index_member(const Json& object, const std::string& where, const char* key,
                                               std::size_t count) {
  const Json* found = member(object, key);
  if (!found) return std::nullopt;
  if (count == 0) gltf_fault(where, std::string("names a '") + key + "', of which there are none");
  return std::size_t(whole(*found, where, key, count - 1));
}

/// Finite numbers, `count` of them; nothing if there is no such member.
inline std::optional<Json> numbers_member(const Json& object, const std::string& where, const char* key,
                                          std::size_t count) {
  const Json* found = member(object, key);
  if (!found) return std::nullopt;
  bool good = found->is_array() && found->size() == count;
  for (std::size_t i = 0; good && i < count; ++i) {
    good = (*found)[i].is_number();
    // Whole numbers of 64 bits are finite; other numbers that are not finite, JSON cannot hold.
  }
  if (!good)
    gltf_fault(where, std::string("has a '") + key + "' that is not " + std::to_string(count) + " numbers");
  Json numbers = Json::array();
  for (const Json& number : *found) numbers.push_back(number.get<double>());
  return numbers;
}

}  // namespace mesocell
