#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "sdk/core/rng.h"
#include "tests/fuzz/fuzz.h"

// Runs a fuzz target without libFuzzer, as an ordinary test:
//
//   replay_TARGET [--mutate N] [--write-seeds FOLDER] [FILE | FOLDER]...
//
// Runs the target's seeds, N mutants of each if it has a mutator of its own, and the files given, those of
// folders in the order of their names; a folder that is not there is an empty one. A target that breaks a
// promise aborts; the input is then written to crash-replay in the current folder. --write-seeds writes the
// seeds and runs nothing.

namespace fs = std::filesystem;
using mesocell::fuzz::Bytes;

extern "C" {
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
__attribute__((weak)) std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                                          std::size_t max_size, unsigned seed);

/// Of the sanitizers, which end the program without a signal.
__attribute__((weak)) void __sanitizer_set_death_callback(void (*callback)());

/// In place of libFuzzer's: a byte becomes another.
std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t) {
  static mesocell::Rng rng(1);
  if (size > 0) data[rng.below(std::uint32_t(size))] = std::uint8_t(rng.below(256));
  return size;
}
}

namespace {

int runs = 0;
const std::string* running_name = nullptr;
const Bytes* running = nullptr;

void write(const Bytes& bytes, const fs::path& path) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}

/// The program ends in any case: what is not safe in a signal handler can do no harm.
void keep_input() {
  if (!running) return;
  std::fprintf(stderr, "at %s, which is written to crash-replay\n", running_name->c_str());
  write(*running, "crash-replay");
  running = nullptr;
}

void run(const Bytes& bytes, const std::string& name) {
  running_name = &name;
  running = &bytes;
  // A buffer of its own size, and never null.
  const auto copy = std::make_unique<std::uint8_t[]>(bytes.size());
  std::transform(bytes.begin(), bytes.end(), copy.get(), [](std::byte b) { return std::uint8_t(b); });
  LLVMFuzzerTestOneInput(copy.get(), bytes.size());
  running = nullptr;
  ++runs;
}

void run_mutants(const Bytes& seed, int count, const std::string& name) {
  constexpr std::size_t kMost = 1 << 16;
  std::vector<std::uint8_t> data(kMost);
  std::size_t size = 0;
  for (int i = 0; i < count; ++i) {
    // Four changes one after the other, then from the seed again.
    if (i % 4 == 0) {
      size = std::min(seed.size(), kMost);
      for (std::size_t k = 0; k < size; ++k) data[k] = std::uint8_t(seed[k]);
    }
    size = LLVMFuzzerCustomMutator(data.data(), size, kMost, unsigned(i) * 7919u + unsigned(seed.size()));
    const auto bytes = std::as_bytes(std::span(data).first(size));
    run({bytes.begin(), bytes.end()}, name + ", mutant " + std::to_string(i));
  }
}

void run_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    std::fprintf(stderr, "%s cannot be read\n", path.c_str());
    std::exit(2);
  }
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto bytes = std::as_bytes(std::span(text));
  run({bytes.begin(), bytes.end()}, path.string());
}

void run_path(const fs::path& path) {
  if (!fs::exists(path)) return;
  if (!fs::is_directory(path)) return run_file(path);
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(path))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) run_file(file);
}

void write_seeds(const std::vector<Bytes>& seeds, const fs::path& folder) {
  fs::create_directories(folder);
  for (std::size_t i = 0; i < seeds.size(); ++i) write(seeds[i], folder / ("seed-" + std::to_string(i)));
}

}  // namespace

int main(int count, char** arguments) {
  const std::vector<Bytes> seeds = mesocell::fuzz::seeds();
  int mutants = 0, next = 1;
  for (; next + 1 < count && arguments[next][0] == '-'; next += 2) {
    const std::string option = arguments[next];
    if (option == "--write-seeds") {
      write_seeds(seeds, arguments[next + 1]);
      return 0;
    }
    if (option == "--mutate") mutants = std::atoi(arguments[next + 1]);
  }
  std::signal(SIGABRT, [](int) { keep_input(); });
  if (__sanitizer_set_death_callback) __sanitizer_set_death_callback(keep_input);
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const std::string name = "seed " + std::to_string(i);
    run(seeds[i], name);
    if (LLVMFuzzerCustomMutator) run_mutants(seeds[i], mutants, name);
  }
  for (; next < count; ++next) run_path(arguments[next]);
  std::printf("%d inputs\n", runs);
  return 0;
}
