/* Part of backend.cu: steps that a world of a batch puts off until those of all are known: noted,
 * run together, or alone before anything else is asked of the world. */
#ifndef PBF_CUDA_SMALL_DEFERRED_STEPS_H
#define PBF_CUDA_SMALL_DEFERRED_STEPS_H

#include "cuda/device_rows.h"
#include "cuda/small/worlds.h"

/* The solver's own way to do them: backend.cu. */
static pbf_status run_steps(solver *s, const pbf_step_times &times, uint32_t steps, uint32_t *done);

static solver *entered(pbf_backend_solver *handle) {
  solver *s = reinterpret_cast<solver *>(handle);
  pbf_cuda_host = s->host;
  return s;
}

/* Notes the steps, for them to run together with those of other worlds. */
static bool put_off(solver *s, const pbf_step_times &times, uint32_t steps) {
  const pbf_step_times &first = s->put_off.times;
  if (!s->puts_off || !steps || s->late_failure || !world_serves(s)) return false;
  if (s->put_off.steps &&
      (first.time != times.time || first.before + s->put_off.steps != times.before))
    return false;
  if (!s->put_off.steps) s->put_off.times = times;
  s->put_off.steps += steps;
  s->time = pbf_time_after(&times, steps);
  s->pressure_scale = s->constants.pressure;
  s->found.struct_size = 0;
  return true;
}

/* All that the world has put off, alone. */
static pbf_status run_put_off(solver *s) {
  const steps_put_off noted = s->put_off;
  uint32_t done = 0;
  s->put_off.steps = 0;
  if (s->works_together)
    if (pbf_status status =
            pbf_cuda_check(cudaStreamWaitEvent(s->stream, s->team->done, 0), "cudaStreamWaitEvent"))
      return status;
  s->works_together = false;
  s->works_alone = true;
  return noted.steps ? run_steps(s, noted.times, noted.steps, &done) : PBF_OK;
}

static pbf_status tell_late_failure(solver *s) {
  const pbf_status status = s->late_failure;
  s->late_failure = PBF_OK;
  if (status) pbf_cuda_host->set_error("steps that had been put off failed on the device");
  return status ? status : tell_refusal(s);
}

/* Before anything else happens in the world's own stream. */
static void settle(solver *s) {
  if (s->put_off.steps || s->works_together) {
    pbf_cuda_scope scope(s->context);
    const pbf_status status = run_put_off(s);
    if (!s->late_failure) s->late_failure = status;
  }
  s->works_alone = true;
}

/* Every call begins with it. */
static solver *of(pbf_backend_solver *handle) {
  solver *s = entered(handle);
  settle(s);
  return s;
}

/* ---- All together --------------------------------------------------------------------------- */

static void let_put_off(pbf_backend_solver *handle, uint32_t on) {
  entered(handle)->puts_off = on != 0;
}

static pbf_status run_one_by_one(solver *const *worlds, uint32_t count) {
  for (uint32_t k = 0; k < count; ++k)
    if (pbf_status status = run_put_off(worlds[k])) return status;
  return PBF_OK;
}

/* Solvers are those that have something to do; there is room for as many numbers of steps. */
static pbf_status run_worlds_of(solver *leader, solver **worlds, uint32_t *steps, uint32_t count) {
  pbf_cuda_scope scope(leader->context);
  if (!worlds_fill(leader, count) || !team_of(leader)) return run_one_by_one(worlds, count);
  const pbf_status status = run_together(leader, worlds, steps, count);
  return status == PBF_ERROR_OUT_OF_MEMORY ? run_one_by_one(worlds, count) : status;
}

static pbf_status run_worlds(pbf_backend_solver *const *handles, uint32_t count) {
  if (count == 0) return PBF_OK;
  solver *leader = entered(handles[0]);
  const pbf_allocator &allocator = leader->allocator;
  const uint64_t bytes = count * (sizeof(solver *) + sizeof(uint32_t));
  solver **worlds =
      static_cast<solver **>(allocator.allocate(allocator.user, bytes, alignof(solver *)));
  uint32_t some = 0;
  pbf_status status = PBF_OK;
  for (uint32_t k = 0; k < count; ++k) {
    solver *s = reinterpret_cast<solver *>(handles[k]);
    if (!s->put_off.steps) continue;
    if (worlds)
      worlds[some++] = s;
    else
      settle(s);
  }
  if (some)
    status = run_worlds_of(leader, worlds, reinterpret_cast<uint32_t *>(worlds + count), some);
  if (worlds) allocator.release(allocator.user, worlds, bytes, alignof(solver *));
  return status;
}

#endif
