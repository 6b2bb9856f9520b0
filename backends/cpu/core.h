/* The solver of the CPU backends: all that `serial`, `threads` and `openmp` have in common. It lies
 * in a file of its own beside these plugins, so that an installation has the loops of all
 * instruction sets once. */
#ifndef PBF_CPU_CORE_H
#define PBF_CPU_CORE_H

#include <pbf/pbf_backend.h>

#include "cpu/team.h"
#include "pbf_build.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Beside the plugins. */
#define CPU_CORE_FILE "pbf_cpu" PBF_PLUGIN_SUFFIX

/* What `create` of the core's tables is given: the description is complete. */
typedef struct cpu_desc {
  pbf_backend_desc desc;
  const team_api *team_api;
} cpu_desc;

typedef struct cpu_core {
  const char *build; /* the same text as the plugin's, or the rest is not what the plugin knows */
  const struct pbf_variant *variants; /* of tables without probe */
  void (*probe)(const team_api *teams, const pbf_workload *workload, pbf_probe_result *result);
} cpu_core;

extern const cpu_core pbf_cpu_part;

/* Of which sources, by which compiler, with what left out. */
extern const char cpu_build[];

extern const pbf_backend_api cpu_2d_f32, cpu_2d_f64, cpu_3d_f32, cpu_3d_f64;

#ifdef __cplusplus
}
#endif

#endif
