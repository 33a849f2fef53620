#pragma once

#include <cstddef>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "converters/cli/console.h"
#include "format/cell_object.h"
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

/// An asset of a file.
struct NamedAsset {
  std::unique_ptr<Asset> asset;
  std::string name;            ///< as the file has it, may be empty
  std::string representation;  ///< "cell-object"
  std::vector<ChunkInfo> chunks;
};

/// A .meso file, or one asset of it, that was read whole.
struct AssetFile {
  std::vector<NamedAsset> assets;  ///< at least one
  std::string format;              ///< "meso 1.0"
  std::uint64_t file_bytes = 0;

  [[nodiscard]] const Asset& first() const { return *assets.front().asset; }
};

/// A .meso file's name on the command line: FILE.meso, or FILE.meso#ASSET for the asset of that name, or of
/// that number from 0. A file that is there under the whole name goes before.
struct AssetPath {
  std::string file;
  std::optional<std::string> asset;
};
[[nodiscard]] AssetPath parse_asset_path(const std::string& text);
/// Whether it names a .meso file or an asset of one.
[[nodiscard]] bool is_asset_path(const std::string& text);

/// Index of the asset that is asked for, 0 if none is. Errors: kUsage.
[[nodiscard]] Result<std::size_t> find_asset(std::span<const AssetInfo> assets,
                                             const std::optional<std::string>& asset);

/// Reads the cell object that `text` names, a file or FILE#ASSET. Untrusted input: safe.
[[nodiscard]] std::optional<Failure> read_named_object(const std::string& text, CellObject& object);

/// Reads assets from a file's bytes, which need not live on: the one that is asked for, else all. Untrusted
/// input: safe. Errors: kInvalidInput with the id, kLimit, kUsage (no such asset).
[[nodiscard]] Result<AssetFile> read_assets(std::span<const std::byte> bytes,
                                            const std::optional<std::string>& asset = std::nullopt,
                                            const ReadLimits& limits = {});

/// The asset that a path names: the first of several unless it names one. Errors also: kUnreadable.
[[nodiscard]] Result<AssetFile> read_asset_file(const std::string& path, const ReadLimits& limits = {});
/// All assets of the file, or the one that the path names.
[[nodiscard]] Result<AssetFile> read_whole_asset_file(const std::string& path, const ReadLimits& limits = {});

/// All that `info --json` tells: of the first asset in keys of their own, of all in "assets".
[[nodiscard]] nlohmann::ordered_json describe_assets(const AssetFile& file);

/// JSON as the command prints it, with a line end; text that is not UTF-8 is replaced.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json);

}  // namespace mesocell
