#include "converters/vdb/vdb_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "format/file.h"

namespace mesocell {
namespace {

constexpr const char* kWorker = "mesocell_vdb_worker";

struct TypeRow {
  std::string_view type;
  bool shape, colors, labels;
};
constexpr std::array<TypeRow, 9> kTypes = {{{"float_5_4_3", true, false, false},
                                            {"double_5_4_3", true, false, false},
                                            {"bool_5_4_3", true, false, true},
                                            {"mask_5_4_3", true, false, true},
                                            {"int32_5_4_3", true, false, true},
                                            {"int64_5_4_3", true, false, true},
                                            {"vec3s_5_4_3", false, true, false},
                                            {"vec3d_5_4_3", false, true, false},
                                            {"vec3i_5_4_3", false, false, false}}};

const char* purpose_text(VdbPurpose purpose) {
  switch (purpose) {
    case VdbPurpose::kShape:
      return "a shape (float, double, bool, mask, int32 or int64)";
    case VdbPurpose::kColors:
      return "colors (vec3s or vec3d)";
    case VdbPurpose::kLabels:
      return "labels (int32, int64, bool or mask)";
    case VdbPurpose::kAny:
      break;
  }
  return "anything";
}

bool usable(const VdbGridHead& grid, VdbPurpose purpose) {
  const auto row =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const TypeRow& r) { return r.type == grid.type; });
  if (row == kTypes.end()) return false;
  switch (purpose) {
    case VdbPurpose::kShape:
      return row->shape;
    case VdbPurpose::kColors:
      return row->colors;
    case VdbPurpose::kLabels:
      return row->labels;
    case VdbPurpose::kAny:
      break;
  }
  return true;
}

/// "grid 'density' of type float_5_4_3", in words for points.
std::string described(const VdbGridHead& grid) {
  return "grid '" + grid.label() + "' holds " +
         (grid.type.starts_with("ptdataidx") ? std::string("points, not voxels (a PointDataGrid)")
                                             : "values of type " + grid.type);
}

std::string labels_of_all(const std::vector<VdbGridHead>& grids) {
  std::string text;
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < std::min(grids.size(), kMost); ++i) text += (i ? ", " : "") + grids[i].label();
  return grids.size() > kMost ? text + ", …" : text;
}

/// The grid that is asked for by name, or by name and index.
const VdbGridHead* find_grid(const std::vector<VdbGridHead>& grids, const std::string& wanted) {
  for (const VdbGridHead& grid : grids)
    if (grid.name == wanted && grid.index == 0) return &grid;
  const std::size_t open = wanted.rfind('[');
  if (open == wanted.npos || !wanted.ends_with(']')) return nullptr;
  std::uint32_t index = 0;
  const char* const end = wanted.data() + wanted.size() - 1;
  const auto [stop, status] = std::from_chars(wanted.data() + open + 1, end, index);
  if (status != std::errc() || stop != end) return nullptr;
  for (const VdbGridHead& grid : grids)
    if (std::string_view(wanted).substr(0, open) == grid.name && grid.index == index) return &grid;
  return nullptr;
}

Result<const VdbGridHead*> choose(const std::vector<VdbGridHead>& grids, const VdbReadOptions& options) {
  if (!options.grid.empty()) {
    const VdbGridHead* const grid = find_grid(grids, options.grid);
    if (!grid)
      return Error{ErrorCode::kUsage,
                   "the VDB has no grid '" + options.grid + "'; there are: " + labels_of_all(grids)};
    if (!usable(*grid, options.purpose))
      return Error{ErrorCode::kInvalidInput, described(*grid) + ", which are no " +
                                                 purpose_text(options.purpose) + "; choose another grid"};
    return grid;
  }
  for (const VdbGridHead& grid : grids)
    if (usable(grid, options.purpose)) return &grid;
  return Error{ErrorCode::kInvalidInput,
               "no grid of the VDB can be used as " + std::string(purpose_text(options.purpose)) + ": its " +
                   described(grids.front()) + "; convert it to a grid of such a type"};
}

}  // namespace

Result<SparseVolume> read_vdb(const std::string& path, const VdbReadOptions& options, VdbReadReport* report,
                              const Progress* progress) {
  const Result<std::vector<VdbGridHead>> grids = read_vdb_header(path, options.max_file_bytes);
  if (!grids) return grids.error();
  const Result<const VdbGridHead*> grid = choose(*grids, options);
  if (!grid) return grid.error();
  if (report) {
    report->grid = (*grid)->label();
    report->others.clear();
    if (options.grid.empty())
      for (const VdbGridHead& other : *grids)
        if (&other != *grid) report->others.push_back(other.label());
  }
  ByteWriter request;
  request.u32(std::uint32_t(VdbTask::kRead));
  write_text(path, request);
  request.u64(options.max_voxels);
  request.u64(options.max_bytes);
  write_text((*grid)->key, request);
  const Result<std::vector<std::byte>> reply =
      run_worker(kWorker, request.bytes(), "the VDB", options.worker, progress);
  if (!reply) return reply.error();
  ByteReader reader(*reply);
  return read_volume(reader);
}

Result<std::vector<VdbGridInfo>> list_vdb(const std::string& path, const WorkerLimits& limits,
                                          const Progress* progress) {
  const Result<std::vector<VdbGridHead>> grids = read_vdb_header(path);
  if (!grids) return grids.error();
  std::vector<VdbGridInfo> infos;
  ByteWriter request;
  request.u32(std::uint32_t(VdbTask::kList));
  write_text(path, request);
  std::uint32_t count = 0;
  for (const VdbGridHead& grid : *grids) count += usable(grid, VdbPurpose::kAny);
  request.u32(count);
  for (const VdbGridHead& grid : *grids)
    if (usable(grid, VdbPurpose::kAny)) write_text(grid.key, request);
  const Result<std::vector<std::byte>> reply =
      run_worker(kWorker, request.bytes(), "the VDB", limits, progress);
  if (!reply) return reply.error();
  ByteReader reader(*reply);
  for (const VdbGridHead& grid : *grids) {
    VdbGridInfo& info = infos.emplace_back(VdbGridInfo{grid, {}, usable(grid, VdbPurpose::kAny)});
    if (info.usable)
      info.facts = read_facts(reader);
    else
      info.facts.trouble = "the type cannot be used";
    info.facts.linear = info.facts.linear && is_sound(info.facts.index_to_world);
  }
  if (reader.overrun())
    return Error{ErrorCode::kInvalidInput, "what was read of the VDB is damaged; fetch or export it again"};
  return infos;
}

Status write_vdb(const std::string& path, std::span<const SparseVolume> volumes, bool no_clobber,
                 const WorkerLimits& limits, const Progress* progress) {
  Result<AtomicFile> file = AtomicFile::create(path, no_clobber);
  if (!file) return file.error();
  ByteWriter request;
  request.u32(std::uint32_t(VdbTask::kWrite));
  write_text(std::filesystem::absolute(file->temporary_path()).string(), request);
  request.u32(std::uint32_t(volumes.size()));
  for (const SparseVolume& volume : volumes) write_volume(volume, request);
  const Result<std::vector<std::byte>> reply =
      run_worker(kWorker, request.bytes(), "the volumes to write", limits, progress);
  if (!reply) return reply.error();
  return file->commit();
}

}  // namespace mesocell
