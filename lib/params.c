#include "params.h"

#include <math.h>
#include <string.h>

#include "error.h"
#include "physics/motion.h"
#include "structs.h"

/* Of a periodic axis, in units of h: the images of a pair are then apart (physics/periodic.h). */
enum { PBF_PERIODIC_MIN_WIDTH = 4 };

/* A support of more spacings has thousands of neighbours a particle: a unit gone wrong. */
enum { MAX_SPACINGS = 10 };

#define LENGTH(array) (sizeof(array) / sizeof((array)[0]))

/* The column `when` of params.def: the switch of a rule. */
#define SWITCH_ALWAYS 0
#define SWITCH_WITH(member) offsetof(pbf_params, member)

static const pbf_count_rule counts[] = {
#define PBF_PARAM_INTEGER(offset, name, initial, type, min, max, hint, when, feature, doc) \
  {#name, offsetof(pbf_params, name), min, max, hint, SWITCH_##when},
#include "physics/params.def"
};

static const pbf_real_rule reals[] = {
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  {#name, offsetof(pbf_params, name), 1, PBF_##range, SWITCH_##when},
#define PBF_PARAM_REALS(offset, name, count, initial, low, high, projected, unit, doc) \
  {#name, offsetof(pbf_params, name), count, PBF_ANY, 0},
#include "physics/params.def"
};

static pbf_status check_sleep(const pbf_params *params) {
  if (params->sleep_speed <= 0 || params->sleep_time > 0) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "params.sleep_time is 0; with a sleep_speed (%.9g) it must be above 0, or "
                  "sleep_speed 0",
                  params->sleep_speed);
}

/* The solver has to know the pushes of a whole step. */
static pbf_status check_solver(const pbf_params *params) {
  const char *name = NULL;
  double value = 0;
#define PBF_PARAM_REAL(offset, member, initial, range, when, min_solver, low, high, usual, \
                       feature, projected, unit, doc)                                      \
  if (params->member > 0 && PBF_SOLVER_##min_solver > (int)params->solver)                 \
    name = #member, value = params->member;
#include "physics/params.def"
  if (!name) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "params.%s is %.9g; it must be 0 with PBF_SOLVER_JACOBI, or solver "
                  "PBF_SOLVER_CHEBYSHEV",
                  name, value);
}

static double rest_spacing(const pbf_params *params) {
  return params->spacing > 0 ? params->spacing : params->smoothing_radius / 2;
}

/* Squared gradients of kernels, also of particles that all but coincide, and their sums must be
 * numbers; so must what a backend sums moves in, which is of the size of h cubed in some, more in
 * crowds. tests/api/units.c goes to both ends. */
static pbf_status check_unit(double h, uint32_t precision) {
  int single = precision == PBF_FLOAT32;
  double least = single ? 1e-8 : 1e-75, most = single ? 1e11 : 1e75;
  if (h >= least && h <= most) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "params.smoothing_radius is %.9g; float%d can compute with %.0e … %.0e: choose "
                  "another unit of length%s",
                  h, single ? 32 : 64, least, most, single ? ", or PBF_FLOAT64" : "");
}

/* A particle alone has 1e-5 to 1e4 times the rest density: beyond, a unit has gone wrong, too. */
static pbf_status check_volume(const pbf_params *params, uint32_t dimension) {
  double h = params->smoothing_radius, volume = params->particle_volume;
  double share = volume / (dimension == 2 ? h * h : h * h * h);
  if (volume == 0 || (share >= 1e-6 && share <= 1000)) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "params.particle_volume is %.9g; it must be 0, or 1e-6 … 1000 times "
                  "smoothing_radius to the power of the dimension",
                  volume);
}

static pbf_status check_lengths(const pbf_params *params, pbf_check_kind kind) {
  double h = params->smoothing_radius;
  pbf_status status = check_unit(h, kind.precision);
  if (status == PBF_OK) status = check_volume(params, kind.dimension);
  if (status != PBF_OK) return status;
  if (params->spacing >= h || rest_spacing(params) * MAX_SPACINGS < h) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "params.spacing is %.9g; it must be below smoothing_radius (%.9g) and at least "
                    "a %dth of it, or 0 for half of it",
                    params->spacing, h, MAX_SPACINGS);
  }
  if (params->search_cell_width > 0 && params->search_cell_width < h) {
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "params.search_cell_width is %.9g; it must be at least smoothing_radius "
                    "(%.9g), or 0",
                    params->search_cell_width, h);
  }
  return PBF_OK;
}

/* A fiftieth of a spacing is the least that positions must resolve for a fluid to hold. As at the
 * origin it is with a 4,000th; a domain that is so long that its own end resolves less is taken,
 * as moving it would help little. */
static pbf_status check_resolution(const pbf_params *params, uint32_t precision, int wall,
                                   double bound) {
  enum { FAR = 4 }; /* lengths of the domain from the origin */
  int axis = wall / 2, single = precision == PBF_FLOAT32;
  double length = params->domain_max[axis] - params->domain_min[axis];
  double farthest = fabs(bound) + fabs(params->wall_amplitude[wall]);
  double resolved = farthest * (single ? 0x1p-23 : 0x1p-52), spacing = rest_spacing(params);
  int parts = farthest > FAR * length ? 4000 : 50;
  if (resolved * parts <= spacing) return PBF_OK;
  if (fabs(params->wall_amplitude[wall]) > fabs(bound))
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "params.wall_amplitude[%d] is %.9g, where float%d resolves %.2g; it must be a "
                    "%dth of the spacing (%.2g): the wall is to move less far",
                    wall, params->wall_amplitude[wall], single ? 32 : 64, resolved, parts, spacing);
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "params.domain_%s[%d] is %.9g, where float%d resolves %.2g; it must be a %dth of "
                  "the spacing (%.2g): move the domain to the origin%s",
                  wall & 1 ? "max" : "min", axis, bound, single ? 32 : 64, resolved, parts, spacing,
                  single ? " or use PBF_FLOAT64" : ", and its ends nearer to it");
}

/* The fastest that a particle can be: by the domain's lengths in a step. Its square is a number. */
static pbf_status check_speed(const pbf_params *params, pbf_check_kind kind) {
  const double fastest = kind.precision == PBF_FLOAT32 ? 1e18 : 1e150;
  double way = 0;
  for (uint32_t axis = 0; axis < kind.dimension; ++axis)
    way += params->domain_max[axis] - params->domain_min[axis];
  if (way / params->time_step <= fastest) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "params.time_step is %.9g; it must be at least %.2g, for float%u computes with "
                  "speeds up to %.0e",
                  params->time_step, way / fastest, 8 * kind.precision, fastest);
}

/* What a step multiplies must stay a number: beyond these a factor has been mistaken for another.
 */
static pbf_status check_factors(const pbf_params *params, pbf_check_kind kind) {
  const double h = params->smoothing_radius, step = params->time_step;
  const double fastest = kind.precision == PBF_FLOAT32 ? 1e18 : 1e150;
  const struct {
    const char *name;
    double value, most;
    const char *unit;
  } factors[] = {
      {"over_relaxation", params->over_relaxation, 1e6, ""},
      {"scorr_k", params->scorr_k / (h * h), 1e6, " in units of smoothing_radius²"},
      {"vorticity", params->vorticity * step / h, 1e6, " in units of smoothing_radius / time_step"},
      {"sleep_speed", params->sleep_speed, fastest, ""},
  };
  for (size_t i = 0; i < LENGTH(factors); ++i) {
    if (factors[i].value <= factors[i].most) continue;
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "params.%s is %.9g%s; it must be at most %.0e",
                    factors[i].name, factors[i].value, factors[i].unit, factors[i].most);
  }
  return PBF_OK;
}

/* Both faces are one place, which stands still, and images of a pair must not all be near. */
static pbf_status check_periodic(const pbf_params *params, uint32_t axis) {
  const double length = params->domain_max[axis] - params->domain_min[axis];
  const double least = PBF_PERIODIC_MIN_WIDTH * params->smoothing_radius;
  if (!(params->periodic >> axis & 1)) return PBF_OK;
  if (length < least)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                    "params.periodic has axis %u, along which the domain is %.9g long; it must be "
                    "at least %d smoothing_radius (%.9g)",
                    axis, length, PBF_PERIODIC_MIN_WIDTH, least);
  for (uint32_t wall = 2 * axis; wall < 2 * axis + 2; ++wall)
    if (params->wall_velocity[wall] != 0 || params->wall_amplitude[wall] != 0)
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "params.wall_%s[%u] is %.9g; it must be 0, as params.periodic has axis %u, "
                      "which has no walls",
                      params->wall_velocity[wall] != 0 ? "velocity" : "amplitude", wall,
                      params->wall_velocity[wall] != 0 ? params->wall_velocity[wall]
                                                       : params->wall_amplitude[wall],
                      axis);
  return PBF_OK;
}

static pbf_status check_domain(const pbf_params *params, pbf_check_kind kind, double time) {
  for (uint32_t axis = 0; axis < kind.dimension; ++axis) {
    double low = params->domain_min[axis], high = params->domain_max[axis];
    const char *demand = pbf_check_finite(high - low, kind.precision);
    if (high <= low || demand) {
      return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                      "params.domain_max[%u] is %.9g; it must be above domain_min[%u] (%.9g)%s",
                      axis, high, axis, low, demand ? ", by a finite length" : "");
    }
    pbf_status status = check_resolution(params, kind.precision, (int)(2 * axis), low);
    if (status == PBF_OK)
      status = check_resolution(params, kind.precision, (int)(2 * axis + 1), high);
    if (status == PBF_OK) status = check_periodic(params, axis);
    if (status != PBF_OK) return status;
  }
  pbf_box box = pbf_params_box(params, kind.dimension, time);
  uint32_t closed = pbf_box_closed_axis(&box, kind.dimension);
  if (closed == kind.dimension) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "params.wall_…: at the present time %.9g the walls of axis %u stand at %.9g and "
                  "%.9g; the upper one must be above the lower one",
                  time, closed, box.lower[closed], box.upper[closed]);
}

pbf_status pbf_params_in(const pbf_params *theirs, pbf_params *params) {
  pbf_params defaults;
  pbf_status status = pbf_struct_in(&pbf_kind_params, theirs, params);
  if (status == PBF_OK) status = pbf_params_init(&defaults, sizeof defaults);
  if (status != PBF_OK) return status;
  const uint32_t known = pbf_struct_size(theirs);
  if (known < sizeof defaults)
    memcpy((char *)params + known, (const char *)&defaults + known, sizeof defaults - known);
  return PBF_OK;
}

pbf_status pbf_params_check(const pbf_params *params, pbf_check_kind kind, double time) {
  pbf_status status = pbf_check_counts(counts, LENGTH(counts), "params", params);
  if (status == PBF_OK) status = pbf_check_reals(reals, LENGTH(reals), "params", params, kind);
  if (status == PBF_OK) status = check_sleep(params);
  if (status == PBF_OK) status = check_solver(params);
  if (status == PBF_OK) status = check_lengths(params, kind);
  if (status == PBF_OK) status = check_factors(params, kind);
  if (status == PBF_OK) status = check_domain(params, kind, time);
  if (status == PBF_OK) status = check_speed(params, kind);
  return status;
}

/* 2D lacks the last component of an array by axis, and the last two of one by wall. */
pbf_params pbf_params_for_backend(const pbf_params *params, uint32_t dimension) {
  pbf_params clean = *params;
  if (dimension == 3) return clean;
  clean.periodic &= PBF_PERIODIC_X | PBF_PERIODIC_Y;
#define PBF_PARAM_REALS(offset, name, count, initial, low, high, projected, unit, doc) \
  for (int k = count / 3 * 2; k < count; ++k) clean.name[k] = 0;
#include "physics/params.def"
  return clean;
}

pbf_box pbf_params_box(const pbf_params *params, uint32_t dimension, double time) {
  pbf_box box = {{0}, {0}};
  for (uint32_t axis = 0; axis < dimension; ++axis) {
    box.lower[axis] = pbf_motion_wall(params, (int)(2 * axis), time);
    box.upper[axis] = pbf_motion_wall(params, (int)(2 * axis + 1), time);
  }
  return box;
}

int pbf_params_walls_move(const pbf_params *params, uint32_t dimension) {
  for (uint32_t wall = 0; wall < 2 * dimension; ++wall) {
    if (params->wall_velocity[wall] != 0) return 1;
    if (params->wall_amplitude[wall] != 0 && params->wall_frequency[wall] != 0) return 1;
  }
  return 0;
}

uint32_t pbf_box_closed_axis(const pbf_box *box, uint32_t dimension) {
  for (uint32_t axis = 0; axis < dimension; ++axis) {
    double width = box->upper[axis] - box->lower[axis];
    if (!(width > 0) || !isfinite(width)) return axis;
  }
  return dimension;
}
