#include <sys/stat.h>

#include <atomic>
#include <string>

#include "converters/import/mesh_file.h"
#include "sdk/core/rng.h"
#include "tests/import/mesh_bytes.h"
#include "tests/import/messages.h"
#include "tests/support/catch.h"
#include "tests/support/data.h"
#include "tests/support/shapes.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// What is promised of any bytes: a sound mesh, or an error with a text.
bool sound(const Result<TriangleMesh>& mesh) {
  if (!mesh) return !mesh.error().message.empty();
  for (const Triangle& t : mesh->triangles)
    for (const std::uint32_t v : t)
      if (v >= mesh->vertices.size() || !is_finite(mesh->vertices[v])) return false;
  return !mesh->triangles.empty() && (mesh->colors.empty() || mesh->colors.size() == mesh->vertices.size());
}

/// The error's message, with its code checked.
std::string refusal(const std::string& name, const std::string& bytes,
                    ErrorCode code = ErrorCode::kInvalidInput) {
  const TempFolder folder;
  const Result<TriangleMesh> mesh = read_mesh_file(folder.write(name, bytes));
  INFO(name << ": " << bytes.substr(0, 200));
  REQUIRE(!mesh.ok());
  CHECK(mesh.error().code == code);
  return mesh.error().message;
}

/// With colors where the format has them.
TriangleMesh colored_box() {
  TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  for (std::size_t i = 0; i < box.vertices.size(); ++i)
    box.colors.push_back({std::uint8_t(255 - i), std::uint8_t(20 * i), 7});
  return box;
}

std::string ply_header(const std::string& vertices, const std::string& faces) {
  return "ply\nformat binary_little_endian 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

}  // namespace

TEST_CASE("a file cut off anywhere is refused or read as far as it is sound") {
  const TempFolder folder;
  std::vector<MeshBytes> files = in_all_formats(make_box({0, 0, 0}, {1, 1, 1}));
  for (const MeshBytes& file : in_all_formats(colored_box())) files.push_back(file);
  for (const MeshBytes& file : files)
    for (std::size_t n = 0; n < file.bytes.size(); ++n) {
      const Result<TriangleMesh> mesh = read_mesh_file(folder.write(file.name, file.bytes.substr(0, n)));
      INFO(file.name << " cut to " << n << " bytes");
      CHECK(sound(mesh));
      // OBJ has no counts and text may end within a number; all others must notice.
      if (!file.name.ends_with("obj") && n + 20 < file.bytes.size()) CHECK(!mesh.ok());
    }
}

TEST_CASE("damaged files never crash, hang or give an unsound mesh") {
  static constexpr const char* kWords[] = {
      "-1", "4294967295", "99999999999999999999",        "nan",  "1e999", "//", "f ",
      "\n", "\\\n",       "element vertex 4000000000\n", "outer"};
  const TempFolder folder;
  Rng rng(7);
  std::size_t read = 0;
  for (int round = 0; round < 300; ++round)
    for (const MeshBytes& file :
         in_all_formats(round % 2 == 0 ? make_box({0, 0, 0}, {1, 1, 1}) : colored_box())) {
      std::string bytes = file.bytes;
      for (std::uint32_t k = 1 + rng.below(4); k > 0; --k) {
        const std::size_t at = rng.below(std::uint32_t(bytes.size()));
        switch (rng.below(4)) {
          case 0:
            bytes[at] = char(std::uint8_t(rng.below(256)));
            break;
          case 1:
            bytes[at] = char(std::uint8_t(bytes[at]) ^ (1u << rng.below(8)));
            break;
          case 2:
            bytes.insert(at, kWords[rng.below(11)]);
            break;
          default:
            bytes.erase(at, 1 + rng.below(8));
            break;
        }
      }
      const Result<TriangleMesh> mesh = read_mesh_file(folder.write(file.name, bytes));
      CHECK(sound(mesh));
      read += mesh.ok();
    }
  CHECK(read > 100);
  CHECK(read < 2000);
}

TEST_CASE("what is missing or no plain file is unreadable") {
  const TempFolder folder;
  const auto code = [&](const std::string& path) { return read_mesh_file(path).error().code; };
  CHECK(code(folder.file("missing.obj")) == ErrorCode::kUnreadable);
  REQUIRE(mkdir(folder.file("folder.obj").c_str(), 0700) == 0);
  CHECK(code(folder.file("folder.obj")) == ErrorCode::kUnreadable);
  // Nobody writes to it: opening it would wait for ever.
  REQUIRE(mkfifo(folder.file("pipe.obj").c_str(), 0600) == 0);
  CHECK(code(folder.file("pipe.obj")) == ErrorCode::kUnreadable);
}

TEST_CASE("a file that is not what its name says is called by its name") {
  for (const char* name : {"a.obj", "a.off", "a.ply", "a.stl"}) {
    CHECK(says(refusal(name, ""), "empty"));
    CHECK(says(refusal(name, "\x89PNG\r\n\x1a\n and more"), "PNG"));
    CHECK(says(refusal(name, std::string("glTF\2\0\0\0", 8)), "GLB"));
    CHECK(refusal(name, "Dear Sir or Madam,\n") != "");
    CHECK(refusal(name, std::string(5000, '\0')) != "");
  }
  CHECK(says(refusal("a.xyz", "1 2 3"), ".obj"));
}

TEST_CASE("counts beyond the end of the file are refused before memory is taken") {
  CHECK(says(refusal("a.off", "OFF\n4000000000 1 0\n0 0 0\n"), "4000000000"));
  CHECK(says(refusal("a.off", "OFF\n1 4000000000 0\n0 0 0\n"), "4000000000"));
  CHECK(says(refusal("a.off", "OFF\n-1 -1 0\n"), "cannot be read"));
  CHECK(says(refusal("a.off", "OFF\n3 1 0\n0 0 0\n0 1 0\n1 0 0\n4000000000 0 1 2\n"), "corners"));
  CHECK(says(refusal("a.ply", ply_header("4000000000", "0")), "4000000000"));
  CHECK(says(refusal("a.ply", ply_header("18446744073709551615", "0")), "header"));
  CHECK(says(refusal("a.ply", ply_header("0", "4000000000")), "4000000000"));
  CHECK(says(refusal("a.ply", ply_header("0", "1") + "\xff"), "longer"));
  CHECK(says(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"), "no end"));
  CHECK(says(refusal("a.ply", "ply\nformat ascii 1.0\nproperty float x\nend_header\n"), "line 3"));
  std::string stl = mesh_bytes(make_box({0, 0, 0}, {1, 1, 1}), "binary.stl");
  stl[80] = char(13);
  CHECK(says(refusal("a.stl", stl), "13 triangles"));
}

TEST_CASE("bad indices and meshes without triangles are refused") {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const char* face : {"f 1 2 4", "f 0 1 2", "f -1 -2 -4", "f 1 2 99999999999"})
    CHECK(says(refusal("a.obj", vertices + face), "line 4"));
  for (const char* face : {"f 1 2", "f a b c", "f /1 /2 /3"})
    CHECK(says(refusal("a.obj", vertices + face), "line 4"));
  CHECK(says(refusal("a.obj", "v 0 0\n"), "line 1"));
  CHECK(says(refusal("a.obj", "v 0 zero 0\n"), "line 1"));
  CHECK(says(refusal("a.obj", vertices), "no triangles"));
  CHECK(says(refusal("a.obj", vertices + "f 1 1 2"), "equal corners"));
  CHECK(says(refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "vertex 3"));
  CHECK(says(refusal("a.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"), "no triangles"));
  CHECK(says(refusal("a.off", "OFF BINARY\n"), "binary OFF"));
  CHECK(says(refusal("a.off", "4OFF\n1 0 0\n0 0 0 1\n"), "4OFF"));
  CHECK(says(refusal("a.ply", ply_header("1", "1") + std::string(12, '\0') +
                                  std::string("\3\0\0\0\0\1\0\0\0\0\0\0\0", 13)),
             "not there"));
  CHECK(says(refusal("a.ply", ply_header("0", "0")), "no triangles"));
  CHECK(says(refusal("a.stl", "solid x\nendsolid x\n"), "no triangles"));
  CHECK(says(refusal("a.stl", "solid x\nouter loop\nvertex 0 0 0\nendloop\n"), "three corners"));
  CHECK(says(refusal("a.stl", "solid x\nouter loop\nvertex 0 0 0\nendsolid\n"), "cut off"));
}

TEST_CASE("a file over the limit is refused, and reading can be cancelled") {
  const TempFolder folder;
  const std::string path = folder.write("a.obj", mesh_bytes(make_box({0, 0, 0}, {1, 1, 1}), "mesh.obj"));
  MeshReadOptions options;
  options.max_file_bytes = 64;
  CHECK(read_mesh_file(path, options).error().code == ErrorCode::kLimit);
  const std::atomic<bool> cancel = true;
  Progress progress;
  progress.cancel = &cancel;
  CHECK(read_mesh_file(path, {}, nullptr, &progress).error().code == ErrorCode::kCancelled);
}

TEST_CASE("damaged files from elsewhere") {
  const auto read = [](const char* name) -> std::optional<Result<TriangleMesh>> {
    const std::optional<std::string> path = find_data(std::string("corrupt/") + name);
    if (!path) return std::nullopt;
    return read_mesh_file(*path);
  };
  if (!read("truncated.ply")) {
    WARN("skipped: the test data are not there");
    return;
  }
  for (const char* name :
       {"corrupted_invalid_facet_vertex.off", "truncated.ply", "corrupted_invalid_triangle_count.stl"}) {
    INFO(name);
    const auto mesh = read(name);
    REQUIRE(mesh);
    REQUIRE(!mesh->ok());
    CHECK(mesh->error().code == ErrorCode::kInvalidInput);
  }
  const auto cube = read("wrongHeader.bin.stl");
  REQUIRE(cube);
  REQUIRE(cube->ok());
  CHECK((*cube)->triangles.size() == 12);
  CHECK((*cube)->vertices.size() == 8);
  const auto tetrahedron = read("notANumberNormal.ascii.stl");
  REQUIRE(tetrahedron);
  REQUIRE(tetrahedron->ok());
  CHECK((*tetrahedron)->triangles.size() == 4);
}
