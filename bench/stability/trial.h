/* One solver in one run of a case, its states dumped for the judge. */
#ifndef PBF_BENCH_STABILITY_TRIAL_H
#define PBF_BENCH_STABILITY_TRIAL_H

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "stability/record.h"

namespace bench::stability {

// What cases begin with: the library's defaults, and what these settings, key=value, have in place
// of them. Throws Error for a setting that names no parameter.
void set_default_params(const std::vector<std::string> &settings);
pbf_params default_params();

// A solver's beginning: the library's defaults, but for what a case names.
struct Start {
  unsigned dimension = 3;
  pbf_params params = default_params();
  Particles particles;
  std::vector<pbf_collider> colliders;
  uint32_t capacity = 0;  // 0: as many as there are particles
  uint32_t threads = 0;
};

class Trial {
 public:
  // Makes the solver and dumps its first state into the folder `label` of the case. Calls that
  // fail throw Error with the library's sentence; what a case expects to fail it calls itself.
  Trial(Record &record, const std::string &label, const Start &start);

  pbf_solver *solver() const { return solver_.get(); }
  const pbf_params &params() const { return scene_.params; }
  uint32_t count() const;
  uint64_t hash() const;
  pbf_info info() const;
  pbf_stats stats() const;

  void step(uint32_t steps);
  // Steps, and dumps `frames` states on the way, the last one included.
  void run(uint32_t steps, uint32_t frames);

  // Dumps the present state.
  void frame();
  // … and the solver's own densities of it.
  void densities();

  // From here on states go into the folder `label`, the present one first.
  void begin(const std::string &label);
  // … with new parameters.
  void change(const pbf_params &params, const std::string &label);

  // A picture of the present state for the page.
  void draw(const std::string &caption);

  // The bytes of a row of scalars in the solver's precision.
  Bytes scalars(const std::vector<double> &values) const;
  Bytes positions() const;
  Bytes velocities() const;

 private:
  void write_rows(const char *what, const Bytes &bytes, uint32_t columns) const;
  Bytes read(pbf_status (*getter)(pbf_solver *, uint32_t, uint32_t, void *),
             uint32_t columns) const;

  struct Destroy {
    void operator()(pbf_solver *solver) const { pbf_destroy(solver); }
  };
  Record &record_;
  Scene scene_;
  std::string label_;
  std::map<uint64_t, double> times_;
  std::unique_ptr<pbf_solver, Destroy> solver_;
};

// Throws Error with the library's sentence.
void must(pbf_status status);

// A pbf_desc for this run's backend, which it keeps a pointer into.
pbf_desc desc_for(const Record &record, unsigned dimension, uint32_t capacity, uint32_t threads);

}  // namespace bench::stability

#endif
