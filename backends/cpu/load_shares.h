/* Part of executor.h: the stage that shares out what solids have done (physics/loads.h). */
#ifndef PBF_CPU_LOAD_SHARES_H
#define PBF_CPU_LOAD_SHARES_H

#include "cpu/loads.h"
#include "cpu/pressure_grid.h"
#include "physics/friction.h"

namespace {

/* The sums of the solids that a task has met last: particles near each other meet the same ones. */
struct recent_loads {
  enum { SLOTS = 4 };
  pbf_load_tally *tally;
  int solid[SLOTS];
  pbf_load_sums sums[SLOTS];

  void begin(pbf_load_tally *to) {
    tally = to;
    for (int &of : solid) of = -1;
  }

  void flush(int slot) {
    if (solid[slot] < 0) return;
    pbf_load_sums *to = &tally->sums[solid[slot]];
    const pbf_load_sums *from = &sums[slot];
    for (int k = 0; k < PBF_LOAD_SUMS; ++k) add_to_shared(&to->of[k], from->of[k]);
    __atomic_fetch_add(&to->contacts, from->contacts, __ATOMIC_RELAXED);
    uint64_t depth = __atomic_load_n(&to->depth, __ATOMIC_RELAXED);
    while (depth < from->depth &&
           !__atomic_compare_exchange_n(&to->depth, &depth, from->depth, true, __ATOMIC_RELAXED,
                                        __ATOMIC_RELAXED)) {
    }
    solid[slot] = -1;
  }

  pbf_load_sums *of(int wanted) {
    const int slot = wanted % SLOTS;
    if (solid[slot] != wanted) {
      flush(slot);
      solid[slot] = wanted;
      memset(&sums[slot], 0, sizeof sums[slot]);
    }
    return &sums[slot];
  }

  void end() {
    for (int slot = 0; slot < SLOTS; ++slot) flush(slot);
  }
};

}  // namespace

static pbf_real grid_lambda_of(const worker *w, uint32_t i) {
  const solver *s = w->s;
  if (!has_pressure_grid(w) || !s->schedule.accelerated) return 0;
  return pbf_pressure_grid_particle_lambda(&s->pressure_grid, s->constants.pressure,
                                           (pbf_real)(1 / s->params.time_step),
                                           field_at(&w->b.x, i));
}

static load_particle load_particle_at(const worker *w, const pbf_load_scales *scales, uint32_t i) {
  const load_particle p = {field_at(&w->b.x, i), field_at(&w->b.v, i), field_at(&w->s->push, i),
                           w->s->lambda[i], grid_lambda_of(w, i)};
  if (!sleep_is_on(w) || !pbf_is_asleep(w->activity[i])) return p;
  return sleeping_load_particle(&w->constants, scales, w->obstacles, p);
}

/* What friction changes velocities by moves particles at once. */
static void friction_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const solver *s = w->s;
  const pbf_friction_scales scales = pbf_friction_scales_of(&w->constants, &w->forces, &s->params);
  const range all = task_sorted(w, task);
  const field to = w->b.sheared_x();
  recent_loads loads;
  loads.begin(s->load_tally);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last)) {
    for (uint32_t i = r.first; i < r.last; ++i) {
      const load_particle p = load_particle_at(w, &scales.loads, i);
      const pbf_vec change = friction_change(
          &w->constants, scales, w->obstacles, p,
          [&](const pbf_load_plane &plane, const load_share &share) {
            if (finds_loads(s))
              add_part(loads.of(plane.solid),
                       friction_load(&scales.loads, w->obstacles, p.x, plane, share), false);
          });
      field_set(&w->b.v, i, pbf_add_scaled(p.change, 1, change));
      field_set(&to, i, pbf_add_scaled(p.x, w->forces.time_step, change));
    }
    begin_noting(s, &w->b.v, r);
    s->kernels->collide(&w->obstacles, w->forces.inv_time_step, w->b.x, to, w->b.v, r.first,
                        r.last);
    end_noting(s, &w->b.v, r);
  }
  loads.end();
  copy_sleeping(w, all, &w->b.x, &to);
  fill_packed(s, packed_positions(s), &to, NULL, all);
}

static void loads_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const pbf_load_scales scales = pbf_load_scales_of(&w->constants, &w->forces, &w->s->params);
  const range all = task_sorted(w, task);
  pbf_wide_sum change[PBF_DIM] = {};
  recent_loads loads;
  loads.begin(w->s->load_tally);
  for (uint32_t i = all.first; i < all.last; ++i) {
    const load_particle p = load_particle_at(w, &scales, i);
    int last = -1;
    for (int k = 0; k < PBF_DIM; ++k)
      pbf_wide_add(&change[k], pbf_wide_of(scales.velocity * (double)p.change.c[k]));
    share_push(&w->constants, &scales, w->obstacles, p,
               [&](const pbf_load_plane &plane, const load_share &share) {
                 const load_part part = load_part_of(&scales, w->obstacles, p.x, plane, share);
                 add_part(loads.of(plane.solid), part, part.touches && plane.solid != last);
                 if (part.touches) last = plane.solid;
               });
  }
  loads.end();
  add_change(w->s, change);
}

static void end_loads_of_step(void *context) {
  const worker *w = static_cast<const worker *>(context);
  const pbf_load_scales scales = pbf_load_scales_of(&w->constants, &w->forces, &w->s->params);
  end_loads(w->s->load_tally, w->obstacles, &scales);
}

#endif
