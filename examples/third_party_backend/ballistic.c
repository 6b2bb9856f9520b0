/* The smallest backend: particles that fall and never meet, 3D float32. It shows every function of
 * the plugin table; a real one differs in `step`. */
#include <pbf/pbf_backend.h>

#include <stdio.h>
#include <string.h>

struct pbf_backend_solver {
  pbf_backend_desc desc;
  pbf_params params;
  uint32_t count;
  float (*x)[3], (*v)[3];
  uint32_t *ids;
};

static uint64_t bytes_of(const pbf_backend_solver *s) { return s->desc.capacity * sizeof *s->x; }

static void *take(const pbf_backend_desc *desc, uint64_t bytes) {
  return desc->allocator.allocate(desc->allocator.user, bytes, 64);
}

static void give_back(const pbf_backend_desc *desc, void *memory, uint64_t bytes) {
  if (memory) desc->allocator.release(desc->allocator.user, memory, bytes, 64);
}

static int serves(uint32_t dimension, uint32_t precision) {
  return dimension == 3 && precision == PBF_FLOAT32;
}

static void probe(const pbf_workload *workload, pbf_probe_result *result) {
  result->device_type = PBF_DEVICE_CPU;
  snprintf(result->device_name, sizeof result->device_name, "thin air");
  if (serves(workload->dimension, workload->precision))
    result->score = 1;
  else
    snprintf(result->reason, sizeof result->reason, "built for 3D float32 alone");
}

static void destroy(pbf_backend_solver *s) {
  pbf_backend_desc desc = s->desc;
  give_back(&desc, s->x, bytes_of(s));
  give_back(&desc, s->v, bytes_of(s));
  give_back(&desc, s->ids, desc.capacity * sizeof *s->ids);
  give_back(&desc, s, sizeof *s);
}

static const pbf_backend_api table;

static pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                         pbf_backend_solver **solver, const pbf_backend_api **api) {
  if (!serves(desc->dimension, desc->precision)) {
    desc->host->set_error("the ballistic backend is built for 3D float32 alone");
    return PBF_ERROR_UNSUPPORTED;
  }
  pbf_backend_solver *s = take(desc, sizeof *s);
  if (s) {
    memset(s, 0, sizeof *s);
    s->desc = *desc;
    s->params = *params;
    s->x = take(desc, bytes_of(s));
    s->v = take(desc, bytes_of(s));
    s->ids = take(desc, desc->capacity * sizeof *s->ids);
    if (s->x && s->v && s->ids) {
      *solver = s;
      *api = &table;
      return PBF_OK;
    }
    destroy(s);
  }
  desc->host->set_error("no memory for a ballistic solver");
  return PBF_ERROR_OUT_OF_MEMORY;
}

static pbf_status set_params(pbf_backend_solver *s, const pbf_params *params) {
  s->params = *params;
  return PBF_OK;
}

static pbf_status set_colliders(pbf_backend_solver *s, uint32_t count,
                                const pbf_collider *colliders, double time) {
  (void)s, (void)colliders, (void)time;
  if (!count) return PBF_OK;
  s->desc.host->set_error("the ballistic backend has no colliders");
  return PBF_ERROR_UNSUPPORTED;
}

static pbf_status step(pbf_backend_solver *s, double time, uint64_t before, uint32_t steps,
                       uint32_t *done) {
  (void)time, (void)before;
  for (*done = 0; *done < steps; ++*done)
    for (uint32_t i = 0; i < s->count; ++i)
      for (int k = 0; k < 3; ++k) {
        s->v[i][k] += (float)(s->params.time_step * s->params.gravity[k]);
        s->x[i][k] += (float)s->params.time_step * s->v[i][k];
      }
  return PBF_OK;
}

static pbf_status synchronize(pbf_backend_solver *s) { return (void)s, PBF_OK; }

static pbf_status add_particles(pbf_backend_solver *s, const pbf_particles *p) {
  uint64_t bytes = p->count * sizeof *s->x;
  memcpy(s->x + s->count, p->positions, bytes);
  memset(s->v + s->count, 0, bytes);
  if (p->velocities) memcpy(s->v + s->count, p->velocities, bytes);
  memcpy(s->ids + s->count, p->ids, p->count * sizeof *s->ids);
  s->count += p->count;
  return PBF_OK;
}

static pbf_status remove_particles(pbf_backend_solver *s, uint32_t count, const uint32_t *ids) {
  uint32_t kept = 0, next = 0;
  for (uint32_t i = 0; i < s->count; ++i) {
    if (next < count && ids[next] == s->ids[i]) {
      ++next;
      continue;
    }
    memmove(s->x[kept], s->x[i], sizeof *s->x);
    memmove(s->v[kept], s->v[i], sizeof *s->v);
    s->ids[kept++] = s->ids[i];
  }
  s->count = kept;
  return PBF_OK;
}

static pbf_status remove_all(pbf_backend_solver *s) {
  s->count = 0;
  return PBF_OK;
}

/* Particles stay in the order of adding, so that a row is a place in the arrays. */
static pbf_status read_field(pbf_backend_solver *s, uint32_t field, const pbf_rows *rows,
                             void *out) {
  if (field == PBF_FIELD_DENSITY) {
    s->desc.host->set_error("the ballistic backend has no densities");
    return PBF_ERROR_UNSUPPORTED;
  }
  memcpy(out, (field == PBF_FIELD_POSITION ? s->x : s->v) + rows->first,
         rows->count * sizeof *s->x);
  return PBF_OK;
}

static pbf_status write_field(pbf_backend_solver *s, uint32_t field, const pbf_rows *rows,
                              const void *in) {
  memcpy((field == PBF_FIELD_POSITION ? s->x : s->v) + rows->first, in, rows->count * sizeof *s->x);
  return PBF_OK;
}

static pbf_status map(pbf_backend_solver *s, uint32_t field, pbf_view *view) {
  int is_id = field == PBF_FIELD_ID;
  view->device_type = PBF_DEVICE_CPU;
  view->element_type = is_id ? PBF_TYPE_UINT32 : PBF_TYPE_FLOAT32;
  view->components = is_id ? 1 : 3;
  view->particle_stride = is_id ? sizeof *s->ids : sizeof *s->x;
  view->component_stride = 4;
  view->count = s->count;
  view->ids = s->ids;
  view->data = is_id ? (const void *)s->ids : field == PBF_FIELD_POSITION ? s->x : s->v;
  return PBF_OK;
}

static pbf_status get_stats(pbf_backend_solver *s, pbf_stats *stats) {
  stats->count = s->count;
  for (uint32_t i = 0; i < s->count; ++i)
    for (int k = 0; k < 3; ++k) {
      stats->center_of_mass[k] += (double)s->x[i][k] / s->count;
      stats->momentum[k] += (double)s->v[i][k] / s->count;
    }
  return PBF_OK;
}

static pbf_status get_plan(pbf_backend_solver *s, pbf_plan *plan) {
  plan->stage_count = 1;
  snprintf(plan->stages[0].name, sizeof plan->stages[0].name, "fall");
  plan->stages[0].runs_per_step = 1;
  plan->bytes = 2 * bytes_of(s) + s->desc.capacity * sizeof *s->ids + sizeof *s;
  plan->bytes_per_particle = 2.0 * sizeof *s->x + sizeof *s->ids;
  return PBF_OK;
}

static pbf_status describe(pbf_backend_solver *s, pbf_backend_state *state) {
  (void)s;
  state->threads = 1;
  state->device_type = PBF_DEVICE_CPU;
  snprintf(state->device_name, sizeof state->device_name, "thin air");
  return PBF_OK;
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
    .read = read_field,
    .write = write_field,
    .map = map,
    .get_stats = get_stats,
    .get_plan = get_plan,
    .describe = describe,
};

pbf_status pbf_backend_negotiate(const pbf_backend_host *offer, pbf_backend_answer *answer);

__attribute__((visibility("default"))) pbf_status pbf_backend_negotiate(
    const pbf_backend_host *offer, pbf_backend_answer *answer) {
  if (offer->abi_min > PBF_BACKEND_ABI_VERSION || offer->abi_max < PBF_BACKEND_ABI_VERSION)
    return PBF_ERROR_UNSUPPORTED;
  answer->abi_version = PBF_BACKEND_ABI_VERSION;
  answer->api = &table;
  snprintf(answer->name, sizeof answer->name, "ballistic");
  snprintf(answer->build_id, sizeof answer->build_id, "example");
  return PBF_OK;
}
