/* Checks of the callers' particle arrays. */
#ifndef PBF_LIB_PARTICLES_VALUES_H
#define PBF_LIB_PARTICLES_VALUES_H

#include "solver/solver.h"

/* `first_row` is the number of the array's first row, for the message. Positions must be finite
 * and inside the domain as it is now; velocities finite, and at most pbf_check_most in size. */
pbf_status pbf_values_check_positions(const pbf_solver *solver, const void *positions,
                                      uint32_t count, uint32_t first_row);
pbf_status pbf_values_check_finite(const pbf_solver *solver, const char *name, const void *values,
                                   uint32_t count, uint32_t first_row);

/* `count` numbers that need only be finite. */
pbf_status pbf_values_check_numbers(const pbf_solver *solver, const char *name, const void *values,
                                    uint64_t count);

/* Number `index` of an array of the precision. Inline, for it is called for each of millions. */
static inline double pbf_value_at(const void *values, uint64_t index, uint32_t precision) {
  return precision == PBF_FLOAT32 ? (double)((const float *)values)[index]
                                  : ((const double *)values)[index];
}

/* function(kind, …), an inline function over many rows, compiled for each kind of solver. */
#define PBF_OF_KIND(kind, function, ...)                                                           \
  ((kind).precision == PBF_FLOAT32 ? (kind).dimension == 3                                         \
                                         ? function((pbf_check_kind){3, PBF_FLOAT32}, __VA_ARGS__) \
                                         : function((pbf_check_kind){2, PBF_FLOAT32}, __VA_ARGS__) \
   : (kind).dimension == 3 ? function((pbf_check_kind){3, PBF_FLOAT64}, __VA_ARGS__)               \
                                   : function((pbf_check_kind){2, PBF_FLOAT64}, __VA_ARGS__))

/* Where rows of `least` bytes lie in the caller's array: `call`.data and .stride, which 0 stands
 * for no gap. */
pbf_status pbf_values_check_layout(const char *call, const void *data, uint64_t stride,
                                   uint64_t least, uint32_t element_size);

#endif
