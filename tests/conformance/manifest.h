#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// What manifest.json says of the suite's files. It knows nothing of the libraries that are tested.
namespace mesocell::conformance {

/// A row of the issue catalogue, as it was when the manifest was written.
struct Rule {
  std::string id, clause, severity, text;
};

struct Entry {
  std::string path;     ///< from the manifest's folder
  std::string verdict;  ///< "valid", "invalid" or "limit"
  std::string clause;
  std::string issue;                ///< that the file is for; empty for a valid one without remarks
  std::vector<std::string> report;  ///< ids that a validator finds, each once
  std::string xxh64;                ///< of the file, 16 hexadecimal digits
  std::uint64_t bytes = 0;
  std::string digest;    ///< of what a valid file holds, else empty
  std::string folder{};  ///< where the manifest was read from, which does not know that
};

struct Manifest {
  std::string version;  ///< of the format, "1.0"
  std::vector<Rule> rules;
  std::vector<Entry> files;
  /// The text of an issue's rule, empty if it is unknown.
  [[nodiscard]] std::string rule_text(std::string_view issue) const;
};

[[nodiscard]] std::string to_json(const Manifest& manifest);
/// Throws std::runtime_error with the place if that is not a manifest.
[[nodiscard]] Manifest parse_manifest(std::string_view json);

/// 16 lower-case hexadecimal digits.
[[nodiscard]] std::string hex16(std::uint64_t value);

}  // namespace mesocell::conformance
