#include "stability/suite.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/process.h"
#include "core/progress.h"

namespace bench::stability {
namespace {

std::vector<Case> chosen(const std::vector<int> &numbers) {
  if (numbers.empty()) return all_cases();
  std::vector<Case> cases;
  for (const int number : numbers) {
    const auto found = std::find_if(all_cases().begin(), all_cases().end(),
                                    [&](const Case &c) { return c.number == number; });
    if (found == all_cases().end()) {
      throw Error(exit_usage, "--case " + std::to_string(number) + ": the cases are 1 … " +
                                  std::to_string(all_cases().back().number));
    }
    cases.push_back(*found);
  }
  return cases;
}

std::string folder_for(const SuiteOptions &options, const Case &entry, const std::string &backend) {
  return options.dump + "/" + folder_of(entry) + "/" + backend;
}

// Facts of a case that could not tell them itself.
void write_facts(const SuiteOptions &options, const Case &entry, const std::string &backend,
                 const std::string &key, const std::string &sentence) {
  SolverOptions solver = options.solver;
  solver.backend = backend;
  Record record(folder_for(options, entry, backend), solver, options.quick);
  record.note(key, sentence);
  record.finish();
}

void run_elsewhere(const SuiteOptions &options, const Case &entry, const std::string &backend) {
  // Not by its path: a rebuilt program has another one.
  std::vector<std::string> words = {"/proc/self/exe",
                                    "stability",
                                    "--alone",
                                    "--backend",
                                    backend,
                                    "--case",
                                    std::to_string(entry.number),
                                    "--dump",
                                    options.dump,
                                    "--device",
                                    std::to_string(options.solver.device)};
  if (options.quick) words.emplace_back("--quick");
  for (const std::string &setting : options.settings) {
    words.emplace_back("--set");
    words.push_back(setting);
  }
  if (options.solver.precision == PBF_FLOAT64) {
    words.emplace_back("--precision");
    words.emplace_back("f64");
  }
  const Ended ended = run_program(words);
  if (!ended.reason.empty()) throw Error(exit_failure, ended.reason);
  if (ended.signal == SIGALRM) {
    write_facts(options, entry, backend, "failed",
                "no end within " + std::to_string(entry.limit) + " s");
  } else if (ended.signal != 0 || ended.code != 0) {
    write_facts(options, entry, backend, "failed",
                ended.signal != 0 ? "crashed with signal " + std::to_string(ended.signal)
                                  : "ended with exit code " + std::to_string(ended.code));
  }
}

std::string reason_against_backend(const SuiteOptions &options, const std::string &name) {
  SolverOptions solver = options.solver;
  solver.backend = name;
  for (const pbf_backend_info &info : list_backends(solver, nullptr)) {
    if (name == info.name) return info.available ? "" : info.reason;
  }
  return "there is no backend of this name in this build";
}

}  // namespace

void run_alone(const SuiteOptions &options) {
  const Case entry = chosen(options.cases).front();
  SolverOptions solver = options.solver;
  solver.backend = options.backends.front();
  Record record(folder_for(options, entry, solver.backend), solver, options.quick);
  if (!options.settings.empty()) record.note("settings", options.settings);
  alarm(entry.limit);
  try {
    entry.run(record);
  } catch (const std::exception &error) {
    record.note("failed", sentence_of(error));
  }
  record.finish();
}

void run_all(const SuiteOptions &options) {
  std::vector<std::string> backends = options.backends;
  if (backends.empty()) backends = {"reference", "serial", "openmp", "cuda"};
  const std::vector<Case> cases = chosen(options.cases);
  const double total = static_cast<double>(cases.size() * backends.size());
  Progress progress;
  size_t done = 0;
  for (const std::string &backend : backends) {
    const std::string reason = reason_against_backend(options, backend);
    for (const Case &entry : cases) {
      if (interrupted()) return;
      progress.show(static_cast<double>(done++) / total, backend + ", " + folder_of(entry));
      if (reason.empty()) {
        run_elsewhere(options, entry, backend);
      } else {
        write_facts(options, entry, backend, "unavailable", reason);
      }
    }
  }
}

}  // namespace bench::stability
