/* Times the variants of an ablation: each in a process of its own, by turns. */
#include <algorithm>
#include <memory>

#include "ablation/ablation.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/progress.h"

namespace bench {
namespace {

struct Entry {
  std::unique_ptr<Worker> worker;
  AblationRow row;
};

// A row that can't run says why; the first must.
Entry enter(const std::string &name, const Job &job, const Start &start, bool must_run) {
  Entry entry;
  entry.row.name = name;
  try {
    entry.worker = std::make_unique<Worker>(job, start);
  } catch (const Error &error) {
    if (must_run || error.code == exit_failure) throw;
    entry.row.reason = error.what();
  }
  return entry;
}

void run_round(std::vector<Entry> &entries, unsigned round, double steps) {
  std::vector<size_t> order;
  for (size_t i = 0; i < entries.size(); ++i) order.push_back(i);
  if (round % 2 == 1) std::reverse(order.begin(), order.end());
  for (const size_t i : order) {
    Entry &entry = entries[i];
    if (entry.worker) entry.row.ms_per_step.push_back(1e3 * entry.worker->run() / steps);
  }
  for (Entry &entry : entries) {
    if (!entry.worker) continue;
    entry.row.ratios.push_back(entry.row.ms_per_step.back() / entries[0].row.ms_per_step.back());
  }
}

std::vector<AblationRow> measure_rows(std::vector<Entry> &entries, unsigned rounds, double steps,
                                      const char *label) {
  Progress progress;
  for (Entry &entry : entries)
    if (entry.worker) entry.worker->run();  // warm
  for (unsigned round = 0; round < rounds && !interrupted(); ++round) {
    progress.show(static_cast<double>(round) / rounds, std::string(label) + ", round " +
                                                           std::to_string(round + 1) + " of " +
                                                           std::to_string(rounds));
    run_round(entries, round, steps);
  }
  std::vector<AblationRow> rows;
  for (Entry &entry : entries) {
    if (entry.worker) entry.row.facts = entry.worker->facts();
    rows.push_back(entry.row);
  }
  return rows;
}

std::vector<Entry> enter_builds(const Ablation &ablation, const Start &start,
                                const std::vector<LibraryBuild> &builds) {
  std::vector<Entry> entries;
  const Job here{minimal(ablation.scene), ablation.solver, "", ablation.cpu_time};
  entries.push_back(enter("this build", here, start, true));
  entries.push_back(enter("this build again", here, start, true));
  for (const LibraryBuild &build : builds) {
    const Job there{minimal(ablation.scene), ablation.solver, build.folder, ablation.cpu_time};
    entries.push_back(enter(build.name, there, start, false));
  }
  return entries;
}

}  // namespace

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

Ablation ablate(const Scene &scene, const AblationOptions &options) {
  Ablation ablation{scene, options.solver, options.cpu_time, {}, {}};
  const Start start = run_up(scene, options.solver, options.run_up);
  if (options.against.empty()) {
    std::vector<Entry> entries;
    const Variant bare = minimal(scene);
    entries.push_back(enter(bare.name, {bare, options.solver, "", options.cpu_time}, start, true));
    for (const Variant &variant : one_at_a_time(scene))
      entries.push_back(
          enter(variant.name, {variant, options.solver, "", options.cpu_time}, start, false));
    ablation.variants = measure_rows(entries, options.rounds, scene.steps, "features");
  } else {
    std::vector<Entry> entries = enter_builds(ablation, start, options.against);
    ablation.builds = measure_rows(entries, options.rounds, scene.steps, "builds");
  }
  return ablation;
}

}  // namespace bench
