/* The host's side of small.h: when it serves, its memory, its launches. */
#ifndef PBF_CUDA_SMALL_HOST_H
#define PBF_CUDA_SMALL_HOST_H

#include "cuda/step.h"

static inline uint32_t small_cells(const solver *s) {
  return (PBF_DIM == 3 ? 1 : 2) * s->capacity + 1024;
}

/* Whether this solver can ever be small: decided once, by what cannot change. */
static inline bool small_possible(const solver *s) {
  return sizeof(pbf_real) == sizeof(float) && s->capacity <= SMALL_MOST_PARTICLES &&
         s->multiprocessors * SMALL_THREADS >= s->capacity;
}

static inline double small_expected_neighbors(const pbf_params *params) {
  double q = params->smoothing_radius / pbf_derive_spacing(params);
  return PBF_DIM == 3 ? 4.0 / 3 * PBF_PI * q * q * q : PBF_PI * q * q;
}

/* Threads of a particle: as many as the machine holds at once. */
static inline uint32_t small_lanes(const solver *s) {
  uint32_t lanes = 16;
  while (lanes > 1 && lanes * s->count > s->multiprocessors * SMALL_THREADS) lanes /= 2;
  return lanes;
}

/* Threads of a block, one block a multiprocessor. */
static inline uint32_t small_block(const solver *s) {
  uint32_t threads = (small_lanes(s) * s->count / s->multiprocessors + 32) / 32 * 32;
  return threads < SMALL_THREADS ? threads : (uint32_t)SMALL_THREADS;
}

/* Shared memory that lists can have: less the steps, and what general_step needs. */
static inline size_t small_shared(const solver *s) {
  return s->block_shared - SMALL_STEPS * sizeof(small_step) - SMALL_THREADS * sizeof(uint32_t) -
         1024;
}

static inline uint32_t small_list_room(const solver *s) {
  size_t room = small_shared(s) / (small_block(s) / small_lanes(s) * sizeof(uint16_t));
  return room < SMALL_LIST_ROOM ? (uint32_t)room : (uint32_t)SMALL_LIST_ROOM;
}

/* Of what determines the state's bits, only parameters and the particle count enter, and whether
 * times are taken. */
static inline bool small_serves(const solver *s) {
  const pbf_schedule &has = s->schedule;
  return s->small.control && !s->clock.begin && s->count > 0 && !has.runs[PBF_STAGE_CURL] &&
         !has.runs[PBF_STAGE_VISCOSITY] && !has.runs[PBF_STAGE_SLACK] &&
         !has.runs[PBF_STAGE_SLEEP] && !has.watched && s->params.iterations <= SMALL_ITERATIONS &&
         small_expected_neighbors(&s->params) <= 0.6 * small_list_room(s);
}

static inline pbf_status small_take(solver *s) {
  uint64_t n = s->capacity, cells = small_cells(s);
  small_room *room = &s->small;
  const struct {
    const char *name;
    uint64_t bytes;
    void *to;
  } wanted[] = {
      {"small: predicted", n * sizeof(point), &room->points[0]},
      {"small: moved", n * sizeof(point), &room->points[1]},
      {"small: cell count", cells * sizeof(uint32_t), &room->cell_count},
      {"small: cell list", cells * SMALL_CELL_ROOM * sizeof(uint16_t), &room->cell_list},
      {"small: steps", sizeof(small_upload), &s->small_table},
      {"small: control", sizeof(grid_control), &room->control},
  };
  for (const auto &array : wanted)
    if (pbf_status status =
            pbf_cuda_take(&s->memory, array.name, array.bytes, static_cast<void **>(array.to)))
      return status;
  return PBF_OK;
}

/* Into the order of ids, unless the particles are in it. */
static inline pbf_status small_order(solver *s) {
  if (s->ordered) return PBF_OK;
  order_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
      state_of(s), s->other, s->other_velocities, s->other_ids);
  exchange(&s->points, &s->other);
  exchange(&s->velocities, &s->other_velocities);
  exchange(&s->ids, &s->other_ids);
  s->ordered = true;
  return pbf_cuda_check_launch("order_kernel");
}

static inline pbf_status small_upload_table(solver *s, double time, uint32_t steps) {
  small_upload upload;
  pbf_constants c = s->constants;
  memset(static_cast<void *>(&upload), 0, sizeof upload);
  for (uint32_t k = 0; k < steps; ++k) {
    upload.steps[k].walls = pbf_walls_at(&s->params, time + k * s->params.time_step);
    upload.steps[k].grid =
        grid_over(&upload.steps[k].walls, s->params.smoothing_radius, small_cells(s), 1);
  }
  for (uint32_t k = 0; k < s->params.iterations; ++k) {
    pbf_set_iteration(&c, &s->params, k);
    upload.iterations[k] = {c.weight, c.scorr_k};
  }
  size_t bytes = s->schedule.accelerated ? sizeof upload : steps * sizeof(small_step);
  return pbf_cuda_check(
      cudaMemcpyAsync(s->small_table, &upload, bytes, cudaMemcpyHostToDevice, s->stream),
      "cudaMemcpyAsync of the steps");
}

static inline small_scene small_scene_of(const solver *s, uint32_t steps) {
  const pbf_schedule &has = s->schedule;
  small_scene scene = {};
  scene.points = s->points;
  scene.velocities = s->velocities;
  scene.count = s->count;
  scene.steps = steps;
  scene.iterations = s->params.iterations;
  scene.lanes = small_lanes(s);
  scene.list_room = small_list_room(s);
  scene.constants = s->constants;
  scene.forces = pbf_forces_of(&s->params);
  scene.inv_time_step = (pbf_real)(1 / s->params.time_step);
  scene.wall_density = has.wall_density;
  scene.accelerated = has.accelerated;
  scene.collide_after_prediction = has.collide_after_prediction;
  scene.collide_in_iteration = has.collide_in_iteration;
  scene.collide_after_solve = has.collide_after_solve;
  scene.table = s->small_table->steps;
  scene.iteration_table = s->small_table->iterations;
  scene.solids = s->solids;
  scene.solid_count = (int)s->collider_count;
  return scene;
}

template <class Kernel, class... Arguments>
static pbf_status launch_resident(const solver *s, Kernel kernel, uint32_t blocks, uint32_t threads,
                                  size_t shared, const char *name, Arguments... arguments) {
  void *pointers[] = {&arguments...};
  return pbf_cuda_check(
      cudaLaunchCooperativeKernel(reinterpret_cast<const void *>(kernel), dim3(blocks),
                                  dim3(threads), pointers, shared, s->stream),
      name);
}

/* In 64 bits there is nothing to compile. */
template <class Real>
static pbf_status small_launch(const solver *s, const small_scene &scene) {
  pbf_status status = PBF_OK;
  if constexpr (sizeof(Real) == sizeof(float)) {
    uint32_t block = small_block(s), blocks = (scene.lanes * s->count + block - 1) / block;
    size_t shared = (size_t)(block / scene.lanes) * scene.list_room * sizeof(uint16_t);
    general_room general = {
        {s->other, s->other_velocities, s->other_ids, s->cells, s->cell_start, s->count},
        reinterpret_cast<uint32_t *>(s->small.points[1]), /* of a step that is done over */
        scratch_of(s),
        s->lambda_before};
    with_features(s->schedule.features, [&](auto features) {
      constexpr int FEATURES = decltype(features)::value;
      bool extras = scene.accelerated || scene.wall_density || scene.solid_count;
      auto kernel = extras ? small_kernel<FEATURES, true> : small_kernel<FEATURES, false>;
      status = launch_resident(s, kernel, blocks, block, shared, "small_kernel", scene, s->small,
                               general);
    });
  }
  return status;
}

/* Lets small_kernel have the shared memory that its lists take. */
template <class Real>
static pbf_status small_allow_shared(const solver *s) {
  pbf_status status = PBF_OK;
  if constexpr (sizeof(Real) == sizeof(float)) {
    for (int k = 0; k < PBF_FEATURE_COUNT && status == PBF_OK; ++k)
      with_features(k, [&](auto features) {
        constexpr int FEATURES = decltype(features)::value;
        for (auto kernel : {small_kernel<FEATURES, false>, small_kernel<FEATURES, true>})
          if (status == PBF_OK)
            status = pbf_cuda_check(
                cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                     (int)small_shared(s)),
                "cudaFuncSetAttribute");
      });
  }
  return status;
}

/* The steps that end at `time`, `time` + time_step, …; at most SMALL_STEPS of them. */
static inline pbf_status small_steps(solver *s, double time, uint32_t steps) {
  if (pbf_status status = small_order(s)) return status;
  if (pbf_status status = small_upload_table(s, time, steps)) return status;
  if (pbf_status status = pbf_cuda_check(
          cudaMemsetAsync(s->small.control, 0, sizeof(grid_control), s->stream), "cudaMemsetAsync"))
    return status;
  if (pbf_status status = small_launch<pbf_real>(s, small_scene_of(s, steps))) return status;
  s->time = time + (steps - 1) * s->params.time_step;
  return PBF_OK;
}

#endif
