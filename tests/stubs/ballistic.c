/* The smallest backend that keeps every rule of the plugin ABI: particles fall. Exports, beside the
 * entry point, the switches of ballistic.h. */
#include "ballistic.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pbf/pbf_backend.h>

#if defined(_WIN32)
#include <malloc.h>
#define ALIGNED_ALLOC(alignment, size) _aligned_malloc(size, alignment)
#define ALIGNED_FREE(memory) _aligned_free(memory)
#else
#define ALIGNED_ALLOC(alignment, size) aligned_alloc(alignment, size)
#define ALIGNED_FREE(memory) free(memory)
#endif

#ifndef STUB_NAME
#define STUB_NAME "ballistic"
#endif
#ifndef STUB_SCORE
#define STUB_SCORE 1
#endif

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

EXPORT ballistic_control stub_control;

static const pbf_backend_host *host;

struct pbf_backend_solver {
  pbf_backend_desc desc;
  pbf_params params;
  uint32_t count;
  uint32_t *ids;
  unsigned char *positions;
  unsigned char *velocities;
  unsigned char *accelerations; /* null: there are none */
  uint32_t puts_off, noted;     /* steps may wait; those that do */
};

static pbf_status fail(pbf_status status, const char *sentence) {
  host->set_error(sentence);
  return status;
}

/* Every call that may fail asks here first. */
static pbf_status ordered_failure(void) {
  if (stub_control.calls_until_failure == 0 || --stub_control.calls_until_failure != 0)
    return PBF_OK;
  if (!stub_control.failure_is_silent) host->set_error("the test ordered this failure");
  if (stub_control.failure_is_silent == 2) host->set_error("\xe2\x82");
  return stub_control.failure_status;
}

static uint64_t row_bytes(const pbf_backend_solver *s) {
  return (uint64_t)s->desc.dimension * s->desc.precision;
}

static double get(const pbf_backend_solver *s, const unsigned char *array, uint32_t row,
                  uint32_t axis) {
  const unsigned char *at = array + row * row_bytes(s) + axis * s->desc.precision;
  float single;
  double value;
  if (s->desc.precision == PBF_FLOAT64) {
    memcpy(&value, at, sizeof value);
    return value;
  }
  memcpy(&single, at, sizeof single);
  return single;
}

static void put(const pbf_backend_solver *s, unsigned char *array, uint32_t row, uint32_t axis,
                double value) {
  unsigned char *at = array + row * row_bytes(s) + axis * s->desc.precision;
  float single = (float)value;
  if (s->desc.precision == PBF_FLOAT64) {
    memcpy(at, &value, sizeof value);
  } else {
    memcpy(at, &single, sizeof single);
  }
}

static void *take(const pbf_allocator *allocator, uint64_t size) {
  return allocator->allocate(allocator->user, size, 64);
}

static void give(const pbf_allocator *allocator, void *memory, uint64_t size) {
  if (memory) allocator->release(allocator->user, memory, size, 64);
}

static uint64_t id_bytes(const pbf_backend_solver *s) { return (uint64_t)s->desc.capacity * 4; }
static uint64_t field_bytes(const pbf_backend_solver *s) { return s->desc.capacity * row_bytes(s); }

static void destroy(pbf_backend_solver *s) {
  pbf_allocator allocator = s->desc.allocator;
  give(&allocator, s->ids, id_bytes(s));
  give(&allocator, s->positions, field_bytes(s));
  give(&allocator, s->velocities, field_bytes(s));
  give(&allocator, s->accelerations, field_bytes(s));
  give(&allocator, s, sizeof *s);
}

static const pbf_backend_api table;

static void lie_about_creation(pbf_backend_solver **solver, const pbf_backend_api **api) {
  static pbf_backend_api bad;
  if (stub_control.lie < BALLISTIC_NO_SOLVER || stub_control.lie > BALLISTIC_BAD_TABLE) return;
  destroy(*solver); /* so that the lie leaks nothing */
  if (stub_control.lie == BALLISTIC_NO_SOLVER) *solver = NULL;
  if (stub_control.lie == BALLISTIC_NO_TABLE) *api = NULL;
  if (stub_control.lie == BALLISTIC_BAD_TABLE) {
    bad = table;
    bad.read = NULL;
    *api = &bad;
  }
}

static pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                         pbf_backend_solver **solver, const pbf_backend_api **api) {
  pbf_status status = ordered_failure();
  if (status != PBF_OK) return status;
  pbf_backend_solver *s = take(&desc->allocator, sizeof *s);
  if (!s) return fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for the stub");
  memset(s, 0, sizeof *s);
  s->desc = *desc;
  __atomic_store_n(&stub_control.worlds, desc->worlds, __ATOMIC_RELAXED);
  s->params = *params;
  s->ids = take(&desc->allocator, id_bytes(s));
  s->positions = take(&desc->allocator, field_bytes(s));
  s->velocities = take(&desc->allocator, field_bytes(s));
  if (!s->ids || !s->positions || !s->velocities) {
    destroy(s);
    return fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for the stub's particles");
  }
  *solver = s;
  *api = &table;
  lie_about_creation(solver, api);
  return PBF_OK;
}

static void probe(const pbf_workload *workload, pbf_probe_result *result) {
  (void)workload;
  result->score = STUB_SCORE;
  result->device_type = PBF_DEVICE_CPU;
  snprintf(result->device_name, sizeof result->device_name, "a stub");
#if STUB_SCORE == 0
  snprintf(result->reason, sizeof result->reason, "the stub's probe always fails");
#endif
}

/* Symplectic Euler, as the predict stage has it. */
static void fall(pbf_backend_solver *s) {
  double dt = s->params.time_step;
  for (uint32_t row = 0; row < s->count; ++row) {
    for (uint32_t axis = 0; axis < s->desc.dimension; ++axis) {
      double a = s->accelerations ? get(s, s->accelerations, row, axis) : 0;
      double v = get(s, s->velocities, row, axis) + dt * (a + s->params.gravity[axis]);
      put(s, s->velocities, row, axis, v);
      put(s, s->positions, row, axis, get(s, s->positions, row, axis) + dt * v);
    }
  }
}

/* Before whatever else is done to the solver. */
static void settle(pbf_backend_solver *s) {
  for (; s->noted; --s->noted) fall(s);
}

static pbf_status set_params(pbf_backend_solver *s, const pbf_params *params) {
  pbf_status status = ordered_failure();
  settle(s);
  if (status == PBF_OK) s->params = *params;
  return status;
}

static pbf_status set_colliders(pbf_backend_solver *s, uint32_t count,
                                const pbf_collider *colliders, double time) {
  (void)s, (void)count, (void)colliders, (void)time;
  return ordered_failure();
}

static pbf_status step(pbf_backend_solver *s, double time, uint64_t before, uint32_t steps,
                       uint32_t *done) {
  (void)time, (void)before;
  if (steps == 0) return ordered_failure();
  if (s->puts_off) {
    pbf_status status = ordered_failure();
    *done = status == PBF_OK ? steps : 0;
    s->noted += *done;
    return status;
  }
  settle(s);
  for (*done = 0; *done < steps; ++*done) {
    pbf_status status = ordered_failure();
    if (status != PBF_OK) return status;
    if (stub_control.inside_step) stub_control.inside_step(stub_control.user);
    fall(s);
  }
  if (stub_control.lie == BALLISTIC_TOO_MANY_STEPS) *done = steps + 1;
  if (stub_control.lie == BALLISTIC_TOO_FEW_STEPS) *done = steps - 1;
  return PBF_OK;
}

static pbf_status synchronize(pbf_backend_solver *s) {
  settle(s);
  return ordered_failure();
}

/* ---- Worlds together ---- */

static void put_off(pbf_backend_solver *s, uint32_t on) { s->puts_off = on; }

static pbf_status run(pbf_backend_solver *const *worlds, uint32_t count) {
  pbf_status status = ordered_failure();
  ++stub_control.runs;
  stub_control.run_worlds = 0;
  for (uint32_t k = 0; k < count && status == PBF_OK; ++k) {
    stub_control.run_worlds += worlds[k]->noted > 0;
    settle(worlds[k]);
  }
  return status;
}

static const void *get_extension(const char *name) {
  static const pbf_backend_worlds together = {sizeof together, 0, put_off, run};
  return stub_control.steps_together && strcmp(name, PBF_BACKEND_WORLDS) == 0 ? &together : NULL;
}

static pbf_status add_particles(pbf_backend_solver *s, const pbf_particles *particles) {
  pbf_status status = ordered_failure();
  if (status != PBF_OK) return status;
  settle(s);
  uint64_t bytes = particles->count * row_bytes(s);
  memcpy(s->ids + s->count, particles->ids, (uint64_t)particles->count * 4);
  memcpy(s->positions + s->count * row_bytes(s), particles->positions, bytes);
  memset(s->velocities + s->count * row_bytes(s), 0, bytes);
  if (particles->velocities)
    memcpy(s->velocities + s->count * row_bytes(s), particles->velocities, bytes);
  if (s->accelerations) memset(s->accelerations + s->count * row_bytes(s), 0, bytes);
  s->count += particles->count;
  return PBF_OK;
}

static pbf_status set_accelerations(pbf_backend_solver *s, uint32_t on) {
  pbf_status status = ordered_failure();
  if (status != PBF_OK) return status;
  settle(s);
  if (!on) {
    give(&s->desc.allocator, s->accelerations, field_bytes(s));
    s->accelerations = NULL;
    return PBF_OK;
  }
  s->accelerations = take(&s->desc.allocator, field_bytes(s));
  if (!s->accelerations) return fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for accelerations");
  memset(s->accelerations, 0, field_bytes(s));
  return PBF_OK;
}

static void move_row(pbf_backend_solver *s, uint32_t to, uint32_t from) {
  s->ids[to] = s->ids[from];
  memmove(s->positions + to * row_bytes(s), s->positions + from * row_bytes(s), row_bytes(s));
  memmove(s->velocities + to * row_bytes(s), s->velocities + from * row_bytes(s), row_bytes(s));
  if (s->accelerations)
    memmove(s->accelerations + to * row_bytes(s), s->accelerations + from * row_bytes(s),
            row_bytes(s));
}

static pbf_status remove_particles(pbf_backend_solver *s, uint32_t count, const uint32_t *ids) {
  pbf_status status = ordered_failure();
  if (status != PBF_OK) return status;
  settle(s);
  uint32_t kept = 0, next = 0;
  for (uint32_t row = 0; row < s->count; ++row) {
    if (next < count && s->ids[row] == ids[next]) {
      ++next;
    } else {
      move_row(s, kept++, row);
    }
  }
  s->count = kept;
  return PBF_OK;
}

static pbf_status remove_all(pbf_backend_solver *s) {
  pbf_status status = ordered_failure();
  if (status == PBF_OK) s->count = 0;
  return status;
}

static unsigned char *field_of(const pbf_backend_solver *s, uint32_t field) {
  if (field == PBF_BACKEND_FIELD_ACCELERATION) return s->accelerations;
  return field == PBF_FIELD_POSITION ? s->positions : s->velocities;
}

/* The rows' ids must be what the host says, or the test has found a defect in the host. */
static pbf_status check_rows(pbf_backend_solver *s, const pbf_rows *rows) {
  settle(s);
  if (rows->total != s->count) return fail(PBF_ERROR_PLUGIN, "the host's total is wrong");
  for (uint32_t i = 0; i < s->count; ++i) {
    if (s->ids[i] != (rows->ids ? rows->ids[i] : i))
      return fail(PBF_ERROR_PLUGIN, "the host's ids are wrong");
  }
  return ordered_failure();
}

static pbf_status read(pbf_backend_solver *s, uint32_t field, const pbf_rows *rows, void *out) {
  pbf_status status = check_rows(s, rows);
  if (status != PBF_OK) return status;
  if (field == PBF_FIELD_DENSITY) {
    for (uint32_t i = 0; i < rows->count; ++i) {
      if (s->desc.precision == PBF_FLOAT64) {
        ((double *)out)[i] = 1;
      } else {
        ((float *)out)[i] = 1;
      }
    }
    return PBF_OK;
  }
  memcpy(out, field_of(s, field) + rows->first * row_bytes(s), rows->count * row_bytes(s));
  return PBF_OK;
}

/* ---- What would stay on a device ---- */

static pbf_status take_array(pbf_backend_solver *s, uint64_t bytes, pbf_backend_array *array) {
  enum { ALIGNED = 64 };
  (void)s;
  pbf_status status = ordered_failure();
  if (status != PBF_OK) return status;
  array->data = ALIGNED_ALLOC(ALIGNED, (bytes + ALIGNED - 1) / ALIGNED * ALIGNED);
  if (!array->data) return fail(PBF_ERROR_OUT_OF_MEMORY, "no memory for the stub's array");
  array->device_type = PBF_DEVICE_CPU;
  ++stub_control.arrays;
  return PBF_OK;
}

static void release_array(const pbf_backend_array *array) {
  --stub_control.arrays;
  ALIGNED_FREE(array->data);
}

static pbf_status read_array(pbf_backend_solver *s, uint32_t field, const pbf_rows *rows,
                             uint32_t room, void *data) {
  pbf_status status = ordered_failure();
  if (status != PBF_OK) return status;
  memset((char *)data + rows->count * row_bytes(s), 0, (room - rows->count) * row_bytes(s));
  return rows->count ? read(s, field, rows, data) : PBF_OK;
}

static double number_at(const pbf_backend_solver *s, const unsigned char *values, uint64_t index) {
  return s->desc.precision == PBF_FLOAT64 ? ((const double *)(const void *)values)[index]
                                          : ((const float *)(const void *)values)[index];
}

static int is_in_any(const pbf_backend_solver *s, uint32_t row, uint32_t count,
                     const pbf_backend_box *boxes) {
  for (uint32_t b = 0; b < count; ++b) {
    int inside = 1;
    for (uint32_t k = 0; k < s->desc.dimension; ++k) {
      const double x = number_at(s, s->positions, (uint64_t)row * s->desc.dimension + k);
      inside &= x >= boxes[b].lower[k] && x <= boxes[b].upper[k];
    }
    if (inside) return 1;
  }
  return 0;
}

/* The last ones first, as the host may not go by any order. */
static pbf_status find_in_boxes(pbf_backend_solver *s, uint32_t count, const pbf_backend_box *boxes,
                                pbf_backend_found *found) {
  const uint64_t bytes = row_bytes(s);
  pbf_status status = ordered_failure();
  if (status != PBF_OK) return status;
  settle(s);
  found->count = 0;
  for (uint32_t row = s->count; row-- > 0;) {
    if (!is_in_any(s, row, count, boxes)) continue;
    if (found->count < found->room) {
      found->ids[found->count] = s->ids[row];
      memcpy((char *)found->positions + found->count * bytes, s->positions + row * bytes, bytes);
      memcpy((char *)found->velocities + found->count * bytes, s->velocities + row * bytes, bytes);
    }
    ++found->count;
  }
  if (stub_control.lie == BALLISTIC_FOUND_COUNT) found->count = s->count + 1;
  return PBF_OK;
}

static pbf_status write(pbf_backend_solver *s, uint32_t field, const pbf_rows *rows,
                        const void *in) {
  pbf_status status = check_rows(s, rows);
  if (status != PBF_OK) return status;
  memcpy(field_of(s, field) + rows->first * row_bytes(s), in, rows->count * row_bytes(s));
  return PBF_OK;
}

static void lie_about_view(pbf_view *view) {
  ballistic_lie lie = stub_control.lie;
  if (lie == BALLISTIC_VIEW_COUNT) view->count += 1;
  if (lie == BALLISTIC_VIEW_FIELD) view->field += 1;
  if (lie == BALLISTIC_VIEW_TYPE) view->element_type = 5;
  if (lie == BALLISTIC_VIEW_COMPONENTS) view->components = 7;
  if (lie == BALLISTIC_VIEW_DEVICE) view->device_type = 99;
  if (lie == BALLISTIC_VIEW_NO_DATA) view->data = NULL;
  if (lie == BALLISTIC_VIEW_NO_IDS) view->ids = NULL;
  if (lie == BALLISTIC_VIEW_ODD_STRIDE) view->particle_stride += 1;
}

static pbf_status map(pbf_backend_solver *s, uint32_t field, pbf_view *view) {
  pbf_status status = ordered_failure();
  if (status != PBF_OK) return status;
  settle(s);
  int is_id = field == PBF_FIELD_ID;
  view->device_type = PBF_DEVICE_CPU;
  view->element_type = is_id ? PBF_TYPE_UINT32 : s->desc.precision;
  view->components = is_id ? 1 : s->desc.dimension;
  view->count = s->count;
  view->component_stride = is_id ? 4 : (int64_t)s->desc.precision;
  view->particle_stride = view->components * view->component_stride;
  view->data = is_id ? (const void *)s->ids : field_of(s, field);
  view->ids = s->ids;
  lie_about_view(view);
  return PBF_OK;
}

static pbf_status get_stats(pbf_backend_solver *s, pbf_stats *stats) {
  pbf_status status = ordered_failure();
  stats->count = s->count + (stub_control.lie == BALLISTIC_STATS_COUNT);
  return status;
}

static void add_array(pbf_plan *plan, const pbf_backend_solver *s, const char *name,
                      uint64_t bytes) {
  pbf_plan_array *array = &plan->arrays[plan->array_count++];
  snprintf(array->name, sizeof array->name, "%s", name);
  array->bytes = bytes;
  array->bytes_per_particle = (double)bytes / s->desc.capacity;
  plan->bytes += bytes;
  plan->bytes_per_particle += array->bytes_per_particle;
}

static pbf_status get_plan(pbf_backend_solver *s, pbf_plan *plan) {
  pbf_status status = ordered_failure();
  plan->stage_count = 1;
  snprintf(plan->stages[0].name, PBF_NAME_SIZE, "fall");
  plan->stages[0].runs_per_step = 1;
  plan->bytes = sizeof *s;
  add_array(plan, s, "ids", id_bytes(s));
  add_array(plan, s, "positions", field_bytes(s));
  add_array(plan, s, "velocities", field_bytes(s));
  if (s->accelerations) add_array(plan, s, "accelerations", field_bytes(s));
  if (stub_control.lie == BALLISTIC_STAGE_COUNT) plan->stage_count = PBF_MAX_STAGES + 1;
  if (stub_control.lie == BALLISTIC_ARRAY_COUNT) plan->array_count = PBF_MAX_ARRAYS + 1;
  if (stub_control.lie == BALLISTIC_ENDLESS_TEXT) memset(plan->variant, 'x', sizeof plan->variant);
  return status;
}

static pbf_status describe(pbf_backend_solver *s, pbf_backend_state *state) {
  (void)s;
  state->threads = 1;
  state->device_type = PBF_DEVICE_CPU;
  snprintf(state->device_name, sizeof state->device_name, "a stub");
  if (stub_control.lie == BALLISTIC_ENDLESS_TEXT)
    memset(state->device_name, 'x', sizeof state->device_name);
  return ordered_failure();
}

static const pbf_backend_api table = {
    .struct_size = sizeof table,
    .probe = probe,
    .create = create,
    .destroy = destroy,
    .set_params = set_params,
    .set_colliders = set_colliders,
    .step = step,
    .synchronize = synchronize,
    .add_particles = add_particles,
    .remove_particles = remove_particles,
    .remove_all = remove_all,
    .read = read,
    .write = write,
    .map = map,
    .get_stats = get_stats,
    .get_plan = get_plan,
    .describe = describe,
    .get_extension = get_extension,
    .take_array = take_array,
    .release_array = release_array,
    .read_array = read_array,
    .set_accelerations = set_accelerations,
    .find_in_boxes = find_in_boxes,
};

EXPORT pbf_status pbf_backend_negotiate(const pbf_backend_host *h, pbf_backend_answer *answer);

EXPORT pbf_status pbf_backend_negotiate(const pbf_backend_host *h, pbf_backend_answer *answer) {
  host = h;
#ifdef STUB_PART
  if (!h->load_part(STUB_PART)) return PBF_ERROR_UNAVAILABLE;
#endif
  answer->abi_version = PBF_BACKEND_ABI_VERSION;
  answer->api = &table;
  const char *name = getenv("PBF_STUB_NAME");
  snprintf(answer->name, sizeof answer->name, "%s", name ? name : STUB_NAME);
  snprintf(answer->build_id, sizeof answer->build_id, "stub");
  return PBF_OK;
}
