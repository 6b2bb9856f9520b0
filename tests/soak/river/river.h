/* A river that joins what the library has: a bed of heights, a mill wheel, crates that float, two
 * fluids, emitters, a kill plane and probes. */
#ifndef PBF_TESTS_RIVER_H
#define PBF_TESTS_RIVER_H

#include <pbf/emit.h>
#include <pbf/pbf.h>
#include <pbf/phases.h>
#include <pbf/query.h>
#include <pbf/shapes.h>

#include "../dice.h"

enum { RIVER_BED, RIVER_WHEEL, RIVER_CRATES, RIVER_COLLIDERS = RIVER_CRATES + 2 };
enum { RIVER_CAPACITY_2D = 250, RIVER_CAPACITY_3D = 1200 };

extern const double river_spacing;

typedef struct river {
  pbf_solver *solver;
  pbf_shape *bed, *wheel;
  uint32_t dimension, precision, capacity;
  int64_t bytes;         /* that the solver has of the allocator */
  uint64_t put, taken;   /* particles that calls have added and removed */
  uint64_t step, change; /* that have been made */
  uint64_t seed;
  double deepest;              /* a centre has been in a solid, in spacings */
  uint64_t squeezed, in_solid; /* particles that were so when they were looked at */
  double fastest;
  char fault[400]; /* empty: none so far */
} river;

/* Ends the process with the library's sentence where a call that can't fail does. */
void river_must(pbf_status status, const char *what);

void river_begin(river *r, const char *backend);
void river_end(river *r);

/* The colliders as they stand now; poses of those that move by `change`. */
void river_colliders(river *r, pbf_collider colliders[RIVER_COLLIDERS]);

/* Lets crates float for `steps` steps, by what the fluid does to them. */
void river_float(river *r, uint32_t steps);

/* One thing about it becomes another, drawn by the seed and the number of the change. */
void river_change(river *r);

/* Whether all is as it has to be: r->fault says what is not. */
int river_check(river *r);

#endif
