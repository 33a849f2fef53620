#include "converters/export/glb_file.h"

namespace mesocell {

Status write_glb(const std::string& path, std::string_view json, const GlbViews& views, bool no_clobber,
                 std::uint64_t* file_bytes, const Progress* progress) {
  constexpr std::uint32_t kMagic = 0x46546c67, kJson = 0x4e4f534a, kBin = 0x004e4942;
  const std::uint64_t json_bytes = (json.size() + 3) / 4 * 4;
  const std::uint64_t total = 12 + 8 + json_bytes + 8 + views.size();
  if (total > 0xffffffffu)
    return Error{ErrorCode::kLimit,
                 "the GLB file would have " + std::to_string(total) +
                     " bytes, and 2^32 - 1 are the most that there can be; write PLY, use Draco, "
                     "or take a box of tiles"};
  Result<FileStream> out = FileStream::create(path, no_clobber);
  if (!out) return out.error();
  out->u32(kMagic);
  out->u32(2);
  out->u32(std::uint32_t(total));
  out->u32(std::uint32_t(json_bytes));
  out->u32(kJson);
  out->text(json);
  out->text(std::string(std::size_t(json_bytes - json.size()), ' '));
  out->u32(std::uint32_t(views.size()));
  out->u32(kBin);
  for (const GlbViews::View& view : views.views()) {
    if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
    if (progress && progress->report)
      progress->report("writing", double(view.offset) / double(views.size() + 1));
    view.write(*out);
    for (std::uint64_t k = view.bytes; k % 4 != 0; ++k) out->u8(0);
  }
  if (file_bytes) *file_bytes = total;
  return out->finish();
}

}  // namespace mesocell
