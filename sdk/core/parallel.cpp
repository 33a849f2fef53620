#include "sdk/core/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace mesocell {

unsigned resolve_threads(unsigned requested) {
  if (requested > 0) return requested;
  return std::max(1u, std::thread::hardware_concurrency());
}

bool parallel_for(std::size_t count, unsigned threads, const std::function<void(std::size_t, unsigned)>& body,
                  const Progress* progress, std::string_view stage) {
  threads = unsigned(std::min<std::size_t>(resolve_threads(threads), std::max<std::size_t>(count, 1)));
  std::atomic<std::size_t> next{0}, done{0};
  std::atomic<bool> stop{false};
  std::exception_ptr failure;
  std::mutex mutex;
  std::size_t reported = 0;
  const auto work = [&](unsigned worker) {
    try {
      for (;;) {
        if (stop.load(std::memory_order_relaxed) || (progress && progress->cancelled())) return;
        const std::size_t i = next.fetch_add(1, std::memory_order_relaxed);
        if (i >= count) return;
        body(i, worker);
        const std::size_t finished = done.fetch_add(1, std::memory_order_relaxed) + 1;
        if (progress && progress->report) {
          // Whoever finds the lock taken leaves the report to the holder: a late one would only wait.
          std::unique_lock lock(mutex, std::try_to_lock);
          if (lock && finished > reported) {
            reported = finished;
            progress->report(stage, double(finished) / double(count));
          }
        }
      }
    } catch (...) {
      const std::scoped_lock lock(mutex);
      if (!failure) failure = std::current_exception();
      stop = true;
    }
  };
  {
    std::vector<std::jthread> pool;
    for (unsigned w = 1; w < threads; ++w) pool.emplace_back(work, w);
    work(0);
  }
  if (failure) std::rethrow_exception(failure);
  return done == count;
}

}  // namespace mesocell
