#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "converters/import/gltf_json.h"
#include "converters/import/gltf_normal.h"

namespace mesocell {

/// What normalize_gltf() makes of buffers, views and accessors: one buffer that has it all.
class GltfData {
 public:
  /// What is known of an accessor.
  struct Accessor {
    std::uint64_t count = 0;
    int component = 0;      ///< glTF's number of the type
    std::string type;       ///< "VEC3"
    bool normalized = false;
    bool has_data = false;  ///< else zeros, or a Draco stream's
  };

  /// Reads all buffers and checks views and accessors of `in`. Throws GltfFault.
  GltfData(const Json& in, std::span<const std::byte> binary, const ResourceReader& read);

  [[nodiscard]] std::size_t view_count() const { return views_.size(); }
  [[nodiscard]] const std::vector<Accessor>& accessors() const { return accessors_; }

  /// Adds bytes of a picture; returns the index of their view. Throws GltfFault.
  std::size_t add_view(std::span<const std::byte> bytes);
  /// Puts buffer, views and accessors into `out`.
  void write(Json& out);
  [[nodiscard]] std::vector<std::byte> take_bytes() { return std::move(bytes_); }

 private:
  void read_buffers(const Json& in, std::span<const std::byte> binary, const ResourceReader& read);
  void read_views(const Json& in);
  void read_accessors(const Json& in);
  void check_sparse(const Json& sparse, const std::string& where, const Accessor& accessor,
                    std::uint64_t element_bytes, Json& written);
  std::uint64_t append(std::span<const std::byte> bytes);

  struct View {
    std::uint64_t offset = 0, bytes = 0, stride = 0;
  };
  /// Of `count` elements a stride apart from `offset` on in a view. Throws GltfFault.
  void check_range(const View& view, std::uint64_t offset, std::uint64_t count, std::uint64_t stride,
                   std::uint64_t element, const std::string& where) const;

  std::vector<std::byte> bytes_;
  std::vector<View> buffers_, views_;
  std::vector<Accessor> accessors_;
  Json written_accessors_ = Json::array();
};

/// The bytes of a data URI; nothing if it is none or damaged.
[[nodiscard]] std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri);

}  // namespace mesocell
