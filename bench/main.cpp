/* pbf-bench: runs scenes through libpbf, and measures. */
#include <cstdio>
#include <vector>

#include "commands/commands.h"
#include "core/command_line.h"
#include "core/error.h"
#include "core/failure_message.h"
#include "core/solver.h"
#include "core/standard_streams.h"

namespace {

using namespace bench;

const AddCommand add_commands[] = {add_speedup,   add_pareto,  add_run,      add_ablation,
                                   add_stability, add_picture, add_record,   add_replay,
                                   add_worlds,    add_startup, add_validate, add_list};

const char *const footer =
    "Exit codes: 0 done; 1 failed at run time; 2 wrong command line or scene; 3 no backend can "
    "serve;\n130 interrupted (what there was has been written).";

int run_parsed(CLI::App &app, int argc, char **argv) {
  std::vector<std::pair<CLI::App *, Command>> commands;
  for (const AddCommand add : add_commands) commands.push_back(add(app));
  try {
    parse(app, argc, argv);
  } catch (const CLI::ParseError &error) {
    return app.exit(error) == 0 ? exit_ok : exit_usage;
  }
  for (const std::string &path : app.get_option("--plugin")->results()) load_plugin(path);
  for (const auto &[command, run] : commands) {
    if (command->parsed()) return run();
  }
  return exit_usage;
}

int run_command(CLI::App &app, int argc, char **argv) {
  try {
    return run_parsed(app, argc, argv);
  } catch (const Error &error) {
    std::fprintf(stderr, "pbf-bench: %s\n", one_line(error.what()).c_str());
    return error.code;
  } catch (const std::exception &error) {
    std::fprintf(stderr, "pbf-bench: %s\n", one_line(sentence_of(error)).c_str());
    return exit_failure;
  }
}

}  // namespace

int main(int argc, char **argv) {
  prepare_standard_streams();
  CLI::App app("Position based fluids: scenes, speed and error", "pbf-bench");
  app.require_subcommand(1);
  app.footer(footer);
  app.failure_message(failure_message);
  app.add_option("--plugin", "load this backend too (absolute path)")
      ->type_name("FILE")
      ->expected(1, -1)
      ->allow_extra_args(false);
  return exit_after_output(run_command(app, argc, argv), exit_failure, "pbf-bench");
}
