#include "converters/cli/batch.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "converters/cli/batch_plan.h"
#include "converters/cli/interrupt.h"
#include "converters/cli/progress_bar.h"
#include "converters/cli/representations.h"
#include "converters/worker/child_process.h"

namespace mesocell {
namespace {

/// In the environment of a batch's processes: the number of the batch's.
constexpr const char* kParentVariable = "MESOCELL_BATCH_PROCESS";

enum class Outcome { kNotBegun, kMade, kSkipped, kFailed };

/// What became of a file.
struct BatchResult {
  Outcome outcome = Outcome::kNotBegun;
  int exit = 0;
  double seconds = 0;
  std::string message;          ///< of a failure
  nlohmann::ordered_json json;  ///< what the process printed
};

const char* outcome_name(Outcome outcome) {
  switch (outcome) {
    case Outcome::kMade:
      return "made";
    case Outcome::kSkipped:
      return "up-to-date";
    case Outcome::kFailed:
      return "failed";
    case Outcome::kNotBegun:
      break;
  }
  return "not-begun";
}

/// Reads what a process prints, to its end. False if it was cancelled.
bool read_output(const Descriptor& from, const Progress& progress, const std::atomic<bool>& stop,
                 std::string& text) {
  std::vector<char> chunk(1 << 16);
  for (;;) {
    if (progress.cancelled() || stop) return false;
    pollfd polled{from.get(), POLLIN, 0};
    const int ready = poll(&polled, 1, 100);
    if (ready < 0 && errno != EINTR) return true;
    if (ready <= 0) continue;
    const ssize_t count = read(from.get(), chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return true;
    text.append(chunk.data(), std::size_t(count));
  }
}

/// What a process says that it read beside its input.
std::vector<std::string> files_beside(const nlohmann::ordered_json& report) {
  std::vector<std::string> files;
  if (!report.is_object() || !report.contains("files")) return files;
  for (const auto& file : report["files"])
    if (file.is_string()) files.push_back(file.get<std::string>());
  return files;
}

class Batch {
 public:
  Batch(const ConvertCommand& command, std::vector<BatchFile> files)
      : command_(command), files_(std::move(files)), results_(files_.size()) {
    record_ = BatchRecord::load(command.output);
    for (const std::string& word : command.file_options) words_ += (words_.empty() ? "" : " ") + word;
    jobs_ = std::min<unsigned>(command.jobs.value_or(std::max(1u, std::thread::hardware_concurrency())),
                               unsigned(files_.size()));
    const unsigned threads =
        command.common.threads ? command.common.threads : std::max(1u, std::thread::hardware_concurrency());
    threads_ = std::max(1u, threads / jobs_);
  }

  void run(const Progress& progress) {
    std::vector<std::thread> workers;
    for (unsigned k = 0; k < jobs_; ++k)
      workers.emplace_back([&] {
        for (std::size_t i = next_++; i < files_.size() && !stop_ && !progress.cancelled(); i = next_++) {
          convert(i, progress);
          const std::lock_guard lock(mutex_);
          ++done_;
          if (progress.report) progress.report(files_[i].input, double(done_) / double(files_.size()));
        }
      });
    for (std::thread& worker : workers) worker.join();
    // Also what was made before a failure or an interruption is known the next time.
    saved_ = record_.save(command_.output);
  }

  [[nodiscard]] const std::vector<BatchFile>& files() const { return files_; }
  [[nodiscard]] const std::vector<BatchResult>& results() const { return results_; }
  [[nodiscard]] const Status& saved() const { return saved_; }

 private:
  void convert(std::size_t i, const Progress& progress) {
    const BatchFile& file = files_[i];
    BatchResult& result = results_[i];
    {
      const std::lock_guard lock(mutex_);
      if (!command_.force && record_.up_to_date(file, words_)) {
        result.outcome = Outcome::kSkipped;
        return;
      }
    }
    const auto start = std::chrono::steady_clock::now();
    std::string text;
    const int status = run_process(file, progress, text);
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (progress.cancelled() || (stop_ && status < 0)) return;
    result.json = nlohmann::ordered_json::parse(text, nullptr, false);
    if (status == 0) {
      result.outcome = Outcome::kMade;
      const std::lock_guard lock(mutex_);
      record_.note(file, words_, files_beside(result.json));
      return;
    }
    result.outcome = Outcome::kFailed;
    result.exit = WIFEXITED(status) ? WEXITSTATUS(status) : int{kExitLimit};
    result.message = "it ended without a word; it may take more memory than there is";
    if (result.json.is_object() && result.json.contains("error") && result.json["error"].is_object())
      result.message = result.json["error"].value("message", result.message);
    if (!command_.keep_going) stop_ = true;
  }

  /// The status of the process that converts a file; -1 if it was stopped.
  int run_process(const BatchFile& file, const Progress& progress, std::string& text) const {
    std::vector<std::string> words = {"convert", file.input, file.output, "--json", "--quiet"};
    words.push_back("--threads=" + std::to_string(threads_));
    if (command_.no_clobber) words.emplace_back("--no-clobber");
    words.insert(words.end(), command_.file_options.begin(), command_.file_options.end());
    ChildProcess child;
    Descriptor to, from;
    if (Status status = child.start("/proc/self/exe", words, to, from, true); !status) {
      text = nlohmann::json{{"error", {{"message", status.error().message}}}}.dump();
      return int{kExitOutput} << 8;
    }
    to.close();
    if (read_output(from, progress, stop_, text)) return child.wait();
    child.ask_to_end();
    (void)child.wait();
    return -1;
  }

  const ConvertCommand& command_;
  std::vector<BatchFile> files_;
  std::vector<BatchResult> results_;
  BatchRecord record_;
  std::string words_;
  unsigned jobs_ = 1, threads_ = 1;
  std::mutex mutex_;
  std::atomic<std::size_t> next_ = 0;
  std::size_t done_ = 0;
  std::atomic<bool> stop_ = false;
  Status saved_;
};

struct Counts {
  std::size_t made = 0, skipped = 0, failed = 0, not_begun = 0;
  int exit = kExitDone;
};

Counts count(const std::vector<BatchResult>& results) {
  Counts counts;
  for (const BatchResult& result : results) {
    counts.made += result.outcome == Outcome::kMade;
    counts.skipped += result.outcome == Outcome::kSkipped;
    counts.failed += result.outcome == Outcome::kFailed;
    counts.not_begun += result.outcome == Outcome::kNotBegun;
    if (counts.exit == kExitDone) counts.exit = result.exit;
  }
  return counts;
}

std::string summary_text(const Batch& batch, const Counts& counts, double seconds) {
  std::string text;
  for (std::size_t i = 0; i < batch.files().size(); ++i) {
    const BatchResult& result = batch.results()[i];
    const BatchFile& file = batch.files()[i];
    if (result.outcome == Outcome::kMade) {
      char line[64];
      std::snprintf(line, sizeof line, " (%.1f s)\n", result.seconds);
      text += "made       " + printable(file.output) + line;
      if (result.json.is_object() && result.json.contains("warnings") && result.json["warnings"].is_array())
        for (const auto& warning : result.json["warnings"])
          if (warning.is_object())
            text += "             " + printable(warning.value("text", std::string())) + "\n";
    }
    if (result.outcome == Outcome::kFailed)
      text += "failed     " + printable(file.input) + ": " + printable(result.message) + "\n";
  }
  char line[160];
  std::snprintf(line, sizeof line, "%zu made, %zu up to date, %zu failed, %zu not begun, in %.1f s\n",
                counts.made, counts.skipped, counts.failed, counts.not_begun, seconds);
  return text + line;
}

nlohmann::ordered_json summary_json(const Batch& batch, const Counts& counts, double seconds) {
  nlohmann::ordered_json json;
  json["made"] = counts.made;
  json["up_to_date"] = counts.skipped;
  json["failed"] = counts.failed;
  json["not_begun"] = counts.not_begun;
  json["seconds"] = seconds;
  json["files"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < batch.files().size(); ++i) {
    const BatchResult& result = batch.results()[i];
    nlohmann::ordered_json file;
    file["input"] = batch.files()[i].input;
    file["output"] = batch.files()[i].output;
    file["status"] = outcome_name(result.outcome);
    file["exit"] = result.exit;
    file["seconds"] = result.seconds;
    if (result.outcome == Outcome::kFailed) file["message"] = result.message;
    if (result.outcome == Outcome::kMade && result.json.is_object()) file["report"] = result.json;
    json["files"].push_back(std::move(file));
  }
  return json;
}

}  // namespace

void end_with_batch() {
  const char* const parent = std::getenv(kParentVariable);
  if (parent && *parent) end_with_parent(std::strtol(parent, nullptr, 10));
}

int run_batch(const ConvertCommand& command) {
  const Console console(command.common);
  std::vector<BatchFile> files;
  if (auto failure = plan_batch(command, files)) return console.fail(*failure);
  std::error_code error;
  std::filesystem::create_directories(command.output, error);
  if (error)
    return console.fail(Error{ErrorCode::kOutput, "the folder cannot be made (" + error.message() + ")"},
                        command.output);
  setenv(kParentVariable, std::to_string(getpid()).c_str(), 1);
  const auto start = std::chrono::steady_clock::now();
  ProgressBar bar(!console.quiet());
  Batch batch(command, std::move(files));
  batch.run(bar.progress());
  bar.finish();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  Counts counts = count(batch.results());
  if (bar.progress().cancelled()) counts.exit = kExitInterrupted;
  if (!batch.saved())
    console.warn(command.output,
                 "what is up to date could not be noted there, " + batch.saved().error().message);
  if (console.json()) return console.finish(json_text(summary_json(batch, counts, seconds)), counts.exit);
  const std::string text = summary_text(batch, counts, seconds);
  if (console.quiet() && counts.exit == kExitDone) return counts.exit;
  return console.finish(text, counts.exit);
}

}  // namespace mesocell
