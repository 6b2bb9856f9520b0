/* Part of scene.h: memory for more colliders than kernels take by value, while there are more.
 */
#ifndef PBF_CUDA_COLLIDER_ROOM_H
#define PBF_CUDA_COLLIDER_ROOM_H

#include "cuda/loads.h"
#include "cuda/population.h"

static inline void free_many_host(solver *s, const pbf_collider_table &table) {
  if (table.room)
    s->allocator.release(s->allocator.user, table.list, many_host_bytes(table.room), PBF_ALIGNMENT);
}

/* ---- Loads ---------------------------------------------------------------------------------- */

/* What has been summed up of solids that are in both. */
static inline pbf_status copy_loads(solver *s, pbf_collider_load *to, const pbf_collider_load *from,
                                    uint32_t solids) {
  return pbf_cuda_check(
      cudaMemcpyAsync(to, from, solids * sizeof *to, cudaMemcpyDeviceToDevice, s->stream),
      "cudaMemcpyAsync of loads");
}

/* A tally for as many as there is room for, with what the one before, or that of few, has. */
static inline pbf_status take_many_loads(solver *s) {
  many_colliders next = s->many;
  void *memory = nullptr;
  next.solids = (int)(PBF_WALLS + s->many.table.room);
  if (pbf_status status = pbf_cuda_take(&s->memory, "loads of many",
                                        pbf_load_tally_bytes(s->many.table.room), &memory))
    return status;
  next.loads = static_cast<pbf_load_tally *>(memory);
  pbf_load_tally there = {};
  there.solids = next.solids;
  there.sums = reinterpret_cast<pbf_load_sums *>(next.loads + 1);
  there.loads = many_loads(next);
  pbf_status status = pbf_cuda_check(
      cudaMemcpyAsync(next.loads, &there, sizeof there, cudaMemcpyHostToDevice, s->stream),
      "cudaMemcpyAsync of a tally");
  if (status == PBF_OK)
    status = copy_loads(s, there.loads, loads_on_device(s), solids_with_loads(s));
  if (status != PBF_OK) {
    pbf_cuda_free(&s->memory, memory);
    return status;
  }
  pbf_cuda_free(&s->memory, s->many.loads);
  s->many = next;
  return PBF_OK;
}

static inline pbf_status keep_many_loads(solver *s, bool wanted) {
  const bool many = are_many(s->many) && wanted;
  if (many && s->many.solids < (int)(PBF_WALLS + s->many.table.room)) return take_many_loads(s);
  if (many || !s->many.loads) return PBF_OK;
  pbf_cuda_free(&s->memory, s->many.loads);
  s->many.loads = nullptr;
  s->many.solids = 0;
  return PBF_OK;
}

/* ---- Room ----------------------------------------------------------------------------------- */

/* What the grid of the last step adds to pressures goes by its colliders; their memory goes. */
static inline pbf_status settle_divided(solver *s) {
  return s->pressure_grid_solids > PBF_FEW_COLLIDERS ? add_weight(s) : PBF_OK;
}

/* Room for so many, and no less than before. */
static inline pbf_status make_room_for(solver *s, uint32_t count) {
  const uint32_t room = pbf_collider_room(count), before = s->many.table.room;
  if (count <= PBF_FEW_COLLIDERS || room <= before) return PBF_OK;
  void *device = nullptr;
  if (pbf_status status = settle_divided(s)) return status;
  char *host = static_cast<char *>(
      s->allocator.allocate(s->allocator.user, many_host_bytes(room), PBF_ALIGNMENT));
  if (!host) {
    s->host->set_error("no host memory for the colliders; fewer of them would do");
    return PBF_ERROR_OUT_OF_MEMORY;
  }
  if (pbf_status status =
          pbf_cuda_take(&s->memory, "many colliders", many_device_bytes(room), &device)) {
    s->allocator.release(s->allocator.user, host, many_host_bytes(room), PBF_ALIGNMENT);
    return status;
  }
  memset(host, 0, many_host_bytes(room));
  const pbf_collider_table table = s->many.table;
  char *steps = s->many.steps;
  place_many(&s->many, &s->basins, host, static_cast<char *>(device), room);
  memcpy(s->many.table.list, s->colliders, s->collider_count * sizeof *s->colliders);
  if (before) {
    memcpy(s->many.table.moving, table.moving, pbf_words_of(before) * sizeof *table.moving);
    pbf_cuda_free(&s->memory, steps);
  }
  s->colliders = s->many.table.list;
  s->moving_obstacles.more = s->many.table.moving;
  s->topology.memory = nullptr;
  note_standing(s);
  free_many_host(s, table); /* last: by a callback that may be left */
  return PBF_OK;
}

/* Where they are few by now. */
static inline pbf_status leave_room_of_many(solver *s) {
  if (!are_many(s->many) || s->collider_count > PBF_FEW_COLLIDERS) return PBF_OK;
  if (pbf_status status = settle_divided(s)) return status;
  if (s->many.loads && s->load_tally)
    if (pbf_status status =
            copy_loads(s, s->load_tally->loads, many_loads(s->many), PBF_FEW_SOLIDS))
      return status;
  memcpy(s->few_colliders, s->colliders, s->collider_count * sizeof *s->colliders);
  s->colliders = s->few_colliders;
  pbf_cuda_free(&s->memory, s->many.loads);
  pbf_cuda_free(&s->memory, s->many.steps);
  const pbf_collider_table table = s->many.table;
  s->many = {};
  s->moving_obstacles.more = nullptr;
  s->topology.memory = nullptr;
  pbf_place_few_basins(&s->basins, &s->basins_memory);
  s->basins.known = 0;
  free_many_host(s, table); /* last, as above */
  return PBF_OK;
}

/* Those of many that have been placed in the fluid, which the host says during the call alone. */
static inline pbf_status upload_placed(solver *s) {
  if (!are_listed(s)) return PBF_OK;
  if (s->found.more_colliders) return upload_set(s, MANY_PLACED, &s->found.more_colliders);
  uint64_t *there = many_set_of(s->many, MANY_PLACED);
  s->found.more_colliders = there;
  return pbf_cuda_check(
      cudaMemsetAsync(there, 0, (pbf_words_of(s->collider_count) - 1) * sizeof *there, s->stream),
      "cudaMemsetAsync");
}

#endif
