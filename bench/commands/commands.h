/* The subcommands of pbf-bench, one file each. A new one is a function here and a line in main. */
#ifndef PBF_BENCH_COMMANDS_H
#define PBF_BENCH_COMMANDS_H

#include <CLI/CLI.hpp>
#include <functional>

namespace bench {

// Adds the subcommand and its options to `app`. Returns what runs it, and gives the exit code.
using Command = std::function<int()>;
using AddCommand = std::pair<CLI::App *, Command> (*)(CLI::App &app);

std::pair<CLI::App *, Command> add_ablation(CLI::App &app);
std::pair<CLI::App *, Command> add_list(CLI::App &app);
std::pair<CLI::App *, Command> add_pareto(CLI::App &app);
std::pair<CLI::App *, Command> add_picture(CLI::App &app);
std::pair<CLI::App *, Command> add_record(CLI::App &app);
std::pair<CLI::App *, Command> add_replay(CLI::App &app);
std::pair<CLI::App *, Command> add_run(CLI::App &app);
std::pair<CLI::App *, Command> add_speedup(CLI::App &app);
std::pair<CLI::App *, Command> add_stability(CLI::App &app);
std::pair<CLI::App *, Command> add_startup(CLI::App &app);
std::pair<CLI::App *, Command> add_validate(CLI::App &app);
std::pair<CLI::App *, Command> add_worlds(CLI::App &app);

}  // namespace bench

#endif
