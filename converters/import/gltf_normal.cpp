#include "converters/import/gltf_normal.h"

#include <algorithm>
#include <array>
#include <set>

#include "converters/import/gltf_data.h"
#include "converters/import/gltf_json.h"
#include "converters/import/gltf_losses.h"
#include "format/byte_writer.h"

namespace mesocell {
namespace {

/// Of lists in each other a parsed JSON takes a hundred times its bytes, of others twenty times.
constexpr std::uint64_t kMaxJsonBytes = std::uint64_t{1} << 27;
constexpr int kMaxDepth = 64;
constexpr std::size_t kMaxWarnings = 50;
constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kTransform = "KHR_texture_transform";
constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

/// Extensions that may be required: those that are read, and those that change neither shape nor base color.
constexpr std::array<std::string_view, 18> kKnown = {kDraco,
                                                     kTransform,
                                                     kInstancing,
                                                     "KHR_mesh_quantization",
                                                     "KHR_materials_unlit",
                                                     "KHR_lights_punctual",
                                                     "KHR_materials_anisotropy",
                                                     "KHR_materials_clearcoat",
                                                     "KHR_materials_dispersion",
                                                     "KHR_materials_emissive_strength",
                                                     "KHR_materials_ior",
                                                     "KHR_materials_iridescence",
                                                     "KHR_materials_sheen",
                                                     "KHR_materials_specular",
                                                     "KHR_materials_transmission",
                                                     "KHR_materials_volume",
                                                     "KHR_materials_variants",
                                                     "KHR_xmp_json_ld"};

/// Extensions without which what is read differs from what is meant.
constexpr std::array<std::string_view, 4> kMissed = {"EXT_texture_webp", "KHR_texture_basisu",
                                                     "KHR_materials_pbrSpecularGlossiness", "MSFT_lod"};

bool is_type(const GltfData::Accessor& accessor, std::initializer_list<std::string_view> types,
             std::initializer_list<int> components) {
  return std::find(types.begin(), types.end(), accessor.type) != types.end() &&
         std::find(components.begin(), components.end(), accessor.component) != components.end();
}

/// Whether values are in each other no deeper than anyone writes them.
bool is_shallow(std::string_view json) {
  int depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_text && c == '\\') ++i;
    if (c == '"') in_text = !in_text;
    if (in_text) continue;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kMaxDepth) return false;
  }
  return true;
}

class Normalizer {
 public:
  Normalizer(const Json& in, std::span<const std::byte> binary, const ResourceReader& read,
             std::vector<MeshWarning>& warnings, ReadNotes& notes)
      : in_(in), read_(read), warnings_(warnings), notes_(notes) {
    check_head();
    data_.emplace(in, binary, read);
    add_materials();
    add_meshes();
    add_nodes();
    add_scene();
    note_scene_losses(in, notes);
    if (lines_ > 0)
      warn("primitives-skipped",
           std::to_string(lines_) + " parts of the scene are points or lines, and left out");
    if (deformed_ > 0)
      warn("deformation-ignored", std::to_string(deformed_) +
                                      " skins or morph targets are not read; meshes are as they are without");
  }

  [[nodiscard]] std::vector<std::byte> glb() {
    data_->write(out_);
    std::string text = out_.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::vector<std::byte> bytes = data_->take_bytes();
    ByteWriter glb;
    glb.u32(0x46546c67);  // "glTF"
    glb.u32(2);
    glb.u32(std::uint32_t(28 + text.size() + bytes.size()));
    glb.u32(std::uint32_t(text.size()));
    glb.u32(0x4e4f534a);  // "JSON"
    glb.append(text);
    glb.u32(std::uint32_t(bytes.size()));
    glb.u32(0x004e4942);  // "BIN"
    glb.append(bytes);
    return glb.release();
  }

 private:
  void warn(const char* id, std::string text) {
    if (warnings_.size() < kMaxWarnings) warnings_.push_back({id, std::move(text)});
  }

  void check_head() {
    const Json* asset = member(in_, "asset");
    const Json* version = asset ? member(*asset, "version") : nullptr;
    if (!version || !version->is_string()) gltf_fault("the file", "does not say its version of glTF");
    if (!version->get_ref<const std::string&>().starts_with("2."))
      gltf_fault("the file", "is glTF " + version->get<std::string>().substr(0, 16) + ", not 2.0");
    for (const Json& name : array_member(in_, "extensionsRequired")) {
      if (!name.is_string()) gltf_fault("extensionsRequired", "has an entry that is no text");
      const std::string text = name.get<std::string>();
      if (std::find(kKnown.begin(), kKnown.end(), text) == kKnown.end())
        throw GltfFault{{ErrorCode::kInvalidInput, "it needs the glTF extension " + text.substr(0, 64) +
                                                       ", which is not read; export the scene without it"}};
    }
    for (const Json& name : array_member(in_, "extensionsUsed"))
      if (name.is_string() &&
          std::find(kMissed.begin(), kMissed.end(), name.get<std::string>()) != kMissed.end()) {
        notes_.lose("extension " + name.get<std::string>());
        warn("extension-ignored", "the glTF extension " + name.get<std::string>() +
                                      " is not read; shape or colors may differ from what is meant");
      }
    out_["asset"] = {{"version", "2.0"}};
  }

  /// The index of a picture in the new file; nothing if it cannot be had.
  std::optional<std::size_t> add_image(std::size_t source) {
    const auto known = images_.find(source);
    if (known != images_.end()) return known->second;
    const Json& image = array_member(in_, "images")[source];
    const std::string where = numbered("image", source);
    Json written = {{"mimeType", "image/png"}};  // the content decides
    if (const Json* uri = member(image, "uri")) {
      if (!uri->is_string()) gltf_fault(where, "has a URI that is no text");
      const std::string& text = uri->get_ref<const std::string&>();
      Result<std::vector<std::byte>> bytes = Error{ErrorCode::kInvalidInput, "its data URI is damaged"};
      if (!text.starts_with("data:")) {
        bytes = read_(text);
      } else if (auto decoded = decode_data_uri(text)) {
        bytes = std::move(*decoded);
      }
      if (!bytes) {
        if (bytes.error().code == ErrorCode::kCancelled) throw GltfFault{bytes.error()};
        warn("texture-missing", "the picture " + (text.starts_with("data:") ? where : text.substr(0, 200)) +
                                    " is left out: " + bytes.error().message);
        return images_[source] = std::nullopt;
      }
      written["bufferView"] = data_->add_view(*bytes);
    } else {
      const auto view = index_member(image, where, "bufferView", data_->view_count());
      if (!view) gltf_fault(where, "has neither a URI nor a buffer view");
      written["bufferView"] = *view;
    }
    out_["images"].push_back(std::move(written));
    return images_[source] = out_["images"].size() - 1;
  }

  /// Wrap modes of a texture's sampler, as a sampler of its own.
  Json wraps(const Json& texture, const std::string& where) {
    Json written = Json::object();
    const Json& samplers = array_member(in_, "samplers");
    const auto sampler = index_member(texture, where, "sampler", samplers.size());
    for (const char* key : {"wrapS", "wrapT"}) {
      if (!sampler) break;
      const auto wrap = whole_member(samplers[*sampler], numbered("sampler", *sampler), key);
      if (!wrap) continue;
      if (*wrap != 33071 && *wrap != 33648 && *wrap != 10497)
        gltf_fault(numbered("sampler", *sampler), std::string("has an unknown ") + key);
      written[key] = *wrap;
    }
    return written;
  }

  void add_texture(const Json& info, const std::string& where, Json& written) {
    const Json& textures = array_member(in_, "textures");
    const auto index = index_member(info, where, "index", textures.size());
    if (!index) gltf_fault(where, "has a baseColorTexture without index");
    const std::string texture_where = numbered("texture", *index);
    const auto source =
        index_member(textures[*index], texture_where, "source", array_member(in_, "images").size());
    if (!source) {
      warn("texture-missing", texture_where + " has no picture of a kind that is read");
      return;
    }
    const auto image = add_image(*source);
    if (!image) return;
    std::uint64_t set = whole_member(info, where, "texCoord", 1000).value_or(0);
    Json entry = {{"index", out_["textures"].size()}};
    if (const Json* extensions = member(info, "extensions")) {
      if (const Json* transform = member(*extensions, kTransform)) {
        Json& own = entry["extensions"][kTransform] = Json::object();
        for (const char* key : {"offset", "scale"})
          if (auto pair = numbers_member(*transform, where, key, 2)) own[key] = std::move(*pair);
        if (const Json* rotation = member(*transform, "rotation")) {
          if (!rotation->is_number()) gltf_fault(where, "has a rotation that is no number");
          own["rotation"] = rotation->get<double>();
        }
        set = whole_member(*transform, where, "texCoord", 1000).value_or(set);
      }
    }
    entry["texCoord"] = set;
    out_["samplers"].push_back(wraps(textures[*index], texture_where));
    out_["textures"].push_back({{"source", *image}, {"sampler", out_["samplers"].size() - 1}});
    written["baseColorTexture"] = std::move(entry);
  }

  void add_materials() {
    const Json& materials = array_member(in_, "materials");
    for (std::size_t i = 0; i < materials.size(); ++i) {
      const std::string where = numbered("material", i);
      note_material_losses(materials[i], notes_);
      Json written = Json::object();
      if (const Json* pbr = member(materials[i], "pbrMetallicRoughness")) {
        if (auto factor = numbers_member(*pbr, where, "baseColorFactor", 4))
          written["baseColorFactor"] = std::move(*factor);
        if (const Json* info = member(*pbr, "baseColorTexture")) add_texture(*info, where, written);
      }
      out_["materials"].push_back({{"pbrMetallicRoughness", std::move(written)}});
    }
  }

  /// Whether an attribute is taken; its accessor must then be of a type that it may have.
  bool check_attribute(const std::string& name, const GltfData::Accessor& accessor,
                       const std::string& where) {
    bool good = true;
    if (name == "POSITION")
      good = is_type(accessor, {"VEC3"}, {5120, 5121, 5122, 5123, 5126});
    else if (name == "COLOR_0")
      good = is_type(accessor, {"VEC3", "VEC4"}, {5121, 5123, 5126});
    else if (name.starts_with("TEXCOORD_"))
      good = is_type(accessor, {"VEC2"}, {5120, 5121, 5122, 5123, 5126});
    else
      return false;
    if (!good) gltf_fault(where, "has an accessor of the wrong type for " + name.substr(0, 32));
    return true;
  }

  /// Attributes of a primitive, as indices below `count`.
  Json attributes(const Json& from, const std::string& where, std::size_t count, bool accessors) {
    Json written = Json::object();
    const Json* found = member(from, "attributes");
    if (!found || !found->is_object()) gltf_fault(where, "has no attributes");
    for (const auto& [name, value] : found->items()) {
      if (count == 0) gltf_fault(where, "has attributes, but there are no accessors");
      const std::uint64_t index = whole(value, where, "attribute", count - 1);
      if (accessors ? check_attribute(name, data_->accessors()[index], where)
                    : name == "POSITION" || name == "COLOR_0" || name.starts_with("TEXCOORD_"))
        written[name] = index;
    }
    return written;
  }

  void add_primitive(const Json& primitive, const std::string& where, Json& list) {
    const std::uint64_t mode = whole_member(primitive, where, "mode", 6).value_or(4);
    const Json* targets = member(primitive, "targets");
    deformed_ += targets != nullptr;
    if (mode < 4) {
      notes_.lose("lines and points");
      ++lines_;
      return;
    }
    const auto& accessors = data_->accessors();
    Json written = {{"mode", mode}, {"attributes", attributes(primitive, where, accessors.size(), true)}};
    std::string used_set;
    if (const auto material =
            index_member(primitive, where, "material", array_member(in_, "materials").size())) {
      written["material"] = *material;
      const Json& pbr = out_["materials"][*material]["pbrMetallicRoughness"];
      if (pbr.contains("baseColorTexture"))
        used_set = "TEXCOORD_" + std::to_string(pbr["baseColorTexture"]["texCoord"].get<std::uint64_t>());
    }
    note_attribute_losses(primitive, used_set, notes_);
    const Json* extensions = member(primitive, "extensions");
    const Json* draco = extensions ? member(*extensions, kDraco) : nullptr;
    if (!written["attributes"].contains("POSITION")) {
      warn("primitives-skipped", where + " has no positions, and is left out");
      return;
    }
    if (draco) {
      const auto view = index_member(*draco, where, "bufferView", data_->view_count());
      if (!view || mode == 6) gltf_fault(where, "is compressed by Draco, but has no buffer view or is a fan");
      Json own = attributes(*draco, where, 0x7fff'ffff, false);
      if (!own.contains("POSITION")) gltf_fault(where, "is compressed by Draco without positions");
      // What is compressed replaces accessors; tinygltf must not look for their data.
      written["extensions"][kDraco] = {{"bufferView", *view}, {"attributes", std::move(own)}};
    } else {
      check_counts(primitive, where, written);
    }
    list.push_back(std::move(written));
  }

  void check_counts(const Json& primitive, const std::string& where, Json& written) {
    const auto& accessors = data_->accessors();
    const std::uint64_t count = accessors[written["attributes"]["POSITION"].get<std::size_t>()].count;
    for (const auto& [name, index] : written["attributes"].items()) {
      const GltfData::Accessor& accessor = accessors[index.get<std::size_t>()];
      if (accessor.count != count) gltf_fault(where, "has attributes of different lengths");
      if (!accessor.has_data) gltf_fault(where, "has an attribute without data");
    }
    const auto indices = index_member(primitive, where, "indices", accessors.size());
    if (!indices) return;
    const GltfData::Accessor& accessor = accessors[*indices];
    if (!is_type(accessor, {"SCALAR"}, {5121, 5123, 5125}) || !accessor.has_data)
      gltf_fault(where, "has indices of the wrong type or without data");
    written["indices"] = *indices;
  }

  void add_meshes() {
    const Json& meshes = array_member(in_, "meshes");
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      Json list = Json::array();
      const Json& primitives = array_member(meshes[i], "primitives");
      for (std::size_t k = 0; k < primitives.size(); ++k)
        add_primitive(primitives[k], numbered("primitive", k) + " of mesh " + std::to_string(i), list);
      out_["meshes"].push_back({{"primitives", std::move(list)}});
    }
  }

  /// Where a node's mesh stands how often: attributes that have an entry for each of the places.
  Json instances(const Json& extension, const std::string& where) {
    const Json* found = member(extension, "attributes");
    if (!found || !found->is_object() || found->empty())
      gltf_fault(where, "has instances without attributes");
    const auto& accessors = data_->accessors();
    if (accessors.empty()) gltf_fault(where, "has instances, but there are no accessors");
    Json written = Json::object();
    std::optional<std::uint64_t> count;
    for (const auto& [name, value] : found->items()) {
      const std::uint64_t index = whole(value, where, "attribute", accessors.size() - 1);
      const GltfData::Accessor& accessor = accessors[index];
      bool good = true, used = true;
      if (name == "TRANSLATION" || name == "SCALE")
        good = is_type(accessor, {"VEC3"}, {5126});
      else if (name == "ROTATION")
        good = is_type(accessor, {"VEC4"}, {5126}) ||
               (is_type(accessor, {"VEC4"}, {5120, 5122}) && accessor.normalized);
      else if (name == "_COLOR_0")
        good = is_type(accessor, {"VEC3", "VEC4"}, {5121, 5123, 5126});
      else
        used = false;  // a program's own, but it says how many there are
      if (!used) notes_.lose("other attributes of instances");
      if (!good) gltf_fault(where, "has an accessor of the wrong type for " + name + " of its instances");
      if (used && !accessor.has_data) gltf_fault(where, "has instances with a " + name + " without data");
      if (count.value_or(accessor.count) != accessor.count)
        gltf_fault(where, "has attributes of instances of different lengths");
      count = accessor.count;
      written[name] = index;
    }
    return {{"attributes", std::move(written)}};
  }

  void add_nodes() {
    const Json& nodes = array_member(in_, "nodes");
    const std::size_t meshes = array_member(in_, "meshes").size();
    std::vector<bool> has_parent(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const std::string where = numbered("node", i);
      Json written = Json::object();
      if (auto matrix = numbers_member(nodes[i], where, "matrix", 16)) written["matrix"] = std::move(*matrix);
      for (const auto& [key, count] : {std::pair{"translation", 3}, {"rotation", 4}, {"scale", 3}})
        if (auto numbers = numbers_member(nodes[i], where, key, std::size_t(count)))
          written[key] = std::move(*numbers);
      if (const auto mesh = index_member(nodes[i], where, "mesh", meshes)) written["mesh"] = *mesh;
      deformed_ += member(nodes[i], "skin") != nullptr;
      if (const Json* extensions = member(nodes[i], "extensions"))
        if (const Json* instancing = member(*extensions, kInstancing))
          written["extensions"][kInstancing] = instances(*instancing, where);
      for (const Json& child : array_member(nodes[i], "children")) {
        const std::size_t c = std::size_t(whole(child, where, "child", nodes.size() - 1));
        if (has_parent[c]) gltf_fault(numbered("node", c), "is the child of two");
        has_parent[c] = true;
        written["children"].push_back(c);
      }
      out_["nodes"].push_back(std::move(written));
    }
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (!has_parent[i]) roots_.push_back(i);
    if (!nodes.empty()) return;
    for (std::size_t i = 0; i < meshes; ++i) {  // a library of meshes: each as it is
      out_["nodes"].push_back({{"mesh", i}});
      roots_.push_back(i);
    }
  }

  /// Only what has no parent is a root, so that all is a tree and nothing is met twice.
  void add_scene() {
    const Json& scenes = array_member(in_, "scenes");
    const std::size_t nodes = array_member(in_, "nodes").size();
    std::vector<std::size_t> shown = roots_;
    if (!scenes.empty()) {
      const std::size_t scene = index_member(in_, "the file", "scene", scenes.size()).value_or(0);
      const std::string where = numbered("scene", scene);
      std::set<std::size_t> own;
      for (const Json& node : array_member(scenes[scene], "nodes")) {
        if (nodes == 0) gltf_fault(where, "names nodes, of which there are none");
        const std::size_t n = std::size_t(whole(node, where, "node", nodes - 1));
        if (!std::binary_search(roots_.begin(), roots_.end(), n))
          gltf_fault(where, "names node " + std::to_string(n) + ", which is the child of another");
        own.insert(n);
      }
      shown.assign(own.begin(), own.end());
      if (scenes.size() > 1)
        warn("scenes-skipped",
             "scene " + std::to_string(scene) + " of " + std::to_string(scenes.size()) + " was read");
    }
    out_["scenes"] = Json::array({{{"nodes", shown}}});
    out_["scene"] = 0;
  }

  const Json& in_;
  const ResourceReader& read_;
  std::vector<MeshWarning>& warnings_;
  ReadNotes& notes_;
  std::optional<GltfData> data_;
  Json out_ = {{"images", Json::array()},    {"textures", Json::array()}, {"samplers", Json::array()},
               {"materials", Json::array()}, {"meshes", Json::array()},   {"nodes", Json::array()}};
  std::map<std::size_t, std::optional<std::size_t>> images_;  ///< new index by old
  std::vector<std::size_t> roots_;                            ///< ascending
  std::uint64_t lines_ = 0, deformed_ = 0;
};

}  // namespace

Result<std::vector<std::byte>> normalize_gltf(std::string_view json, std::span<const std::byte> binary,
                                              const ResourceReader& read, std::vector<MeshWarning>& warnings,
                                              ReadNotes& notes) {
  if (json.size() > kMaxJsonBytes)
    return Error{ErrorCode::kLimit, "its JSON has more than " + std::to_string(kMaxJsonBytes >> 20) +
                                        " MiB; save the scene with its data in a file of its own, or as GLB"};
  if (json.starts_with("\xef\xbb\xbf")) json.remove_prefix(3);
  if (!is_shallow(json))
    return Error{ErrorCode::kInvalidInput, "its JSON has values in each other more than " +
                                               std::to_string(kMaxDepth) +
                                               " deep, so it is damaged; export the scene again"};
  try {
    const Json in = Json::parse(json.begin(), json.end(), nullptr, false);
    if (!in.is_object())
      return Error{ErrorCode::kInvalidInput, "its JSON is damaged; fetch or export the scene again"};
    return Normalizer(in, binary, read, warnings, notes).glb();
  } catch (const GltfFault& fault) {
    return fault.error;
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimit, "there is not enough memory to read the scene; use a smaller one"};
  } catch (const Json::exception& exception) {
    return Error{ErrorCode::kInvalidInput,
                 std::string("its JSON cannot be understood (") + exception.what() + "); export it again"};
  }
}

}  // namespace mesocell
