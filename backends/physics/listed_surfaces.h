/* Ways of particles among many surfaces that a grid lists (surfaces/near.h), one by one and without
 * memory: for a thread that has none of its own. To the bit as if all had been asked. */
#ifndef PBF_PHYSICS_LISTED_SURFACES_H
#define PBF_PHYSICS_LISTED_SURFACES_H

#include "physics/bounds.h"

/* The surfaces that some cells list, in the order of their numbers: those of one cell one after
 * another, and of several always the lowest number that comes next. */
struct surfaces_in_cells {
  const pbf_surface *all;
  const pbf_surface_grid *grid;
  const uint16_t *numbers; /* null: of several cells */
  int count;
  pbf_cell_range cells;

  template <class Visit>
  PBF_IN void each(Visit visit) const;
};

/* The lowest number after `last`, and before `next`, in a cell; or `next`. */
PBF_FN int next_in_cell(const pbf_surface_grid *grid, uint32_t cell, int last, int next) {
  const uint16_t *numbers;
  const uint32_t entries = pbf_cell_entries(grid, cell, &numbers);
  for (uint32_t k = 0; k < entries && numbers[k] < next; ++k)
    if (numbers[k] > last) return numbers[k];
  return next;
}

/* … in any of the cells; -1: there is none. */
PBF_FN_NOINLINE int next_in_cells(const surfaces_in_cells &of, int last) {
  const pbf_cell_range &r = of.cells;
  const int levels = PBF_DIM == 3 ? r.last[PBF_DIM - 1] : 0, most = (int)PBF_MAX_COLLIDERS;
  int next = most;
  for (int z = PBF_DIM == 3 ? r.first[PBF_DIM - 1] : 0; z <= levels; ++z)
    for (int y = r.first[1]; y <= r.last[1]; ++y)
      for (int x = r.first[0]; x <= r.last[0]; ++x)
        next = next_in_cell(
            of.grid, (uint32_t)((z * of.grid->cells[1] + y) * of.grid->cells[0] + x), last, next);
  return next < most ? next : -1;
}

template <class Visit>
PBF_IN void surfaces_in_cells::each(Visit visit) const {
  int last = -1;
  for (int k = 0;; ++k) {
    if (numbers) {
      if (k >= count) return;
      last = numbers[k];
    } else {
      last = next_in_cells(*this, last);
      if (last < 0) return;
    }
    visit(all[last]);
  }
}

/* Those that may be within `reach` of something in a box. */
PBF_FN surfaces_in_cells surfaces_around(const pbf_surface *all, const pbf_surface_grid *grid,
                                         pbf_vec lower, pbf_vec upper, double reach) {
  double low[PBF_DIM], high[PBF_DIM];
  surfaces_in_cells found = {all, grid, nullptr, 0, {}};
  for (int k = 0; k < PBF_DIM; ++k) {
    low[k] = (double)lower.c[k];
    high[k] = (double)upper.c[k];
  }
  found.cells = pbf_cells_between(grid, low, high, fmax(reach - grid->reach, 0.0));
  if (pbf_cells_in(&found.cells) == 1)
    found.count = (int)pbf_surfaces_at(grid, lower, &found.numbers);
  return found;
}

/* Those that may have something to do with a particle there that gets no farther than `way` by
 * itself. */
PBF_FN surfaces_in_cells surfaces_around_way(const pbf_surface *all, const pbf_surface_grid *grid,
                                             pbf_vec lower, pbf_vec upper, pbf_real way) {
  const double longer = (1 + (double)bounds_rounding) * (double)way;
  return surfaces_around(all, grid, lower, upper, grid->stretch * longer);
}

/* Those that `bounds` may meet, which others push on by as much as `pushed`. */
struct surfaces_met_by {
  surfaces_in_cells of;
  const group_bounds *bounds;
  int with_obstacle_motion;
  pbf_real pushed;

  template <class Visit>
  PBF_IN void each(Visit visit) const {
    of.each([&](const pbf_surface &s) {
      if (bounds_may_meet(bounds, &s, with_obstacle_motion, pushed)) visit(s);
    });
  }
};

/* A way that touches one of them. Those that push a particle may push it to others, which push it
 * in turn: they are looked for until no more come in. */
PBF_FN_NOINLINE pbf_vec resolve_touched(const pbf_domain *domain, const pbf_surface *all,
                                        const pbf_surface_grid *grid, int with_obstacle_motion,
                                        pbf_vec from, pbf_vec x) {
  const group_bounds bounds = bounds_of_way(from, x);
  surfaces_met_by met = {{}, &bounds, with_obstacle_motion, 0};
  pbf_real pushed = 0;
  for (int found = -1; pushed < INFINITY;) {
    int count = 0;
    met.pushed = pushed;
    met.of = surfaces_around_way(all, grid, bounds.lower, bounds.upper, bounds.way + pushed);
    met.each([&](const pbf_surface &) { ++count; });
    if (count == found || count == (int)grid->count) break;
    found = count;
    pushed = way_pushed_by_all(domain, met, &bounds, with_obstacle_motion);
    if (!(pushed > 0)) break;
  }
  return pbf_resolve_among(domain, met, with_obstacle_motion, from, x);
}

/* The same for one that may meet some. */
PBF_FN_NOINLINE pbf_vec resolve_met(const pbf_domain *domain, const pbf_surface *all,
                                    const pbf_surface_grid *grid, int with_obstacle_motion,
                                    pbf_vec from, pbf_vec x, pbf_real way) {
  surfaces_in_cells near = surfaces_around_way(all, grid, from, from, way);
  const pbf_vec kept = pbf_keep_before(domain, near, with_obstacle_motion, from, x);
  const pbf_real kept_way = way_along_axes(from, kept);
  if (kept_way > way) near = surfaces_around_way(all, grid, from, from, way = kept_way);
  const auto on_way = surfaces_on_way_of(near, with_obstacle_motion, from, way);
  if (!pbf_touches_any(on_way, with_obstacle_motion, from, kept)) return kept;
  return resolve_touched(domain, all, grid, with_obstacle_motion, from, x);
}

/* Whether a particle may meet one of them, by balls around them; a way that is long for the cells
 * may. */
PBF_FN bool may_meet_listed(const pbf_surface *all, const pbf_surface_grid *grid,
                            int with_obstacle_motion, pbf_vec from, pbf_real way) {
  const uint16_t *numbers;
  if (!(grid->stretch * (1 + (double)bounds_rounding) * (double)way < grid->reach)) return true;
  const int count = (int)pbf_surfaces_at(grid, from, &numbers);
  const auto listed = surface_array_of(count, pbf_surface_list{all, numbers});
  bool met = false;
  surfaces_on_way_of(listed, with_obstacle_motion, from, way).each([&](const pbf_surface &) {
    met = true;
  });
  return met;
}

/* A particle on its way from `from` to x, see pbf_resolve_collisions. Nearly all are near none. */
PBF_FN pbf_vec resolve_among_listed(const pbf_domain *domain, const pbf_surface *all,
                                    const pbf_surface_grid *grid, int with_obstacle_motion,
                                    pbf_vec from, pbf_vec x) {
  const pbf_vec kept = pbf_keep_in_domain(domain, x);
  const pbf_real way = pbf_real_max(way_along_axes(from, x), way_along_axes(from, kept));
  if (!may_meet_listed(all, grid, with_obstacle_motion, from, way)) return kept;
  return resolve_met(domain, all, grid, with_obstacle_motion, from, x, way);
}

#endif
