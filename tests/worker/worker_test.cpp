#include "converters/worker/worker.h"

#include <atomic>
#include <chrono>
#include <string>
#include <string_view>
#include <thread>

#include "tests/support/catch.h"

using namespace mesocell;

namespace {

Result<std::vector<std::byte>> ask(std::string_view text, const WorkerLimits& limits = {},
                                   const Progress* progress = nullptr) {
  return run_worker("mesocell_unruly_worker", std::as_bytes(std::span(text)), "the thing", limits, progress);
}

}  // namespace

TEST_CASE("a worker gets the request and its reply comes back, also where both are large") {
  for (const std::size_t bytes :
       {std::size_t{0}, std::size_t{1}, std::size_t{65536}, std::size_t{5'000'001}}) {
    std::string text(bytes, 'x');
    if (bytes > 1) text[bytes / 2] = 'y';
    const auto reply = ask(text);
    REQUIRE(reply);
    CHECK(std::string_view(reinterpret_cast<const char*>(reply->data()), reply->size()) == text);
  }
}

TEST_CASE("a worker that fails says why") {
  CHECK(ask("throw").error().code == ErrorCode::kInvalidInput);
  CHECK(ask("throw").error().message.find("a wheel came off") != std::string::npos);
  CHECK(ask("memory").error().code == ErrorCode::kLimit);
  CHECK(ask("refuse").error().code == ErrorCode::kUsage);
  CHECK(ask("refuse").error().message == "not like this");
}

TEST_CASE("a worker that crashes, leaves or does not end harms nobody") {
  for (const char* way : {"crash", "leave"}) {
    const auto reply = ask(way);
    REQUIRE_FALSE(reply);
    CHECK(reply.error().code == ErrorCode::kInvalidInput);
    CHECK(reply.error().message.find("the thing") != std::string::npos);
  }
  const auto reply = ask("hang", {.max_seconds = 0.1});
  REQUIRE_FALSE(reply);
  CHECK(reply.error().code == ErrorCode::kLimit);
}

TEST_CASE("a worker that hangs can be cancelled") {
  std::atomic<bool> cancel = false;
  const Progress progress{.report = nullptr, .cancel = &cancel};
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    cancel = true;
  });
  const auto reply = ask("hang", {}, &progress);
  later.join();
  REQUIRE_FALSE(reply);
  CHECK(reply.error().code == ErrorCode::kCancelled);
}

TEST_CASE("a reply over the limit is refused") {
  const auto reply = ask(std::string(100'000, 'x'), {.max_reply_bytes = 50'000});
  REQUIRE_FALSE(reply);
  CHECK(reply.error().code == ErrorCode::kLimit);
}

TEST_CASE("what a library prints does not get into the reply") {
  const auto reply = ask("print");
  REQUIRE(reply);
  CHECK(*reply == std::vector<std::byte>{std::byte{7}});
}

TEST_CASE("a worker that is not installed is named") {
  const auto reply = run_worker("mesocell_no_worker", {}, "it");
  REQUIRE_FALSE(reply);
  CHECK(reply.error().code == ErrorCode::kOutput);
  CHECK(reply.error().message.find("mesocell_no_worker is missing") != std::string::npos);
}
