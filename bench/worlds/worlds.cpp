#include "worlds/worlds.h"

#include <pbf/batch.h>

#include <chrono>
#include <functional>
#include <memory>

#include "ablation/ablation.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/progress.h"

namespace bench {

SolverOptions solver_options(const std::string &backend, const WorldsOptions &options) {
  SolverOptions own;
  own.backend = backend;
  own.precision = options.precision;
  own.threads = options.threads;
  own.device = options.device;
  return own;
}

namespace {

using WorldsClock = std::chrono::steady_clock;

// A way to step all worlds, at the state in which each repetition starts.
class Way {
 public:
  virtual ~Way() = default;
  virtual void reset() = 0;
  virtual void step(uint32_t steps) = 0;  // and waits for a device
  virtual void describe(WorldsRow &row) const = 0;
};

class InBatch : public Way {
 public:
  InBatch(const Scene &scene, const SolverOptions &options, uint32_t worlds) {
    const pbf_desc desc = desc_of(options, &scene);
    const Bytes start = Solver(scene, options).save();
    pbf_batch *batch = nullptr;
    check_call(pbf_batch_create(&desc, &scene.params, worlds, &batch));
    batch_.reset(batch);
    check_call(pbf_batch_set_start(batch, nullptr, start.data(), start.size()));
    for (uint32_t k = 0; k < worlds; ++k) {
      pbf_solver *world = nullptr;
      check_call(pbf_batch_get_world(batch, k, &world));
      worlds_.push_back(world);
    }
  }

  void reset() override { check_call(pbf_batch_reset(batch_.get(), nullptr)); }

  void step(uint32_t steps) override {
    check_call(pbf_batch_step(batch_.get(), nullptr, steps));
    for (pbf_solver *world : worlds_) check_call(pbf_synchronize(world));
  }

  void describe(WorldsRow &row) const override {
    pbf_batch_info info{};
    info.struct_size = sizeof info;
    check_call(pbf_batch_get_info(batch_.get(), &info));
    row.threads = info.threads;
  }

 private:
  struct Destroy {
    void operator()(pbf_batch *batch) const { pbf_batch_destroy(batch); }
  };
  std::unique_ptr<pbf_batch, Destroy> batch_;
  std::vector<pbf_solver *> worlds_;
};

class OneByOne : public Way {
 public:
  OneByOne(const Scene &scene, const SolverOptions &options, uint32_t worlds) {
    for (uint32_t k = 0; k < worlds; ++k) solvers_.emplace_back(scene, options);
    start_ = solvers_.front().save();
  }

  void reset() override {
    for (Solver &solver : solvers_) solver.load(start_);
  }

  void step(uint32_t steps) override {
    for (Solver &solver : solvers_) solver.step(steps);
    for (Solver &solver : solvers_) solver.synchronize();
  }

  void describe(WorldsRow &row) const override {
    const pbf_info info = solvers_.front().info();
    row.device = info.device_name;
    row.threads = info.threads;
  }

 private:
  std::vector<Solver> solvers_;
  Bytes start_;
};

struct Entry {
  size_t row;
  std::unique_ptr<Way> way;
};

double run_once(Way &way, uint32_t steps) {
  way.reset();
  way.step(1);  // what a first step does beside
  const auto begin = WorldsClock::now();
  way.step(steps);
  return 1e3 * std::chrono::duration<double>(WorldsClock::now() - begin).count() / steps;
}

class Contest {
 public:
  Contest(const Scene &small, const Scene &large, const WorldsOptions &options)
      : small_(small), large_(large), options_(options) {}

  std::vector<WorldsRow> run() {
    for (const std::string &backend : options_.backends) {
      enter(backend);
      for (uint32_t k = 0; k < options_.repetitions && !interrupted(); ++k) round();
      entries_.clear();
    }
    return rows_;
  }

 private:
  void enter(const std::string &backend) {
    const SolverOptions options = solver_options(backend, options_);
    const Scene &small = small_, &large = large_;
    const uint32_t worlds = options_.worlds;
    add(backend, "batch", small, worlds,
        [&] { return std::make_unique<InBatch>(small, options, worlds); });
    add(backend, "one after another", small, worlds,
        [&] { return std::make_unique<OneByOne>(small, options, worlds); });
    add(backend, "one world", large, 1,
        [&] { return std::make_unique<OneByOne>(large, options, 1); });
  }

  void add(const std::string &backend, const char *way, const Scene &scene, uint32_t worlds,
           const std::function<std::unique_ptr<Way>()> &make) {
    WorldsRow row;
    row.backend = backend;
    row.way = way;
    row.worlds = worlds;
    row.particles = count_particles(scene);
    rows_.push_back(row);
    try {
      entries_.push_back({rows_.size() - 1, make()});
      entries_.back().way->describe(rows_.back());
    } catch (const Error &error) {
      if (error.code == exit_usage) throw;
      rows_.back().reason = error.what();
    }
  }

  void round() {
    for (Entry &entry : entries_) {
      WorldsRow &row = rows_[entry.row];
      if (interrupted()) return;
      progress_.show(static_cast<double>(row.milliseconds.size()) / options_.repetitions,
                     row.backend + ", " + row.way);
      row.milliseconds.push_back(run_once(*entry.way, small_.steps));
    }
  }

  const Scene &small_, &large_;
  const WorldsOptions &options_;
  std::vector<WorldsRow> rows_;
  std::vector<Entry> entries_;
  Progress progress_;
};

}  // namespace

double WorldsRow::particle_steps_per_second() const {
  if (milliseconds.empty()) return 0;
  const double ms = median_of(milliseconds);
  return ms > 0 ? 1e3 * worlds * static_cast<double>(particles) / ms : 0;
}

std::vector<WorldsRow> measure_worlds(const Scene &small, const Scene &large,
                                      const WorldsOptions &options) {
  return Contest(small, large, options).run();
}

}  // namespace bench
