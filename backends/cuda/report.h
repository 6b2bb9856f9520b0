/* Part of backend.cu: statistics, plan and times. */
#ifndef PBF_CUDA_REPORT_H
#define PBF_CUDA_REPORT_H

#include "common/report.h"
#include "cuda/executor.h"
#include "cuda/population.h"
#include "cuda/small/host.h"

static inline void fill_stats(const partial_stats &sum, uint32_t count, pbf_stats *stats) {
  double per_particle = 1.0 / count;
  for (int k = 0; k < PBF_DIM; ++k) {
    stats->center_of_mass[k] = sum.position[k] * per_particle;
    stats->momentum[k] = sum.velocity[k] * per_particle;
    stats->position_min[k] = sum.position_min[k];
    stats->position_max[k] = sum.position_max[k];
  }
  stats->kinetic_energy = sum.kinetic_energy * per_particle;
  stats->speed_max = sqrt(sum.speed2_max);
  stats->density_mean = sum.density * per_particle;
  stats->density_error_mean = sum.density_error * per_particle;
  stats->density_error_max = fmax(sum.density_max - 1, 0);
  stats->neighbors_mean = sum.neighbors * per_particle;
  stats->neighbors_max = sum.neighbors_max;
  stats->squeezed = sum.squeezed;
}

static inline pbf_status count_asleep(solver *s, uint32_t *asleep) {
  if (!PBF_SLEEP || !s->activity) return PBF_OK;
  if (pbf_status status = wake_ranks(s)) return status;
  if (pbf_status status =
          pbf_cuda_check(cudaMemsetAsync(&s->tally->asked, 0, sizeof s->tally->asked, s->stream),
                         "cudaMemsetAsync"))
    return status;
  if (s->count)
    count_asleep_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(s->activity + s->first,
                                                                           s->count, s->tally);
  if (pbf_status status = pbf_cuda_check_launch("count_asleep_kernel")) return status;
  return copy_out(s, asleep, &s->tally->asked, sizeof *asleep);
}

/* Of all ranks. */
static inline bool add_up_asleep(solver *s, uint32_t *asleep) {
  uint32_t all[RANKS_OF_CUDA];
  if (!gather_on_ranks(s, asleep, all, sizeof *asleep)) return false;
  *asleep = 0;
  for (uint32_t k = 0; k < s->ranks.count; ++k) *asleep += all[k];
  return true;
}

/* In the order of the ranks, and so of the particles. */
static inline bool merge_of_ranks(solver *s, partial_stats *sum) {
  partial_stats all[RANKS_OF_CUDA];
  if (!gather_on_ranks(s, sum, all, sizeof *sum)) return false;
  *sum = empty_stats();
  for (uint32_t k = 0; k < s->ranks.count; ++k) merge(sum, all[k]);
  return true;
}

/* Where a rank has no particles, no kernel has noted when the solve ended. */
static inline bool most_iterations_of_ranks(solver *s, uint32_t *iterations) {
  uint32_t all[RANKS_OF_CUDA];
  if (!gather_on_ranks(s, iterations, all, sizeof *iterations)) return false;
  for (uint32_t k = 0; k < s->ranks.count; ++k)
    *iterations = all[k] > *iterations ? all[k] : *iterations;
  return true;
}

static inline pbf_status report_stats(solver *s, pbf_stats *stats) {
  stats->count = particles_of_all(s);
  stats->iterations = s->params.iterations;
  if (s->watch)
    if (pbf_status status =
            copy_out(s, &stats->iterations, &s->watch->done, sizeof stats->iterations))
      return status;
  if (s->watch && has_ranks(s) && !most_iterations_of_ranks(s, &stats->iterations))
    return s->ranks.failed;
  if (!stats->count) return PBF_OK;
  if (pbf_status status = count_asleep(s, &stats->asleep)) return status;
  if (has_ranks(s) && !add_up_asleep(s, &stats->asleep)) return s->ranks.failed;
  iteration_extras extras;
  if (pbf_status status = present_extras(s, &extras)) return status;
  cell_grid grid = present_grid(s, extras.obstacles.domain);
  if (pbf_status status = sort_present(s, grid)) return status;
  const neighborhood n = neighborhood_of(s, grid);
  unsorted_particles from = state_of(s);
  if (has_ranks(s)) { /* what is its own now, sorted */
    from.points = n.particles.points;
    from.velocities = n.particles.velocities;
    from.count = n.particles.count;
  }
  uint32_t blocks = blocks_for(own_count(n));
  if (blocks > PBF_SUM_BLOCKS) blocks = PBF_SUM_BLOCKS;
  const uint32_t padded = (n.particles.count + 31) / 32 * 32; /* in the room of the lists */
  const found_densities found = found_densities_in(s->list_storage, padded);
  partial_stats partial[PBF_SUM_BLOCKS],
      *on_device = reinterpret_cast<partial_stats *>(found.neighbors + padded);
  launch_densities(s, n, extras, found);
  with_surfaces(s, [&](auto surfaces) {
    stats_kernel<decltype(surfaces)::value><<<blocks ? blocks : 1, PBF_BLOCK, 0, s->stream>>>(
        from, n.particles.first, found, extras.obstacles, on_device);
  });
  if (pbf_status status = pbf_cuda_check_launch("stats_kernel")) return status;
  if (pbf_status status = copy_out(s, partial, on_device, blocks * sizeof *partial)) return status;
  partial_stats sum = empty_stats();
  for (uint32_t k = 0; k < blocks; ++k) merge(&sum, partial[k]);
  if (has_ranks(s) && !merge_of_ranks(s, &sum)) return s->ranks.failed;
  fill_stats(sum, stats->count, stats);
  return PBF_OK;
}

/* The largest square: its bits are in the order of the numbers: the same in any order of threads.
 */
static __global__ void max_speed2_kernel(const pbf_vec *velocities, uint32_t count,
                                         unsigned long long *largest) {
  const uint32_t i = thread_index();
  double v2 = 0;
  if (i < count)
    for (int k = 0; k < PBF_DIM; ++k) v2 += (double)velocities[i].c[k] * (double)velocities[i].c[k];
  for (int step = 16; step > 0; step /= 2) v2 = fmax(v2, __shfl_xor_sync(~0u, v2, step));
  if (threadIdx.x % 32 == 0 && v2 > 0)
    atomicMax(largest, (unsigned long long)__double_as_longlong(v2));
}

/* Between steps the lists' room is free. */
static inline pbf_status report_max_speed(solver *s, double *speed) {
  unsigned long long *largest = static_cast<unsigned long long *>(s->list_storage);
  double v2 = 0;
  *speed = 0;
  if (!s->count) return PBF_OK;
  if (pbf_status status = pbf_cuda_check(cudaMemsetAsync(largest, 0, sizeof *largest, s->stream),
                                         "cudaMemsetAsync"))
    return status;
  max_speed2_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(s->velocities, s->count,
                                                                       largest);
  if (pbf_status status = pbf_cuda_check_launch("max_speed2_kernel")) return status;
  if (pbf_status status = copy_out(s, &v2, largest, sizeof v2)) return status;
  *speed = sqrt(v2);
  return PBF_OK;
}

static inline void report_plan(const solver *s, pbf_plan *plan) {
  for (int k = 0; k < PBF_STAGE_COUNT; ++k) {
    if (!s->schedule.runs[k]) continue;
    pbf_plan_stage *stage = pbf_plan_add_stage(plan, k, s->schedule.runs[k]);
    stage->launches_per_step += s->schedule.runs[k] * launches_of(s, (pbf_stage)k);
    /* Crowding, and where particles go. */
    if (k == PBF_STAGE_VISCOSITY && s->schedule.accelerated)
      stage->launches_per_step += 2 + (finds_loads(s) && s->schedule.no_slip);
    if (k == PBF_STAGE_SURFACE_TENSION) stage->launches_per_step += s->schedule.adhesion;
    /* One launch does all the steps of a call, up to SMALL_STEPS. */
    if (small_serves(s)) stage->launches_per_step = k == PBF_STAGE_PREDICT ? 1 : 0;
  }
  pbf_variant_name(plan->variant, sizeof plan->variant, s->schedule.features, PBF_DIM,
                   sizeof(pbf_real));
  pbf_cuda_memory_plan(&s->memory, s->capacity, plan);
  plan->bytes += sizeof *s;
}

static inline void report_timings(const solver *s, pbf_timings *timings) {
  for (int k = 0; k < PBF_STAGE_COUNT; ++k)
    if (s->schedule.runs[k])
      pbf_timings_add(timings, k, s->clock.milliseconds[k], s->clock.runs[k]);
}

#endif
