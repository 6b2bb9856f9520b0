/* What there is to do on a host about the fluid on the pressure grid: sums, equations, their start
 * and end, and the pressure of them. */
#ifndef PBF_COMMON_PRESSURE_GRID_H
#define PBF_COMMON_PRESSURE_GRID_H

#include "common/pressure_grid_topology.h"
#include "physics/pressure_grid/cell_forces.h"
#include "physics/pressure_grid/datum.h"
#include "physics/pressure_grid/particles.h"
#include "physics/pressure_grid/solid_gains.h"
#include "physics/constants.h"

static inline uint32_t pbf_pressure_grid_last_further(const pbf_pressure_grid_topology *t) {
  return t->is_active ? t->first + pbf_pressure_grid_further_count(t, PBF_FURTHER_COMPARTMENTS)
                      : t->first;
}

/* Before particles add to the sums, in a grid for `count` of them, which lie within `fluid`, in the
 * step that ends at a time. `surfaces` is room for as many as the obstacles have; its content stays
 * until the next step. */
static inline void pbf_pressure_grid_begin(pbf_pressure_grid_storage *storage,
                                           const pbf_topology_memory *memory,
                                           const pbf_params *params, int corrects_shear,
                                           double time, uint32_t capacity, uint32_t count,
                                           const pbf_fluid_bounds *fluid, const pbf_obstacles *o,
                                           pbf_surface *surfaces) {
  pbf_domain domain = o->domain;
  for (int k = 0; k < pbf_surface_count(*o); ++k)
    domain = pbf_domain_within(domain, &o->surfaces[k]);
  pbf_pressure_grid_place_over(storage, memory, params, corrects_shear, &domain, time, capacity,
                               count, fluid, o, surfaces);
  memset(storage->sums, 0, storage->grid.nodes * sizeof *storage->sums);
  memset(storage->places, 0, storage->grid.nodes * sizeof *storage->places);
  if (storage->cell_moves)
    memset(storage->cell_moves, 0,
           (uint64_t)PBF_DIM * storage->grid.nodes * sizeof *storage->cell_moves);
}

/* The cell of a particle, or the compartment, and its place there; PBF_NO_INDEX: none. */
static inline uint32_t pbf_pressure_grid_find(const pbf_pressure_grid_storage *storage, pbf_vec x,
                                              double at[PBF_DIM]) {
  uint32_t cell = pbf_pressure_grid_cell(&storage->grid, x, at);
  return pbf_compartment_of(&storage->grid, &storage->topology, cell, x, at);
}

/* ---- The cells ------------------------------------------------------------------------------ */

/* Indices, up to the last of them along each axis. */
typedef struct pbf_pressure_grid_box {
  int first[PBF_DIM], last[PBF_DIM];
} pbf_pressure_grid_box;

/* A walk through the rows of a box along the first axis: the index of the place (0, i[1], i[2]),
 * and on to the next. Returns 0 after the last. */
static inline uint32_t pbf_pressure_grid_row(const pbf_pressure_grid *c, const int i[PBF_DIM]) {
  uint32_t row = 0;
  for (int k = PBF_DIM - 1; k > 0; --k) row = (row + (uint32_t)i[k]) * c->size[k - 1];
  return row;
}

static inline int pbf_pressure_grid_next_row(const pbf_pressure_grid_box *box, int i[PBF_DIM]) {
  for (int k = 1; k < PBF_DIM; ++k) {
    if (++i[k] <= box->last[k]) return 1;
    i[k] = box->first[k];
  }
  return 0;
}

static inline void pbf_pressure_grid_extend(const pbf_pressure_grid *c,
                                            pbf_pressure_grid_extent *extent,
                                            const int i[PBF_DIM]) {
  for (int k = 0; k < PBF_DIM; ++k) {
    uint32_t above = (uint32_t)i[k], below = (uint32_t)(c->n[k] + 1 - i[k]);
    if (above > extent->above[k]) extent->above[k] = above;
    if (below > extent->below[k]) extent->below[k] = below;
  }
}

static inline int pbf_any_obstacle_gains(const pbf_obstacles *o) {
  int any = 0;
  for (int k = 0; k < o->count && !any; ++k) any = o->surfaces.all[k].gains;
  return any;
}

/* The free volume of the cells in a box outside which there is no fluid, and what is to be done
 * about that in them. */
static inline pbf_pressure_grid_source_scale pbf_pressure_grid_find_free_volumes(
    pbf_pressure_grid_storage *storage, const pbf_obstacles *o, const pbf_pressure_grid_box *box) {
  const pbf_pressure_grid *c = &storage->grid;
  const pbf_pressure_grid_topology *t = &storage->topology;
  pbf_pressure_grid_extent extent = {{0}, {0}};
  int i[PBF_DIM];
  storage->gaining = pbf_any_obstacle_gains(o) ? o : NULL;
  memcpy(i, box->first, sizeof i);
  do {
    uint32_t row = pbf_pressure_grid_row(c, i);
    for (i[0] = box->first[0]; i[0] <= box->last[0]; ++i[0]) {
      uint32_t cell = row + (uint32_t)i[0];
      double whole = 0;
      if (!pbf_cell_is_cut(t, cell)) {
        const double reach = 0.51 * c->width * (o->grid ? o->grid->steepest : 1);
        const pbf_obstacles near = pbf_obstacles_near(*o, pbf_cell_middle(c, i), (pbf_real)reach);
        whole = pbf_pressure_grid_free_volume_at(c, near, i);
      }
      if (t->is_active) whole = pbf_compartment_volume(t, cell, whole);
      storage->free_volumes[cell] = whole;
      if (pbf_pressure_grid_is_filled(c, storage->sums[cell], storage->free_volumes[cell]))
        pbf_pressure_grid_extend(c, &extent, i);
    }
  } while (pbf_pressure_grid_next_row(box, i));
  for (uint32_t k = t->first; k < pbf_pressure_grid_last_further(t); ++k) {
    storage->free_volumes[k] = pbf_compartment_volume(t, k, 0);
    if (!pbf_pressure_grid_is_filled(c, storage->sums[k], storage->free_volumes[k])) continue;
    pbf_pressure_grid_place(c, pbf_compartment_cell(t, k), i);
    pbf_pressure_grid_extend(c, &extent, i);
  }
  return pbf_pressure_grid_source_scale_of(c, &extent);
}

/* How far the nodes of the cells in a box are below the surface, and where fluid ends in these:
 * torn nodes stand for those that they are of. */
static inline void pbf_pressure_grid_find_surface(pbf_pressure_grid_storage *storage,
                                                  const pbf_pressure_grid_box *box) {
  const pbf_pressure_grid *c = &storage->grid;
  const pbf_pressure_grid_topology *t = &storage->topology;
  pbf_pressure_grid_box nodes = *box;
  int i[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) {
    i[k] = nodes.first[k] = box->first[k] > 1 ? box->first[k] : 1;
    nodes.last[k] = (box->last[k] < c->n[k] ? box->last[k] : c->n[k]) + 1;
  }
  do {
    uint32_t row = pbf_pressure_grid_row(c, i);
    for (i[0] = nodes.first[0]; i[0] <= nodes.last[0]; ++i[0]) {
      const uint32_t node = row + (uint32_t)i[0];
      if (t->is_active && t->torn[node]) continue;
      storage->depths[node] = pbf_pressure_grid_node_depth(c, t, storage->sums, storage->places,
                                                           storage->free_volumes, node, i);
    }
  } while (pbf_pressure_grid_next_row(&nodes, i));
  for (uint32_t k = 0; k < pbf_pressure_grid_torn_count(t); ++k)
    storage->depths[t->torn_at[k]] = pbf_pressure_grid_torn_depth(
        c, t, storage->sums, storage->places, storage->free_volumes, k);
}

/* What solids gain at a node, or one that it is a copy of. */
static inline pbf_node_gain pbf_pressure_grid_gain_at(const pbf_pressure_grid_storage *storage,
                                                      uint32_t node) {
  const pbf_pressure_grid *c = &storage->grid;
  const pbf_obstacles *o = storage->gaining;
  int i[PBF_DIM];
  pbf_pressure_grid_place(c, node, i);
  pbf_node_gain gain = pbf_node_gain_begin(c, i);
  const double reach = gain.nearest * (o->grid ? o->grid->steepest : 1);
  const pbf_obstacles near = pbf_obstacles_near(*o, gain.x, (pbf_real)reach);
  for (int k = 0; k < pbf_surface_count(near); ++k) pbf_node_gain_look(&near.surfaces[k], &gain);
  for (int k = 0; k < pbf_surface_count(near); ++k)
    pbf_node_gain_settle(c, &near.surfaces[k], &gain);
  return gain;
}

/* The equations of torn nodes, which are none of the others; returns the largest right side of one
 * that is not in the open. */
static inline double pbf_pressure_grid_torn_equations(
    pbf_pressure_grid_storage *storage, const pbf_pressure_grid_source_scale *source_scale) {
  const pbf_pressure_grid_topology *t = &storage->topology;
  double largest = 0;
  for (uint32_t k = 0; k < pbf_pressure_grid_torn_count(t); ++k) {
    pbf_pressure_grid_torn_equation(&storage->grid, t, source_scale, storage->sums, storage->places,
                                    storage->free_volumes, storage->depths, k);
    if (storage->cell_moves && t->inverse[k] > 0)
      t->right[k] += pbf_moves_at_torn_node(&storage->grid, t, source_scale->part, storage->sums,
                                            storage->cell_moves, storage->free_volumes, k);
    if (storage->gaining && t->inverse[k] > 0) {
      const pbf_node_gain gain = pbf_pressure_grid_gain_at(storage, t->base[k]);
      t->right[k] += pbf_gain_at_torn_node(&storage->grid, t, source_scale->part,
                                           storage->free_volumes, &gain, k);
    }
    if (t->inverse[k] > 0) largest = pbf_max(largest, fabs(t->right[k]));
  }
  return largest;
}

/* What forces that differ from particle to particle, and solids that gain, add to a node's right
 * side. */
static inline double pbf_pressure_grid_moves_at(const pbf_pressure_grid_storage *storage,
                                                const pbf_pressure_grid_source_scale *source_scale,
                                                uint32_t node) {
  double right = 0;
  if (storage->gaining) {
    const pbf_node_gain gain = pbf_pressure_grid_gain_at(storage, node);
    right +=
        pbf_gain_at_node(&storage->grid, source_scale->part, storage->free_volumes, &gain, node);
  }
  if (storage->cell_moves)
    right += pbf_moves_at_node(&storage->grid, source_scale->part, storage->sums,
                               storage->cell_moves, storage->free_volumes, node);
  return right;
}

static inline void pbf_pressure_grid_guess_torn(pbf_pressure_grid_storage *storage, double part) {
  const pbf_pressure_grid_topology *t = &storage->topology;
  for (uint32_t k = 0; k < pbf_pressure_grid_torn_count(t); ++k) {
    const double lambda = pbf_pressure_grid_torn_guess(&storage->grid, t, part, storage->inverse,
                                                       storage->free_volumes, storage->depths, k);
    storage->lambda[t->torn_at[k]] = storage->before[t->torn_at[k]] = t->before[k] = lambda;
  }
}

/* Where the solve starts, once all have an equation. */
static inline void pbf_pressure_grid_guess_all(pbf_pressure_grid_storage *storage,
                                               const pbf_pressure_grid_source_scale *source_scale) {
  const pbf_pressure_grid *c = &storage->grid;
  const pbf_pressure_grid_topology *t = &storage->topology;
  pbf_pressure_grid_guess_torn(storage, source_scale->part);
  for (uint32_t column = 0; column < pbf_pressure_grid_columns(c); ++column)
    pbf_pressure_grid_guess(c, t, source_scale->part, storage->inverse, storage->free_volumes,
                            storage->depths, column, storage->lambda);
  memcpy(storage->before, storage->lambda, c->nodes * sizeof *storage->lambda);
}

/* An iteration has written to `before`. */
static inline void pbf_pressure_grid_swap(pbf_pressure_grid_storage *storage) {
  double *now = storage->before;
  for (uint32_t k = 0; k < pbf_pressure_grid_torn_count(&storage->topology); ++k)
    pbf_pressure_grid_end_torn(&storage->topology, storage->lambda, now, k);
  storage->before = storage->lambda;
  storage->lambda = now;
}

/* After the last iteration: lambda goes on beyond the surface, in a box of nodes. */
static inline void pbf_pressure_grid_extrapolate(pbf_pressure_grid_storage *storage,
                                                 const pbf_pressure_grid_box *nodes) {
  const pbf_pressure_grid *c = &storage->grid;
  const pbf_pressure_grid_topology *t = &storage->topology;
  const double *depths = storage->depths, *free_volumes = storage->free_volumes;
  double *lambda = storage->lambda;
  int i[PBF_DIM];
  memcpy(i, nodes->first, sizeof i);
  do {
    uint32_t row = pbf_pressure_grid_row(c, i);
    for (i[0] = nodes->first[0]; i[0] <= nodes->last[0]; ++i[0]) {
      const uint32_t node = row + (uint32_t)i[0];
      if (pbf_pressure_grid_is_open(depths[node]) && !(t->is_active && t->torn[node]))
        lambda[node] = pbf_pressure_grid_node_beyond(c, t, depths, free_volumes, lambda, node, i,
                                                     nodes->first, nodes->last);
    }
  } while (pbf_pressure_grid_next_row(nodes, i));
  for (uint32_t k = 0; k < pbf_pressure_grid_torn_count(t); ++k)
    if (pbf_pressure_grid_is_open(depths[t->torn_at[k]]))
      lambda[t->torn_at[k]] = pbf_pressure_grid_torn_beyond(c, t, depths, free_volumes, lambda, k);
}

/* Once particles have been moved, in a box of cells outside which there is no fluid. The right
 * sides and what was before have been read, and are room for what is found. */
static inline void pbf_pressure_grid_find_datum(pbf_pressure_grid_storage *storage,
                                                const pbf_pressure_grid_box *cells) {
  const pbf_pressure_grid *c = &storage->grid;
  const pbf_pressure_grid_topology *t = &storage->topology;
  const uint32_t torn = pbf_pressure_grid_torn_count(t);
  const pbf_pressure_datum d = {c,
                                t,
                                storage->sums,
                                storage->places,
                                storage->free_volumes,
                                storage->inverse,
                                storage->lambda,
                                (int64_t *)storage->right,
                                (int64_t *)storage->before};
  const auto each_compartment = [&](auto visit) {
    int i[PBF_DIM];
    memcpy(i, cells->first, sizeof i);
    do {
      const uint32_t row = pbf_pressure_grid_row(c, i);
      for (int x = cells->first[0]; x <= cells->last[0]; ++x) visit(row + (uint32_t)x);
    } while (pbf_pressure_grid_next_row(cells, i));
    for (uint32_t k = t->first; k < pbf_pressure_grid_last_further(t); ++k) visit(k);
  };
  const auto each_node = [&](auto visit) {
    for (uint32_t k = 0; k < c->nodes; ++k) visit(k, storage->inverse[k] > 0);
    for (uint32_t k = 0; k < torn; ++k) visit(t->torn_at[k], t->inverse[k] > 0);
  };
  each_node([&](uint32_t node, bool) { pbf_datum_begin(&d, node); });
  each_compartment([&](uint32_t compartment) { pbf_datum_join(&d, compartment); });
  each_compartment([&](uint32_t compartment) { pbf_datum_note(&d, compartment); });
  each_node([&](uint32_t node, bool solved) {
    if (solved) pbf_datum_end(&d, node);
  });
  each_node([&](uint32_t node, bool) { storage->right[node] = storage->before[node] = 0; });
}

/* The lambda over particles that has the grid's pressure at x. */
static inline pbf_real pbf_pressure_grid_particle_lambda(const pbf_pressure_grid_storage *storage,
                                                         pbf_real pressure, pbf_real inv_time_step,
                                                         pbf_vec x) {
  double at[PBF_DIM];
  uint32_t cell = pbf_pressure_grid_find(storage, x, at);
  if (cell == PBF_NO_INDEX) return 0;
  double lambda =
      pbf_pressure_grid_lambda(&storage->grid, &storage->topology, storage->lambda, cell, at);
  return (pbf_real)(storage->carried * lambda * (double)inv_time_step * (double)inv_time_step /
                    (double)pressure);
}

/* The grid's pressure around x over the reference density, and its slope: means over a cube so many
 * cells wide. */
static inline double pbf_pressure_grid_pressure(const pbf_pressure_grid_storage *storage,
                                                double time_step, pbf_vec x, double cube,
                                                double slope[PBF_DIM]) {
  double at[PBF_DIM];
  const uint32_t cell = pbf_pressure_grid_find(storage, x, at);
  for (int k = 0; k < PBF_DIM; ++k) slope[k] = 0;
  if (cell == PBF_NO_INDEX) return 0;
  const double scale = -storage->carried / (time_step * time_step);
  const double lambda = pbf_pressure_grid_lambda_sloped(&storage->grid, &storage->topology,
                                                        storage->lambda, cell, at, cube, slope);
  for (int k = 0; k < PBF_DIM; ++k) slope[k] *= scale;
  return scale * lambda;
}

/* Whether there may be pressure in a cell. */
static inline bool pbf_pressure_grid_has_pressure(const pbf_pressure_grid_storage *storage,
                                                  uint32_t cell) {
  double values[PBF_CORNERS];
  if (pbf_cell_is_cut(&storage->topology, cell)) return true;
  pbf_pressure_grid_corners(&storage->grid, &storage->topology, storage->lambda, cell, values);
  return pbf_pressure_grid_deepest(values) < 0;
}

#endif
