/* Part of solver.h: which particles fall asleep and which wake (physics/sleep.h). Nothing comes
 * back to the host, which only looks: when all sleep, the device says so in the host's memory, and
 * the steps that the host launches until it has seen that change nothing. */
#ifndef PBF_CUDA_SLEEP_H
#define PBF_CUDA_SLEEP_H

#include "cuda/kernels_viscosity.h"

/* What the blocks of a step tell each other. */
struct sleep_tally {
  uint32_t near_sleep_count; /* a particle sleeps or is still enough to */
  uint32_t sleepers;         /* counted in each step, */
  uint32_t blocks;           /* by so many blocks so far */
  uint32_t all;              /* 1: all particles sleep */
  uint32_t some;             /* a particle may sleep */
  uint32_t asked;            /* sleepers, for statistics */
  uint32_t woken;            /* 1: a particle slept near colliders that move or have moved */
};

/* Of particles in sorted order, at the end of a step; a byte each. */
struct sleep_marks {
  uint8_t *wakes_neighbors, *awakened;
};

/* Sleepers with a particle awake within h, once the awake have their lists. Several
 * threads may mark the same one. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    sleeping_boundary_kernel(neighborhood n, const sleep_tally *tally) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  if (tally->all || !tally->some) return;
  const point *points = n.particles.points;
  volatile pbf_real *activity = n.particles.activity;
  bool awake = !pbf_is_asleep(activity[own]);
  if (!__any_sync(~0u, awake)) return;
  pbf_vec x = position_of(load(points, own));
  for_neighbors(n.particles, n.grid, n.lists, i, [&](uint32_t j) {
    if (!awake || j == n.lists.sentinel_index || !pbf_is_inactive(activity[j])) return;
    pbf_vec x_ij = pbf_nearest_image(n.grid.period, pbf_sub(x, position_of(load(points, j))));
    if (pbf_dot(x_ij, x_ij) < n.constants.h2) activity[j] = pbf_sleeping_boundary();
  });
}

template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    activity_kernel(neighborhood n, const pbf_vec *velocities, pbf_sleep sleep, pbf_real *activity,
                    sleep_tally *tally, sleep_marks marks) {
  uint32_t i = own_index(n.particles);
  if (tally->all) return;
  pbf_vec around = smoothed_velocity<FEATURES>(n, velocities, 1, i);
  if (i >= n.particles.count) return;
  pbf_real rest = activity[i];
  bool wakes_neighbors = false;
  if (!pbf_is_asleep(rest)) {
    activity[i] = rest = pbf_activity(&sleep, rest, around);
    wakes_neighbors = pbf_wakes_neighbors(&sleep, rest, around);
  }
  marks.wakes_neighbors[i] = wakes_neighbors;
  marks.awakened[i] = 0;
  if (rest < sleep.still2) tally->near_sleep_count = 1;
}

/* Where no particle sleeps or is about to, none has to be told of what wakes its neighbours.
 * Several threads may mark the same neighbour. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    wake_neighbors_kernel(neighborhood n, const sleep_tally *tally, sleep_marks marks) {
  uint32_t i = own_index(n.particles), own = min(i, n.particles.count - 1);
  if (tally->all || !tally->near_sleep_count) return;
  const point *points = n.particles.points;
  pbf_vec x = position_of(load(points, own));
  bool wakes_neighbors = marks.wakes_neighbors[own];
  if (!__any_sync(~0u, wakes_neighbors)) return;
  for_neighbors(n.particles, n.grid, n.lists, i, [&](uint32_t j) {
    if (!wakes_neighbors || j == n.lists.sentinel_index) return;
    pbf_vec x_ij = pbf_nearest_image(n.grid.period, pbf_sub(x, position_of(load(points, j))));
    if (pbf_dot(x_ij, x_ij) < n.constants.h2) marks.awakened[j] = 1;
  });
}

/* The last block to come knows how many sleep; the host knows it by `epoch`. */
static __global__ void __launch_bounds__(PBF_BLOCK)
    update_sleep_kernel(uint32_t count, pbf_sleep sleep, pbf_real *activity, pbf_vec *velocities,
                        sleep_tally *tally, sleep_marks marks, volatile uint64_t *all_asleep,
                        uint64_t epoch) {
  uint32_t i = thread_index();
  if (tally->all) {
    if (i == 0) *all_asleep = epoch;
    return;
  }
  if (!tally->near_sleep_count) {
    if (i == 0) tally->some = 0;
    return;
  }
  bool asleep = false;
  if (i < count) {
    pbf_real rest = pbf_update_sleep(&sleep, activity[i], marks.awakened[i]);
    activity[i] = rest;
    asleep = pbf_is_asleep(rest);
    if (asleep) velocities[i] = {{0}};
  }
  uint32_t sleepers = (uint32_t)__syncthreads_count(asleep);
  if (threadIdx.x != 0) return;
  atomicAdd(&tally->sleepers, sleepers);
  __threadfence();
  if (atomicAdd(&tally->blocks, 1u) + 1 < gridDim.x) return;
  __threadfence();
  bool all = atomicAdd(&tally->sleepers, 0u) == count;
  if (all) *all_asleep = epoch;
  *tally = {0, 0, 0, all, 0, 0, 0};
}

/* No particle solves while all sleep: then the iterations are those of the step before. */
static __global__ void clear_convergence_kernel(convergence_state *watch,
                                                const sleep_tally *tally) {
  if (!tally->all) *watch = {};
}

template <bool LISTED>
static __global__ void wake_near_moving_kernel(const point *points, uint32_t count, pbf_sleep sleep,
                                               pbf_moving_obstacles moving_obstacles,
                                               step_obstacles o, pbf_real reach, pbf_real *activity,
                                               sleep_tally *tally) {
  uint32_t i = thread_index();
  if (i >= count || !pbf_is_asleep(activity[i])) return;
  const pbf_vec x = position_of(load(points, i));
  if (!pbf_near_moving_obstacle(moving_obstacles, asked_near<LISTED>(o, x, (double)reach), reach,
                                x))
    return;
  activity[i] = pbf_woken_activity(&sleep);
  tally->all = 0;
  tally->woken = 1;
}

template <bool LISTED>
static __global__ void keep_awake_near_kernel(const point *points, uint32_t count, pbf_sleep sleep,
                                              pbf_moving_obstacles arriving, step_obstacles o,
                                              pbf_real reach, pbf_real *activity) {
  uint32_t i = thread_index();
  if (i >= count || pbf_is_asleep(activity[i])) return;
  const pbf_vec x = position_of(load(points, i));
  if (pbf_near_moving_obstacle(arriving, asked_near<LISTED>(o, x, (double)reach), reach, x))
    activity[i] = pbf_real_max(activity[i], pbf_disturbed_activity(&sleep));
}

/* CONDITIONAL: where a particle near colliders has just woken. */
template <bool CONDITIONAL>
static __global__ void wake_all_kernel(uint32_t count, pbf_sleep sleep, pbf_real *activity,
                                       sleep_tally *tally) {
  uint32_t i = thread_index();
  if (CONDITIONAL && !tally->woken) return;
  if (i < count && pbf_is_asleep(activity[i])) activity[i] = pbf_woken_activity(&sleep);
  if (i == 0) tally->all = 0;
}

static __global__ void init_new_kernel(uint32_t count, pbf_sleep sleep, pbf_real *activity,
                                       sleep_tally *tally) {
  uint32_t i = thread_index();
  if (i < count) activity[i] = pbf_new_activity(&sleep);
  if (i == 0) tally->all = 0;
}

static __global__ void count_asleep_kernel(const pbf_real *activity, uint32_t count,
                                           sleep_tally *tally) {
  uint32_t i = thread_index();
  uint32_t sleepers = (uint32_t)__syncthreads_count(i < count && pbf_is_asleep(activity[i]));
  if (threadIdx.x == 0 && sleepers) atomicAdd(&tally->asked, sleepers);
}

#endif
