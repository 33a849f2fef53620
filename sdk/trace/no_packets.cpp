#include "sdk/trace/packets.h"

/// Stands for packets.cpp where the project is built without Highway.
namespace mesocell {

bool packets_supported() { return false; }

std::uint64_t trace_packets(const PacketScene&, std::span<const Ray>, StreamHit*, std::uint64_t*) {
  return ~std::uint64_t{0};
}

}  // namespace mesocell
