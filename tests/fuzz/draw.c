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

#define FIELD(member, components, low, high) \
  { offsetof(pbf_params, member), components, low, high }

static const real_field fields[] = {FIELD(smoothing_radius, 1, 0.06, 0.2),
                                    FIELD(spacing, 1, 0.03, 0.1),
                                    FIELD(particle_volume, 1, 0, 0.001),
                                    FIELD(time_step, 1, 0.0005, 0.02),
                                    FIELD(gravity, 3, -20, 20),
                                    FIELD(attraction, 1, -5, 5),
                                    FIELD(attraction_center, 3, -1, 2),
                                    FIELD(relaxation, 1, 0, 1),
                                    FIELD(epsilon, 1, 0, 1),
                                    FIELD(separation, 1, 0, 1),
                                    FIELD(min_diagonal, 1, 0.5, 1),
                                    FIELD(wall_density, 1, 0, 1),
                                    FIELD(scorr_k, 1, 0, 0.1),
                                    FIELD(scorr_dq, 1, 0.1, 0.5),
                                    FIELD(vorticity, 1, 0, 0.1),
                                    FIELD(viscosity, 1, 0, 0.1),
                                    FIELD(domain_min, 3, -0.2, 0.2),
                                    FIELD(domain_max, 3, 0.8, 1.4),
                                    FIELD(wall_velocity, 6, -1, 1),
                                    FIELD(wall_amplitude, 6, -0.1, 0.1),
                                    FIELD(wall_frequency, 6, 0, 20),
                                    FIELD(wall_phase, 6, -4, 4),
                                    FIELD(search_cell_width, 1, 0.2, 0.5),
                                    FIELD(sleep_speed, 1, 0, 1),
                                    FIELD(sleep_time, 1, 0.01, 0.1),
                                    FIELD(tolerance, 1, 0, 0.02),
                                    FIELD(pressure_grid, 1, 1, 3),
                                    FIELD(prestabilization, 1, 0, 0.1),
                                    FIELD(undamping, 1, 0, 1),
                                    FIELD(torque_correction, 1, 0, 1)};

enum { FIELDS = sizeof fields / sizeof fields[0] };

static void draw_counts(input *in, pbf_params *params) {
  params->iterations = 1 + take_u8(in) % 6;
  params->kernel = take_u8(in) % 2;
  params->solver = take_u8(in) % 2;
  params->collide = 1 + take_u8(in) % 7;
  params->scorr_n = 1 + take_u8(in) % 8;
}

/* Also numbers that the checks must refuse; a count of iterations that they needn't stays small. */
static void draw_any_counts(input *in, pbf_params *params) {
  params->kernel = take_u8(in) % 4;
  params->solver = take_u8(in) % 4;
  params->collide = take_u8(in) % 16;
  params->scorr_n = take_u8(in) % 16;
  params->iterations = take_u8(in) % 4;
}

static int draw_field(input *in, pbf_params *params) {
  uint8_t choice = take_u8(in), how = take_u8(in);
  if (choice % (FIELDS + 2) == FIELDS) return draw_counts(in, params), 0;
  if (choice % (FIELDS + 2) == FIELDS + 1) return draw_any_counts(in, params), 0;
  const real_field *field = &fields[choice % (FIELDS + 2)];
  int wild = how % 8 == 7, place = (how / 8) % field->components;
  double value = wild ? draw_wild(in) : how % 8 == 6 ? 0 : take_from(in, field->low, field->high);
  memcpy((char *)params + field->offset + (size_t)place * sizeof value, &value, sizeof value);
  return wild;
}

int draw_params(input *in, pbf_params *params) {
  int wild = 0;
  for (int changes = 1 + take_u8(in) % 4; changes > 0; --changes) wild |= draw_field(in, params);
  /* Refused together: most of what is drawn has to pass. */
  if (!wild && params->solver != PBF_SOLVER_CHEBYSHEV)
    params->undamping = params->torque_correction = 0;
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
