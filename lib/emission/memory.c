/* The memory of emitters and drains, given back. */
#include "memory.h"

#include "emission.h"

void pbf_emission_free(pbf_solver *solver, pbf_emission *emission) {
  const pbf_allocator *allocator = &solver->allocator;
  if (!emission) return;
  pbf_memory_free(allocator, emission->births,
                  (uint64_t)emission->births_capacity * sizeof *emission->births);
  pbf_memory_free(allocator, emission->guided,
                  (uint64_t)emission->guided_capacity * sizeof *emission->guided);
  pbf_memory_free(allocator, emission->particles, emission->particles_bytes);
  pbf_memory_free(allocator, emission, sizeof *emission);
}
