/* What the recipe of a step exchanges, against what its stages read of neighbours and change. */
#include "support.h"

#include "physics/step.h"

/* Each stage says what it reads of neighbours, which must be as it was last written, and what it
 * writes. */
struct watcher {
  int stale;        /* fields that ghosts have not as they are */
  const char *late; /* the first stage that read one of them */

  void stage_of(const char *name, int reads, int writes) {
    if ((stale & reads) && !late) late = name;
    stale |= writes;
  }
  void exchange(int fields) { stale &= ~fields; }

  bool wake() { return true; }
  void predict() { stage_of("predict", 0, FIELD_POSITION | FIELD_VELOCITY); }
  bool find_neighbors() {
    stale = 0; /* ghosts are found with all that they repeat */
    return true;
  }
  void overlap() { stage_of("overlap", FIELD_POSITION | FIELD_VELOCITY, 0); }
  void residual_density() { stage_of("residual_density", FIELD_POSITION | FIELD_VELOCITY, 0); }
  void crowding() { stage_of("crowding", FIELD_POSITION | FIELD_VELOCITY, FIELD_CROWDING); }
  void viscosity(uint32_t k) {
    stage_of("viscosity",
             FIELD_POSITION | FIELD_CROWDING | (k ? FIELD_VISCOUS_CHANGE : FIELD_VELOCITY),
             FIELD_VISCOUS_CHANGE);
  }
  void move_by_viscosity() { stage_of("move_by_viscosity", 0, FIELD_POSITION | FIELD_VELOCITY); }
  void begin_solve() { stage_of("begin_solve", 0, 0); }
  void pressure_grid() {
    stage_of("pressure_grid", FIELD_POSITION, FIELD_POSITION | FIELD_VELOCITY);
  }
  bool is_converged(uint32_t) const { return false; }
  void begin_iteration(uint32_t) {}
  void lambda(uint32_t) { stage_of("lambda", FIELD_POSITION, FIELD_LAMBDA | FIELD_LAMBDA_TOTAL); }
  void torque_deficit(uint32_t) { stage_of("torque_deficit", FIELD_POSITION | FIELD_LAMBDA, 0); }
  void move(uint32_t) {
    stage_of("move", FIELD_POSITION | FIELD_LAMBDA, FIELD_POSITION | FIELD_VELOCITY);
  }
  void velocity() { stage_of("velocity", 0, FIELD_POSITION | FIELD_VELOCITY); }
  void deviator() { stage_of("deviator", FIELD_POSITION, FIELD_DEVIATOR); }
  bool shear_stress_is_due() const { return true; }
  void shear_push() { stage_of("shear_push", FIELD_POSITION | FIELD_DEVIATOR, FIELD_SHEAR_PUSH); }
  void correct_shear_stress() {
    stage_of("correct_shear_stress", FIELD_POSITION | FIELD_SHEAR_PUSH,
             FIELD_POSITION | FIELD_VELOCITY);
  }
  void mean_velocity() {
    stage_of("mean_velocity", FIELD_POSITION | FIELD_VELOCITY, FIELD_MEAN_VELOCITY);
  }
  void compensate_damping() {
    stage_of("compensate_damping", FIELD_POSITION | FIELD_MEAN_VELOCITY | FIELD_LAMBDA_TOTAL,
             FIELD_VELOCITY);
  }
  void correction_rate() { stage_of("correction_rate", FIELD_POSITION, FIELD_CORRECTION_RATE); }
  void correct_angular_momentum() {
    stage_of("correct_angular_momentum", FIELD_POSITION | FIELD_CORRECTION_RATE, FIELD_VELOCITY);
  }
  void curl() { stage_of("curl", FIELD_POSITION | FIELD_VELOCITY, FIELD_CURL_SIZE); }
  void confine() { stage_of("confine", FIELD_POSITION | FIELD_CURL_SIZE, FIELD_VELOCITY); }
  void friction() { stage_of("friction", 0, FIELD_POSITION | FIELD_VELOCITY); }
  void loads() { stage_of("loads", 0, 0); }
  void missing_neighbors() { stage_of("missing_neighbors", FIELD_POSITION, FIELD_MISSING); }
  void surface_tension() {
    stage_of("surface_tension", FIELD_POSITION | FIELD_MISSING, FIELD_VELOCITY);
  }
  template <class Pass>
  void over_particles(pbf_stage stage) {
    stage_of(pbf_stage_name(stage), 0, FIELD_VELOCITY);
  }
  bool update_sleep() {
    stage_of("update_sleep", FIELD_POSITION | FIELD_VELOCITY, 0);
    return false;
  }
  void end() { stage_of("end", 0, 0); }
};

/* Of all sets of stages, in which those of an iteration run more than once. */
static void no_stage_reads_what_is_stale(void **state) {
  (void)state;
  for (uint32_t set = 0; set < 2u << PBF_STAGE_COUNT; ++set) {
    pbf_schedule has = {};
    has.adhesion = set >> PBF_STAGE_COUNT != 0;
    has.accelerated = 1;
    watcher seen = {};
    for (int k = 0; k < PBF_STAGE_COUNT; ++k) has.runs[k] = set >> k & 1 ? 2 : 0;
    run_step(seen, has);
    if (seen.late) fail_msg("stages %x: %s reads what ghosts do not have", set, seen.late);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(no_stage_reads_what_is_stale)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
