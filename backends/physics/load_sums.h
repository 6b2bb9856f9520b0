/* What is summed up of what the fluid does to each solid (loads.h).
 *
 * Sums are of integers: their order, and with it threads, changes no bit. */
#ifndef PBF_PHYSICS_LOAD_SUMS_H
#define PBF_PHYSICS_LOAD_SUMS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "physics/boundary.h"
#include "physics/periodic.h"

/* Solids by number: the walls, 2 * axis and + 1, and after six of these the colliders. */
enum { PBF_WALLS = 6, PBF_FEW_SOLIDS = PBF_WALLS + PBF_FEW_COLLIDERS };

/* high * 2^32 + low, of 2^31 numbers and more. */
typedef struct pbf_wide_sum {
  int64_t high, low;
} pbf_wide_sum;

/* Of a number in units: at most 2^62 of them, and what is no number counts as none. */
PBF_FN pbf_wide_sum pbf_wide_of(double units) {
  const double limit = 0x1p62;
  units = units > -limit ? units : -limit;
  units = units < limit ? units : limit;
  const int64_t whole = (int64_t)units, low = whole & 0xffffffff;
  pbf_wide_sum sum = {whole >> 32, low};
  return sum;
}

PBF_FN double pbf_wide_value(pbf_wide_sum sum) {
  return (double)sum.high * 0x1p32 + (double)sum.low;
}

/* What is summed up of a solid, as changes of particles' velocities: the fluid's, opposite to the
 * solid's. In 2D the third components, and of the turn the first two, stay 0. */
enum {
  PBF_LOAD_CHANGE = 0,
  PBF_LOAD_TURN = 3,   /* place before the solid's position x change */
  PBF_LOAD_WET = 6,    /* particles of a wet layer */
  PBF_LOAD_PLACE = 7,  /* their places before the solid's position */
  PBF_LOAD_ALONG = 10, /* what a wall changes along itself, which is not in its change */
  PBF_LOAD_OPEN = 13,  /* what a pressure of one at all depths would change */
  PBF_LOAD_SUMS = 16
};

typedef struct pbf_load_sums {
  pbf_wide_sum of[PBF_LOAD_SUMS];
  uint64_t contacts;
  uint64_t depth; /* the largest, as its bits, which are in order */
} pbf_load_sums;

/* Of a solver. `change` is of all velocities. Arrays are behind it. */
typedef struct pbf_load_tally {
  pbf_wide_sum change[3];
  int solids; /* that there is room for */
  pbf_load_sums *sums;
  pbf_collider_load *loads;
} pbf_load_tally;

/* The same of few colliders, in one piece. */
typedef struct pbf_few_load_tally {
  pbf_wide_sum change[3];
  pbf_load_sums sums[PBF_FEW_SOLIDS];
  pbf_collider_load loads[PBF_FEW_SOLIDS];
} pbf_few_load_tally;

PBF_FN int pbf_tally_solids(const pbf_load_tally *t) { return t->solids; }
PBF_FN int pbf_tally_solids(const pbf_few_load_tally *) { return PBF_FEW_SOLIDS; }

static inline uint64_t pbf_load_tally_bytes(uint64_t colliders) {
  return sizeof(pbf_load_tally) +
         (PBF_WALLS + colliders) * (sizeof(pbf_load_sums) + sizeof(pbf_collider_load));
}

/* In memory of that size, which is 0 but for what it has been before. */
static inline void pbf_place_load_tally(pbf_load_tally *t, uint64_t colliders) {
  t->solids = (int)(PBF_WALLS + colliders);
  t->sums = (pbf_load_sums *)(t + 1);
  t->loads = (pbf_collider_load *)(t->sums + t->solids);
}

PBF_FN void pbf_wide_add(pbf_wide_sum *to, pbf_wide_sum more) {
  to->high += more.high;
  to->low += more.low;
}

/* Units of one, of sums of velocities and of lengths by velocities or by nothing, `lever` being
 * above all of these. A number of the former is at most twice the largest speed that walls stop. */
PBF_FN double pbf_units_of_velocity(double max_speed) { return 0x1p60 / max_speed; }

/* No particle is farther from a solid's position. `periods`: of the axes without walls. */
template <class Obstacles>
PBF_FN double pbf_lever(const Obstacles &o, const pbf_periods &periods, int solid) {
  double lever = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const int periodic = periods.length.c[k] > 0;
    const double lower = (double)(periodic ? periods.lower : o.domain.lower).c[k];
    const double upper = (double)(periodic ? periods.upper : o.domain.upper).c[k];
    const double at = solid < PBF_WALLS ? 0 : (double)o.surfaces[solid - PBF_WALLS].center.c[k];
    lever += fabs(upper - lower) + fabs(at - lower);
  }
  return lever;
}

PBF_FN void pbf_load_units(double units_of_velocity, double lever, double units[PBF_LOAD_SUMS]) {
  for (int k = 0; k < 3; ++k) {
    units[PBF_LOAD_CHANGE + k] = units_of_velocity;
    units[PBF_LOAD_TURN + k] = units_of_velocity / lever;
    units[PBF_LOAD_PLACE + k] = 0x1p59 / lever;
    units[PBF_LOAD_ALONG + k] = units_of_velocity;
    units[PBF_LOAD_OPEN + k] = 0x1p54;
  }
  units[PBF_LOAD_WET] = 0x1p59;
}

#endif
