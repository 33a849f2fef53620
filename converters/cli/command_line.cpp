#include "converters/cli/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "converters/cli/bench.h"
#include "converters/cli/cell_object_asset.h"
#include "converters/cli/color_source.h"
#include "converters/cli/commands.h"
#include "converters/cli/common_options.h"
#include "converters/cli/convert_options.h"
#include "converters/cli/exit_codes.h"
#include "converters/cli/export.h"
#include "converters/cli/height_source.h"
#include "converters/cli/stability.h"
#include "converters/import/mesh_file.h"
#include "converters/import/volume_file.h"
#include "format/container_scan.h"
#include "sdk/core/shapes.h"

namespace mesocell {
namespace {

void add_info(CLI::App& app, InfoCommand& command) {
  CLI::App* sub = app.add_subcommand("info", "Tell what is in a .meso file, or what is amiss with a mesh");
  sub->add_option("input", command.input,
                  std::string("File to read: .meso, of which FILE.meso#ASSET is one asset; or a mesh: ") +
                      kMeshExtensions)
      ->required()
      ->type_name("FILE");
  sub->add_option(
         "--tile", command.tile,
         "Tell the tags of the cells of one tile instead, reading only the parts of a .meso file that say so")
      ->type_name("I,J,K");
  add_common(*sub, command.common);
  sub->footer(
      "Keys of --json for a mesh: format, file_bytes, polygons, dropped_faces (with a repeated vertex), "
      "vertices, "
      "vertex_colors, box {min, max}, volume (metres³, null if it is not closed), diagnosis {depth, closed, "
      "triangles, "
      "components, closed_components, cavities, findings [{id, count, at_least, example, text}]}; convert "
      "has the "
      "same diagnosis. Of a volume: format, file_bytes, grids [{name, type, usable, class, active_voxels, "
      "transform (3 rows of 4), voxels {min, max}, box {min, max}}].\n\nOf a .meso file with several assets the keys are those of the first one; assets "
      "[{name, …}] has "
      "all of them. With --tile the keys are tile, tags [one a cell], bytes_read, file_bytes.\n\n"
      "Example:\n  mesocell info bunny.meso --json\n  mesocell info library.meso#bunny\n"
      "  mesocell info bunny.meso --tile 32,20,32\n  mesocell info bunny.obj\n");
}

void add_validate(CLI::App& app, ValidateCommand& command) {
  CLI::App* sub = app.add_subcommand("validate", "List every fault of a .meso file");
  sub->add_option("input", command.input, "File to check: .meso")->required()->type_name("FILE");
  sub->add_flag("--strict", command.strict, "Let a warning count as a fault");
  sub->add_option("--max-issues", command.max_issues, "Most issues to list, 1 to 1000000 [256]")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000000}).description(""));
  add_common(*sub, command.common);
  sub->footer(
      "Exit code 0 if the file is valid, 1 if it is not, 3 if it is no .meso file at all.\n"
      "Every issue has an id, which spec/issues.md explains; --json follows "
      "spec/validation-report.schema.json.\n\n"
      "Example:\n  mesocell validate bunny.meso\n");
}

void add_render(CLI::App& app, RenderCommand& command) {
  CLI::App* sub = app.add_subcommand("render", "Make a picture of a .meso file");
  sub->add_option("input", command.input, "File to read: .meso")->required()->type_name("FILE");
  sub->add_option(
         "output", command.output,
         "Picture to write: .png; or .exr, with all layers: R, G, B as in a .png but linear, depth.Z, "
         "normal.X/Y/Z, color.R/G/B and cell.id")
      ->required()
      ->type_name("PICTURE");
  sub->add_option("--mode", command.mode, "first-hit (shaded), depth, cell, normal or color [first-hit]")
      ->type_name("MODE");
  sub->add_option("--method", command.method,
                  "exact, distance, linear:S with the step S in tile edges, or linear:S:angle [exact]")
      ->type_name("METHOD");
  sub->add_option("--size", command.size, "Size in pixels, each from 1 to 16384 [1024x768]")
      ->type_name("WxH");
  sub->add_option("--eye", command.eye, "Where the camera is; framed automatically if not given")
      ->type_name("X,Y,Z");
  sub->add_option("--look", command.look, "The point it looks at")->type_name("X,Y,Z");
  sub->add_option("--up", command.up, "The direction that is up [0,1,0]")->type_name("X,Y,Z");
  sub->add_option("--fov", command.fov, "Vertical angle of view [35]")->type_name("DEGREES");
  sub->add_option("--depth", command.depth,
                  "Also write the distance along each ray, channel Z, a miss is infinite")
      ->type_name("FILE.exr");
  const auto whole = [&](const char* name, std::optional<std::uint32_t>& value, std::uint32_t low,
                         std::uint32_t high, const char* help) {
    sub->add_option(name, value, help)->type_name("N")->check(CLI::Range(low, high).description(""));
  };
  sub->add_option("--clip", command.clip, "Cut the object: keep the points x with n·x at most D")
      ->type_name("NX,NY,NZ,D");
  whole("--samples", command.samples, 1, 4096, "Rays a pixel [1]");
  whole("--bounces", command.bounces, 0, 1000, "Mirror reflections to follow; 0 is a matt object [0]");
  sub->add_option("--reflectivity", command.reflectivity,
                  "Share of the light that a mirror reflects, 0 to 1; the rest is matt [1]")
      ->type_name("R");
  sub->add_option("--ior", command.ior, "Make the object clear, with this index of refraction, 1 to 10")
      ->type_name("X");
  whole("--events", command.events, 0, 1000, "Refractions to follow in a clear object [6]");
  sub->add_option("--light", command.light, "Direction towards a light that casts hard shadows")
      ->type_name("X,Y,Z");
  whole("--ao", command.ao, 0, 4096, "Rays of ambient occlusion at every hit [0]");
  sub->add_option(
         "--env", command.env,
         "What surrounds the object, a latitude-longitude picture: .hdr, .exr or .png, the middle of "
         "it is seen along -z; or sky, a sun over a checkered ground")
      ->type_name("PICTURE");
  add_no_clobber(*sub, command.no_clobber);
  add_common(*sub, command.common);
  sub->footer(
      "Light, mirrors and glass are for mode first-hit; an option without effect warns.\n\n"
      "Example:\n  mesocell render bunny.meso bunny.png --mode first-hit --size 1024x768 --eye "
      "0.2,0.2,0.3\n  mesocell render bunny.meso glass.png --ior 1.5 --env sky --samples 4\n");
}

void add_compare(CLI::App& app, CompareCommand& command) {
  CLI::App* sub = app.add_subcommand("compare", "Compare pictures, .meso files, or a .meso file with a mesh");
  sub->add_option("a", command.a, "Picture (.png, .exr, .hdr) or .meso file")->required()->type_name("A");
  sub->add_option("b", command.b, "Another of the same kind; or, for a .meso file, the mesh it should equal")
      ->required()
      ->type_name("B");
  sub->add_option("--tolerance", command.tolerance,
                  "Greatest difference that is still equal: for pictures of a channel, 0 to 1 [0]; for an "
                  "asset and a mesh the greater RMS distance in per cent of the mesh's diagonal [any]")
      ->type_name("X");
  sub->add_option("--samples", command.samples,
                  "Samples in each direction, for an asset and a mesh, 1 to 1000000000 [100000]")
      ->type_name("N")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1000000000}).description(""));
  // The parser would take -1 for the greatest number.
  sub->add_option("--seed", command.seed, "Seed of the samples [1]")
      ->type_name("N")
      ->check(CLI::Validator(CLI::NonNegativeNumber).description(""));
  add_common(*sub, command.common);
  sub->footer(
      "Exit code 0 if they are equal, within the tolerance if there is one, else 1.\n"
      "Pictures: values as they are in the file, 1 is white; where only one of the two is in sRGB, both are "
      "taken in linear light. Infinite values equal each other, and what is not a number equals its like.\n\n"
      "An asset and a mesh: how far samples of what can be seen of the asset, the first hits of uniformly "
      "random lines, are from the mesh's surface, and samples of the mesh's surface, uniform by area, from "
      "what is inside the asset. Without --tolerance they count as equal.\n\n"
      "Keys of --json: kind (picture, asset or asset-and-mesh), equal, differences [parts that differ], and\n"
      "  of pictures: width, height, channels, tolerance, max, mean, rmse, psnr (dB, of a peak of 1); null "
      "where a figure is infinite or there is none; the parts are size, channels, values\n"
      "  of cell objects: " +
      std::string(cell_object_comparison_help()) +
      "\n  of an asset and a mesh: tolerance (per cent, null if not given), surface_distance {asset_to_mesh, "
      "mesh_to_asset {max, mean, rms (metres), max_percent, mean_percent, rms_percent, samples (taken)}, "
      "samples (asked for), seed, diagonal (metres)}, volume {asset, mesh (metres³), percent (of the "
      "mesh's)}; "
      "null for the volume of a mesh that is not closed; the part is surface"
      "\n\nExample:\n  mesocell compare a.png b.png --tolerance 0.01\n"
      "  mesocell compare bunny.meso bunny.off --tolerance 0.5 --json\n");
}

void add_stability(CLI::App& app, StabilityCommand& command) {
  CLI::App* sub = app.add_subcommand(
      "stability", "Compare methods on cases that are hard for them, by their errors and cost");
  sub->add_flag("--voxelize", command.voxelize, "Test inside/outside voxelization, on damaged meshes");
  sub->add_flag("--cast", command.cast,
                "Test methods of tracing, on thin cells, gaps, grazing, far and aligned rays, and light");
  sub->add_option("--rays", command.rays, "Rays a case of --cast, 16 to 100000 [4096]")
      ->type_name("N")
      ->check(CLI::Range(16u, 100000u).description(""));
  sub->add_flag("--benchmark", command.benchmark,
                "Measure time, peak memory and wrong voxels at several sizes instead of the catalogue");
  sub->add_option("--resolution", command.resolution, "Voxels along the longest side, 16 to 512 [32]")
      ->type_name("N")
      ->check(CLI::Range(16u, 512u).description(""));
  sub->add_option("--sizes", command.sizes,
                  "Voxels along the longest side for --benchmark, each 16 to 2048 [256,512,1024]")
      ->type_name("N,...");
  sub->add_option("--repeat", command.repeat, "Runs of --benchmark, the median is told, 1 to 99 [1]")
      ->type_name("N")
      ->check(CLI::Range(1u, 99u).description(""));
  sub->add_option("--mesh", command.meshes,
                  std::string("A closed mesh to damage, instead of generated ones: ") + kMeshExtensions +
                      "; may be repeated")
      ->type_name("MESH")
      ->expected(1)
      ->take_all();
  sub->add_option("--pair", command.pairs,
                  "A broken mesh and its sound twin in the same place; may be repeated")
      ->type_name("BROKEN SOUND")
      ->expected(2)
      ->take_all();
  sub->add_option("--methods", command.methods, stability_methods_help())->type_name("NAME,...");
  sub->add_option("--cases", command.cases, "Cases whose name or group begins with one of these words [all]")
      ->type_name("WORD,...");
  sub->add_option("--max-seconds", command.max_seconds,
                  "Processor time; what takes more is stopped and told as too long [5; 600 for --benchmark]")
      ->type_name("S")
      ->check(CLI::Range(0.01, 86400.0).description(""));
  sub->add_option("--csv", command.csv, "Write all figures here")->type_name("FILE.csv");
  sub->add_option("--markdown", command.markdown, "Write tables here")->type_name("FILE.md");
  sub->add_option("--picture", command.picture, "Write a heat map here")->type_name("FILE.svg");
  add_no_clobber(*sub, command.no_clobber);
  add_common(*sub, command.common);
  sub->footer(stability_help());
}

void add_chart(CLI::App& app, ChartCommand& command) {
  CLI::App* sub =
      app.add_subcommand("chart", "Draw the figures of a benchmark: speed and memory against error");
  sub->add_option("input", command.input, "Figures to read, the CSV of a benchmark")
      ->required()
      ->type_name("IN.csv");
  sub->add_option("output", command.output, "Picture to write: .svg or .png")
      ->required()
      ->type_name("PICTURE");
  sub->add_option("--chart", command.chart,
                  "pareto (rays a second against error), memory (against error), steps (against the angle "
                  "between rays and surface) or all in one picture [all]")
      ->type_name("CHART");
  sub->add_option("--error", command.error,
                  "wrong, the share of rays that miss what they should hit, hit what is not there or hit "
                  "another cell (another voxel, where cells are not told); or depth, the greatest error in "
                  "depth in voxels [wrong]")
      ->type_name("ERROR");
  sub->add_option("--scene", command.scene, "Rows of this scene alone [all]")->type_name("NAME");
  sub->add_option("--camera", command.camera, "Rows of this camera alone [all]")->type_name("NAME");
  sub->add_option("--rays", command.rays, "Rows of this kind of rays alone [primary, if there are any]")
      ->type_name("NAME");
  sub->add_option("--threads", command.threads, "Rows of this number of threads alone [the greatest]")
      ->type_name("N")
      ->check(CLI::Range(1u, 1000000u).description(""));
  add_no_clobber(*sub, command.no_clobber);
  sub->add_flag("--json", command.json,
                "Print what is drawn as JSON; a failure is printed as {\"error\": {...}}");
  sub->add_flag("--quiet", command.quiet, "Print no warnings");
  sub->footer(
      "A method is a point: the median over scenes and cameras, with thin lines for their range. What makes "
      "no "
      "error stands at the left edge. Columns that are needed: scene, camera, rays, method, threads, "
      "rays_per_second, peak_bytes, miss_rate, depth_error_max; used where they are there: hit_rate, "
      "false_hit_rate, wrong_cell_rate, wrong_voxel_rate, steps_per_ray, angle_degrees. It is drawn by "
      "gnuplot, "
      "which must be installed (package gnuplot-nox).\n\n"
      "Keys of --json: output, subject, methods [method, rows, rays_per_second, peak_bytes, error {median, "
      "min, "
      "max}, steps [angle_degrees, steps_per_ray]]\n\n"
      "Example:\n  mesocell chart quick.csv chart.svg\n"
      "  mesocell chart quick.csv close.png --chart pareto --camera close --threads 1\n");
}

void add_bench(CLI::App& app, BenchCommand& command) {
  CLI::App* sub = app.add_subcommand("bench", "Measure speed, memory and errors of methods of tracing");
  sub->add_option("--set", command.set, "What to measure: quick, default or full [default]")
      ->type_name("SET");
  const auto words = [&](const char* name, std::optional<std::string>& value, const char* help) {
    sub->add_option(name, value, help)->type_name("NAME,...");
  };
  words("--scenes", command.scenes, "Scenes to measure, such as wavy-voronoi-64x32");
  words("--cameras", command.cameras, "Where they are seen from: full, cover90, close, grazing, inside");
  words("--rays", command.rays, "Kinds of rays: primary, diffuse, reflection, shadow");
  words("--methods", command.methods, "Methods, such as exact,linear:1/512,embree-instanced");
  sub->add_option("--input", command.input, "A .meso file to measure on, instead of scenes")
      ->type_name("FILE");
  sub->add_option("--threads", command.threads, "Numbers of threads, each is measured, 0 for all [0]")
      ->type_name("N,...");
  sub->add_option("--size", command.size, "Size in pixels, each from 1 to 16384 [1024x768]")
      ->type_name("WxH");
  sub->add_option("--repeat", command.repeat, "Passes that are timed, the median is told, 1 to 99 [3]")
      ->type_name("N")
      ->check(CLI::Range(1u, 99u).description(""));
  sub->add_option("--seed", command.seed, "Seed of rays that are drawn at random [1]")
      ->type_name("N")
      ->check(CLI::Validator(CLI::NonNegativeNumber).description(""));
  sub->add_option("--oracle", command.oracle,
                  "Rays of each case whose exact hit is checked by brute force, 1 to 1000000 [1024]")
      ->type_name("N")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1000000}).description(""));
  sub->add_option("--max-seconds", command.max_seconds,
                  "Begin nothing more after this time, and tell what was left out [40 for quick, 400 for "
                  "default]")
      ->type_name("S")
      ->check(CLI::Range(0.01, 1e6).description(""));
  sub->add_option("--csv", command.csv, "Write all figures here")->type_name("FILE.csv");
  add_no_clobber(*sub, command.no_clobber);
  add_reporting(*sub, command.common);
  sub->footer(bench_help());
}

/// The words of the command line, last first, as the parser takes them. A vector whose first number is
/// negative and begins with a point ("-.5,0,1") looks like an option to the parser, so it is joined to its
/// option.
std::vector<std::string> parser_words(int argc, char** argv) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool number =
        word.size() > 2 && word[0] == '-' && word[1] == '.' && word[2] >= '0' && word[2] <= '9';
    if (number && !words.empty() && words.back().starts_with("--") &&
        words.back().find('=') == std::string::npos)
      words.back() += "=" + word;
    else
      words.push_back(word);
  }
  std::reverse(words.begin(), words.end());
  return words;
}

bool wants_json(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (std::strcmp(argv[i], "--json") == 0) return true;
  return false;
}

/// The parser's complaint as one message with a remedy; its own exit codes are not ours.
int usage_error(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  std::string message = error.what();
  for (char& c : message)
    if (c == '\n') c = ' ';
  while (!message.empty() && (message.back() == ' ' || message.back() == '.')) message.pop_back();
  std::string help = "mesocell";
  for (const CLI::App* sub : app.get_subcommands()) help += " " + sub->get_name();
  // The parser calls an unknown subcommand a missing one.
  if (app.get_subcommands().empty() && argc > 1 && argv[1][0] != '-')
    message = "there is no subcommand '" + std::string(argv[1]) + "'";
  CommonOptions options;
  options.json = wants_json(argc, argv);
  return Console(options).fail(Error{ErrorCode::kUsage, message + "; see " + help + " --help"}, "");
}

}  // namespace

int run_command_line(int argc, char** argv) {
  CLI::App app("Turn meshes, volumes and heights into small, ray-traceable .meso files, and look at them.", "mesocell");
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("mesocell ") + MESOCELL_VERSION + ", format meso " +
                                        std::to_string(kFormatMajor) + "." + std::to_string(kFormatMinor));
  app.footer(std::string(exit_codes_help()) +
             "\nMessages go to stderr and results to stdout. mesocell <subcommand> --help tells more.\n\n"
             "Example:\n  mesocell convert bunny.off bunny.meso && mesocell render bunny.meso bunny.png\n");
  ConvertCommand convert;
  InfoCommand info;
  ValidateCommand validate;
  RenderCommand render;
  CompareCommand compare;
  StabilityCommand stability;
  ChartCommand chart;
  BenchCommand bench;
  add_convert(app, convert);
  add_info(app, info);
  add_validate(app, validate);
  add_render(app, render);
  add_compare(app, compare);
  add_stability(app, stability);
  add_chart(app, chart);
  add_bench(app, bench);
  try {
    app.parse(parser_words(argc, argv));
  } catch (const CLI::Success& wish) {
    return app.exit(wish);  // prints help or version
  } catch (const CLI::ParseError& error) {
    return usage_error(app, error, argc, argv);
  }
  if (app.got_subcommand("convert")) {
    if (!complete_convert(app, convert)) return usage_error(app, CLI::RequiredError("output"), argc, argv);
    return run_convert(convert);
  }
  if (app.got_subcommand("info")) return run_info(info);
  if (app.got_subcommand("validate")) return run_validate(validate);
  if (app.got_subcommand("compare")) return run_compare(compare);
  if (app.got_subcommand("stability")) return run_stability(stability);
  if (app.got_subcommand("chart")) return run_chart(chart);
  if (app.got_subcommand("bench")) return run_bench_command(bench);
  return run_render(render);
}

}  // namespace mesocell
