/* How much surface tension a step can take, and the lattice sums of passes/surface_tension.h. Host
 * only, float64; C17 and C++17: lib/ asks for the longest step. */
#ifndef PBF_PHYSICS_CAPILLARY_H
#define PBF_PHYSICS_CAPILLARY_H

#include <math.h>
#include <stdint.h>

/* The most of tension dt² / spacing³: waves of two spacings turn by some half a radian in such a
 * step. Measured on drops without viscosity: they keep calm up to here, tremble at twice, and fly
 * apart at four times this. */
static inline double pbf_capillary_part(uint32_t dimension) { return dimension == 3 ? 0.02 : 0.05; }

static inline double pbf_limit_of_tension(double spacing, double tension, uint32_t dimension) {
  const double part = pbf_capillary_part(dimension);
  return tension > 0 ? spacing * sqrt(part * spacing / tension) : INFINITY;
}

/* The tension that acts: what is too much for a step does not. */
static inline double pbf_acting_tension(double spacing, double tension, double time_step,
                                        uint32_t dimension) {
  const double per_step = spacing / time_step;
  return time_step > 0
             ? fmin(tension, pbf_capillary_part(dimension) * spacing * per_step * per_step)
             : 0;
}

/* Neighbours of a particle of the lattice, by their weights (1 - r²/h²)², and those of them on the
 * other side of a plane half a spacing off. */
typedef struct pbf_neighbor_weights {
  double all, beyond;
} pbf_neighbor_weights;

static inline pbf_neighbor_weights pbf_lattice_neighbors(uint32_t dimension, double h, double d) {
  pbf_neighbor_weights sum = {0, 0};
  const int n = (int)ceil(h / d), nz = dimension == 3 ? n : 0;
  for (int k = -nz; k <= nz; ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        const double near = 1 - (double)(i * i + j * j + k * k) * (d / h) * (d / h);
        if (near <= 0 || near >= 1) continue;
        sum.all += near * near;
        if (j > 0) sum.beyond += near * near;
      }
  return sum;
}

#endif
