/* Part of executor.h: the stage that shares out what solids have done (physics/loads.h). */
#ifndef PBF_CPU_LOAD_SHARES_H
#define PBF_CPU_LOAD_SHARES_H

#include "cpu/broad_phase.h"
#include "cpu/loads.h"
#include "cpu/pressure_grid.h"
#include "physics/adhesion.h"
#include "physics/friction.h"
#include "physics/grid_loads.h"

namespace {

/* The surfaces that some particles may be within a reach of, by number. */
struct near_surfaces {
  enum { PARTICLES = 16 };
  int count;
  bool any; /* these, or walls */
  const uint16_t *of;

  template <class Visit>
  void each(int, Visit visit) const {
    for (int k = 0; k < count; ++k) visit((int)of[k]);
  }

  /* Of particles first … last - 1. A surface that one of them asks about is never left out, so that
   * what it finds does not depend on the others. */
  void find(const pbf_obstacles *o, const field *x, pbf_real reach, range r) {
    pbf_vec lower = field_at(x, r.first), upper = lower;
    for (int k = 0; k < PBF_DIM; ++k)
      for (uint32_t i = r.first; i < r.last; ++i) {
        lower.c[k] = pbf_real_min(lower.c[k], x->c[k][i]);
        upper.c[k] = pbf_real_max(upper.c[k], x->c[k][i]);
      }
    find_between(o, lower, upper, reach);
  }

  void find_between(const pbf_obstacles *o, pbf_vec lower, pbf_vec upper, pbf_real reach) {
    const group_bounds bounds = bounds_between(lower, upper, 0);
    const pbf_real to_wall = pbf_domain_distance(&o->domain, bounds.center);
    pbf_obstacles found;
    collect_surfaces(
        pbf_obstacles_around(*o, bounds.lower, bounds.upper, reach), o->room,
        [&](const pbf_surface *s) { return may_be_near(&bounds, s, reach); }, &found);
    count = found.count;
    of = o->room;
    any = count || to_wall < bounds.radius + reach;
  }

  /* Of a field planes may be nearer than the surface is. */
  static bool may_be_near(const group_bounds *bounds, const pbf_surface *s, pbf_real reach) {
    if (pbf_surface_is_field(s))
      return !pbf_surface_is_beyond(s, bounds->center, bounds->radius + reach);
    return bounds_are_within(bounds, s, reach);
  }
};

static inline void add_sums_to_shared(const worker *w, int solid, const pbf_load_sums *from) {
  pbf_load_sums *to = &w->s->load_tally->sums[solid];
  for (int k = 0; k < PBF_LOAD_SUMS; ++k) add_to_shared(&to->of[k], from->of[k]);
  __atomic_fetch_add(&to->contacts, from->contacts, __ATOMIC_RELAXED);
  uint64_t depth = __atomic_load_n(&to->depth, __ATOMIC_RELAXED);
  while (depth < from->depth && !__atomic_compare_exchange_n(&to->depth, &depth, from->depth, true,
                                                             __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
}

/* The sums of the solids that a task has met last: particles near each other meet the same ones. */
struct recent_loads {
  enum { SLOTS = 16 };
  const worker *w;
  const pbf_load_scales *scales;
  int solid[SLOTS];
  pbf_load_measure measures[SLOTS];
  pbf_load_sums sums[SLOTS];

  recent_loads(const worker *of, const pbf_load_scales *by) : w(of), scales(by) {
    for (int &none : solid) none = -1;
  }

  void flush(int slot) {
    if (solid[slot] < 0) return;
    add_sums_to_shared(w, solid[slot], &sums[slot]);
    solid[slot] = -1;
  }

  int slot_of(int wanted) {
    const int slot = wanted % SLOTS;
    if (solid[slot] != wanted) {
      flush(slot);
      solid[slot] = wanted;
      measures[slot] = load_measure_of(scales, w->obstacles, wanted);
      memset(&sums[slot], 0, sizeof sums[slot]);
    }
    return slot;
  }

  /* *last is the solid that the particle has touched last. */
  void add(const pbf_load_plane &plane, pbf_vec x, const load_share &share, int *last) {
    const int slot = slot_of(plane.solid);
    const load_numbers part = load_numbers_of(scales, measures[slot], x, plane, share);
    add_numbers(&sums[slot], measures[slot], part, part.touches && plane.solid != *last);
    if (part.touches) *last = plane.solid;
  }

  /* A force beside pushes. */
  void add_beside(const pbf_load_plane &plane, pbf_vec x, const load_share &share) {
    const int slot = slot_of(plane.solid);
    const load_numbers part = load_numbers_of(scales, measures[slot], x, plane, share);
    add_numbers(&sums[slot], measures[slot], without_wet(part), false);
  }

  void end() {
    for (int slot = 0; slot < SLOTS; ++slot) flush(slot);
  }
};

}  // namespace

static load_slot recent_slot(void *recent, int solid) {
  recent_loads *loads = static_cast<recent_loads *>(recent);
  const int slot = loads->slot_of(solid);
  return {&loads->sums[slot], &loads->measures[slot]};
}

static bool has_grid_pressure(const worker *w) {
  return has_pressure_grid(w) && w->s->schedule.accelerated;
}

/* What the pressure grid adds to the lambda of particle i. */
static pbf_real grid_lambda_of(const worker *w, uint32_t i) {
  return pbf_pressure_grid_particle_lambda(&w->s->pressure_grid, w->s->constants.pressure,
                                           (pbf_real)(1 / w->s->params.time_step),
                                           field_at(&w->b.x, i));
}

static load_particle load_particle_at(const worker *w, const pbf_load_scales *scales,
                                      const near_surfaces &near, uint32_t i) {
  const load_particle p = {field_at(&w->b.x, i), field_at(&w->b.v, i), field_at(&w->s->push, i),
                           w->s->lambda[i], has_grid_pressure(w)};
  if (!sleep_is_on(w) || !pbf_is_asleep(w->activity[i])) return p;
  return sleeping_load_particle(&w->constants, scales, w->obstacles, near, p,
                                [&] { return grid_lambda_of(w, i); });
}

/* And of its momentum, which is what solids get. */
static load_particle load_momentum_at(const worker *w, const pbf_load_scales *scales,
                                      const near_surfaces &near, uint32_t i) {
  const load_particle p = load_particle_at(w, scales, near, i);
  const bool sleeps = sleep_is_on(w) && pbf_is_asleep(w->activity[i]);
  return w->s->mobility && !sleeps ? with_mass(p, w->s->mobility[i]) : p;
}

/* Calls visit(near, particles) for some particles of a range after others. */
template <class Visit>
static void each_near_surfaces(const worker *w, double reach, range all, Visit visit) {
  near_surfaces near;
  for (range r = {all.first, all.first}; r.first < all.last; r.first = r.last) {
    const uint32_t left = all.last - r.first, most = near_surfaces::PARTICLES;
    r.last = r.first + (left < most ? left : most);
    near.find(&w->obstacles, &w->b.x, (pbf_real)reach, r);
    visit(near, r);
  }
}

/* Where it is not, and no solid is near, it has no load. */
static bool is_pushed(const worker *w, uint32_t i) {
  const pbf_vec push = field_at(&w->s->push, i);
  return pbf_dot(push, push) > 0;
}

/* What friction changes velocities by moves particles at once. */
static void friction_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const solver *s = w->s;
  const pbf_friction_scales scales =
      pbf_friction_scales_of(&w->constants, &w->forces, &s->params, s->table.list);
  const range all = task_sorted(w, task);
  const field to = w->b.sheared_x();
  recent_loads loads(w, &scales.loads);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last)) {
    each_near_surfaces(w, scales.loads.reach, r, [&](const near_surfaces &near, range some) {
      for (uint32_t i = some.first; i < some.last; ++i) {
        load_particle p = load_particle_at(w, &scales.loads, near, i);
        const pbf_real mobility = s->mobility ? s->mobility[i] : 1;
        p.lambda *= mobility;
        pbf_vec change = {{0}};
        if (near.any || is_pushed(w, i))
          change = friction_change(
              &w->constants, scales, w->obstacles, near, p, [&] { return grid_lambda_of(w, i); },
              [&](const pbf_load_plane &plane, const load_share &share) {
                if (finds_loads(s)) loads.add_beside(plane, p.x, with_mass(share, mobility));
              });
        field_set(&w->b.v, i, pbf_add_scaled(p.change, 1, change));
        field_set(&to, i, pbf_add_scaled(p.x, w->forces.time_step, change));
      }
    });
    begin_noting(s, &w->b.v, r);
    s->kernels->collide(&w->obstacles, w->forces.inv_time_step, w->b.x, to, w->b.v, r.first,
                        r.last);
    end_noting(s, &w->b.v, r);
  }
  loads.end();
  copy_sleeping(w, all, &w->b.x, &to);
  fill_packed(s, packed_positions(s), &to, NULL, all);
}

/* At the end of the step, of fluid with a surface tension. */
static void adhesion_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const solver *s = w->s;
  const pbf_adhesion_scales scales =
      pbf_adhesion_scales_of(&w->constants, &w->forces, &s->params, s->table.list);
  const pbf_real *missing = missing_neighbors_of(s);
  const range all = task_sorted(w, task);
  recent_loads loads(w, &scales.loads);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    each_near_surfaces(w, scales.loads.reach, r, [&](const near_surfaces &near, range some) {
      for (uint32_t i = some.first; i < some.last && near.any; ++i) {
        const pbf_vec x = field_at(&w->b.x, i);
        const pbf_vec change =
            adhesion_change(&w->constants, scales, w->obstacles, near, x, missing[i],
                            [&](const pbf_load_plane &plane, const load_share &share) {
                              if (finds_loads(s)) loads.add_beside(plane, x, share);
                            });
        field_set(&w->b.v, i, pbf_add_scaled(field_at(&w->b.v, i), 1, change));
      }
    });
  loads.end();
}

namespace {

/* What the grid's pressure does, in the cells of a task. */
struct grid_task_loads {
  const worker *w;
  recent_loads recent;
  grid_load_pass pass;

  grid_task_loads(const worker *of, const pbf_load_scales *scales)
      : w(of), recent(of, scales), pass{&of->s->pressure_grid,
                                        &of->obstacles,
                                        scales,
                                        recent_slot,
                                        &recent,
                                        grid_load_cubes_of(scales, &of->s->pressure_grid.grid)} {}

  /* In the i-th cell along each axis. */
  void add(const int i[PBF_DIM]) {
    const pbf_pressure_grid *c = &pass.storage->grid;
    const pbf_vec middle = pbf_cell_middle(c, i);
    pbf_vec half;
    near_surfaces near;
    pbf_real places[PBF_DIM][near_surfaces::PARTICLES];
    field some;
    uint32_t count = 0;
    for (int k = 0; k < PBF_DIM; ++k) some.c[k] = places[k];
    for (int k = 0; k < PBF_DIM; ++k) half.c[k] = (pbf_real)(0.5 * c->width);
    near.find_between(&w->obstacles, pbf_sub(middle, half), pbf_add_scaled(middle, 1, half),
                      (pbf_real)pbf_grid_load_reach(pass.scales->spacing));
    if (!near.any) return;
    each_grid_load_point(c, pass.cubes.points, i, [&](pbf_vec x) {
      field_set(&some, count, x);
      if (++count < w->s->kernels->width) return;
      add_points(near, some, count);
      count = 0;
    });
    if (count) add_points(near, some, count);
  }

  void add_points(const near_surfaces &near, field x, uint32_t count) {
    const auto in_lanes = w->s->kernels->grid_loads;
    if (in_lanes && in_lanes(&pass, near.of, near.count, x, count)) return;
    for (uint32_t l = 0; l < count; ++l) add_point(near, field_at(&x, l));
  }

  void add_point(const near_surfaces &near, pbf_vec x) {
    share_grid_pressure_around(
        pass.scales, pass.cubes, w->obstacles, near, x,
        [&](pbf_vec at, double slope[]) {
          return pbf_pressure_grid_pressure(pass.storage, pass.scales->time_step, at,
                                            pass.cubes.part, slope);
        },
        [&](const pbf_load_plane &plane, pbf_vec at, const load_share &share) {
          recent.add_beside(plane, at, share);
        });
  }
};

}  // namespace

/* On ranks, which have all of the grid, each looks at some of the cells. */
static bool is_load_cell(const worker *w, uint32_t cell, int i[PBF_DIM]) {
  const solver *s = w->s;
  if (has_ranks(s) && cell % s->ranks.count != s->ranks.rank) return false;
  pbf_pressure_grid_place(&s->pressure_grid.grid, cell, i);
  return pbf_cell_is_inside(&s->pressure_grid.grid, i) &&
         pbf_pressure_grid_has_pressure(&s->pressure_grid, cell);
}

static void grid_loads_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const pbf_load_scales scales = pbf_load_scales_of(&w->constants, &w->forces, &w->s->params);
  const range cells = part_of(w->s->pressure_grid.grid.nodes, task, pair_task_count(w));
  grid_task_loads loads(w, &scales);
  for (uint32_t cell = cells.first; cell < cells.last; ++cell) {
    int i[PBF_DIM];
    if (is_load_cell(w, cell, i)) loads.add(i);
  }
  loads.recent.end();
}

namespace {

/* What is summed up for a task. */
struct task_loads {
  const worker *w;
  const pbf_load_scales *scales;
  pbf_wide_sum change[PBF_DIM];
  recent_loads recent;
  load_pass pass;

  task_loads(const worker *of, const pbf_load_scales *by)
      : w(of), scales(by), change{}, recent(of, by), pass{&of->constants,
                                                          &of->obstacles,
                                                          by,
                                                          recent_slot,
                                                          &recent,
                                                          of->b.x,
                                                          of->b.v,
                                                          of->s->push,
                                                          of->s->lambda,
                                                          of->s->mobility} {}

  /* What a particle has got is shared out. */
  void share(const near_surfaces &near, const load_particle &p) {
    int last = -1;
    share_push(
        &w->constants, scales, w->obstacles, near, p, [] { return (pbf_real)0; },
        [&](const pbf_load_plane &plane, const load_share &part) {
          recent.add(plane, p.x, part, &last);
        });
  }

  void add(const near_surfaces &near, uint32_t i) {
    load_particle p = load_momentum_at(w, scales, near, i);
    p.has_grid = false;
    for (int k = 0; k < PBF_DIM; ++k)
      pbf_wide_add(&change[k], pbf_wide_of(scales->velocity * (double)p.change.c[k]));
    if (near.any || is_pushed(w, i)) share(near, p);
  }

  /* Particles that are awake. */
  void add_in_lanes(const near_surfaces &near, range r) {
    uint32_t left =
        w->s->kernels->loads(&pass, near.any ? near.of : NULL, near.count, r.first, r.last, change);
    for (uint32_t i = r.first; left; ++i, left >>= 1)
      if (left & 1) {
        load_particle p = load_momentum_at(w, scales, near, i);
        p.has_grid = false;
        share(near, p);
      }
  }

  void end() {
    recent.end();
    add_change(w->s, change);
  }
};

}  // namespace

static bool is_in_lanes(const worker *w, range r) {
  return w->s->kernels->loads && sleeping_particles(w, r.first, r.last).first == r.last;
}

static void loads_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  const pbf_load_scales scales = pbf_load_scales_of(&w->constants, &w->forces, &w->s->params);
  task_loads loads(w, &scales);
  each_near_surfaces(w, scales.reach, task_sorted(w, task),
                     [&](const near_surfaces &near, range some) {
                       if (is_in_lanes(w, some)) {
                         loads.add_in_lanes(near, some);
                         return;
                       }
                       for (uint32_t i = some.first; i < some.last; ++i) loads.add(near, i);
                     });
  loads.end();
}

/* The largest depth of each solid over all ranks, which the first of them then has alone. */
static void find_largest_depths(solver *s, pbf_load_sums *sums, int solids) {
  uint64_t mine[DEPTHS_AT_ONCE] = {}, *all = static_cast<uint64_t *>(s->ranks.gathered);
  for (int some; solids > 0; solids -= some, sums += some) {
    some = solids < DEPTHS_AT_ONCE ? solids : (int)DEPTHS_AT_ONCE;
    for (int k = 0; k < some; ++k) mine[k] = sums[k].depth;
    if (!gather_on_ranks(s, mine, all, some * sizeof *mine)) return;
    for (int k = 0; k < some; ++k) {
      for (uint32_t r = 0; r < s->ranks.count; ++r)
        mine[k] = mine[k] > all[r * some + k] ? mine[k] : all[r * some + k];
      sums[k].depth = s->ranks.rank ? 0 : mine[k];
    }
  }
}

/* On ranks each has noted what its own particles get, in integers: all get the sums of these. */
static void add_up_loads(solver *s, int solids) {
  pbf_load_tally *t = s->load_tally;
  uint32_t *words = s->ranks.histogram; /* of the sort, which is done */
  const uint64_t each = sizeof *t->sums / sizeof(int64_t), changes = sizeof t->change;
  static_assert(sizeof *t->sums % sizeof(int64_t) == 0, "all are of 64 bits");
  find_largest_depths(s, t->sums, solids);
  sum_numbers_on_ranks(s, &t->change[0].high, changes / sizeof(int64_t), words, RANK_BINS);
  sum_numbers_on_ranks(s, &t->sums[0].of[0].high, solids * each, words, RANK_BINS);
}

static void end_loads_of_step(void *context) {
  const worker *w = static_cast<const worker *>(context);
  const pbf_load_scales scales = pbf_load_scales_of(&w->constants, &w->forces, &w->s->params);
  if (has_ranks(w->s)) add_up_loads(w->s, PBF_WALLS + pbf_surface_count(w->obstacles));
  end_loads(w->s->load_tally, w->obstacles, &scales);
}

#endif
