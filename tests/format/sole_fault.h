#pragma once

#include <string>
#include <vector>

#include "tests/format/test_file.h"
#include "tests/support/catch.h"

namespace mesocell::test {

/// Whether a file is refused by all who read it, for that reason alone.
inline void check_sole_fault(const Bytes& file, const std::string& id) {
  CAPTURE(id);
  const Verdicts v = verdicts(file);
  CAPTURE(v.why, v.reader_id, v.loader_text);
  CHECK(v.agree);
  CHECK_FALSE(v.reader);
  CHECK(v.issues == std::vector<std::string>{id});
}

inline void check_sole_fault(const CellObject& object, const std::string& id) {
  check_sole_fault(TestFile::of(object).build(), id);
}

}  // namespace mesocell::test
