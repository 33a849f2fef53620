#include "converters/bench/machine.h"

#include <unistd.h>

#include <ctime>
#include <fstream>
#include <thread>

namespace mesocell {

Machine this_machine() {
  Machine machine;
  machine.cores = std::thread::hardware_concurrency();
  std::ifstream cpus("/proc/cpuinfo");
  for (std::string line; machine.processor.empty() && std::getline(cpus, line);)
    if (line.starts_with("model name"))
      if (const std::size_t colon = line.find(": "); colon != line.npos)
        machine.processor = line.substr(colon + 2);
  if (machine.processor.empty()) machine.processor = "unknown";
  const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
  if (pages > 0 && page > 0) machine.memory_bytes = std::uint64_t(pages) * std::uint64_t(page);
#if defined(__clang__)
  machine.compiler = "clang " __clang_version__;
#elif defined(__GNUC__)
  machine.compiler = "gcc " __VERSION__;
#else
  machine.compiler = "unknown";
#endif
  return machine;
}

std::string date_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts)};
}

}  // namespace mesocell
