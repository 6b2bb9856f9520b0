/* Walls and colliders in a step. A few colliders each thread places for itself; more the threads
 * share out, and one of them then finds which are near which place. */
#ifndef PBF_CPU_PLACING_H
#define PBF_CPU_PLACING_H

#include "cpu/worker.h"

static void place_few(const worker *w, double time, pbf_surface *surfaces, uint16_t *numbers,
                      pbf_obstacles *o) {
  const solver *s = w->s;
  pbf_place_obstacles(&s->params, s->collider_count, s->table.list, s->collider_time, time,
                      s->schedule.close_phases, surfaces, o);
  o->room = numbers;
}

/* Views of what the team places. */
static void view_many(const worker *w, double time, pbf_surface *surfaces, pbf_obstacles *o) {
  solver *s = w->s;
  o->domain = pbf_domain_at(&s->params, time, s->schedule.close_phases);
  o->count = (int)s->collider_count;
  o->surfaces = {surfaces, NULL};
  o->grid = &s->table.grid;
  o->room = s->table.numbers + PBF_OBSTACLE_LISTS * (uint64_t)s->table.room * w->self->thread;
}

enum { COLLIDERS_AT_ONCE = 16 };

static void place_task(void *context, uint32_t task) {
  const worker *w = static_cast<const worker *>(context);
  solver *s = w->s;
  pbf_collider_table *t = &s->table;
  const uint32_t first = task * COLLIDERS_AT_ONCE, left = s->collider_count - first;
  const uint32_t most = COLLIDERS_AT_ONCE, last = first + (left < most ? left : most);
  for (uint32_t k = first; k < last; ++k) {
    t->surfaces[k] = pbf_obstacle_at(&s->params, &w->obstacles.domain, &t->list[k],
                                     w->placed_at - s->collider_time);
    t->grid.boxes[k] = pbf_surface_box_of(&t->surfaces[k]);
    if (w->before.surfaces.all)
      t->before[k] = pbf_obstacle_at(&s->params, &w->before.domain, &t->list[k],
                                     w->begins_at - s->collider_time);
  }
}

static void end_placing(void *context) {
  const worker *w = static_cast<const worker *>(context);
  solver *s = w->s;
  note_still_moving(s, w->begins_at);
  pbf_grid_build(&s->table.grid, s->collider_count, &w->obstacles.domain,
                 pbf_obstacles_reach(&s->params));
}

/* Of the step between two times, and where they are before it where that is wanted. */
static void place_step_obstacles(worker *w, double begin, double end, bool with_before) {
  solver *s = w->s;
  w->moving_obstacles = moving_obstacles_at(s, begin);
  w->placed_at = end;
  w->begins_at = begin;
  if (s->collider_count <= PBF_ASKED_COLLIDERS) {
    place_few(w, end, w->few, w->few_numbers, &w->obstacles);
    if (with_before) place_few(w, begin, w->few_before, w->few_numbers, &w->before);
    return;
  }
  view_many(w, end, s->table.surfaces, &w->obstacles);
  view_many(w, begin, with_before ? s->table.before : NULL, &w->before);
  parallel_for(w->self, (s->collider_count + COLLIDERS_AT_ONCE - 1) / COLLIDERS_AT_ONCE, place_task,
               end_placing, w);
}

#endif
