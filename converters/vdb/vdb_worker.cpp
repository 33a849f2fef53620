#include "converters/vdb/vdb_worker.h"

#include <openvdb/openvdb.h>

#include "converters/vdb/vdb_wire.h"
#include "converters/worker/serve.h"

using namespace mesocell;

// The one program that links OpenVDB: what hostile files do to it ends here.

namespace {

Result<std::vector<std::byte>> answer(std::span<const std::byte> request) {
  openvdb::initialize();
  ByteReader reader(request);
  switch (VdbTask(reader.u32())) {
    case VdbTask::kList:
      return list_grids(reader);
    case VdbTask::kRead:
      return read_grid(reader);
    case VdbTask::kWrite:
      return write_grids(reader);
  }
  return Error{ErrorCode::kInvalidInput,
               "the request is of another version of this program; install it again"};
}

}  // namespace

int main() { return serve_request(answer); }
