#include "opening.h"

#include <math.h>
#include <string.h>

/* A side or a radius of whole spacings has as many columns, whatever is rounded. */
static const double tolerance = 1e-9;

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- Directions ------------------------------------------------------------------------------ */

static void cross(const double a[3], const double b[3], double out[3]) {
  for (int k = 0; k < 3; ++k)
    out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* The first side less what of it goes along the stream; of a disc, or of nothing, the axis that is
 * least along it. */
static void find_across(pbf_opening *o) {
  double side[3], length = 0;
  memcpy(side, o->emitter->across, sizeof side);
  for (int tries = 0; tries < 2 && !(length > tolerance); ++tries) {
    const double size = sqrt(dot(side, side)), part = size > 0 ? dot(side, o->along) / size : 0;
    for (int k = 0; k < 3; ++k)
      o->across[0][k] = size > 0 ? side[k] / size - part * o->along[k] : 0;
    length = sqrt(dot(o->across[0], o->across[0]));
    int least = 0;
    for (int k = 1; k < 3; ++k) least = fabs(o->along[k]) < fabs(o->along[least]) ? k : least;
    for (int k = 0; k < 3; ++k) side[k] = k == least;
  }
  for (int k = 0; k < 3; ++k) o->across[0][k] /= length;
  cross(o->along, o->across[0], o->across[1]);
}

static void find_directions(pbf_opening *o) {
  double v[3] = {o->emitter->velocity[0], o->emitter->velocity[1], 0};
  if (o->dimension == 3) v[2] = o->emitter->velocity[2];
  o->speed = sqrt(dot(v, v));
  for (int k = 0; k < 3; ++k) o->along[k] = v[k] / o->speed;
  if (o->dimension == 3) {
    find_across(o);
    return;
  }
  o->across[0][0] = o->along[1];
  o->across[0][1] = -o->along[0];
}

/* ---- Columns --------------------------------------------------------------------------------- */

/* In spacings; a change of parameters may have made it any number of them. */
static double radius_of(const pbf_opening *o) {
  const double most = 10000;
  return fmin(o->emitter->radius / o->spacing, most);
}

/* In pairs about the middle of a disc's row, which is a column's width and a half from its own
 * middle and so on. */
static uint64_t half_row(const pbf_opening *o, int64_t row) {
  const double r = radius_of(o), y = (double)row + 0.5;
  return y * y < r * r ? (uint64_t)floor(sqrt(r * r - y * y) + 0.5 + tolerance) : 0;
}

static int64_t half_rows(const pbf_opening *o) { return (int64_t)ceil(radius_of(o)); }

static uint64_t count_of_side(const pbf_opening *o, double half) {
  const double most = 1e9;
  return (uint64_t)fmin(fmax(floor(2 * half / o->spacing + tolerance), 1), most);
}

static void count_columns(pbf_opening *o) {
  const pbf_emitter *e = o->emitter;
  const int is_line = o->dimension == 2;
  if (e->shape == PBF_EMITTER_RECTANGLE || is_line) {
    const double half = e->shape == PBF_EMITTER_DISC ? e->radius : e->half_width;
    o->sides[0] = count_of_side(o, half);
    o->sides[1] = is_line ? 1 : count_of_side(o, e->half_height);
    o->columns = o->sides[0] * o->sides[1];
    return;
  }
  for (int64_t row = -half_rows(o); row < half_rows(o); ++row) o->columns += 2 * half_row(o, row);
  if (o->columns == 0) o->columns = 1; /* in the middle */
}

/* In spacings from the middle. */
static void place_of_disc(const pbf_opening *o, uint64_t column, double at[2]) {
  at[0] = at[1] = 0;
  for (int64_t row = -half_rows(o); row < half_rows(o); ++row) {
    const uint64_t half = half_row(o, row);
    if (column < 2 * half) {
      at[0] = (double)column + 0.5 - (double)half;
      at[1] = (double)row + 0.5;
      return;
    }
    column -= 2 * half;
  }
}

static void place_of_rectangle(const pbf_opening *o, uint64_t column, double at[2]) {
  at[0] = (double)(column % o->sides[0]) + 0.5 - 0.5 * (double)o->sides[0];
  const uint64_t row = column / o->sides[0];
  at[1] = (double)row + 0.5 - 0.5 * (double)o->sides[1];
}

/* Between -1/2 and 1/2, by the finalizer of Steele, Lea and Flood's SplitMix64 (OOPSLA 2014). */
static double noise(uint32_t seed, uint64_t number, uint64_t axis) {
  uint64_t z = (2 * number + axis + 1) * UINT64_C(0x9e3779b97f4a7c15) ^ (uint64_t)seed << 32;
  z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
  return (double)((z ^ z >> 31) >> 11) / (double)(UINT64_C(1) << 53) - 0.5;
}

pbf_opening pbf_opening_of(const pbf_emitter *emitter, uint32_t dimension, double spacing) {
  pbf_opening o = {.emitter = emitter, .dimension = dimension, .spacing = spacing};
  find_directions(&o);
  count_columns(&o);
  const double area = (double)o.columns * (dimension == 3 ? spacing * spacing : spacing);
  o.rate = emitter->rate > 0 ? emitter->rate : area * o.speed;
  return o;
}

double pbf_opening_gap(const pbf_opening *o) {
  const double a = (double)o->sides[0], b = (double)o->sides[1];
  if (!(a > 0)) return o->spacing * radius_of(o) / 2;
  return o->spacing * (o->dimension == 3 ? a * b / (2 * (a + b)) : a / 2);
}

static int is_parallel(const pbf_opening *o, const double velocity[3]) {
  const double least_angle = 1e-6, forward = dot(velocity, o->along);
  double aside[3];
  for (int k = 0; k < 3; ++k) aside[k] = velocity[k] - forward * o->along[k];
  return forward > 0 && dot(aside, aside) <= least_angle * least_angle * forward * forward;
}

/* In spacings from where a column is, the nearest one: columns are half a spacing off the middle
 * where they are an even number. */
static double off_column(const pbf_opening *o, const double from_middle[3], int side) {
  const uint64_t columns = o->sides[0] > 0 ? o->sides[side] : 2;
  const double at = dot(from_middle, o->across[side]) / o->spacing + 0.5 * (double)(columns % 2);
  return fabs(at - floor(at) - 0.5);
}

int pbf_opening_fits(const pbf_opening *o, const double place[3], const double velocity[3]) {
  const double rounding = 1e-3;
  double from_middle[3] = {0};
  for (uint32_t k = 0; k < o->dimension; ++k) from_middle[k] = place[k] - o->emitter->position[k];
  if (o->emitter->jitter > 0 || !is_parallel(o, velocity)) return 0;
  if (fabs(dot(from_middle, o->along)) > rounding * o->spacing) return 0;
  return off_column(o, from_middle, 0) <= rounding &&
         (o->dimension == 2 || off_column(o, from_middle, 1) <= rounding);
}

void pbf_opening_place(const pbf_opening *o, uint64_t number, double place[3]) {
  const uint64_t column = number % o->columns;
  double at[2];
  if (o->sides[0] > 0)
    place_of_rectangle(o, column, at);
  else
    place_of_disc(o, column, at);
  for (uint64_t side = 0; side < 2; ++side)
    at[side] += o->emitter->jitter * noise(o->emitter->seed, number, side);
  for (uint32_t k = 0; k < 3; ++k)
    place[k] =
        o->emitter->position[k] + o->spacing * (at[0] * o->across[0][k] + at[1] * o->across[1][k]);
}
