/* pbf-bench record and replay: a run in one file, and whether another one is the same. */
#include <algorithm>
#include <cinttypes>
#include <cstring>
#include <memory>

#include "commands/commands.h"
#include "commands/options.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/solver.h"
#include "core/surroundings.h"
#include "record/recording.h"

namespace bench {
namespace {

void must(pbf_status status) {
  if (status != PBF_OK) throw Error(exit_failure, pbf_last_error());
}

// ---- record ----

struct RecordOptions {
  SceneOptions scene;
  SolverOptions solver;
  std::vector<std::string> changes;
  std::string to;
  uint64_t every = 1;
};

struct Change {
  uint64_t step;
  std::string setting;
};

Change change_of(const std::string &text) {
  const size_t colon = text.find(':');
  const bool number = colon != std::string::npos && colon > 0 && colon < 10 &&
                      text.find_first_not_of("0123456789") == colon;
  if (!number) throw Error(exit_usage, "--at " + text + ": wanted is STEP:KEY=VALUE");
  return {std::stoull(text.substr(0, colon)), text.substr(colon + 1)};
}

void sort_by_step(std::vector<Change> &changes) {
  std::stable_sort(changes.begin(), changes.end(),
                   [](const Change &a, const Change &b) { return a.step < b.step; });
}

// The parameters that the scene has with all settings so far, at once.
void apply_change(const Change &change, RecordOptions &options, Solver &solver,
                  RecordWriter &writer) {
  options.scene.settings.push_back(change.setting);
  const Scene scene = load_scene(options.scene);
  if (pbf_set_params(solver.handle(), &scene.params) != PBF_OK)
    throw Error(exit_usage, pbf_last_error());
  writer.params(scene.params);
}

// A stretch of a scene's motion changes velocities, and nothing else does.
bool turned(const std::vector<pbf_collider> &before, const std::vector<pbf_collider> &now) {
  return !std::equal(before.begin(), before.end(), now.begin(), now.end(),
                     [](const pbf_collider &a, const pbf_collider &b) {
                       return std::equal(a.velocity, a.velocity + 3, b.velocity) &&
                              std::equal(a.angular_velocity, a.angular_velocity + 3,
                                         b.angular_velocity);
                     });
}

int record(RecordOptions options) {
  std::vector<Change> changes;
  for (const std::string &text : options.changes) changes.push_back(change_of(text));
  sort_by_step(changes);
  const Scene scene = load_scene(options.scene);
  Solver solver(scene, options.solver);
  RecordWriter writer(options.to, solver.handle(), scene.shapes);
  size_t next = 0;
  std::vector<pbf_collider> colliders = colliders_of(solver.handle());
  const uint64_t steps = uint64_t{scene.lead_in_steps} + scene.steps;
  uint64_t step = 0;
  catch_interrupts();
  while (step < steps && !interrupted()) {
    for (; next < changes.size() && changes[next].step == step; ++next)
      apply_change(changes[next], options, solver, writer);
    solver.step(1);
    ++step;
    if (step % options.every == 0 || step == steps || interrupted()) writer.hash();
    const std::vector<pbf_collider> now = colliders_of(solver.handle());
    if (turned(colliders, now)) writer.colliders(now);
    colliders = now;
  }
  writer.finish();
  std::printf("%s: %" PRIu64 " steps, state %016" PRIx64 "\n", options.to.c_str(), step,
              solver.hash());
  return interrupted() ? exit_interrupted : exit_ok;
}

// ---- replay ----

struct ReplayOptions {
  std::string file, backend;
  uint32_t threads = 0;
};

struct Destroy {
  void operator()(pbf_solver *solver) const { pbf_destroy(solver); }
};
using Handle = std::unique_ptr<pbf_solver, Destroy>;

// A solver with bits of its machine's own says so in the name of its device, where they differ.
bool has_bits_of_machine(const Recording &recording) {
  const std::string end = "-fused)", &name = recording.device;
  return name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
}

Handle solver_for(const Recording &recording, const ReplayOptions &options) {
  pbf_desc desc;
  must(pbf_desc_init(&desc, sizeof desc));
  desc.dimension = recording.dimension;
  desc.precision = recording.precision;
  desc.capacity = recording.capacity;
  const std::string backend = options.backend.empty() ? recording.backend : options.backend;
  desc.backend = backend.c_str();
  desc.threads = options.threads;
  desc.determinism = has_bits_of_machine(recording) ? PBF_DETERMINISM_PER_MACHINE
                                                    : PBF_DETERMINISM_ACROSS_MACHINES;
  desc.strict = 1;
  pbf_solver *solver = nullptr;
  if (pbf_create(&desc, nullptr, &solver) != PBF_OK)
    throw Error(exit_unavailable, pbf_last_error());
  return Handle(solver);
}

pbf_info info_of(const Handle &solver) {
  pbf_info info = {};
  info.struct_size = sizeof info;
  must(pbf_get_info(solver.get(), &info));
  return info;
}

void run_to(const Handle &solver, uint64_t step) {
  const uint64_t now = info_of(solver).step;
  if (step < now || step - now > UINT32_MAX)
    throw Error(exit_usage, "a line is of step " + std::to_string(step) +
                                ", and the one before of " + std::to_string(now));
  if (step > now) must(pbf_step(solver.get(), static_cast<uint32_t>(step - now)));
}

void tell_of_difference(const Recording &recording, const pbf_info &here) {
  if (recording.build != here.build_id)
    std::printf("the builds differ: recorded %s, here %s\n", recording.build.c_str(),
                here.build_id);
  if (recording.device != here.device_name)
    std::printf("the devices differ: recorded %s, here %s\n", recording.device.c_str(),
                here.device_name);
}

void change(const Handle &solver, const Recording &recording, const Recording::Entry &entry) {
  const size_t size = entry.bytes.size();
  if (entry.kind == Recording::Kind::state) {
    must(pbf_load(solver.get(), entry.bytes.data(), size));
  } else if (entry.kind == Recording::Kind::params) {
    pbf_params params = {};
    std::memcpy(&params, entry.bytes.data(), std::min(size, sizeof params));
    must(pbf_set_params(solver.get(), &params));
  } else {
    const std::vector<pbf_collider> colliders = colliders_of_entry(recording, entry);
    const auto count = static_cast<uint32_t>(colliders.size());
    must(entry.kind == Recording::Kind::move
             ? pbf_move_colliders(solver.get(), count, colliders.data(), entry.duration)
             : pbf_set_colliders(solver.get(), count, colliders.data()));
  }
}

int replay(const ReplayOptions &options) {
  const Recording recording = read_recording(options.file);
  const Handle solver = solver_for(recording, options);
  uint64_t same = 0, compared = 0, changes = 0;
  for (const Recording::Entry &entry : recording.entries) {
    if (entry.kind != Recording::Kind::state) run_to(solver, entry.step);
    if (entry.kind != Recording::Kind::hash) {
      change(solver, recording, entry);
      ++changes;
      continue;
    }
    uint64_t hash = 0;
    must(pbf_hash(solver.get(), &hash));
    ++compared;
    if (hash != entry.hash) {
      std::printf("the runs part after step %" PRIu64 ", by step %" PRIu64 ": recorded %016" PRIx64
                  ", here %016" PRIx64 "\n",
                  same, entry.step, entry.hash, hash);
      tell_of_difference(recording, info_of(solver));
      return exit_failure;
    }
    same = entry.step;
  }
  std::printf("the same: %" PRIu64 " hashes, up to step %" PRIu64 ", with %" PRIu64
              " changes on the way\n",
              compared, same, changes - 1);
  return exit_ok;
}

}  // namespace

std::pair<CLI::App *, Command> add_record(CLI::App &app) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App *command = app.add_subcommand(
      "record", "Writes a scene's run into a file, from which it can be run again");
  add_scene_options(*command, options->scene);
  command->get_option("--scene")->required();
  command->add_option("--backend", options->solver.backend, "which backend: this one or none")
      ->type_name("B")
      ->required();
  command->add_option("--threads", options->solver.threads, "CPU threads (0: all)")->type_name("N");
  add_precision_option(*command, options->solver.precision);
  add_device_option(*command, options->solver.device);
  add_determinism_option(*command, options->solver.is_per_machine);
  command
      ->add_option("--at", options->changes,
                   "changes a parameter before that step, as --at 120:gravity.1=3; again and again")
      ->type_name("STEP:KEY=VALUE")
      ->allow_extra_args(false);
  command->add_option("--every", options->every, "steps from one hash to the next")
      ->type_name("K")
      ->check(positive())
      ->capture_default_str();
  command->add_option("--to", options->to, "the file")->type_name("FILE")->required();
  return {command, [options] { return record(*options); }};
}

std::pair<CLI::App *, Command> add_replay(CLI::App &app) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App *command = app.add_subcommand(
      "replay", "Runs a recording again, and says after which step the two runs part");
  command->add_option("file", options->file, "what record, or examples/record.h, wrote")
      ->type_name("FILE")
      ->required();
  command->add_option("--backend", options->backend, "in place of the recorded one")
      ->type_name("B");
  command->add_option("--threads", options->threads, "CPU threads (0: all)")->type_name("N");
  return {command, [options] { return replay(*options); }};
}

}  // namespace bench
