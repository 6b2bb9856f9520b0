/* pbf-bench run: one scene on one backend, with a trace and dumps. */
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "commands/commands.h"
#include "core/error.h"
#include "commands/options.h"
#include "core/dump.h"
#include "core/interrupt.h"
#include "core/progress.h"
#include "core/solver.h"
#include "core/table.h"
#include "core/trace.h"

namespace bench {
namespace {

using Clock = std::chrono::steady_clock;

struct RunOptions {
  SceneOptions scene;
  SolverOptions solver;
  std::string csv;
  std::string dump;
  std::string pictures;
  Portrait portrait;
  uint64_t every = 0;
  uint32_t steps_per_call = 0;
  bool stages = false;
};

// How many steps go into one call: all that nothing between them wants to see, but not so many
// that Ctrl-C and the progress bar wait for long.
class Batch {
 public:
  explicit Batch(uint32_t fixed) : fixed_(fixed) {}

  uint64_t size() const { return fixed_ > 0 ? fixed_ : size_; }

  void took(uint64_t steps, double seconds) {
    constexpr double patience = 0.25;
    if (steps == size_ && seconds < patience / 2) size_ = std::min<uint64_t>(2 * size_, 1u << 16);
    if (seconds > 2 * patience && size_ > 1) size_ /= 2;
  }

 private:
  uint64_t fixed_;
  uint64_t size_ = 1;
};

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void draw(const RunOptions &options, const Solver &solver, uint64_t step) {
  if (options.pictures.empty()) return;
  std::error_code ignored;
  std::filesystem::create_directories(options.pictures, ignored);
  char name[32];
  std::snprintf(name, sizeof name, "/%06llu.png", static_cast<unsigned long long>(step));
  write_picture(options.pictures + name, draw_solver(solver.handle(), options.portrait));
}

// Runs to the end or to Ctrl-C; returns the seconds spent in steps.
double run_steps(Solver &solver, uint64_t steps, const RunOptions &options, Trace *trace,
                 Dump &dump) {
  Progress progress;
  Batch batch(trace ? 1 : options.steps_per_call);
  double seconds = 0;
  for (uint64_t done = 0; done < steps && !interrupted();) {
    const uint64_t to_picture = !options.pictures.empty() && options.every > 0
                                    ? options.every - done % options.every
                                    : steps;
    const uint64_t now =
        std::min({steps - done, batch.size(), dump.steps_to_next(done), to_picture});
    const auto start = Clock::now();
    solver.step(static_cast<uint32_t>(now));
    solver.synchronize();
    const double took = seconds_since(start);
    batch.took(now, took);
    seconds += took;
    done += now;
    if (trace) trace->add(solver.info(), solver.stats());
    if (dump.due(done)) dump.write(solver);
    if (now == to_picture || done == steps) draw(options, solver, done);
    progress.show(static_cast<double>(done) / static_cast<double>(steps),
                  "step " + std::to_string(done) + " of " + std::to_string(steps));
  }
  return seconds;
}

void print_summary(FILE *out, const Scene &scene, const Solver &solver, double seconds) {
  const pbf_info info = solver.info();
  const pbf_stats stats = solver.stats();
  std::fprintf(out, "scene      %s: %u particles, %uD, %s\n", scene.name.c_str(), stats.count,
               info.dimension, info.precision == PBF_FLOAT64 ? "float64" : "float32");
  std::fprintf(out, "backend    %s on %s, %u threads; %s\n", info.backend, info.device_name,
               info.threads, info.build_id);
  std::fprintf(out, "simulated  %llu steps, %.6g time units; state %016llx\n",
               static_cast<unsigned long long>(info.step), info.time,
               static_cast<unsigned long long>(solver.hash()));
  std::fprintf(out, "fluid      density error mean %.3g, max %.3g; fastest %.4g; %.3g neighbours\n",
               stats.density_error_mean, stats.density_error_max, stats.speed_max,
               stats.neighbors_mean);
  if (info.step == 0 || seconds <= 0) return;
  const double steps = static_cast<double>(info.step);
  std::fprintf(out, "time       %.4g ms a step, %.4g million particle-iterations/s\n",
               1e3 * seconds / steps,
               1e-6 * stats.count * scene.params.iterations * steps / seconds);
}

void print_stages(FILE *out, const Solver &solver, uint64_t steps) {
  const pbf_timings timings = solver.timings();
  Table table({"stage", "ms a step", "runs"});
  table.align_right(1, 2);
  for (uint32_t i = 0; i < timings.stage_count; ++i) {
    char ms[32];
    std::snprintf(ms, sizeof ms, "%.4g",
                  timings.stages[i].milliseconds / static_cast<double>(steps));
    table.add({timings.stages[i].name, ms, std::to_string(timings.stages[i].runs)});
  }
  std::fprintf(out, "%s", table.text().c_str());
}

int run(const RunOptions &options) {
  if (options.every > 0 && options.dump.empty() && options.pictures.empty())
    throw Error(exit_usage, "--every needs --dump or --pictures");
  const Scene scene = load_scene(options.scene);
  tell_of_misfit(options.scene, scene);
  const uint64_t steps =
      options.scene.steps > 0 ? scene.steps : uint64_t{scene.lead_in_steps} + scene.steps;
  Solver solver(scene, options.solver);
  if (options.stages) solver.set_timing(true);
  Dump dump(options.dump, options.every, scene, solver.info());
  std::unique_ptr<Trace> trace;
  if (!options.csv.empty()) trace = std::make_unique<Trace>(options.csv);
  dump.write(solver);
  draw(options, solver, 0);
  catch_interrupts();
  const double seconds = run_steps(solver, steps, options, trace.get(), dump);
  if (trace) trace->finish();
  dump.write(solver);
  FILE *out = options.csv == "-" ? stderr : stdout;
  print_summary(out, scene, solver, seconds);
  if (options.stages && solver.info().step > 0) print_stages(out, solver, solver.info().step);
  return interrupted() ? exit_interrupted : exit_ok;
}

}  // namespace

std::pair<CLI::App *, Command> add_run(CLI::App &app) {
  auto options = std::make_shared<RunOptions>();
  CLI::App *command = app.add_subcommand("run", "One scene on one backend, with a trace and dumps");
  add_scene_options(*command, options->scene);
  command->get_option("--scene")->required();
  command->add_option("--backend", options->solver.backend, "which backend: this one or none")
      ->type_name("B")
      ->required();
  command->add_option("--threads", options->solver.threads, "CPU threads (0: all)")
      ->type_name("N")
      ->capture_default_str();
  add_precision_option(*command, options->solver.precision);
  add_device_option(*command, options->solver.device);
  add_determinism_option(*command, options->solver.is_per_machine);
  command->add_option("--csv", options->csv, "one row a step into this file (-: standard output)")
      ->type_name("F");
  command
      ->add_option(
          "--dump", options->dump,
          "positions, velocities and, where the solver keeps them, pressures as "
          ".npy into this folder, first and last, and dump.json for pbf-check; in place of "
          "what another run has dumped there")
      ->type_name("DIR");
  command->add_option("--every", options->every, "… and every so many steps, of dumps and pictures")
      ->type_name("K")
      ->check(positive());
  command
      ->add_option(
          "--pictures", options->pictures,
          "the first and the last state, and those of --every, as PNG files into this folder")
      ->type_name("DIR");
  add_portrait_options(*command, options->portrait);
  command
      ->add_option("--steps-per-call", options->steps_per_call,
                   "steps in one call of pbf_step (0: as many as take a quarter of a second; with "
                   "--csv it is 1)")
      ->type_name("N")
      ->capture_default_str();
  command->add_flag("--stages", options->stages, "time each stage (slows a device down)");
  return {command, [options] { return run(*options); }};
}

}  // namespace bench
