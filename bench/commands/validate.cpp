/* pbf-bench validate: what the fluid does, against closed forms. */
#include <cmath>
#include <cstdio>

#include "commands/commands.h"
#include "commands/options.h"
#include "core/error.h"
#include "core/number_option.h"
#include "core/output_file.h"
#include "physics/run.h"

namespace bench {
namespace {

struct ValidateOptions {
  physics::Options physics;
  std::vector<std::string> cases;
  std::string json;
};

nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

nlohmann::json json_of(const physics::Figure &f) {
  const bool judged = f.bar > 0;
  return {{"figure", f.name},
          {"is", number(f.is)},
          {"must", number(f.must)},
          {"error", number(f.error)},
          {"unit", f.unit},
          {"bar", judged ? nlohmann::json(f.bar) : nlohmann::json()},
          {"holds", judged ? nlohmann::json(std::fabs(f.error) <= f.bar) : nlohmann::json()}};
}

void print_figure(const physics::Figure &f) {
  std::printf("    %-60s %10.4g", f.name.c_str(), f.is);
  if (f.bar > 0)
    std::printf("  must be %.4g, off by %+.2g%s%s, bar %g: %s", f.must, f.error,
                f.unit.empty() ? "" : " ", f.unit.c_str(), f.bar,
                std::fabs(f.error) <= f.bar ? "holds" : "missed");
  std::printf("\n");
}

nlohmann::json run_case(const physics::Case &one, const physics::Options &options) {
  physics::Run run(options);
  std::printf("%s\n", one.title);
  one.run(run);
  nlohmann::json figures = nlohmann::json::array();
  for (const physics::Figure &figure : run.figures()) {
    print_figure(figure);
    figures.push_back(json_of(figure));
  }
  std::fflush(stdout);
  return {{"case", one.name},
          {"title", one.title},
          {"particles", run.particles()},
          {"figures", figures}};
}

const physics::Case &case_of(const std::string &name) {
  std::string names;
  for (const physics::Case &one : physics::cases) {
    if (name == one.name) return one;
    names += (names.empty() ? "" : ", ") + std::string(one.name);
  }
  throw Error(exit_usage, "there is no case \"" + name + "\"; there are " + names);
}

std::string build_of(const physics::Options &options) {
  for (const pbf_backend_info &backend : list_backends(options.solver, nullptr))
    if (options.solver.backend == backend.name) return backend.build_id;
  return "";
}

int validate(const ValidateOptions &options) {
  std::vector<const physics::Case *> chosen;
  for (const std::string &name : options.cases) chosen.push_back(&case_of(name));
  if (chosen.empty())
    for (const physics::Case &one : physics::cases) chosen.push_back(&one);
  nlohmann::json all = nlohmann::json::array();
  for (const physics::Case *one : chosen) all.push_back(run_case(*one, options.physics));
  if (options.json.empty()) return exit_ok;
  const nlohmann::json report = {{"tool", "pbf-bench validate"},
                                 {"format", 1},
                                 {"backend", options.physics.solver.backend},
                                 {"build", build_of(options.physics)},
                                 {"cases", all}};
  write_file(options.json, report.dump(1) + "\n");
  return exit_ok;
}

}  // namespace

std::pair<CLI::App *, Command> add_validate(CLI::App &app) {
  auto options = std::make_shared<ValidateOptions>();
  physics::Options &physics = options->physics;
  CLI::App *command = app.add_subcommand(
      "validate", "What the fluid does, against closed forms; bench/validate runs this and more");
  command->add_option("--case", options->cases, "these only (all when not given)")
      ->type_name("NAME,…")
      ->delimiter(',');
  command->add_option("--backend", physics.solver.backend, "which backend: this one or none")
      ->type_name("B")
      ->capture_default_str();
  command->add_option("--threads", physics.solver.threads, "CPU threads (0: all)")
      ->type_name("N")
      ->capture_default_str();
  add_precision_option(*command, physics.solver.precision);
  add_device_option(*command, physics.solver.device);
  command->add_option("--finer", physics.finer, "so many times as fine, where the scene may be")
      ->type_name("F")
      ->check(times_as_fine());
  command
      ->add_option("--set", physics.settings, "in place of the scenes' parameter, for experiments")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command->add_flag("--quick", physics.quick, "fewer starts, shorter: a minute for all");
  command->add_option("--json", options->json, "the figures into this file")->type_name("F");
  return {command, [options] { return validate(*options); }};
}

}  // namespace bench
