#include "converters/mesh_worker/gltf_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "converters/import/fan.h"
#include "converters/import/mesh_message.h"
#include "converters/mesh_worker/gltf_accessor.h"
#include "converters/mesh_worker/texture_decoder.h"
#include "sdk/core/srgb.h"

namespace mesocell {
namespace {

constexpr std::uint64_t kMaxTriangles = std::uint64_t{1} << 28;
constexpr Rgb8 kWhite{255, 255, 255};

/// Places points: columns of the linear part, and where the origin goes.
struct Placement {
  std::array<Vec3, 3> axes{Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3 origin;

  [[nodiscard]] Vec3 turn(Vec3 p) const { return axes[0] * p.x + axes[1] * p.y + axes[2] * p.z; }
  [[nodiscard]] Vec3 apply(Vec3 p) const { return turn(p) + origin; }
  [[nodiscard]] bool mirrors() const { return dot(cross(axes[0], axes[1]), axes[2]) < 0; }

  /// [glTF 5.28: x, y, z, w]
  void rotate(double x, double y, double z, double w) {
    const double n = x * x + y * y + z * z + w * w, s = n > 0 ? 2 / n : 0;
    axes[0] = {1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)};
    axes[1] = {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)};
    axes[2] = {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)};
  }
};

/// One of the places of a node's mesh, within the node [EXT_mesh_gpu_instancing].
struct Instance {
  Placement placement;
  std::optional<Vec3> tint;  ///< linear light
};

Placement operator*(const Placement& outer, const Placement& inner) {
  Placement product;
  for (std::size_t k = 0; k < 3; ++k) product.axes[k] = outer.turn(inner.axes[k]);
  product.origin = outer.apply(inner.origin);
  return product;
}

Placement placement_of(const tinygltf::Node& node) {
  Placement p;
  if (node.matrix.size() == 16) {
    const std::vector<double>& m = node.matrix;
    for (std::size_t k = 0; k < 3; ++k) p.axes[k] = {m[4 * k], m[4 * k + 1], m[4 * k + 2]};
    p.origin = {m[12], m[13], m[14]};
    return p;
  }
  if (node.rotation.size() == 4)
    p.rotate(node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3]);
  if (node.scale.size() == 3)
    for (std::size_t k = 0; k < 3; ++k) p.axes[k] = p.axes[k] * node.scale[k];
  if (node.translation.size() == 3)
    p.origin = {node.translation[0], node.translation[1], node.translation[2]};
  return p;
}

Error senseless(const std::string& why) {
  return {ErrorCode::kInvalidInput, "the scene cannot be understood (" + why + "); export it again"};
}

TextureWrap wrap_of(int mode) {
  return mode == 33071 ? TextureWrap::kClamp : mode == 33648 ? TextureWrap::kMirror : TextureWrap::kRepeat;
}

double number_of(const tinygltf::Value& value, double otherwise) {
  return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
}

std::array<double, 2> pair_of(const tinygltf::Value& value, std::array<double, 2> otherwise) {
  if (!value.IsArray() || value.ArrayLen() != 2) return otherwise;
  return {number_of(value.Get(0), otherwise[0]), number_of(value.Get(1), otherwise[1])};
}

/// Reads the materials; `sets`: which texture coordinates each of them wants.
void read_materials(const tinygltf::Model& model, SurfacePaint& paint, std::vector<int>& sets) {
  for (const tinygltf::Material& source : model.materials) {
    PaintMaterial material;
    const auto& pbr = source.pbrMetallicRoughness;
    for (std::size_t k = 0; k < 3 && k < pbr.baseColorFactor.size(); ++k)
      material.base_color[k] = std::clamp(pbr.baseColorFactor[k], 0.0, 1.0);
    const tinygltf::TextureInfo& info = pbr.baseColorTexture;
    sets.push_back(info.texCoord);
    if (info.index >= 0 && std::size_t(info.index) < model.textures.size()) {
      const tinygltf::Texture& texture = model.textures[std::size_t(info.index)];
      const std::size_t image = texture.source >= 0 ? std::size_t(texture.source) : paint.images.size();
      if (image < paint.images.size() && !paint.images[image].texels.empty()) {
        TextureUse use;
        use.image = std::uint32_t(image);
        if (texture.sampler >= 0 && std::size_t(texture.sampler) < model.samplers.size()) {
          const tinygltf::Sampler& sampler = model.samplers[std::size_t(texture.sampler)];
          use.wrap = {wrap_of(sampler.wrapS), wrap_of(sampler.wrapT)};
        }
        const auto transform = info.extensions.find("KHR_texture_transform");
        if (transform != info.extensions.end()) {
          use.transform.offset = pair_of(transform->second.Get("offset"), {0, 0});
          use.transform.scale = pair_of(transform->second.Get("scale"), {1, 1});
          use.transform.rotation = number_of(transform->second.Get("rotation"), 0);
        }
        material.texture = use;
      }
    }
    paint.materials.push_back(std::move(material));
  }
}

/// Pictures that cannot be decoded are left without texels; tinygltf goes on.
struct Pictures {
  std::vector<TextureImage> images;
  std::vector<MeshWarning> warnings;
  std::uint64_t texels = 0;
};

bool load_picture(tinygltf::Image*, const int index, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void* context) {
  Pictures& pictures = *static_cast<Pictures*>(context);
  if (pictures.images.size() <= std::size_t(index)) pictures.images.resize(std::size_t(index) + 1);
  Result<TextureImage> image = decode_picture(std::as_bytes(std::span(bytes, std::size_t(std::max(size, 0)))),
                                              kMaxTexels - pictures.texels);
  if (!image) {
    pictures.warnings.push_back(
        {"texture-missing", "image " + std::to_string(index) + " is left out: " + image.error().message});
    return true;
  }
  pictures.texels += image->texels.size();
  pictures.images[std::size_t(index)] = std::move(*image);
  return true;
}

/// Puts the primitives of a scene into one mesh.
class SceneMesh {
 public:
  SceneMesh(const tinygltf::Model& model, WorkerMesh& out) : model_(model), out_(out) {
    read_materials(model, out.painted.paint, sets_);
    // Pictures that were not decoded have no use left, but are counted.
    for (TextureImage& image : out.painted.paint.images)
      if (image.texels.empty()) image = {1, 1, {kWhite}};
    has_uvs_ = std::any_of(out.painted.paint.materials.begin(), out.painted.paint.materials.end(),
                           [](const PaintMaterial& m) { return m.texture.has_value(); });
  }

  /// Adds a node's mesh once, or wherever its instances are.
  Status add(const tinygltf::Node& node, const Placement& placement) {
    if (node.mesh < 0 || std::size_t(node.mesh) >= model_.meshes.size()) return {};
    const std::vector<tinygltf::Primitive>& primitives = model_.meshes[std::size_t(node.mesh)].primitives;
    std::vector<const GltfPrimitive*> read;
    std::uint64_t triangles = 0, vertices = 0;
    for (const tinygltf::Primitive& primitive : primitives) {
      const Result<const GltfPrimitive*> found = find(primitive);
      if (!found) return found.error();
      read.push_back(*found);
      triangles += read.back()->triangles.size();
      vertices += read.back()->positions.size();
    }
    const auto instancing = node.extensions.find("EXT_mesh_gpu_instancing");
    if (instancing == node.extensions.end()) {
      if (Status status = check_room(1, triangles, vertices); !status) return status;
      for (std::size_t i = 0; i < read.size(); ++i)
        if (Status status = place(primitives[i], *read[i], placement, nullptr); !status) return status;
      return {};
    }
    // Before memory is taken for the places.
    const tinygltf::Value& attributes = instancing->second.Get("attributes");
    const std::uint64_t count = instance_count(attributes);
    if (Status status = check_room(count, triangles, vertices); !status) return status;
    if (triangles == 0) return {};
    const Result<std::vector<Instance>> instances = read_instances(attributes, std::size_t(count));
    if (!instances) return instances.error();
    for (const Instance& instance : *instances)
      for (std::size_t i = 0; i < read.size(); ++i)
        if (Status status = place(primitives[i], *read[i], placement, &instance); !status) return status;
    return {};
  }

 private:
  /// A primitive, which several nodes may share.
  Result<const GltfPrimitive*> find(const tinygltf::Primitive& primitive) {
    const auto [known, is_new] = primitives_.try_emplace(&primitive);
    if (is_new) {
      Result<GltfPrimitive> made = read_primitive(model_, primitive, texture_set(primitive));
      if (!made) return made.error();
      known->second = std::move(*made);
    }
    return &known->second;
  }

  /// Whether so many more can be added `count` times.
  [[nodiscard]] Status check_room(std::uint64_t count, std::uint64_t triangles,
                                  std::uint64_t vertices) const {
    const TriangleMesh& mesh = out_.painted.mesh;
    const auto fits = [count](std::uint64_t each, std::uint64_t there, std::uint64_t most) {
      return there <= most && (each == 0 || count <= (most - there) / each);
    };
    if (fits(triangles, mesh.triangles.size(), kMaxTriangles) &&
        fits(vertices, mesh.vertices.size(), kMaxMeshElements))
      return {};
    return Error{ErrorCode::kLimit, "the scene has more than " + std::to_string(kMaxTriangles) +
                                        " triangles or " + std::to_string(kMaxMeshElements) + " vertices" +
                                        (count > 1 ? " with all instances of its meshes" : "") +
                                        "; use a smaller one"};
  }

  /// As all attributes have it.
  [[nodiscard]] std::uint64_t instance_count(const tinygltf::Value& attributes) const {
    for (const std::string& name : attributes.IsObject() ? attributes.Keys() : std::vector<std::string>()) {
      const int index = attributes.Get(name).GetNumberAsInt();
      if (index >= 0 && std::size_t(index) < model_.accessors.size())
        return model_.accessors[std::size_t(index)].count;
    }
    return 0;
  }

  [[nodiscard]] Result<std::vector<Instance>> read_instances(const tinygltf::Value& attributes,
                                                             std::size_t count) const {
    std::vector<Instance> instances(count);
    // Scale comes last, as it goes to the axes that the rotation makes.
    for (const char* name : {"TRANSLATION", "ROTATION", "SCALE", "_COLOR_0"}) {
      if (!attributes.Has(name)) continue;
      const int index = attributes.Get(name).GetNumberAsInt();
      const Result<std::vector<GltfElement>> values = read_accessor(model_, index);
      if (!values) return values.error();
      if (values->size() != count) return senseless("attributes of instances have different lengths");
      const tinygltf::Accessor& accessor = model_.accessors[std::size_t(index)];
      const double full = accessor.normalized ? 1 : full_value(accessor.componentType);
      for (std::size_t i = 0; i < count; ++i) {
        const GltfElement& e = (*values)[i];
        Placement& placement = instances[i].placement;
        switch (name[0]) {
          case 'T':
            placement.origin = {e[0], e[1], e[2]};
            break;
          case 'R':
            placement.rotate(e[0], e[1], e[2], e[3]);
            break;
          case 'S':
            for (std::size_t k = 0; k < 3; ++k) placement.axes[k] = placement.axes[k] * e[k];
            break;
          default:
            instances[i].tint = Vec3{e[0], e[1], e[2]} / full;
        }
      }
    }
    return instances;
  }

  Status place(const tinygltf::Primitive& primitive, const GltfPrimitive& read, const Placement& placement,
               const Instance* instance) {
    TriangleMesh& mesh = out_.painted.mesh;
    SurfacePaint& paint = out_.painted.paint;
    const std::uint32_t first = std::uint32_t(mesh.vertices.size());
    for (const Vec3& p : read.positions) {
      // One after the other, so that what meets in the node's own numbers does so to the bit.
      const Vec3 placed = placement.apply(instance ? instance->placement.apply(p) : p);
      if (!is_finite(placed))
        return Error{ErrorCode::kInvalidInput,
                     "the scene has a vertex whose place is not finite (NaN or infinite); repair it"};
      mesh.vertices.push_back(placed);
    }
    const bool tinted = instance && instance->tint;
    const Vec3 tint = tinted ? *instance->tint : Vec3{1, 1, 1};
    if (tinted || !read.colors.empty() || !mesh.colors.empty()) {
      mesh.colors.resize(first, kWhite);
      for (const Vec3& c : read.colors)
        mesh.colors.push_back(linear_to_srgb8(Vec3{c.x * tint.x, c.y * tint.y, c.z * tint.z}));
      mesh.colors.resize(mesh.vertices.size(), linear_to_srgb8(tint));
    }

    const bool mirrors = placement.mirrors() != (instance && instance->placement.mirrors());
    out_.polygons += read.triangles.size();
    for (Triangle t : read.triangles) {
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
        ++out_.dropped_faces;
        continue;
      }
      if (mirrors) std::swap(t[1], t[2]);
      if (has_uvs_) {
        std::array<Uv, 3> uvs{};
        for (std::size_t k = 0; k < 3 && !read.uvs.empty(); ++k) uvs[k] = read.uvs[t[k]];
        paint.uvs.push_back(uvs);
      }
      if (!paint.materials.empty())
        paint.material_indices.push_back(primitive.material >= 0 &&
                                                 std::size_t(primitive.material) < paint.materials.size()
                                             ? std::uint32_t(primitive.material)
                                             : SurfacePaint::kNoMaterial);
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    return {};
  }

  /// Of its material's texture; -1 if it needs no texture coordinates.
  [[nodiscard]] int texture_set(const tinygltf::Primitive& primitive) const {
    const auto& materials = out_.painted.paint.materials;
    if (primitive.material < 0 || std::size_t(primitive.material) >= materials.size()) return -1;
    return materials[std::size_t(primitive.material)].texture ? sets_[std::size_t(primitive.material)] : -1;
  }

  const tinygltf::Model& model_;
  WorkerMesh& out_;
  std::vector<int> sets_;
  std::map<const tinygltf::Primitive*, GltfPrimitive> primitives_;  ///< nodes may share meshes
  bool has_uvs_ = false;
};

}  // namespace

Result<WorkerMesh> read_gltf_scene(std::span<const std::byte> glb) {
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  Pictures pictures;
  loader.SetImageLoader(load_picture, &pictures);
  std::string error, warning;
  if (!loader.LoadBinaryFromMemory(&model, &error, &warning,
                                   reinterpret_cast<const unsigned char*>(glb.data()), unsigned(glb.size())))
    return senseless(error.substr(0, 200));
  WorkerMesh out;
  out.warnings = std::move(pictures.warnings);
  out.painted.paint.images = std::move(pictures.images);
  SceneMesh scene(model, out);

  struct Visit {
    std::size_t node;
    Placement placement;
  };
  std::vector<Visit> open;
  if (model.scenes.size() != 1) return senseless("no scene");
  std::uint64_t visited = 0;
  for (auto root = model.scenes[0].nodes.rbegin(); root != model.scenes[0].nodes.rend(); ++root)
    open.push_back({std::size_t(*root), {}});
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    if (visit.node >= model.nodes.size() || ++visited > model.nodes.size())
      return senseless("nodes are no tree");
    const tinygltf::Node& node = model.nodes[visit.node];
    const Placement placement = visit.placement * placement_of(node);
    if (Status status = scene.add(node, placement); !status) return status.error();
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
      open.push_back({std::size_t(*child), placement});
  }
  return out;
}

}  // namespace mesocell
