#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "converters/vdb/sparse_volume.h"
#include "format/byte_reader.h"
#include "format/byte_writer.h"

/// What goes between the command and mesocell_vdb_worker. Both are of one build. A request begins with its
/// task:
/// - kList: path, number of grids, their keys; reply: a VdbGridFacts for each
/// - kRead: path, VdbReadLimits, key; reply: a volume
/// - kWrite: path, number of volumes, volumes; no reply
namespace mesocell {

enum class VdbTask : std::uint32_t { kList = 1, kRead = 2, kWrite = 3 };

struct VdbReadLimits {
  std::uint64_t max_voxels = 0, max_bytes = 0;
};

/// What is told of a grid that is not read.
struct VdbGridFacts {
  std::string trouble;  ///< why nothing is known of it; empty if all is well
  VolumeClass volume_class = VolumeClass::kUnknown;
  std::uint64_t active_voxels = 0;
  bool linear = false;       ///< else the rest means nothing
  Transform index_to_world;  ///< unchecked
  VoxelCoord low{}, high{};  ///< of the active voxels; high less than low if there is none
};

inline void write_facts(const VdbGridFacts& facts, ByteWriter& out) {
  write_text(facts.trouble, out);
  out.u8(std::uint8_t(facts.volume_class));
  out.u64(facts.active_voxels);
  out.u8(facts.linear ? 1 : 0);
  write_transform(facts.index_to_world, out);
  for (const VoxelCoord& c : {facts.low, facts.high})
    for (const std::int32_t v : c) out.u32(std::uint32_t(v));
}

inline VdbGridFacts read_facts(ByteReader& in) {
  VdbGridFacts facts;
  facts.trouble = read_text(in);
  const std::uint8_t volume_class = in.u8();
  if (volume_class <= std::uint8_t(VolumeClass::kFog)) facts.volume_class = VolumeClass(volume_class);
  facts.active_voxels = in.u64();
  facts.linear = in.u8() != 0;
  facts.index_to_world = read_transform(in);
  for (VoxelCoord* c : {&facts.low, &facts.high})
    for (std::int32_t& v : *c) v = std::int32_t(in.u32());
  return facts;
}

}  // namespace mesocell
