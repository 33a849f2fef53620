#include "converters/stability/isolated_run.h"

#include <chrono>
#include <cstdlib>
#include <thread>

#include "sdk/core/primitives.h"
#include "tests/support/catch.h"

using namespace mesocell;

namespace {

Status set_one(const TriangleMesh&, BitGrid& out, unsigned) {
  out.set(1, 2, 3);
  return {};
}
Status take_memory(const TriangleMesh&, BitGrid& out, unsigned) {
  const std::vector<std::uint64_t> block(8 << 20, 3);
  if (block[block.size() / 2] == 3) out.set(0, 0, 0);
  return {};
}
Status sleep_long(const TriangleMesh&, BitGrid&, unsigned) {
  std::this_thread::sleep_for(std::chrono::seconds(60));
  return {};
}
Status refuse(const TriangleMesh&, BitGrid&, unsigned) { return Error{ErrorCode::kLimit, "too hard"}; }
Status crash(const TriangleMesh&, BitGrid&, unsigned) { std::_Exit(7); }
Status fail_by_exception(const TriangleMesh&, BitGrid&, unsigned) { throw std::bad_alloc(); }
Status not_there() { return Error{ErrorCode::kOutput, "the module is not there"}; }

Result<IsolatedRun> run(const Voxelizer& method, BitGrid& out, double max_seconds = 20,
                        const Progress* progress = nullptr) {
  return run_isolated(method, make_box({1, 1, 1}, {3, 3, 3}), out, 1, max_seconds, progress);
}

}  // namespace

TEST_CASE("what a method does in its own process is seen, timed and measured") {
  Result<BitGrid> grid = BitGrid::create({70, 4, 5});
  REQUIRE(grid);
  grid->set(5, 0, 0);  // of an earlier run
  Result<IsolatedRun> done = run({"one", "", set_one, nullptr}, *grid);
  REQUIRE(done);
  CHECK(done->outcome == RunOutcome::kDone);
  CHECK(grid->get(1, 2, 3));
  CHECK(!grid->get(5, 0, 0));
  CHECK(done->seconds < 5);
  const std::uint64_t little = done->memory_bytes;

  done = run({"memory", "", take_memory, nullptr}, *grid);
  REQUIRE(done);
  CHECK(done->cpu_seconds > 0);
  CHECK(done->memory_bytes > little + (60 << 20));
  CHECK(done->memory_bytes < little + (200 << 20));
}

TEST_CASE("failures, crashes and patience at its end are told") {
  Result<BitGrid> grid = BitGrid::create({8, 8, 8});
  REQUIRE(grid);
  Result<IsolatedRun> result = run({"refuse", "", refuse, nullptr}, *grid);
  REQUIRE(result);
  CHECK(result->outcome == RunOutcome::kFailed);
  CHECK(result->message == "too hard");

  result = run({"crash", "", crash, nullptr}, *grid);
  REQUIRE(result);
  CHECK(result->outcome == RunOutcome::kFailed);
  CHECK(result->message == "its process ended with code 7");

  result = run({"exception", "", fail_by_exception, nullptr}, *grid);
  REQUIRE(result);
  CHECK(result->outcome == RunOutcome::kFailed);
  CHECK(!result->message.empty());

  result = run({"long", "", sleep_long, nullptr}, *grid, 0.2);
  REQUIRE(result);
  CHECK(result->outcome == RunOutcome::kTooLong);
  CHECK(result->seconds >= 0.2);
  CHECK(result->seconds < 20);

  result = run({"nothing", "", set_one, not_there}, *grid);
  REQUIRE(result);
  CHECK(result->outcome == RunOutcome::kFailed);
  CHECK(result->message == "the module is not there");
}

TEST_CASE("an interruption ends the method's process") {
  Result<BitGrid> grid = BitGrid::create({8, 8, 8});
  REQUIRE(grid);
  const std::atomic<bool> cancel = true;
  Progress progress;
  progress.cancel = &cancel;
  const Result<IsolatedRun> result = run({"long", "", sleep_long, nullptr}, *grid, 50, &progress);
  REQUIRE(!result);
  CHECK(result.error().code == ErrorCode::kCancelled);
}

TEST_CASE("runs of bits are set whole") {
  Result<BitGrid> grid = BitGrid::create({200, 2, 2});
  REQUIRE(grid);
  for (const auto& [begin, end] :
       {std::pair(3u, 7u), std::pair(60u, 64u), std::pair(63u, 65u), std::pair(0u, 200u),
        std::pair(64u, 128u), std::pair(5u, 190u), std::pair(9u, 9u)}) {
    grid->clear();
    grid->set_run(1, 1, begin, end);
    for (std::uint32_t x = 0; x < 200; ++x) {
      CHECK(grid->get(x, 1, 1) == (x >= begin && x < end));
      CHECK(!grid->get(x, 0, 1));
    }
  }
  CHECK(!BitGrid::create({0, 4, 4}));
  CHECK(!BitGrid::create({4000000000u, 4000000000u, 4000000000u}));
}
