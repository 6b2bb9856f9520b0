/* pbf-bench stability: stiff and extreme cases on every backend, judged from their dumps. */
#include <algorithm>
#include <cstdio>

#include "commands/commands.h"
#include "commands/options.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/output_file.h"
#include "core/scratch.h"
#include "stability/suite.h"
#include "stability/trial.h"

namespace bench {
namespace {

using namespace stability;

struct StabilityOptions {
  SuiteOptions suite;
  std::string json, html;
  std::vector<int> known;
  bool alone = false, only_dump = false, only_judge = false;
};

// A case that is known to fail still shows as failed.
int exit_code_of(const Judgement &judgement, const std::vector<int> &known) {
  if (interrupted()) return exit_interrupted;
  const auto any = [&](const char *outcome) {
    return std::any_of(judgement.verdicts.begin(), judgement.verdicts.end(),
                       [&](const Verdict &v) { return v.outcome == outcome; });
  };
  const auto surprises = [&](const Verdict &v) {
    return v.outcome == "fails" && std::find(known.begin(), known.end(), v.number) == known.end();
  };
  if (std::any_of(judgement.verdicts.begin(), judgement.verdicts.end(), surprises)) {
    return exit_failure;
  }
  if (any("fails")) return exit_ok;
  return any("holds") || any("absent") ? exit_ok : exit_unavailable;
}

int judge_and_show(const StabilityOptions &options) {
  const Judgement judgement = judge(options.suite);
  std::printf("%s", verdict_table(judgement).c_str());
  std::fflush(stdout);
  if (!options.json.empty()) write_file(options.json, judgement.text);
  if (!options.html.empty()) write_verdict_page(judgement, options.html);
  return exit_code_of(judgement, options.known);
}

int run(StabilityOptions options) {
  std::unique_ptr<Scratch> scratch;
  if (options.suite.dump.empty()) {
    scratch = std::make_unique<Scratch>("stability");
    options.suite.dump = scratch->path();
  }
  set_default_params(options.suite.settings);
  if (options.alone) {
    run_alone(options.suite);
    return exit_ok;
  }
  catch_interrupts();
  if (!options.only_judge) run_all(options.suite);
  return options.only_dump ? exit_ok : judge_and_show(options);
}

}  // namespace

std::pair<CLI::App *, Command> add_stability(CLI::App &app) {
  auto options = std::make_shared<StabilityOptions>();
  SuiteOptions &suite = options->suite;
  CLI::App *command =
      app.add_subcommand("stability", "Stiff and extreme cases, each judged from its dumps");
  command->add_option("--backend", suite.backends, "these only (all when not given)")
      ->type_name("B,…")
      ->delimiter(',');
  command->add_option("--case", suite.cases, "these only, by number (all when not given)")
      ->type_name("N,…")
      ->delimiter(',');
  command->add_flag("--quick", suite.quick, "fewer particles and steps: seconds a backend");
  command
      ->add_option("--known", options->known,
                   "cases whose failure is known: it shows, and does not change the exit code")
      ->type_name("N,…")
      ->delimiter(',');
  command
      ->add_option("--set", suite.settings,
                   "in place of the library's default, as --set damping_compensation=1; again and "
                   "again. What a "
                   "case sets itself stays")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  add_precision_option(*command, suite.solver.precision);
  add_device_option(*command, suite.solver.device);
  auto *dump = command
                   ->add_option("--dump", suite.dump,
                                "keep dumps and facts in this folder, for pbf-check stability")
                   ->type_name("DIR");
  command->add_flag("--only-dump", options->only_dump, "… and judge them another time")
      ->needs(dump);
  command->add_flag("--only-judge", options->only_judge, "judge what is in --dump")->needs(dump);
  command->add_flag("--alone", options->alone)->needs(dump)->group("");
  command->add_option("--json", options->json, "the judge's report into this file")->type_name("F");
  command
      ->add_option("--html", options->html, "the table and pictures into this file, a single page")
      ->type_name("F");
  return {command, [options] { return run(*options); }};
}

}  // namespace bench
