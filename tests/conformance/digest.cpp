#include "tests/conformance/digest.h"

#include <vector>

#include "format/byte_writer.h"
#include "format/cell_object_chunks.h"
#include "format/cell_object_io.h"
#include "format/container.h"
#include "format/hash.h"
#include "format/representation.h"
#include "format/text_chunk.h"

namespace mesocell::test {
namespace {

/// `payload(asset, type)` for each chunk of a known type, in the order of the directory, behind its type.
template <typename Payload>
Result<std::uint64_t> digest(const Container& container, Payload payload) {
  ByteWriter all;
  for (std::size_t asset = 0; asset < container.assets().size(); ++asset) {
    for (const ChunkInfo& chunk : container.chunks_of(asset)) {
      const AssetInfo& info = container.assets()[asset];
      if (!info.rules || !info.rules->find(chunk.type, container.minor())) continue;
      const Result<std::vector<std::byte>> bytes = payload(asset, chunk.type);
      if (!bytes) return bytes.error();
      all.u32(chunk.type);
      all.append(*bytes);
    }
  }
  return hash64(all.bytes());
}

std::vector<std::byte> encode_chunk(const CellObject& object, std::uint32_t type) {
  switch (type) {
    case kGridChunk:
      return encode_grid(object.grid);
    case kTileChunk:
      return encode_tile(object.tile);
    case kMembershipChunk:
      return encode_membership(object.membership);
    case kColorChunk:
      return encode_color(object.color.value());
    case kCellColorChunk:
      return encode_colors(object.cell_colors.value());
    case kInstanceColorChunk:
      return encode_colors(object.instance_colors.value());
    case kSurfaceColorChunk:
      return encode_surface_colors(object.surface_colors.value());
    case kNormalChunk:
      return encode_normals(object.normals.value());
    case kBasicMeshChunk:
      return encode_basic_mesh(object.basic_mesh.value());
    default:
      return encode_text(object.metadata);
  }
}

}  // namespace

Result<std::uint64_t> digest_of_chunks(std::span<const std::byte> file) {
  const auto container = Container::open(file);
  if (!container) return container.error();
  return digest(*container,
                [&](std::size_t asset, std::uint32_t type) { return container->read_chunk(asset, type); });
}

Result<std::uint64_t> digest_of_objects(std::span<const std::byte> file) {
  const auto container = Container::open(file);
  if (!container) return container.error();
  std::vector<CellObject> objects;
  for (std::size_t asset = 0; asset < container->assets().size(); ++asset) {
    auto object = read_cell_object(file, {}, asset);
    if (!object) return object.error();
    objects.push_back(std::move(*object));
  }
  return digest(*container, [&](std::size_t asset, std::uint32_t type) {
    return Result<std::vector<std::byte>>(encode_chunk(objects[asset], type));
  });
}

}  // namespace mesocell::test
