/* A command line, as the programs beside pbf-bench read it, too. */
#ifndef PBF_BENCH_COMMAND_LINE_H
#define PBF_BENCH_COMMAND_LINE_H

#include <CLI/CLI.hpp>
#include <string>

namespace bench {

// What a script's variable without a value leaves would be taken for an option that is not there.
inline void refuse_empty(const CLI::App &app) {
  for (const CLI::Option *option : app.get_options())
    for (const std::string &value : option->results())
      if (value.empty()) throw CLI::ValidationError(option->get_name(), "its value is empty");
  for (const CLI::App *command : app.get_subcommands()) refuse_empty(*command);
}

inline void parse(CLI::App &app, int argc, char **argv) {
  app.parse(argc, argv);
  refuse_empty(app);
}

}  // namespace bench

#endif
