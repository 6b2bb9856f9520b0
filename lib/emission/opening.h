/* The columns in which particles leave an opening. */
#ifndef PBF_LIB_EMISSION_OPENING_H
#define PBF_LIB_EMISSION_OPENING_H

#include <pbf/emit.h>

#include "check.h"

typedef struct pbf_opening {
  const pbf_emitter *emitter;
  uint32_t dimension;
  uint64_t columns;
  uint64_t sides[2];             /* rectangle: columns along them */
  double spacing, speed, rate;   /* the rate with what 0 stands for */
  double along[3], across[2][3]; /* unit vectors: the stream's, and the opening's two */
} pbf_opening;

/* `emitter` stays where it is as long as the opening is used. */
pbf_opening pbf_opening_of(const pbf_emitter *emitter, uint32_t dimension, double spacing);

/* The gap before a wall across the stream through which what the opening carries leaves to all
 * sides at the stream's speed: its area over its rim. */
double pbf_opening_gap(const pbf_opening *opening);

/* Whether what has left there with that velocity is of one lattice with what leaves now: not where
 * the opening has been turned or moved since, or where it has a jitter. */
int pbf_opening_fits(const pbf_opening *opening, const double place[3], const double velocity[3]);

/* Where a particle of that number leaves, jitter included. */
void pbf_opening_place(const pbf_opening *opening, uint64_t number, double place[3]);

#endif
