/* What the variants of the `reference` backend share. */
#ifndef PBF_REFERENCE_PLUGIN_H
#define PBF_REFERENCE_PLUGIN_H

#include <pbf/pbf_backend.h>

#ifdef __cplusplus
extern "C" {
#endif

extern const pbf_backend_api reference_2d_f32, reference_2d_f64, reference_3d_f32, reference_3d_f64;

void reference_probe(const pbf_workload *workload, pbf_probe_result *result);

#ifdef __cplusplus
}
#endif

#endif
