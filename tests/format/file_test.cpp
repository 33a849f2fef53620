#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "format/file.h"
#include "tests/format/test_file.h"
#include "tests/support/catch.h"
#include "tests/support/folder.h"

using namespace mesocell;
using namespace mesocell::test;
namespace fs = std::filesystem;

namespace {

Bytes bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

Bytes content(const std::string& path) {
  auto bytes = read_file(path, 1 << 20);
  REQUIRE(bytes.ok());
  return *bytes;
}

}  // namespace

TEST_CASE("file: reading says what is wrong") {
  const Folder folder;
  CHECK(read_file(folder / "none", 100).error().code == ErrorCode::kUnreadable);
  CHECK(read_file(folder.path().string(), 100).error().code == ErrorCode::kUnreadable);
  CHECK(read_file("", 100).error().code == ErrorCode::kUnreadable);
  REQUIRE(write_file(folder / "empty", {}).ok());
  CHECK(read_file(folder / "empty", 0)->empty());
  const Bytes bytes(100, std::byte{1});
  REQUIRE(write_file(folder / "hundred", bytes).ok());
  CHECK(*read_file(folder / "hundred", 100) == bytes);
  CHECK(read_file(folder / "hundred", 99).error().code == ErrorCode::kLimit);
  CHECK(read_file("/dev/zero", 3 << 20).error().code == ErrorCode::kLimit);
  if (::geteuid() != 0) {
    fs::permissions(folder / "hundred", fs::perms::none);
    CHECK(read_file(folder / "hundred", 100).error().code == ErrorCode::kUnreadable);
  }
}

TEST_CASE("file: a pipe is read to its end") {
  const Folder folder;
  REQUIRE(::mkfifo((folder / "pipe").c_str(), 0600) == 0);
  // Either side's open() waits for the other's.
  std::thread writer([name = folder / "pipe"] {
    std::ofstream out(name);
    out << std::string(100000, 'x');
  });
  const auto read = read_file(folder / "pipe", 1 << 20);
  writer.join();
  REQUIRE(read.ok());
  CHECK(*read == Bytes(100000, std::byte{'x'}));
}

TEST_CASE("file: an atomic file appears whole or not at all") {
  const Folder folder;
  const std::string target = folder / "a.meso";
  REQUIRE(write_file(target, bytes_of("old")).ok());
  {
    auto file = AtomicFile::create(target);
    REQUIRE(file.ok());
    CHECK(fs::path(file->temporary_path()).extension() == ".meso");
    CHECK(fs::path(file->temporary_path()).parent_path() == folder.path());
    REQUIRE(file->write(bytes_of("half")).ok());
    CHECK(folder.count() == 2);
    CHECK(content(target) == bytes_of("old"));
  }
  CHECK(folder.count() == 1);
  CHECK(content(target) == bytes_of("old"));

  auto file = AtomicFile::create(target);
  REQUIRE(file.ok());
  REQUIRE(file->write(bytes_of("new ")).ok());
  AtomicFile moved = std::move(*file);
  REQUIRE(moved.write(bytes_of("text")).ok());
  REQUIRE(moved.commit().ok());
  CHECK(content(target) == bytes_of("new text"));
  CHECK(folder.count() == 1);
}

TEST_CASE("file: a library may write by the temporary name, even put a new file there") {
  const Folder folder;
  auto file = AtomicFile::create(folder / "picture.png");
  REQUIRE(file.ok());
  fs::remove(file->temporary_path());
  std::ofstream(file->temporary_path()) << "pixels";
  REQUIRE(file->commit().ok());
  CHECK(content(folder / "picture.png") == bytes_of("pixels"));
  CHECK(folder.count() == 1);
}

TEST_CASE("file: a lost temporary is an error and leaves the target alone") {
  const Folder folder;
  REQUIRE(write_file(folder / "a", bytes_of("old")).ok());
  auto file = AtomicFile::create(folder / "a");
  REQUIRE(file.ok());
  fs::remove(file->temporary_path());
  CHECK(file->commit().error().code == ErrorCode::kOutput);
  CHECK(content(folder / "a") == bytes_of("old"));
  CHECK(folder.count() == 1);
}

TEST_CASE("file: no_clobber keeps what is there, also what came in between") {
  const Folder folder;
  REQUIRE(write_file(folder / "a", bytes_of("old"), true).ok());
  CHECK(write_file(folder / "a", bytes_of("new"), true).error().code == ErrorCode::kOutput);
  CHECK(content(folder / "a") == bytes_of("old"));

  auto file = AtomicFile::create(folder / "b", true);
  REQUIRE(file.ok());
  REQUIRE(file->write(bytes_of("mine")).ok());
  std::ofstream(folder / "b") << "theirs";
  CHECK(file->commit().error().code == ErrorCode::kOutput);
  CHECK(content(folder / "b") == bytes_of("theirs"));
  CHECK(folder.count() == 2);
}

TEST_CASE("file: targets that cannot be written are refused with nothing left") {
  const Folder folder;
  CHECK(AtomicFile::create("").error().code == ErrorCode::kOutput);
  CHECK(AtomicFile::create(folder / "none/a").error().code == ErrorCode::kOutput);
  CHECK(AtomicFile::create(folder.path().string()).error().code == ErrorCode::kOutput);
  CHECK(AtomicFile::create(folder / (std::string(5000, 'x'))).error().code == ErrorCode::kOutput);
  // Renaming over a device would replace it by a file.
  CHECK(AtomicFile::create("/dev/null").error().code == ErrorCode::kOutput);
  CHECK(fs::is_character_file("/dev/null"));
  REQUIRE(write_file(folder / "file", {}).ok());
  CHECK(AtomicFile::create(folder / "file/a").error().code == ErrorCode::kOutput);
  if (::geteuid() != 0) {
    fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
    CHECK(AtomicFile::create(folder / "a").error().code == ErrorCode::kOutput);
    fs::permissions(folder.path(), fs::perms::owner_all);
  }
  CHECK(folder.count() == 1);
}

TEST_CASE("file: a symbolic link stays and what it points to is replaced") {
  const Folder folder;
  fs::create_directory(folder / "sub");
  REQUIRE(write_file(folder / "sub/real.meso", bytes_of("old")).ok());
  fs::create_symlink("sub/real.meso", folder / "link.meso");
  REQUIRE(write_file(folder / "link.meso", bytes_of("new")).ok());
  CHECK(fs::is_symlink(folder / "link.meso"));
  CHECK(content(folder / "sub/real.meso") == bytes_of("new"));

  fs::create_symlink("sub/later.meso", folder / "dangling.meso");
  REQUIRE(write_file(folder / "dangling.meso", bytes_of("made")).ok());
  CHECK(content(folder / "sub/later.meso") == bytes_of("made"));

  fs::create_symlink("loop", folder / "loop");
  CHECK(write_file(folder / "loop", {}).error().code == ErrorCode::kOutput);
}

TEST_CASE("file: permissions of a replaced file stay") {
  const Folder folder;
  REQUIRE(write_file(folder / "a", {}).ok());
  fs::permissions(folder / "a", fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  REQUIRE(write_file(folder / "a", bytes_of("x")).ok());
  CHECK(fs::status(folder / "a").permissions() ==
        (fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read));
}

TEST_CASE("file: a process that is stopped can remove its temporary files") {
  const Folder folder;
  auto one = AtomicFile::create(folder / "one.meso");
  auto two = AtomicFile::create(folder / "two.png");
  REQUIRE((one.ok() && two.ok()));
  REQUIRE(write_file(folder / "done", bytes_of("x")).ok());
  CHECK(folder.count() == 3);
  remove_temporary_files();
  CHECK(folder.count() == 1);
  CHECK(content(folder / "done") == bytes_of("x"));
}

TEST_CASE("file: more files at once than can be watched is an error, and slots come back") {
  const Folder folder;
  for (int round = 0; round < 3; ++round) {
    std::vector<AtomicFile> files;
    for (int i = 0; i < 64; ++i) {
      auto file = AtomicFile::create(folder / std::to_string(i));
      REQUIRE(file.ok());
      files.push_back(std::move(*file));
    }
    CHECK(AtomicFile::create(folder / "x").error().code == ErrorCode::kOutput);
    for (std::size_t i = 0; i < 32; ++i) REQUIRE(files[i].commit().ok());
  }
  CHECK(folder.count() == 32);
}
