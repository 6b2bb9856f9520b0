/* pbf-bench speedup: all backends on one scene, side by side. */
#include <algorithm>
#include <cstdio>
#include <set>

#include "commands/commands.h"
#include "commands/options.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/machine.h"
#include "speedup/measure.h"
#include "speedup/speedup.h"

namespace bench {
namespace {

struct SpeedupOptions {
  SceneOptions scene;
  LineUpOptions line_up;
  std::string json, html;
};

bool is_the_report(const SceneOptions &options, const Scene &scene) {
  return options.name == "report-30k" && options.settings.empty() &&
         count_particles(scene) == 30000 && scene.steps == 100;
}

int exit_code_of(const std::vector<Result> &results) {
  if (interrupted()) return exit_interrupted;
  const auto failed = [](const Result &r) { return !r.ran() && !r.unavailable; };
  if (std::any_of(results.begin(), results.end(), failed)) return exit_failure;
  const auto ran = [](const Result &r) { return r.ran(); };
  return std::any_of(results.begin(), results.end(), ran) ? exit_ok : exit_unavailable;
}

void refuse_twice(const std::vector<std::string> &names, const char *option) {
  std::set<std::string> seen;
  for (const std::string &name : names) {
    if (!seen.insert(name).second) {
      throw Error(exit_usage, std::string(option) + ": \"" + name + "\" stands twice");
    }
  }
}

void check_line_up(const LineUpOptions &options) {
  refuse_twice(options.backends, "--backends");
  std::vector<std::string> threads;
  for (const unsigned n : options.threads) threads.push_back(std::to_string(n));
  refuse_twice(threads, "--threads");
}

int run_speedup(const SpeedupOptions &options) {
  check_line_up(options.line_up);
  const Scene scene = load_scene(options.scene);
  tell_of_misfit(options.scene, scene);
  const Machine machine = this_machine();
  std::printf("%s: %s\n%llu particles, %uD, %u steps of %u iterations; %s, %u CPUs; commit %s\n\n",
              scene.name.c_str(), scene.description.c_str(),
              static_cast<unsigned long long>(count_particles(scene)), scene.dimension, scene.steps,
              scene.params.iterations, machine.cpu.c_str(), machine.cpus, machine.commit.c_str());
  std::fflush(stdout);
  catch_interrupts();
  Speedup speedup{scene, measure(scene, line_up(options.line_up), !options.html.empty()),
                  is_the_report(options.scene, scene)};
  std::printf("%s", speedup_table(speedup).c_str());
  std::fflush(stdout);
  if (!options.json.empty()) write_speedup_json(speedup, options.json);
  if (!options.html.empty()) write_speedup_page(speedup, options.html);
  return exit_code_of(speedup.results);
}

}  // namespace

std::pair<CLI::App *, Command> add_speedup(CLI::App &app) {
  auto options = std::make_shared<SpeedupOptions>();
  LineUpOptions &line_up = options->line_up;
  CLI::App *command = app.add_subcommand("speedup", "All backends on one scene, side by side");
  add_scene_options(*command, options->scene);
  command
      ->add_option("--backends", line_up.backends,
                   "which take part; naive is reference in float32 with the scene's cell width")
      ->type_name("B,…")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--threads", line_up.threads,
                   "numbers of threads for openmp (1, 2, 4, … up to the CPUs when not given)")
      ->type_name("N,…")
      ->delimiter(',')
      ->check(positive());
  add_precision_option(*command, line_up.precision);
  add_device_option(*command, line_up.device);
  command->add_option("--repetitions", line_up.repetitions, "timed runs a row")
      ->type_name("N")
      ->check(positive())
      ->capture_default_str();
  command->add_option("--naive-repetitions", line_up.naive_repetitions, "… of the naive row")
      ->type_name("N")
      ->check(positive())
      ->capture_default_str();
  command->add_option("--json", options->json, "Google Benchmark's JSON into this file")
      ->type_name("F");
  command->add_option("--html", options->html, "table and pictures into this file, a single page")
      ->type_name("F");
  return {command, [options] { return run_speedup(*options); }};
}

}  // namespace bench
