#pragma once

#include <cstddef>

extern "C" [[gnu::weak]] void __asan_init();

namespace mesocell::test {

/// Whether what is tested is compiled with sanitizers. Tests are compiled alike in all presets, so only the
/// linker knows.
inline bool sanitized() { return &__asan_init != nullptr; }

/// How often to try what differs in nothing but random numbers: all of `n` times, and an eighth under
/// sanitizers, which look at each step of the code and take ten times as long. Kinds of cases are never
/// fewer.
inline std::size_t repetitions(std::size_t n) { return sanitized() ? (n + 7) / 8 : n; }

}  // namespace mesocell::test
