/* The `serial`, `threads` and `openmp` plugins: one CPU solver with three kinds of team. */
#include <stddef.h>
#include <string.h>

#include "common/entry.h"
#include "common/variants.h"
#include "cpu/core.h"

static const pbf_backend_host *negotiated;
static const cpu_core *core;

/* The core's tables, of which the plugin has two functions of its own. */
enum { MAX_VARIANTS = 4 };
static pbf_backend_api tables[MAX_VARIANTS];

static void probe(const pbf_workload *workload, pbf_probe_result *result) {
  core->probe(&cpu_team, workload, result);
}

static pbf_status create(const pbf_backend_desc *desc, const pbf_params *params,
                         pbf_backend_solver **solver, const pbf_backend_api **api) {
  const cpu_desc complete = {pbf_variant_complete(desc, negotiated), &cpu_team};
  const pbf_variant *variant = pbf_variant_wanted(core->variants, &complete.desc);
  if (!variant) return PBF_ERROR_UNSUPPORTED;
  pbf_status status = variant->api->create(&complete.desc, params, solver, api);
  if (status == PBF_OK) *api = &tables[variant - core->variants];
  return status;
}

#ifdef PBF_LINKED
static const cpu_core *find_core(const pbf_backend_host *host) {
  (void)host;
  return &pbf_cpu_part;
}
#else
/* Null, with a sentence: it is not there, or of another build. */
static const cpu_core *find_core(const pbf_backend_host *host) {
  if (host->struct_size < offsetof(pbf_backend_host, load_part) + sizeof host->load_part) {
    host->set_error("it needs " CPU_CORE_FILE ", which this version of libpbf does not load");
    return NULL;
  }
  const cpu_core *found = host->load_part(CPU_CORE_FILE);
  if (!found || strcmp(found->build, cpu_build) == 0) return found;
  host->set_error("it needs " CPU_CORE_FILE " beside it, and that one is of another build");
  return NULL;
}
#endif

pbf_status PBF_ENTRY(const pbf_backend_host *host, pbf_backend_answer *answer) {
  negotiated = host;
  core = find_core(host);
  if (!core) return PBF_ERROR_UNAVAILABLE;
  for (int k = 0; core->variants[k].api; ++k) {
    tables[k] = *core->variants[k].api;
    tables[k].probe = probe;
    tables[k].create = create;
  }
  return pbf_entry_answer(host, &tables[0], answer);
}
