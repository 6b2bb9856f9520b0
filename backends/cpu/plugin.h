/* What the variants of the CPU backends share. */
#ifndef PBF_CPU_PLUGIN_H
#define PBF_CPU_PLUGIN_H

#include <pbf/pbf_backend.h>

#ifdef __cplusplus
extern "C" {
#endif

extern const pbf_backend_api cpu_2d_f32, cpu_2d_f64, cpu_3d_f32, cpu_3d_f64;

void cpu_probe(const pbf_workload *workload, pbf_probe_result *result);

#ifdef __cplusplus
}
#endif

#endif
