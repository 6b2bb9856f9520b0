/* Some of a solver's colliders: a bit each, of the first 64 in one number, and of the others in
 * memory that lies with the colliders (colliders.h). */
#ifndef PBF_LIB_SOLVER_COLLIDER_SET_H
#define PBF_LIB_SOLVER_COLLIDER_SET_H

#include <stdint.h>

typedef struct pbf_collider_set {
  uint64_t first;
  uint32_t words; /* of `more` */
  uint64_t *more;
} pbf_collider_set;

static inline void pbf_collider_set_add(pbf_collider_set *set, uint32_t k) {
  uint64_t *word = k < 64 ? &set->first : &set->more[k / 64 - 1];
  *word |= UINT64_C(1) << k % 64;
}

static inline void pbf_collider_set_remove(pbf_collider_set *set, uint32_t k) {
  uint64_t *word = k < 64 ? &set->first : &set->more[k / 64 - 1];
  *word &= ~(UINT64_C(1) << k % 64);
}

static inline int pbf_collider_set_has(const pbf_collider_set *set, uint32_t k) {
  const uint64_t word = k < 64 ? set->first : set->more[k / 64 - 1];
  return (int)(word >> k % 64 & 1);
}

static inline int pbf_collider_set_is_empty(const pbf_collider_set *set) {
  uint64_t any = set->first;
  for (uint32_t w = 0; w < set->words; ++w) any |= set->more[w];
  return any == 0;
}

/* Of two with the same number of words. */
static inline int pbf_collider_sets_differ(const pbf_collider_set *a, const pbf_collider_set *b) {
  uint64_t other = a->first ^ b->first;
  for (uint32_t w = 0; w < a->words; ++w) other |= a->more[w] ^ b->more[w];
  return other != 0;
}

static inline void pbf_collider_set_unite(pbf_collider_set *set, const pbf_collider_set *with) {
  set->first |= with->first;
  for (uint32_t w = 0; w < set->words; ++w) set->more[w] |= with->more[w];
}

static inline void pbf_collider_set_copy(pbf_collider_set *to, const pbf_collider_set *from) {
  to->first = from->first;
  for (uint32_t w = 0; w < to->words; ++w) to->more[w] = w < from->words ? from->more[w] : 0;
}

#endif
