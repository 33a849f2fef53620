#pragma once

#include <cstdint>
#include <string>

namespace mesocell {

/// What figures were measured on, as text for people.
struct Machine {
  std::string processor;
  unsigned cores = 0;
  std::uint64_t memory_bytes = 0;
  std::string compiler;  ///< that made this program
};
[[nodiscard]] Machine this_machine();

/// The date and time, UTC, such as 2026-01-31T12:00:00Z.
[[nodiscard]] std::string date_now();

}  // namespace mesocell
