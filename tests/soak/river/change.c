/* What changes on the way. Each change is one that a game makes: none is refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "river.h"

typedef void (*change)(river *r, dice *d);

static pbf_params params_of(river *r) {
  pbf_params params = {.struct_size = sizeof params};
  river_must(pbf_get_params(r->solver, &params), "the parameters");
  return params;
}

static void set_params(river *r, const pbf_params *params) {
  river_must(pbf_set_params(r->solver, params), "other parameters");
}

static void change_gravity(river *r, dice *d) {
  pbf_params params = params_of(r);
  params.gravity[0] = dice_in(d, -2, 2);
  params.gravity[1] = dice_one_in(d, 8) ? dice_in(d, -2, 2) : dice_in(d, -12, -6);
  params.gravity[2] = dice_in(d, -1, 1);
  set_params(r, &params);
}

static void change_step(river *r, dice *d) {
  pbf_params params = params_of(r);
  params.time_step = 1 / dice_in(d, 60, 480);
  params.iterations = 2 + dice_below(d, 5);
  params.max_substeps = dice_one_in(d, 2) ? 0 : 4;
  params.tolerance = dice_one_in(d, 3) ? 0.005 : 0;
  set_params(r, &params);
}

static void change_fluid(river *r, dice *d) {
  pbf_params params = params_of(r);
  params.viscosity = dice_one_in(d, 2) ? 0 : dice_in(d, 0, 0.01);
  params.vorticity = dice_one_in(d, 3) ? dice_in(d, 0, 0.01) : 0;
  params.drag = dice_one_in(d, 3) ? dice_in(d, 0, 2) : 0;
  params.cohesion = dice_one_in(d, 3) ? dice_in(d, 0, 1) : 0;
  params.shear_stress_correction = dice_one_in(d, 2) ? -1 : dice_in(d, 0, 0.75);
  params.damping_compensation = dice_one_in(d, 3) ? dice_in(d, 0, 1) : 0;
  set_params(r, &params);
}

static void change_solids(river *r, dice *d) {
  pbf_params params = params_of(r);
  params.wall_friction = dice_one_in(d, 2) ? 0 : dice_in(d, 0, 0.5);
  params.wall_no_slip = params.viscosity > 0 && dice_one_in(d, 2) ? 1 : 0;
  params.wall_density = dice_one_in(d, 4) ? dice_in(d, 0, 1) : 1;
  params.loads = !dice_one_in(d, 6);
  params.sleep_speed = dice_one_in(d, 3) ? dice_in(d, 0.01, 0.1) : 0;
  params.sleep_time = 0.25;
  set_params(r, &params);
}

static void change_phases(river *r, dice *d) {
  pbf_phase phases[2];
  for (int i = 0; i < 2; ++i) {
    river_must(pbf_phase_init(&phases[i], sizeof phases[i]), "a phase");
    phases[i].rest_density = dice_one_in(d, 4) ? 1 : dice_in(d, 0.5, 2);
    phases[i].viscosity = dice_in(d, 0, 1);
    phases[i].user = dice_below(d, 100);
  }
  river_must(pbf_set_phases(r->solver, 2, phases), "other phases");
}

static void change_wheel(river *r, dice *d) {
  pbf_collider colliders[RIVER_COLLIDERS];
  river_colliders(r, colliders);
  pbf_collider *wheel = &colliders[RIVER_WHEEL];
  wheel->angular_velocity[2] = dice_in(d, -5, 5);
  wheel->scale = dice_one_in(d, 3) ? dice_in(d, 0.8, 1.1) : wheel->scale;
  wheel->friction = dice_one_in(d, 2) ? 0 : dice_in(d, 0, 1);
  wheel->path = dice_below(d, 3);
  colliders[RIVER_BED].friction = dice_one_in(d, 2) ? 0 : dice_in(d, 0, 0.6);
  river_must(pbf_set_colliders(r->solver, RIVER_COLLIDERS, colliders), "another wheel");
}

/* Falls in again from above. */
static void drop_crate(river *r, dice *d) {
  pbf_collider colliders[RIVER_COLLIDERS];
  river_colliders(r, colliders);
  pbf_collider *crate = &colliders[RIVER_CRATES + dice_below(d, RIVER_COLLIDERS - RIVER_CRATES)];
  const double turn = dice_in(d, -1.5, 1.5);
  crate->position[0] = dice_one_in(d, 2) ? dice_in(d, 0.35, 0.45) : dice_in(d, 1.15, 1.25);
  crate->position[1] = dice_in(d, 0.7, 1);
  crate->orientation[2] = sin(turn / 2), crate->orientation[3] = cos(turn / 2);
  for (int k = 0; k < 3; ++k) crate->velocity[k] = 0;
  crate->angular_velocity[2] = dice_in(d, -2, 2);
  river_must(pbf_set_colliders(r->solver, RIVER_COLLIDERS, colliders), "a crate");
}

static void turn_taps(river *r, dice *d) {
  pbf_in_out in_out = {.struct_size = sizeof in_out};
  pbf_emitter emitters[2];
  river_must(pbf_get_in_out(r->solver, &in_out), "the taps");
  for (uint32_t i = 0; i < in_out.emitters; ++i) {
    emitters[i].struct_size = sizeof emitters[i];
    river_must(pbf_get_emitter(r->solver, i, &emitters[i]), "a tap");
    emitters[i].velocity[0] = dice_in(d, 0.2, 1.5);
    emitters[i].velocity[1] = dice_in(d, -0.2, 0.2);
    emitters[i].rate = dice_one_in(d, 2) ? 0 : dice_in(d, 1e-6, r->dimension == 2 ? 0.019 : 0.0039);
    emitters[i].jitter = dice_one_in(d, 2) ? 0 : dice_in(d, 0, 0.5);
    emitters[i].lifetime = dice_one_in(d, 3) ? dice_in(d, 0.2, 5) : 0;
    emitters[i].recycle = dice_below(d, 2);
    emitters[i].phase = dice_below(d, 2);
  }
  river_must(pbf_set_emitters(r->solver, in_out.emitters, emitters), "other taps");
}

static void pour(river *r, dice *d) {
  const uint32_t n = r->dimension, side = 3, many = n == 2 ? side * side : side * side * side;
  double x[27 * 3], first[3];
  float packed[27 * 3];
  uint32_t count = 0;
  river_must(pbf_get_count(r->solver, &count), "the count");
  if (count + many > r->capacity) return;
  for (uint32_t k = 0; k < n; ++k)
    first[k] = dice_in(d, k == 1 ? 0.95 : 0.1, k == 0 ? 1.4 : k == 1 ? 1.05 : 0.3);
  for (uint32_t i = 0; i < many; ++i)
    for (uint32_t k = 0; k < n; ++k) {
      const uint32_t at = k == 0 ? i % side : k == 1 ? i / side % side : i / side / side;
      x[i * n + k] = first[k] + river_spacing * at;
      packed[i * n + k] = (float)x[i * n + k];
    }
  const void *rows = r->precision == PBF_FLOAT32 ? (const void *)packed : (const void *)x;
  river_must(pbf_add_particles(r->solver, many, rows, NULL, NULL), "a bucket");
  const uint32_t phase = dice_below(d, 2);
  uint32_t phases[27];
  for (uint32_t i = 0; i < many; ++i) phases[i] = phase;
  river_must(pbf_set_particle_phases(r->solver, count, many, phases), "its phase");
  r->put += many;
}

static void scoop(river *r, dice *d) {
  double lower[3], upper[3];
  uint32_t count = 0;
  for (int k = 0; k < 3; ++k) {
    lower[k] = dice_in(d, 0, 1.5);
    upper[k] = lower[k] + dice_in(d, 0, 0.3);
  }
  lower[2] = 0, upper[2] = 1;
  river_must(pbf_remove_in_box(r->solver, lower, upper, &count), "a scoop");
  r->taken += count;
}

static void save_and_load(river *r, dice *d) {
  uint64_t size = 0, before = 0, after = 0;
  (void)d;
  river_must(pbf_hash(r->solver, &before), "the hash");
  river_must(pbf_save(r->solver, NULL, &size), "a state's size");
  void *state = malloc(size);
  river_must(state ? pbf_save(r->solver, state, &size) : PBF_ERROR_OUT_OF_MEMORY, "a state");
  river_must(pbf_load(r->solver, state, size), "its loading");
  free(state);
  river_must(pbf_hash(r->solver, &after), "the hash");
  if (before != after)
    snprintf(r->fault, sizeof r->fault, "a state that was saved and loaded has another hash");
}

static void change_watching(river *r, dice *d) {
  river_must(pbf_set_snapshots(r->solver, dice_one_in(d, 2) ? 0 : 2), "snapshots");
  river_must(pbf_keep_previous(r->solver, dice_below(d, 2)), "positions from before");
  const pbf_status status = pbf_set_timing(r->solver, dice_below(d, 2));
  if (status != PBF_ERROR_UNSUPPORTED) river_must(status, "times"); /* `reference` has none */
}

void river_change(river *r) {
  static const change changes[] = {change_gravity, change_step,    change_fluid, change_solids,
                                   change_phases,  change_wheel,   drop_crate,   turn_taps,
                                   turn_taps,      pour,           pour,         scoop,
                                   save_and_load,  change_watching};
  dice d = dice_of(r->seed, 0, r->change++);
  changes[dice_below(&d, sizeof changes / sizeof *changes)](r, &d);
}
