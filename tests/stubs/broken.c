/* Plugins that break one rule each; DEFECT says which. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <pbf/pbf_backend.h>

#define TOO_OLD 1
#define TOO_NEW 2
#define REFUSES 3
#define REFUSES_SILENTLY 4
#define NO_TABLE 5
#define MISSING_FUNCTION 6
#define SHORT_TABLE 7
#define HALF_TIMING 8
#define NO_NAME 9
#define ENDLESS_NAME 10
#define UNPRINTABLE_NAME 11
#define NAMED_AUTO 12
#define NO_SYMBOL 13
#define ENDLESS_BUILD_ID 14
#define LARGER_TABLE 15
#define TABLE_WITHOUT_OPTIONS 16
#define LYING_PROBE 17
#define NEGATIVE_PROBE 18
#define FAILING_CREATE 19 /* with the highest score */

static void probe(const pbf_workload *workload, pbf_probe_result *result) {
  (void)workload;
  result->score = DEFECT == NEGATIVE_PROBE ? -5 : DEFECT == FAILING_CREATE ? 1000000 : 1;
  result->device_type = DEFECT == LYING_PROBE ? 77 : PBF_DEVICE_CPU;
  memset(result->device_name, 'x', sizeof result->device_name);
}

static pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                         pbf_backend_solver **solver, const pbf_backend_api **api) {
  (void)desc, (void)params, (void)solver, (void)api;
  return PBF_ERROR_DEVICE;
}

/* None of these is ever called: create always fails. */
static void destroy(pbf_backend_solver *s) { (void)s; }
static pbf_status with_params(pbf_backend_solver *s, const pbf_params *p) {
  return (void)s, (void)p, PBF_ERROR_DEVICE;
}
static pbf_status with_colliders(pbf_backend_solver *s, uint32_t n, const pbf_collider *c,
                                 double t) {
  return (void)s, (void)n, (void)c, (void)t, PBF_ERROR_DEVICE;
}
static pbf_status step(pbf_backend_solver *s, double t, uint64_t before, uint32_t n,
                       uint32_t *done) {
  return (void)s, (void)t, (void)before, (void)n, (void)done, PBF_ERROR_DEVICE;
}
static pbf_status alone(pbf_backend_solver *s) { return (void)s, PBF_ERROR_DEVICE; }
static pbf_status add(pbf_backend_solver *s, const pbf_particles *p) {
  return (void)s, (void)p, PBF_ERROR_DEVICE;
}
static pbf_status take_away(pbf_backend_solver *s, uint32_t n, const uint32_t *ids) {
  return (void)s, (void)n, (void)ids, PBF_ERROR_DEVICE;
}
static pbf_status read(pbf_backend_solver *s, uint32_t f, const pbf_rows *r, void *out) {
  return (void)s, (void)f, (void)r, (void)out, PBF_ERROR_DEVICE;
}
static pbf_status write(pbf_backend_solver *s, uint32_t f, const pbf_rows *r, const void *in) {
  return (void)s, (void)f, (void)r, (void)in, PBF_ERROR_DEVICE;
}
static pbf_status map(pbf_backend_solver *s, uint32_t f, pbf_view *v) {
  return (void)s, (void)f, (void)v, PBF_ERROR_DEVICE;
}
static pbf_status stats(pbf_backend_solver *s, pbf_stats *out) {
  return (void)s, (void)out, PBF_ERROR_DEVICE;
}
static pbf_status plan(pbf_backend_solver *s, pbf_plan *out) {
  return (void)s, (void)out, PBF_ERROR_DEVICE;
}
static pbf_status describe(pbf_backend_solver *s, pbf_backend_state *out) {
  return (void)s, (void)out, PBF_ERROR_DEVICE;
}
static pbf_status set_timing(pbf_backend_solver *s, uint32_t on) {
  return (void)s, (void)on, PBF_ERROR_DEVICE;
}

/* A table of a later header: members that the host has never heard of follow. */
static struct {
  pbf_backend_api api;
  void *later[4];
} table;

static void fill_table(void) {
  table.api = (pbf_backend_api){
      .struct_size = sizeof table.api,
      .probe = probe,
      .create = create,
      .destroy = destroy,
      .set_params = with_params,
      .set_colliders = with_colliders,
      .step = step,
      .synchronize = alone,
      .add_particles = add,
      .remove_particles = take_away,
      .remove_all = alone,
      .read = read,
      .write = write,
      .map = map,
      .get_stats = stats,
      .get_plan = plan,
      .describe = describe,
  };
  if (DEFECT == MISSING_FUNCTION) table.api.map = NULL;
  if (DEFECT == HALF_TIMING) table.api.set_timing = set_timing;
  if (DEFECT == SHORT_TABLE) table.api.struct_size = offsetof(pbf_backend_api, describe);
  if (DEFECT == LARGER_TABLE) table.api.struct_size = sizeof table;
  if (DEFECT == TABLE_WITHOUT_OPTIONS) {
    /* As an older header had it: what stands behind is not the table's any more. */
    table.api.struct_size = offsetof(pbf_backend_api, set_timing);
    table.api.set_timing = set_timing;
  }
}

static void fill_names(pbf_backend_answer *answer) {
  snprintf(answer->name, sizeof answer->name, "broken%d", DEFECT);
  if (DEFECT == NO_NAME) answer->name[0] = 0;
  if (DEFECT == ENDLESS_NAME) memset(answer->name, 'n', sizeof answer->name);
  if (DEFECT == UNPRINTABLE_NAME) answer->name[1] = '\n';
  if (DEFECT == NAMED_AUTO) snprintf(answer->name, sizeof answer->name, "auto");
  if (DEFECT == ENDLESS_BUILD_ID) memset(answer->build_id, 'b', sizeof answer->build_id);
}

#if DEFECT == NO_SYMBOL
#define pbf_backend_negotiate pbf_backend_something_else
#endif

__attribute__((visibility("default"))) pbf_status pbf_backend_negotiate(
    const pbf_backend_host *host, pbf_backend_answer *answer);

pbf_status pbf_backend_negotiate(const pbf_backend_host *host, pbf_backend_answer *answer) {
  if (DEFECT == REFUSES) {
    host->set_error("the stub likes no host");
    return PBF_ERROR_UNSUPPORTED;
  }
  if (DEFECT == REFUSES_SILENTLY) return PBF_ERROR_DEVICE;
  answer->abi_version = PBF_BACKEND_ABI_VERSION;
  if (DEFECT == TOO_OLD) answer->abi_version = host->abi_min - 1;
  if (DEFECT == TOO_NEW) answer->abi_version = host->abi_max + 1;
  fill_names(answer);
  fill_table();
  answer->api = DEFECT == NO_TABLE ? NULL : &table.api;
  return PBF_OK;
}
