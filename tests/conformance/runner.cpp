#include "tests/conformance/runner.h"

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <map>
#include <ostream>
#include <sstream>

#include "tests/conformance/reader_process.h"

namespace mesocell::conformance {
namespace {

struct Count {
  std::size_t passed = 0, failed = 0;
};

/// "3.10" after "3.9".
struct ByNumbers {
  bool operator()(const std::string& a, const std::string& b) const { return numbers(a) < numbers(b); }
  static std::vector<int> numbers(const std::string& clause) {
    std::vector<int> result;
    std::istringstream in(clause);
    for (std::string part; std::getline(in, part, '.');) result.push_back(std::atoi(part.c_str()));
    return result;
  }
};

bool is_hex16(const std::string& text) {
  return text.size() == 16 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

bool chosen(const Entry& entry, const std::string& only) {
  return entry.path.starts_with(only) || entry.path.substr(entry.path.find('/') + 1).starts_with(only);
}

std::string expectation(const Entry& entry) {
  std::string text = entry.verdict;
  if (entry.verdict == "valid") return text + " " + entry.digest;
  if (entry.verdict == "limit") return text;
  for (const std::string& id : entry.report) text += (&id == &entry.report.front() ? " " : " or ") + id;
  return text;
}

void print_failure(const Manifest& manifest, const Entry& entry, const std::string& fault,
                   std::ostream& out) {
  out << "FAILED " << entry.path << "\n  " << fault << "\n  expected: " << expectation(entry) << "\n  clause "
      << entry.clause;
  const std::string rule = manifest.rule_text(entry.issue);
  if (!rule.empty()) out << ": " << entry.issue << ", " << rule;
  out << '\n';
}

}  // namespace

std::string fault_of_answer(const Entry& entry, const std::string& answer, bool ids) {
  const std::string word = answer.substr(0, answer.find(' '));
  const std::string rest = answer.size() > word.size() ? answer.substr(word.size() + 1) : "";
  const bool well_formed =
      (word == "valid" && is_hex16(rest)) ||
      (word == "invalid" && rest.find(' ') == std::string::npos && (answer == word || !rest.empty())) ||
      answer == "limit";
  if (!well_formed) return "not an answer of the protocol: '" + answer + "'";
  if (word != entry.verdict) return "the reader says: " + answer;
  if (word == "valid" && rest != entry.digest) return "it holds something else: " + answer;
  if (word == "invalid" && ids &&
      std::find(entry.report.begin(), entry.report.end(), rest) == entry.report.end())
    return "refused for something else: " + answer;
  return {};
}

int run(const Manifest& manifest, const RunOptions& options, std::ostream& out) {
  constexpr std::size_t kTries = 3;  // of a reader that has never answered
  ReaderProcess reader(options.command);
  std::map<std::string, Count, ByNumbers> counts;
  Count all;
  std::size_t answers = 0;
  for (const Entry& entry : manifest.files) {
    if (!chosen(entry, options.only)) continue;
    const auto path =
        std::filesystem::absolute(std::filesystem::path(entry.folder) / entry.path).lexically_normal();
    const ReaderProcess::Reply reply = reader.ask(path.string(), options.time);
    if (reply.answered) ++answers;
    const std::string fault = reply.answered ? fault_of_answer(entry, reply.text, options.ids) : reply.text;
    // Who does not keep to the protocol may not keep to the order of the questions either.
    if (reply.answered && fault.starts_with("not an answer")) reader.stop();
    Count& count = counts[entry.clause];
    ++(fault.empty() ? count.passed : count.failed);
    ++(fault.empty() ? all.passed : all.failed);
    if (!fault.empty()) print_failure(manifest, entry, fault, out);
    if (answers == 0 && all.failed == kTries) {
      out << "the reader does not answer: " << options.command << '\n';
      return 2;
    }
  }
  if (all.passed + all.failed == 0) {
    out << "no file begins with '" << options.only << "'\n";
    return 2;
  }
  out << "clause   passed   failed\n";
  for (const auto& [clause, count] : counts)
    out << std::left << std::setw(6) << clause << std::right << std::setw(9) << count.passed << std::setw(9)
        << count.failed << '\n';
  out << all.passed << " passed, " << all.failed << " failed\n";
  return all.failed == 0 ? 0 : 1;
}

}  // namespace mesocell::conformance
