/* pbf-bench pareto: error against run time. */
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>

#include "commands/commands.h"
#include "commands/options.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/machine.h"
#include "core/number_option.h"
#include "core/scratch.h"
#include "pareto/runner.h"
#include "pareto/words.h"
#include "report/pareto.h"

namespace bench {
namespace {

namespace fs = std::filesystem;

struct ParetoOptions {
  PlanOptions plan;
  RunnerOptions runner;
  std::string sweep, html = "out/pareto.html";
  unsigned repetitions = 5;
  bool quick = false;
};

// Small enough for a test, in everything that the command line leaves open.
void make_quick(ParetoOptions &options, const CLI::App &command) {
  const auto left_out = [&](const char *name) { return command.get_option(name)->empty(); };
  if (left_out("--particles")) options.plan.scene.particles = 400;
  if (left_out("--steps") && left_out("--duration")) options.plan.scene.steps = 24;
  if (left_out("--frames")) options.plan.frames = 3;
  if (left_out("--repetitions")) options.repetitions = 2;
}

Sweep sweep_of(const ParetoOptions &options, const std::string &scene) {
  if (!options.sweep.empty()) return read_sweep(read_document(options.sweep), scene);
  return options.quick ? quick_sweep(scene) : default_sweep(scene);
}

void refuse_twice(const std::vector<std::string> &names) {
  std::set<std::string> seen;
  for (const std::string &name : names) {
    if (seen.insert(name).second) continue;
    throw Error(exit_usage, "--backends: \"" + name + "\" stands twice");
  }
}

// Points whose backend can't serve here have that as their reason.
void mark_unavailable(Study &study) {
  std::map<std::string, std::string> reasons;
  for (Point &point : study.plan.points) {
    if (point.outcome.judged()) continue;
    const std::string which = point.solver.backend + std::to_string(point.solver.precision);
    const auto [found, is_new] = reasons.emplace(which, "");
    if (is_new) found->second = reason_against(point.solver, point.scene);
    point.outcome.reason = found->second;
  }
  const auto can_run = [](const Point &point) {
    return point.outcome.reason.empty() || was_timed(point);
  };
  const std::vector<Point> &points = study.plan.points;
  if (std::any_of(points.begin(), points.end(), can_run)) return;
  throw Error(exit_unavailable, "no point can run: " + points.front().outcome.reason);
}

void name_builds(Study &study) {
  for (const pbf_backend_info &info : list_backends({}, &study.plan.scene)) {
    for (const Point &point : study.plan.points) {
      if (point.solver.backend != info.name || !info.available) continue;
      study.builds[info.name] = {info.device_name, info.build_id};
      break;
    }
  }
}

void print_start(const Study &study, size_t resumed) {
  const Scene &scene = study.plan.scene;
  const Machine machine = this_machine();
  std::printf("%s: %s\n%llu particles, %uD, %.4g simulated; %zu points; %s, %u CPUs; commit %s\n",
              scene.name.c_str(), scene.description.c_str(),
              static_cast<unsigned long long>(count_particles(scene)), scene.dimension,
              scene.steps * scene.params.time_step, study.plan.points.size(), machine.cpu.c_str(),
              machine.cpus, machine.commit.c_str());
  if (resumed > 0) std::printf("%zu points are there already\n", resumed);
  std::printf("\n");
  std::fflush(stdout);
}

// Outcomes of another build, scene or sweep are kept beside the file, never overwritten.
size_t resume_from(const std::string &json, Study &study) {
  if (json.empty()) return 0;
  const size_t others = resume(json, study);
  if (others > 0) {
    const std::string kept = json + ".old";
    std::error_code failed;
    fs::copy_file(json, kept, fs::copy_options::overwrite_existing, failed);
    if (failed) throw Error(exit_failure, kept + " can't be written: " + failed.message());
    std::printf("%zu points in %s are of another build, machine, scene or sweep: kept in %s\n",
                others, json.c_str(), kept.c_str());
  }
  return static_cast<size_t>(
      std::count_if(study.plan.points.begin(), study.plan.points.end(),
                    [](const Point &point) { return point.outcome.judged(); }));
}

int finish(const Study &study, const ParetoOptions &options) {
  std::printf("%s\n%s\n", study_table(study).c_str(), headline(study).c_str());
  if (!options.runner.json.empty()) write_results(study, options.runner.json);
  if (!options.html.empty()) {
    write_pareto_page(study, options.html);
    std::printf("The page is %s\n", options.html.c_str());
  }
  if (interrupted()) return exit_interrupted;
  const std::vector<Point> &points = study.plan.points;
  return std::any_of(points.begin(), points.end(), was_timed) ? exit_ok : exit_failure;
}

int run_pareto(ParetoOptions options, const CLI::App &command) {
  if (options.quick) make_quick(options, command);
  refuse_twice(options.plan.backends);
  const Scene scene = load_scene(options.plan.scene);
  tell_of_misfit(options.plan.scene, scene);
  Study study;
  study.sweep = sweep_of(options, scene.name);
  study.repetitions = options.repetitions;
  study.frames = options.plan.frames;
  study.cpu_time = options.plan.cpu_time;
  const Scratch scratch("pareto");
  options.runner.scratch = scratch.path();
  const Judge judge(scratch.path(), study.sweep.errors);
  options.plan.judge = judge.id();
  study.plan = make_plan(study.sweep, options.plan);
  const size_t resumed = resume_from(options.runner.json, study);
  mark_unavailable(study);
  name_builds(study);
  print_start(study, resumed);
  catch_interrupts();
  run_study(study, judge, options.runner);
  return finish(study, options);
}

void add_measuring_options(CLI::App &command, ParetoOptions &options) {
  command.add_option("--duration", options.plan.duration, "simulated time, in place of --steps")
      ->type_name("T")
      ->check(above_zero())
      ->excludes("--steps");
  command.add_option("--frames", options.plan.frames, "judged, beside the start")
      ->type_name("N")
      ->check(positive())
      ->capture_default_str();
  command.add_option("--repetitions", options.repetitions, "timed runs a point")
      ->type_name("N")
      ->check(positive())
      ->capture_default_str();
  command
      .add_option("--patience", options.runner.patience, "seconds after which a run is given up")
      ->type_name("S")
      ->check(above_zero())
      ->capture_default_str();
  command.add_flag("--cpu-time", options.plan.cpu_time,
                   "count processor time, of all threads: for one thread on a shared machine");
  command.add_flag("--quick", options.quick,
                   "a small sweep of a few seconds, to see that everything works");
}

void add_files(CLI::App &command, ParetoOptions &options) {
  command
      .add_option("--sweep", options.sweep, "what to sweep (bench/sweeps/; a sweep is built in)")
      ->type_name("FILE");
  command
      .add_option("--json", options.runner.json,
                  "results, written after every run; with the same file a sweep goes on")
      ->type_name("F");
  command.add_option("--html", options.html, "charts and tables into this file, a single page")
      ->type_name("F")
      ->capture_default_str();
  command.add_option("--dumps", options.runner.dumps, "keep the dumps that were judged here")
      ->type_name("DIR");
}

}  // namespace

std::pair<CLI::App *, Command> add_pareto(CLI::App &app) {
  auto options = std::make_shared<ParetoOptions>();
  options->plan.scene.name = "dam-break-3d";
  CLI::App *command =
      app.add_subcommand("pareto", "Error against run time: many settings of one scene");
  add_scene_options(*command, options->plan.scene);
  command->add_option("--backends", options->plan.backends, "for the families that name none")
      ->type_name("B,…")
      ->delimiter(',')
      ->capture_default_str();
  add_measuring_options(*command, *options);
  add_files(*command, *options);
  return {command, [options, command] { return run_pareto(*options, *command); }};
}

}  // namespace bench
