#include "speedup/measure.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/progress.h"
#include "core/stepper.h"

namespace bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// One contestant with its solver, at the state in which every repetition starts.
class Bout {
 public:
  Bout(const Scene &scene, Result &result, bool keep_frames)
      : scene_(scene),
        result_(result),
        keep_frames_(keep_frames),
        solver_(scene, result.contestant.solver) {
    result_.info = solver_.info();
  }

  // One timed repetition; seconds.
  double run() {
    if (start_.empty()) prepare();
    solver_.load(start_);
    const auto begin = Clock::now();
    stepper_.run(solver_, scene_.steps);
    const double seconds = seconds_since(begin);
    result_.stats = solver_.stats();
    if (keep_frames_) {
      result_.positions = solver_.positions();
      result_.velocities = solver_.velocities();
    }
    return seconds;
  }

 private:
  // The lead-in, then the warm-up: a step to learn the pace, and a whole untimed run unless that
  // takes long (a slow contestant has no clock or cache left to warm after a step of seconds).
  void prepare() {
    stepper_.run(solver_, scene_.lead_in_steps);
    start_ = solver_.save();
    stepper_.run(solver_, 1);
    const auto begin = Clock::now();
    stepper_.run(solver_, 1);
    const double pace = std::max(seconds_since(begin), 1e-7);
    stepper_.learn(pace);
    constexpr double longest_warm_up = 5;
    const double steps = std::min<double>(scene_.steps, longest_warm_up / pace);
    if (result_.contestant.repetitions > 1) stepper_.run(solver_, static_cast<uint32_t>(steps));
  }

  const Scene &scene_;
  Result &result_;
  bool keep_frames_;
  Solver solver_;
  Bytes start_;
  Stepper stepper_;
};

// Gathers what Google Benchmark measured into the results.
class Collector : public benchmark::BenchmarkReporter {
 public:
  explicit Collector(std::vector<Result> &results) {
    for (Result &result : results) by_name_[result.row_name] = &result;
  }

  bool ReportContext(const Context &) override { return true; }

  void ReportRuns(const std::vector<Run> &runs) override {
    for (const Run &run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      Result &result = *by_name_.at(run.run_name.function_name);
      if (run.error_occurred) {
        result.reason = run.error_message;
      } else {
        result.milliseconds.push_back(1e3 * run.real_accumulated_time);
      }
    }
  }

 private:
  std::map<std::string, Result *> by_name_;
};

void initialize_google_benchmark() {
  static char program[] = "pbf-bench";  // Google Benchmark keeps the pointer for its JSON
  char interleave[] = "--benchmark_enable_random_interleaving=true";
  static char *arguments[] = {program, interleave, nullptr};
  int count = 2;
  benchmark::Initialize(&count, arguments);
}

class Meet {
 public:
  Meet(const Scene &scene, std::vector<Result> &results, bool keep_frames)
      : scene_(scene), results_(results), keep_frames_(keep_frames) {}

  void run() {
    initialize_google_benchmark();
    for (Result &result : results_) enter(result);
    Collector collector(results_);
    if (!bouts_.empty()) benchmark::RunSpecifiedBenchmarks(&collector);
    benchmark::ClearRegisteredBenchmarks();
  }

 private:
  void enter(Result &result) {
    result.reason = reason_against(result.contestant.solver, scene_);
    result.unavailable = !result.reason.empty();
    if (result.unavailable) return;
    try {
      bouts_.push_back(std::make_unique<Bout>(scene_, result, keep_frames_));
    } catch (const Error &error) {
      if (error.code == exit_usage) throw;
      result.reason = error.what();
      result.unavailable = error.code == exit_unavailable;
      return;
    }
    repetitions_ += result.contestant.repetitions;
    benchmark::RegisterBenchmark(result.row_name.c_str(),
                                 [this, &bout = *bouts_.back(), &result](benchmark::State &state) {
                                   for (auto _ : state) time_once(state, bout, result);
                                 })
        ->Iterations(1)
        ->Repetitions(static_cast<int>(result.contestant.repetitions))
        ->Unit(benchmark::kMillisecond)
        ->UseManualTime();
  }

  void time_once(benchmark::State &state, Bout &bout, Result &result) {
    progress_.show(static_cast<double>(done_) / repetitions_,
                   result.contestant.name + ", repetition " + std::to_string(done_ + 1) + " of " +
                       std::to_string(repetitions_));
    try {
      if (!interrupted()) state.SetIterationTime(bout.run());
      if (interrupted()) state.SkipWithError("interrupted");
    } catch (const Error &error) {
      state.SkipWithError(error.what());
    }
    ++done_;
  }

  const Scene &scene_;
  std::vector<Result> &results_;
  bool keep_frames_;
  std::vector<std::unique_ptr<Bout>> bouts_;
  Progress progress_;
  unsigned done_ = 0;
  unsigned repetitions_ = 0;
};

}  // namespace

std::vector<Result> measure(const Scene &scene, const std::vector<Contestant> &contestants,
                            bool keep_frames) {
  std::vector<Result> results;
  for (const Contestant &contestant : contestants) {
    Result result;
    result.contestant = contestant;
    result.row_name =
        scene.name + "/" + contestant.name + "/threads:" + std::to_string(contestant.threads);
    results.push_back(result);
  }
  Meet(scene, results, keep_frames).run();
  return results;
}

}  // namespace bench
