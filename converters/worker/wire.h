#pragma once

#include <cstdint>

#include "format/byte_reader.h"
#include "format/byte_writer.h"

/// What goes between a worker and who runs it. Both are of one build.
namespace mesocell {

inline constexpr std::uint32_t kWireMagic = 0x4b524f57;  // "WORK"
inline constexpr std::uint32_t kWireDone = 0xffff'ffff;  // else an ErrorCode

/// The head of a request.
struct WireLimits {
  std::uint64_t memory_bytes = 0, cpu_seconds = 0;
};

inline void write_wire_limits(const WireLimits& limits, ByteWriter& out) {
  out.u64(limits.memory_bytes);
  out.u64(limits.cpu_seconds);
}

inline WireLimits read_wire_limits(ByteReader& in) {
  WireLimits limits;
  limits.memory_bytes = in.u64();
  limits.cpu_seconds = in.u64();
  return limits;
}

}  // namespace mesocell
