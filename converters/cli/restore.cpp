#include "converters/cli/restore.h"

#include <utility>

#include "converters/cli/convert_plan.h"
#include "converters/vdb/vdb_object.h"
#include "format/cell_object_io.h"
#include "format/file.h"

namespace mesocell {

bool is_restore(const ConvertCommand& command) {
  return command.inputs.size() == 1 && !command.grid && is_vdb_object(command.input);
}

std::optional<Failure> restore(const ConvertCommand& command, const Progress& progress, AssetFile& written) {
  Metadata metadata;
  WriteOptions options;
  if (auto failure = parse_write_options(command, options, metadata)) return failure;
  if (auto failure = check_convert_files(command, {})) return failure;
  Result<CellObject> object = read_vdb_object(command.input, {}, command.common.threads, &progress);
  if (!object) return Failure{object.error(), command.input};
  object->metadata = std::move(metadata);
  const Result<std::vector<std::byte>> bytes = encode_cell_object(*object, options);
  if (!bytes) return Failure{bytes.error(), command.output};
  // What the volume holds is untrusted: it is an asset if readers say so.
  Result<AssetFile> file = read_assets(*bytes);
  if (!file) return Failure{file.error(), command.input};
  if (Status status = write_file(command.output, *bytes, command.no_clobber); !status)
    return Failure{status.error(), command.output};
  written = std::move(*file);
  return std::nullopt;
}

}  // namespace mesocell
