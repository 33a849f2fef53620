#include "tests/fuzz/fuzz.h"

#include <cstdio>
#include <cstdlib>

namespace mesocell::fuzz {

void fail(const char* source, int line, const char* promise) {
  std::fprintf(stderr, "%s:%d: broken promise: %s\n", source, line, promise);
  std::abort();
}

}  // namespace mesocell::fuzz
