/* The same calls on two backends, `reference` being the oracle of `serial`: the same statuses and
 * sentences, the same books, and after each step positions within a stated distance. */
#ifndef PBF_TESTS_FUZZ_TWINS_H
#define PBF_TESTS_FUZZ_TWINS_H

#include "kind.h"

enum { TWIN_CAPACITY = 48, TWINS = 2 };

typedef struct twins {
  kind k;
  pbf_solver *solver[TWINS]; /* reference, serial */
  int wild;                  /* numbers have been let in that no distance can be stated for */
  int placed;                /* since the last step: what overlaps is looked for in the next */
  int overlapped;            /* in an earlier step: something may be left of that */
  int lost;                  /* and have led to what is no number: the two need not agree on more */
} twins;

twins twins_make(kind k);
void twins_destroy(twins *t);

/* A call of the API on one of them, with what it needs. */
typedef pbf_status (*twin_call)(pbf_solver *solver, void *context);

/* Makes the call on both, and insists that they agree, and that a call that fails changes nothing.
 */
pbf_status twins_call(twins *t, twin_call call, void *context);

/* Steps both from the same state, one step, and holds their particles against each other. */
pbf_status twins_step(twins *t, int by_loading);

/* Densities and statistics of both, from the same state. */
void twins_compare_reports(twins *t);

uint32_t twins_count(const twins *t);

#endif
