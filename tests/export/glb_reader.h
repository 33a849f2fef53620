#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/export/surfaces.h"
#include "tests/support/catch.h"

namespace mesocell::test {

/// A GLB file taken apart by hand.
struct Glb {
  nlohmann::json json;
  std::string binary;

  explicit Glb(const std::string& path) {
    std::ostringstream all;
    all << std::ifstream(path, std::ios::binary).rdbuf();
    const std::string bytes = all.str();
    const auto u32 = [&](std::size_t at) {
      std::uint32_t v = 0;
      std::memcpy(&v, bytes.data() + at, 4);
      return v;
    };
    REQUIRE(bytes.size() > 28);
    REQUIRE(bytes.substr(0, 4) == "glTF");
    REQUIRE(u32(4) == 2);
    REQUIRE(u32(8) == bytes.size());
    const std::uint32_t length = u32(12);
    REQUIRE(bytes.substr(16, 4) == "JSON");
    json = nlohmann::json::parse(bytes.substr(20, length));
    REQUIRE(u32(20 + length) == bytes.size() - 28 - length);
    binary = bytes.substr(28 + length);
  }

  /// The numbers of an accessor, in one row.
  [[nodiscard]] std::vector<double> numbers(std::size_t accessor) const {
    const auto& a = json["accessors"][accessor];
    const auto& view = json["bufferViews"][a["bufferView"].get<std::size_t>()];
    const std::string type = a["type"];
    const std::size_t components = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : 4;
    const int kind = a["componentType"];
    const std::size_t bytes = kind == 5123 ? 2 : 4;
    const std::size_t count = a["count"].get<std::size_t>() * components;
    REQUIRE(view["byteLength"] == count * bytes);
    std::vector<double> out;
    for (std::size_t k = 0; k < count; ++k) {
      const char* p = binary.data() + view["byteOffset"].get<std::size_t>() + k * bytes;
      std::uint16_t small = 0;
      std::uint32_t whole = 0;
      float real = 0;
      std::memcpy(&small, p, 2);
      if (bytes == 4) std::memcpy(&whole, p, 4);
      if (bytes == 4) std::memcpy(&real, p, 4);
      out.push_back(kind == 5123 ? small : kind == 5125 ? whole : double(real));
    }
    return out;
  }

  [[nodiscard]] std::multiset<LatticeTriangle> triangles(std::size_t mesh) const {
    const auto& primitive = json["meshes"][mesh]["primitives"][0];
    const auto positions = numbers(primitive["attributes"]["POSITION"]);
    const auto indices = numbers(primitive["indices"]);
    std::multiset<LatticeTriangle> out;
    for (std::size_t k = 0; k < indices.size(); k += 3) {
      LatticeTriangle t;
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t a = 0; a < 3; ++a)
          t[c][a] = std::int32_t(positions.at(3 * std::size_t(indices[k + c]) + a));
      out.insert(turned(t));
    }
    return out;
  }
};

}  // namespace mesocell::test
