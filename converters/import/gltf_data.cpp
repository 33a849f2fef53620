#include "converters/import/gltf_data.h"

#include <algorithm>
#include <string_view>

namespace mesocell {
namespace {

/// A GLB counts its bytes in 32 bits; some are left for the JSON.
constexpr std::uint64_t kMaxBytes = 0xe000'0000;
/// Of an accessor.
constexpr std::uint64_t kMaxElements = std::uint64_t{1} << 30;
/// Of one that has no bytes in the file to bound it.
constexpr std::uint64_t kMaxZeros = std::uint64_t{1} << 26;

struct ComponentType {
  int number;
  std::uint64_t bytes;
};
constexpr std::array<ComponentType, 6> kComponents = {
    {{5120, 1}, {5121, 1}, {5122, 2}, {5123, 2}, {5125, 4}, {5126, 4}}};

std::uint64_t component_bytes(std::uint64_t number) {
  for (const ComponentType& type : kComponents)
    if (std::uint64_t(type.number) == number) return type.bytes;
  return 0;
}

/// Components of an element. Columns of matrices may be padded, which nothing that is read here has.
std::uint64_t component_count(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, std::uint64_t>, 7> kTypes = {
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  for (const auto& [name, count] : kTypes)
    if (name == type) return count;
  return 0;
}

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
}

}  // namespace

std::optional<std::vector<std::byte>> decode_data_uri(std::string_view uri) {
  constexpr std::string_view kMark = ";base64,";
  const std::size_t mark = uri.substr(0, 256).find(kMark);
  if (!uri.starts_with("data:") || mark == uri.npos) return std::nullopt;
  uri.remove_prefix(mark + kMark.size());
  std::vector<std::byte> bytes;
  bytes.reserve(uri.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : uri) {
    if (c == '=') break;
    const int digit = base64_digit(c);
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | std::uint32_t(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(std::byte(std::uint8_t(bits >> count)));
  }
  return bytes;
}

GltfData::GltfData(const Json& in, std::span<const std::byte> binary, const ResourceReader& read) {
  read_buffers(in, binary, read);
  read_views(in);
  read_accessors(in);
}

std::uint64_t GltfData::append(std::span<const std::byte> bytes) {
  if (bytes.size() > kMaxBytes - bytes_.size())
    throw GltfFault{
        {ErrorCode::kLimit, "its buffers and pictures have more than 3.5 GB; use a smaller scene"}};
  const std::uint64_t offset = bytes_.size();
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  bytes_.resize((bytes_.size() + 7) / 8 * 8);
  return offset;
}

void GltfData::read_buffers(const Json& in, std::span<const std::byte> binary, const ResourceReader& read) {
  const Json& buffers = array_member(in, "buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::string where = numbered("buffer", i);
    const auto size = whole_member(buffers[i], where, "byteLength", kMaxBytes);
    if (!size) gltf_fault(where, "has no byteLength");
    std::vector<std::byte> own;
    std::span<const std::byte> bytes = binary;
    if (const Json* uri = member(buffers[i], "uri")) {
      if (!uri->is_string()) gltf_fault(where, "has a URI that is no text");
      const std::string& text = uri->get_ref<const std::string&>();
      if (text.starts_with("data:")) {
        auto decoded = decode_data_uri(text);
        if (!decoded) gltf_fault(where, "has a data URI that is damaged or not in base64");
        own = std::move(*decoded);
      } else {
        Result<std::vector<std::byte>> file = read(text);
        if (!file)
          throw GltfFault{
              {file.error().code, where + ", '" + text.substr(0, 200) + "': " + file.error().message}};
        own = std::move(*file);
      }
      bytes = own;
    } else if (i > 0) {
      gltf_fault(where, "has no URI");
    }
    if (*size > bytes.size())
      gltf_fault(where, "promises " + std::to_string(*size) + " bytes, but there are " +
                            std::to_string(bytes.size()) + ": the file is cut off");
    buffers_.push_back({append(bytes.first(std::size_t(*size))), *size, 0});
  }
}

void GltfData::read_views(const Json& in) {
  const Json& views = array_member(in, "bufferViews");
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string where = numbered("buffer view", i);
    const auto buffer = index_member(views[i], where, "buffer", buffers_.size());
    const auto size = whole_member(views[i], where, "byteLength");
    if (!buffer || !size) gltf_fault(where, "has no buffer or no byteLength");
    const std::uint64_t offset = whole_member(views[i], where, "byteOffset").value_or(0);
    const std::uint64_t stride = whole_member(views[i], where, "byteStride").value_or(0);
    if (stride > 252 || stride % 4 != 0) gltf_fault(where, "has a byteStride that is not allowed");
    if (offset > buffers_[*buffer].bytes || *size > buffers_[*buffer].bytes - offset)
      gltf_fault(where, "reaches beyond the end of its buffer");
    views_.push_back({buffers_[*buffer].offset + offset, *size, stride});
  }
}

void GltfData::check_range(const View& view, std::uint64_t offset, std::uint64_t count, std::uint64_t stride,
                           std::uint64_t element, const std::string& where) const {
  // Nothing overflows: counts are below 2^31, strides below 2^8.
  if (count > 0 && (offset > view.bytes || (count - 1) * stride + element > view.bytes - offset))
    gltf_fault(where, "reaches beyond the end of its buffer view");
}

void GltfData::check_sparse(const Json& sparse, const std::string& where, const Accessor& accessor,
                            std::uint64_t element_bytes, Json& written) {
  const Json *indices = member(sparse, "indices"), *values = member(sparse, "values");
  const auto count = whole_member(sparse, where, "count", accessor.count);
  if (!indices || !values || !count) gltf_fault(where, "has a 'sparse' without count, indices or values");
  const auto view = index_member(*indices, where, "bufferView", views_.size());
  const auto type = whole_member(*indices, where, "componentType");
  const auto value_view = index_member(*values, where, "bufferView", views_.size());
  if (!view || !type || !value_view || component_bytes(*type) == 0 || *type == 5126 || *type % 2 == 0)
    gltf_fault(where, "has a 'sparse' with no or wrong buffer views or types");
  const std::uint64_t offset = whole_member(*indices, where, "byteOffset").value_or(0);
  const std::uint64_t value_offset = whole_member(*values, where, "byteOffset").value_or(0);
  check_range(views_[*view], offset, *count, component_bytes(*type), component_bytes(*type), where);
  check_range(views_[*value_view], value_offset, *count, element_bytes, element_bytes, where);
  written["sparse"] = {{"count", *count},
                       {"indices", {{"bufferView", *view}, {"byteOffset", offset}, {"componentType", *type}}},
                       {"values", {{"bufferView", *value_view}, {"byteOffset", value_offset}}}};
}

void GltfData::read_accessors(const Json& in) {
  const Json& accessors = array_member(in, "accessors");
  for (std::size_t i = 0; i < accessors.size(); ++i) {
    const Json& a = accessors[i];
    const std::string where = numbered("accessor", i);
    const auto component = whole_member(a, where, "componentType");
    const auto count = whole_member(a, where, "count", kMaxElements);
    const Json* type = member(a, "type");
    Accessor accessor;
    if (type && type->is_string()) accessor.type = type->get<std::string>();
    if (!component || component_bytes(*component) == 0 || !count || component_count(accessor.type) == 0)
      gltf_fault(where, "has no or a wrong componentType, type or count");
    accessor.count = *count;
    accessor.component = int(*component);
    const std::uint64_t element = component_bytes(*component) * component_count(accessor.type);
    Json written = {{"componentType", *component}, {"count", *count}, {"type", accessor.type}};
    if (const Json* normalized = member(a, "normalized")) {
      if (!normalized->is_boolean()) gltf_fault(where, "has a 'normalized' that is neither true nor false");
      accessor.normalized = normalized->get<bool>();
      written["normalized"] = accessor.normalized;
    }
    const auto view = index_member(a, where, "bufferView", views_.size());
    if (view) {
      const std::uint64_t offset = whole_member(a, where, "byteOffset").value_or(0);
      const std::uint64_t stride = views_[*view].stride > 0 ? views_[*view].stride : element;
      check_range(views_[*view], offset, *count, stride, element, where);
      written["bufferView"] = *view;
      written["byteOffset"] = offset;
    }
    if (const Json* sparse = member(a, "sparse")) check_sparse(*sparse, where, accessor, element, written);
    accessor.has_data = view || written.contains("sparse");
    if (!view && written.contains("sparse") && *count > kMaxZeros)
      gltf_fault(where,
                 "has more elements than a sparse accessor may have here, " + std::to_string(kMaxZeros));
    accessors_.push_back(std::move(accessor));
    written_accessors_.push_back(std::move(written));
  }
}

std::size_t GltfData::add_view(std::span<const std::byte> bytes) {
  views_.push_back({append(bytes), bytes.size(), 0});
  return views_.size() - 1;
}

void GltfData::write(Json& out) {
  if (bytes_.empty()) bytes_.resize(8);  // tinygltf wants some
  out["buffers"] = Json::array({{{"byteLength", bytes_.size()}}});
  Json views = Json::array();
  for (const View& view : views_) {
    Json written = {{"buffer", 0}, {"byteOffset", view.offset}, {"byteLength", view.bytes}};
    if (view.stride > 0) written["byteStride"] = view.stride;
    views.push_back(std::move(written));
  }
  out["bufferViews"] = std::move(views);
  out["accessors"] = std::move(written_accessors_);
}

}  // namespace mesocell
