/* Parameters by purpose, from the particles' distance d and the height H of the highest fall, in
 * metres and seconds. Copy the one that you want. */
#ifndef PBF_PRESETS_H
#define PBF_PRESETS_H

#include <math.h>
#include <pbf/pbf.h>

/* code: begin */
/* What all of them have. The domain is the caller's. */
static inline void preset_begin(pbf_params *params, double d, double H) {
  pbf_params_init(params, sizeof *params);
  params->spacing = d;
  params->smoothing_radius = 2 * d;
  params->time_step = d / sqrt(2 * 9.81 * H); /* what falls by H goes a spacing a step */
}
/* end */

/* code: game */
/* Two steps a frame; whatever is too fast for them gets shorter ones. Water at rest sleeps. */
static inline void preset_game(pbf_params *params, double d, double H) {
  preset_begin(params, d, H);
  params->time_step = 1.0 / 120;
  params->iterations = 3;
  params->max_substeps = 4;
  params->sleep_speed = 0.1 * sqrt(9.81 * d);
  params->sleep_time = 0.5;
}
/* end */

/* code: film */
/* Half the step, twice the iterations: waves and splashes that keep their energy. */
static inline void preset_film(pbf_params *params, double d, double H) {
  preset_begin(params, d, H);
  params->time_step /= 2;
  params->iterations = 8;
  params->max_substeps = 8;
  params->damping_compensation = 1;
  params->pressure_grid = 2;
}
/* end */

/* code: research */
/* A wide kernel, a short step, and as many iterations as the density wants. */
static inline void preset_research(pbf_params *params, double d, double H) {
  preset_begin(params, d, H);
  params->smoothing_radius = 3 * d;
  params->time_step /= 4;
  params->iterations = 16;
  params->tolerance = 2e-4;
  params->cohesion = 1;
  params->damping_compensation = 1;
}
/* end */

/* code: thick */
/* Batter, paint, mud: 0.05 m²/s is fifty thousand times water. It sticks to walls. */
static inline void preset_thick(pbf_params *params, double d, double H) {
  preset_begin(params, d, H);
  params->viscosity = 0.05;
  params->wall_no_slip = 1;
  params->max_substeps = 8;
}
/* end */

/* code: replay */
/* The same bits on machines that differ: CPUs, whatever their instruction sets. No limit of time
 * decides how far a solve goes, nor does the number of threads. */
static inline void preset_replay(pbf_desc *desc, pbf_params *params, double d, double H) {
  preset_begin(params, d, H);
  params->max_substeps = 8; /* found from the state alone: the same in each run */
  pbf_desc_init(desc, sizeof *desc);
  desc->backend = "threads";
  desc->strict = 1; /* no other backend instead */
}
/* end */

#endif
