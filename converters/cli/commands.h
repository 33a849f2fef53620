#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "converters/cli/console.h"

/// The subcommands. Each takes the words of its command line and returns the exit code; options whose text
/// has a syntax of its own are parsed by the subcommand.
namespace mesocell {

struct ConvertCommand {
  CommonOptions common;
  std::vector<std::string> inputs;  ///< at least one
  std::string input, output;        ///< input: the first one
  std::optional<std::string> codec, target_version;
  std::vector<std::string> meta;  ///< each KEY=VALUE
  std::optional<std::int64_t> tiles;
  std::optional<double> tile_size;
  std::string box;
  std::optional<std::string> tile, rule, percolating, repair, solid, heights;
  std::optional<double> stitch, thicken, wrap_alpha, wrap_offset;  ///< metres
  std::optional<std::string> color, grid;  ///< grid: of a volume
  std::optional<double> iso;
  bool normals = false, keep_mesh = false;
  // Of assets to other formats.
  std::optional<std::string> as, region, side, size;
  std::optional<std::uint64_t> max_faces;
  bool draco = false, drop_buried = false;
  // Of batches.
  std::optional<std::string> to;
  std::optional<unsigned> jobs;
  bool keep_going = false, force = false;
  std::vector<std::string> file_options;  ///< words of the options that each file is converted with
  bool no_clobber = false;
};
[[nodiscard]] int run_convert(const ConvertCommand& command);

struct InfoCommand {
  CommonOptions common;
  std::string input, tile;
};
[[nodiscard]] int run_info(const InfoCommand& command);

struct ValidateCommand {
  CommonOptions common;
  std::string input;
  bool strict = false;
  std::size_t max_issues = 256;
};
[[nodiscard]] int run_validate(const ValidateCommand& command);

struct RenderCommand {
  CommonOptions common;
  std::string input, output, depth;
  std::string mode = "first-hit", method = "exact", size = "1024x768";
  std::string eye, look, up;
  std::optional<double> fov;
  std::optional<std::uint32_t> bounces, events, ao, samples;
  std::optional<double> reflectivity, ior;
  std::string light, clip, env;
  bool no_clobber = false;
};
[[nodiscard]] int run_render(const RenderCommand& command);

struct CompareCommand {
  CommonOptions common;
  std::string a, b;
  std::optional<double> tolerance;
  std::optional<std::uint64_t> samples, seed;
};
[[nodiscard]] int run_compare(const CompareCommand& command);

/// Whether two paths name the same file, also by different names or through links.
[[nodiscard]] bool same_file(const std::string& a, const std::string& b);

/// Whether `path` ends in `extension` (with its dot), any case.
[[nodiscard]] bool has_extension(const std::string& path, std::string_view extension);

/// Whether a file could be written there, tried before long work is begun; nothing is left behind. Errors:
/// kOutput.
[[nodiscard]] Status check_output(const std::string& path, bool no_clobber);

/// The bytes of an input, as read_file() gives them, with a remedy in the message of every failure.
[[nodiscard]] Result<std::vector<std::byte>> read_input(const std::string& path, std::uint64_t max_bytes);

struct StabilityCommand {
  CommonOptions common;
  bool voxelize = false, cast = false;
  bool benchmark = false;
  std::optional<std::uint32_t> resolution;
  std::vector<std::string> meshes;
  std::vector<std::string> pairs;  ///< broken and sound in turn
  std::string methods, cases;
  std::optional<std::string> sizes;
  std::string csv, markdown, picture;
  std::optional<double> max_seconds;
  std::uint32_t repeat = 1;
  std::optional<std::uint32_t> rays;  ///< a case of --cast
  bool no_clobber = false;
};
[[nodiscard]] int run_stability(const StabilityCommand& command);

struct ChartCommand {
  bool json = false, quiet = false;
  std::string input, output;
  std::string chart = "all", error = "wrong";
  std::string scene, camera, rays;  ///< as of ChartRows
  std::optional<unsigned> threads;  ///< which rows, not how many to use
  bool no_clobber = false;
};
[[nodiscard]] int run_chart(const ChartCommand& command);

struct BenchCommand {
  CommonOptions common;  ///< but for its threads
  std::optional<std::string> set, scenes, cameras, rays, methods, threads, input;
  std::string size = "1024x768", csv;
  std::uint32_t repeat = 3;
  std::uint64_t seed = 1;
  std::uint64_t oracle = 1024;  ///< rays of each case that brute force checks
  std::optional<double> max_seconds;
  bool no_clobber = false;
};
[[nodiscard]] int run_bench_command(const BenchCommand& command);

}  // namespace mesocell
