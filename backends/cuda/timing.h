/* Part of solver.h: times of stages, off at first. */
#ifndef PBF_CUDA_TIMING_H
#define PBF_CUDA_TIMING_H

#include <stdio.h>

#include "cuda/status.h"
#include "physics/schedule.h"

struct stage_clock {
  cudaEvent_t begin, end; /* null: off */
  double milliseconds[PBF_STAGE_COUNT];
  uint64_t runs[PBF_STAGE_COUNT];
};

static inline void clock_stop(stage_clock *clock) {
  if (clock->begin) cudaEventDestroy(clock->begin);
  if (clock->end) cudaEventDestroy(clock->end);
  clock->begin = clock->end = nullptr;
}

static inline pbf_status clock_start(stage_clock *clock) {
  *clock = stage_clock{};
  if (pbf_status status = pbf_cuda_check(cudaEventCreate(&clock->begin), "cudaEventCreate"))
    return status;
  pbf_status status = pbf_cuda_check(cudaEventCreate(&clock->end), "cudaEventCreate");
  if (status != PBF_OK) clock_stop(clock);
  return status;
}

/* Before a stage's launches, … */
static inline pbf_status clock_begin(stage_clock *clock, cudaStream_t stream) {
  if (!clock->begin) return PBF_OK;
  return pbf_cuda_check(cudaEventRecord(clock->begin, stream), "cudaEventRecord");
}

/* … and after them. */
static inline pbf_status clock_end(stage_clock *clock, cudaStream_t stream, pbf_stage stage) {
  if (!clock->begin) return PBF_OK;
  float milliseconds = 0;
  cudaEventRecord(clock->end, stream);
  if (pbf_status status = pbf_cuda_check(cudaEventSynchronize(clock->end), "cudaEventSynchronize"))
    return status;
  cudaEventElapsedTime(&milliseconds, clock->begin, clock->end);
  clock->milliseconds[stage] += milliseconds;
  ++clock->runs[stage];
  return PBF_OK;
}

#endif
