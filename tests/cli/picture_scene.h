#pragma once

#include <string>
#include <vector>

#include "converters/image/image_reader.h"
#include "tests/cli/run_command.h"
#include "tests/import/mesh_bytes.h"

namespace mesocell::test {

/// A folder with an asset, a ball of radius 1 about the origin, to make pictures of.
struct Scene {
  TempFolder folder;
  std::string asset = folder.file("ball.meso");

  /// `more`: words for its conversion.
  explicit Scene(const std::vector<std::string>& more = {});
  /// 48 × 32 pixels unless `more` says otherwise.
  [[nodiscard]] Run render(const std::string& output, const std::vector<std::string>& more = {}) const;
};

/// Lets this process load the image module that the command would load.
void find_image_module();

/// A picture that must be readable.
[[nodiscard]] Image read_picture(const std::string& path);

/// A picture as .hdr: equal pixels, each (m, m, m) · 2^(e - 136).
[[nodiscard]] std::string hdr_bytes(std::uint32_t width, std::uint32_t height, std::uint8_t m, std::uint8_t e,
                                    std::size_t pixels_written);

}  // namespace mesocell::test
