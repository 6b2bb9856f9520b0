/* Which dimensions and element types a backend was built for, and its answer for the others. */
#ifndef PBF_COMMON_VARIANTS_H
#define PBF_COMMON_VARIANTS_H

#include <stdio.h>
#include <string.h>

#include <pbf/pbf_backend.h>

#include "pbf_build.h"

/* A backend's list of these ends with one that has no api. */
typedef struct pbf_variant {
  uint32_t dimension, precision;
  const pbf_backend_api *api;
} pbf_variant;

/* Null: built without it. */
static inline const pbf_variant *pbf_variant_find(const pbf_variant *variants, uint32_t dimension,
                                                  uint32_t precision) {
  while (variants->api && (variants->dimension != dimension || variants->precision != precision))
    ++variants;
  return variants->api ? variants : NULL;
}

static inline void pbf_variant_say_missing(char *reason, size_t size, uint32_t dimension,
                                           uint32_t precision) {
  snprintf(reason, size, "built without %uD float%u", dimension, 8 * precision);
}

/* Fills the answer to a probe and returns 1 when the variant that it asks about is missing. */
static inline int pbf_variant_refuse(const pbf_variant *variants, const pbf_workload *workload,
                                     pbf_probe_result *result) {
  if (pbf_variant_find(variants, workload->dimension, workload->precision)) return 0;
  result->score = 0;
  pbf_variant_say_missing(result->reason, sizeof result->reason, workload->dimension,
                          workload->precision);
  return 1;
}

/* The description as this header has it: a host of an older one does not say which it is. */
static inline pbf_backend_desc pbf_variant_complete(const pbf_backend_desc *desc,
                                                    const pbf_backend_host *negotiated) {
  pbf_backend_desc complete;
  memset(&complete, 0, sizeof complete);
  memcpy(&complete, desc,
         desc->struct_size < sizeof complete ? desc->struct_size : sizeof complete);
  complete.struct_size = sizeof complete;
  if (!complete.host) complete.host = negotiated;
  return complete;
}

/* The variant that a complete description asks for; null, with a sentence: built without it. */
static inline const pbf_variant *pbf_variant_wanted(const pbf_variant *variants,
                                                    const pbf_backend_desc *desc) {
  char reason[64];
  const pbf_variant *v = pbf_variant_find(variants, desc->dimension, desc->precision);
  if (v) return v;
  pbf_variant_say_missing(reason, sizeof reason, desc->dimension, desc->precision);
  desc->host->set_error(reason);
  return NULL;
}

/* `create` of a backend: that of the variant. `negotiated` is the last host that has. */
static inline pbf_status pbf_variant_create(const pbf_variant *variants,
                                            const pbf_backend_host *negotiated,
                                            const pbf_backend_desc *desc, const pbf_params *params,
                                            pbf_backend_solver **solver,
                                            const pbf_backend_api **api) {
  const pbf_backend_desc complete = pbf_variant_complete(desc, negotiated);
  const pbf_variant *variant = pbf_variant_wanted(variants, &complete);
  return variant ? variant->api->create(&complete, params, solver, api) : PBF_ERROR_UNSUPPORTED;
}

#endif
