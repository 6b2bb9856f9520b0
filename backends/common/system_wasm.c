/* WebAssembly with threads. A thread is run by a worker that the host has made before and given to
 * this module, where it waits in shared memory: to start one, to wait for its end, and to start
 * another one in the same worker needs neither the host nor its event loop. */
#include "common/system.h"

#include <stdlib.h>

/* What the host has: seconds, by one clock in all workers. */
__attribute__((import_module("pbf"), import_name("seconds"))) double pbf_wasm_seconds(void);

/* ---- Waits ---------------------------------------------------------------------------------- */

/* A page's own thread may not, and looks again and again. */
static _Thread_local int may_wait;

void pbf_wasm_wait(uint32_t *word, uint32_t value) {
  if (may_wait) __builtin_wasm_memory_atomic_wait32((int *)word, (int)value, -1);
}

static void wake_all(uint32_t *word) { __builtin_wasm_memory_atomic_notify((int *)word, ~0u); }

/* There is no call that lets others run. The core is given away by a wait for a time, the shortest
 * that there is. */
void pbf_yield(void) {
  static uint32_t never;
  if (may_wait) __builtin_wasm_memory_atomic_wait32((int *)&never, 0, 1);
}

/* ---- What there is one of ------------------------------------------------------------------- */

const char *pbf_environment(const char *name) { return (void)name, NULL; }

double pbf_seconds(void) { return pbf_wasm_seconds(); }
double pbf_thread_seconds(void) { return pbf_wasm_seconds(); }

uint32_t pbf_process(void) { return 1; }
int pbf_process_is_told(void) { return 1; }

int pbf_at_fork(void (*before)(void), void (*in_parent)(void), void (*in_child)(void)) {
  return (void)before, (void)in_parent, (void)in_child, 1;
}

/* ---- Workers -------------------------------------------------------------------------------- */

enum { MAX_WORKERS = 63 };

/* ABSENT until the host has given it. A thread that takes it has it from TAKEN until it has joined
 * what RUNS in it, or left that to itself. */
enum { ABSENT, FREE, TAKEN, RUNS, DETACHED, ENDED };

typedef struct worker {
  uint32_t state;
  void *(*run)(void *);
  void *user;
  uintptr_t thread; /* what pbf_this_thread gives in it */
} worker;

static worker workers[MAX_WORKERS];
static uint32_t given;

static uint32_t state_of(const worker *w) { return __atomic_load_n(&w->state, __ATOMIC_ACQUIRE); }

static void become(worker *w, uint32_t state) {
  __atomic_store_n(&w->state, state, __ATOMIC_RELEASE);
  wake_all(&w->state);
}

/* 0: it was in another state than `before`. */
static int exchange(worker *w, uint32_t before, uint32_t after) {
  return __atomic_compare_exchange_n(&w->state, &before, after, 0, __ATOMIC_ACQ_REL,
                                     __ATOMIC_RELAXED);
}

static void wait_for(worker *w, uint32_t state) {
  for (uint32_t now; (now = state_of(w)) != state;) pbf_wasm_wait(&w->state, now);
}

uint32_t pbf_processors(void) {
  const uint32_t there = __atomic_load_n(&given, __ATOMIC_RELAXED);
  return 1 + (there < MAX_WORKERS ? there : MAX_WORKERS);
}

/* A worker has the stack that it came with, and there are no signals. */
int pbf_thread_start(pbf_thread *thread, pbf_thread_kind kind, size_t stack_bytes,
                     void *(*run)(void *), void *user) {
  (void)kind;
  (void)stack_bytes;
  for (uint32_t k = 0; k < MAX_WORKERS; ++k) {
    worker *w = &workers[k];
    if (!exchange(w, FREE, TAKEN)) continue;
    *thread = (pbf_thread){.worker = k};
    w->run = run;
    w->user = user;
    become(w, RUNS);
    return 1;
  }
  return 0;
}

void pbf_thread_join(pbf_thread *thread) {
  worker *w = &workers[thread->worker];
  wait_for(w, ENDED);
  become(w, FREE);
}

/* Also from itself: then its end makes the worker free. */
void pbf_thread_detach(pbf_thread *thread) {
  worker *w = &workers[thread->worker];
  if (!exchange(w, RUNS, DETACHED)) become(w, FREE);
}

uintptr_t pbf_thread_of(const pbf_thread *thread) { return workers[thread->worker].thread; }

/* ---- What the host calls -------------------------------------------------------------------- */

void __wasm_init_tls(void *memory);

void pbf_wasm_begin_thread(void *variables);
void pbf_wasm_let_wait(void);
uint32_t pbf_wasm_pages(void);
void *pbf_wasm_room(void);
uint32_t pbf_wasm_give(void);
void pbf_wasm_work(uint32_t number);

/* First in each thread. */
void pbf_wasm_begin_thread(void *variables) { __wasm_init_tls(variables); }

/* Where the calling thread may wait. */
void pbf_wasm_let_wait(void) { may_wait = 1; }

/* Of a thread: its own variables begin there, and its stack ends. Null: there is no memory. */
void *pbf_wasm_room(void) {
  enum { STACK_BYTES = 1 << 18, ALIGNMENT = 64 };
  const size_t own = (__builtin_wasm_tls_size() + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
  char *memory = aligned_alloc(ALIGNMENT, STACK_BYTES + own);
  return memory ? memory + STACK_BYTES : NULL;
}

/* Of memory, which may have grown in another thread. */
uint32_t pbf_wasm_pages(void) { return __builtin_wasm_memory_size(0); }

/* Gives the worker that calls it, which is then to work. Returns its number. */
uint32_t pbf_wasm_give(void) {
  const uint32_t k = __atomic_fetch_add(&given, 1, __ATOMIC_RELAXED);
  if (k >= MAX_WORKERS) return k;
  workers[k].thread = pbf_this_thread();
  become(&workers[k], FREE);
  return k;
}

/* Runs threads, one after another. Does not return. */
void pbf_wasm_work(uint32_t number) {
  if (number >= MAX_WORKERS) return;
  for (worker *w = &workers[number];;) {
    wait_for(w, RUNS);
    w->run(w->user);
    if (exchange(w, RUNS, ENDED))
      wake_all(&w->state);
    else
      become(w, FREE);
  }
}

/* ---- Threads -------------------------------------------------------------------------------- */

/* Of which there are few, for the life of their thread. */
enum { MAX_KINDS = 4 };
static uint32_t kinds;
static _Thread_local void *own[MAX_KINDS];

uintptr_t pbf_this_thread(void) { return (uintptr_t)&own; }

void pbf_per_thread_begin(pbf_per_thread *memory, size_t bytes) {
  *memory = (pbf_per_thread){.kind = kinds++, .bytes = bytes};
}

void pbf_per_thread_end(pbf_per_thread *memory) { (void)memory; }

void *pbf_per_thread_look(const pbf_per_thread *memory) {
  return memory->kind < MAX_KINDS ? own[memory->kind] : NULL;
}

void *pbf_per_thread_take(const pbf_per_thread *memory) {
  if (memory->kind < MAX_KINDS && !own[memory->kind]) own[memory->kind] = calloc(1, memory->bytes);
  return pbf_per_thread_look(memory);
}
