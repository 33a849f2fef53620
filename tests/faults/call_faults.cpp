// The system calls of tests/faults/call_faults.h. Preloaded, it takes its orders from the environment:
// MESOCELL_FAULT="CALL NTH ERRNO FOLDER", and makes the file MESOCELL_FAULT_MARK when the call has failed.
#include "tests/faults/call_faults.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace mesocell::test {
namespace {

// Constant initialisation: calls come before any constructor has run.
std::atomic<bool> armed{false};
std::atomic<bool> failed{false};
std::atomic<unsigned> calls_left{0};
std::atomic<unsigned> armed_call{0};
std::atomic<int> armed_error{0};
char armed_folder[PATH_MAX];
std::size_t armed_folder_size;
char mark[PATH_MAX];

bool below_folder(const char* path) {
  return path && std::strncmp(path, armed_folder, armed_folder_size) == 0 && path[armed_folder_size] == '/';
}

bool is_folder(const char* path) {
  return below_folder(path) || (path && std::strcmp(path, armed_folder) == 0);
}

/// The errno or count that this call is to end with, 0 if none.
int strike(Call call) {
  if (armed_call.load() != static_cast<unsigned>(call) || calls_left.fetch_sub(1) != 1) return 0;
  failed.store(true);
  if (mark[0] != '\0') {
    const long file = ::syscall(SYS_openat, AT_FDCWD, mark, O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
    ::syscall(SYS_close, file);
  }
  return armed_error.load();
}

int strike_path(Call call, const char* path) {
  const int saved = errno;
  const int error = armed.load() && is_folder(path) ? strike(call) : 0;
  errno = saved;
  return error;
}

int strike_file(Call call, int descriptor) {
  if (!armed.load() || descriptor < 0) return 0;
  const int saved = errno;
  char link[64];
  char path[PATH_MAX];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const long size = ::syscall(SYS_readlinkat, AT_FDCWD, link, path, sizeof path - 1);
  path[size > 0 ? size : 0] = '\0';
  const int error = is_folder(path) ? strike(call) : 0;
  errno = saved;
  return error;
}

template <typename Function>
Function* real(const char* name) {
  void* const found = ::dlsym(RTLD_NEXT, name);
  if (!found) std::abort();
  return reinterpret_cast<Function*>(found);
}

/// Ends a call that transfers `count` bytes; `transfer(n)` does so for n of them.
template <typename Transfer>
ssize_t end_transfer(int error, std::size_t count, Transfer transfer) {
  if (error == 0 || (error == kShortCount && count < 2)) return transfer(count);
  if (error == kShortCount) return transfer(count / 2);
  if (error == kZeroCount) return 0;
  errno = error;
  return -1;
}

int error_number(const char* name) {
  struct Name {
    const char* name;
    int number;
  };
  constexpr Name kNames[] = {{"EIO", EIO},       {"ENOSPC", ENOSPC}, {"EDQUOT", EDQUOT},    {"EINTR", EINTR},
                             {"EACCES", EACCES}, {"EMFILE", EMFILE}, {"SHORT", kShortCount}};
  for (const Name& known : kNames)
    if (std::strcmp(known.name, name) == 0) return known.number;
  std::abort();
}

__attribute__((constructor)) void read_environment() {
  const char* const order = std::getenv("MESOCELL_FAULT");
  const char* const where = std::getenv("MESOCELL_FAULT_MARK");
  if (!order || !where) return;
  char call[32], error[32], folder[2048];
  unsigned nth = 0;
  if (std::sscanf(order, "%31s %u %31s %2047s", call, &nth, error, folder) != 4) std::abort();
  std::snprintf(mark, sizeof mark, "%s", where);
  for (unsigned i = 0; i < kCalls; ++i)
    if (std::strcmp(call, kCallNames[i]) == 0) return fail_call(folder, Call{i}, nth, error_number(error));
  std::abort();
}

}  // namespace

void fail_call(const std::string& folder, Call call, unsigned nth, int error) {
  armed.store(false);
  if (folder.size() >= sizeof armed_folder) std::abort();
  std::memcpy(armed_folder, folder.c_str(), folder.size() + 1);
  armed_folder_size = folder.size();
  armed_call.store(static_cast<unsigned>(call));
  armed_error.store(error);
  calls_left.store(nth);
  failed.store(false);
  armed.store(true);
}

bool stop_failing_calls() {
  armed.store(false);
  return failed.load();
}

}  // namespace mesocell::test

using namespace mesocell::test;

// A call that either does its work or fails with the errno.
#define MESOCELL_FAIL(strike_, failure)           \
  if (const int error_ = (strike_); error_ > 0) { \
    errno = error_;                               \
    return failure;                               \
  }

// NOLINTBEGIN: the names and parameters are libc's.
extern "C" {

int open(const char* path, int flags, ...) {
  static const auto next = real<int(const char*, int, ...)>("open");
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  MESOCELL_FAIL(strike_path(Call::kOpen, path), -1)
  return next(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  static const auto next = real<int(const char*, int, ...)>("open64");
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  MESOCELL_FAIL(strike_path(Call::kOpen, path), -1)
  return next(path, flags, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  static const auto next = real<int(int, const char*, int, ...)>("openat");
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  MESOCELL_FAIL(strike_path(Call::kOpen, path), -1)
  return next(folder, path, flags, mode);
}

FILE* fopen(const char* path, const char* mode) {
  static const auto next = real<FILE*(const char*, const char*)>("fopen");
  MESOCELL_FAIL(strike_path(Call::kOpen, path), nullptr)
  return next(path, mode);
}

FILE* fopen64(const char* path, const char* mode) {
  static const auto next = real<FILE*(const char*, const char*)>("fopen64");
  MESOCELL_FAIL(strike_path(Call::kOpen, path), nullptr)
  return next(path, mode);
}

ssize_t read(int file, void* to, size_t count) {
  static const auto next = real<ssize_t(int, void*, size_t)>("read");
  return end_transfer(strike_file(Call::kRead, file), count, [&](size_t n) { return next(file, to, n); });
}

ssize_t pread(int file, void* to, size_t count, off_t at) {
  static const auto next = real<ssize_t(int, void*, size_t, off_t)>("pread");
  return end_transfer(strike_file(Call::kRead, file), count, [&](size_t n) { return next(file, to, n, at); });
}

ssize_t pread64(int file, void* to, size_t count, off64_t at) {
  static const auto next = real<ssize_t(int, void*, size_t, off64_t)>("pread64");
  return end_transfer(strike_file(Call::kRead, file), count, [&](size_t n) { return next(file, to, n, at); });
}

size_t fread(void* to, size_t size, size_t count, FILE* file) {
  static const auto next = real<size_t(void*, size_t, size_t, FILE*)>("fread");
  MESOCELL_FAIL(strike_file(Call::kRead, ::fileno(file)), 0)
  return next(to, size, count, file);
}

ssize_t write(int file, const void* from, size_t count) {
  static const auto next = real<ssize_t(int, const void*, size_t)>("write");
  return end_transfer(strike_file(Call::kWrite, file), count, [&](size_t n) { return next(file, from, n); });
}

ssize_t writev(int file, const iovec* parts, int count) {
  static const auto next = real<ssize_t(int, const iovec*, int)>("writev");
  MESOCELL_FAIL(strike_file(Call::kWrite, file), -1)
  return next(file, parts, count);
}

size_t fwrite(const void* from, size_t size, size_t count, FILE* file) {
  static const auto next = real<size_t(const void*, size_t, size_t, FILE*)>("fwrite");
  MESOCELL_FAIL(strike_file(Call::kWrite, ::fileno(file)), 0)
  return next(from, size, count, file);
}

int fsync(int file) {
  static const auto next = real<int(int)>("fsync");
  MESOCELL_FAIL(strike_file(Call::kSync, file), -1)
  return next(file);
}

int fdatasync(int file) {
  static const auto next = real<int(int)>("fdatasync");
  MESOCELL_FAIL(strike_file(Call::kSync, file), -1)
  return next(file);
}

int close(int file) {
  static const auto next = real<int(int)>("close");
  const int error = strike_file(Call::kClose, file);
  const int result = next(file);
  MESOCELL_FAIL(error, -1)
  return result;
}

int fclose(FILE* file) {
  static const auto next = real<int(FILE*)>("fclose");
  const int error = strike_file(Call::kClose, ::fileno(file));
  const int result = next(file);
  MESOCELL_FAIL(error, EOF)
  return result;
}

int rename(const char* from, const char* to) noexcept {
  static const auto next = real<int(const char*, const char*)>("rename");
  MESOCELL_FAIL(strike_path(Call::kRename, from), -1)
  return next(from, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  static const auto next = real<int(int, const char*, int, const char*, unsigned)>("renameat2");
  MESOCELL_FAIL(strike_path(Call::kRename, from), -1)
  return next(from_folder, from, to_folder, to, flags);
}

int link(const char* from, const char* to) noexcept {
  static const auto next = real<int(const char*, const char*)>("link");
  MESOCELL_FAIL(strike_path(Call::kRename, from), -1)
  return next(from, to);
}

int unlink(const char* path) noexcept {
  static const auto next = real<int(const char*)>("unlink");
  MESOCELL_FAIL(strike_path(Call::kUnlink, path), -1)
  return next(path);
}

int stat(const char* __restrict path, struct stat* __restrict info) noexcept {
  static const auto next = real<int(const char*, struct stat*)>("stat");
  MESOCELL_FAIL(strike_path(Call::kStat, path), -1)
  return next(path, info);
}

int lstat(const char* __restrict path, struct stat* __restrict info) noexcept {
  static const auto next = real<int(const char*, struct stat*)>("lstat");
  MESOCELL_FAIL(strike_path(Call::kStat, path), -1)
  return next(path, info);
}

int fstat(int file, struct stat* info) noexcept {
  static const auto next = real<int(int, struct stat*)>("fstat");
  MESOCELL_FAIL(strike_file(Call::kStat, file), -1)
  return next(file, info);
}

int access(const char* path, int mode) noexcept {
  static const auto next = real<int(const char*, int)>("access");
  MESOCELL_FAIL(strike_path(Call::kAccess, path), -1)
  return next(path, mode);
}

ssize_t readlink(const char* __restrict path, char* __restrict to, size_t size) noexcept {
  static const auto next = real<ssize_t(const char*, char*, size_t)>("readlink");
  MESOCELL_FAIL(strike_path(Call::kAccess, path), -1)
  return next(path, to, size);
}

int fchmod(int file, mode_t mode) noexcept {
  static const auto next = real<int(int, mode_t)>("fchmod");
  MESOCELL_FAIL(strike_file(Call::kChmod, file), -1)
  return next(file, mode);
}

void* mmap(void* address, size_t size, int protection, int flags, int file, off_t at) noexcept {
  // Not by dlsym(), which may map memory itself.
  MESOCELL_FAIL(strike_file(Call::kMap, file), MAP_FAILED)
  return reinterpret_cast<void*>(::syscall(SYS_mmap, address, size, protection, flags, file, at));
}

}  // extern "C"
// NOLINTEND
