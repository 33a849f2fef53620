#include "format/mapped_file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "format/cell_object_io.h"
#include "format/file.h"
#include "format/validate.h"
#include "tests/faults/fault_child.h"
#include "tests/faults/open_files.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"
#include "tests/support/folder.h"

using namespace mesocell;
using namespace mesocell::test;
namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

namespace {

constexpr std::uint64_t kMost = std::uint64_t{1} << 30;

/// Of more than 60 pages.
CellObject large_object() {
  RandomObjectOptions options;
  options.resolution = {40, 40, 40};
  options.tiles = {4, 4, 4};
  options.cells = 50;
  options.maps = kAllMaps;
  return random_object(11, options);
}

std::size_t sum(std::span<const std::byte> bytes) {
  std::size_t total = 0;
  for (const std::byte byte : bytes) total += std::to_integer<std::size_t>(byte);
  return total;
}

MappedFile mapped(const std::string& path) {
  auto file = MappedFile::open(path, kMost);
  REQUIRE(file.ok());
  return std::move(*file);
}

}  // namespace

TEST_CASE("mapped file: it has the bytes of the file") {
  const Folder folder(in_memory());
  for (const std::size_t size : {1u, 4095u, 4096u, 4097u, 100000u}) {
    Bytes content(size);
    for (std::size_t i = 0; i < size; ++i) content[i] = std::byte(i * 13 >> 2);
    REQUIRE(write_file(folder / "a", content).ok());
    const MappedFile file = mapped(folder / "a");
    CHECK(std::ranges::equal(file.bytes(), content));
    CHECK(file.check().ok());
    CHECK(MappedFile::open(folder / "a", size).ok());
    CHECK(MappedFile::open(folder / "a", size - 1).error().code == ErrorCode::kLimit);
  }
}

TEST_CASE("mapped file: an empty file has no bytes, and growing is noticed") {
  const Folder folder(in_memory());
  REQUIRE(write_file(folder / "a", {}).ok());
  const MappedFile file = mapped(folder / "a");
  CHECK(file.bytes().empty());
  CHECK(file.check().ok());
  fs::resize_file(folder / "a", 10);
  CHECK(file.check().error().code == ErrorCode::kUnreadable);
}

TEST_CASE("mapped file: what is no file is refused at once") {
  const Folder folder(in_memory());
  REQUIRE(::mkfifo((folder / "pipe").c_str(), 0600) == 0);
  for (const std::string& path : {folder / "none", folder / "pipe", folder.path().string(),
                                  std::string("/dev/zero"), std::string("/dev/null"), std::string()}) {
    CAPTURE(path);
    CHECK(MappedFile::open(path, kMost).error().code == ErrorCode::kUnreadable);
  }
}

TEST_CASE("mapped file: what is cut off reads as zeros, ends as a typed error and is reported") {
  const Folder folder(in_memory());
  const CellObject object = large_object();
  const Bytes whole = encoded(object);
  REQUIRE(whole.size() > 200000);
  for (std::size_t left = 0; left <= whole.size(); left += 1 + whole.size() / 23) {
    CAPTURE(left);
    REQUIRE(write_file(folder / "a", whole).ok());
    const MappedFile file = mapped(folder / "a");
    CHECK(file.check().ok());
    fs::resize_file(folder / "a", left);
    const auto read = read_cell_object(file.bytes());
    REQUIRE(!read.ok());
    CHECK(read.error().code == ErrorCode::kInvalidInput);
    CHECK(!validate(file.bytes()).valid);
    const Status status = file.check();
    REQUIRE(!status.ok());
    CHECK(status.error().code == ErrorCode::kUnreadable);
    // Whole pages that are left are as they were, and nothing but zeros comes after.
    const std::size_t page = std::size_t(::sysconf(_SC_PAGESIZE));
    CHECK(std::ranges::equal(file.bytes().first(left), std::span(whole).first(left)));
    CHECK(sum(file.bytes().subspan(left)) == 0);
    // It stays an error when the file has its bytes again.
    if (file.bytes().size() > left + page) {
      fs::resize_file(folder / "a", whole.size());
      CHECK(!file.check().ok());
    }
  }
}

TEST_CASE("mapped file: a change is reported where no page was lost") {
  const Folder folder(in_memory());
  const Bytes content(10000, std::byte{1});
  REQUIRE(write_file(folder / "a", content).ok());
  {
    const MappedFile file = mapped(folder / "a");
    // Within the last page there is no signal.
    fs::resize_file(folder / "a", 9999);
    CHECK(file.bytes()[9999] == std::byte{0});
    CHECK(file.check().error().code == ErrorCode::kUnreadable);
  }
  REQUIRE(write_file(folder / "a", content).ok());
  {
    const MappedFile file = mapped(folder / "a");
    fs::last_write_time(folder / "a", fs::last_write_time(folder / "a") + std::chrono::seconds(1));
    CHECK(file.check().error().code == ErrorCode::kUnreadable);
  }
}

TEST_CASE("mapped file: a file that is replaced stays whole") {
  const Folder folder(in_memory());
  const Bytes content(100000, std::byte{1});
  REQUIRE(write_file(folder / "a", content).ok());
  const MappedFile file = mapped(folder / "a");
  REQUIRE(write_file(folder / "a", Bytes(5, std::byte{2})).ok());
  fs::remove(folder / "a");
  CHECK(std::ranges::equal(file.bytes(), content));
  CHECK(file.check().ok());
}

TEST_CASE("mapped file: moving keeps the bytes, also those that are lost later") {
  const Folder folder(in_memory());
  REQUIRE(write_file(folder / "a", Bytes(50000, std::byte{1})).ok());
  REQUIRE(write_file(folder / "b", Bytes(70000, std::byte{2})).ok());
  const std::size_t files = open_files();
  {
    MappedFile a = mapped(folder / "a");
    const std::byte* const data = a.bytes().data();
    MappedFile moved = std::move(a);
    CHECK(moved.bytes().data() == data);
    MappedFile b = mapped(folder / "b");
    b = std::move(moved);
    CHECK(b.bytes().data() == data);
    CHECK(open_files() == files + 1);
    fs::resize_file(folder / "a", 0);
    CHECK(sum(b.bytes()) == 0);
    CHECK(!b.check().ok());
  }
  CHECK(open_files() == files);
}

TEST_CASE("mapped file: a thousand times opened and closed, and a thousand at once") {
  const Folder folder(in_memory());
  REQUIRE(write_file(folder / "a", Bytes(10000, std::byte{3})).ok());
  const std::size_t files = open_files();
  for (int i = 0; i < 1000; ++i) {
    const MappedFile file = mapped(folder / "a");
    REQUIRE(file.bytes()[9999] == std::byte{3});
  }
  CHECK(open_files() == files);
  std::vector<MappedFile> many;
  for (;;) {
    auto file = MappedFile::open(folder / "a", kMost);
    if (!file) {
      // As many as are allowed, unless descriptors end before.
      const bool slots = file.error().code == ErrorCode::kLimit && many.size() == 1024;
      CHECK((slots || file.error().message.find("Too many open files") != std::string::npos));
      break;
    }
    many.push_back(std::move(*file));
  }
  CHECK(many.size() > 200);
  fs::resize_file(folder / "a", 0);
  for (const MappedFile& file : many) {
    REQUIRE(sum(file.bytes()) == 0);
    REQUIRE(!file.check().ok());
  }
  many.clear();
  CHECK(open_files() == files);
  CHECK(MappedFile::open(folder / "a", kMost)->check().ok());
}

TEST_CASE("mapped file: many threads read files that are cut off meanwhile") {
  const Folder folder(in_memory());
  const CellObject object = large_object();
  const Bytes whole = encoded(object);
  for (int round = 0; round < 20; ++round) {
    const std::string path = folder / "a";
    REQUIRE(write_file(path, whole).ok());
    const MappedFile shared = mapped(path);
    std::atomic<int> whole_reads{0}, errors{0}, wrong{0};
    std::atomic<bool> started{false};
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i)
      threads.emplace_back([&, i] {
        const auto own = MappedFile::open(path, kMost);
        started = true;
        if (!own) {
          ++wrong;
          return;
        }
        const MappedFile& file = i % 2 == 0 ? shared : *own;
        const auto read = read_cell_object(file.bytes());
        const bool checked = file.check().ok();
        if (read.ok() && *read == object)
          ++whole_reads;
        else if (!read.ok() && !checked)
          ++errors;
        else if (i % 2 == 0 || file.bytes().size() == whole.size())
          ++wrong;  // whatever was read, the check has to tell
      });
    while (!started) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::microseconds(round * 200));
    fs::resize_file(path, whole.size() / unsigned(2 + round % 5));
    for (std::thread& thread : threads) thread.join();
    CHECK(wrong == 0);
    CHECK(!shared.check().ok());
  }
}

TEST_CASE("mapped file: what is not its memory kills as before, or reaches the handler that was there") {
  const Folder folder(in_memory());
  const std::string path = folder.path().string();
  const auto end = [&](const char* previous) { return run_child({"foreign-fault", path, previous}); };
  for (const char* handled : {"siginfo", "plain", "later", "ignored-sent"}) {
    const ChildEnd ended = end(handled);
    INFO(handled << ": " << ended.err);
    CHECK(ended.exit == 0);
  }
  for (const char* killed : {"default", "ignored", "once", "sent"}) {
    const ChildEnd ended = end(killed);
    INFO(killed << ": " << ended.err);
    CHECK(ended.signal == SIGBUS);
  }
}
