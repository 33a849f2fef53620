#include "converters/cli/convert_options.h"

#include <CLI/CLI.hpp>
#include <array>
#include <string>

#include "converters/cli/cell_object_asset.h"
#include "converters/cli/color_source.h"
#include "converters/cli/common_options.h"
#include "converters/cli/convert_plan.h"
#include "converters/cli/export.h"
#include "converters/cli/height_source.h"
#include "converters/cli/tile_source.h"
#include "converters/cli/volume_source.h"
#include "converters/import/mesh_file.h"
#include "converters/import/volume_file.h"
#include "sdk/core/shapes.h"

namespace mesocell {

void add_convert(CLI::App& app, ConvertCommand& command) {
  CLI::App* sub = app.add_subcommand(
      "convert", "Make assets of meshes, volumes, heights, shapes and tiles, and other formats of assets");
  // The parser gives all words to the first option that takes several, so the output is the last of them.
  sub->add_option(
         "input... output", command.inputs,
         std::string("Input: a mesh, ") + kMeshExtensions +
             "; a volume; a picture, as heights; shape:NAME; or tile:RECIPE, to keep and show a tile with "
             "each of its cells once; or .meso files, whose "
             "assets are put into one file, FILE.meso#ASSET for one of them. Output: .meso; of an "
             "asset also other formats, see below")
      ->required()
      ->option_text("FILES");
  CLI::Option* tiles =
      sub->add_option("--tiles", command.tiles, "Tiles along the longest side of the grid, from 1 [16]")
          ->type_name("N");
  sub->add_option("--tile-size", command.tile_size, "Edge of a tile in metres, above 0, instead of --tiles")
      ->type_name("METRES")
      ->excludes(tiles);
  sub->add_option("--box", command.box, "Box to cover, instead of the mesh's")
      ->type_name("X0,Y0,Z0,X1,Y1,Z1");
  sub->add_option("--tile", command.tile,
                  std::string("Recipe of the tile, or a .meso file to take it from [") + kDefaultTile + "]")
      ->type_name("RECIPE");
  sub->add_option("--heights", command.heights, "How a picture is read as heights, see below")
      ->type_name("KEY=VALUE,...");
  sub->add_option("--grid", command.grid, "Which grid of a volume to take, see below")->type_name("NAME");
  sub->add_option("--iso", command.iso, "The value at a volume's surface, see below")->type_name("X");
  sub->add_option("--percolating", command.percolating,
                  "Imported cells that meet their own copy through the tile's border: cut or refuse [cut]")
      ->type_name("CHOICE");
  sub->add_option("--rule", command.rule, "Rule of membership: " + rule_names() + " [centre]")
      ->type_name("RULE");
  sub->add_option(
         "--repair", command.repair,
         "How far a mesh that is not closed is repaired: strict, orient, winding, wrap or auto [auto]")
      ->type_name("CHOICE");
  sub->add_option("--solid", command.solid,
                  "What is solid of shells in and over one another: nonzero, even-odd or outer [nonzero]")
      ->type_name("CHOICE");
  const auto metres = [&](const char* name, std::optional<double>& value, const char* help) {
    sub->add_option(name, value, help)->type_name("METRES");
  };
  metres("--stitch", command.stitch,
         "How wide cracks may be that are stitched [1e-5 of the diagonal of the mesh's box]");
  metres("--thicken", command.thicken,
         "Give what is open a thickness: what is within half of it of the surface is inside");
  metres("--wrap-alpha", command.wrap_alpha,
         "Radius of the ball that a wrap lets in nowhere [a twentieth of the diagonal]");
  metres("--wrap-offset", command.wrap_offset, "How far off the surface a wrap is [a thirtieth of alpha]");
  sub->add_option("--color", command.color, "Recipe of the color; white if not given")->type_name("RECIPE");
  sub->add_flag("--normals", command.normals,
                "Store smooth normals at the borders of the cells; of an export, write normals");
  sub->add_flag("--keep-mesh", command.keep_mesh,
                "Keep the mesh in the asset, compressed by Draco; positions are rounded, and the file says "
                "by how much");
  sub->add_option("--meta", command.meta, "Free text to keep in the file; may be repeated")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
  sub->add_option(
         "--codec", command.codec,
         "zstd, which makes files small, or raw, so that maps can be used in place from a memory map [zstd]")
      ->type_name("CODEC");
  sub->add_option("--target-version", command.target_version,
                  "The newest version of the format to write: 1.0 or 1.1 [1.1]; files state the least that "
                  "has all they hold")
      ->type_name("VERSION");
  sub->add_option("--as", command.as,
                  "What an asset becomes where its output's extension leaves a choice, see below")
      ->type_name("KIND");
  sub->add_option("--region", command.region,
                  "Of a surface: its tiles, from the first up to one beyond the last [all]")
      ->type_name("I0,J0,K0,I1,J1,K1");
  sub->add_option("--max-faces", command.max_faces,
                  "Of a surface: more faces of voxels are refused [20000000]")
      ->type_name("N");
  sub->add_flag("--draco", command.draco, "Compress the meshes of a .glb");
  sub->add_flag("--drop-buried", command.drop_buried,
                "Of instances: leave out those that nothing can be seen of");
  sub->add_option("--side", command.side, "Of a map of heights: -x, +x, -y, +y, -z or +z [+y]")
      ->type_name("SIDE");
  sub->add_option("--size", command.size, "Of a map of heights: its pixels [one a voxel]")->type_name("WxH");
  sub->add_option("--to", command.to, "What each file of a batch becomes: an extension [.meso]")
      ->type_name("EXTENSION");
  sub->add_option("--jobs", command.jobs,
                  "Files of a batch at once, from 1 [as many as there are processors]")
      ->type_name("N")
      ->check(CLI::Range(1u, 256u).description(""));
  sub->add_flag("--keep-going", command.keep_going, "Let a batch go on after a file that fails");
  sub->add_flag("--force", command.force, "Let a batch make what is up to date, too");
  add_no_clobber(*sub, command.no_clobber);
  add_common(*sub, command.common);
  sub->footer(
      "Rules: by centre a cell is inside if all its voxels' centres are; by conservative the surface "
      "must not even touch one of its voxels.\n\n"
      "Solid: by nonzero overlaps are united, and a shell in a shell is a cavity if it runs the other way; "
      "by "
      "even-odd it is one whatever way it runs, and overlaps are hollow; by outer every shell is filled.\n\n"
      "Repair: strict refuses a mesh that is not closed; orient stitches cracks, turns triangles and drops "
      "duplicates, and refuses what that does not close; winding decides by the generalized winding number "
      "what is "
      "inside of what stays open; wrap replaces what stays open by its alpha wrap; auto takes the first of "
      "these that "
      "suffices. `mesocell info MESH` tells what is amiss with a mesh.\n\nRecipes of tiles:\n" +
      tile_sources_help() + "\nRecipes of colors:\n" + color_sources_help() + "\nVolumes: " + kVolumeAxes +
      "\n\nVolumes as shapes: " + volumes_help() + "\nHeights: " + heights_help() + "\nShapes:\n" +
      shapes_help() + "\nWhat an asset can become:\n" + exports_help() +
      "\nBatch: several inputs, or @LIST, a file with one on each line, and a folder as the output, FOLDER/. "
      "Each "
      "becomes a file of its own name there, made by a process of its own. What is up to date is left: made "
      "of the "
      "same file and those read with it (materials, pictures, slices, tiles), by their sizes and times, with "
      "the same options. The folder's .mesocell-batch.json knows.\n"
      "\nExample:\n  mesocell convert bunny.off bunny.meso --tiles 64 "
      "--tile voronoi:cells=8,resolution=128,seed=1 --color marble --normals\n"
      "  mesocell convert tile:mesh:file=stones.obj,size=2 stones.meso --color stone\n"
      "  mesocell convert wall.ply wall.meso --tile stones.meso\n"
      "  mesocell convert bunny.meso bunny.glb\n"
      "  mesocell convert scans/*.ply @more.txt assets/ --tiles 32 --keep-going\n"
      "  mesocell convert wall.meso bunny.meso library.meso && mesocell render library.meso#bunny "
      "bunny.png\n");
}

bool complete_convert(const CLI::App& app, ConvertCommand& command) {
  if (command.inputs.size() < 2) return false;
  command.output = command.inputs.back();
  command.inputs.pop_back();
  command.input = command.inputs.front();
  // Of the batch itself, not of its files.
  constexpr std::array<std::string_view, 8> kOwn = {"--to",   "--jobs",  "--keep-going", "--force",
                                                    "--json", "--quiet", "--threads",    "--no-clobber"};
  for (const CLI::Option* option : app.get_subcommand("convert")->get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || !name.starts_with("--") ||
        std::find(kOwn.begin(), kOwn.end(), name) != kOwn.end())
      continue;
    if (option->get_expected_max() == 0) {
      command.file_options.push_back(name);
      continue;
    }
    for (const std::string& value : option->results()) command.file_options.push_back(name + "=" + value);
  }
  return true;
}

}  // namespace mesocell
