#include <draco/compression/decode.h>

#include <cstring>
#include <memory>
#include <string>

#include "converters/export/basic_mesh.h"

namespace mesocell {
namespace {

Error refused(const std::string& why) {
  return Error{ErrorCode::kInvalidInput, "it is no Draco mesh that can be decoded: " + why};
}

class Writer {
 public:
  explicit Writer(std::uint64_t bytes) { bytes_.reserve(std::size_t(bytes)); }
  void u32(std::uint32_t v) {
    for (int k = 0; k < 4; ++k) u8(std::uint8_t(v >> (8 * k)));
  }
  void f32(float v) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &v, sizeof bits);
    u32(bits);
  }
  void u8(std::uint8_t v) { bytes_.push_back(std::byte(v)); }
  std::vector<std::byte> release() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace

Result<std::vector<std::byte>> decode_draco(std::span<const std::byte> bitstream) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bitstream.data()), bitstream.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) return refused(decoded.status().error_msg());
  const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
  const draco::PointAttribute* const positions = mesh->GetNamedAttribute(draco::GeometryAttribute::POSITION);
  if (!positions || positions->num_components() != 3) return refused("it has no positions");
  const draco::PointAttribute* const colors = mesh->GetNamedAttribute(draco::GeometryAttribute::COLOR);
  const bool colored = colors && colors->data_type() == draco::DT_UINT16 && colors->num_components() >= 3;
  const std::uint32_t points = mesh->num_points(), faces = mesh->num_faces();
  Writer out(12 + 15 * std::uint64_t{points} + 12 * std::uint64_t{faces});
  out.u32(points);
  out.u32(faces);
  out.u32(colored);
  for (draco::PointIndex p(0); p < points; ++p) {
    std::array<float, 3> x{};
    if (!positions->ConvertValue<float, 3>(positions->mapped_index(p), x.data()))
      return refused("a position cannot be read");
    for (const float c : x) out.f32(c);
  }
  for (draco::FaceIndex f(0); f < faces; ++f)
    for (const draco::PointIndex& corner : mesh->face(f)) out.u32(corner.value());
  if (colored)
    for (draco::PointIndex p(0); p < points; ++p) {
      std::array<std::uint16_t, 4> c{};
      if (!colors->ConvertValue<std::uint16_t>(colors->mapped_index(p), std::int8_t(colors->num_components()),
                                               c.data()))
        return refused("a color cannot be read");
      for (std::size_t a = 0; a < 3; ++a) out.u8(std::uint8_t(c[a] >> 8));
    }
  return out.release();
}

}  // namespace mesocell
