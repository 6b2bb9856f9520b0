/* Where no surface of the fluid says what its pressure is: in a body of fluid that solids close in,
 * as a full vessel does, the equations leave a constant open, which moves nothing. Once particles
 * have been moved, it is chosen such that the least pressure of the body is 0, as under a lid that
 * the fluid only just comes up to: solids would else bear it, and pressures that are read have it.
 *
 * Bodies are the sets of nodes that cells join, found by union-find: each node refers to another
 * one of its body with a lower index, and so in the end to the lowest of all. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_DATUM_H
#define PBF_PHYSICS_PRESSURE_GRID_DATUM_H

#include "physics/pressure_grid/solve.h"

/* A cell that has so much free volume and a node in the open is an opening. */
#define PBF_PRESSURE_GRID_OPENING 0.1

/* Of the grid that has been solved. */
typedef struct pbf_pressure_datum {
  const pbf_pressure_grid *grid;
  const pbf_pressure_grid_topology *topology;
  const int64_t *sums, *places; /* of cells */
  const double *free_volumes;   /* of cells */
  const double *inverse;        /* of nodes */
  double *lambda;               /* of nodes */
  int64_t *bodies;              /* of nodes: a node of the same body */
  int64_t *least; /* of a body's lowest node: the bits of its least pressure, or INT64_MAX */
} pbf_pressure_datum;

/* Writes where there is what is expected; returns what there was. */
PBF_FN int64_t pbf_write_if(int64_t *at, int64_t expected, int64_t next) {
#ifdef __CUDA_ARCH__
  return (int64_t)atomicCAS((unsigned long long *)at, (unsigned long long)expected,
                            (unsigned long long)next);
#else
  const int64_t before = *at;
  if (before == expected) *at = next;
  return before;
#endif
}

PBF_FN void pbf_lower_to(int64_t *at, int64_t value) {
#ifdef __CUDA_ARCH__
  atomicMin((long long *)at, (long long)value);
#else
  if (value < *at) *at = value;
#endif
}

/* Reals that are never negative are ordered as their bits are. */
PBF_FN int64_t pbf_bits_of(double value) {
  int64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

PBF_FN double pbf_of_bits(int64_t bits) {
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

PBF_FN int64_t pbf_body_of(int64_t *bodies, int64_t node) {
  while (bodies[node] != node) node = bodies[node] = bodies[bodies[node]];
  return node;
}

PBF_FN void pbf_join_bodies(int64_t *bodies, int64_t one, int64_t other) {
  for (;;) {
    one = pbf_body_of(bodies, one);
    other = pbf_body_of(bodies, other);
    if (one == other) return;
    const int64_t high = one > other ? one : other, low = one > other ? other : one;
    if (pbf_write_if(&bodies[high], high, low) == high) return;
  }
}

/* Of any index. */
PBF_FN void pbf_datum_begin(const pbf_pressure_datum *d, uint32_t index) {
  d->bodies[index] = index;
  d->least[index] = INT64_MAX;
}

PBF_FN int pbf_datum_is_solved(const pbf_pressure_datum *d, uint32_t node) {
  const pbf_pressure_grid_topology *t = d->topology;
  return t->is_active ? pbf_pressure_grid_is_solved(t, d->inverse, node) : d->inverse[node] > 0;
}

/* Once all have begun. */
PBF_FN void pbf_datum_join(const pbf_pressure_datum *d, uint32_t compartment) {
  int64_t first = -1;
  if (!(d->free_volumes[compartment] > 0)) return;
  for (int b = 0; b < PBF_CORNERS; ++b) {
    const uint32_t node = pbf_pressure_grid_corner(d->grid, d->topology, compartment, b);
    if (!pbf_datum_is_solved(d, node)) continue;
    if (first >= 0) pbf_join_bodies(d->bodies, first, node);
    first = node;
  }
}

/* Lambda at the end of a cell's fluid to the side of lower pressure, which is as far beyond the
 * middle of its particles as the cell's other end is before that. */
PBF_FN double pbf_datum_lambda_at_end(const pbf_pressure_datum *d, uint32_t compartment,
                                      const double values[PBF_CORNERS]) {
  const int64_t count = pbf_pressure_grid_count(d->sums[compartment]);
  double middle[PBF_DIM], end[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k)
    middle[k] = pbf_pressure_grid_mean_place(d->places[compartment], count, k);
  for (int k = 0; k < PBF_DIM; ++k) {
    const int falls = pbf_pressure_grid_in_cell(values, middle, k) > 0;
    end[k] = falls ? pbf_min(2 * middle[k], 1) : pbf_max(2 * middle[k] - 1, 0);
  }
  return pbf_pressure_grid_in_cell(values, end, PBF_DIM);
}

/* Once all are joined. */
PBF_FN void pbf_datum_note(const pbf_pressure_datum *d, uint32_t compartment) {
  const double free_volume = d->free_volumes[compartment];
  double values[PBF_CORNERS], least = -1;
  int64_t body = -1;
  int solved = 0;
  if (!(free_volume > 0)) return;
  for (int b = 0; b < PBF_CORNERS; ++b) {
    const uint32_t node = pbf_pressure_grid_corner(d->grid, d->topology, compartment, b);
    values[b] = d->lambda[node];
    if (!pbf_datum_is_solved(d, node)) continue;
    body = node;
    ++solved;
  }
  if (body < 0) return;
  if (solved < PBF_CORNERS && free_volume >= PBF_PRESSURE_GRID_OPENING) least = 0;
  if (solved == PBF_CORNERS &&
      pbf_pressure_grid_is_filled(d->grid, d->sums[compartment], free_volume))
    least = pbf_max(-pbf_datum_lambda_at_end(d, compartment, values), 0);
  if (least >= 0) pbf_lower_to(&d->least[pbf_body_of(d->bodies, body)], pbf_bits_of(least));
}

/* Once all are noted, of a node that is not in the open. What is beyond the fluid has less. */
PBF_FN void pbf_datum_end(const pbf_pressure_datum *d, uint32_t node) {
  const int64_t least = d->least[pbf_body_of(d->bodies, node)];
  if (least > 0 && least < INT64_MAX) d->lambda[node] += pbf_of_bits(least);
}

#endif
