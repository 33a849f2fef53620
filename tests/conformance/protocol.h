#pragma once

#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

/// The side of the protocol that a reader is on, see README.md.
namespace mesocell::conformance {

/// Answers every line on standard input, a path, with one line: what `answer(bytes)` says of the file.
template <typename Answer>
int serve(Answer answer) {
  for (std::string path; std::getline(std::cin, path);) {
    std::ifstream in(path, std::ios::binary);
    if (!in) {
      std::cerr << path << " cannot be read\n";
      return 1;
    }
    const std::vector<char> bytes(std::istreambuf_iterator<char>(in), {});
    std::cout << answer(bytes) << std::endl;  // with a flush: the other side waits for it
  }
  return 0;
}

}  // namespace mesocell::conformance
