/* What comes into a solver and goes out of it in each step. */
#ifndef PBF_LIB_EMISSION_EMISSION_H
#define PBF_LIB_EMISSION_EMISSION_H

#include <pbf/emit.h>

#include "solver/solver.h"

/* An emitter, and how far it is. */
typedef struct pbf_source {
  pbf_emitter emitter;
  double due;      /* of the next particle, the part that has left, 0 … 1 */
  uint64_t number; /* of the next particle */
} pbf_source;

/* Particles that came at once and go at once. */
typedef struct pbf_births {
  uint32_t first_id, count;
  double death; /* a time */
} pbf_births;

/* A particle that has just left its opening, and goes on by the stream's velocity, whatever it
 * meets, until it is h away: fluid that is in its way gives way, as before a piston. It goes
 * straight on where the opening is moved or turned meanwhile, at the speed that the stream has. */
typedef struct pbf_guided {
  uint32_t id, source;
  double ahead; /* how far from where it has left */
  double from[3], velocity[3];
} pbf_guided;

/* What has been done for which step: a step that has failed goes on from there. */
typedef struct pbf_emission_head {
  uint32_t source_count, drain_count, births_count;
  uint32_t stage;    /* of `step`: 0: nothing is done, 1: removals, 1 + i: and i emitters, then
                        reservoirs' particles, then what these push */
  uint64_t step;     /* pbf_info.step when it began */
  pbf_in_out in_out; /* counts alone */
  uint32_t guided_count;
  uint32_t reservoir_count;
} pbf_emission_head;

/* Their part in a step, and in positions that are set. */
typedef struct pbf_emission_work {
  /* What comes and goes before the next step, or the next part of one that is made part by part:
   * each but the first begins by itself, and then they end. */
  pbf_status (*prepare)(pbf_solver *solver);
  void (*end_parts)(pbf_solver *solver);

  double (*speed)(const pbf_solver *solver); /* the fastest stream's */

  /* entering.h */
  int (*find_entering)(const pbf_solver *solver, pbf_entering *entering);
  pbf_status (*tell_entering)(pbf_solver *solver, const pbf_entering *entering);

  /* guided.h */
  pbf_status (*keep)(pbf_solver *solver, uint32_t first, uint32_t count);
  void (*move)(pbf_solver *solver, uint32_t first, uint32_t count, const void *positions);
} pbf_emission_work;

extern const pbf_emission_work pbf_emission_in_steps;

/* Null in a solver that never had any. */
typedef struct pbf_emission {
  const pbf_emission_work *work; /* so that programs that link libpbf and have none leave it out */
  pbf_emission_head head;
  pbf_source sources[PBF_MAX_EMITTERS];
  pbf_volume drains[PBF_MAX_DRAINS];
  pbf_reservoir reservoirs[PBF_MAX_RESERVOIRS];
  pbf_births *births; /* ascending by id */
  uint32_t births_capacity;
  pbf_guided *guided;
  uint32_t guided_capacity;
  uint32_t is_advanced; /* 1: they are where they are to be after the last step */
  void *particles;      /* positions, and then velocities, of those that come next */
  uint64_t particles_bytes;
} pbf_emission;

static inline int pbf_emission_is_active(const pbf_solver *solver) {
  const pbf_emission *e = solver->emission;
  return e && e->head.source_count + e->head.drain_count + e->head.births_count +
                      e->head.guided_count + e->head.reservoir_count >
                  0;
}

static inline void pbf_emission_begin_part(pbf_solver *solver) {
  if (solver->emission) solver->emission->head.stage = solver->emission->is_advanced = 0;
}

/* After the last stage, and so not beyond it where there have become fewer of them. */
static inline void pbf_emission_bound_stage(pbf_emission *e) {
  const uint32_t end = e->head.source_count + 2 * e->head.reservoir_count + 1;
  if (e->head.stage > end) e->head.stage = end;
}

/* The solver's, made where there is none. */
pbf_status pbf_emission_need(pbf_solver *solver, pbf_emission **emission);
void pbf_emission_free(pbf_solver *solver, pbf_emission *emission);

#endif
