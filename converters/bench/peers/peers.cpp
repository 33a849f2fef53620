#include "converters/bench/tracer.h"

namespace mesocell {

Result<std::unique_ptr<Tracer>> make_peer_tracer(const CellObject&, std::string_view name, unsigned,
                                                 std::uint64_t) {
  return Error{ErrorCode::kUsage, "this build has no peer '" + std::string(name) + "'"};
}

}  // namespace mesocell
