/* One instruction set's loops of one variant; see kernels.h. */
#include "cpu/kernels_corrections.h"
#include "cpu/kernels_grid_loads.h"
#include "cpu/kernels_loads.h"
#include "cpu/kernels_pressure_grid.h"
#include "cpu/kernels_pairs.h"
#include "cpu/kernels_particles.h"
#include "cpu/kernels_search.h"

/* What needs the mean of the velocities around a particle. */
enum {
  VELOCITY_MEANS = PBF_FEATURE_VISCOSITY | PBF_FEATURE_SLEEP | PBF_FEATURE_DAMPING_COMPENSATION
};

extern "C" const kernels PBF_VARIANT_API;

const kernels PBF_VARIANT_API = {
    .width = WIDTH,
    .predict = predict,
    .backtrack = backtrack,
    .bounds = bounds,
    .cells = cells,
    .collide = collide,
#ifdef LANES_QUADS
    .pack = pack,
#endif
    .search = search_groups,
    .lambda = lambda,
    .move = move,
    .curl = PBF_BUILT & PBF_FEATURE_VORTICITY ? curl : NULL,
    .confine = PBF_BUILT & PBF_FEATURE_VORTICITY ? confine : NULL,
    .missing_neighbors = PBF_BUILT & PBF_FEATURE_SURFACE_TENSION ? missing_neighbors : NULL,
    .surface_tension = PBF_BUILT & PBF_FEATURE_SURFACE_TENSION ? surface_tension : NULL,
    .compensate_damping = PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION ? compensate_damping : NULL,
    .torque = PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION ? torque : NULL,
    .angular_rate = PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION ? angular_rate : NULL,
    .turn = PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION ? turn : NULL,
    .deviator = PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION ? deviator : NULL,
    .shear_push = PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION ? shear_push : NULL,
    .shear_stress = PBF_BUILT & PBF_FEATURE_DAMPING_COMPENSATION ? shear_stress : NULL,
    .wake_neighbors = PBF_BUILT & PBF_FEATURE_SLEEP ? wake_neighbors : NULL,
    .viscosity = PBF_BUILT & VELOCITY_MEANS ? viscosity : NULL,
    .crowding = PBF_BUILT & PBF_FEATURE_VISCOSITY ? crowding : NULL,
    .viscous_stress = PBF_BUILT & PBF_FEATURE_VISCOSITY ? viscous_stress : NULL,
    .density = PBF_BUILT & (PBF_FEATURE_STATS | PBF_FEATURE_CHEBYSHEV) ? density : NULL,
    .fit = PBF_BUILT & PBF_FEATURE_CHEBYSHEV ? fit : NULL,
    .placed_density = PBF_BUILT & PBF_FEATURE_CHEBYSHEV ? placed_density : NULL,
    .any_number_around = PBF_BUILT & PBF_FEATURE_CHEBYSHEV ? any_number_around : NULL,
    .residual_density = residual_density,
    .note_pushes = PBF_BUILT & PBF_FEATURE_LOADS ? note_pushes : NULL,
    .loads = !BUILT_FOR_SIZE && PBF_BUILT & PBF_FEATURE_LOADS ? loads : NULL,
    .grid_loads = !BUILT_FOR_SIZE && PBF_BUILT & PBF_FEATURE_LOADS ? grid_loads : NULL,
    .deposit = PBF_BUILT & PBF_FEATURE_PRESSURE_GRID ? deposit : NULL,
    .deposit_moves = PBF_BUILT & PBF_FEATURE_PRESSURE_GRID ? deposit_moves : NULL,
    .apply_correction = PBF_BUILT & PBF_FEATURE_PRESSURE_GRID ? apply_correction : NULL,
    .equations = PBF_BUILT & PBF_FEATURE_PRESSURE_GRID ? equations : NULL,
    .relax = PBF_BUILT & PBF_FEATURE_PRESSURE_GRID ? relax : NULL,
};
