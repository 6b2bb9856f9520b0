/* A thread that makes calls on solvers of its own, and what it knows about them. */
#ifndef PBF_TESTS_SOAK_ACTOR_H
#define PBF_TESTS_SOAK_ACTOR_H

#include <signal.h>
#include <string.h>

#include <pbf/pbf.h>

#include "dice.h"
#include "heap.h"
#include "record.h"

enum { TWINS = 2, SUBJECTS = 2, MOST_PARTICLES = 400, MOST_FIELDS = 6, STATE_BYTES = 1 << 17 };

struct DLManagedTensor;

/* What the calls so far make of the particles. */
typedef struct model {
  uint32_t count;
  uint64_t next_id;
  uint32_t ids[MOST_PARTICLES];
} model;

/* Two solvers that get the same calls and have to end with the same bits: on the same backend, or
 * on two whose bits are promised to be the same. */
typedef struct subject {
  pbf_solver *twin[TWINS];
  const char *backend[TWINS];
  heap *heap[TWINS];
  uint32_t dimension, precision, capacity;
  model model;
  uint32_t mapped[MOST_FIELDS];
  struct DLManagedTensor *tensor[TWINS];
  int snapshots; /* 1: they make some */
  int wild;      /* 1: parameters or colliders have been anything */
  int begun[TWINS];
  model saved_model; /* of `saved` */
  uint64_t saved_size, saved_hash;
  uint32_t saved_dimension, saved_precision;
  _Alignas(8) unsigned char saved[STATE_BYTES];
} subject;

/* What a round has beside the actors. */
typedef struct settings {
  uint32_t actors, calls;
  int instrumented; /* by a sanitizer: what it can't stand is left out */
  int forks, cancels, intruders, signals, readers, tasks, environments, memory, leaving;
  uint32_t busy_threads;
  int limit_addresses, limit_threads, exits;
  const char *const *backends; /* of the build that serve here */
  uint32_t backend_count;
} settings;

typedef struct actor {
  uint32_t number;
  const settings *with;
  uint64_t seed;
  uint32_t call; /* its number */
  dice dice;     /* of the present call */
  subject subjects[SUBJECTS];
  subject *subject; /* of the present call */
  const char *function;
  char sentence[TWINS][1024];
  int injected[TWINS]; /* a fault explains that the last call failed */
  pthread_t thread;
  volatile sig_atomic_t signals;                                        /* handled so far */
  struct actor *others;                                                 /* all of the round */
  _Alignas(8) unsigned char numbers[TWINS][MOST_PARTICLES * 3 * 8 * 4]; /* for what calls give */
} actor;

/* The actor that runs in this thread, or null. */
extern _Thread_local actor *this_actor;

/* All heaps of the round, which outlive their solvers. */
heap *heap_for(actor *a);
void check_heaps(void);

static inline const char *file_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

#define insist(a, condition)                                                             \
  ((condition) ? (void)0                                                                 \
               : found((a)->number, "%s: not so: %s (%s:%d)", (a)->function, #condition, \
                       file_name(__FILE__), __LINE__))

/* Numbers of an array in a subject's element type. */
static inline double value_at(const subject *s, const void *numbers, uint32_t index) {
  return s->precision == PBF_FLOAT64 ? ((const double *)numbers)[index]
                                     : (double)((const float *)numbers)[index];
}

static inline void put_value(const subject *s, void *numbers, uint32_t index, double value) {
  if (s->precision == PBF_FLOAT64)
    ((double *)numbers)[index] = value;
  else
    ((float *)numbers)[index] = (float)value;
}

/* ---- Subjects ---- */

/* Makes solvers as the dice fall; 0 where no kind of them can be made just now. */
int subject_make(actor *a, subject *s);
void subject_drop(actor *a, subject *s);

/* Whether a status is one of base.h and has a sentence; else a finding. */
void check_status(actor *a, pbf_status status, const char *sentence);

/* ---- A call on both twins ---- */

typedef pbf_status (*action)(pbf_solver *solver, int twin, void *context);

/* How a call may end. */
enum {
  CALL_READS = 1, /* it changes nothing, also where it succeeds */
  CALL_LOOSE = 2, /* other threads decide about its status, too */
  CALL_WRONG = 4, /* its arguments are: it has to fail */
  CALL_PLAIN = 8  /* no fault is injected */
};

/* Makes the call on both, with faults, and again where these have made it fail; checks that a
 * failure changes nothing and that both have the same end. */
pbf_status call_both(actor *a, action act, void *context, int how);

/* The same on one of them. */
pbf_status call_one(actor *a, int twin, action act, void *context, int how);

/* Whether both have the same bits, and what the model says. */
void check_subject(actor *a);

uint64_t step_of(actor *a, int twin);
void count_steps(const actor *a, uint64_t steps);

/* Runs a twin until its step is `end`, through cancellations; returns what ends it before. */
pbf_status advance(actor *a, int twin, uint64_t end);

/* Runs both from one step to another, and compares how that ends. */
void advance_both(actor *a, uint64_t begin, uint64_t end);

/* Particles finite, and inside the domain. */
void check_places(actor *a, int twin);

/* Both from the same saved state: where a step that failed has left its first parts done. */
void even_out(actor *a);

#endif
