/* What is asked of spray, foam and bubbles. */
#include <math.h>

#include "diffuse.h"
#include "error.h"
#include "physics/spacing.h"
#include "solver/handles.h"
#include "structs.h"
#include "text.h"

#define COUNT(member, min, max, hint) \
  { #member, offsetof(pbf_diffuse_desc, member), min, max, hint, 0 }
#define REAL(member) \
  { #member, offsetof(pbf_diffuse_desc, member), 1, PBF_AT_LEAST_ZERO, 0 }
#define LENGTH(array) (sizeof(array) / sizeof((array)[0]))

static const double pi = 3.14159265358979323846;

/* ---- Checks ---------------------------------------------------------------------------------- */

static const pbf_count_rule counts[] = {
    COUNT(capacity, 1, PBF_MAX_DIFFUSE, ""),
    COUNT(interval, 1, 1000, ""),
    COUNT(foam_neighbors, 0, 100000, ""),
    COUNT(bubble_neighbors, 0, 100000, ""),
};

static const pbf_real_rule reals[] = {
    REAL(trapped_air_min), REAL(trapped_air_max), REAL(wave_crest_min),   REAL(wave_crest_max),
    REAL(energy_min),      REAL(energy_max),      REAL(trapped_air_rate), REAL(wave_crest_rate),
    REAL(lifetime_min),    REAL(lifetime_max),    REAL(buoyancy),         REAL(bubble_drag),
    REAL(spray_drag),      REAL(scatter),
};

static pbf_status check_order(const char *name, double min, double max, int may_be_equal) {
  char text[2][PBF_NUMBER_SIZE];
  if (may_be_equal ? max >= min : max > min) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "desc.%s_max is %s; it must be %s %s_min, %s", name,
                  pbf_text_number(text[0], max), may_be_equal ? "at least" : "above", name,
                  pbf_text_number(text[1], min));
}

pbf_status pbf_diffuse_check(const pbf_diffuse_desc *desc, pbf_check_kind kind) {
  pbf_status status = pbf_check_counts(counts, LENGTH(counts), "desc", desc);
  if (status == PBF_OK && desc->bubble_neighbors < desc->foam_neighbors)
    status = pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "desc.bubble_neighbors is %u; it must be at least foam_neighbors, %u",
                      desc->bubble_neighbors, desc->foam_neighbors);
  if (status == PBF_OK) status = pbf_check_reals(reals, LENGTH(reals), "desc", desc, kind);
  if (status == PBF_OK)
    status = check_order("trapped_air", desc->trapped_air_min, desc->trapped_air_max, 0);
  if (status == PBF_OK)
    status = check_order("wave_crest", desc->wave_crest_min, desc->wave_crest_max, 0);
  if (status == PBF_OK) status = check_order("energy", desc->energy_min, desc->energy_max, 0);
  if (status == PBF_OK) status = check_order("lifetime", desc->lifetime_min, desc->lifetime_max, 1);
  return status;
}

/* ---- Defaults -------------------------------------------------------------------------------- */

/* Speeds and times of a scene that is `spacing` fine: a particle falls by half of it in one unit
 * of time, and is as fast as one unit then. Without gravity the time step stands for that. */
static void find_units(const pbf_params *params, uint32_t dimension, double *time, double *speed) {
  const double spacing = pbf_derive_spacing(params);
  double square = 0;
  for (uint32_t k = 0; k < dimension; ++k) square += params->gravity[k] * params->gravity[k];
  *time = square > 0 ? sqrt(spacing / sqrt(square)) : 10 * params->time_step;
  *speed = spacing / *time;
}

/* Inside of the fluid, on the average. */
static double mean_neighbors(const pbf_params *params, uint32_t dimension) {
  const double reach = params->smoothing_radius / pbf_derive_spacing(params);
  return dimension == 3 ? 4 * pi / 3 * reach * reach * reach : pi * reach * reach;
}

static void fill(const pbf_params *params, uint32_t dimension, pbf_diffuse_desc *desc) {
  const double neighbors = mean_neighbors(params, dimension);
  double time, speed;
  find_units(params, dimension, &time, &speed);
  *desc = (pbf_diffuse_desc){
      .struct_size = sizeof *desc,
      .capacity = 50000,
      .interval = 1,
      .foam_neighbors = (uint32_t)fmin(ceil(0.18 * neighbors), 100000),
      .bubble_neighbors = (uint32_t)fmin(ceil(0.6 * neighbors), 100000),
      .trapped_air_min = 0.5 * speed,
      .trapped_air_max = 2 * speed,
      .wave_crest_min = 0.1,
      .wave_crest_max = 0.4,
      .energy_min = 3 * speed * speed,
      .energy_max = 30 * speed * speed,
      .trapped_air_rate = 50 / time,
      .wave_crest_rate = 200 / time,
      .lifetime_min = 50 * time,
      .lifetime_max = 150 * time,
      .buoyancy = 2,
      .bubble_drag = 4 / time,
      .scatter = 0.1,
  };
}

static pbf_status init(const pbf_solver *solver, pbf_diffuse_desc *theirs, uint32_t struct_size) {
  pbf_diffuse_desc desc;
  if (!theirs) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "desc is null");
  pbf_status status = pbf_struct_check_size(&pbf_kind_diffuse_desc, struct_size);
  if (status != PBF_OK) return status;
  fill(&solver->params, solver->kind.dimension, &desc);
  pbf_struct_out(&pbf_kind_diffuse_desc, &desc, theirs, struct_size);
  return PBF_OK;
}

pbf_status pbf_diffuse_init(pbf_solver *solver, pbf_diffuse_desc *desc, uint32_t struct_size) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, init(solver, desc, struct_size));
}
