/* Part of executor.h: deep water's stage, the pressure of the fluid's weight on a coarse grid
 * (physics/pressure_grid/grid.h), before the iterations. */
#ifndef PBF_CPU_PRESSURE_GRID_H
#define PBF_CPU_PRESSURE_GRID_H

#include "cpu/lists.h"
#include "cpu/loads.h"
#include "cpu/pressure_grid_solve.h"

#include "cpu/pressure_grid_ranks.h"

static int has_pressure_grid(const worker *w) {
  return (PBF_BUILT & PBF_FEATURE_PRESSURE_GRID) && w->s->schedule.runs[PBF_STAGE_GRID];
}

/* The grid changes when the step can no longer fail: until then it is that of the present state. */
static void end_search_with_grid(void *context) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  end_search(w);
  if (s->wanted.lacking) return;
  s->pressure_grid.cell_moves = s->cell_moves.sums;
  pbf_pressure_grid_begin(&s->pressure_grid, &s->topology_memory, &s->params,
                          s->schedule.corrects_shear, w->placed_at, s->capacity, s->planned,
                          &s->around, &w->obstacles, s->table.divided);
  s->pressure_grid.carried = w->constants.phases.carried;
}

/* Sleepers out of reach of the awake pass for free of error. */
static void deposit_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range all = task_sorted(w, task);
  find_densities(w, task_groups(w, task), &w->obstacles, w->b.sorted_predicted, packed_positions(s),
                 grid_densities(s));
  for (range r = inactive_particles(w, all.first, all.last); r.first < r.last;
       r = inactive_particles(w, r.last, all.last))
    for (uint32_t i = r.first; i < r.last; ++i) grid_densities(s)[i] = w->constants.target;
  s->kernels->deposit(&s->pressure_grid, w->constants.target, w->b.sorted_predicted,
                      grid_densities(s), w->b.sorted_overlap, all.first, all.last);
  if (s->pressure_grid.cell_moves)
    s->kernels->deposit_moves(&s->pressure_grid, w->b.sorted_predicted, w->b.sorted_velocity,
                              w->b.sorted_acceleration, all.first, all.last);
}

static void end_deposit(void *context) {
  worker *w = static_cast<worker *>(context);
  if (has_ranks(w->s)) add_up_cells(w->s);
  find_solve(w->s, &w->obstacles);
  begin_solve(w->s, w->self->threads);
}

static void apply_correction_task(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range all = task_sorted(w, task);
  help_solving(s);
  if (s->pressure_grid_solve.nodes == 0) return; /* lambda is 0 */
  const bool collides = s->schedule.collide_after_prediction && pbf_surface_count(w->obstacles);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    s->kernels->apply_correction(&s->pressure_grid, collides ? &w->obstacles : NULL, s->mobility,
                                 grid_densities(s), w->forces.inv_time_step, w->b.sorted_predicted,
                                 w->b.sorted_velocity, r.first, r.last);
  fill_packed(s, packed_positions(s), &w->b.sorted_predicted, s->mobility, all);
}

/* No more particle is moved by it. */
static void find_datum(solver *s) {
  if (s->pressure_grid_solve.nodes == 0) return;
  pbf_pressure_grid_box cells = s->pressure_grid_solve.inside;
  for (int k = 0; k < PBF_DIM; ++k) --cells.first[k];
  pbf_pressure_grid_find_datum(&s->pressure_grid, &cells);
}

/* What solids get is found in the step. */
static void end_correction(void *context) {
  worker *w = static_cast<worker *>(context);
  if (notes_pushes(w->s)) find_datum(w->s);
}

/* What the weight presses together is undone. */
static void solve_pressure_grid(worker *w) {
  parallel_for(w->self, pair_task_count(w), deposit_task, end_deposit, w);
  parallel_for(w->self, pair_task_count(w), apply_correction_task, end_correction, w);
  stage_end(w, PBF_STAGE_GRID);
}

/* Between steps: lambda of all particles, and with it the pressure, gets what the last step's grid
 * added, by the parameters of that step. No step asks for it. */
static void add_weight(solver *s) {
  if (!(PBF_BUILT & PBF_FEATURE_PRESSURE_GRID) || !s->grid_pressure_pending) return;
  find_datum(s);
  for (uint32_t i = 0; i < s->grid_pressure_pending && s->pressure_scale > 0; ++i)
    s->lambda[i] += pbf_pressure_grid_particle_lambda(
        &s->pressure_grid, s->pressure_scale, s->grid_inv_time_step, field_at(&s->buffers.x, i));
  s->grid_pressure_pending = 0;
}

#endif
