/* The same calls on two backends, `reference` being the oracle of `serial`, or of `threads` on a
 * task system where the build has it, with either determinism: the same statuses and sentences, the
 * same books, and after each step positions within a stated distance. Bits of the two are never
 * compared. */
#ifndef PBF_TESTS_FUZZ_TWINS_H
#define PBF_TESTS_FUZZ_TWINS_H

#include "kind.h"

enum { TWIN_CAPACITY = 48, TWINS = 2 };

typedef struct twins {
  kind k;
  pbf_solver *solver[TWINS]; /* reference, and the other one */
  int wild;                  /* numbers have been let in that no distance can be stated for */
  int placed;                /* since the last step: what overlaps is looked for in the next */
  int overlapped;            /* in an earlier step: something may be left of that */
  int lost;                  /* and have led to what is no number: the two need not agree on more */
} twins;

twins twins_make(kind k, int tasked, uint32_t determinism);
void twins_destroy(twins *t);

/* A call of the API on one of them, with what it needs. */
typedef pbf_status (*twin_call)(pbf_solver *solver, void *context);

/* Makes the call on both, and insists that they agree, and that a call that fails changes nothing.
 */
pbf_status twins_call(twins *t, twin_call call, void *context);

/* The same where what particles there are depends on where they are: from one state. */
pbf_status twins_call_apart(twins *t, twin_call call, void *context);

/* Finds out whether all their numbers still are some, after a step. */
void twins_note_lost(twins *t);

/* A task system that runs each item before it returns, the last one first. */
void *twins_enqueue(void *user, pbf_task_fn run, void *task, uint32_t items, uint32_t min_range);

/* Steps both from the same state, one step, and holds their particles against each other. */
pbf_status twins_step(twins *t, int by_loading);

/* Densities and statistics of both, from the same state. */
void twins_compare_reports(twins *t);

uint32_t twins_count(const twins *t);

#endif
