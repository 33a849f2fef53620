#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/structure/structure_rules.h"
#include "tests/support/catch.h"

using namespace mesocell::test;
namespace fs = std::filesystem;

namespace {

std::string read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Calls `visit(path from the root, text)` for every C++ file of the project.
template <typename Visit>
std::size_t for_each_source(Visit visit) {
  const fs::path root = MESOCELL_SOURCE_DIR;
  std::size_t count = 0;
  for (const char* folder : {"format", "sdk", "converters", "tests", "samples"}) {
    if (!fs::exists(root / folder)) continue;
    for (auto it = fs::recursive_directory_iterator(root / folder); it != fs::recursive_directory_iterator();
         ++it) {
      const fs::path& path = it->path();
      if (it->is_directory() && path == root / "samples" / "out") it.disable_recursion_pending();
      const std::string extension = path.extension().string();
      if (!it->is_regular_file() || (extension != ".h" && extension != ".cpp" && extension != ".c")) continue;
      visit(path.lexically_relative(root).generic_string(), read_text(path));
      ++count;
    }
  }
  return count;
}

std::size_t broken(const std::string& path, const std::string& text) {
  return broken_rules(path, text).size();
}

}  // namespace

TEST_CASE("every source keeps to the rules of the folders") {
  const std::size_t count = for_each_source([](const std::string& path, const std::string& text) {
    for (const std::string& rule : broken_rules(path, text)) FAIL_CHECK(rule);
  });
  CHECK(count > 50);
}

TEST_CASE("includes are named from the root and are there") {
  for_each_source([](const std::string& path, const std::string& text) {
    if (path.starts_with("format/loader/")) return;  // an engine takes its two files alone
    for (const std::string& name : quoted_includes(text))
      if (!fs::exists(fs::path(MESOCELL_SOURCE_DIR) / name)) FAIL_CHECK(path << " includes " << name);
  });
}

TEST_CASE("planted violations are caught") {
  CHECK(broken("format/container.cpp", "#include \"sdk/core/vec.h\"\n") == 1);
  CHECK(broken("sdk/core/ray.h", "#include \"sdk/tiles/tile_spec.h\"\n") == 1);
  CHECK(broken("sdk/tiles/a.cpp", "  #  include \"sdk/membership/membership.h\"\n") == 1);
  CHECK(broken("sdk/trace/a.cpp", "#include \"sdk/author/cell_object.h\"\n") == 1);
  CHECK(broken("sdk/trace/a.cpp", "#include \"sdk/shade/render.h\"\n") == 1);
  CHECK(broken("sdk/shade/a.cpp", "#include \"sdk/measure/a.h\"\n") == 1);
  CHECK(broken("sdk/author/a.cpp", "#include \"converters/import/mesh_file.h\"\n") == 1);
  CHECK(broken("converters/import/a.cpp", "#include \"converters/cli/console.h\"\n") == 1);
  CHECK(broken("converters/import/a.cpp", "#include \"mesh_file.h\"\n") == 1);
  CHECK(broken("converters/image/a.cpp", "#include \"converters/import/mesh_file.h\"\n") == 1);
  CHECK(broken("sdk/author/a.cpp", "#include <CGAL/Uncertain.h>\n") == 1);
  CHECK(broken("converters/cli/a.cpp", "#include <OpenMesh/Core/IO/IOManager.hh>\n") == 1);
  CHECK(broken("converters/image/image_file.cpp", "#include <OpenImageIO/imageio.h>\n") == 1);
  CHECK(broken("converters/cli/info.cpp", "#include <CLI/CLI.hpp>\n") == 1);
  CHECK(broken("sdk/core/a.cpp", "#include <zstd.h>\n") == 1);
  CHECK(broken("format/loader/mesocell_loader.cpp", "#include \"format/container.h\"\n") == 1);
  CHECK(broken("format/loader/mesocell_loader.cpp", "#include <boost/crc.hpp>\n#include <xxhash.h>\n") == 2);
  CHECK(broken("elsewhere/a.cpp", "") == 1);
  std::string text;
  for (int i = 0; i < 501; ++i) text += "\n";
  CHECK(broken("tests/a.cpp", text) == 1);
}

TEST_CASE("what the rules allow is not caught") {
  CHECK(broken("format/container.cpp", "#include <zstd.h>\n#include \"format/result.h\"\n") == 0);
  CHECK(broken("sdk/shade/a.cpp", "#include \"sdk/trace/caster.h\"\n") == 0);
  CHECK(broken("sdk/membership/a.cpp", "#include <CGAL/Uncertain.h>\n#include \"sdk/tiles/tile_spec.h\"\n") ==
        0);
  CHECK(broken("converters/cli/a.cpp",
               "#include \"converters/import/mesh_file.h\"\n#include <nlohmann/json.hpp>\n") == 0);
  CHECK(broken("format/loader/mesocell_loader.cpp",
               "#include \"mesocell_loader.h\"\n#include <cstring>\n#include <zstd.h>\n") == 0);
  CHECK(broken("tests/a.cpp", "#include \"converters/cli/console.h\"\n") == 0);
  CHECK(broken("sdk/core/a.cpp", "// #include <zstd.h>\n") == 0);
}
