/* Part of backend.cu: the extension pbf.device_rows/1, by which the caller's memory on the device
 * is read and written. */
#ifndef PBF_CUDA_DEVICE_CALLS_H
#define PBF_CUDA_DEVICE_CALLS_H

#include "common/without.h"
#include "cuda/rank_calls.h"
#include "cuda/small/deferred_steps.h"

static pbf_status read_rows(pbf_backend_solver *handle, const pbf_device_rows *to) {
  solver *s = of(handle);
  if (to->field == PBF_FIELD_DENSITY && !(PBF_BUILT & PBF_FEATURE_STATS))
    return pbf_refuse_without(s->host, PBF_FEATURE_STATS);
  pbf_cuda_scope scope(s->context);
  if (has_ranks(s)) return refuse_call_on_ranks(s, "memory of the device");
  return read_device_rows(s, to);
}

static pbf_status write_rows(pbf_backend_solver *handle, const pbf_device_rows *from) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  if (has_ranks(s)) return refuse_call_on_ranks(s, "memory of the device");
  return write_device_rows(s, from);
}

static pbf_status fetch_rows(pbf_backend_solver *handle, const pbf_device_rows *from, void *to) {
  solver *s = of(handle);
  pbf_cuda_scope scope(s->context);
  if (has_ranks(s)) return refuse_call_on_ranks(s, "memory of the device");
  return fetch_device_rows(s, from, to);
}

static const pbf_backend_device_rows device_calls = {sizeof(pbf_backend_device_rows), 0, read_rows,
                                                     write_rows, fetch_rows};

#endif
