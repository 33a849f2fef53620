#include <cstdio>
#include <exception>
#include <new>

#include "converters/cli/command_line.h"
#include "converters/cli/exit_codes.h"
#include "converters/cli/interrupt.h"
#include "format/file.h"

int main(int argc, char** argv) {
  mesocell::install_signal_handlers();
  // A third party's exception must not end in an abort that leaves a temporary file and no message.
  try {
    return mesocell::run_command_line(argc, argv);
  } catch (const std::bad_alloc&) {
    mesocell::remove_temporary_files();
    std::fputs("mesocell: there is not enough memory; use fewer tiles, a smaller tile or a smaller picture\n",
               stderr);
  } catch (const std::exception& exception) {
    mesocell::remove_temporary_files();
    std::fprintf(stderr, "mesocell: internal error (%s); please report it\n", exception.what());
  }
  return mesocell::kExitLimit;
}
