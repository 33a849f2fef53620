#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "format/file.h"
#include "sdk/core/rng.h"
#include "tests/faults/fault_child.h"
#include "tests/support/catch.h"
#include "tests/support/folder.h"

using namespace mesocell;
using namespace mesocell::test;
namespace fs = std::filesystem;

namespace {

void check_child(const std::vector<std::string>& arguments) {
  const ChildEnd end = run_child(arguments);
  if (end.exit == kChildNotPermitted) {
    WARN("this system does not let " << arguments[0] << " mount a file system; skipped");
    return;
  }
  INFO(end.err);
  CHECK(end.exit == 0);
  CHECK(end.signal == 0);
}

/// Changes whenever the file is replaced.
std::tuple<ino_t, time_t, long> mark(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return {};
  return {info.st_ino, info.st_mtim.tv_sec, info.st_mtim.tv_nsec};
}

/// What saving takes here, microseconds.
std::uint64_t time_of_saving(const std::string& path) {
  using namespace std::chrono;
  const auto start = steady_clock::now();
  for (unsigned i = 0; i < 10; ++i) REQUIRE(write_file(path, saved_bytes(1 + i % 2)).ok());
  return std::uint64_t(duration_cast<microseconds>(steady_clock::now() - start).count()) / 10 + 1;
}

/// Kills a process that saves two contents in turn at random moments and looks at what is there.
void kill_while_saving(const Folder& folder, const std::string& err, int rounds, Rng& rng) {
  const std::string path = folder / "file.meso";
  const std::uint64_t one_save = time_of_saving(path);
  int seen[2] = {};
  for (int round = 0; round < rounds; ++round) {
    const auto before = mark(path);
    const pid_t child = start_child({"save-for-ever", path}, err);
    // Once it saves, within the next few times.
    const auto start = std::chrono::steady_clock::now();
    while (mark(path) == before && std::chrono::steady_clock::now() - start < std::chrono::seconds(20))
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    std::this_thread::sleep_for(std::chrono::microseconds(rng.next() % (4 * one_save)));
    REQUIRE(::kill(child, SIGKILL) == 0);
    REQUIRE(wait_for(child, err).signal == SIGKILL);
    const auto bytes = read_file(path, 1 << 20);
    REQUIRE(bytes.ok());
    const bool first = *bytes == saved_bytes(1);
    REQUIRE((first || *bytes == saved_bytes(2)));
    ++seen[first ? 0 : 1];
  }
  CHECK(seen[0] > rounds / 10);
  CHECK(seen[1] > rounds / 10);
  // What was left behind disturbs nobody; each kill leaves one file at most.
  CHECK(folder.count() <= std::size_t(rounds) + 1);
  const std::size_t before_saving = folder.count();
  REQUIRE(write_file(path, saved_bytes(3)).ok());
  CHECK((*read_file(path, 1 << 20) == saved_bytes(3)));
  CHECK(folder.count() == before_saving);
}

}  // namespace

TEST_CASE("faults: a process that is killed at any moment of saving leaves the old file or the new one") {
  Rng rng(5);
  const Folder notes(in_memory());
  const Folder memory(in_memory());
  kill_while_saving(memory, notes / "err", 120, rng);
  const Folder disk;
  kill_while_saving(disk, notes / "err", 80, rng);
}

TEST_CASE("faults: temporary files that a process of the same number left behind are passed over") {
  const Folder folder(in_memory());
  std::string name;
  {
    auto file = AtomicFile::create(folder / "a.meso");
    REQUIRE(file.ok());
    name = file->temporary_path();
  }
  const std::string stem = name.substr(0, name.rfind('-') + 1);
  const unsigned long number = std::stoul(name.substr(stem.size()));
  std::vector<std::string> stale;
  for (unsigned long i = 1; i <= 5; ++i) stale.push_back(stem + std::to_string(number + i) + ".meso");
  for (const std::string& path : stale) REQUIRE(write_file(path, saved_bytes(1)).ok());
  REQUIRE(write_file(folder / "a.meso", saved_bytes(2)).ok());
  CHECK((*read_file(folder / "a.meso", 1 << 20) == saved_bytes(2)));
  for (const std::string& path : stale) CHECK((*read_file(path, 1 << 20) == saved_bytes(1)));
  CHECK(folder.count() == stale.size() + 1);
}

TEST_CASE("faults: a full disk, no inodes, a read-only disk, too large a file, no descriptors") {
  for (const char* what : {"full-disk", "no-inodes", "read-only", "file-size", "no-descriptors"}) {
    const Folder folder(in_memory());
    CAPTURE(what);
    check_child({what, folder.path().string()});
  }
}

TEST_CASE("faults: a target that becomes a folder while it is written stays one") {
  const Folder folder(in_memory());
  for (const bool no_clobber : {false, true}) {
    auto file = AtomicFile::create(folder / "a", no_clobber);
    REQUIRE(file.ok());
    REQUIRE(file->write(saved_bytes(1)).ok());
    fs::create_directory(folder / "a");
    const Status status = file->commit();
    REQUIRE(!status.ok());
    CHECK(status.error().code == ErrorCode::kOutput);
    const char* const cause = no_clobber ? "exists already" : "Is a directory";
    CHECK(status.error().message.find(cause) != std::string::npos);
    CHECK(fs::is_directory(folder / "a"));
    fs::remove(folder / "a");
    CHECK(folder.count() == 0);
  }
}

TEST_CASE("faults: a folder that goes away while a file in it is written is an error") {
  const Folder folder(in_memory());
  fs::create_directory(folder / "sub");
  auto file = AtomicFile::create(folder / "sub/a");
  REQUIRE(file.ok());
  fs::remove_all(folder / "sub");
  REQUIRE(file->write(saved_bytes(1)).ok());
  CHECK(file->commit().error().code == ErrorCode::kOutput);
  CHECK(folder.count() == 0);
}

TEST_CASE("faults: names of every length are written or refused") {
  const Folder folder(in_memory());
  for (const std::size_t length : {1u, 200u, 240u, 254u, 255u, 256u, 300u, 4000u, 5000u})
    for (const bool extension : {false, true}) {
      CAPTURE(length, extension);
      std::string name(length, 'x');
      // As long an extension as there can be.
      if (extension && length > 2) name[1] = '.';
      const Status status = write_file(folder / name, saved_bytes(1));
      CHECK(status.ok() == (length <= 255));
      if (status.ok()) {
        CHECK((*read_file(folder / name, 1 << 20) == saved_bytes(1)));
      } else {
        CHECK(status.error().code == ErrorCode::kOutput);
        CHECK(status.error().message.find("name too long") != std::string::npos);
      }
      fs::remove(folder / (length <= 255 ? name : "none"));
      CHECK(folder.count() == 0);
    }
}

TEST_CASE("faults: of two threads that write one file the last one wins whole, or the first one alone") {
  const Folder folder(in_memory());
  const std::string path = folder / "a";
  for (const bool no_clobber : {false, true})
    for (int round = 0; round < 50; ++round) {
      fs::remove(path);
      std::vector<Status> statuses(4);
      std::vector<std::thread> threads;
      for (unsigned i = 0; i < statuses.size(); ++i)
        threads.emplace_back([&, i] { statuses[i] = write_file(path, saved_bytes(i), no_clobber); });
      for (std::thread& thread : threads) thread.join();
      const auto bytes = read_file(path, 1 << 20);
      REQUIRE(bytes.ok());
      unsigned written = 0, winners = 0;
      for (unsigned i = 0; i < statuses.size(); ++i) {
        written += statuses[i].ok();
        winners += statuses[i].ok() && *bytes == saved_bytes(i);
        if (!statuses[i].ok()) CHECK(statuses[i].error().message.find("exists already") != std::string::npos);
      }
      CHECK(written == (no_clobber ? 1 : statuses.size()));
      CHECK(winners == 1);
      CHECK(folder.count() == 1);
    }
}

TEST_CASE("faults: of two processes that write one file the last one wins whole, or the first one alone") {
  const Folder folder(in_memory());
  const Folder notes(in_memory());
  const std::string path = folder / "a";
  for (const bool no_clobber : {false, true})
    for (int round = 0; round < 12; ++round) {
      fs::remove(path);
      std::vector<pid_t> children;
      for (unsigned i = 0; i < 3; ++i) {
        std::vector<std::string> arguments = {"save", path, std::to_string(i)};
        if (no_clobber) arguments.push_back("no-clobber");
        children.push_back(start_child(arguments, notes / std::to_string(i)));
      }
      unsigned written = 0, winners = 0;
      std::vector<ChildEnd> ends;
      for (unsigned i = 0; i < 3; ++i) ends.push_back(wait_for(children[i], notes / std::to_string(i)));
      const auto bytes = read_file(path, 1 << 20);
      REQUIRE(bytes.ok());
      for (unsigned i = 0; i < 3; ++i) {
        written += ends[i].exit == 0;
        winners += ends[i].exit == 0 && *bytes == saved_bytes(i);
        if (ends[i].exit != 0) {
          CHECK(ends[i].exit == kChildRefused);
          CHECK(ends[i].err.find("exists already") != std::string::npos);
        }
      }
      CHECK(written == (no_clobber ? 1 : 3));
      CHECK(winners == 1);
      CHECK(folder.count() == 1);
    }
}
