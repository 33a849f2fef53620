#include "converters/export/gltf_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "converters/export/draco_encoder.h"
#include "converters/export/glb_file.h"
#include "sdk/core/srgb.h"

namespace mesocell {
namespace {

using Json = nlohmann::ordered_json;
using Lattice = std::array<std::int32_t, 3>;
using Color = std::array<std::uint16_t, 4>;

constexpr int kFloat = 5126, kUint16 = 5123, kUint32 = 5125;
constexpr int kVertices = 34962, kIndices = 34963;
/// Whole numbers to this are singles.
constexpr std::int64_t kMostWhole = std::int64_t{1} << 24;

std::uint16_t to_16_bits(double linear) { return std::uint16_t(std::lround(linear * 65535)); }

Color linear_color(const Rgb8& c) {
  return {to_16_bits(srgb_to_linear(c[0])), to_16_bits(srgb_to_linear(c[1])),
          to_16_bits(srgb_to_linear(c[2])), 65535};
}

struct Bounds {
  Lattice low, high;
};

Bounds bounds_of(const std::vector<Lattice>& points) {
  Bounds b{points.front(), points.front()};
  for (const Lattice& p : points)
    for (std::size_t a = 0; a < 3; ++a) {
      b.low[a] = std::min(b.low[a], p[a]);
      b.high[a] = std::max(b.high[a], p[a]);
    }
  return b;
}

/// The JSON of a file and what it refers to.
class Document {
 public:
  explicit Document(const GltfOptions& options) : options_(options) {}

  std::size_t add_accessor(Json accessor) {
    accessors_.push_back(std::move(accessor));
    return accessors_.size() - 1;
  }

  std::size_t add_material(const Rgb8& color) {
    Json material;
    Json& pbr = material["pbrMetallicRoughness"];
    if (color != Rgb8{255, 255, 255}) {
      const Vec3 linear = srgb_to_linear(color);
      pbr["baseColorFactor"] = {linear.x, linear.y, linear.z, 1.0};
    }
    pbr["metallicFactor"] = 0.0;
    materials_.push_back(std::move(material));
    return materials_.size() - 1;
  }

  /// Of points less `base`. `surface` lives until the file is written.
  Result<std::size_t> add_mesh(const ExplicitSurface& surface, const Lattice& base, std::size_t material) {
    const Bounds bounds = bounds_of(surface.vertices);
    Json low = Json::array(), high = Json::array();
    std::int64_t extent = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t from = std::int64_t{bounds.low[a]} - base[a],
                         to = std::int64_t{bounds.high[a]} - base[a];
      if (from < -kMostWhole || to > kMostWhole || to - from >= kMostWhole)
        return Error{
            ErrorCode::kLimit,
            "single precision, which glTF has, does not hold a surface of more than 2^24 voxels along "
            "an axis; write PLY, or take a box of tiles"};
      low.push_back(from);
      high.push_back(to);
      extent = std::max(extent, to - from);
    }
    Json primitive;
    std::uint64_t vertices = surface.vertices.size(), triangles = surface.triangle_count();
    DracoMesh compressed;
    if (options_.draco) {
      Result<DracoMesh> made = compress(surface, base, bounds, extent);
      if (!made) return made.error();
      compressed = std::move(*made);
      vertices = compressed.vertices;
      triangles = compressed.triangles;
    }
    const bool plain = !options_.draco;
    // The greatest index of a type means something else.
    const bool small = vertices < 65536;
    Json attributes;
    Json positions = accessor(kFloat, "VEC3", vertices);
    positions["min"] = std::move(low);
    positions["max"] = std::move(high);
    if (plain) positions["bufferView"] = add_positions(surface, base);
    attributes["POSITION"] = add_accessor(std::move(positions));
    if (!surface.normals.empty()) {
      Json normals = accessor(kFloat, "VEC3", vertices);
      if (plain) normals["bufferView"] = add_normals(surface);
      attributes["NORMAL"] = add_accessor(std::move(normals));
    }
    if (!surface.colors.empty()) {
      Json colors = accessor(kUint16, "VEC4", vertices);
      colors["normalized"] = true;
      if (plain) colors["bufferView"] = add_colors(surface);
      attributes["COLOR_0"] = add_accessor(std::move(colors));
    }
    Json indices = accessor(small ? kUint16 : kUint32, "SCALAR", 3 * triangles);
    if (plain) indices["bufferView"] = add_indices(surface, small);
    primitive["attributes"] = std::move(attributes);
    primitive["indices"] = add_accessor(std::move(indices));
    primitive["material"] = material;
    if (!plain) {
      Json& draco = primitive["extensions"]["KHR_draco_mesh_compression"];
      const std::uint64_t bytes = compressed.bytes.size();
      draco["bufferView"] =
          views_.add(bytes, 0, 0, [data = std::move(compressed.bytes)](FileStream& out) { out.bytes(data); });
      draco["attributes"]["POSITION"] = std::uint32_t{kDracoPosition};
      if (!surface.normals.empty()) draco["attributes"]["NORMAL"] = std::uint32_t{kDracoNormal};
      if (!surface.colors.empty()) draco["attributes"]["COLOR_0"] = std::uint32_t{kDracoColor};
      require("KHR_draco_mesh_compression");
    }
    Json mesh;
    mesh["primitives"].push_back(std::move(primitive));
    meshes_.push_back(std::move(mesh));
    return meshes_.size() - 1;
  }

  /// Three whole numbers an entry.
  std::size_t add_translations(std::vector<Lattice> places) {
    const Bounds bounds = bounds_of(places);
    Json translations = accessor(kFloat, "VEC3", places.size());
    translations["min"] = bounds.low;
    translations["max"] = bounds.high;
    const std::uint64_t bytes = 12 * std::uint64_t{places.size()};
    translations["bufferView"] = views_.add(bytes, 0, 0, [data = std::move(places)](FileStream& out) {
      for (const Lattice& p : data)
        for (const std::int32_t x : p) out.f32(float(x));
    });
    return add_accessor(std::move(translations));
  }

  /// `colors` live until the file is written.
  std::size_t add_instance_colors(const std::vector<Rgb8>& colors) {
    Json linear = accessor(kFloat, "VEC3", colors.size());
    linear["bufferView"] = views_.add(12 * std::uint64_t{colors.size()}, 0, 0, [&colors](FileStream& out) {
      for (const Rgb8& c : colors)
        for (const std::uint8_t channel : c) out.f32(float(srgb_to_linear(channel)));
    });
    return add_accessor(std::move(linear));
  }

  /// With its origin at a lattice point of a grid, in voxels.
  Json& add_node(const GridLayout& grid, const Lattice& origin, std::size_t mesh) {
    Json node;
    node["mesh"] = mesh;
    const Vec3 at = lattice_point(grid, origin);
    node["translation"] = {at.x, at.y, at.z};
    node["scale"] = {grid.voxel_edge, grid.voxel_edge, grid.voxel_edge};
    nodes_.push_back(std::move(node));
    return nodes_.back();
  }

  void require(const char* extension) {
    if (std::find(extensions_.begin(), extensions_.end(), extension) == extensions_.end())
      extensions_.push_back(extension);
  }

  [[nodiscard]] Status write(const std::string& path, std::uint64_t* file_bytes, const Progress* progress) {
    Json root;
    root["asset"] = {{"version", "2.0"}, {"generator", "Mesocell"}};
    if (!extensions_.empty()) root["extensionsUsed"] = root["extensionsRequired"] = extensions_;
    root["scene"] = 0;
    Json scene;
    for (std::size_t k = 0; k < nodes_.size(); ++k) scene["nodes"].push_back(k);
    root["scenes"].push_back(std::move(scene));
    root["nodes"] = std::move(nodes_);
    root["meshes"] = std::move(meshes_);
    root["materials"] = std::move(materials_);
    root["accessors"] = std::move(accessors_);
    for (const GlbViews::View& v : views_.views()) {
      Json view{{"buffer", 0}, {"byteOffset", v.offset}, {"byteLength", v.bytes}};
      if (v.stride) view["byteStride"] = v.stride;
      if (v.target) view["target"] = v.target;
      root["bufferViews"].push_back(std::move(view));
    }
    root["buffers"].push_back({{"byteLength", views_.size()}});
    return write_glb(path, root.dump(), views_, options_.no_clobber, file_bytes, progress);
  }

 private:
  static Json accessor(int component, const char* type, std::uint64_t count) {
    return {{"componentType", component}, {"count", count}, {"type", type}};
  }

  std::size_t add_positions(const ExplicitSurface& surface, const Lattice& base) {
    return views_.add(12 * std::uint64_t{surface.vertices.size()}, kVertices, 0,
                      [&surface, base](FileStream& out) {
                        for (const Lattice& p : surface.vertices)
                          for (std::size_t a = 0; a < 3; ++a) out.f32(float(p[a] - base[a]));
                      });
  }
  std::size_t add_normals(const ExplicitSurface& surface) {
    return views_.add(12 * std::uint64_t{surface.vertices.size()}, kVertices, 0, [&surface](FileStream& out) {
      for (const auto& n : surface.normals)
        for (const float x : n) out.f32(x);
    });
  }
  std::size_t add_colors(const ExplicitSurface& surface) {
    return views_.add(8 * std::uint64_t{surface.vertices.size()}, kVertices, 0, [&surface](FileStream& out) {
      for (const Rgb8& c : surface.colors)
        for (const std::uint16_t channel : linear_color(c)) out.u16(channel);
    });
  }
  std::size_t add_indices(const ExplicitSurface& surface, bool small) {
    return views_.add(surface.triangle_count() * (small ? 6 : 12), kIndices, 0,
                      [&surface, small](FileStream& out) {
                        for (std::uint64_t k = 0; k < surface.triangle_count(); ++k)
                          for (const std::uint32_t v : surface.triangle(k))
                            small ? out.u16(std::uint16_t(v)) : out.u32(v);
                      });
  }

  static Result<DracoMesh> compress(const ExplicitSurface& surface, const Lattice& base, const Bounds& bounds,
                                    std::int64_t extent) {
    DracoInput in;
    in.vertex_count = std::uint32_t(surface.vertices.size());
    in.triangle_count = surface.triangle_count();
    in.position = [&](std::uint32_t v) {
      const Lattice& p = surface.vertices[v];
      return std::array<float, 3>{float(p[0] - base[0]), float(p[1] - base[1]), float(p[2] - base[2])};
    };
    in.triangle = [&](std::uint64_t k) { return surface.triangle(k); };
    in.normals = surface.normals;
    std::vector<Color> colors;
    for (const Rgb8& c : surface.colors) colors.push_back(linear_color(c));
    in.colors = colors;
    // Steps of one voxel from the least point on, so that whole numbers are kept.
    in.position_bits = 1;
    while ((std::int64_t{1} << in.position_bits) - 1 < extent) ++in.position_bits;
    in.range = float((std::int64_t{1} << in.position_bits) - 1);
    for (std::size_t a = 0; a < 3; ++a) in.origin[a] = float(bounds.low[a] - base[a]);
    return encode_draco(in);
  }

  const GltfOptions& options_;
  GlbViews views_;
  Json nodes_ = Json::array(), meshes_ = Json::array(), materials_ = Json::array(),
       accessors_ = Json::array();
  std::vector<std::string> extensions_;
};

Error nothing_there() {
  return Error{ErrorCode::kLimit, "nothing is inside, and a glTF file cannot have a mesh without triangles"};
}

}  // namespace

Status write_gltf(const ExplicitSurface& surface, const GridLayout& grid, const std::string& path,
                  const GltfOptions& options, std::uint64_t* file_bytes, const Progress* progress) {
  if (surface.squares.empty()) return nothing_there();
  Document document(options);
  const Lattice base = bounds_of(surface.vertices).low;
  const Result<std::size_t> mesh = document.add_mesh(surface, base, document.add_material({255, 255, 255}));
  if (!mesh) return mesh.error();
  document.add_node(grid, base, *mesh);
  return document.write(path, file_bytes, progress);
}

Status write_instanced_gltf(const CellObject& object, const std::vector<ExplicitSurface>& surfaces,
                            const std::vector<CellInstances>& instances, const std::string& path,
                            const GltfOptions& options, std::uint64_t* file_bytes, const Progress* progress) {
  Document document(options);
  Lattice middle{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint64_t voxels = std::uint64_t{object.grid.tiles[a]} * object.tile.resolution[a];
    if (voxels > std::uint64_t(2 * kMostWhole))
      return Error{
          ErrorCode::kLimit,
          "single precision, which glTF has, does not hold places of more than 2^25 voxels along an axis; "
          "take an object of fewer tiles"};
    middle[a] = std::int32_t(object.grid.tiles[a] / 2 * object.tile.resolution[a]);
  }
  bool any = false;
  for (const CellInstances& of_cell : instances) {
    if (of_cell.homes.empty()) continue;
    if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
    any = true;
    Rgb8 color{255, 255, 255};
    if (options.cell_colors && object.cell_colors) color = object.cell_colors->colors[of_cell.cell - 1];
    const Result<std::size_t> mesh =
        document.add_mesh(surfaces[of_cell.cell - 1], {}, document.add_material(color));
    if (!mesh) return mesh.error();
    std::vector<Lattice> places;
    places.reserve(of_cell.homes.size());
    for (const Index3& home : of_cell.homes) {
      Lattice& place = places.emplace_back();
      for (std::size_t a = 0; a < 3; ++a)
        place[a] = std::int32_t(home[a] * object.tile.resolution[a]) - middle[a];
    }
    Json& node = document.add_node(object.grid, middle, *mesh);
    Json& attributes = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    attributes["TRANSLATION"] = document.add_translations(std::move(places));
    if (!of_cell.colors.empty()) attributes["_COLOR_0"] = document.add_instance_colors(of_cell.colors);
  }
  if (!any) return nothing_there();
  document.require("EXT_mesh_gpu_instancing");
  return document.write(path, file_bytes, progress);
}

}  // namespace mesocell
