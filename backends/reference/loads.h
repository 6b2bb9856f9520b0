/* Part of step.h: what the fluid does to solids (physics/loads.h). */
#ifndef PBF_REFERENCE_LOADS_H
#define PBF_REFERENCE_LOADS_H

#include "physics/adhesion.h"
#include "physics/grid_loads.h"
#include "physics/no_slip_loads.h"
#include "physics/passes/predict.h"
#include "reference/sleep.h"

static inline bool finds_loads(const solver *s) {
  return (PBF_BUILT & PBF_FEATURE_LOADS) && s->schedule.runs[PBF_STAGE_LOADS];
}

/* Whether what solids push with is wanted of each particle. */
static inline bool notes_pushes(const solver *s) {
  return finds_loads(s) ||
         ((PBF_BUILT & PBF_FEATURE_LOADS) && s->schedule.runs[PBF_STAGE_FRICTION]);
}

static inline pbf_real mobility_of(const solver *s, uint32_t i) {
  return s->phase ? s->constants.phases.mobility[s->phase[i]] : 1;
}

static inline void add_change(solver *s, double units, pbf_vec change) {
  for (int k = 0; k < PBF_DIM; ++k)
    pbf_wide_add(&s->load_tally->change[k], pbf_wide_of(units * (double)change.c[k]));
}

static inline void begin_loads(solver *s) {
  if (finds_loads(s)) pbf_clear_load_sums(s->load_tally);
  if (notes_pushes(s)) memset(s->push, 0, s->count * sizeof *s->push);
}

/* Once it has its velocity in the prediction: without solids it would be `forced`. */
static inline void begin_push(solver *s, const pbf_forces *forces, uint32_t i, pbf_vec forced) {
  if (!notes_pushes(s)) return;
  s->push[i] = pbf_sub(s->v[i], forced);
  if (!finds_loads(s)) return;
  const pbf_real mass = 1 / mobility_of(s, i);
  add_change(s, -pbf_units_of_momentum(&s->constants, forces), pbf_scaled(forced, mass));
}

/* A particle's velocity has been changed by solids. */
static inline void note_push(const solver *s, uint32_t i, pbf_vec change) {
  if (notes_pushes(s)) s->push[i] = pbf_add_scaled(s->push[i], 1, change);
}

static inline bool has_grid_pressure(const solver *s) {
  return s->schedule.runs[PBF_STAGE_GRID] && s->schedule.accelerated;
}

/* What the pressure grid adds to the lambda of particle i. */
static inline pbf_real grid_lambda_of(const solver *s, uint32_t i) {
  return pbf_pressure_grid_particle_lambda(&s->pressure_grid, s->constants.pressure,
                                           (pbf_real)(1 / s->params.time_step), s->moved[i]);
}

static inline load_particle load_particle_at(const solver *s, uint32_t i) {
  return {s->moved[i], s->v[i], s->push[i], s->lambda[i], has_grid_pressure(s)};
}

/* What friction changes the velocity of particle i by. */
static inline pbf_vec rub(solver *s, const pbf_friction_scales &scales, const pbf_obstacles *o,
                          uint32_t i) {
  load_particle p = load_particle_at(s, i);
  const pbf_real mobility = mobility_of(s, i);
  p.lambda *= mobility;
  return friction_change(
      &s->constants, scales, *o, all_surfaces{}, p, [&] { return grid_lambda_of(s, i); },
      [&](const pbf_load_plane &plane, const load_share &share) {
        if (finds_loads(s))
          add_part(&s->load_tally->sums[plane.solid],
                   load_part_beside(&scales.loads, *o, p.x, plane, with_mass(share, mobility)),
                   false);
      });
}

/* What solids change the velocity of particle i by, that lacks so much of its neighbours. */
static inline pbf_vec adhere(solver *s, const pbf_adhesion_scales &scales, const pbf_obstacles *o,
                             uint32_t i, pbf_real missing) {
  const pbf_vec x = s->moved[i];
  return adhesion_change(&s->constants, scales, *o, all_surfaces{}, x, missing,
                         [&](const pbf_load_plane &plane, const load_share &share) {
                           if (finds_loads(s))
                             add_part(&s->load_tally->sums[plane.solid],
                                      load_part_beside(&scales.loads, *o, x, plane, share), false);
                         });
}

/* What solids take by viscosity, once it is known what it changes: of those that sleep nothing. */
static inline void find_no_slip_loads(solver *s, const pbf_forces &forces, const pbf_obstacles *o) {
  const pbf_load_scales scales = pbf_load_scales_of(&s->constants, &forces, &s->params);
  const pbf_no_slip no_slip = pbf_no_slip_of(&s->params, s->table.list);
  for (uint32_t i = 0; i < s->count; ++i) {
    if (asleep(s, i)) continue;
    const pbf_vec x = s->x[i], v = pbf_add_scaled(s->v[i], 1, s->change[i]);
    share_no_slip(
        &s->constants, *o, no_slip, x, v,
        [&](const pbf_load_plane &plane, const load_share &share) {
          add_part(&s->load_tally->sums[plane.solid],
                   load_part_beside(&scales, *o, x, plane, with_mass(share, mobility_of(s, i))),
                   false);
        },
        s->phase ? s->constants.phases.viscosity[s->phase[i]] : 1);
  }
}

/* What the pressure grid does to solids. */
static inline void find_grid_loads(solver *s, const pbf_load_scales &scales,
                                   const pbf_obstacles *o) {
  const pbf_pressure_grid *c = &s->pressure_grid.grid;
  const pbf_grid_load_cubes cubes = grid_load_cubes_of(&scales, c);
  int i[PBF_DIM];
  for (uint32_t cell = 0; cell < c->nodes; ++cell) {
    pbf_pressure_grid_place(c, cell, i);
    if (!pbf_cell_is_inside(c, i) || !pbf_pressure_grid_has_pressure(&s->pressure_grid, cell))
      continue;
    each_grid_load_point(c, cubes.points, i, [&](pbf_vec x) {
      share_grid_pressure_around(
          &scales, cubes, *o, all_surfaces{}, x,
          [&](pbf_vec at, double slope[]) {
            return pbf_pressure_grid_pressure(&s->pressure_grid, s->params.time_step, at,
                                              cubes.part, slope);
          },
          [&](const pbf_load_plane &plane, pbf_vec at, const load_share &share) {
            add_part(&s->load_tally->sums[plane.solid],
                     load_part_beside(&scales, *o, at, plane, share), false);
          });
    });
  }
}

static inline void find_loads(solver *s, const pbf_forces &forces, const pbf_obstacles *o) {
  const pbf_constants *c = &s->constants;
  const pbf_load_scales scales = pbf_load_scales_of(c, &forces, &s->params);
  pbf_load_tally *tally = s->load_tally;
  for (uint32_t i = 0; i < s->count; ++i) {
    load_particle p = with_mass(load_particle_at(s, i), mobility_of(s, i));
    if (asleep(s, i))
      p = sleeping_load_particle(c, &scales, *o, all_surfaces{}, p,
                                 [&] { return grid_lambda_of(s, i); });
    add_change(s, scales.velocity, p.change);
    int last = -1;
    p.has_grid = false;
    share_push(
        c, &scales, *o, all_surfaces{}, p, [] { return (pbf_real)0; },
        [&](const pbf_load_plane &plane, const load_share &share) {
          const load_part part = load_part_of(&scales, *o, p.x, plane, share);
          add_part(&tally->sums[plane.solid], part, part.touches && plane.solid != last);
          if (part.touches) last = plane.solid;
        });
  }
  if (has_grid_pressure(s)) find_grid_loads(s, scales, o);
  end_loads(tally, *o, &scales);
}

#endif
