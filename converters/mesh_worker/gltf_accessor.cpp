#include "converters/mesh_worker/gltf_accessor.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <string>

#include "converters/mesh_worker/draco_mesh.h"

namespace mesocell {
namespace {

Error broken(const std::string& why) {
  return {ErrorCode::kInvalidInput, "the scene is damaged (" + why + "); fetch or export it again"};
}

using Element = GltfElement;

/// Elements of a buffer view, or nothing if they are not all there.
class ViewReader {
 public:
  static std::optional<ViewReader> make(const tinygltf::Model& model, int view_index, std::size_t offset,
                                        std::size_t count, int component, std::size_t components,
                                        bool packed) {
    if (view_index < 0 || std::size_t(view_index) >= model.bufferViews.size()) return std::nullopt;
    const tinygltf::BufferView& view = model.bufferViews[std::size_t(view_index)];
    if (view.buffer < 0 || std::size_t(view.buffer) >= model.buffers.size()) return std::nullopt;
    const std::vector<unsigned char>& bytes = model.buffers[std::size_t(view.buffer)].data;
    const int size = tinygltf::GetComponentSizeInBytes(std::uint32_t(component));
    if (size <= 0 || view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
      return std::nullopt;
    ViewReader reader;
    reader.component_ = component;
    reader.size_ = std::size_t(size);
    const std::size_t element = reader.size_ * components;
    reader.stride_ = view.byteStride > 0 && !packed ? view.byteStride : element;
    if (offset > view.byteLength) return std::nullopt;
    const std::size_t room = view.byteLength - offset;
    if (count > 0 && (room < element || (count - 1) > (room - element) / reader.stride_)) return std::nullopt;
    reader.data_ = bytes.data() + view.byteOffset + offset;
    return reader;
  }

  [[nodiscard]] double at(std::size_t element, std::size_t k) const {
    const unsigned char* p = data_ + element * stride_ + k * size_;
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < size_; ++i) bits |= std::uint32_t{p[i]} << (8 * i);
    switch (component_) {
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return double(std::int8_t(bits));
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return double(std::int16_t(bits));
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return double{std::bit_cast<float>(bits)};
      default:
        return double(bits);
    }
  }

 private:
  const unsigned char* data_ = nullptr;
  std::size_t stride_ = 0, size_ = 0;
  int component_ = 0;
};

}  // namespace

double full_value(int component) {
  switch (component) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return 127;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 255;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return 32767;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 65535;
    default:
      return 1;
  }
}

Result<std::vector<GltfElement>> read_accessor(const tinygltf::Model& model, int index) {
  if (index < 0 || std::size_t(index) >= model.accessors.size()) return broken("an accessor is not there");
  const tinygltf::Accessor& accessor = model.accessors[std::size_t(index)];
  const int components = tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type));
  if (components < 1 || components > 4) return broken("an accessor has a wrong type");
  const std::size_t n = std::size_t(components);
  std::vector<Element> elements;
  if (accessor.bufferView >= 0) {
    const auto view = ViewReader::make(model, accessor.bufferView, accessor.byteOffset, accessor.count,
                                       accessor.componentType, n, false);
    if (!view) return broken("an accessor reaches beyond its data");
    elements.resize(accessor.count);
    for (std::size_t i = 0; i < accessor.count; ++i)
      for (std::size_t k = 0; k < n; ++k) elements[i][k] = view->at(i, k);
  } else {
    elements.resize(accessor.count);
  }
  if (accessor.sparse.isSparse) {
    const auto& sparse = accessor.sparse;
    const std::size_t count = std::size_t(std::max(sparse.count, 0));
    const auto places =
        ViewReader::make(model, sparse.indices.bufferView, std::size_t(sparse.indices.byteOffset), count,
                         sparse.indices.componentType, 1, true);
    const auto values =
        ViewReader::make(model, sparse.values.bufferView, std::size_t(sparse.values.byteOffset), count,
                         accessor.componentType, n, true);
    if (!places || !values) return broken("a sparse accessor reaches beyond its data");
    for (std::size_t i = 0; i < count; ++i) {
      const double place = places->at(i, 0);
      if (!(place < double(elements.size())))
        return broken("a sparse accessor names an element that is not there");
      for (std::size_t k = 0; k < n; ++k) elements[std::size_t(place)][k] = values->at(i, k);
    }
  }
  if (accessor.normalized) {
    const double full = full_value(accessor.componentType);
    for (Element& element : elements)
      for (double& x : element) x = std::max(x / full, -1.0);
  }
  return elements;
}

namespace {

void set_positions(const std::vector<Element>& from, GltfPrimitive& out) {
  for (const Element& e : from) out.positions.push_back({e[0], e[1], e[2]});
}
/// `full`: what is 1.
void set_colors(const std::vector<Element>& from, double full, GltfPrimitive& out) {
  for (const Element& e : from) out.colors.push_back(Vec3{e[0], e[1], e[2]} / full);
}
void set_uvs(const std::vector<Element>& from, GltfPrimitive& out) {
  for (const Element& e : from) {
    const Uv uv{float(e[0]), float(e[1])};
    out.uvs.push_back(std::isfinite(uv[0]) && std::isfinite(uv[1]) ? uv : Uv{0, 0});
  }
}

/// Triangles of a list, a strip or a fan of corners.
void cut(const std::vector<std::uint32_t>& corners, int mode, std::vector<Triangle>& triangles) {
  const std::size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
  for (std::size_t i = 0; i + 2 < corners.size(); i += step) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
      triangles.push_back({corners[0], corners[i + 1], corners[i + 2]});
    else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 != 0)
      triangles.push_back({corners[i + 1], corners[i], corners[i + 2]});
    else
      triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  }
}

/// What of a primitive is wanted, in this order.
std::vector<std::string> wanted_names(int set) {
  std::vector<std::string> names = {"POSITION", "COLOR_0"};
  if (set >= 0) names.push_back("TEXCOORD_" + std::to_string(set));
  return names;
}

void set_attribute(std::size_t which, const std::vector<Element>& values, double full, GltfPrimitive& out) {
  if (which == 0) set_positions(values, out);
  if (which == 1) set_colors(values, full, out);
  if (which == 2) set_uvs(values, out);
}

Result<GltfPrimitive> read_draco_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                           const tinygltf::Value& extension, int set) {
  const tinygltf::Value& view_value = extension.Get("bufferView");
  const tinygltf::Value& ids_value = extension.Get("attributes");
  const int view_index = view_value.IsInt() ? view_value.GetNumberAsInt() : -1;
  if (view_index < 0 || std::size_t(view_index) >= model.bufferViews.size() || !ids_value.IsObject())
    return broken("the Draco extension has no data");
  const tinygltf::BufferView& view = model.bufferViews[std::size_t(view_index)];
  const auto& bytes = model.buffers[std::size_t(view.buffer)].data;
  if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
    return broken("the Draco data are cut off");
  std::vector<std::uint32_t> ids;
  std::vector<std::size_t> which;
  const std::vector<std::string> names = wanted_names(set);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!ids_value.Has(names[i])) continue;
    ids.push_back(std::uint32_t(ids_value.Get(names[i]).GetNumberAsInt()));
    which.push_back(i);
  }
  if (ids.empty()) return broken("the Draco extension has no attributes");
  Result<DracoMesh> mesh =
      decode_draco(std::as_bytes(std::span(bytes).subspan(view.byteOffset, view.byteLength)), ids);
  if (!mesh) return mesh.error();
  GltfPrimitive out;
  for (std::size_t i = 0; i < which.size(); ++i) {
    DracoValues& values = mesh->attributes[i];
    const auto accessor = primitive.attributes.find(names[which[i]]);
    const bool normalized = accessor != primitive.attributes.end() &&
                            std::size_t(accessor->second) < model.accessors.size() &&
                            model.accessors[std::size_t(accessor->second)].normalized;
    if (normalized)
      for (Element& element : values.values)
        for (double& x : element) x = std::max(x / values.full, -1.0);
    set_attribute(which[i], values.values, normalized ? 1 : values.full, out);
  }
  out.triangles = std::move(mesh->triangles);
  return out;
}

}  // namespace

Result<GltfPrimitive> read_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                     int set) {
  const auto draco = primitive.extensions.find("KHR_draco_mesh_compression");
  if (draco != primitive.extensions.end()) return read_draco_primitive(model, primitive, draco->second, set);
  GltfPrimitive out;
  const std::vector<std::string> names = wanted_names(set);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto attribute = primitive.attributes.find(names[i]);
    if (attribute == primitive.attributes.end()) continue;
    const Result<std::vector<Element>> elements = read_accessor(model, attribute->second);
    if (!elements) return elements.error();
    if (i > 0 && elements->size() != out.positions.size()) return broken("attributes have different lengths");
    const tinygltf::Accessor& accessor = model.accessors[std::size_t(attribute->second)];
    // Colors of integers are always meant to be normalized.
    set_attribute(i, *elements, accessor.normalized ? 1 : full_value(accessor.componentType), out);
  }
  std::vector<std::uint32_t> corners;
  if (primitive.indices >= 0) {
    const Result<std::vector<Element>> indices = read_accessor(model, primitive.indices);
    if (!indices) return indices.error();
    for (const Element& index : *indices) {
      if (!(index[0] >= 0 && index[0] < double(out.positions.size())))
        return broken("a triangle uses a vertex that is not there");
      corners.push_back(std::uint32_t(index[0]));
    }
  } else {
    for (std::size_t i = 0; i < out.positions.size(); ++i) corners.push_back(std::uint32_t(i));
  }
  cut(corners, primitive.mode, out.triangles);
  return out;
}

}  // namespace mesocell
