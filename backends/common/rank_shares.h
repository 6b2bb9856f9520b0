/* How what all ranks are given is shared out among them: particles that are added, and places in
 * the order of all particles, which are counted in bins. */
#ifndef PBF_COMMON_RANK_SHARES_H
#define PBF_COMMON_RANK_SHARES_H

#include <pbf/pbf_backend.h>

#include "common/digest.h"
#include "physics/real.h"

/* The bin that holds a place; before[b] is the number of places in the bins before b. */
PBF_FN uint32_t pbf_bin_of_place(const uint32_t *before, uint32_t bins, uint32_t place) {
  uint32_t low = 0, high = bins;
  while (low + 1 < high) {
    const uint32_t middle = low + (high - low) / 2;
    if (before[middle] <= place)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* The digest of what callers have given, with these particles. */
static inline uint64_t pbf_digest_of_added(uint64_t before, const pbf_particles *p) {
  const uint64_t bytes = (uint64_t)p->count * PBF_DIM * sizeof(pbf_real);
  uint64_t hash = digest(before, p->ids, (uint64_t)p->count * sizeof *p->ids);
  hash = digest(hash, p->positions, bytes);
  hash = digest(hash, &p->phase, sizeof p->phase);
  return p->velocities ? digest(hash, p->velocities, bytes) : hash;
}

/* Leaves of added particles those that rank `rank` of `ranks` gets: so many that all ranks, which
 * have counts[k] particles, have about as many then. False where a rank would have more than
 * `capacity`. */
static inline bool pbf_take_share_of_added(const uint32_t *counts, uint32_t ranks, uint32_t rank,
                                           uint32_t capacity, uint64_t total, pbf_particles *p) {
  const uint32_t each = (uint32_t)((total + ranks - 1) / ranks);
  uint32_t first = 0, own_first = 0, own_count = 0;
  for (uint32_t k = 0; k < ranks; ++k) {
    const uint32_t room = counts[k] < each ? each - counts[k] : 0, left = p->count - first;
    const uint32_t share = room < left ? room : left;
    if (counts[k] + share > capacity) return false;
    if (k == rank) {
      own_first = first;
      own_count = share;
    }
    first += share;
  }
  const uint64_t before = (uint64_t)own_first * PBF_DIM * sizeof(pbf_real);
  p->ids += own_first;
  p->positions = static_cast<const char *>(p->positions) + before;
  if (p->velocities) p->velocities = static_cast<const char *>(p->velocities) + before;
  p->count = own_count;
  return true;
}

/* Leaves of new particles those that this rank has until the next step. `counts` has room for one
 * of each rank, and each may have `capacity`. The backend has these of ranks: agree_on_call,
 * gather_on_ranks, refuse_on_ranks. */
template <class Solver>
static bool share_of_added(Solver *s, uint32_t *counts, uint32_t capacity, pbf_particles *p) {
  auto *r = &s->ranks;
  const uint64_t total = (uint64_t)r->total + p->count;
  const uint64_t hash = pbf_digest_of_added(r->particles, p);
  if (!agree_on_call(s, "pbf_add_particles", &hash, sizeof hash) ||
      !gather_on_ranks(s, &s->count, counts, sizeof s->count))
    return false;
  if (!pbf_take_share_of_added(counts, r->count, r->rank, capacity, total, p)) {
    refuse_on_ranks(s, PBF_ERROR_CAPACITY,
                    "the particles do not fit into the local_capacity of all ranks");
    return false;
  }
  r->particles = hash;
  r->total = (uint32_t)total;
  return true;
}

#endif
