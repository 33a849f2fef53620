#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "format/file.h"
#include "format/mapped_file.h"
#include "tests/faults/call_faults.h"
#include "tests/faults/open_files.h"
#include "tests/support/catch.h"
#include "tests/support/folder.h"

using namespace mesocell;
using namespace mesocell::test;
namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

namespace {

constexpr int kFailures[] = {EIO, ENOSPC, EDQUOT, EMFILE, EINTR, kShortCount, kZeroCount};

bool transfers(Call call) { return call == Call::kRead || call == Call::kWrite; }

/// What must succeed: interrupted calls and short counts.
bool harmless(int error) { return error == EINTR || error == kShortCount; }

/// What must not succeed. Nothing is wrong if permissions cannot be set or what was read cannot be closed,
/// and the last read of a file is to give nothing.
bool matters(Call call, int error) {
  return call != Call::kChmod && call != Call::kClose && error != kZeroCount;
}

bool names_cause(const std::string& message, int error) {
  if (error > 0) return message.find(std::generic_category().message(error)) != std::string::npos;
  return message.find("became shorter") != std::string::npos ||
         message.find("takes no more bytes") != std::string::npos;
}

/// One run with one call that fails.
struct Strike {
  Call call;
  int error;
  Status status;  ///< of the run
};

/// Runs with each call of each kind failing in each way. Before every run `prepare`, after it `check`.
/// Returns how many runs had a call that failed.
unsigned each_call_fails(const Folder& folder, const std::function<void()>& prepare,
                         const std::function<Status()>& run,
                         const std::function<void(const Strike&)>& check) {
  unsigned failures = 0;
  for (unsigned kind = 0; kind < kCalls; ++kind)
    for (const int error : kFailures)
      for (unsigned nth = 1;; ++nth) {
        const Call call{kind};
        if (error < 0 && !transfers(call)) break;
        // What cannot be removed stays, and is no fault of the file.
        if (call == Call::kUnlink && error != EINTR) break;
        if (call == Call::kMap && error == EINTR) break;  // mmap() waits for nothing
        INFO(kCallNames[kind] << " number " << nth << " ends with " << error);
        prepare();
        const std::size_t files = open_files();
        fail_call(folder.path().string(), call, nth, error);
        const Status status = run();
        const bool failed = stop_failing_calls();
        CHECK(open_files() == files);
        UNSCOPED_INFO((status.ok() ? "" : status.error().message));
        if (!failed || harmless(error)) {
          CHECK(status.ok());
        } else if (matters(call, error)) {
          CHECK(!status.ok());
        }
        if (failed && !status.ok()) CHECK(names_cause(status.error().message, error));
        check({call, error, status});
        failures += failed;
        if (!failed) break;
        REQUIRE(nth < 1000);
      }
  return failures;
}

/// The content is as it was, or the new one if the run succeeded or said so; and nothing else is there.
void check_saved(const Folder& folder, const std::string& path, const Bytes* old, const Bytes& wanted,
                 const Strike& strike) {
  const auto now = read_file(path, 1 << 20);
  const bool written =
      strike.status.ok() || strike.status.error().message.find("it was written") != std::string::npos;
  if (!strike.status.ok()) CHECK(strike.status.error().code == ErrorCode::kOutput);
  if (written) {
    REQUIRE(now.ok());
    CHECK((*now == wanted));
  } else if (old) {
    REQUIRE(now.ok());
    CHECK((*now == *old));
  } else {
    CHECK(now.error().code == ErrorCode::kUnreadable);
    CHECK(folder.count() == 0);
    return;
  }
  CHECK(folder.count() == 1);
}

}  // namespace

TEST_CASE("faults: each system call of reading a file fails") {
  const Folder folder(in_memory());
  Bytes content(3000000);
  for (std::size_t i = 0; i < content.size(); ++i) content[i] = std::byte(i * 31 >> 3);
  REQUIRE(write_file(folder / "file", content).ok());
  Bytes got;
  const unsigned failures = each_call_fails(
      folder, [] {},
      [&]() -> Status {
        const auto bytes = read_file(folder / "file", content.size());
        if (!bytes) return bytes.error();
        got = *bytes;
        return {};
      },
      [&](const Strike& strike) {
        if (strike.status.ok())
          CHECK((got == content));
        else
          CHECK(strike.status.error().code == ErrorCode::kUnreadable);
      });
  CHECK(failures > 20);
}

TEST_CASE("faults: each system call of mapping a file fails") {
  const Folder folder(in_memory());
  const Bytes content(100000, std::byte{5});
  REQUIRE(write_file(folder / "file", content).ok());
  const unsigned failures = each_call_fails(
      folder, [] {},
      [&]() -> Status {
        const auto file = MappedFile::open(folder / "file", content.size());
        if (!file) return file.error();
        if (!std::equal(content.begin(), content.end(), file->bytes().begin())) return Error{};
        return file->check();
      },
      [](const Strike& strike) {
        if (!strike.status.ok()) CHECK(strike.status.error().code == ErrorCode::kUnreadable);
      });
  CHECK(failures > 15);
}

TEST_CASE("faults: each system call of replacing a file fails") {
  const Folder folder(in_memory());
  const std::string path = folder / "file.meso";
  const Bytes old(5000, std::byte{1});
  const Bytes wanted(7000, std::byte{2});
  const unsigned failures = each_call_fails(
      folder, [&] { REQUIRE(write_file(path, old).ok()); }, [&] { return write_file(path, wanted); },
      [&](const Strike& strike) { check_saved(folder, path, &old, wanted, strike); });
  CHECK(failures > 40);
}

TEST_CASE("faults: each system call of saving a new file fails") {
  const Folder folder(in_memory());
  const std::string path = folder / "file.meso";
  const Bytes wanted(7000, std::byte{2});
  for (const bool no_clobber : {false, true}) {
    const unsigned failures = each_call_fails(
        folder, [&] { fs::remove(path); }, [&] { return write_file(path, wanted, no_clobber); },
        [&](const Strike& strike) { check_saved(folder, path, nullptr, wanted, strike); });
    CHECK(failures > 30);
    fs::remove(path);
  }
}

TEST_CASE("faults: each system call of a file written in parts fails, and no later part hides it") {
  const Folder folder(in_memory());
  const std::string path = folder / "file.meso";
  const Bytes old(5000, std::byte{1});
  Bytes wanted(9000);
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = std::byte(i * 7);
  const unsigned failures = each_call_fails(
      folder, [&] { REQUIRE(write_file(path, old).ok()); },
      [&]() -> Status {
        auto file = AtomicFile::create(path);
        if (!file) return file.error();
        for (std::size_t at = 0; at < wanted.size(); at += 3000)
          if (Status status = file->write(std::span(wanted).subspan(at, 3000)); !status) return status;
        AtomicFile moved = std::move(*file);
        return moved.commit();
      },
      [&](const Strike& strike) { check_saved(folder, path, &old, wanted, strike); });
  CHECK(failures > 50);
}

TEST_CASE("faults: a symbolic link that cannot be looked at is not replaced") {
  const Folder folder(in_memory());
  const Folder elsewhere(in_memory());
  const std::string real = elsewhere / "real.meso";
  fs::create_symlink(real, folder / "link.meso");
  const Bytes old(50, std::byte{1});
  const Bytes wanted(70, std::byte{2});
  each_call_fails(
      folder, [&] { REQUIRE(write_file(real, old).ok()); },
      [&] { return write_file(folder / "link.meso", wanted); },
      [&](const Strike& strike) {
        CHECK(fs::is_symlink(folder / "link.meso"));
        check_saved(elsewhere, real, &old, wanted, strike);
      });
  CHECK(folder.count() == 1);
}

TEST_CASE("faults: a file that is private stays so where its permissions cannot be set") {
  const Folder folder(in_memory());
  const std::string path = folder / "private";
  REQUIRE(write_file(path, {}).ok());
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  fail_call(folder.path().string(), Call::kChmod, 1, EIO);
  const Status status = write_file(path, Bytes(10));
  CHECK(stop_failing_calls());
  CHECK(status.ok());
  CHECK(fs::status(path).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("faults: where renaming cannot keep what is there, linking does") {
  const Folder folder(in_memory());
  const std::string path = folder / "file";
  fail_call(folder.path().string(), Call::kRename, 1, EINVAL);
  const Status first = write_file(path, Bytes(10), true);
  CHECK(stop_failing_calls());
  CHECK(first.ok());
  auto second = AtomicFile::create(folder / "other", true);
  REQUIRE(second.ok());
  REQUIRE(write_file(folder / "other", Bytes(20)).ok());
  fail_call(folder.path().string(), Call::kRename, 1, EINVAL);
  const Status refused = second->commit();
  CHECK(stop_failing_calls());
  REQUIRE(!refused.ok());
  CHECK(refused.error().message.find("exists already") != std::string::npos);
  CHECK(read_file(folder / "other", 100)->size() == 20);
  CHECK(folder.count() == 2);
}
