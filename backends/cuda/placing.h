/* Part of launches.h: where colliders stand in the steps to come, on the device. */
#ifndef PBF_CUDA_PLACING_H
#define PBF_CUDA_PLACING_H

#include "cuda/solver.h"
#include "physics/adhesion.h"
#include "physics/no_slip.h"

/* Steps that they are placed for at once. */
static inline uint32_t steps_ahead(const solver *s) {
  return are_many(s->many) ? (uint32_t)MANY_STEPS_AHEAD : (uint32_t)STEPS_AHEAD;
}

/* Those of the k-th of these. */
static inline pbf_surface *surfaces_of_step(const solver *s, uint32_t k) {
  if (!are_many(s->many)) return s->surfaces + k * s->collider_count;
  return reinterpret_cast<pbf_surface *>(s->many.steps +
                                         (s->many.stand ? 0 : k) * s->many.layout.bytes);
}

/* At `end`, to `placed`. */
static inline void place_at(const solver *s, double end, pbf_surface *placed) {
  const pbf_domain domain = pbf_domain_at(&s->params, end);
  for (uint32_t c = 0; c < s->collider_count; ++c)
    placed[c] = pbf_obstacle_at(&s->params, &domain, &s->colliders[c], end - s->collider_time);
}

/* On the device they are of the device's shapes. */
static inline void take_fields(const solver *s, pbf_surface *placed) {
  for (uint32_t c = 0; c < s->collider_count && s->shapes.count; ++c)
    placed[c].field = shape_on_device(s->shapes, placed[c].field_id);
}

/* What colliders are beside surfaces, to a step's block. */
static inline void stage_scales(const solver *s, char *block) {
  const many_layout &of = s->many.layout;
  pbf_friction *friction = reinterpret_cast<pbf_friction *>(block + of.friction);
  pbf_real *adhesion = reinterpret_cast<pbf_real *>(block + of.adhesion);
  pbf_real *no_slip = reinterpret_cast<pbf_real *>(block + of.no_slip);
  const pbf_solid_friction frictions = {
      pbf_friction_of(s->params.wall_friction, s->params.wall_static_friction), s->colliders};
  const pbf_solid_adhesion adhesions = {(pbf_real)s->params.wall_adhesion, s->colliders};
  for (uint32_t solid = 0; solid < PBF_WALLS + s->collider_count; ++solid) {
    friction[solid] = frictions[(int)solid];
    adhesion[solid] = adhesions[(int)solid];
  }
  for (uint32_t c = 0; c < s->collider_count; ++c) no_slip[c] = (pbf_real)s->colliders[c].no_slip;
}

/* What the surfaces at the beginning of a block are asked by, which is to be `on_device`. */
static inline void stage_scene(solver *s, double end, char *block, char *on_device) {
  const many_layout &of = s->many.layout;
  const pbf_surface *placed = reinterpret_cast<const pbf_surface *>(block);
  const pbf_domain domain = pbf_domain_at(&s->params, end);
  pbf_surface_grid grid = {};
  grid.room = s->many.table.room;
  grid.finer = MANY_FINER;
  grid.boxes = s->many.table.grid.boxes;
  grid.starts = reinterpret_cast<uint32_t *>(block + of.starts);
  grid.entries = reinterpret_cast<uint16_t *>(block + of.entries);
  for (uint32_t c = 0; c < s->collider_count; ++c) grid.boxes[c] = pbf_surface_box_of(&placed[c]);
  pbf_grid_build(&grid, s->collider_count, &domain, pbf_obstacles_reach(&s->params));
  listed_scene there = {grid, domain, s->constants};
  there.grid.starts = reinterpret_cast<uint32_t *>(on_device + of.starts);
  there.grid.entries = reinterpret_cast<uint16_t *>(on_device + of.entries);
  there.grid.boxes = nullptr;
  memcpy(block + s->collider_count * sizeof(pbf_surface), &there, sizeof there);
}

/* More than kernels take by value. Those that stand stay placed. */
static inline pbf_status place_many_surfaces(solver *s, const pbf_step_times &times,
                                             uint32_t steps) {
  many_colliders &m = s->many;
  if (m.stand && m.placed) return PBF_OK;
  const uint32_t placed = m.stand ? 1 : steps;
  m.placed = false;
  for (uint32_t k = 0; k < placed; ++k) {
    char *block = m.staging + k * m.layout.bytes;
    const double end = pbf_time_after(&times, k + 1);
    pbf_surface *surfaces = reinterpret_cast<pbf_surface *>(block);
    place_at(s, end, surfaces);
    stage_scene(s, end, block, m.steps + k * m.layout.bytes);
    take_fields(s, surfaces);
    stage_scales(s, block);
  }
  /* From pageable memory, which the copy has read when it returns. */
  pbf_status status = pbf_cuda_check(cudaMemcpyAsync(m.steps, m.staging, placed * m.layout.bytes,
                                                     cudaMemcpyHostToDevice, s->stream),
                                     "cudaMemcpyAsync of the colliders");
  m.placed = status == PBF_OK;
  return status;
}

/* The colliders, few, at the ends of `steps` steps. */
static inline void write_surfaces(const solver *s, const pbf_step_times &times, uint32_t steps,
                                  pbf_surface *placed) {
  for (uint32_t k = 0; k < steps; ++k) {
    place_at(s, pbf_time_after(&times, k + 1), placed + k * s->collider_count);
    take_fields(s, placed + k * s->collider_count);
  }
}

/* Places the colliders for the ends of `steps` steps, and uploads them in one go. */
static inline pbf_status place_surfaces(solver *s, const pbf_step_times &times, uint32_t steps) {
  if (are_many(s->many)) return place_many_surfaces(s, times, steps);
  uint64_t bytes = (uint64_t)steps * s->collider_count * sizeof(pbf_surface);
  if (!bytes) return PBF_OK;
  pbf_surface *placed = static_cast<pbf_surface *>(
      s->allocator.allocate(s->allocator.user, bytes, alignof(pbf_surface)));
  if (!placed) {
    pbf_cuda_host->set_error("no host memory to place the colliders; fewer of them would do");
    return PBF_ERROR_OUT_OF_MEMORY;
  }
  write_surfaces(s, times, steps, placed);
  /* From pageable memory, which the copy has read when it returns. */
  pbf_status status =
      pbf_cuda_check(cudaMemcpyAsync(s->surfaces, placed, bytes, cudaMemcpyHostToDevice, s->stream),
                     "cudaMemcpyAsync of the colliders");
  s->allocator.release(s->allocator.user, placed, bytes, alignof(pbf_surface));
  return status;
}

/* … and for one moment. */
static inline pbf_status place_surfaces(solver *s, double time) {
  return place_surfaces(s, {time, 0, 0}, 1);
}

/* Whether they stand, which they are placed anew for: after any change of what they follow from. */
static inline void note_standing(solver *s) {
  if (!are_many(s->many)) return;
  const pbf_moving_obstacles moving = pbf_moving_obstacles_of(
      &s->params, s->collider_count, s->colliders, s->many.table.still_moving);
  s->many.stand = !pbf_any_obstacle_moves(moving);
  s->many.placed = false;
}

#endif
