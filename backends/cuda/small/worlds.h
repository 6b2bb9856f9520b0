/* Part of deferred_steps.h: the host's side of worlds that step together: what a step of one puts
 * off, until all are known, and the launches of world.h. */
#ifndef PBF_CUDA_SMALL_WORLDS_H
#define PBF_CUDA_SMALL_WORLDS_H

#include "cuda/small/host.h"

/* ---- When it serves -------------------------------------------------------------------------- */

static inline uint32_t even_above(uint32_t count) { return (count + 2) / 2 * 2; }

static inline world_layout world_layout_of(const solver *s) {
  return {even_above(s->count), even_above(small_cells(s->count)),
          small_list_capacity(small_list_wanted(s))};
}

/* Bytes of the lists of so many particles. */
static inline uint64_t world_list_bytes(const pbf_params *params, uint32_t count) {
  const uint64_t padded = (count + 7) / 8 * 8;
  const uint32_t longest =
      small_list_capacity(small_list_wanted(params, WORLD_LANES)) - SMALL_CHUNK;
  return padded * ((longest + WORLD_CHUNK - 1) / WORLD_CHUNK) * WORLD_QUADS * sizeof(uint4);
}

/* Of a batch's solver, where it has small scenes. */
static inline uint64_t world_list_room(const solver *s, const pbf_params *params) {
  const uint32_t most = s->multiprocessors * (SMALL_THREADS / 16);
  return s->worlds > 1 ? world_list_bytes(params, s->capacity < most ? s->capacity : most) : 0;
}

/* Whether a block does a step of this world. */
static inline bool world_serves(const solver *s) {
  return sizeof(pbf_real) == sizeof(float) && s->worlds > 1 && !s->clock.begin && small_serves(s) &&
         small_lanes(s) == WORLD_LANES && s->params.iterations > 0 &&
         world_list_bytes(&s->params, s->count) <= s->list_bytes &&
         world_layout_of(s).bytes() + sizeof(world_record) + 1024 <= s->block_shared;
}

/* Fewer worlds leave multiprocessors without work, and each is sooner done by many blocks. */
static inline bool worlds_fill(const solver *s, uint32_t worlds) {
  return 4 * worlds >= s->multiprocessors;
}

/* ---- Together ------------------------------------------------------------------------------- */

static inline void drop_team(solver *s) {
  world_team *team = s->team;
  s->team = nullptr;
  if (!team || --team->users > 0) return;
  for (world_upload &upload : team->uploads) {
    if (upload.read) cudaEventDestroy(upload.read);
    cudaFreeHost(upload.host);
    cudaFree(upload.device);
  }
  if (team->done) cudaEventDestroy(team->done);
  cudaGetLastError();
  s->allocator.release(s->allocator.user, team, sizeof *team, alignof(world_team));
}

/* Null where there is no memory for it: worlds then run one by one. */
static inline world_team *team_of(solver *leader) {
  if (leader->team) return leader->team;
  const pbf_allocator &allocator = leader->allocator;
  world_team *team = static_cast<world_team *>(
      allocator.allocate(allocator.user, sizeof(world_team), alignof(world_team)));
  if (!team) return nullptr;
  memset(static_cast<void *>(team), 0, sizeof *team);
  team->users = 1;
  leader->team = team;
  bool made = cudaEventCreateWithFlags(&team->done, cudaEventDisableTiming) == cudaSuccess;
  for (world_upload &upload : team->uploads)
    made = made && cudaEventCreateWithFlags(&upload.read, cudaEventDisableTiming) == cudaSuccess;
  if (made) return team;
  cudaGetLastError();
  drop_team(leader);
  return nullptr;
}

static inline void join_team(solver *s, world_team *team) {
  if (s->team == team) return;
  drop_team(s);
  s->team = team;
  ++team->users;
}

/* Room for records; what the device has read of the last ones. */
static inline pbf_status take_upload(world_upload *upload, uint64_t bytes) {
  if (pbf_status status =
          pbf_cuda_check(cudaEventSynchronize(upload->read), "cudaEventSynchronize"))
    return status;
  if (upload->bytes >= bytes) return PBF_OK;
  cudaFreeHost(upload->host);
  cudaFree(upload->device);
  *upload = {nullptr, nullptr, 0, upload->read};
  bytes += bytes / 4;
  if (pbf_status status = pbf_cuda_check(cudaMallocHost(&upload->host, bytes), "cudaMallocHost"))
    return status;
  if (pbf_status status = pbf_cuda_check(cudaMalloc(&upload->device, bytes), "cudaMalloc"))
    return status;
  upload->bytes = bytes;
  return PBF_OK;
}

/* ---- Records -------------------------------------------------------------------------------- */

/* Where the parts of a record lie. */
struct record_parts {
  uint64_t steps, iterations, surfaces, bytes;
};

static inline record_parts record_parts_of(const solver *s, uint32_t steps) {
  const uint64_t grain = 16;
  record_parts at;
  at.steps = sizeof(world_record);
  at.iterations = at.steps + steps * sizeof(small_step);
  if (s->schedule.accelerated)
    at.surfaces = at.iterations + s->params.iterations * sizeof(small_iteration);
  else
    at.surfaces = at.iterations;
  at.surfaces = (at.surfaces + grain - 1) / grain * grain;
  at.bytes = at.surfaces + (uint64_t)steps * s->collider_count * sizeof(pbf_surface);
  at.bytes = (at.bytes + grain - 1) / grain * grain;
  return at;
}

/* Writes the record of a world's next steps to `host`, which the device has at `device`. */
static inline void write_record(solver *s, const pbf_step_times &times, uint32_t steps, char *host,
                                char *device) {
  const record_parts at = record_parts_of(s, steps);
  world_record *record = reinterpret_cast<world_record *>(host);
  write_steps(s, times, steps, reinterpret_cast<small_step *>(host + at.steps));
  if (s->schedule.accelerated)
    write_iterations(s, reinterpret_cast<small_iteration *>(host + at.iterations));
  if (s->collider_count)
    for (uint32_t k = 0; k < steps; ++k)
      place_at(s, pbf_time_after(&times, k + 1),
               reinterpret_cast<pbf_surface *>(host + at.surfaces) + k * s->collider_count);
  record->scene = small_scene_of(s, pbf_time_after(&times, 1), steps);
  record->scene.layout.list_capacity = small_list_capacity(small_list_wanted(s));
  record->scene.table = reinterpret_cast<const small_step *>(device + at.steps);
  record->scene.iteration_table = reinterpret_cast<const small_iteration *>(device + at.iterations);
  record->scene.surfaces = reinterpret_cast<const pbf_surface *>(device + at.surfaces);
  record->general = general_buffers_of(s);
  record->lists = static_cast<uint4 *>(s->list_storage);
  record->padded = (s->count + 7) / 8 * 8;
}

/* ---- Launches ------------------------------------------------------------------------------- */

/* Worlds that one launch serves are alike in this: twice the features, and 1 with colliders. */
static inline uint32_t kernel_of(const solver *s) {
  return (uint32_t)(s->schedule.features & 3) * 2 + (s->collider_count > 0);
}

static inline world_layout layout_for(const world_layout &a, const world_layout &b) {
  return {a.slots > b.slots ? a.slots : b.slots, a.cells > b.cells ? a.cells : b.cells,
          a.listed > b.listed ? a.listed : b.listed};
}

/* Threads by which the particles are done in the fewest rounds, the last of which is full. */
static inline uint32_t threads_for(uint32_t count) {
  const uint32_t rounds = (count + SMALL_THREADS - 1) / SMALL_THREADS;
  return ((count + rounds - 1) / rounds + 31) / 32 * 32;
}

/* In 64 bits there is nothing to launch. */
template <class Real>
static pbf_status launch_if_built(const world_launch &launch) {
  if constexpr (sizeof(Real) == sizeof(float)) return launch_worlds<Real, PBF_DIM>(launch);
  return PBF_OK;
}

/* What other calls have enqueued of this world comes before. */
static inline pbf_status follow_world(const solver *leader, solver *s) {
  if (!s->works_alone || s->stream == leader->stream) return PBF_OK;
  if (!s->reached)
    if (pbf_status status = pbf_cuda_check(
            cudaEventCreateWithFlags(&s->reached, cudaEventDisableTiming), "cudaEventCreate"))
      return status;
  s->works_alone = false;
  if (pbf_status status = pbf_cuda_check(cudaEventRecord(s->reached, s->stream), "cudaEventRecord"))
    return status;
  return pbf_cuda_check(cudaStreamWaitEvent(leader->stream, s->reached, 0), "cudaStreamWaitEvent");
}

/* The steps of a world's next launch. */
static inline uint32_t next_steps(const solver *s) {
  const uint32_t left = s->put_off.steps;
  const uint32_t ahead = left < SMALL_STEPS ? left : (uint32_t)SMALL_STEPS;
  return pbf_steps_alike(&s->params, s->count, s->schedule.min_volume, &s->put_off.times, ahead);
}

static inline void drop_steps(solver *s, uint32_t steps) {
  s->put_off.steps -= steps;
  s->put_off.times.before += steps;
}

/* One launch of those that a kernel serves; `steps` has how many each is to do. */
static inline pbf_status launch_kind(solver *leader, solver *const *worlds, const uint32_t *steps,
                                     uint32_t count, uint32_t which) {
  world_team *team = leader->team;
  world_upload *upload = &team->uploads[team->turn++ % 2];
  world_layout layout = {0, 0, 0};
  uint64_t stride = 0;
  uint32_t alike = 0, largest = 0;
  for (uint32_t k = 0; k < count; ++k) {
    if (!steps[k] || kernel_of(worlds[k]) != which) continue;
    const uint64_t bytes = record_parts_of(worlds[k], steps[k]).bytes;
    stride = bytes > stride ? bytes : stride;
    largest = worlds[k]->count > largest ? worlds[k]->count : largest;
    layout = layout_for(layout, world_layout_of(worlds[k]));
    ++alike;
  }
  if (!alike) return PBF_OK;
  if (pbf_status status = take_upload(upload, alike * stride)) return status;
  char *host = static_cast<char *>(upload->host), *device = static_cast<char *>(upload->device);
  for (uint32_t k = 0, at = 0; k < count; ++k) {
    if (!steps[k] || kernel_of(worlds[k]) != which) continue;
    write_record(worlds[k], worlds[k]->put_off.times, steps[k], host + at * stride,
                 device + at * stride);
    ++at;
  }
  if (pbf_status status = pbf_cuda_check(
          cudaMemcpyAsync(device, host, alike * stride, cudaMemcpyHostToDevice, leader->stream),
          "cudaMemcpyAsync of the worlds"))
    return status;
  if (pbf_status status =
          pbf_cuda_check(cudaEventRecord(upload->read, leader->stream), "cudaEventRecord"))
    return status;
  return launch_if_built<pbf_real>({leader->stream, (int)(which / 2), (int)(which % 2), device,
                                    alike, (uint32_t)stride, threads_for(largest), layout});
}

/* From here on the leader's stream is where the world's steps are. */
static inline pbf_status gather_world(solver *leader, solver *s) {
  if (pbf_status status = follow_world(leader, s)) return status;
  join_team(s, leader->team);
  cudaStream_t own = s->stream;
  s->stream = leader->stream;
  const pbf_status status = small_order(s);
  s->stream = own;
  s->owned = 0;
  s->works_together = own != leader->stream;
  return status;
}

/* The next launches of some. */
static inline pbf_status launch_part(solver *leader, solver *const *worlds, const uint32_t *steps,
                                     uint32_t count) {
  for (uint32_t which = 0; which < 8; ++which)
    if (pbf_status status = launch_kind(leader, worlds, steps, count, which)) return status;
  for (uint32_t k = 0; k < count; ++k) drop_steps(worlds[k], steps[k]);
  return PBF_OK;
}

static inline pbf_status launch_rounds(solver *leader, solver *const *worlds, uint32_t *steps,
                                       uint32_t count) {
  for (uint32_t k = 0; k < count; ++k)
    if (pbf_status status = gather_world(leader, worlds[k])) return status;
  const uint32_t at_once = leader->multiprocessors * world_blocks(NO_SURFACES);
  /* The device works while the host writes the other records. */
  uint32_t begin = count > 2 * at_once ? at_once : count;
  for (bool some = true; some;) {
    some = false;
    for (uint32_t k = 0; k < count; ++k) {
      steps[k] = worlds[k]->put_off.steps ? next_steps(worlds[k]) : 0;
      some |= steps[k] > 0;
    }
    for (uint32_t first = 0, part = begin; first < count; first += part, part = count - first)
      if (pbf_status status = launch_part(leader, worlds + first, steps + first, part))
        return status;
    begin = count;
  }
  return PBF_OK;
}

/* All that these worlds have put off; what could not be launched stays so. */
static inline pbf_status run_together(solver *leader, solver *const *worlds, uint32_t *steps,
                                      uint32_t count) {
  const pbf_status status = launch_rounds(leader, worlds, steps, count);
  const pbf_status recorded = pbf_cuda_check(cudaEventRecord(leader->team->done, leader->stream),
                                             "cudaEventRecord of the worlds");
  return status != PBF_OK ? status : recorded;
}

#endif
