/* A backend whose every answer may be a lie that the host can know for one: wrong statuses, counts,
 * texts without an end, tables that are too short. It never gives a pointer to memory that is not
 * there, which nobody could tell. Exports, beside the entry point, the switch of liar.h. */
#include "liar.h"

#include <stdio.h>
#include <stdlib.h>

#include <pbf/pbf_backend.h>

#define EXPORT __attribute__((visibility("default")))

EXPORT liar_control liar;

static const pbf_backend_host *host;
static const pbf_backend_api table;

/* One byte in eight is a lie, so that a run gets beyond its first call. */
static int lies_now(void) { return liar.lies && (take_u8(liar.lies) & 7) == 7; }

static void lie_u32(uint32_t *value) {
  if (lies_now()) *value = take_u32(liar.lies);
}

static void lie_text(char *text, size_t size) {
  if (lies_now()) take_bytes(liar.lies, text, size);
}

static pbf_status status_of_call(void) {
  if (!lies_now()) return PBF_OK;
  char sentence[16] = "";
  take_bytes(liar.lies, sentence, sizeof sentence - 1);
  uint8_t kind = take_u8(liar.lies);
  if (kind & 1) host->set_error(kind & 2 ? sentence : NULL);
  return kind & 4 ? (pbf_status)take_u32(liar.lies) : -(pbf_status)(kind >> 3) % 16;
}

struct pbf_backend_solver {
  pbf_backend_desc desc;
  uint32_t count;
  unsigned char zeros[64 * 3 * 8]; /* what views point to; the target adds no more particles */
};

static void probe(const pbf_workload *workload, pbf_probe_result *result) {
  uint32_t score = 1;
  (void)workload;
  lie_u32(&score);
  result->score = (int32_t)score;
  result->device_type = PBF_DEVICE_CPU;
  lie_u32(&result->device_type);
  lie_text(result->device_name, sizeof result->device_name);
  lie_text(result->reason, sizeof result->reason);
}

/* A table in a block of the size that it claims, so that a look beyond its end is seen. Blocks are
 * kept until the next one is wanted: the host may not need them longer than the call. */
static const pbf_backend_api *lying_table(void) {
  static unsigned char *block;
  free(block);
  block = NULL;
  if (!lies_now()) return &table;
  if (take_u8(liar.lies) & 1) return NULL;
  pbf_backend_api api = table;
  lie_u32(&api.struct_size);
  if (api.struct_size > 4096) api.struct_size = 4096;
  for (int lies = take_u8(liar.lies) % 3; lies > 0; --lies) {
    size_t members = (sizeof api - 8) / sizeof(void *), place = take_u8(liar.lies) % members;
    memset((char *)&api + 8 + place * sizeof(void *), 0, sizeof(void *));
  }
  size_t size = api.struct_size < 8 ? 8 : api.struct_size;
  block = calloc(1, size);
  memcpy(block, &api, size < sizeof api ? size : sizeof api);
  return (const pbf_backend_api *)(const void *)block;
}

static pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                         pbf_backend_solver **solver, const pbf_backend_api **api) {
  (void)params;
  pbf_status status = status_of_call();
  if (status != PBF_OK) return status;
  const pbf_backend_api *given = lying_table();
  *api = given;
  if (given != &table || lies_now()) return PBF_OK; /* no solver: the host couldn't free it */
  *solver = desc->allocator.allocate(desc->allocator.user, sizeof **solver, 64);
  if (!*solver) return PBF_ERROR_OUT_OF_MEMORY;
  memset(*solver, 0, sizeof **solver);
  (*solver)->desc = *desc;
  return PBF_OK;
}

static void destroy(pbf_backend_solver *s) {
  pbf_allocator allocator = s->desc.allocator;
  allocator.release(allocator.user, s, sizeof *s, 64);
}

static pbf_status set_params(pbf_backend_solver *s, const pbf_params *params) {
  (void)s, (void)params;
  return status_of_call();
}

static pbf_status set_colliders(pbf_backend_solver *s, uint32_t count,
                                const pbf_collider *colliders, double time) {
  (void)s, (void)count, (void)colliders, (void)time;
  return status_of_call();
}

static pbf_status step(pbf_backend_solver *s, double time, uint64_t before, uint32_t steps,
                       uint32_t *done) {
  (void)s, (void)time, (void)before;
  *done = steps;
  lie_u32(done);
  return status_of_call();
}

static pbf_status synchronize(pbf_backend_solver *s) {
  (void)s;
  return status_of_call();
}

static pbf_status add_particles(pbf_backend_solver *s, const pbf_particles *particles) {
  pbf_status status = status_of_call();
  if (status == PBF_OK) s->count += particles->count;
  return status;
}

static pbf_status remove_particles(pbf_backend_solver *s, uint32_t count, const uint32_t *ids) {
  (void)ids;
  pbf_status status = status_of_call();
  if (status == PBF_OK) s->count -= count;
  return status;
}

static pbf_status remove_all(pbf_backend_solver *s) {
  pbf_status status = status_of_call();
  if (status == PBF_OK) s->count = 0;
  return status;
}

static pbf_status read(pbf_backend_solver *s, uint32_t field, const pbf_rows *rows, void *out) {
  uint32_t components = field == PBF_FIELD_DENSITY ? 1 : s->desc.dimension;
  pbf_status status = status_of_call();
  if (status == PBF_OK)
    memset(out, lies_now() ? 0xff : 0, (size_t)rows->count * components * s->desc.precision);
  return status;
}

static pbf_status write(pbf_backend_solver *s, uint32_t field, const pbf_rows *rows,
                        const void *in) {
  (void)s, (void)field, (void)rows, (void)in;
  return status_of_call();
}

static pbf_status map(pbf_backend_solver *s, uint32_t field, pbf_view *view) {
  int is_id = field == PBF_FIELD_ID;
  view->device_type = PBF_DEVICE_CPU;
  view->element_type = is_id ? PBF_TYPE_UINT32 : s->desc.precision;
  view->components = is_id ? 1 : s->desc.dimension;
  view->count = s->count;
  view->component_stride = is_id ? 4 : (int64_t)s->desc.precision;
  view->particle_stride = view->components * view->component_stride;
  view->data = s->zeros;
  view->ids = (const uint32_t *)(const void *)s->zeros;
  lie_u32(&view->struct_size);
  lie_u32(&view->field);
  lie_u32(&view->device_type);
  lie_u32(&view->element_type);
  lie_u32(&view->components);
  lie_u32(&view->count);
  lie_u32(&view->reserved);
  if (lies_now()) take_bytes(liar.lies, &view->particle_stride, sizeof view->particle_stride);
  if (lies_now()) view->data = NULL;
  if (lies_now()) view->ids = NULL;
  return status_of_call();
}

static pbf_status get_stats(pbf_backend_solver *s, pbf_stats *stats) {
  stats->count = s->count;
  lie_u32(&stats->count);
  lie_u32(&stats->struct_size);
  return status_of_call();
}

static pbf_status get_plan(pbf_backend_solver *s, pbf_plan *plan) {
  (void)s;
  plan->stage_count = plan->array_count = 1;
  lie_u32(&plan->stage_count);
  lie_u32(&plan->array_count);
  lie_u32(&plan->struct_size);
  lie_text(plan->variant, sizeof plan->variant);
  lie_text(plan->stages[0].name, PBF_NAME_SIZE);
  lie_text(plan->arrays[0].name, PBF_NAME_SIZE);
  return status_of_call();
}

static pbf_status describe(pbf_backend_solver *s, pbf_backend_state *state) {
  (void)s;
  state->threads = 1;
  state->device_type = PBF_DEVICE_CPU;
  lie_u32(&state->device_type);
  lie_text(state->device_name, sizeof state->device_name);
  return status_of_call();
}

static pbf_status set_timing(pbf_backend_solver *s, uint32_t enabled) {
  (void)s, (void)enabled;
  return status_of_call();
}

static pbf_status get_timings(pbf_backend_solver *s, pbf_timings *timings) {
  (void)s;
  lie_u32(&timings->stage_count);
  lie_text(timings->stages[0].name, PBF_NAME_SIZE);
  return status_of_call();
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
    .set_timing = set_timing,
    .get_timings = get_timings,
};

EXPORT pbf_status pbf_backend_negotiate(const pbf_backend_host *h, pbf_backend_answer *answer);

EXPORT pbf_status pbf_backend_negotiate(const pbf_backend_host *h, pbf_backend_answer *answer) {
  host = h;
  answer->abi_version = PBF_BACKEND_ABI_VERSION;
  answer->api = &table;
  snprintf(answer->name, sizeof answer->name, "liar");
  snprintf(answer->build_id, sizeof answer->build_id, "a liar");
  if (!liar.lies_in_answer) return PBF_OK;
  lie_u32(&answer->struct_size);
  lie_u32(&answer->abi_version);
  lie_text(answer->name, sizeof answer->name);
  lie_text(answer->build_id, sizeof answer->build_id);
  answer->api = lying_table();
  return status_of_call();
}
