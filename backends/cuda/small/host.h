/* The host's side of small scenes: when their kernel serves, its memory, its launches. */
#ifndef PBF_CUDA_SMALL_SCENE_HOST_H
#define PBF_CUDA_SMALL_SCENE_HOST_H

#include "cuda/arrays.h"
#include "cuda/launches.h"
#include "cuda/small/launch.h"
#include "cuda/small/owners.h"
#include "physics/elementary.h"
#include "physics/overfull.h"

/* ---- When it serves -------------------------------------------------------------------------- */

/* Cells of so many particles. */
static inline uint32_t small_cells(uint32_t count) { return (PBF_DIM == 3 ? 1 : 2) * count + 1024; }

/* The most particles that it serves on this device, so far as there is room for them. */
static inline uint32_t small_max_particles(const solver *s) {
  uint32_t threads = s->multiprocessors * SMALL_THREADS;
  uint32_t maximum = threads < SMALL_MAX_PARTICLES ? threads : (uint32_t)SMALL_MAX_PARTICLES;
  return s->capacity < maximum ? s->capacity : maximum;
}

/* Whether the solver has the memory for it: where few particles, or some day fewer than now, have
 * no other stages. */
static inline bool small_wanted(const pbf_params *params, const pbf_schedule &now) {
  pbf_schedule has = now;
  if (params->pressure_grid < 0) has.runs[PBF_STAGE_GRID] = 0;
  if (params->shear_stress_correction < 0) /* with the grid */
    for (pbf_stage stage : {PBF_STAGE_DEVIATOR, PBF_STAGE_SHEAR_PUSH, PBF_STAGE_SHEAR_STRESS})
      has.runs[stage] = 0;
  return sizeof(pbf_real) == sizeof(float) && !params->periodic && has_only(has, SMALL_STAGES) &&
         !has.checks_convergence && !has.phases && !has.accelerations &&
         !pbf_may_have_ghosts(params) && params->iterations <= SMALL_ITERATIONS;
}

static inline double small_reach(const pbf_params *params) { /* in spacings */
  return params->smoothing_radius / pbf_derive_spacing(params);
}

/* Particles of a block, one block a multiprocessor, of a scene that is alone. */
static inline uint32_t small_own_alone(const solver *s) {
  uint32_t own = (s->count + s->multiprocessors - 1) / s->multiprocessors;
  return own > SMALL_MIN_OWN ? own : (uint32_t)SMALL_MIN_OWN;
}

/* Threads of a particle: as many as a block has for each, but no more than short lists
 * are worth. */
static inline uint32_t small_lanes(const solver *s) {
  uint32_t own = small_own_alone(s);
  if (own <= SMALL_THREADS / 8) return 8;
  return own <= SMALL_THREADS / 4 ? 4 : own <= SMALL_THREADS / 2 ? 2 : 1;
}

/* Shared memory that a block can divide up: less the steps, and what general_step needs. */
static inline size_t small_shared(const solver *s) {
  return s->block_shared - SMALL_STEPS * sizeof(small_step) - SMALL_THREADS * sizeof(uint32_t) -
         1024;
}

/* Twice the neighbours of the rest lattice, and a few. */
static inline double small_list_wanted(const pbf_params *params, uint32_t lanes) {
  double q = small_reach(params);
  double neighbors = PBF_DIM == 3 ? 4.0 / 3 * PBF_PI * q * q * q : PBF_PI * q * q;
  return 2 * neighbors / lanes + 16;
}
static inline double small_list_wanted(const solver *s) {
  return small_list_wanted(&s->params, small_lanes(s));
}

/* Entries that there is room for where so many are wanted. */
static inline uint32_t small_list_capacity(double wanted) {
  return ((uint32_t)fmin(SMALL_MAX_LISTED, wanted) + SMALL_CHUNK - 1) / SMALL_CHUNK * SMALL_CHUNK;
}

/* Particles of a compact block of the rest lattice, and of the cells around it. */
static inline double small_slots_expected(const solver *s, uint32_t own) {
  return pbf_whole_power(pbf_side_of(own, PBF_DIM) + 3 * small_reach(&s->params), PBF_DIM);
}

/* Cells of a tile whose particles are on their own, unless they are many. */
static inline uint32_t small_cells_wanted(uint32_t own) {
  uint32_t cells = PBF_DIM == 3 ? 27 : 9, maximum = 6400;
  return cells * own < maximum ? cells * own / 2 * 2 : maximum;
}

/* Four times the slots that are expected, and a few, if there is room: particles drift apart. */
static inline small_layout small_layout_of(const solver *s, uint32_t own) {
  small_layout layout = {(small_cells(s->count) + 31) / 32, small_cells_wanted(own), 0,
                         small_list_capacity(small_list_wanted(s))};
  size_t none = layout.bytes();
  layout.slot_capacity = 2;
  double wanted = fmin(SMALL_NO_PARTICLE - 3, 4 * small_slots_expected(s, own) + 512);
  double buffers = small_shared(s) > none ? (double)(small_shared(s) - none) : 0;
  layout.slot_capacity =
      (uint32_t)fmin(wanted, 2 * buffers / (double)(layout.bytes() - none)) / 2 * 2;
  return layout;
}

static inline bool small_fits(const solver *s, uint32_t own) {
  return small_layout_of(s, own).slot_capacity >= 1.75 * small_slots_expected(s, own);
}

/* Of what determines the state's bits, only parameters and the particle count enter. */
static inline bool small_serves(const solver *s) {
  if (are_listed(s)) return false;
  return s->small_upload && !s->shapes.count && !s->schedule.runs[PBF_STAGE_GRID] &&
         !s->schedule.runs[PBF_STAGE_SHEAR_STRESS] && s->count > 0 &&
         s->count <= small_max_particles(s) && small_list_wanted(s) <= SMALL_MAX_LISTED &&
         small_fits(s, small_own_alone(s));
}

/* Beside other worlds a block has as many as it has threads and memory for, so that several worlds
 * are resident at once. Which block has a particle changes no bit; how many threads it has, which
 * does, is as if it were alone. */
static inline uint32_t small_own(const solver *s) {
  const uint32_t alone = small_own_alone(s), most = SMALL_THREADS / small_lanes(s);
  if (s->worlds < 2) return alone;
  const uint32_t share = s->multiprocessors / s->worlds, blocks = share > 0 ? share : 1;
  const uint32_t wanted = (s->count + blocks - 1) / blocks;
  uint32_t own = wanted < most ? wanted : most;
  while (own > alone && !small_fits(s, own)) own -= (own + 7) / 8;
  return own > alone ? own : alone;
}

/* ---- Memory ---------------------------------------------------------------------------------- */

/* Of the arrays that lie in the room of the lists, which small scenes do without. */
struct small_parts {
  uint64_t lambdas, cell_count, cell_list, bytes;
};
static inline small_parts small_parts_of(const solver *s) {
  uint64_t n = ((uint64_t)small_max_particles(s) + 31) / 32 * 32,
           cells = ((uint64_t)small_cells(small_max_particles(s)) + 3) / 4 * 4;
  small_parts at;
  at.lambdas = n * sizeof(ulonglong2);
  at.cell_count = at.lambdas + n * sizeof(unsigned long long);
  at.cell_list = at.cell_count + cells * sizeof(uint32_t);
  at.bytes = at.cell_list + cells * SMALL_CELL_CAPACITY * sizeof(uint16_t);
  return at;
}

static inline char *small_part(const solver *s, uint64_t offset) {
  return static_cast<char *>(s->list_storage) + offset;
}

static inline pbf_status take_for_small(solver *s, bool wanted) {
  if (pbf_status status =
          take_if(s, wanted, "small: steps", sizeof(small_upload), &s->small_upload))
    return status;
  if (pbf_status status =
          take_if(s, wanted, "small: control", sizeof(small_control), &s->small_control))
    return status;
  if (!wanted) s->owned = 0;
  return take_if(s, wanted, "small: owners", small_max_particles(s) * sizeof(uint16_t), &s->owners);
}

static inline small_buffers small_buffers_of(const solver *s) {
  small_parts at = small_parts_of(s);
  small_buffers buffers;
  buffers.exchange.positions[0] = reinterpret_cast<ulonglong2 *>(s->list_storage);
  buffers.exchange.positions[1] = reinterpret_cast<ulonglong2 *>(s->other);
  buffers.exchange.lambdas = reinterpret_cast<unsigned long long *>(small_part(s, at.lambdas));
  buffers.cell_count = reinterpret_cast<uint32_t *>(small_part(s, at.cell_count));
  buffers.cell_list = reinterpret_cast<uint16_t *>(small_part(s, at.cell_list));
  buffers.control = s->small_control;
  return buffers;
}

/* A step that is done over needs neither exchange nor cells. */
static inline general_buffers general_buffers_of(const solver *s) {
  small_parts at = small_parts_of(s);
  uint32_t *spare = reinterpret_cast<uint32_t *>(small_part(s, at.lambdas));
  general_buffers buffers = {};
  buffers.sorted = {s->other,         s->other_velocities, s->other_ids,
                    spare + s->count, s->cell_start,       s->count};
  buffers.moved[0] = reinterpret_cast<point *>(s->list_storage);
  buffers.moved[1] = reinterpret_cast<point *>(small_part(s, at.cell_list));
  buffers.numbers = spare;
  buffers.scratch = scratch_of(s);
  buffers.total = s->total;
  return buffers;
}

/* ---- Launches -------------------------------------------------------------------------------- */

/* Into the order of ids, unless the particles are in it. */
static inline pbf_status small_order(solver *s) {
  if (s->ordered) return PBF_OK;
  order_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
      state_of(s), s->other, s->other_velocities, s->other_ids, s->other_last_pressure);
  swap_arrays(&s->points, &s->other);
  swap_arrays(&s->velocities, &s->other_velocities);
  swap_arrays(&s->ids, &s->other_ids);
  swap_arrays(&s->last_pressure, &s->other_last_pressure);
  s->ordered = true;
  return pbf_cuda_check_launch("order_kernel");
}

/* What differs from step to step; a grid is the last one's where no wall has moved. */
static inline void write_steps(const solver *s, const pbf_step_times &times, uint32_t steps,
                               small_step *to) {
  const pbf_periods none = {}; /* it serves no periodic domain */
  for (uint32_t k = 0; k < steps; ++k) {
    to[k].domain = pbf_domain_at(&s->params, pbf_time_after(&times, k + 1));
    if (k && memcmp(&to[k].domain, &to[k - 1].domain, sizeof to[k].domain) == 0)
      to[k].grid = to[k - 1].grid;
    else
      to[k].grid =
          grid_over(&to[k].domain, &none, s->params.smoothing_radius, small_cells(s->count), 1);
    to[k].rounding = pbf_rounding_of(pbf_time_after(&times, k), s->params.time_step);
  }
}

/* And from iteration to iteration. */
static inline void write_iterations(const solver *s, small_iteration *to) {
  pbf_constants c = s->constants;
  for (uint32_t k = 0; k < s->params.iterations; ++k) {
    pbf_set_iteration(&c, k);
    to[k] = {c.weight, c.scorr_k};
  }
}

static inline pbf_status small_upload_table(solver *s, const pbf_step_times &times,
                                            uint32_t steps) {
  small_upload upload;
  memset(static_cast<void *>(&upload), 0, sizeof upload);
  write_steps(s, times, steps, upload.steps);
  write_iterations(s, upload.iterations);
  size_t bytes = s->schedule.accelerated ? sizeof upload : steps * sizeof(small_step);
  return pbf_cuda_check(
      cudaMemcpyAsync(s->small_upload, &upload, bytes, cudaMemcpyHostToDevice, s->stream),
      "cudaMemcpyAsync of the steps");
}

/* Lets each block own neighbours, from now on for SMALL_STEPS steps. */
static inline pbf_status small_own_neighbors(solver *s, double time, uint32_t steps) {
  bool lasts = s->owned == s->count && s->owned_steps >= steps;
  if (lasts) {
    s->owned_steps -= steps;
    return PBF_OK;
  }
  pbf_domain domain = pbf_domain_at(&s->params, time);
  uint32_t bits = owner_bits(s->count), keys = 1u << (bits * PBF_DIM);
  owner_grid grid = owner_grid_over(&domain, s->params.smoothing_radius, bits);
  uint32_t *starts = reinterpret_cast<uint32_t *>(small_part(s, small_parts_of(s).cell_count));
  if (pbf_status status = pbf_cuda_check(
          cudaMemsetAsync(starts, 0, keys * sizeof(uint32_t), s->stream), "cudaMemsetAsync"))
    return status;
  count_owned_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(s->points, s->count, grid,
                                                                        starts, scratch_of(s));
  if (pbf_status status = pbf_cuda_scan(starts, keys, s->scan_scratch, s->scan_bytes, s->stream))
    return status;
  place_owned_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(s->count, starts,
                                                                        scratch_of(s), s->owners);
  s->owned = s->count;
  s->owned_steps = (uint32_t)SMALL_STEPS - steps;
  return pbf_cuda_check_launch("place_owned_kernel");
}

/* But for how blocks share it out. */
static inline small_scene small_scene_of(const solver *s, double time, uint32_t steps) {
  const pbf_schedule &has = s->schedule;
  small_scene scene = {};
  scene.points = s->points;
  scene.velocities = s->velocities;
  scene.last_pressure = s->last_pressure;
  scene.owners = s->owners;
  scene.count = s->count;
  scene.cells = small_cells(s->count);
  scene.steps = steps;
  scene.iterations = s->params.iterations;
  scene.lanes = small_lanes(s);
  scene.constants = s->constants;
  pbf_set_constants_of_step(&scene.constants, &s->constants, &s->params, s->count, &has, time);
  scene.forces = pbf_forces_of(&s->params, s->time); /* but for `rounding`, a step's own */
  scene.inv_time_step = (pbf_real)(1 / s->params.time_step);
  scene.wall_density = has.wall_density;
  scene.accelerated = has.accelerated;
  scene.collide_after_prediction = has.collide_after_prediction;
  scene.collide_in_iteration = has.collide_in_iteration;
  scene.collide_after_solve = has.collide_after_solve;
  scene.table = s->small_upload->steps;
  scene.iteration_table = s->small_upload->iterations;
  scene.surfaces = s->surfaces;
  scene.surface_count = (int)s->collider_count;
  return scene;
}

/* In 64 bits there is nothing to launch. */
template <class Real>
static pbf_status small_launch(const solver *s, const small_scene &scene) {
  if constexpr (sizeof(Real) == sizeof(float)) {
    const uint32_t blocks = (s->count + scene.own - 1) / scene.own;
    return launch_small<Real, PBF_DIM>(s->stream, s->schedule.features, blocks, scene,
                                       small_buffers_of(s), general_buffers_of(s));
  }
  return PBF_OK;
}

/* Lets small_kernel have the shared memory that its lists take: before it is first launched, for
 * what it costs. */
template <class Real>
static pbf_status small_allow_shared(solver *s) {
  pbf_status status = PBF_OK;
  if (s->small_allowed) return status;
  if constexpr (sizeof(Real) == sizeof(float))
    status = allow_small_shared<Real, PBF_DIM>(small_shared(s));
  s->small_allowed = status == PBF_OK;
  return status;
}

/* So many steps, at most SMALL_STEPS, all alike. What they take counts to the first stage, with
 * which the plan has their launch. */
static inline pbf_status small_steps(solver *s, const pbf_step_times &times, uint32_t steps) {
  const double time = pbf_time_after(&times, 1);
  if (pbf_status status = small_allow_shared<pbf_real>(s)) return status;
  if (pbf_status status = clock_begin(&s->clock, s->stream)) return status;
  if (pbf_status status = small_order(s)) return status;
  if (pbf_status status = small_own_neighbors(s, time, steps)) return status;
  if (pbf_status status = small_upload_table(s, times, steps)) return status;
  if (pbf_status status =
          pbf_cuda_check(cudaMemsetAsync(s->small_control, 0, sizeof(small_control), s->stream),
                         "cudaMemsetAsync"))
    return status;
  small_scene scene = small_scene_of(s, time, steps);
  scene.own = small_own(s);
  scene.layout = small_layout_of(s, scene.own);
  if (pbf_status status = small_launch<pbf_real>(s, scene)) return status;
  if (pbf_status status = clock_end(&s->clock, s->stream, PBF_STAGE_PREDICT)) return status;
  s->time = pbf_time_after(&times, steps);
  return PBF_OK;
}

#endif
