/* Part of pressure_grid.h: where the pressure grid lies on a host, and what thin solids and
 * periodic faces divide it into. */
#ifndef PBF_COMMON_PRESSURE_GRID_TOPOLOGY_H
#define PBF_COMMON_PRESSURE_GRID_TOPOLOGY_H

#include "common/pressure_grid_memory.h"
#include "physics/pressure_grid/division.h"
#include "physics/pressure_grid/samples.h"

static inline void pbf_pressure_grid_divide_cells(const pbf_pressure_grid *c,
                                                  const pbf_pressure_grid_topology *t) {
  int i[PBF_DIM];
  memset(t->counts, 0, PBF_TOPOLOGY_COUNTS * sizeof *t->counts);
  memset(t->links, 0, c->nodes * sizeof *t->links);
  memset(t->merged, 0, (uint64_t)c->nodes * PBF_PARTS * sizeof *t->merged);
  memset(t->touched, 0, c->nodes * sizeof *t->touched);
  memset(t->corners, 0, (uint64_t)c->nodes * PBF_CORNERS * sizeof *t->corners);
  for (uint32_t cell = 0; cell < c->nodes; ++cell) {
    pbf_pressure_grid_place(c, cell, i);
    if (pbf_cell_is_inside(c, i)) pbf_divide_cell(c, t, cell, i);
  }
  for (uint32_t cell = 0; cell < c->nodes; ++cell) {
    pbf_pressure_grid_place(c, cell, i);
    pbf_link_cell(c, t, cell, i);
  }
  for (uint32_t cell = 0; cell < c->nodes; ++cell) pbf_merge_compartments(c, t, cell);
}

static inline void pbf_pressure_grid_tear_nodes(const pbf_pressure_grid *c,
                                                const pbf_pressure_grid_topology *t) {
  memset(t->torn, 0, t->limit * sizeof *t->torn);
  for (uint32_t node = 0; node < c->nodes; ++node)
    if (pbf_node_is_inside(c, node)) pbf_tear_node(c, t, node);
  for (uint32_t node = 0; node < c->nodes; ++node)
    if (pbf_node_is_inside(c, node)) pbf_list_torn_node(c, t, node);
}

static inline int pbf_pressure_grid_has_thin(const pbf_pressure_grid *c, const pbf_obstacles *o) {
  int any = 0;
  for (int k = 0; k < pbf_surface_count(*o); ++k) any |= pbf_surface_is_thin(c, &o->surfaces[k]);
  return any;
}

/* Whether nothing has moved since the last step: all that is found again would be the same. */
static inline int pbf_pressure_grid_stands(const pbf_pressure_grid_storage *storage,
                                           const pbf_pressure_grid *now, const pbf_obstacles *o) {
  const pbf_obstacles *of = &storage->obstacles;
  return storage->topology.counts[PBF_TOPOLOGY_FOUND] &&
         memcmp(&storage->grid, now, sizeof *now) == 0 && of->count == o->count &&
         memcmp(&of->domain, &o->domain, sizeof o->domain) == 0 &&
         (o->count == 0 || memcmp(of->surfaces.all, o->surfaces.all,
                                  (size_t)o->count * sizeof *o->surfaces.all) == 0);
}

/* Finds, from a cell's middle, the surfaces that matter to the cell. */
static inline void pbf_pressure_grid_reach(const pbf_pressure_grid *c, const pbf_obstacles *o) {
  const double reach = 1.01 * (pbf_cell_reach(c) + c->width / PBF_SAMPLES);
  if (o->grid && o->grid->reach < o->grid->steepest * reach)
    pbf_grid_build(o->grid, o->grid->count, &o->domain, o->grid->steepest * reach);
}

/* `surfaces` is room for as many as there are. */
static inline void pbf_pressure_grid_note_surfaces(pbf_pressure_grid_storage *storage,
                                                   const pbf_obstacles *o, pbf_surface *surfaces) {
  pbf_pressure_grid_topology *t = &storage->topology;
  if (o->count > 0) memcpy(surfaces, o->surfaces.all, (size_t)o->count * sizeof *surfaces);
  storage->obstacles = *o;
  storage->obstacles.surfaces.all = t->surfaces = surfaces;
  t->is_active = 1;
  t->surface_count = o->count;
  t->domain = o->domain;
  t->grid = o->grid;
  t->built = o->grid ? o->grid->built : 0;
}

/* The grid between these walls; where there are thin solids, in fewer of the indices, and with what
 * they divide it into. */
static inline void pbf_pressure_grid_place_over(
    pbf_pressure_grid_storage *storage, const pbf_topology_memory *memory, const pbf_params *params,
    int corrects_shear, const pbf_domain *domain, double time, uint32_t capacity, uint32_t count,
    const pbf_fluid_bounds *fluid, const pbf_obstacles *o, pbf_surface *surfaces) {
  uint64_t limit = pbf_pressure_grid_limit(count);
  pbf_pressure_grid_topology *t = &storage->topology;
  pbf_pressure_grid now = pbf_pressure_grid_between(params, domain, corrects_shear, limit, fluid);
  pbf_pressure_grid_set_gains(&now, params, domain, time);
  *t = pbf_pressure_grid_topology_in(memory->bytes, pbf_pressure_grid_max_nodes(capacity), limit);
  if (!memory->bytes ||
      !(pbf_pressure_grid_has_thin(&now, o) || pbf_pressure_grid_is_periodic(&now))) {
    storage->grid = now;
    pbf_pressure_grid_reach(&now, o);
    return;
  }
  now = pbf_pressure_grid_between(params, domain, corrects_shear,
                                  pbf_pressure_grid_first_further(limit), fluid);
  pbf_pressure_grid_set_gains(&now, params, domain, time);
  const int stands = pbf_pressure_grid_stands(storage, &now, o);
  storage->grid = now;
  pbf_pressure_grid_reach(&now, o);
  pbf_pressure_grid_note_surfaces(storage, o, surfaces);
  if (!stands) {
    pbf_pressure_grid_divide_cells(&storage->grid, t);
    pbf_pressure_grid_tear_nodes(&storage->grid, t);
    t->counts[PBF_TOPOLOGY_FOUND] = 1;
  }
  memset(storage->sums + t->first, 0, t->max_further * sizeof *storage->sums);
  memset(storage->places + t->first, 0, t->max_further * sizeof *storage->places);
  if (storage->cell_moves)
    memset(storage->cell_moves + (uint64_t)PBF_DIM * t->first, 0,
           (uint64_t)PBF_DIM * t->max_further * sizeof *storage->cell_moves);
}

/* Whether it is divided by a shape that none of these colliders has. */
static inline bool pbf_topology_loses_shape(const pbf_pressure_grid_storage *storage,
                                            uint32_t count, const pbf_collider *colliders) {
  const pbf_pressure_grid_topology *t = &storage->topology;
  for (int k = 0; k < t->surface_count; ++k) {
    const pbf_shape *field = t->surfaces[k].field;
    if (!field || ((uint32_t)k < count && colliders[k].geometry == field)) continue;
    uint32_t c = 0;
    while (c < count && colliders[c].geometry != field) ++c;
    if (c == count) return true;
  }
  return false;
}

#endif
