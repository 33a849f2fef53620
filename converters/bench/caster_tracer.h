#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "converters/bench/tracer.h"

namespace mesocell {

/// A tracer of a benchmark, and what making it took.
struct NamedTracer {
  std::string method;
  std::unique_ptr<Tracer> tracer;
  double build_seconds = 0;
};

/// All methods there are, ours and those of peers, as examples of their names; not all may be available.
[[nodiscard]] const std::vector<std::string>& bench_methods();

/// Prepares an object for a method: one of make_cell_object_caster() or of make_peer_tracer(). Errors:
/// theirs; kUsage says which methods there are.
[[nodiscard]] Result<NamedTracer> make_tracer(const CellObject& object, std::string_view method,
                                              unsigned threads, std::uint64_t max_bytes);

/// Tries a method on an object of one tile. Errors: those of make_tracer().
[[nodiscard]] Status try_method(std::string_view method);

/// A caster as a tracer.
[[nodiscard]] std::unique_ptr<Tracer> make_caster_tracer(std::unique_ptr<Caster> caster);

}  // namespace mesocell
