/* What follows from parameters alone, kept for the next solver that is created alike: sums over
 * lattices and tables of walls are four fifths of what creating one costs. */
#ifndef PBF_COMMON_DERIVED_TABLES_H
#define PBF_COMMON_DERIVED_TABLES_H

#include <string.h>

#include "physics/constants.h"

struct derived_tables {
  pbf_derived derived;
  pbf_constants constants; /* of any parameters with these derived ones */
};

/* A variant's last few. A thread that finds another one here derives for itself, and so does the
 * child of a fork in such a moment. */
enum { DERIVED_TABLES_KEPT = 4 };
static struct {
  unsigned taken, count;
  derived_tables last[DERIVED_TABLES_KEPT];
} kept_tables;

static inline bool take_kept_tables() {
  return __atomic_exchange_n(&kept_tables.taken, 1u, __ATOMIC_ACQUIRE) == 0;
}

static inline void leave_kept_tables() {
  __atomic_store_n(&kept_tables.taken, 0u, __ATOMIC_RELEASE);
}

static inline bool recall_tables(const pbf_params *from, derived_tables *tables) {
  bool found = false;
  if (!take_kept_tables()) return false;
  for (unsigned k = 0; k < DERIVED_TABLES_KEPT && k < kept_tables.count && !found; ++k) {
    found = memcmp(&kept_tables.last[k].derived.from, from, sizeof *from) == 0;
    if (found) *tables = kept_tables.last[k];
  }
  leave_kept_tables();
  return found;
}

static inline void keep_tables(const derived_tables *tables) {
  if (!take_kept_tables()) return;
  kept_tables.last[kept_tables.count++ % DERIVED_TABLES_KEPT] = *tables;
  leave_kept_tables();
}

/* Of new parameters; `derived` and `constants` are those of the parameters before, or zeros. */
static inline void derive_tables(const pbf_params *params, pbf_derived *derived,
                                 pbf_constants *constants) {
  const pbf_params from = pbf_params_to_derive_from(params);
  derived_tables tables;
  if (memcmp(&derived->from, &from, sizeof from) == 0) {
    tables.constants = *constants;
  } else if (recall_tables(&from, &tables)) {
    *derived = tables.derived;
  } else {
    tables.derived = *derived = pbf_derive_from(&from, PBF_DIM);
    tables.constants = pbf_constants_from(params, derived, NULL);
    keep_tables(&tables);
  }
  *constants = pbf_constants_from(params, derived, &tables.constants);
}

#endif
