/* What phases may be, by themselves and with what parameters. */
#include "phases.h"

#include <math.h>
#include <stdio.h>

#include "check.h"
#include "error.h"

static const double max_ratio = 1000;

static pbf_status check_phase(const pbf_phase *phase, uint32_t index, pbf_check_kind kind) {
  static const pbf_real_rule rules[] = {
      {"rest_density", offsetof(pbf_phase, rest_density), 1, PBF_ABOVE_ZERO, 0},
      {"viscosity", offsetof(pbf_phase, viscosity), 1, PBF_FRACTION, 0}};
  char label[32];
  snprintf(label, sizeof label, "phases[%u]", index);
  pbf_status status = pbf_check_reals(rules, 2, label, phase, kind);
  if (status != PBF_OK) return status;
  if (phase->rest_density * max_ratio >= 1 && phase->rest_density <= max_ratio) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s.rest_density is %.9g; it must be 0.001 … 1000",
                  label, phase->rest_density);
}

pbf_status pbf_phases_check_number(const pbf_phases *phases, const char *list, uint32_t index,
                                   uint32_t phase) {
  if (phase < pbf_phases_count(phases)) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "%s[%u].phase is %u; it must be below the number of phases, %u", list, index,
                  phase, pbf_phases_count(phases));
}

static int is_usual(const pbf_phase *phase) {
  return !(phase->rest_density < 1 || phase->rest_density > 1 || phase->viscosity < 1);
}

pbf_status pbf_phases_check(pbf_phases *phases, pbf_check_kind kind) {
  uint32_t lightest = 0, heaviest = 0;
  phases->differ = 0;
  for (uint32_t i = 0; i < phases->count; ++i) {
    pbf_status status = check_phase(&phases->of[i], i, kind);
    if (status != PBF_OK) return status;
    if (phases->of[i].rest_density < phases->of[lightest].rest_density) lightest = i;
    if (phases->of[i].rest_density > phases->of[heaviest].rest_density) heaviest = i;
    phases->differ |= !is_usual(&phases->of[i]);
  }
  const double most = max_ratio * phases->of[lightest].rest_density * (1 + 1e-9);
  if (phases->of[heaviest].rest_density <= most) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "phases[%u].rest_density is %.9g and phases[%u].rest_density %.9g; the heaviest "
                  "phase may be 1000 times as heavy as the lightest",
                  heaviest, phases->of[heaviest].rest_density, lightest,
                  phases->of[lightest].rest_density);
}

/* What a grid carries of these fluids is more than nothing: physics/phases.h of the backends. */
static int has_grid(const pbf_phases *phases) {
  double lightest = HUGE_VAL, heaviest = 0;
  for (uint32_t i = 0; i < phases->count; ++i) {
    lightest = fmin(lightest, phases->of[i].rest_density);
    heaviest = fmax(heaviest, phases->of[i].rest_density);
  }
  return 3 * lightest > heaviest;
}

static pbf_status refuse(const char *name, double value) {
  return pbf_fail(PBF_ERROR_UNSUPPORTED,
                  "params.%s is %.9g and phases differ in rest_density or viscosity; %s knows of "
                  "one fluid alone, and must be 0 with them",
                  name, value, name);
}

pbf_status pbf_phases_check_params(const pbf_phases *phases, const pbf_params *params) {
  if (!phases || !phases->differ) return PBF_OK;
  if (params->pressure_grid > 0 && !has_grid(phases))
    return pbf_fail(PBF_ERROR_UNSUPPORTED,
                    "params.pressure_grid is %.9g and a phase has a rest_density of a third of the "
                    "heaviest one's or less; a grid carries none of that, and must be 0 or -1",
                    params->pressure_grid);
  if (params->surface_tension > 0) return refuse("surface_tension", params->surface_tension);
  if (params->viscosity > 0 && params->solver == PBF_SOLVER_JACOBI)
    return pbf_fail(
        PBF_ERROR_UNSUPPORTED,
        "params.viscosity is %.9g with PBF_SOLVER_JACOBI, and phases differ in "
        "rest_density or viscosity; XSPH knows of one fluid alone, PBF_SOLVER_CHEBYSHEV "
        "of several",
        params->viscosity);
  return PBF_OK;
}
