#include "converters/cli/cell_object_exports.h"

#include <array>
#include <nlohmann/json.hpp>

#include "converters/cli/values.h"
#include "converters/export/gpu_textures.h"
#include "converters/export/height_map.h"
#include "converters/export/image_stack.h"

namespace mesocell {
namespace {

void add_losses(const std::vector<std::string>& from, const ExportJob& job) {
  job.losses.insert(job.losses.end(), from.begin(), from.end());
}

Status export_stack(const ExportJob& job, StackMap map) {
  StackExportReport report;
  const Status status =
      write_image_stack(job.object, map, job.command.output, job.command.no_clobber, &report, &job.progress);
  job.report["slices"] = report.slices;
  job.report["bytes"] = report.bytes;
  add_losses(report.losses, job);
  return status;
}
Status export_cells(const ExportJob& job) { return export_stack(job, StackMap::kCells); }
Status export_colors(const ExportJob& job) { return export_stack(job, StackMap::kColors); }
Status export_normals(const ExportJob& job) { return export_stack(job, StackMap::kNormals); }

Status export_heights(const ExportJob& job) {
  HeightMapOptions options{.no_clobber = job.command.no_clobber, .threads = job.command.common.threads};
  constexpr std::array<std::string_view, 6> kSides = {"-x", "+x", "-y", "+y", "-z", "+z"};
  const std::string side = job.command.side.value_or("+y");
  const auto found = std::find(kSides.begin(), kSides.end(), side);
  if (found == kSides.end())
    return Error{ErrorCode::kUsage, "--side: unknown side '" + side + "'; there are: -x, +x, -y, +y, -z, +z"};
  options.axis = int((found - kSides.begin()) / 2);
  options.from_low = (found - kSides.begin()) % 2 == 0;
  if (job.command.size) {
    const auto size = parse_size(*job.command.size);
    if (!size) return Error{ErrorCode::kUsage, "--size: " + size.error().message};
    options.size = *size;
  }
  HeightMapReport report;
  const Status status = write_height_map(job.object, job.command.output, options, &report, &job.progress);
  job.report["size"] = {report.width, report.height};
  job.report["missing"] = report.missing;
  job.report["heights"] = report.heights;
  job.report["bytes"] = report.bytes;
  add_losses(report.losses, job);
  return status;
}

Status export_gpu(const ExportJob& job) {
  std::uint64_t bytes = 0;
  const Status status = write_gpu_textures(job.object, job.command.output, job.command.no_clobber, &bytes);
  job.report["bytes"] = bytes;
  add_losses({"colors of cells and instances, normals, metadata"}, job);
  return status;
}

constexpr ExportKind kKinds[] = {
    {"tile", "/ .tif .tiff .exr", "the cells of the tile, a stack of pictures", "", export_cells},
    {"color", "/ .tif .tiff .exr", "the colors in the tile, a stack of pictures", "", export_colors},
    {"normal", "/ .tif .tiff .exr", "the normals of the tile, a stack of pictures", "", export_normals},
    {"height", ".png .exr .tif .tiff", "a map of heights, seen from --side", " --side --size ",
     export_heights},
    {"gpu", ".json", "textures for a GPU: raw files, and a JSON that says what they are", "", export_gpu},
};

}  // namespace

std::span<const ExportKind> cell_object_exports() { return kKinds; }

}  // namespace mesocell
