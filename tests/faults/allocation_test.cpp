#include <cstdlib>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "format/cell_object_chunks.h"
#include "format/cell_object_io.h"
#include "format/container.h"
#include "format/file.h"
#include "format/loader/mesocell_loader.h"
#include "format/mapped_file.h"
#include "format/validate.h"
#include "tests/faults/allocation_faults.h"
#include "tests/format/test_file.h"
#include "tests/format/test_objects.h"
#include "tests/support/catch.h"
#include "tests/support/folder.h"

using namespace mesocell;
using namespace mesocell::test;

namespace {

/// What a run came to, without any memory of its own.
struct Outcome {
  bool ok = false;
  ErrorCode code = ErrorCode::kUsage;  ///< if not ok
  bool same = true;                    ///< what it gave is what it should be
};

template <typename ResultOrStatus>
Outcome outcome_of(const ResultOrStatus& result) {
  return result.ok() ? Outcome{true} : Outcome{false, result.error().code};
}

/// Runs with every single allocation failing, the first one, the second one, until a run has no more; with
/// `kFromThenOn` all that follow fail, too. Returns how many allocations there are.
std::uint64_t each_allocation_fails(const std::function<Outcome()>& run, Failing failing = Failing::kOnce) {
  (void)run();  // what is made once a process is made
  const Outcome wanted = run();
  CHECK(wanted.same);
  for (std::uint64_t n = 0;; ++n) {
    CAPTURE(n);
    const std::int64_t before = live_allocations();
    Outcome outcome;
    bool thrown = false;
    fail_allocation(n, failing);
    try {
      outcome = run();
    } catch (...) {
      thrown = true;
    }
    const bool failed = stop_failing_allocations();
    const std::int64_t left = live_allocations() - before;
    if (thrown) FAIL_CHECK("an exception came out");
    if (left != 0) FAIL_CHECK(left << " blocks are left");
    if (thrown) continue;
    const bool as_without = outcome.ok == wanted.ok && outcome.code == wanted.code;
    const bool limit = !outcome.ok && outcome.code == ErrorCode::kLimit;
    if (!as_without && !(failed && limit)) FAIL_CHECK("ends with error code " << int(outcome.code));
    if (outcome.ok && !outcome.same) FAIL_CHECK("gives something else");
    if (!failed) return n;
    REQUIRE(n < 100000);
  }
}

std::vector<CellObject> small_objects() {
  std::vector<CellObject> objects;
  for (const Bytes& file : small_files()) objects.push_back(*read_cell_object(file));
  return objects;
}

/// The small files, and each of them with a bit turned and cut off: errors need memory, too.
std::vector<Bytes> good_and_bad_files() {
  std::vector<Bytes> files = small_files();
  // The one chunk that the compact loader decodes outside its arena.
  TestFile compressed = TestFile::take_apart(files[0]);
  compress(compressed.chunk(kGridChunk));
  files.push_back(compressed.build());
  const std::size_t good = files.size();
  for (std::size_t i = 0; i < good; ++i) {
    Bytes damaged = files[i];
    damaged[damaged.size() / 2] ^= std::byte{16};
    files.push_back(damaged);
    damaged = files[i];
    damaged.resize(damaged.size() * 2 / 3);
    files.push_back(damaged);
  }
  return files;
}

Outcome validate_outcome(const Bytes& file, const std::vector<Issue>& issues) {
  const ValidationReport report = validate(file);
  if (report.valid) return {true};
  if (report.issues.empty()) return {false, report.capped ? ErrorCode::kLimit : ErrorCode::kUsage};
  bool limit = false;
  for (const Issue& issue : report.issues) limit = limit || issue.id == "limit-exceeded";
  if (limit) return {false, ErrorCode::kLimit};
  // Each issue that it names is one that is there.
  bool same = report.issues.size() == issues.size();
  for (std::size_t i = 0; same && i < issues.size(); ++i) same = report.issues[i].id == issues[i].id;
  return {false, same ? ErrorCode::kInvalidInput : ErrorCode::kUsage};
}

}  // namespace

TEST_CASE("faults: every allocation of writing an object fails") {
  for (const CellObject& object : small_objects()) {
    const Bytes wanted = encoded(object);
    const std::uint64_t count = each_allocation_fails([&] {
      const auto bytes = encode_cell_object(object);
      Outcome outcome = outcome_of(bytes);
      outcome.same = !bytes || *bytes == wanted;
      return outcome;
    });
    CHECK(count > 5);
  }
}

TEST_CASE("faults: every allocation of reading an object fails") {
  for (const Bytes& file : good_and_bad_files()) {
    const auto wanted = read_cell_object(file);
    each_allocation_fails([&] {
      const auto object = read_cell_object(file);
      Outcome outcome = outcome_of(object);
      outcome.same = !object || *object == *wanted;
      return outcome;
    });
  }
}

TEST_CASE("faults: every allocation of the validator fails") {
  for (const Bytes& file : good_and_bad_files()) {
    const ValidationReport wanted = validate(file);
    each_allocation_fails([&] { return validate_outcome(file, wanted.issues); });
  }
}

TEST_CASE("faults: every allocation of opening a file and reading its chunks fails") {
  for (const Bytes& file : good_and_bad_files()) {
    each_allocation_fails([&]() -> Outcome {
      const auto container = Container::open(file);
      if (!container) return outcome_of(container);
      if (const Status status = container->verify(0); !status) return outcome_of(status);
      for (const ChunkInfo& chunk : container->chunks()) {
        const auto bytes = container->read_chunk(0, chunk.type);
        if (!bytes) return outcome_of(bytes);
        if (bytes->size() != chunk.decoded_bytes) return {true, {}, false};
      }
      return {true};
    });
  }
}

TEST_CASE("faults: every allocation of the compact loader fails") {
  for (const Bytes& file : good_and_bad_files()) {
    Bytes arena(1 << 20);
    each_allocation_fails([&]() -> Outcome {
      std::size_t need = 0;
      MesocellObject object;
      MesocellStatus status = mesocell_arena_bytes(file.data(), file.size(), 0, nullptr, &need, nullptr);
      if (status == kMesocellOk && need > arena.size()) return {true, {}, false};
      if (status == kMesocellOk)
        status = mesocell_load(file.data(), file.size(), 0, nullptr, arena.data(), need, &object, nullptr);
      if (status == kMesocellOk) return {true};
      return {false, status == kMesocellLimit ? ErrorCode::kLimit : ErrorCode::kInvalidInput};
    });
  }
}

TEST_CASE("faults: every allocation of reading and mapping a file fails") {
  const Folder folder;
  const Bytes content(5000, std::byte{7});
  REQUIRE(write_file(folder / "file", content).ok());
  for (const std::string& path : {folder / "file", folder / "missing", folder.path().string()})
    for (const Failing failing : {Failing::kOnce, Failing::kFromThenOn})
      for (const std::uint64_t max_bytes : {5000, 4999}) {
        CAPTURE(path, max_bytes);
        each_allocation_fails(
            [&] {
              const auto bytes = read_file(path, max_bytes);
              Outcome outcome = outcome_of(bytes);
              outcome.same = !bytes || *bytes == content;
              return outcome;
            },
            failing);
        each_allocation_fails(
            [&] {
              const auto file = MappedFile::open(path, max_bytes);
              return file ? outcome_of(file->check()) : outcome_of(file);
            },
            failing);
      }
}

TEST_CASE("faults: every allocation of saving a file fails, and the old one or the new one is there") {
  const Folder folder;
  const Bytes first(5000, std::byte{7});
  const Bytes second(6000, std::byte{9});
  const std::string path = folder / "a file whose name is too long for a short string.meso";
  const std::string missing = folder / "no such folder/a file.meso";
  const std::string is_folder = folder.path().string();
  for (const Failing failing : {Failing::kOnce, Failing::kFromThenOn}) {
    bool turn = false;
    each_allocation_fails(
        [&]() -> Outcome {
          const bool again = std::exchange(turn, !turn);
          Outcome outcome = outcome_of(write_file(path, again ? first : second));
          if (outcome.ok) return outcome;
          // Nothing that runs here may take memory; the folder is looked at below.
          turn = again;
          return outcome;
        },
        failing);
    CHECK((*read_file(path, 10000) == (turn ? second : first)));
    CHECK(folder.count() == 1);
    each_allocation_fails([&] { return outcome_of(write_file(path, first, true)); }, failing);
    each_allocation_fails([&] { return outcome_of(write_file(missing, first)); }, failing);
    each_allocation_fails([&] { return outcome_of(write_file(is_folder, first)); }, failing);
    CHECK((*read_file(path, 10000) == (turn ? second : first)));
    CHECK(folder.count() == 1);
  }
}
