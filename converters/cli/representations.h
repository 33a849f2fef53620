#pragma once

#include <cstddef>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "format/container.h"
#include "format/limits.h"
#include "format/result.h"
#include "sdk/core/triangle_mesh.h"
#include "sdk/measure/surface_distance.h"
#include "sdk/trace/caster.h"

namespace mesocell {

/// An asset in memory, of whatever representation.
class Asset {
 public:
  virtual ~Asset() = default;

  /// Adds what `info` tells of this representation.
  virtual void describe(nlohmann::ordered_json& info) const = 0;
  /// Adds what `compare` tells of this asset and another of the same representation, and to the array
  /// result["differences"] the name of every part that differs.
  virtual void compare(const Asset& other, nlohmann::ordered_json& result) const = 0;
  /// Errors: kUsage (the representation has no such method).
  [[nodiscard]] virtual Result<std::unique_ptr<Caster>> make_caster(std::string_view method) const = 0;
  /// How far its surface and that of a mesh are from each other. Errors: those of
  /// measure_surface_distance().
  [[nodiscard]] virtual Result<SurfaceDistance> surface_distance(const TriangleMesh& mesh,
                                                                 const SurfaceDistanceOptions& options,
                                                                 const Progress& progress) const = 0;
  /// Metres³ of what is inside.
  [[nodiscard]] virtual double volume() const = 0;
};

/// A .meso file that was read whole.
struct AssetFile {
  std::unique_ptr<Asset> asset;
  std::string format;          ///< "meso 0.9"
  std::string representation;  ///< "cell-object"
  std::vector<ChunkInfo> chunks;
  std::uint64_t file_bytes = 0;
};

/// Reads an asset from a file's bytes, which need not live on. Untrusted input: safe.
/// Errors: kInvalidInput with the id, kLimit.
[[nodiscard]] Result<AssetFile> read_asset(std::span<const std::byte> bytes, const ReadLimits& limits = {});

/// The same from a file. Errors also: kUnreadable.
[[nodiscard]] Result<AssetFile> read_asset_file(const std::string& path, const ReadLimits& limits = {});

/// All that `info --json` tells.
[[nodiscard]] nlohmann::ordered_json describe_asset(const AssetFile& file);

/// JSON as the command prints it, with a line end; text that is not UTF-8 is replaced.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json);

}  // namespace mesocell
