#pragma once

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <new>
#include <utility>

#if defined(__unix__) || defined(__APPLE__)
#include <sys/mman.h>
#include <unistd.h>
#define MESOCELL_GUARDS 1
#endif

namespace mesocell::test {

/// A copy of bytes whose end is the end of what may be read: a read beyond ends the process, also one by
/// vector instructions, which sanitizers do not watch. Where there are no such pages it is a plain copy.
class GuardedCopy {
 public:
  GuardedCopy(const void* bytes, std::size_t size) {
#ifdef MESOCELL_GUARDS
    const std::size_t page = std::size_t(sysconf(_SC_PAGESIZE));
    const std::size_t whole = (size + page - 1) / page * page;
    total_ = whole + page;
    base_ = mmap(nullptr, total_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANON, -1, 0);
    if (base_ == MAP_FAILED || mprotect(static_cast<char*>(base_) + whole, page, PROT_NONE) != 0)
      std::abort();
    data_ = static_cast<char*>(base_) + (whole - size);
#else
    base_ = ::operator new(size + 1);
    data_ = base_;
#endif
    if (size > 0) std::memcpy(data_, bytes, size);
  }
  GuardedCopy(GuardedCopy&& other) noexcept
      : base_(std::exchange(other.base_, nullptr)), data_(other.data_), total_(other.total_) {}
  GuardedCopy& operator=(GuardedCopy&&) = delete;
  ~GuardedCopy() {
#ifdef MESOCELL_GUARDS
    if (base_) munmap(base_, total_);
#else
    ::operator delete(base_);
#endif
  }

  [[nodiscard]] const void* data() const { return data_; }

 private:
  void* base_ = nullptr;
  void* data_ = nullptr;
  std::size_t total_ = 0;
};

}  // namespace mesocell::test
