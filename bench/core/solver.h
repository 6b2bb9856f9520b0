/* A pbf_solver that holds a scene: calls that fail throw Error with the library's sentence. */
#ifndef PBF_BENCH_SOLVER_H
#define PBF_BENCH_SOLVER_H

#include <pbf/pbf.h>

#include <memory>
#include <string>
#include <vector>

#include "core/scalars.h"
#include "scene/scene.h"

namespace bench {

struct SolverOptions {
  std::string backend = "serial";
  uint32_t precision = PBF_FLOAT32;
  uint32_t threads = 0;
  int32_t device = 0;
  bool is_per_machine = false;  // pbf_desc.determinism
};

// Throws Error with the library's sentence.
void check_call(pbf_status status);

// The same, with the place in the scene's file of what the sentence names: `key` and, if the
// sentence names one, which of its list.
void check_scene_call(const Scene &scene, const char *key, pbf_status status);

// Strict, with room for the scene's particles, or without a scene for as many as by default.
// `options` must outlive it.
pbf_desc desc_of(const SolverOptions &options, const Scene *scene);

class Solver {
 public:
  // Always strict: a row of results is never of another backend than it says.
  Solver(const Scene &scene, const SolverOptions &options);

  // Steps, and at the ends of stretches sets the colliders' new velocities. Returns before a
  // device has finished.
  void step(uint32_t steps);
  void synchronize();

  pbf_info info() const;
  pbf_stats stats() const;
  pbf_timings timings() const;
  pbf_plan plan() const;
  void set_timing(bool enabled);
  // One row a particle, in the order of adding.
  Bytes positions() const { return read(pbf_get_positions); }
  Bytes velocities() const { return read(pbf_get_velocities); }
  // One number a particle; the backend may keep none.
  bool has_pressures() const;
  Bytes pressures() const;
  void place(const Bytes &positions, const Bytes &velocities);  // of all particles
  uint64_t hash() const;
  Bytes save() const;
  void load(const Bytes &state);

  pbf_solver *handle() const { return solver_.get(); }
  uint32_t count() const;
  pbf_collider collider(uint32_t index) const;  // in its present pose

 private:
  using Getter = pbf_status (*)(pbf_solver *, uint32_t, uint32_t, void *);

  Bytes read(Getter getter) const;
  void add(const Scene &scene);
  void set_objects(const Scene &scene);
  void set_colliders(const std::vector<pbf_collider> &colliders);
  uint32_t steps_to_next_turn() const;
  void turn_colliders();

  struct Destroy {
    void operator()(pbf_solver *solver) const { pbf_destroy(solver); }
  };
  std::unique_ptr<pbf_solver, Destroy> solver_;
  std::vector<Collider> colliders_;
  std::vector<SceneShape> shapes_;  // which loaded states find by their hashes
  unsigned dimension_;
  uint32_t precision_;
  double time_step_;
  uint64_t step_ = 0;
};

// Entries of the library's list, judged for a solver like `options` for `scene` (or null).
std::vector<pbf_backend_info> list_backends(const SolverOptions &options, const Scene *scene);

// Why `options.backend` can't serve for `scene`; empty when it can.
std::string reason_against(const SolverOptions &options, const Scene &scene);

void load_plugin(const std::string &path);

}  // namespace bench

#endif
