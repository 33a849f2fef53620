#pragma once

#include <string>

/// System calls that fail on purpose. The definitions in call_faults.cpp take the place of libc's: linked
/// into a test program, or preloaded into a command (MESOCELL_FAULT, see there). Calls count only on files
/// below one folder, so that nothing else of the process is disturbed.
namespace mesocell::test {

enum class Call : unsigned {
  kOpen,    ///< open, openat, fopen
  kRead,    ///< read, pread, fread
  kWrite,   ///< write, writev, fwrite
  kSync,    ///< fsync, fdatasync
  kClose,   ///< close, fclose; it has closed all the same
  kRename,  ///< rename, renameat2, link
  kUnlink,
  kStat,    ///< stat, lstat, fstat
  kAccess,  ///< access, readlink
  kChmod,   ///< fchmod
  kMap,     ///< mmap
};
inline constexpr unsigned kCalls = 11;
inline constexpr const char* kCallNames[kCalls] = {"open",   "read", "write",  "sync",  "close", "rename",
                                                   "unlink", "stat", "access", "chmod", "map"};

/// Instead of an errno: half of the bytes are read or written, or none with the result 0.
inline constexpr int kShortCount = -1;
inline constexpr int kZeroCount = -2;

/// From now on the `nth` call (from 1) of this kind on what is below `folder` (absolute) fails, once.
void fail_call(const std::string& folder, Call call, unsigned nth, int error);
/// No call fails any more. Returns whether one has failed.
bool stop_failing_calls();

}  // namespace mesocell::test
