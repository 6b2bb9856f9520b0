/* The colliders of a solver: the block that they lie in, and how they are set. */
#ifndef PBF_LIB_SOLVER_COLLIDERS_H
#define PBF_LIB_SOLVER_COLLIDERS_H

#include "collider_set.h"
#include "solver.h"

/* A solver's colliders lie in one block: as they were set, in 2D once more as backends get them,
 * and behind them sets of those that are not among the first 64, and numbers for each. */
enum pbf_collider_mark {
  PBF_COLLIDERS_PLACED,  /* in fluid, since the last step: overlap.h */
  PBF_COLLIDERS_SHIFTED, /* all farther by the same, since then: prestabilize.h */
  PBF_COLLIDERS_JUMP_IN, /* those that these two get when the block takes its place */
  PBF_COLLIDERS_JUMP_ALIKE,
  PBF_COLLIDER_MARKS
};

/* While they take the place of others: which of those each was, or `none` of them; and, once others
 * take theirs, two for collider_places.h. */
enum pbf_collider_numbers { PBF_COLLIDERS_BEFORE, PBF_COLLIDERS_PLACES, PBF_COLLIDER_NUMBERS = 3 };

static inline uint32_t pbf_collider_words(uint32_t count) {
  return count > 64 ? (count - 1) / 64 : 0;
}

static inline uint64_t pbf_collider_copies(const pbf_solver *solver, uint32_t count) {
  return (uint64_t)count * (solver->kind.dimension == 2 ? 2 : 1);
}

static inline uint64_t pbf_colliders_before_numbers(const pbf_solver *solver, uint32_t count) {
  return pbf_collider_copies(solver, count) * sizeof(pbf_collider) +
         PBF_COLLIDER_MARKS * (uint64_t)pbf_collider_words(count) * sizeof(uint64_t);
}

static inline uint64_t pbf_colliders_bytes(const pbf_solver *solver, uint32_t count) {
  return pbf_colliders_before_numbers(solver, count) +
         PBF_COLLIDER_NUMBERS * (uint64_t)count * sizeof(uint32_t);
}

static inline uint32_t *pbf_colliders_numbers(const pbf_solver *solver, uint32_t count,
                                              pbf_collider *colliders,
                                              enum pbf_collider_numbers which) {
  return (uint32_t *)(void *)((char *)colliders + pbf_colliders_before_numbers(solver, count)) +
         (uint64_t)which * count;
}

/* The words of a set in a block; null: there are none. */
static inline uint64_t *pbf_colliders_marked(const pbf_solver *solver, uint32_t count,
                                             pbf_collider *colliders, enum pbf_collider_mark mark) {
  const uint32_t words = pbf_collider_words(count);
  if (words == 0) return NULL;
  return (uint64_t *)(void *)(colliders + pbf_collider_copies(solver, count)) +
         (uint64_t)mark * words;
}

/* One of the solver's sets, of which the first word is given. */
static inline pbf_collider_set pbf_colliders_set(const pbf_solver *solver, uint64_t first,
                                                 enum pbf_collider_mark mark) {
  const pbf_collider_set set = {
      first, pbf_collider_words(solver->collider_count),
      pbf_colliders_marked(solver, solver->collider_count, solver->colliders, mark)};
  return set;
}

/* Fails for more than the backend takes. */
pbf_status pbf_colliders_check_count(const pbf_solver *solver, uint32_t count);

/* A reference to the geometry of an array's collider, where it has one. Fails for what is none. */
pbf_status pbf_collider_hold(const pbf_collider *collider, const char *name, uint32_t index);

/* Notes that so many have references which the running call gives back or hands on: where it is
 * left by a callback, pbf_destroy does. */
static inline void pbf_colliders_bring(pbf_solver *solver, uint32_t count,
                                       const pbf_collider *colliders) {
  solver->brought_count = 0;
  atomic_signal_fence(memory_order_release); /* never a count of others: a fork may part these */
  solver->brought = colliders;
  atomic_signal_fence(memory_order_release);
  solver->brought_count = count;
}

/* Gives the references of so many colliders back. */
void pbf_colliders_let_go(uint32_t count, const pbf_collider *colliders);

/* Hands checked colliders, with poses that hold at `time`, to the backend. */
pbf_status pbf_colliders_to_backend(pbf_solver *solver, uint32_t count, pbf_collider *colliders,
                                    double time);

/* The solver owns `colliders`, and their references, from now on and frees what it had. */
void pbf_colliders_replace(pbf_solver *solver, uint32_t count, pbf_collider *colliders,
                           double time);

#endif
