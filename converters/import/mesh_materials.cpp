#include "converters/import/mesh_materials.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>

#include "converters/image/page_reader.h"
#include "converters/import/gltf_file.h"
#include "converters/import/mesh_message.h"
#include "converters/import/mesh_text.h"
#include "converters/import/mtl.h"
#include "converters/import/picture_file.h"
#include "converters/import/plain_file.h"
#include "converters/import/sniff.h"
#include "converters/import/volume_slices.h"

namespace mesocell {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxMtlBytes = std::uint64_t{1} << 28, kMaxPictureBytes = std::uint64_t{1} << 31;
/// Of a TIFF, whose first counts.
constexpr std::uint32_t kMaxPages = 1024;
constexpr std::size_t kMaxWarnings = 20;

/// Which channels are a picture's color. Of one with more than that, such as depths, those that are named so.
std::optional<ColorChannels> texture_channels(const PageHeader& header) {
  if (auto channels = color_channels(header)) return channels;
  const auto gray = std::find(header.channels.begin(), header.channels.end(), "Y");
  if (gray == header.channels.end()) return std::nullopt;
  const auto index = std::size_t(gray - header.channels.begin());
  return ColorChannels{true, {index, index, index}};
}

/// The first page of a picture that the worker does not know, by the image library.
Result<TextureImage> read_first_page(const std::string& path, const Progress* progress) {
  const Result<PictureFile> picture = examine_picture(
      path, {.max_file_bytes = kMaxPictureBytes, .max_pages = kMaxPages, .max_side = kMaxTextureSide});
  if (!picture) return picture.error();
  TextureImage texture;
  PageHeader page;
  ColorChannels channels;
  PageSink sink;
  sink.first_only = true;
  sink.begin = [&](const PageHeader& header) -> Status {
    const auto found = texture_channels(header);
    if (!found) return Error{ErrorCode::kInvalidInput, "it is neither gray nor RGB; save it as one of these"};
    if (header.width > kMaxTextureSide || header.height > kMaxTextureSide ||
        std::uint64_t{header.width} * header.height >
            3 * kMaxTexels / std::max<std::size_t>(header.channels.size(), 3))
      return Error{ErrorCode::kLimit, "it has " + std::to_string(header.width) + " x " +
                                          std::to_string(header.height) + " pixels of " +
                                          std::to_string(header.channels.size()) +
                                          " channels, more than are read for a mesh; use a smaller one"};
    if (progress && progress->cancelled()) return cancelled();
    page = header;
    channels = *found;
    return {};
  };
  sink.take = [&](std::uint32_t, PageSamples samples) -> Status {
    texture = {page.width, page.height, {}};
    texture.texels.reserve(std::size_t{page.width} * page.height);
    for (std::size_t i = 0; i < samples.size(); i += page.channels.size()) {
      Rgb8 texel{};
      for (std::size_t k = 0; k < 3; ++k) texel[k] = srgb8_of_sample(page, samples[i + channels.index[k]]);
      texture.texels.push_back(texel);
    }
    return {};
  };
  if (Status status = read_pages(path, picture->format, 1, sink); !status) return status.error();
  return texture;
}

/// Whatever its name, a picture is what it begins as.
Result<TextureImage> read_texture(const std::string& path, const Progress* progress) {
  const Result<std::vector<std::byte>> bytes = read_plain_file(path, kMaxPictureBytes);
  if (!bytes) return bytes.error();
  const std::string_view content =
      sniff_content({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  if (content == kExrContent || content == kHdrContent || content == kTiffContent)
    return read_first_page(path, progress);
  return decode_texture(*bytes, progress);
}

class MaterialReader {
 public:
  MaterialReader(const std::string& path, PlainMesh& mesh, std::vector<MeshWarning>& warnings,
                 ReadNotes& notes, const Progress* progress)
      : folder_(fs::path(path).parent_path()),
        mesh_(mesh),
        warnings_(warnings),
        notes_(notes),
        progress_(progress) {}

  Status read() {
    SurfacePaint& paint = mesh_.paint;
    std::map<std::string, MtlMaterial> found;
    for (const std::string& name : mesh_.material_files) read_mtl(name, found);
    const bool has_files = !mesh_.material_files.empty();
    bool any = false;
    for (const std::string& name : mesh_.materials) {
      if (progress_ && progress_->cancelled()) return cancelled();
      PaintMaterial material;
      if (mesh_.extension != "obj") {
        add_texture(name, material);
      } else if (const auto place = found.find(name); place != found.end()) {
        any = true;
        material.base_color = place->second.diffuse;
        if (!place->second.diffuse_map.empty()) add_texture(place->second.diffuse_map, material);
        if (place->second.has_alpha) notes_.lose("alpha");
        if (place->second.has_map_options) notes_.lose("options of pictures");
        if (place->second.has_more) notes_.lose("other properties of materials");
      } else if (has_files) {
        warn("material-missing", "the material " + name + " is in no file that the mesh names; it is white");
      }
      any = any || material.texture;
      paint.materials.push_back(material);
    }
    // Materials of which nothing is known color nothing.
    if (!any) paint = {std::move(paint.face_colors), {}, {}, {}, {}};
    return {};
  }

 private:
  void warn(const char* id, std::string text) {
    if (warnings_.size() < kMaxWarnings) warnings_.push_back({id, std::move(text)});
  }

  /// Where a file is that the mesh names; programs of another system write "\".
  [[nodiscard]] std::string place(std::string name) const {
    std::replace(name.begin(), name.end(), '\\', '/');
    name.erase(std::remove(name.begin(), name.end(), '\0'), name.end());
    fs::path path(name);
    if (path.is_absolute() || (name.size() > 1 && name[1] == ':')) path = path.filename();
    return (folder_ / path).string();
  }

  void read_mtl(const std::string& name, std::map<std::string, MtlMaterial>& found) {
    // One name with blanks, or several.
    std::vector<std::string> names = {name};
    std::error_code error;
    if (!fs::exists(place(name), error) && name.find(' ') != name.npos) {
      names.clear();
      std::string_view rest = name;
      for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest))
        names.emplace_back(word);
    }
    for (const std::string& file : names) {
      notes_.files.insert(place(file));
      const Result<std::vector<std::byte>> bytes = read_plain_file(place(file), kMaxMtlBytes);
      if (!bytes) {
        warn("material-missing", "the materials " + file + " cannot be read: " + bytes.error().message);
        continue;
      }
      for (MtlMaterial& material : parse_mtl({reinterpret_cast<const char*>(bytes->data()), bytes->size()})) {
        std::string key = material.name;
        found.try_emplace(std::move(key), std::move(material));
      }
    }
  }

  void add_texture(const std::string& name, PaintMaterial& material) {
    if (mesh_.paint.uvs.empty()) return;
    const auto [known, is_new] = images_.try_emplace(place(name));
    if (is_new) {
      notes_.files.insert(known->first);
      Result<TextureImage> image = read_texture(known->first, progress_);
      if (image && image->texels.size() > kMaxTexels - texels_)
        image = Error{ErrorCode::kLimit, "the pictures have too many pixels together; use smaller ones"};
      if (image) {
        texels_ += image->texels.size();
        known->second = std::uint32_t(mesh_.paint.images.size());
        mesh_.paint.images.push_back(std::move(*image));
      } else {
        warn("texture-missing", "the picture " + name + " is left out: " + image.error().message);
      }
    }
    if (known->second) material.texture = TextureUse{*known->second, {}, {}};
  }

  fs::path folder_;
  PlainMesh& mesh_;
  std::vector<MeshWarning>& warnings_;
  ReadNotes& notes_;
  const Progress* progress_;
  std::map<std::string, std::optional<std::uint32_t>> images_;  ///< by where they are
  std::uint64_t texels_ = 0;
};

}  // namespace

Status read_materials(const std::string& path, PlainMesh& mesh, std::vector<MeshWarning>& warnings,
                      ReadNotes& notes, const Progress* progress) {
  return MaterialReader(path, mesh, warnings, notes, progress).read();
}

Status use_texture(const std::string& picture, std::uint64_t triangles, SurfacePaint& paint,
                   const Progress* progress) {
  if (paint.uvs.empty() || paint.uvs.size() != triangles)
    return Error{ErrorCode::kUsage,
                 "the mesh has no texture coordinates, which say where in the picture a place is; "
                 "unwrap it in a mesh editor"};
  Result<TextureImage> image = read_texture(picture, progress);
  if (!image) {
    Error error = image.error();
    error.message = "the picture " + picture + ": " + error.message;
    return error;
  }
  paint.images.clear();
  paint.images.push_back(std::move(*image));
  PaintMaterial material;
  material.texture = TextureUse{0, {}, {}};
  paint.materials = {material};
  paint.material_indices.assign(std::size_t(triangles), 0);
  return {};
}

}  // namespace mesocell
