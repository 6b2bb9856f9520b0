/* Loads: the impulse that the fluid gives to each solid in a step, and where.
 *
 * Two things are measured. Of each particle, its push: the velocity that it has got where walls and
 * colliders act on it by itself, by collisions, by the density that they contribute and by ghosts.
 * And of all particles together, what their velocities have changed by beside forces. Pairs
 * conserve momentum, so the latter is the solids' in all: with what no particle tells, the pressure
 * of a pressure grid first of all.
 *
 * A push is shared out among the solids near its particle. Each gets what the step's lambda makes
 * of the density that it contributes, which is its pressure: so a layer between two plates presses
 * on both. What is left goes to each along its normal, as far as normals span it; colliders also
 * take the rest. But what walls do along themselves stands in for fluid that they cut off
 * (pbf_boundary_correction), the weight of which is on the walls across: they share it, where there
 * are any that the fluid is at. What is then left of the whole is that of a pressure grid, the
 * pressure of which ends some tenths of a spacing above or below where the fluid does. It goes to
 * all as one pressure at all depths would, along normals: to a floor by its area, to a body that
 * floats by the area that it cuts out of the surface, upwards, and to one that is pressed from all
 * sides not at all. What does not fit one pressure goes in proportion to what each has got along
 * the axis in all. So the sum over all solids is the momentum that the fluid has lost, whatever
 * errors the parts have.
 *
 * load_sums.h has the sums of solids, load_shares.h what each takes of a particle's push,
 * load_parts.h how that is added to its sums; here is what becomes of sums at the end of a step. */
#ifndef PBF_PHYSICS_LOADS_H
#define PBF_PHYSICS_LOADS_H

#include "physics/load_parts.h"

namespace {

/* What is left of the whole along an axis, in units, and by which of their sums solids share it:
 * what they have got, or how much of them is wet where none has got anything, in proportion to its
 * size. */
typedef struct load_rest {
  double change, sum;
  int by;
} load_rest;

template <class Tally>
PBF_FN double load_sum_over(const Tally *t, int solids, int which) {
  double sum = 0;
  for (int solid = 0; solid < solids; ++solid) sum += pbf_wide_value(t->sums[solid].of[which]);
  return sum;
}

/* Of their sizes. */
template <class Tally>
PBF_FN double load_size_over(const Tally *t, int solids, int which) {
  double sum = 0;
  for (int solid = 0; solid < solids; ++solid)
    sum += fabs(pbf_wide_value(t->sums[solid].of[which]));
  return sum;
}

/* How the first `solids` of all share a change. */
template <class Tally>
PBF_FN load_rest load_rest_of(const Tally *t, int solids, int axis, double change) {
  load_rest rest = {change, load_size_over(t, solids, PBF_LOAD_CHANGE + axis),
                    PBF_LOAD_CHANGE + axis};
  if (rest.sum > 0) return rest;
  rest.by = PBF_LOAD_WET;
  rest.sum = load_size_over(t, solids, PBF_LOAD_WET);
  return rest;
}

/* What walls share, and then what is left for all, of which one pressure would do `open` in all and
 * `open_size` in sizes. */
struct load_rests {
  load_rest walls[3], all[3];
  double open[3], open_size[3];
};

/* Along axis k. */
template <class Tally>
PBF_FN void find_load_rests(const Tally *t, int k, load_rests *rests) {
  const int solids = pbf_tally_solids(t);
  const double along = load_sum_over(t, PBF_WALLS, PBF_LOAD_ALONG + k);
  const double known = load_sum_over(t, solids, PBF_LOAD_CHANGE + k) + along;
  const bool are_walls_across = load_size_over(t, PBF_WALLS, PBF_LOAD_CHANGE + k) > 0;
  double rest = pbf_wide_value(t->change[k]) - known;
  if (!are_walls_across) rest += along;
  rests->walls[k] = load_rest_of(t, PBF_WALLS, k, are_walls_across ? along : 0);
  rests->all[k] = load_rest_of(t, solids, k, rest);
  rests->open[k] = load_sum_over(t, solids, PBF_LOAD_OPEN + k);
  rests->open_size[k] = load_size_over(t, solids, PBF_LOAD_OPEN + k);
}

/* The pressure at all depths that what is left tells, by the axes along which it presses on one
 * side more than on the other: wholly where fluid has a surface that it is known to be 0 at, and
 * not at all where it is closed in. One for all axes, so that what is left along one of them
 * presses on solids along their normals. */
PBF_FN double open_pressure_left(const load_rests &rests) {
  double told = 0, open2 = 0;
  for (int k = 0; k < 3; ++k) {
    const double net2 = rests.open[k] * rests.open[k];
    const double all2 = net2 + 0.01 * rests.open_size[k] * rests.open_size[k];
    if (all2 > 0) told += net2 / all2 * rests.all[k].change * rests.open[k];
    open2 += net2;
  }
  return open2 > 0 ? told / open2 : 0;
}

template <class Tally>
PBF_FN load_rests load_rests_of(const Tally *t) {
  load_rests rests;
  for (int k = 0; k < 3; ++k) find_load_rests(t, k, &rests);
  return rests;
}

/* Of a change that solids share. */
PBF_FN double load_share_of(const load_rest &rest, double change, const pbf_load_sums *sums) {
  return rest.sum > 0 ? change * (fabs(pbf_wide_value(sums->of[rest.by])) / rest.sum) : 0;
}

/* A solid's load from its sums. */
PBF_FN void find_load(const pbf_load_sums *sums, const load_rests &rests, bool is_wall,
                      const pbf_load_scales *s, double lever, pbf_collider_load *load) {
  double number[PBF_LOAD_SUMS], units[PBF_LOAD_SUMS], rest[3], place[3];
  pbf_load_units(s->velocity, lever, units);
  for (int k = 0; k < PBF_LOAD_SUMS; ++k) number[k] = pbf_wide_value(sums->of[k]) / units[k];
  const double pressure = open_pressure_left(rests);
  for (int k = 0; k < 3; ++k) {
    const double left = rests.all[k].change - pressure * rests.open[k];
    rest[k] = pressure * pbf_wide_value(sums->of[PBF_LOAD_OPEN + k]);
    rest[k] += load_share_of(rests.all[k], left, sums);
    if (is_wall) rest[k] += load_share_of(rests.walls[k], rests.walls[k].change, sums);
    rest[k] /= s->velocity;
    place[k] = number[PBF_LOAD_WET] > 0 ? number[PBF_LOAD_PLACE + k] / number[PBF_LOAD_WET] : 0;
  }
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    const double turn = number[PBF_LOAD_TURN + k] + place[l] * rest[m] - place[m] * rest[l];
    load->impulse[k] = -s->mass * (number[PBF_LOAD_CHANGE + k] + rest[k]);
    load->angular_impulse[k] = PBF_DIM == 3 || k == 2 ? -s->mass * turn : 0;
  }
  load->contacts = (uint32_t)sums->contacts;
  load->wetted_area = s->mass / s->spacing * number[PBF_LOAD_WET];
  memcpy(&load->penetration, &sums->depth, sizeof load->penetration);
}

/* Adds a step's load so many times to the sums since they were read. */
PBF_FN void add_load(pbf_collider_load *load, double steps, double time_step) {
  for (int k = 0; k < 3; ++k) {
    load->impulse_sum[k] += steps * load->impulse[k];
    load->angular_impulse_sum[k] += steps * load->angular_impulse[k];
  }
  load->time_sum += steps * time_step;
}

PBF_FN bool is_solid_there(int solid, int colliders) {
  return solid < PBF_WALLS ? solid < 2 * PBF_DIM : solid < PBF_WALLS + colliders;
}

/* Once all particles have added theirs: of one solid, from what is left of the whole. */
template <class Tally, class Obstacles>
PBF_FN void end_load(Tally *t, const Obstacles &o, const load_rests &rests,
                     const pbf_load_scales *s, int solid) {
  if (!is_solid_there(solid, pbf_surface_count(o))) return;
  find_load(&t->sums[solid], rests, solid < PBF_WALLS, s, pbf_lever(o, s->periods, solid),
            &t->loads[solid]);
  add_load(&t->loads[solid], 1, s->time_step);
}

template <class Tally, class Obstacles>
PBF_FN void end_loads(Tally *t, const Obstacles &o, const pbf_load_scales *s) {
  const load_rests rests = load_rests_of(t);
  const int solids = PBF_WALLS + pbf_surface_count(o);
  for (int solid = 0; solid < solids; ++solid) end_load(t, o, rests, s, solid);
}

}  // namespace

/* ---- Between steps -------------------------------------------------------------------------- */

/* At the start of a step. */
static inline void pbf_clear_load_sums(pbf_load_tally *t) {
  memset(t->change, 0, sizeof t->change);
  memset(t->sums, 0, (size_t)t->solids * sizeof *t->sums);
}

/* Steps in which all sleep, and which are not made. */
static inline void pbf_repeat_loads(pbf_load_tally *t, uint32_t steps, double time_step) {
  for (int solid = 0; solid < t->solids; ++solid) add_load(&t->loads[solid], steps, time_step);
}

/* Colliders from this number on are other ones. */
static inline void pbf_forget_loads(pbf_load_tally *t, uint32_t collider) {
  for (uint32_t solid = PBF_WALLS + collider; solid < (uint32_t)t->solids; ++solid)
    memset(&t->loads[solid], 0, sizeof t->loads[solid]);
}

/* Once they have been read. */
PBF_FN void pbf_begin_load_sums(pbf_collider_load *load) {
  for (int k = 0; k < 3; ++k) load->impulse_sum[k] = load->angular_impulse_sum[k] = 0;
  load->time_sum = 0;
}

/* Gives loads of solids, and begins their sums anew. */
static inline void pbf_read_loads(pbf_load_tally *t, uint32_t first, uint32_t count,
                                  pbf_collider_load *out) {
  memcpy(out, t->loads + first, count * sizeof *out);
  for (uint32_t k = first; k < first + count; ++k) pbf_begin_load_sums(&t->loads[k]);
}

#endif
