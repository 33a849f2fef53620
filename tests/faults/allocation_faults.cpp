#include "tests/faults/allocation_faults.h"

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <new>

namespace mesocell::test {
namespace {

std::atomic<std::int64_t> live{0};
thread_local bool armed = false;
thread_local bool failed = false;
thread_local bool all_after = false;
thread_local std::uint64_t left = 0;

bool strikes() {
  if (!armed) return false;
  if (left > 0) {
    --left;
    return false;
  }
  if (failed && !all_after) return false;
  failed = true;
  return true;
}

}  // namespace

void fail_allocation(std::uint64_t nth, Failing failing) {
  left = nth;
  failed = false;
  all_after = failing == Failing::kFromThenOn;
  armed = true;
}

bool stop_failing_allocations() {
  armed = false;
  return failed;
}

std::int64_t live_allocations() { return live.load(); }

}  // namespace mesocell::test

using namespace mesocell::test;

#ifdef MESOCELL_TEST_SANITIZED

void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  void* const made = strikes() ? nullptr : std::malloc(size > 0 ? size : 1);
  if (made) ++live;
  return made;
}
void* operator new(std::size_t size) {
  void* const made = operator new(size, std::nothrow);
  if (!made) throw std::bad_alloc();
  return made;
}
void* operator new[](std::size_t size) { return operator new(size); }
void* operator new[](std::size_t size, const std::nothrow_t& nothrow) noexcept {
  return operator new(size, nothrow);
}
void operator delete(void* gone) noexcept {
  if (gone) --live;
  std::free(gone);
}
void operator delete(void* gone, std::size_t) noexcept { operator delete(gone); }
void operator delete[](void* gone) noexcept { operator delete(gone); }
void operator delete[](void* gone, std::size_t) noexcept { operator delete(gone); }

#else

// NOLINTBEGIN: the names and parameters are libc's.
extern "C" {

void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* old, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
void __libc_free(void* gone);

static void* counted(void* made) {
  if (made)
    ++live;
  else
    errno = ENOMEM;
  return made;
}

void* malloc(size_t size) { return counted(strikes() ? nullptr : __libc_malloc(size)); }

void* calloc(size_t count, size_t size) { return counted(strikes() ? nullptr : __libc_calloc(count, size)); }

void* realloc(void* old, size_t size) {
  if (!old) return malloc(size);
  if (size == 0) --live;
  if (size > 0 && strikes()) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_realloc(old, size);
}

void* memalign(size_t alignment, size_t size) {
  return counted(strikes() ? nullptr : __libc_memalign(alignment, size));
}

void* aligned_alloc(size_t alignment, size_t size) { return memalign(alignment, size); }

int posix_memalign(void** made, size_t alignment, size_t size) {
  void* const block = memalign(alignment, size);
  if (!block) return ENOMEM;
  *made = block;
  return 0;
}

void free(void* gone) {
  if (!gone) return;
  --live;
  __libc_free(gone);
}

}  // extern "C"
   // NOLINTEND

#endif
