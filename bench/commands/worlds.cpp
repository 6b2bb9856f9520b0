/* pbf-bench worlds: many small worlds in a batch, one after another, and as one large world. */
#include "worlds/worlds.h"

#include <cstdio>
#include <memory>

#include "commands/commands.h"
#include "commands/options.h"
#include "core/interrupt.h"

namespace bench {
namespace {

struct WorldsCommand {
  SceneOptions scene;
  WorldsOptions worlds;
  std::string json;
};

int run_worlds(WorldsCommand options) {
  if (options.scene.particles == 0) options.scene.particles = 1000;
  if (options.scene.steps == 0) options.scene.steps = 20;
  const Scene small = load_scene(options.scene);
  options.scene.particles = count_particles(small) * options.worlds.worlds;
  const Scene large = load_scene(options.scene);
  catch_interrupts();
  const std::vector<WorldsRow> rows = measure_worlds(small, large, options.worlds);
  std::printf("%s, %u steps of %u iterations\n\n%s", small.name.c_str(), small.steps,
              small.params.iterations, worlds_table(rows).c_str());
  if (!options.json.empty()) write_worlds_json(small, rows, options.json);
  if (interrupted()) return exit_interrupted;
  for (const WorldsRow &row : rows)
    if (row.reason.empty()) return exit_ok;
  return exit_unavailable;
}

}  // namespace

std::pair<CLI::App *, Command> add_worlds(CLI::App &app) {
  auto options = std::make_shared<WorldsCommand>();
  options->scene.name = "dam-break-3d";
  CLI::App *command = app.add_subcommand(
      "worlds", "Many small worlds in a batch, one solver after another, and as one large world");
  add_scene_options(*command, options->scene);
  command->get_option("--particles")->description("of a world (1000)");
  command->get_option("--steps")->description("of a repetition (20)");
  add_worlds_options(*command, options->worlds, "how many, 1 … 65536");
  command->add_option("--repetitions", options->worlds.repetitions, "timed runs a row")
      ->type_name("N")
      ->check(positive())
      ->capture_default_str();
  command->add_option("--json", options->json, "all figures into this file")->type_name("F");
  return {command, [options] { return run_worlds(*options); }};
}

}  // namespace bench
