/* The pressure grid's equations, of which each node has one: grid.h says what they are. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_NODES_H
#define PBF_PHYSICS_PRESSURE_GRID_NODES_H

#include "physics/pressure_grid/surface.h"

/* ---- Nodes --------------------------------------------------------------------------------- */

/* The integral of grad N_a · grad N_b over a unit cell, an element's stiffness, is OWN in these
 * units for a = b; for corners that differ in one axis 0 in three dimensions and -1 in two, in more
 * axes -1 and -2. */
#define PBF_PRESSURE_GRID_STIFFNESS (PBF_DIM == 3 ? 1.0 / 12 : 1.0 / 6)
#define PBF_PRESSURE_GRID_STIFFNESS_OWN 4

/* What a node's cells have and do. */
typedef struct pbf_pressure_grid_node_sum {
  double free_volume, divergence;
  double pressed, lacks; /* errors of the cells that are too dense, and of the others */
  int64_t ends;          /* whether fluid ends in one of them, pbf_pressure_grid_is_end */
} pbf_pressure_grid_node_sum;

/* A cell, or a compartment of it, of which the node, the i-th along each axis, is corner `a`. A
 * crowd counts as an error of its cell's whole free volume: it is for the iterations. */
PBF_FN void pbf_pressure_grid_add_cell(const pbf_pressure_grid *c, const int64_t *sums,
                                       const int64_t *places, const double *free_volumes,
                                       int64_t cell, const int i[PBF_DIM], int a,
                                       pbf_pressure_grid_node_sum *all) {
  const double error = pbf_min(pbf_pressure_grid_error(c, sums[cell]), free_volumes[cell]);
  double divergence = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    int right_of = a >> k & 1;
    divergence +=
        (right_of ? 1 : -1) * (c->push[k] + c->pull[k] * (i[k] - right_of) -
                               (i[k] > c->middle[k] ? c->upper_gain[k] : c->lower_gain[k]));
  }
  all->free_volume += free_volumes[cell];
  all->divergence += free_volumes[cell] * divergence;
  all->pressed += pbf_max(error, 0);
  all->lacks += pbf_min(error, 0);
  all->ends |= places[cell];
}

/* What fluid lacks where it ends is no room inside: nothing pulls there. */
PBF_FN double pbf_pressure_grid_source(const pbf_pressure_grid *c,
                                       const pbf_pressure_grid_source_scale *source_scale,
                                       const pbf_pressure_grid_node_sum *all) {
  const double room = pbf_pressure_grid_is_end(all->ends) ? 0 : c->room;
  return source_scale->part / PBF_CORNERS *
         (source_scale->share * (all->pressed + room * all->lacks) + 2 * all->divergence);
}

PBF_FN void pbf_pressure_grid_equation_of(const pbf_pressure_grid *c,
                                          const pbf_pressure_grid_source_scale *source_scale,
                                          const pbf_pressure_grid_node_sum *all, double depth,
                                          double *right, double *inverse) {
  int has = all->free_volume >= PBF_PRESSURE_GRID_NO_VOLUME && source_scale->part > 0;
  int solved = has && !pbf_pressure_grid_is_open(depth);
  *right = has ? -pbf_pressure_grid_source(c, source_scale, all) : 0;
  *inverse =
      solved
          ? 1 / (PBF_PRESSURE_GRID_STIFFNESS * PBF_PRESSURE_GRID_STIFFNESS_OWN * all->free_volume)
          : 0;
}

/* The system's right side and the inverse of its diagonal: 0 for a node in the open or with next to
 * no free volume, and where nothing is to be done. One cell by one, here and below, so that the
 * compiler can do several nodes at once. */
PBF_FN void pbf_pressure_grid_equation_at(const pbf_pressure_grid *c,
                                          const pbf_pressure_grid_source_scale *source_scale,
                                          const int64_t *sums, const int64_t *places,
                                          const double *free_volumes, double depth, int64_t node,
                                          const int i[PBF_DIM], double *right, double *inverse) {
  pbf_pressure_grid_node_sum all = {0, 0, 0, 0, 0};
  pbf_pressure_grid_add_cell(c, sums, places, free_volumes, node - (int64_t)c->corner[0], i, 0,
                             &all);
  pbf_pressure_grid_add_cell(c, sums, places, free_volumes, node - (int64_t)c->corner[1], i, 1,
                             &all);
  pbf_pressure_grid_add_cell(c, sums, places, free_volumes, node - (int64_t)c->corner[2], i, 2,
                             &all);
  pbf_pressure_grid_add_cell(c, sums, places, free_volumes, node - (int64_t)c->corner[3], i, 3,
                             &all);
  if (PBF_DIM == 3) {
    pbf_pressure_grid_add_cell(c, sums, places, free_volumes,
                               node - (int64_t)c->corner[PBF_CORNERS - 4], i, PBF_CORNERS - 4,
                               &all);
    pbf_pressure_grid_add_cell(c, sums, places, free_volumes,
                               node - (int64_t)c->corner[PBF_CORNERS - 3], i, PBF_CORNERS - 3,
                               &all);
    pbf_pressure_grid_add_cell(c, sums, places, free_volumes,
                               node - (int64_t)c->corner[PBF_CORNERS - 2], i, PBF_CORNERS - 2,
                               &all);
    pbf_pressure_grid_add_cell(c, sums, places, free_volumes,
                               node - (int64_t)c->corner[PBF_CORNERS - 1], i, PBF_CORNERS - 1,
                               &all);
  }
  pbf_pressure_grid_equation_of(c, source_scale, &all, depth, right, inverse);
}

/* What is between corners a and b of a cell, in PBF_PRESSURE_GRID_STIFFNESS. */
PBF_FN double pbf_pressure_grid_between_corners(int a, int b) {
  const int axes = ((a ^ b) & 1) + ((a ^ b) >> 1 & 1) + ((a ^ b) >> 2 & 1);
  return PBF_DIM == 2 ? axes : axes > 1;
}

/* What the surface adds to the diagonal of a node inside that is corner `a` of a cell or
 * compartment, times how deep the node is: between it and each corner in the open lambda ends. */
PBF_FN double pbf_pressure_grid_surface_stiffness(const pbf_pressure_grid *c,
                                                  const pbf_pressure_grid_topology *t,
                                                  const double *free_volumes, const double *depths,
                                                  uint32_t compartment, int a) {
  double sum = 0;
  if (!(free_volumes[compartment] > 0)) return 0;
  for (int b = 0; b < PBF_CORNERS; ++b) {
    const double depth = depths[pbf_pressure_grid_corner(c, t, compartment, b)];
    if (b != a && pbf_pressure_grid_is_open(depth))
      sum -= pbf_pressure_grid_between_corners(a, b) * depth;
  }
  return free_volumes[compartment] * sum;
}

/* The inverse of the diagonal with that. */
PBF_FN double pbf_pressure_grid_with_surface(double inverse, double surface, double depth) {
  return surface != 0 ? 1 / (1 / inverse + PBF_PRESSURE_GRID_STIFFNESS * surface / depth) : inverse;
}

/* Of an ordinary node that is not in the open. */
PBF_FN double pbf_pressure_grid_end_equation(const pbf_pressure_grid *c,
                                             const pbf_pressure_grid_topology *t,
                                             const double *free_volumes, const double *depths,
                                             uint32_t node, double inverse) {
  double surface = 0;
  for (int a = 0; a < PBF_CORNERS; ++a)
    surface +=
        pbf_pressure_grid_surface_stiffness(c, t, free_volumes, depths, node - c->corner[a], a);
  return pbf_pressure_grid_with_surface(inverse, surface, depths[node]);
}

/* The equation of any node; 0 for those outside. */
PBF_FN void pbf_pressure_grid_equation(const pbf_pressure_grid *c,
                                       const pbf_pressure_grid_topology *t,
                                       const pbf_pressure_grid_source_scale *source_scale,
                                       const int64_t *sums, const int64_t *places,
                                       const double *free_volumes, const double *depths,
                                       uint32_t node, double *right, double *inverse) {
  int i[PBF_DIM];
  *right = *inverse = 0;
  pbf_pressure_grid_place(c, node, i);
  for (int k = 0; k < PBF_DIM; ++k)
    if (i[k] == 0) return;
  pbf_pressure_grid_equation_at(c, source_scale, sums, places, free_volumes, depths[node], node, i,
                                right, inverse);
  if (*inverse > 0)
    *inverse = pbf_pressure_grid_end_equation(c, t, free_volumes, depths, node, *inverse);
}

/* That of a torn node. */
PBF_FN void pbf_pressure_grid_torn_equation(const pbf_pressure_grid *c,
                                            const pbf_pressure_grid_topology *t,
                                            const pbf_pressure_grid_source_scale *source_scale,
                                            const int64_t *sums, const int64_t *places,
                                            const double *free_volumes, const double *depths,
                                            uint32_t torn) {
  pbf_pressure_grid_node_sum all = {0, 0, 0, 0, 0};
  double surface = 0;
  int i[PBF_DIM];
  pbf_pressure_grid_place(c, t->base[torn], i);
  pbf_for_compartments(t, torn, [&](uint32_t compartment, int a) {
    pbf_pressure_grid_add_cell(c, sums, places, free_volumes, compartment, i, a, &all);
    surface += pbf_pressure_grid_surface_stiffness(c, t, free_volumes, depths, compartment, a);
  });
  const double depth = depths[t->torn_at[torn]];
  pbf_pressure_grid_equation_of(c, source_scale, &all, depth, &t->right[torn], &t->inverse[torn]);
  if (t->inverse[torn] > 0)
    t->inverse[torn] = pbf_pressure_grid_with_surface(t->inverse[torn], surface, depth);
}

/* The free volumes of the cells around a node: of the one of which it is corner a. */
PBF_FN void pbf_pressure_grid_around(const pbf_pressure_grid *c, const double *free_volumes,
                                     uint32_t node, double around[PBF_CORNERS]) {
  for (int a = 0; a < PBF_CORNERS; ++a)
    around[a] = free_volumes[(int64_t)node - (int64_t)c->corner[a]];
}

/* What of the diagonal is not the cells' own: the surface's, and 0 for a node in the open. */
PBF_FN double pbf_pressure_grid_surface_diagonal(double inverse, double free_volume) {
  const double own = PBF_PRESSURE_GRID_STIFFNESS * PBF_PRESSURE_GRID_STIFFNESS_OWN * free_volume;
  return inverse > 0 ? 1 / inverse - own : 0;
}

/* The part of a node's left side from the cell of which it is corner `a`. */
PBF_FN double pbf_pressure_grid_stiffness(const pbf_pressure_grid *c,
                                          const double around[PBF_CORNERS], const double *lambda,
                                          uint32_t node, int a) {
  int64_t x = 1 - 2 * (a & 1), y = (1 - 2 * (a >> 1 & 1)) * (int64_t)c->corner[2];
  const double *at = lambda + node;
  int64_t z = (1 - 2 * (a >> 2)) * (int64_t)c->corner[PBF_CORNERS / 2];
  double others = PBF_DIM == 2 ? at[x] + at[y] + 2 * at[x + y]
                               : at[x + y] + at[x + z] + (at[y + z] + at[x + y + z]);
  return around[a] * (PBF_PRESSURE_GRID_STIFFNESS_OWN * at[0] - others);
}

/* The same, of the free volumes around a node. */
PBF_FN double pbf_pressure_grid_surface_of(const double around[PBF_CORNERS], double inverse) {
  double free_volume = around[0] + around[1] + (around[2] + around[3]);
  if (PBF_DIM == 3)
    free_volume += around[PBF_CORNERS - 4] + around[PBF_CORNERS - 3] +
                   (around[PBF_CORNERS - 2] + around[PBF_CORNERS - 1]);
  return pbf_pressure_grid_surface_diagonal(inverse, free_volume);
}

/* What is missing on the left side; `surface` is what of the diagonal is the surface's. */
PBF_FN double pbf_pressure_grid_residual(const pbf_pressure_grid *c,
                                         const double around[PBF_CORNERS], const double *lambda,
                                         double right, double surface, uint32_t node) {
  double left = pbf_pressure_grid_stiffness(c, around, lambda, node, 0) +
                pbf_pressure_grid_stiffness(c, around, lambda, node, 1) +
                (pbf_pressure_grid_stiffness(c, around, lambda, node, 2) +
                 pbf_pressure_grid_stiffness(c, around, lambda, node, 3));
  if (PBF_DIM == 3)
    left += pbf_pressure_grid_stiffness(c, around, lambda, node, PBF_CORNERS - 4) +
            pbf_pressure_grid_stiffness(c, around, lambda, node, PBF_CORNERS - 3) +
            (pbf_pressure_grid_stiffness(c, around, lambda, node, PBF_CORNERS - 2) +
             pbf_pressure_grid_stiffness(c, around, lambda, node, PBF_CORNERS - 1));
  return right - PBF_PRESSURE_GRID_STIFFNESS * left - surface * lambda[node];
}

/* The same of a torn node. */
PBF_FN double pbf_pressure_grid_torn_residual(const pbf_pressure_grid *c,
                                              const pbf_pressure_grid_topology *t,
                                              const double *free_volumes, const double *lambda,
                                              uint32_t torn) {
  const double now = lambda[t->torn_at[torn]], own = PBF_PRESSURE_GRID_STIFFNESS_OWN * now;
  double left = 0, free_volume = 0;
  pbf_for_compartments(t, torn, [&](uint32_t of, int a) {
    const double x = lambda[pbf_pressure_grid_corner(c, t, of, a ^ 3)];
    double others;
    if (PBF_DIM == 2)
      others = lambda[pbf_pressure_grid_corner(c, t, of, a ^ 1)] +
               lambda[pbf_pressure_grid_corner(c, t, of, a ^ 2)] + 2 * x;
    else
      others = x + lambda[pbf_pressure_grid_corner(c, t, of, a ^ (5 % PBF_CORNERS))] +
               lambda[pbf_pressure_grid_corner(c, t, of, a ^ (6 % PBF_CORNERS))] +
               lambda[pbf_pressure_grid_corner(c, t, of, a ^ (PBF_CORNERS - 1))];
    left += free_volumes[of] * (own - others);
    free_volume += free_volumes[of];
  });
  return t->right[torn] - PBF_PRESSURE_GRID_STIFFNESS * left -
         pbf_pressure_grid_surface_diagonal(t->inverse[torn], free_volume) * now;
}

#endif
