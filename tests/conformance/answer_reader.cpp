// The full reader, or the validator, as the suite asks it: mesocell_conformance_reader reader|validator
#include <span>
#include <string_view>

#include "format/validate.h"
#include "tests/conformance/digest.h"
#include "tests/conformance/manifest.h"
#include "tests/conformance/protocol.h"

namespace {

using namespace mesocell;

std::string answer(const Result<std::uint64_t>& digest) {
  if (digest) return "valid " + conformance::hex16(*digest);
  if (digest.error().code == ErrorCode::kLimit) return "limit";
  return "invalid " + std::string(digest.error().id);
}

/// By the report alone: what it does not list is not known.
std::string validated(std::span<const std::byte> file) {
  const ValidationReport report = validate(file);
  if (report.valid) return answer(test::digest_of_chunks(file));
  for (const Issue& issue : report.issues) {
    if (issue.severity != Severity::kError) continue;
    return issue.id == "limit-exceeded" ? "limit" : "invalid " + std::string(issue.id);
  }
  return "invalid";
}

}  // namespace

int main(int count, char** arguments) {
  const std::string_view word = count == 2 ? arguments[1] : "";
  if (word != "reader" && word != "validator") {
    std::cerr << "usage: mesocell_conformance_reader reader|validator\n";
    return 2;
  }
  return conformance::serve([&](const std::vector<char>& bytes) {
    const auto file = std::as_bytes(std::span(bytes));
    return word == "validator" ? validated(file) : answer(test::digest_of_objects(file));
  });
}
