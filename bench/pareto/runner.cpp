#include "pareto/runner.h"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <numeric>
#include <random>

#include "core/dump.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/machine.h"
#include "core/progress.h"
#include "core/stepper.h"

namespace bench {
namespace {

using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string hash_text(const Solver &solver) {
  char text[24];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(solver.hash()));
  return text;
}

class Runner {
 public:
  Runner(Study &study, const Judge &judge, const RunnerOptions &options)
      : study_(study), judge_(judge), options_(options) {
    for (const Point &point : study.plan.points) {
      total_ += point.work * (judging_weight + study.repetitions);
    }
  }

  void run() {
    for (Point &point : study_.plan.points) {
      if (interrupted()) return;
      if (!point.outcome.judged()) find_errors(point);
      done_ += point.work * judging_weight;
    }
    for (unsigned round = 0; round < study_.repetitions; ++round) time_all(round);
  }

 private:
  // A point's run for its errors, its dumps and pbf-check cost about as much as three runs.
  static constexpr double judging_weight = 3;

  // ---- Errors ----

  void find_errors(Point &point) {
    progress_.show(done_ / total_, "errors of " + name_of(point));
    const size_t index = static_cast<size_t>(&point - study_.plan.points.data());
    const std::string folder =
        (options_.dumps.empty() ? options_.scratch : options_.dumps) + "/" + std::to_string(index);
    Outcome outcome;
    outcome.commit = this_machine().commit;
    try {
      outcome.state = run_with_dumps(point, folder, outcome);
    } catch (const Error &error) {
      if (error.code == exit_unavailable) throw;
      outcome.reason = error.what();
    }
    if (outcome.reason.empty() && !interrupted()) judge_.judge(folder, outcome);
    std::error_code ignored;
    if (options_.dumps.empty()) fs::remove_all(folder, ignored);
    if (interrupted()) return;  // it may have been cut short
    if (!outcome.reason.empty()) outcome.state.clear();
    point.outcome = outcome;
    save();
  }

  std::string run_with_dumps(const Point &point, const std::string &folder, Outcome &outcome) {
    Solver solver(point.scene, point.solver);
    Dump dump(folder, point.every, point.scene, solver.info());
    dump.write(solver);
    const auto begin = Clock::now();
    uint64_t done = 0;
    uint64_t batch = 1;
    while (done < point.scene.steps && !interrupted()) {
      const auto start = Clock::now();
      const uint64_t now = std::min({point.scene.steps - done, batch, dump.steps_to_next(done)});
      solver.step(static_cast<uint32_t>(now));
      solver.synchronize();
      batch = seconds_since(start) < 0.1 ? 2 * batch : std::max<uint64_t>(batch / 2, 1);
      done += now;
      if (dump.due(done)) dump.write(solver);
      if (seconds_since(begin) > options_.patience) {
        outcome.reason = "given up after " + std::to_string(static_cast<int>(options_.patience)) +
                         " s, at step " + std::to_string(done) + " of " +
                         std::to_string(point.scene.steps);
        return "";
      }
    }
    dump.write(solver);
    return hash_text(solver);
  }

  // ---- Times ----

  // One run of every point that has none for this round, in an order of the round's own: a machine
  // that slows down hits all alike.
  void time_all(unsigned round) {
    std::vector<size_t> order(study_.plan.points.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::shuffle(order.begin(), order.end(), std::mt19937(round + 1));
    for (const size_t index : order) {
      if (interrupted()) return;
      Point &point = study_.plan.points[index];
      done_ += point.work;
      if (!point.outcome.reason.empty() || !point.outcome.judged()) continue;
      if (point.outcome.seconds.size() > round) continue;
      progress_.show((done_ - point.work) / total_, "round " + std::to_string(round + 1) + " of " +
                                                        std::to_string(study_.repetitions) + ", " +
                                                        name_of(point));
      time_once(point);
    }
  }

  void time_once(Point &point) {
    Solver solver(point.scene, point.solver);
    const Bytes start = solver.save();
    const Stepper stepper = warm_up(solver, point.scene.steps);
    solver.load(start);
    const double begin = now();
    stepper.run(solver, point.scene.steps);
    const double seconds = now() - begin;
    if (interrupted()) return;
    if (hash_text(solver) != point.outcome.state) {
      throw Error(exit_failure, name_of(point) +
                                    ": a timed run ended in another state than the judged one, "
                                    "so its time is not that of its errors");
    }
    point.outcome.seconds.push_back(seconds);
    save();
  }

  double now() const {
    timespec time;
    clock_gettime(study_.cpu_time ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  // A tenth of a second, so that memory is touched and clocks are up.
  static Stepper warm_up(Solver &solver, uint32_t steps) {
    Stepper stepper;
    stepper.run(solver, 1);
    const auto begin = Clock::now();
    stepper.run(solver, 1);
    const double pace = std::max(seconds_since(begin), 1e-7);
    stepper.learn(pace);
    stepper.run(solver, static_cast<uint64_t>(std::min<double>(steps, 0.1 / pace)));
    return stepper;
  }

  std::string name_of(const Point &point) const {
    return study_.sweep.families[point.family].name + ": " + point.label;
  }

  void save() const {
    if (!options_.json.empty()) write_results(study_, options_.json);
  }

  Study &study_;
  const Judge &judge_;
  const RunnerOptions &options_;
  Progress progress_;
  double total_ = 0, done_ = 0;
};

}  // namespace

void run_study(Study &study, const Judge &judge, const RunnerOptions &options) {
  Runner(study, judge, options).run();
}

}  // namespace bench
