/* Writes results with Google Benchmark's own reporter, so that its tools read them. */
#include <benchmark/benchmark.h>

#include <set>
#include <sstream>

#include "core/machine.h"
#include "core/output_file.h"
#include "speedup/speedup.h"

namespace bench {
namespace {

using Reporter = benchmark::BenchmarkReporter;

void add_context(const Speedup &speedup) {
  const Machine machine = this_machine();
  benchmark::AddCustomContext("commit", machine.commit);
  benchmark::AddCustomContext("cpu_model", machine.cpu);
  benchmark::AddCustomContext("system", machine.system);
  benchmark::AddCustomContext("compiler", machine.compiler);
  benchmark::AddCustomContext("scene", speedup.scene.name);
  benchmark::AddCustomContext("particles", std::to_string(count_particles(speedup.scene)));
  benchmark::AddCustomContext("steps", std::to_string(speedup.scene.steps));
  std::set<std::string> told;
  for (const Result &result : speedup.results) {
    const std::string &name = result.contestant.name;
    if (!result.ran() || !told.insert(name).second) continue;
    benchmark::AddCustomContext("device_" + name, result.info.device_name);
    benchmark::AddCustomContext("build_" + name, result.info.build_id);
  }
}

Reporter::Run entry_of(const Speedup &speedup, const Result &result) {
  Reporter::Run run;
  run.run_name.function_name = result.row_name;
  run.family_index = &result - speedup.results.data();
  run.per_family_instance_index = 0;
  run.threads = result.contestant.threads;
  run.repetition_index = 0;
  run.repetitions = static_cast<int64_t>(result.milliseconds.size());
  run.time_unit = benchmark::kMillisecond;
  run.statistics = nullptr;
  if (!result.ran()) {
    run.error_occurred = true;
    run.error_message = result.reason;
    return run;
  }
  run.real_accumulated_time = run.cpu_accumulated_time = 1e-3 * median_ms(result);
  run.report_label = result.info.device_name;
  run.counters["ms_per_step"] = ms_per_step(speedup, result);
  run.counters["particle_iterations_per_second"] = particle_iterations_per_second(speedup, result);
  if (const auto factor = speedup_vs_naive(speedup, result)) {
    run.counters["speedup_vs_naive"] = *factor;
  }
  run.counters["density_error_mean"] = result.stats.density_error_mean;
  run.counters["density_error_max"] = result.stats.density_error_max;
  run.counters["ms_min"] = min_ms(result);
  run.counters["ms_max"] = max_ms(result);
  return run;
}

}  // namespace

void write_speedup_json(const Speedup &speedup, const std::string &path) {
  std::ostringstream text;
  add_context(speedup);
  benchmark::JSONReporter reporter;
  reporter.SetOutputStream(&text);
  reporter.ReportContext(Reporter::Context());
  std::vector<Reporter::Run> runs;
  for (const Result &result : speedup.results) runs.push_back(entry_of(speedup, result));
  reporter.ReportRuns(runs);
  reporter.Finalize();
  write_file(path, text.str());
}

}  // namespace bench
