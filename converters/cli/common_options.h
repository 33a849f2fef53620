#pragma once

#include <CLI/CLI.hpp>

#include "converters/cli/console.h"

/// Options that several subcommands have.
namespace mesocell {

inline void add_reporting(CLI::App& app, CommonOptions& options) {
  app.add_flag("--json", options.json,
               "Print the result as JSON; a failure is printed as {\"error\": {...}}");
  app.add_flag("--quiet", options.quiet, "Print no progress, no warnings and no summary");
}

inline void add_common(CLI::App& app, CommonOptions& options) {
  add_reporting(app, options);
  app.add_option("--threads", options.threads, "Threads to use, 0 for all; the result does not depend on it")
      ->type_name("N")
      ->check(CLI::Range(0u, 1024u).description(""));
}

inline void add_no_clobber(CLI::App& app, bool& no_clobber) {
  app.add_flag("--no-clobber", no_clobber, "Fail if the output exists, instead of replacing it");
}

}  // namespace mesocell
