#include "tests/structure/structure_rules.h"

#include <algorithm>
#include <array>

namespace mesocell::test {
namespace {

struct Include {
  bool quoted = false;
  std::string name;
};

std::vector<Include> includes(std::string_view text) {
  std::vector<Include> found;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    const auto skip_blanks = [&] {
      line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    };
    skip_blanks();
    if (!line.starts_with('#')) continue;
    line.remove_prefix(1);
    skip_blanks();
    if (!line.starts_with("include")) continue;
    line.remove_prefix(7);
    skip_blanks();
    if (line.empty() || (line[0] != '"' && line[0] != '<')) continue;
    const char close = line[0] == '"' ? '"' : '>';
    found.push_back({close == '"', std::string(line.substr(1, line.find(close, 1) - 1))});
  }
  return found;
}

/// A folder and those that it may include besides itself; the first row that fits a path counts.
struct Folder {
  std::string_view name;
  std::string_view may_include;  ///< folders, each followed by a blank
};

constexpr std::array<Folder, 21> kFolders = {{
    {"format/loader/", ""},
    {"format/", ""},
    {"sdk/core/", "format/ "},
    {"sdk/tiles/", "format/ sdk/core/ "},
    {"sdk/membership/", "format/ sdk/core/ sdk/tiles/ "},
    {"sdk/surface/", "format/ sdk/core/ sdk/tiles/ sdk/membership/ sdk/trace/ "},
    {"sdk/author/", "format/ sdk/core/ sdk/tiles/ sdk/membership/ sdk/surface/ "},
    {"sdk/wrap/", "format/ sdk/core/ "},
    {"sdk/trace/", "format/ sdk/core/ "},
    {"sdk/shade/", "format/ sdk/core/ sdk/trace/ "},
    {"sdk/measure/", "format/ sdk/core/ sdk/trace/ "},
    {"converters/image/", "format/ sdk/ "},
    {"converters/export/", "format/ sdk/ converters/image/ converters/import/ converters/worker/ "},
    {"converters/worker/", "format/ sdk/ converters/image/ "},
    {"converters/import/", "format/ sdk/ converters/image/ converters/worker/ "},
    {"converters/mesh_worker/", "format/ sdk/ converters/import/ converters/worker/ "},
    {"converters/vdb/", "format/ sdk/ converters/image/ converters/import/ converters/worker/ "},
    {"converters/stability/", "format/ sdk/ converters/image/ "},
    {"converters/bench/", "format/ sdk/ converters/image/ converters/stability/ "},
    {"converters/cli/", "format/ sdk/ converters/ "},
    {"samples/", "format/ sdk/ converters/ "},
}};

/// A third party and the folders or files that may include it; tests may include any.
struct ThirdParty {
  std::string_view prefix;
  std::string_view where;
};

constexpr std::array<ThirdParty, 16> kThirdParties = {{
    {"hwy/", "sdk/trace/packets.cpp sdk/trace/packet_ "},
    {"CGAL/", "sdk/membership/ sdk/wrap/ "},
    {"OpenMesh/", "converters/import/openmesh_reader.cpp "},
    {"OpenImageIO/", "converters/image/image_module.cpp "},
    {"openvdb/",
     "converters/stability/methods/openvdb_module.cpp converters/bench/peers/ converters/vdb/vdb_worker "},
    {"nanovdb/", "converters/bench/peers/nanovdb_mask.cpp "},
    {"embree3/", "converters/bench/peers/embree_module.cpp "},
    {"tbb/", "converters/stability/methods/openvdb_module.cpp "},
    {"CLI/",
     "converters/cli/command_line.cpp converters/cli/common_options.h converters/cli/convert_options. "},
    {"draco/", "converters/export/draco_ converters/mesh_worker/draco_mesh.cpp "},
    {"nlohmann/",
     "converters/cli/ converters/export/ converters/import/gltf_json.h "
     "converters/mesh_worker/gltf_library.cpp "},
    {"tiny_gltf", "converters/mesh_worker/gltf_library.cpp converters/mesh_worker/gltf_accessor.h "},
    {"stb/", "converters/mesh_worker/texture_decoder.cpp "},
    {"zstd", "format/ "},
    {"xxhash", "format/ "},
    {"boost/", "sdk/membership/ "},
}};

/// Whether one of the names in `list` begins `path`.
bool listed(std::string_view list, std::string_view path) {
  while (!list.empty()) {
    const std::size_t blank = list.find(' ');
    if (path.starts_with(list.substr(0, blank))) return true;
    list.remove_prefix(blank + 1);
  }
  return false;
}

const Folder* folder_of(std::string_view path) {
  for (const Folder& folder : kFolders)
    if (path.starts_with(folder.name)) return &folder;
  return nullptr;
}

void check_loader(const std::string& path, const Include& include, std::vector<std::string>& broken) {
  // Folders are a mark of anything that is neither std nor zstd.
  const bool own = include.quoted && include.name.ends_with("mesocell_loader.h");
  const bool third = !include.quoted && include.name.find('/') != std::string::npos;
  if ((include.quoted && !own) || third || include.name.starts_with("xxhash"))
    broken.push_back(path + ": the compact loader includes " + include.name);
}

}  // namespace

std::vector<std::string> quoted_includes(std::string_view text) {
  std::vector<std::string> names;
  for (const Include& include : includes(text))
    if (include.quoted) names.push_back(include.name);
  return names;
}

std::vector<std::string> broken_rules(const std::string& path, std::string_view text) {
  std::vector<std::string> broken;
  const auto lines = std::count(text.begin(), text.end(), '\n');
  // The compact loader is one source by its purpose, so that an engine takes two files.
  const int most = path.starts_with("format/loader/") ? 1000 : 500;
  if (lines > most)
    broken.push_back(path + ": has " + std::to_string(lines) + " lines, over " + std::to_string(most));
  if (path.starts_with("tests/")) return broken;
  const Folder* own = folder_of(path);
  if (!own) {
    broken.push_back(path + ": lies in no folder that the rules know");
    return broken;
  }
  for (const Include& include : includes(text)) {
    if (own->name == "format/loader/") {
      check_loader(path, include, broken);
      continue;
    }
    if (include.quoted) {
      const Folder* other = folder_of(include.name);
      if (!other || (other != own && !listed(own->may_include, include.name)) ||
          (other != own && other->name == "format/loader/" && own->name != "samples/"))
        broken.push_back(path + ": must not include " + include.name);
      continue;
    }
    for (const ThirdParty& party : kThirdParties)
      if (include.name.starts_with(party.prefix) && !listed(party.where, path))
        broken.push_back(path + ": must not see " + include.name);
  }
  return broken;
}

}  // namespace mesocell::test
