/* pbf-bench ablation: what each feature costs, used and unused. */
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "ablation/ablation.h"
#include "commands/commands.h"
#include "commands/options.h"
#include "core/error.h"
#include "core/interrupt.h"

namespace bench {
namespace {

struct Options {
  SceneOptions scene;
  AblationOptions ablation;
  std::vector<std::string> against;
  std::string json, html;
};

// "name=folder" or a folder alone, which is then the name; made absolute, as PBF_BACKEND_PATH wants
// it.
LibraryBuild build_of(const std::string &text) {
  const size_t equals = text.find('=');
  const bool named = equals != std::string::npos && text.find('/') > equals;
  const std::string folder = named ? text.substr(equals + 1) : text;
  std::error_code failed;
  const auto path = std::filesystem::canonical(folder, failed);
  if (failed || !std::filesystem::is_directory(path) ||
      path.string().find(':') != std::string::npos) {
    throw Error(exit_usage, "--against " + text +
                                ": no folder that can be searched; wanted: where another build "
                                "has its pbf_backend_….so, lib/pbf/backends");
  }
  return {named ? text.substr(0, equals) : folder, path.string()};
}

int run_ablation(Options options) {
  for (const std::string &text : options.against)
    options.ablation.against.push_back(build_of(text));
  Scene scene = load_scene(options.scene);
  if (!scene.emitters.empty() || !scene.drains.empty())
    throw Error(exit_usage, "--scene: " + scene.name +
                                " has emitters or drains; what is compared has as many particles "
                                "in each variant");
  tell_of_misfit(options.scene, scene);
  if (options.scene.steps == 0) scene.steps = std::min<uint32_t>(scene.steps, 50);
  catch_interrupts();
  const Ablation ablation = ablate(scene, options.ablation);
  std::printf("%s: %llu particles, rounds of %u steps\n\n%s", scene.name.c_str(),
              static_cast<unsigned long long>(count_particles(scene)), scene.steps,
              ablation_table(ablation).c_str());
  if (!options.json.empty()) write_ablation_json(ablation, options.json);
  if (!options.html.empty()) write_ablation_page(ablation, options.html);
  return interrupted() ? exit_interrupted : exit_ok;
}

}  // namespace

std::pair<CLI::App *, Command> add_ablation(CLI::App &app) {
  auto options = std::make_shared<Options>();
  AblationOptions &ablation = options->ablation;
  CLI::App *command =
      app.add_subcommand("ablation",
                         "What each feature costs, used and unused: from the scene's "
                         "minimal plan upward, one feature at a time");
  add_scene_options(*command, options->scene);
  command->get_option("--scene")->required();
  command->get_option("--steps")->description("steps of a round (at most 50 of the scene's)");
  command->add_option("--backend", ablation.solver.backend, "which backend")
      ->type_name("B")
      ->capture_default_str();
  command->add_option("--threads", ablation.solver.threads, "CPU threads (0: all)")
      ->type_name("N")
      ->capture_default_str();
  add_precision_option(*command, ablation.solver.precision);
  add_device_option(*command, ablation.solver.device);
  command->add_option("--rounds", ablation.rounds, "in which every row runs once")
      ->type_name("N")
      ->check(positive())
      ->capture_default_str();
  command->add_flag("--cpu-time", ablation.cpu_time,
                    "what the process has worked, for machines that others use too; CPU backends "
                    "with one thread");
  command
      ->add_option("--run-up", ablation.run_up,
                   "steps of the scene as it is before the measured ones")
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--against", options->against,
                   "instead: the minimal plan on this build, on it again, and on the builds whose "
                   "backends lie in these folders")
      ->type_name("[NAME=]DIR");
  command->add_option("--json", options->json, "all figures into this file")->type_name("F");
  command->add_option("--html", options->html, "the table into this file, a single page")
      ->type_name("F");
  return {command, [options] { return run_ablation(*options); }};
}

}  // namespace bench
