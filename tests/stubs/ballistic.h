/* What a test can ask of the stub: to lie, or to fail at a certain call. */
#ifndef PBF_TESTS_BALLISTIC_H
#define PBF_TESTS_BALLISTIC_H

#include <stdint.h>

typedef enum ballistic_lie {
  BALLISTIC_HONEST,
  BALLISTIC_NO_SOLVER,
  BALLISTIC_NO_TABLE,
  BALLISTIC_BAD_TABLE,
  BALLISTIC_TOO_MANY_STEPS,
  BALLISTIC_TOO_FEW_STEPS,
  BALLISTIC_VIEW_COUNT,
  BALLISTIC_VIEW_FIELD,
  BALLISTIC_VIEW_TYPE,
  BALLISTIC_VIEW_COMPONENTS,
  BALLISTIC_VIEW_DEVICE,
  BALLISTIC_VIEW_NO_DATA,
  BALLISTIC_VIEW_NO_IDS,
  BALLISTIC_VIEW_ODD_STRIDE,
  BALLISTIC_STATS_COUNT,
  BALLISTIC_STAGE_COUNT,
  BALLISTIC_ARRAY_COUNT,
  BALLISTIC_ENDLESS_TEXT,
  BALLISTIC_FOUND_COUNT,
} ballistic_lie;

typedef struct ballistic_control {
  ballistic_lie lie;
  int32_t calls_until_failure; /* counts down with each call; the one that finds 1 fails */
  int32_t failure_status;
  uint32_t failure_is_silent;      /* 1: it has no sentence, 2: one of half a character */
  void (*inside_step)(void *user); /* while a step runs; may be null */
  void *user;
  uint32_t worlds;         /* that the last solver was told of */
  uint32_t arrays;         /* taken, and not given back */
  uint32_t steps_together; /* 1: solvers created from now on have PBF_BACKEND_WORLDS, … */
  uint32_t runs;           /* … which has run so often, … */
  uint32_t run_worlds;     /* … the last time so many that had steps noted */
} ballistic_control;

#endif
