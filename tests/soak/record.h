/* What a round tells the process that watches it, in memory that both have, so that it is there
 * after a crash, too. */
#ifndef PBF_TESTS_SOAK_RECORD_H
#define PBF_TESTS_SOAK_RECORD_H

#include <stdatomic.h>
#include <stdint.h>

enum {
  MOST_ACTORS = 4,
  MOST_CALLS = 160,
  MOST_FUNCTIONS = 128,
  FINDING_SIZE = 2000,
  WORDS_SIZE = 1200
};

typedef enum fault {
  FAULT_MEMORY,      /* an allocation that fails */
  FAULT_CALLBACK,    /* a callback that is left by a longjmp */
  FAULT_FORK,        /* a child that uses or abandons the solvers */
  FAULT_KILL,        /* a child that is killed while it steps */
  FAULT_EXIT,        /* a process that exits with solvers alive */
  FAULT_ADDRESSES,   /* RLIMIT_AS lowered */
  FAULT_THREADS,     /* RLIMIT_NPROC lowered */
  FAULT_LOAD,        /* a busy thread beside it */
  FAULT_SIGNAL,      /* a handler that calls in */
  FAULT_ENVIRONMENT, /* another floating-point environment */
  FAULT_CANCEL,      /* pbf_cancel from another thread */
  FAULT_INTRUDER,    /* calls of another thread into the same solver */
  FAULT_TASKS,       /* runs on a caller's task system */
  FAULT_READER,      /* snapshots held by another thread */
  FAULT_DAMAGE,      /* a damaged saved state */
  FAULT_ARGUMENT,    /* a wrong argument */
  FAULT_BEGUN,       /* calls between pbf_begin_step and pbf_end_step */
  FAULT_COUNT
} fault;

extern const char *const fault_names[FAULT_COUNT];

/* The calls of one thread, as far as it has come. */
typedef struct trace {
  atomic_uint_least32_t come;      /* calls begun */
  unsigned char entry[MOST_CALLS]; /* of the table, plus 1; 0: left out */
} trace;

typedef struct record {
  /* Of all rounds. */
  atomic_uint_least64_t calls[MOST_FUNCTIONS], failed[MOST_FUNCTIONS];
  atomic_uint_least64_t faults[FAULT_COUNT];
  atomic_uint_least64_t steps, particles;
  /* Of the present one. */
  trace traces[MOST_ACTORS];
  unsigned char left_out[MOST_ACTORS][MOST_CALLS]; /* 1: this call is not made */
  atomic_int found;
  uint32_t found_actor;
  char finding[WORDS_SIZE];
} record;

extern record *soak_record;

static inline void count_fault(fault kind) { atomic_fetch_add(&soak_record->faults[kind], 1); }

/* Keeps the first finding of the round, and ends the process. */
_Noreturn void found(uint32_t actor, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The exit status of a process that has called it. */
enum { FOUND_STATUS = 3 };

#endif
