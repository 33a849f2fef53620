#include <string>

#include "converters/bench/peers/peers.h"

namespace mesocell {

Result<std::unique_ptr<Tracer>> make_peer_tracer(const CellObject& object, std::string_view name,
                                                 unsigned threads, std::uint64_t max_bytes) {
  const std::size_t colon = name.find(':');
  const std::string_view peer = name.substr(0, colon);
  const bool variant = colon != name.npos;
  const std::string_view call = variant ? name.substr(colon + 1) : "";
  try {
    if (peer == "embree-instanced" && (!variant || !call.empty()))
      return make_embree_tracer(object, true, call, threads, max_bytes);
    if (peer == "embree-surface" && (!variant || !call.empty()))
      return make_embree_tracer(object, false, call, threads, max_bytes);
    if (name == "openvdb") return make_vdb_tracer(object, false, max_bytes);
    if (name == "nanovdb") return make_vdb_tracer(object, true, max_bytes);
  } catch (const std::bad_alloc&) {
    return out_of_memory();
  }
  return Error{ErrorCode::kUsage, "there is no peer '" + std::string(name) +
                                      "'; there are embree-instanced and embree-surface, each also with :1, "
                                      ":8, :16 or :stream, openvdb and nanovdb"};
}

}  // namespace mesocell
