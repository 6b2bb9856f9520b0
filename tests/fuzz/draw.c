#include "draw.h"

#include <float.h>
#include <math.h>

double draw_wild(input *in) {
  static const double values[] = {NAN,      INFINITY, -INFINITY, DBL_TRUE_MIN, -DBL_MIN, FLT_MIN,
                                  1e-45,    FLT_MAX,  -FLT_MAX,  DBL_MAX,      1e39,     -1e300,
                                  16777217, -0.0,     1e-300,    4294967296.0};
  uint8_t which = take_u8(in);
  return which < 128 ? values[which % 16] : take_f64(in);
}

/* A field and the values of it that make a fluid. */
typedef struct real_field {
  size_t offset;
  int components;
  double low, high;
} real_field;

static const real_field reals[] = {
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  {offsetof(pbf_params, name), 1, low, high},
#define PBF_PARAM_REALS(offset, name, count, initial, low, high, projected, unit, doc) \
  {offsetof(pbf_params, name), count, low, high},
#include "physics/params.def"
};

/* And one that is a count: from `low` on, `span` values, few where very many are allowed. */
typedef struct count_field {
  size_t offset;
  uint32_t low, span;
} count_field;

#define SPAN(min, max) ((max) - (min) < 8 ? (max) - (min) + 1 : 6)

static const count_field counts[] = {
#define PBF_PARAM_INTEGER(offset, name, initial, type, min, max, hint, when, feature, doc) \
  {offsetof(pbf_params, name), min, SPAN(min, max)},
#include "physics/params.def"
};

enum { REALS = sizeof reals / sizeof reals[0], COUNTS = sizeof counts / sizeof counts[0] };

static void draw_counts(input *in, pbf_params *params) {
  for (int k = 0; k < COUNTS; ++k) {
    uint32_t value = counts[k].low + take_u8(in) % counts[k].span;
    memcpy((char *)params + counts[k].offset, &value, sizeof value);
  }
}

/* Also numbers that the checks must refuse; a count of iterations that they needn't stays small. */
static void draw_any_counts(input *in, pbf_params *params) {
  for (int k = 0; k < COUNTS; ++k) {
    uint32_t value = take_u8(in) % (2 * counts[k].span);
    memcpy((char *)params + counts[k].offset, &value, sizeof value);
  }
}

static int draw_field(input *in, pbf_params *params) {
  uint8_t choice = take_u8(in), how = take_u8(in);
  if (choice % (REALS + 2) == REALS) return draw_counts(in, params), 0;
  if (choice % (REALS + 2) == REALS + 1) return draw_any_counts(in, params), 0;
  const real_field *field = &reals[choice % (REALS + 2)];
  int wild = how % 8 == 7, place = (how / 8) % field->components;
  double value = wild ? draw_wild(in) : how % 8 == 6 ? 0 : take_from(in, field->low, field->high);
  memcpy((char *)params + field->offset + (size_t)place * sizeof value, &value, sizeof value);
  return wild;
}

/* What would be refused together: most of what is drawn has to pass. */
static void clear_what_the_solver_refuses(pbf_params *params) {
#define PBF_PARAM_REAL(offset, name, initial, range, when, min_solver, low, high, usual, feature, \
                       projected, unit, doc)                                                      \
  if (PBF_SOLVER_##min_solver > (int)params->solver) params->name = 0;
#include "physics/params.def"
}

int draw_params(input *in, pbf_params *params) {
  int wild = 0;
  for (int changes = 1 + take_u8(in) % 4; changes > 0; --changes) wild |= draw_field(in, params);
  if (!wild) clear_what_the_solver_refuses(params);
  return wild;
}

static void draw_vector(input *in, double *out, double low, double high) {
  for (int axis = 0; axis < 3; ++axis) out[axis] = take_from(in, low, high);
}

static void draw_pose(input *in, pbf_collider *collider) {
  double angle = take_from(in, -3, 3);
  collider->orientation[2] = sin(angle / 2);
  collider->orientation[3] = cos(angle / 2);
  draw_vector(in, collider->position, -0.2, 1.2);
  draw_vector(in, collider->velocity, -1, 1);
  collider->angular_velocity[2] = take_from(in, -3, 3);
}

int draw_collider(input *in, pbf_collider *collider) {
  uint8_t flags = take_u8(in);
  pbf_collider_init(collider, sizeof *collider, flags & 3);
  collider->inverted = flags >> 2 & 1;
  draw_pose(in, collider);
  draw_vector(in, collider->half_extents, 0.05, 0.5);
  collider->radius = take_from(in, 0.05, 0.5);
  collider->half_length = take_from(in, 0, 0.5);
  if (flags >> 3 & 1) draw_vector(in, collider->axis, -1, 1);
  if (flags < 0xe0) return 0;
  size_t first = offsetof(pbf_collider, position) / sizeof(double);
  size_t numbers = sizeof *collider / sizeof(double) - first;
  double value = draw_wild(in);
  memcpy((char *)collider + (first + take_u8(in) % numbers) * sizeof value, &value, sizeof value);
  return 1;
}
