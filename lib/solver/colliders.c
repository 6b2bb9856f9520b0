/* The colliders of a solver. */
#include "colliders.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "backend_call.h"
#include "collider.h"
#include "collider_places.h"
#include "error.h"
#include "handles.h"
#include "memory.h"
#include "overlap.h"
#include "physics/depenetration.h"
#include "physics/motion.h"
#include "prestabilize.h"
#include "solver_time.h"
#include "structs.h"
#include "text.h"

/* A label is written for what is refused alone: it takes as long as a check. */
static pbf_status check_one(const pbf_solver *solver, const char *name, uint32_t index,
                            const pbf_collider *collider) {
  char label[32];
  pbf_status status = pbf_collider_check(collider, name, solver->kind);
  if (status == PBF_OK) return PBF_OK;
  snprintf(label, sizeof label, "%s[%u]", name, index);
  return pbf_collider_check(collider, label, solver->kind);
}

/* What a caller gives colliders for. */
typedef enum array_use { TO_SET, TO_MOVE } array_use;

static const char *name_of(array_use use) { return use == TO_MOVE ? "targets" : "colliders"; }

/* A target is a pose and sizes: how it would move on is not looked at. */
static void forget_motion(pbf_collider *target) {
  memset(target->velocity, 0, sizeof target->velocity);
  memset(target->angular_velocity, 0, sizeof target->angular_velocity);
  memset(target->half_extents_rate, 0, sizeof target->half_extents_rate);
  target->radius_rate = target->half_length_rate = target->scale_rate = target->duration = 0;
  target->path = PBF_PATH_AUTO;
}

/* *held counts those that have their references. */
static pbf_status copy_in(const pbf_solver *solver, array_use use, uint32_t count,
                          const pbf_collider *theirs, pbf_collider *ours, uint32_t *held) {
  const char *name = name_of(use);
  const uint32_t first = count > 0 ? pbf_struct_size(theirs) : 0;
  for (uint32_t i = 0; i < count; ++i) {
    pbf_status status = pbf_struct_in_array(&pbf_kind_collider, name, theirs, first, i, &ours[i]);
    if (status == PBF_OK) status = pbf_collider_hold(&ours[i], name, i);
    if (status != PBF_OK) return status;
    ++*held;
    if (use == TO_MOVE) forget_motion(&ours[i]);
    status = check_one(solver, name, i, &ours[i]);
    if (status != PBF_OK) return status;
  }
  return PBF_OK;
}

/* A copy of a caller's array, checked and with references of its own. */
static pbf_status take(pbf_solver *solver, array_use use, uint32_t count,
                       const pbf_collider *theirs, pbf_collider **ours) {
  void *memory = NULL;
  uint32_t held = 0;
  pbf_status status = pbf_memory_allocate(&solver->allocator, pbf_colliders_bytes(solver, count),
                                          "the colliders", &memory);
  if (status != PBF_OK) return status;
  if (pbf_collider_words(count) > 0)
    memset(pbf_colliders_marked(solver, count, memory, (enum pbf_collider_mark)0), 0,
           PBF_COLLIDER_MARKS * (uint64_t)pbf_collider_words(count) * sizeof(uint64_t));
  status = copy_in(solver, use, count, theirs, memory, &held);
  *ours = memory;
  if (status == PBF_OK) {
    pbf_colliders_bring(solver, count, *ours);
    return PBF_OK;
  }
  pbf_colliders_let_go(held, memory);
  pbf_memory_free(&solver->allocator, memory, pbf_colliders_bytes(solver, count));
  return status;
}

/* Gives back what was taken for colliders. */
static void drop(pbf_solver *solver, uint32_t count, pbf_collider *colliders) {
  pbf_colliders_bring(solver, 0, NULL);
  if (!colliders) return;
  pbf_colliders_let_go(count, colliders);
  pbf_memory_free(&solver->allocator, colliders, pbf_colliders_bytes(solver, count));
}

pbf_status pbf_colliders_to_backend(pbf_solver *solver, uint32_t count, pbf_collider *colliders,
                                    double time) {
  const int copies = solver->kind.dimension == 2; /* in 3D nothing is ignored */
  pbf_collider *clean = copies && count > 0 ? colliders + count : colliders;
  for (uint32_t i = 0; i < count && copies; ++i) {
    clean[i] = colliders[i];
    pbf_collider_clean(&clean[i], solver->kind.dimension);
  }
  pbf_status status = solver->api.set_colliders(solver->backend, count, clean, time);
  return pbf_backend_result(solver, status, "set_colliders");
}

/* ---- Setting -------------------------------------------------------------------------------- */

pbf_status pbf_colliders_check_count(const pbf_solver *solver, uint32_t count) {
  enum { WITHOUT_EXTENSION = 64 };
  const uint32_t *most =
      solver->api.get_extension ? solver->api.get_extension(PBF_BACKEND_COLLIDERS) : NULL;
  const uint32_t taken = most ? *most : WITHOUT_EXTENSION;
  if (count <= taken) return PBF_OK;
  return pbf_fail(PBF_ERROR_UNSUPPORTED, "the backend \"%s\" takes at most %u colliders, not %u",
                  solver->plugin->name, taken, count);
}

static pbf_status check_array(const pbf_solver *solver, const char *name, uint32_t count,
                              const pbf_collider *colliders) {
  if (count > PBF_MAX_COLLIDERS) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "count is %u; it must be at most %u", count,
                    PBF_MAX_COLLIDERS);
  }
  if (count == 0) return PBF_OK;
  if (!colliders) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s is null", name);
  pbf_status status = pbf_colliders_check_count(solver, count);
  return status == PBF_OK ? pbf_struct_check_out(&pbf_kind_collider, colliders) : status;
}

void pbf_colliders_replace(pbf_solver *solver, uint32_t count, pbf_collider *colliders,
                           double time) {
  const uint32_t count_before = solver->collider_count;
  pbf_collider *before = solver->colliders;
  pbf_colliders_bring(solver, 0, NULL);
  solver->collider_count = 0;
  atomic_signal_fence(memory_order_release); /* never a count of others: a fork may part these */
  solver->colliders = colliders;
  atomic_signal_fence(memory_order_release);
  solver->collider_count = count;
  solver->collider_time = time;
  solver->step_length_checked = 0;
  drop(solver, count_before, before); /* last: by a callback that may be left */
}

/* Of a size that is set anew in each step, as that of a balloon: what its surface then finds, the
 * next step's collision pushes out of it. */
static double most_growth_of(const pbf_solver *solver) {
  return pbf_max_depenetration_speed_of(&solver->params, (int)solver->kind.dimension) *
         solver->params.time_step;
}

static pbf_collider_change change_of(const pbf_solver *solver) {
  const pbf_collider_change change = {pbf_solver_time(solver) - solver->collider_time,
                                      solver->params.smoothing_radius, most_growth_of(solver),
                                      solver->kind.dimension};
  return change;
}

static double length_of(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* Whether it is the one of the same number that goes on. */
static int goes_on(const pbf_collider_places *before, uint32_t k, const pbf_collider *next) {
  double way[3];
  if (k >= before->count) return 0;
  if (pbf_collider_is_surely_near(&before->change, &before->list[k], next)) return 1;
  const double turn = pbf_collider_find_way(&before->change, &before->list[k], next, way);
  return turn + length_of(way) < before->change.near;
}

/* Whether it is one that stood where it is set, *number its number: its own, or else another. */
static int find_one(pbf_solver *solver, pbf_collider_places *before, const pbf_collider *next,
                    uint32_t *number) {
  if (before->count == 0) return 0;
  if (goes_on(before, *number, next)) return 1;
  if (!before->heads)
    pbf_collider_places_build(
        before, pbf_colliders_numbers(solver, solver->collider_count, solver->colliders,
                                      PBF_COLLIDERS_PLACES));
  const uint32_t found = pbf_collider_places_find(before, next);
  if (found < before->count) *number = found;
  return found < before->count;
}

/* The colliders that have been set to other places than their motion has led to. */
typedef struct jumps {
  pbf_collider_set placed, shifted; /* these all farther by the same: */
  double shift[3];
} jumps;

/* Which of those before each is; of those that have been set elsewhere, all of which are placed so
 * far, that of its number. */
static jumps find_before(pbf_solver *solver, pbf_collider_places *before, uint32_t count,
                         pbf_collider *next, uint32_t *numbers) {
  const uint32_t words = pbf_collider_words(count);
  jumps found = {
      {0, words, pbf_colliders_marked(solver, count, next, PBF_COLLIDERS_JUMP_IN)},
      {0, words, pbf_colliders_marked(solver, count, next, PBF_COLLIDERS_JUMP_ALIKE)},
      {0, 0, 0},
  };
  for (uint32_t k = 0; k < count; ++k) {
    numbers[k] = k;
    if (!find_one(solver, before, &next[k], &numbers[k])) pbf_collider_set_add(&found.placed, k);
  }
  return found;
}

static void choose_paths(const pbf_collider_places *before, uint32_t count, const uint32_t *numbers,
                         pbf_collider *next) {
  for (uint32_t k = 0; k < count; ++k) {
    const pbf_collider *was = numbers[k] < before->count ? &before->list[numbers[k]] : NULL;
    if (next[k].path != PBF_PATH_AUTO) continue;
    next[k].path = !was || was->shape != next[k].shape
                       ? (uint32_t)PBF_PATH_STRAIGHT
                       : pbf_collider_path_after(was, before->change.elapsed, &next[k]);
  }
}

/* How each has come to where it is set; what is placed there has only the velocities it is given.
 */
static void note_last_velocities(const pbf_solver *solver, uint32_t count, const uint32_t *numbers,
                                 const pbf_collider_set *placed, pbf_collider *next) {
  const double elapsed = pbf_solver_time(solver) - solver->collider_time;
  for (uint32_t k = 0; k < count; ++k) {
    pbf_collider *now = &next[k];
    const uint32_t was = numbers ? numbers[k] : k;
    if (was < solver->collider_count && !(placed && pbf_collider_set_has(placed, k))) {
      pbf_motion_last_velocities(&solver->colliders[was], elapsed, solver->params.time_step,
                                 now->position, now->last_velocity, now->last_angular_velocity);
    } else {
      memcpy(now->last_velocity, now->velocity, sizeof now->velocity);
      memcpy(now->last_angular_velocity, now->angular_velocity, sizeof now->angular_velocity);
    }
  }
}

/* Of those that have been set elsewhere some may have been shifted alike, with the world's origin.
 */
static void find_shift(const pbf_collider_places *before, uint32_t count, const pbf_collider *next,
                       jumps *found) {
  int any = 0;
  for (uint32_t k = 0; k < count; ++k) {
    if (!pbf_collider_set_has(&found->placed, k)) continue;
    const pbf_collider *was = k < before->count ? &before->list[k] : NULL;
    double way[3];
    const double turn = pbf_collider_find_way(&before->change, was, &next[k], way);
    if (!any) memcpy(found->shift, way, sizeof way);
    for (int a = 0; a < 3; ++a) way[a] -= found->shift[a];
    if (turn + length_of(way) >= before->change.near) continue;
    any = 1;
    pbf_collider_set_remove(&found->placed, k);
    pbf_collider_set_add(&found->shifted, k);
  }
}

/* What the solver has noted of its colliders goes on with those that take their place; `numbers`:
 * which of them each was, null: that of its own number. The first word of what is noted is told. */
static uint64_t carried(const pbf_solver *solver, uint64_t first, enum pbf_collider_mark mark,
                        uint32_t count, const uint32_t *numbers, pbf_collider *next) {
  const pbf_collider_set before = pbf_colliders_set(solver, first, mark);
  pbf_collider_set after = {0, pbf_collider_words(count),
                            pbf_colliders_marked(solver, count, next, mark)};
  const uint32_t looked_at = pbf_collider_set_is_empty(&before) ? 0 : count;
  for (uint32_t k = 0; k < looked_at; ++k) {
    const uint32_t number = numbers ? numbers[k] : k;
    if (number < solver->collider_count && pbf_collider_set_has(&before, number))
      pbf_collider_set_add(&after, k);
  }
  return after.first;
}

static void keep_marks(pbf_solver *solver, uint32_t count, const uint32_t *numbers,
                       pbf_collider *next) {
  uint64_t *placed = &solver->overlap.found.colliders, *shifted = &solver->placement.colliders;
  *placed = carried(solver, *placed, PBF_COLLIDERS_PLACED, count, numbers, next);
  *shifted = carried(solver, *shifted, PBF_COLLIDERS_SHIFTED, count, numbers, next);
}

/* Checked ones, with poses that hold now, for the backend and then for the solver, which owns them
 * from then on. */
static pbf_status put_in_place(pbf_solver *solver, uint32_t count, const uint32_t *numbers,
                               pbf_collider *colliders) {
  const double now = pbf_solver_time(solver);
  pbf_status status = pbf_colliders_to_backend(solver, count, colliders, now);
  if (status == PBF_OK) {
    keep_marks(solver, count, numbers, colliders);
    pbf_colliders_replace(solver, count, colliders, now);
  } else {
    drop(solver, count, colliders);
  }
  return status;
}

static pbf_status set_colliders(pbf_solver *solver, uint32_t count, const pbf_collider *theirs) {
  pbf_collider *memory = NULL;
  pbf_status status = check_array(solver, "colliders", count, theirs);
  if (status == PBF_OK && count > 0) status = take(solver, TO_SET, count, theirs, &memory);
  if (status != PBF_OK) return status;
  pbf_collider_places before = {solver->colliders, solver->collider_count, change_of(solver), NULL,
                                NULL};
  uint32_t *numbers =
      count > 0 ? pbf_colliders_numbers(solver, count, memory, PBF_COLLIDERS_BEFORE) : NULL;
  jumps found = find_before(solver, &before, count, memory, numbers);
  find_shift(&before, count, memory, &found);
  choose_paths(&before, count, numbers, memory);
  note_last_velocities(solver, count, numbers, &found.placed, memory);
  status = put_in_place(solver, count, numbers, memory);
  if (status != PBF_OK) return status;
  pbf_overlap_note_colliders(solver, &found.placed);
  pbf_note_collider_shift(solver, &found.shifted, found.shift);
  return PBF_OK;
}

pbf_status pbf_set_colliders(pbf_solver *solver, uint32_t count, const pbf_collider *colliders) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, set_colliders(solver, count, colliders));
}

/* ---- Moving --------------------------------------------------------------------------------- */

/* As it stands and moves now, without what the dimension ignores. */
static void find_present(const pbf_solver *solver, uint32_t index, pbf_collider *now) {
  const double elapsed = pbf_solver_time(solver) - solver->collider_time;
  const uint32_t dimension = solver->kind.dimension;
  if (dimension == 2) {
    pbf_collider moving = solver->colliders[index];
    pbf_collider_clean(&moving, dimension);
    pbf_motion_collider_state(&moving, elapsed, now);
    pbf_collider_clean(now, dimension);
  } else {
    pbf_motion_collider_state(&solver->colliders[index], elapsed, now);
  }
}

static pbf_status check_target(const pbf_collider *collider, const pbf_collider *target,
                               uint32_t index, uint32_t dimension) {
  const char *what = NULL;
  if (target->shape != collider->shape) what = "shape";
  if (target->inverted != collider->inverted) what = "inverted";
  if (target->geometry != collider->geometry) what = "geometry";
  if (pbf_collider_has_axis(collider) &&
      memcmp(target->axis, collider->axis, dimension * sizeof target->axis[0]) != 0)
    what = "axis";
  if (!what) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "targets[%u].%s is not that of collider %u; pbf_set_colliders changes it", index,
                  what, index);
}

/* A way that is so far, or so short a time, that its velocities are more than one may set. */
static pbf_status check_way(const pbf_solver *solver, const pbf_collider *moving, uint32_t index,
                            double duration) {
  pbf_status status = pbf_collider_check_moving(moving, "the collider", solver->kind);
  if (status == PBF_OK) return status;
  return pbf_fail(status, "targets[%u] can't be reached in a duration of %.9g: on the way %.1500s",
                  index, duration, pbf_last_error());
}

static pbf_status aim(const pbf_solver *solver, uint32_t count, double duration,
                      pbf_collider *targets) {
  const uint32_t dimension = solver->kind.dimension;
  for (uint32_t i = 0; i < count; ++i) {
    pbf_collider moving;
    pbf_collider_clean(&targets[i], dimension);
    pbf_status status = check_target(&solver->colliders[i], &targets[i], i, dimension);
    if (status != PBF_OK) return status;
    find_present(solver, i, &moving);
    pbf_motion_towards(&moving, &targets[i], duration);
    status = check_way(solver, &moving, i, duration);
    if (status != PBF_OK) return status;
    targets[i] = moving;
  }
  return PBF_OK;
}

static pbf_status check_move(const pbf_solver *solver, uint32_t count, const pbf_collider *targets,
                             double duration) {
  char number[PBF_NUMBER_SIZE];
  if (count != solver->collider_count) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "count is %u; the solver has %u colliders", count,
                    solver->collider_count);
  }
  if (!(duration > 0 && isfinite(duration))) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "duration is %s; it must be a time above 0, and finite",
                    pbf_text_number(number, duration));
  }
  return check_array(solver, "targets", count, targets);
}

static pbf_status move_colliders(pbf_solver *solver, uint32_t count, const pbf_collider *theirs,
                                 double duration) {
  pbf_collider *memory = NULL;
  pbf_status status = check_move(solver, count, theirs, duration);
  if (status != PBF_OK || count == 0) return status;
  status = take(solver, TO_MOVE, count, theirs, &memory);
  if (status != PBF_OK) return status;
  status = aim(solver, count, duration, memory);
  if (status == PBF_OK) note_last_velocities(solver, count, NULL, NULL, memory);
  if (status == PBF_OK) return put_in_place(solver, count, NULL, memory);
  drop(solver, count, memory);
  return status;
}

pbf_status pbf_move_colliders(pbf_solver *solver, uint32_t count, const pbf_collider *targets,
                              double duration) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, move_colliders(solver, count, targets, duration));
}

/* ---- Asking --------------------------------------------------------------------------------- */

pbf_status pbf_get_collider_count(pbf_solver *solver, uint32_t *count) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, pbf_count_out(solver->collider_count, count));
}

/* What 2D ignores is as it was set. */
static void restore_ignored(const pbf_collider *at_set, pbf_collider *now) {
  now->position[2] = at_set->position[2];
  now->velocity[2] = at_set->velocity[2];
  now->axis[2] = at_set->axis[2];
  now->half_extents[2] = at_set->half_extents[2];
  now->half_extents_rate[2] = at_set->half_extents_rate[2];
  for (int k = 0; k < 2; ++k) now->angular_velocity[k] = at_set->angular_velocity[k];
}

static pbf_status get_collider(const pbf_solver *solver, uint32_t index, pbf_collider *theirs) {
  pbf_status status = pbf_struct_check_out(&pbf_kind_collider, theirs);
  if (status != PBF_OK) return status;
  if (index >= solver->collider_count) {
    return pbf_fail(PBF_ERROR_NOT_FOUND, "index is %u; the solver has %u colliders", index,
                    solver->collider_count);
  }
  pbf_collider now;
  find_present(solver, index, &now);
  if (solver->kind.dimension == 2) restore_ignored(&solver->colliders[index], &now);
  pbf_struct_out(&pbf_kind_collider, &now, theirs, theirs->struct_size);
  return PBF_OK;
}

pbf_status pbf_get_collider(pbf_solver *solver, uint32_t index, pbf_collider *collider) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, get_collider(solver, index, collider));
}
