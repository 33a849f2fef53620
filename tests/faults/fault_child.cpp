// What the tests of faults let another process do; see tests/faults/fault_child.h. Exit codes: 0 all is as it
// should be, 1 it is not (stderr tells), 2 usage, and those of that header.
#include "tests/faults/fault_child.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "format/file.h"
#include "format/mapped_file.h"

using namespace mesocell;
using namespace mesocell::test;
namespace fs = std::filesystem;

namespace {

int failures = 0;

void expect(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", what.c_str());
  failures = 1;
}

void expect_error(const Status& status, ErrorCode code, int cause, const std::string& what) {
  if (status.ok()) return expect(false, what + " succeeds");
  const std::string& message = status.error().message;
  expect(status.error().code == code, what + ": wrong code, " + message);
  expect(message.find(std::strerror(cause)) != std::string::npos, what + ": " + message);
}

void expect_content(const std::string& path, unsigned seed, const std::string& what) {
  const auto bytes = read_file(path, 1 << 20);
  expect(bytes.ok() && *bytes == saved_bytes(seed), what + ": the content is another one");
}

std::size_t count(const std::string& folder) {
  return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// Saves two contents in turn, until it is killed.
int save_for_ever(const std::string& path) {
  const std::vector<std::byte> contents[] = {saved_bytes(1), saved_bytes(2)};
  for (unsigned i = 0;; ++i)
    if (const Status status = write_file(path, contents[i % 2]); !status.ok()) {
      std::fprintf(stderr, "%s\n", status.error().message.c_str());
      return 1;
    }
}

int save(const std::string& path, unsigned seed, bool no_clobber) {
  const Status status = write_file(path, saved_bytes(seed), no_clobber);
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s\n", status.error().message.c_str());
  return kChildRefused;
}

bool write_text(const char* path, const std::string& text) {
  const int file = ::open(path, O_WRONLY);
  const bool written = file >= 0 && ::write(file, text.data(), text.size()) == ssize_t(text.size());
  ::close(file);
  return written;
}

/// Mounts of its own; who is not root becomes it in a user namespace of its own, where the system allows
/// that.
bool unshare_mounts() {
  if (::unshare(CLONE_NEWNS) == 0) return true;
  const std::string user = std::to_string(::geteuid());
  return ::unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0 && write_text("/proc/self/uid_map", "0 " + user + " 1");
}

/// A file system of its own in the folder, that no other process sees.
bool mount_memory(const std::string& folder, const char* options) {
  return unshare_mounts() && ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         ::mount("none", folder.c_str(), "tmpfs", 0, options) == 0;
}

int full_disk(const std::string& folder) {
  if (!mount_memory(folder, "size=256k")) return kChildNotPermitted;
  const std::string path = folder + "/a.meso";
  // 140 kB are there, and another 140 kB do not fit beside them.
  expect(saved_bytes(1).size() < 100000 && saved_bytes(2).size() > 130000, "the sizes are others");
  expect(write_file(path, saved_bytes(2)).ok(), "there is no room from the beginning");
  expect_error(write_file(path, saved_bytes(2)), ErrorCode::kOutput, ENOSPC, "a full disk");
  expect_content(path, 2, "a full disk");
  expect(count(folder) == 1, "a full disk: something is left");
  expect(write_file(path, saved_bytes(1)).ok(), "what fits is not written");
  expect_content(path, 1, "what fits");
  // No room for a single byte.
  const int filler = ::open((folder + "/filler").c_str(), O_WRONLY | O_CREAT, 0600);
  const std::vector<char> zeros(4096);
  while (::write(filler, zeros.data(), zeros.size()) > 0) continue;
  ::close(filler);
  expect_error(write_file(folder + "/b", saved_bytes(1)), ErrorCode::kOutput, ENOSPC, "a brimful disk");
  expect_content(path, 1, "a brimful disk");
  expect(count(folder) == 2, "a brimful disk: something is left");
  return failures;
}

int no_inodes(const std::string& folder) {
  if (!mount_memory(folder, "nr_inodes=3")) return kChildNotPermitted;  // the folder itself and two files
  expect(write_file(folder + "/a", saved_bytes(1)).ok(), "the first file fails");
  expect(write_file(folder + "/b", saved_bytes(2)).ok(), "the second file fails");
  expect_error(write_file(folder + "/a", saved_bytes(2)), ErrorCode::kOutput, ENOSPC, "no inode is left");
  expect_content(folder + "/a", 1, "no inode is left");
  return failures;
}

int read_only(const std::string& folder) {
  if (!mount_memory(folder, nullptr)) return kChildNotPermitted;
  const std::string path = folder + "/a.meso";
  expect(write_file(path, saved_bytes(1)).ok(), "it is not writable from the beginning");
  auto begun = AtomicFile::create(path);
  expect(begun.ok() && begun->write(saved_bytes(2)).ok(), "a file is not begun");
  expect(::mount("none", folder.c_str(), nullptr, MS_REMOUNT | MS_RDONLY, nullptr) != 0,
         "busy, yet remounted");
  expect(begun->commit().ok(), "a file is not finished");
  expect(::mount("none", folder.c_str(), nullptr, MS_REMOUNT | MS_RDONLY, nullptr) == 0, "not remounted");
  expect_error(write_file(path, saved_bytes(1)), ErrorCode::kOutput, EROFS, "a read-only file");
  expect_error(write_file(folder + "/b", saved_bytes(1)), ErrorCode::kOutput, EROFS, "a read-only folder");
  expect_content(path, 2, "a read-only file");
  const auto mapped = MappedFile::open(path, 1 << 20);
  expect(mapped.ok() && mapped->check().ok(), "a read-only file is not mapped");
  expect(count(folder) == 1, "something is left");
  return failures;
}

/// No file may have more than 100 000 bytes.
int file_size(const std::string& folder) {
  const std::string path = folder + "/a.meso";
  expect(write_file(path, saved_bytes(1)).ok(), "a file cannot be written");
  const rlimit limit{100000, 100000};
  expect(::setrlimit(RLIMIT_FSIZE, &limit) == 0, "the limit is not taken");
  std::signal(SIGXFSZ, SIG_IGN);
  expect_error(write_file(path, saved_bytes(2)), ErrorCode::kOutput, EFBIG, "too large a file");
  expect_content(path, 1, "too large a file");
  expect(count(folder) == 1, "something is left");
  return failures;
}

int no_descriptors(const std::string& folder) {
  const std::string path = folder + "/a.meso";
  expect(write_file(path, saved_bytes(1)).ok(), "a file cannot be written");
  auto begun = AtomicFile::create(folder + "/b");
  expect(begun.ok() && begun->write(saved_bytes(1)).ok(), "a file is not begun");
  const rlimit limit{64, 64};
  expect(::setrlimit(RLIMIT_NOFILE, &limit) == 0, "the limit is not taken");
  std::vector<int> taken;
  for (int file; (file = ::open("/dev/null", O_RDONLY)) >= 0;) taken.push_back(file);
  const auto read = read_file(path, 1 << 20);
  expect_error(read ? Status() : Status(read.error()), ErrorCode::kUnreadable, EMFILE, "reading");
  const auto mapped = MappedFile::open(path, 1 << 20);
  expect_error(mapped ? Status() : Status(mapped.error()), ErrorCode::kUnreadable, EMFILE, "mapping");
  expect_error(write_file(path, saved_bytes(2)), ErrorCode::kOutput, EMFILE, "writing");
  // Its own descriptor is enough for a file that was begun before.
  expect(begun->commit().ok(), "a file that was begun is not finished");
  for (const int file : taken) ::close(file);
  expect_content(path, 1, "no descriptors");
  expect_content(folder + "/b", 1, "no descriptors");
  expect(count(folder) == 2, "something is left");
  return failures;
}

/// Memory of a file that is cut off, mapped by other means than MappedFile.
volatile char* foreign_memory(const std::string& folder) {
  const int file = ::open((folder + "/foreign").c_str(), O_RDWR | O_CREAT, 0600);
  if (file < 0 || ::ftruncate(file, 8192) != 0) std::abort();
  void* const memory = ::mmap(nullptr, 8192, PROT_READ, MAP_SHARED, file, 0);
  if (memory == MAP_FAILED || ::ftruncate(file, 0) != 0) std::abort();
  return static_cast<volatile char*>(memory);
}

/// Has MappedFile installed its handler, and a file of its own mended by it.
void use_mapped_file(const std::string& folder) {
  const std::string path = folder + "/own";
  if (!write_file(path, saved_bytes(2)).ok()) std::abort();
  const auto file = MappedFile::open(path, 1 << 20);
  if (!file || ::truncate(path.c_str(), 0) != 0) std::abort();
  expect(file->bytes()[50000] == std::byte{0}, "no zeros are in the place of what is lost");
  expect(!file->check().ok(), "what is lost is not reported");
}

volatile std::sig_atomic_t reached = 0;

extern "C" void end_well(int, siginfo_t* info, void*) { ::_exit(info->si_addr ? 0 : 1); }
extern "C" void end_well_plain(int) { ::_exit(0); }
extern "C" void count_only(int) { reached = reached + 1; }
extern "C" void mend_or_end(int, siginfo_t* info, void*) {
  if (!MappedFile::handle_fault(info->si_addr)) ::_exit(0);
  reached = reached + 1;
}

void handle(void (*handler)(int, siginfo_t*, void*), void (*plain)(int), int flags) {
  struct sigaction action = {};
  if (handler) {
    action.sa_sigaction = handler;
    flags |= SA_SIGINFO;
  } else {
    action.sa_handler = plain;
  }
  action.sa_flags = flags;
  ::sigaction(SIGBUS, &action, nullptr);
}

/// A SIGBUS that is none of MappedFile's.
int foreign_fault(const std::string& folder, const std::string& previous) {
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  handle(nullptr, SIG_DFL, 0);
  if (previous == "siginfo") handle(end_well, nullptr, 0);
  if (previous == "plain") handle(nullptr, end_well_plain, 0);
  if (previous == "once") handle(nullptr, count_only, static_cast<int>(SA_RESETHAND));
  if (previous == "ignored" || previous == "ignored-sent") handle(nullptr, SIG_IGN, 0);
  use_mapped_file(folder);
  if (previous == "later") {
    handle(mend_or_end, nullptr, 0);
    use_mapped_file(folder);
    expect(reached == 1, "the later handler was not called");
  }
  if (failures != 0) return failures;
  if (previous == "sent" || previous == "ignored-sent") {
    ::raise(SIGBUS);
    return 0;
  }
  (void)*foreign_memory(folder);
  std::fprintf(stderr, "lost memory of others can be read\n");
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 2) return 2;
  const std::string& path = words[1];
  if (words[0] == "save-for-ever") return save_for_ever(path);
  if (words[0] == "save") return save(path, unsigned(std::stoul(words.at(2))), words.size() > 3);
  if (words[0] == "full-disk") return full_disk(path);
  if (words[0] == "no-inodes") return no_inodes(path);
  if (words[0] == "read-only") return read_only(path);
  if (words[0] == "file-size") return file_size(path);
  if (words[0] == "no-descriptors") return no_descriptors(path);
  if (words[0] == "foreign-fault") return foreign_fault(path, words.at(2));
  return 2;
}
