/* The arrays that a solver has for some scenes only. */
#ifndef PBF_CUDA_ARRAYS_H
#define PBF_CUDA_ARRAYS_H

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

namespace {

/* An entry of physics/arrays.def. */
struct optional_array {
  solver *s;
  const char *name;
  bool wanted;

  /* Takes or frees it. */
  template <class Element>
  pbf_status keep(Element **array, uint64_t elements) const {
    return take_if(s, wanted, name, elements * sizeof(Element), array);
  }
  pbf_status keep() const { return PBF_OK; } /* other backends' */
};

}  // namespace

/* Takes those that are wanted, or frees those that are not. */
static inline pbf_status keep_arrays(solver *s, const pbf_schedule &has, const pbf_params &params,
                                     bool take) {
  const uint64_t n = s->capacity;
  const bool sleeps = PBF_SLEEP && has.runs[PBF_STAGE_SLEEP];
  if (sleeps && take)
    if (pbf_status status = take_all_asleep(s)) return status;
#define PBF_ARRAY(name, wanted, holders) \
  if (((wanted) != 0) == take)           \
    if (pbf_status status = optional_array{s, name, take}.keep(holders)) return status;
#define PBF_CUDA(type, member, elements) &s->member, elements
#include "physics/arrays.def"
  if (!sleeps && !take) free_all_asleep(s); /* freeing the arrays has waited for the device */
  return PBF_OK;
}

#endif
