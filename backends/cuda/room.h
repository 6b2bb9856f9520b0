/* Arrays that a solver has only while its parameters want them. */
#ifndef PBF_CUDA_ROOM_H
#define PBF_CUDA_ROOM_H

#include "cuda/solver.h"

/* Takes or frees an array as `wanted` says. */
template <class Value>
static inline pbf_status take_if(solver *s, bool wanted, const char *name, uint64_t bytes,
                                 Value **data) {
  if (wanted == (*data != nullptr)) return PBF_OK;
  if (wanted) return pbf_cuda_take(&s->memory, name, bytes, reinterpret_cast<void **>(data));
  pbf_cuda_free(&s->memory, *data);
  *data = nullptr;
  return PBF_OK;
}

/* What the device tells the host, in the host's memory. */
static inline pbf_status take_all_asleep(solver *s) {
  if (s->all_asleep) return PBF_OK;
  void *word = nullptr;
  if (pbf_status status = pbf_cuda_check(
          cudaHostAlloc(&word, sizeof *s->all_asleep, cudaHostAllocMapped), "cudaHostAlloc"))
    return status;
  s->all_asleep = static_cast<uint64_t *>(word);
  *s->all_asleep = 0;
  return PBF_OK;
}

static inline void free_all_asleep(solver *s) {
  if (s->all_asleep && cudaFreeHost(s->all_asleep) != cudaSuccess) cudaGetLastError();
  s->all_asleep = nullptr;
}

static inline pbf_status take_for_sleep(solver *s, bool wanted, uint64_t n) {
  if (!PBF_SLEEP) return PBF_OK;
  if (wanted)
    if (pbf_status status = take_all_asleep(s)) return status;
  if (pbf_status status = take_if(s, wanted, "unrest", n * sizeof(pbf_real), &s->unrest))
    return status;
  if (pbf_status status =
          take_if(s, wanted, "sorted unrest", n * sizeof(pbf_real), &s->other_unrest))
    return status;
  if (pbf_status status = take_if(s, wanted, "sleep", sizeof *s->tally, &s->tally)) return status;
  if (!wanted) free_all_asleep(s); /* freeing the arrays has waited for the device */
  return PBF_OK;
}

#endif
