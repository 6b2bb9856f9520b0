/* Part of backend.cu: how a solver of the device begins and ends. */
#ifndef PBF_CUDA_CREATE_H
#define PBF_CUDA_CREATE_H

#include "cuda/plugin.h"
#include "cuda/scene.h"

static inline void destroy_solver(solver *s) {
  {
    pbf_cuda_scope scope(s->context);
    clock_stop(&s->clock);
    if (s->stream) cudaStreamSynchronize(s->stream);
    drop_team(s);
    if (s->reached) cudaEventDestroy(s->reached);
    free_ranks(s);
    free_shape_table(s->allocator, s->shapes);
    free_many_host(s, s->many.table);
    pbf_cuda_free_all(&s->memory);
    free_all_asleep(s);
    free_refusals(s);
    if (s->owns_stream) cudaStreamDestroy(s->stream);
    cudaGetLastError();
  }
  s->allocator.release(s->allocator.user, s, sizeof *s, alignof(solver));
}

static inline pbf_status take_arrays(solver *s) {
  uint64_t n = s->capacity, warps = (n + 31) / 32;
  if (pbf_status status =
          pbf_cuda_scan_scratch(grid_cell_limit(s->scene_capacity) + 2, &s->scan_bytes))
    return status;
  const struct {
    const char *name;
    uint64_t bytes;
    void *to;
  } wanted[] = {
      {"position", (n + PBF_SPARE_POINTS) * sizeof(point), &s->points},
      {"velocity", n * sizeof(pbf_vec), &s->velocities},
      {"id", n * sizeof(uint32_t), &s->ids},
      {"moved position", (n + PBF_SPARE_POINTS) * sizeof(point), &s->other},
      {"predicted velocity", n * sizeof(pbf_vec), &s->other_velocities},
      {"sorted id", n * sizeof(uint32_t), &s->other_ids},
      {"sorted cell", n * sizeof(uint32_t), &s->cells},
      {"scan scratch", s->scan_bytes, &s->scan_scratch},
      {"list size", n * sizeof(uint8_t), &s->lists.sizes},
      {"list base", warps * PBF_ROWS * sizeof(uint32_t), &s->lists.bases},
  };
  for (const auto &array : wanted)
    if (pbf_status status =
            pbf_cuda_take(&s->memory, array.name, array.bytes, static_cast<void **>(array.to)))
      return status;
  if (has_ranks(s)) return take_ranks(s); /* with cells once they are known */
  return pbf_cuda_take(&s->memory, "cell start",
                       (grid_cell_limit(s->capacity) + 1ull) * sizeof(uint32_t),
                       reinterpret_cast<void **>(&s->cell_start));
}

/* The particle that fills up lists: so far away that every pair term with it is 0, near enough
 * that no distance overflows. */
static inline pbf_status place_nowhere(solver *s) {
  point sentinel_position = {};
  for (int k = 0; k < PBF_DIM; ++k) sentinel_position.c[k] = (pbf_real)1e18;
  s->lists.sentinel_index = s->capacity;
  for (point *points : {s->points, s->other})
    if (pbf_status status = pbf_cuda_check(
            cudaMemcpyAsync(points + s->capacity, &sentinel_position, sizeof sentinel_position,
                            cudaMemcpyHostToDevice, s->stream),
            "cudaMemcpyAsync"))
      return status;
  return PBF_OK;
}

static inline pbf_status open_stream(solver *s, void *stream) {
  if (stream) {
    s->stream = static_cast<cudaStream_t>(stream);
  } else {
    if (pbf_status status = pbf_cuda_check(
            cudaStreamCreateWithFlags(&s->stream, cudaStreamNonBlocking), "cudaStreamCreate"))
      return status;
    s->owns_stream = true;
  }
  s->memory.stream = s->stream;
  return PBF_OK;
}

/* Lists grow in more shared memory than a kernel may have unasked. */
template <searchers WHICH>
static inline pbf_status allow_lists() {
  for (auto kernel : {list_kernel<WHICH, false>, list_kernel<WHICH, true>})
    if (pbf_status status =
            pbf_cuda_check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                                (int)list_shared(PBF_MAX_LISTED / PBF_CHUNK)),
                           "cudaFuncSetAttribute"))
      return status;
  return PBF_OK;
}

static inline pbf_status fill(solver *s, const pbf_backend_desc *desc, const pbf_params *params) {
  cudaDeviceProp properties;
  if (pbf_status status = pbf_cuda_check(cudaGetDevice(&s->device), "cudaGetDevice")) return status;
  if (pbf_status status = pbf_cuda_check(cudaGetDeviceProperties(&properties, s->device),
                                         "cudaGetDeviceProperties"))
    return status;
  snprintf(s->device_name, sizeof s->device_name, "%.95s", properties.name);
  s->multiprocessors = (uint32_t)properties.multiProcessorCount;
  s->block_shared = properties.sharedMemPerBlockOptin;
  s->launches_early = properties.major >= 9;
  s->ordered = true;
  if (pbf_status status = open_stream(s, desc->stream)) return status;
  if (pbf_status status = take_arrays(s)) return status;
  if (pbf_status status = place_nowhere(s)) return status;
  if (pbf_status status = allow_lists<SEARCH_ALL>()) return status;
  if constexpr (PBF_SLEEP) {
    if (pbf_status status = allow_lists<SEARCH_AWAKE>()) return status;
    if (pbf_status status = allow_lists<SEARCH_SLEEPING_BOUNDARY>()) return status;
  }
  if constexpr (PBF_HAS_PRESSURE_GRID)
    if (pbf_status status = allow_pressure_grid(s)) return status;
  if (pbf_status status = apply_params(s, params, 0, nullptr)) return status;
  return pbf_cuda_check(cudaStreamSynchronize(s->stream), "cudaStreamSynchronize");
}

static inline pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                                pbf_backend_solver **out, const pbf_backend_api **api) {
  const pbf_allocator &allocator = desc->allocator;
  pbf_cuda_host = desc->host;
  solver *s =
      static_cast<solver *>(allocator.allocate(allocator.user, sizeof(solver), alignof(solver)));
  if (!s) {
    pbf_cuda_host->set_error("no host memory for a cuda solver");
    return PBF_ERROR_OUT_OF_MEMORY;
  }
  memset(static_cast<void *>(s), 0, sizeof *s);
  s->allocator = allocator;
  s->host = desc->host;
  s->capacity = desc->capacity;
  s->worlds = desc->worlds;
  s->colliders = s->few_colliders;
  pbf_place_few_basins(&s->basins, &s->basins_memory);
  pbf_status status = describe_ranks(s, desc->ranks);
  if (status == PBF_OK) status = pbf_cuda_context_find(desc->device, desc->stream, &s->context);
  if (status == PBF_OK) {
    pbf_cuda_scope scope(s->context);
    status = fill(s, desc, params);
  }
  if (status != PBF_OK) {
    destroy_solver(s);
    return status;
  }
  *out = reinterpret_cast<pbf_backend_solver *>(s);
  *api = &PBF_VARIANT_API;
  return PBF_OK;
}

#endif
