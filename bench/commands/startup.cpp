/* pbf-bench startup: how long it takes to a solver's first step, and to be rid of it. */
#include <cstdio>
#include <memory>

#include "commands/commands.h"
#include "commands/options.h"
#include "core/interrupt.h"
#include "worlds/worlds.h"

namespace bench {
namespace {

struct StartupCommand {
  SceneOptions scene;
  WorldsOptions solvers;
  uint32_t cycles = 200;
  std::string json;
};

int run_startup(StartupCommand options) {
  if (options.scene.particles == 0) options.scene.particles = 1000;
  const Scene scene = load_scene(options.scene);
  catch_interrupts();
  const std::vector<StartupRow> rows = measure_startup(scene, options.solvers, options.cycles);
  std::printf("%s, medians of %u solvers\n\n%s", scene.name.c_str(), options.cycles,
              startup_table(rows).c_str());
  if (!options.json.empty()) write_startup_json(scene, rows, options.json);
  if (interrupted()) return exit_interrupted;
  for (const StartupRow &row : rows)
    if (row.reason.empty()) return exit_ok;
  return exit_unavailable;
}

}  // namespace

std::pair<CLI::App *, Command> add_startup(CLI::App &app) {
  auto options = std::make_shared<StartupCommand>();
  options->scene.name = "dam-break-3d";
  options->solvers.backends = {"reference", "serial", "threads", "openmp"};
  CLI::App *command = app.add_subcommand(
      "startup", "Time to the first step, first and later solvers, and to destroy one");
  add_scene_options(*command, options->scene);
  command->get_option("--particles")->description("of a solver (1000)");
  command->add_option("--cycles", options->cycles, "solvers created and destroyed")
      ->type_name("N")
      ->check(positive())
      ->capture_default_str();
  add_worlds_options(*command, options->solvers, "of the batch");
  command->add_option("--json", options->json, "all figures into this file")->type_name("F");
  return {command, [options] { return run_startup(*options); }};
}

}  // namespace bench
