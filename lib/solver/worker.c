#include "worker.h"

#include <stdio.h>
#include <string.h>

#include "error.h"
#include "memory.h"
#include "os.h"

typedef enum worker_state { IDLE, BEGUN, DONE, QUIT } worker_state;

typedef struct pbf_worker {
  pbf_mutex mutex;
  pbf_condition changed;
  pbf_thread thread;
  uint32_t process; /* that the thread runs in: a child of a fork has none; 0: none does */
  worker_state state;
  const pbf_worker_calls *calls;
  uint32_t steps;
  pbf_status status;
  char why[PBF_MESSAGE_SIZE]; /* of the status, if it is a failure */
} pbf_worker;

static void set_state(pbf_worker *worker, worker_state state) {
  pbf_mutex_lock(&worker->mutex);
  worker->state = state;
  pbf_condition_broadcast(&worker->changed);
  pbf_mutex_unlock(&worker->mutex);
}

/* Returns the state that it is in then. */
static worker_state wait_while(pbf_worker *worker, worker_state a, worker_state b) {
  pbf_mutex_lock(&worker->mutex);
  while (worker->state == a || worker->state == b)
    pbf_condition_wait(&worker->changed, &worker->mutex);
  const worker_state state = worker->state;
  pbf_mutex_unlock(&worker->mutex);
  return state;
}

static void run_steps(pbf_solver *solver) {
  pbf_worker *worker = solver->worker;
  solver->callers_fp = pbf_fp_begin();
  pbf_plugin_message_clear();
  worker->status = worker->calls->run(solver, worker->steps);
  if (worker->status != PBF_OK) memcpy(worker->why, pbf_last_error(), sizeof worker->why);
  pbf_fp_end(solver->callers_fp);
}

/* What is left of the solver goes with the thread, or with the last snapshot. */
static void end_alone(pbf_solver *solver) {
  pbf_worker *worker = solver->worker;
  worker->process = 0; /* so that none joins this thread */
  pbf_thread_detach(&worker->thread);
  pbf_condition_destroy(&worker->changed);
  pbf_mutex_destroy(&worker->mutex);
  worker->calls->leave(solver, PBF_OK);
}

static void *work(void *user) {
  pbf_solver *solver = user;
  while (wait_while(solver->worker, IDLE, DONE) == BEGUN) {
    run_steps(solver);
    if (solver->worker->calls->is_alone(solver)) return end_alone(solver), NULL;
    set_state(solver->worker, DONE);
  }
  return NULL;
}

/* ---- Its life -------------------------------------------------------------------------------- */

static pbf_status take_worker(pbf_solver *solver) {
  void *memory;
  if (solver->worker) return PBF_OK;
  pbf_status status = pbf_memory_allocate(&solver->allocator, sizeof(pbf_worker),
                                          "the thread of pbf_begin_step", &memory);
  if (status != PBF_OK) return status;
  memset(memory, 0, sizeof(pbf_worker));
  solver->worker = memory;
  return PBF_OK;
}

pbf_status pbf_worker_start(pbf_solver *solver) {
  pbf_status status = take_worker(solver);
  if (status != PBF_OK) return status;
  if (solver->worker->process == pbf_process()) {
    if (pbf_can_wait()) return PBF_OK;
    return pbf_fail(PBF_ERROR_OUT_OF_MEMORY,
                    "the thread of pbf_begin_step can't be woken: this process may no longer call "
                    "futex; pbf_step would do");
  }
  solver->worker->state = IDLE;
  solver->worker->process = 0;
  pbf_mutex_init(&solver->worker->mutex);
  pbf_condition_init(&solver->worker->changed);
  if (!pbf_thread_start(&solver->worker->thread, PBF_THREAD_OF_CALLBACKS, 0, work, solver))
    return pbf_fail(PBF_ERROR_OUT_OF_MEMORY, "no thread for pbf_begin_step can be started");
  solver->worker->process = pbf_process();
  return PBF_OK;
}

uint64_t pbf_worker_bytes(const pbf_solver *solver) {
  return solver->worker ? sizeof(pbf_worker) : 0;
}

void pbf_worker_free(pbf_solver *solver) {
  pbf_worker *worker = solver->worker;
  if (!worker) return;
  if (worker->process == pbf_process()) {
    if (!pbf_can_wait()) return; /* it sleeps in this memory for good */
    set_state(worker, QUIT);
    pbf_thread_join(&worker->thread);
    pbf_condition_destroy(&worker->changed);
    pbf_mutex_destroy(&worker->mutex);
  }
  pbf_memory_free(&solver->allocator, worker, sizeof *worker);
}

/* ---- Its work ------------------------------------------------------------------------------- */

uintptr_t pbf_worker_thread(const pbf_solver *solver) {
  return pbf_thread_of(&solver->worker->thread);
}

void pbf_worker_run(pbf_solver *solver, const pbf_worker_calls *calls, uint32_t steps) {
  solver->worker->calls = calls;
  solver->worker->steps = steps;
  set_state(solver->worker, BEGUN);
}

void pbf_worker_wait(pbf_solver *solver) { wait_while(solver->worker, BEGUN, BEGUN); }

void pbf_worker_has_ended(pbf_solver *solver) {
  pbf_worker *worker = solver->worker;
  worker->status = PBF_ERROR_STATE;
  snprintf(worker->why, sizeof worker->why,
           "a callback has ended the thread of steps that have begun; this solver can only be "
           "destroyed");
  set_state(worker, DONE);
}

pbf_status pbf_worker_status(const pbf_solver *solver, char why[PBF_MESSAGE_SIZE]) {
  const pbf_worker *worker = solver->worker;
  if (worker->status != PBF_OK) memcpy(why, worker->why, sizeof worker->why);
  return worker->status;
}
