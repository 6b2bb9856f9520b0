/* Particles: adding, removing, reading, overwriting. */
#include <math.h>
#include <string.h>

#include <pbf/ranks.h>

#include "table.h"

enum { MOST_ADDED = 64, GUARD = 0xa5 };

typedef struct rows {
  uint32_t first, count, first_id[TWINS], field;
  _Alignas(8) unsigned char x[MOST_PARTICLES * 3 * 8], v[MOST_PARTICLES * 3 * 8];
  int with_velocities;
  uint32_t ids[MOST_PARTICLES];
  double lower[3], upper[3];
  uint32_t found[TWINS];
  unsigned char *out[TWINS];
  pbf_read_desc read;
  pbf_anisotropy_desc wanted;
  uint32_t with_positions; /* where they go, in bytes; 0: not wanted */
} rows;

static rows *rows_of(actor *a) {
  static _Thread_local rows r;
  memset(&r, 0, sizeof r);
  for (int twin = 0; twin < TWINS; ++twin) r.out[twin] = a->numbers[twin];
  return &r;
}

static uint32_t draw_count(actor *a) {
  return dice_below(&a->dice, dice_one_in(&a->dice, 3) ? MOST_ADDED : 8);
}

/* In the middle of the unit box, now and then on a lattice, at one point, or anything. */
static void draw_places(actor *a, rows *r) {
  const subject *s = a->subject;
  const uint32_t way = dice_below(&a->dice, 6);
  double at[3] = {0.5, 0.5, 0.5};
  for (uint32_t i = 0; i < r->count && i < MOST_PARTICLES; ++i)
    for (uint32_t axis = 0; axis < s->dimension; ++axis) {
      if (way < 3) at[axis] = dice_in(&a->dice, 0.21, 0.79);
      if (way == 3) at[axis] = 0.3 + 0.05 * ((i >> (2 * axis)) & 3);
      put_value(s, r->x, i * s->dimension + axis, at[axis]);
      put_value(s, r->v, i * s->dimension + axis, dice_in(&a->dice, -3, 3));
    }
  r->with_velocities = dice_one_in(&a->dice, 2);
  if (!dice_one_in(&a->dice, 12) || r->count == 0 || r->count > MOST_PARTICLES) return;
  static const double wild[] = {NAN, INFINITY, -INFINITY, 1e30, -1e300, 1e-300, 2, -0.0};
  put_value(s, dice_one_in(&a->dice, 2) ? r->x : r->v,
            dice_below(&a->dice, r->count * s->dimension), wild[dice_below(&a->dice, 8)]);
}

/* Some of those that there are; now and then not. */
static void draw_rows(actor *a, rows *r) {
  const uint32_t count = a->subject->model.count;
  r->first = dice_below(&a->dice, count + 1);
  r->count = dice_below(&a->dice, count - r->first + 1);
  if (dice_one_in(&a->dice, 16)) r->first = (uint32_t)dice_next(&a->dice);
  if (dice_one_in(&a->dice, 16)) r->count = 1 + dice_below(&a->dice, MOST_PARTICLES - 1);
}

/* ---- How many ---- */

static pbf_status get_count(pbf_solver *solver, int twin, void *context) {
  return pbf_get_count(solver, &((rows *)context)->found[twin]);
}

void call_get_count(actor *a) {
  rows *r = rows_of(a);
  if (call_both(a, get_count, r, CALL_READS) == PBF_OK)
    insist(a, r->found[0] == a->subject->model.count);
}

static pbf_status add(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  return pbf_add_particles(solver, r->count, r->x, r->with_velocities ? r->v : NULL,
                           &r->first_id[twin]);
}

void call_add_particles(actor *a) {
  rows *r = rows_of(a);
  model *m = &a->subject->model;
  r->count = draw_count(a);
  draw_places(a, r);
  if (call_both(a, add, r, 0) != PBF_OK) return;
  insist(a, r->first_id[0] == m->next_id && r->first_id[1] == m->next_id);
  insist(a, m->count + r->count <= a->subject->capacity);
  for (uint32_t i = 0; i < r->count; ++i) m->ids[m->count++] = (uint32_t)m->next_id++;
  atomic_fetch_add(&soak_record->particles, r->count);
  check_subject(a);
}

/* ---- Fewer ---- */

static void forget(model *m, const uint32_t *ids, uint32_t count) {
  uint32_t kept = 0;
  for (uint32_t i = 0; i < m->count; ++i) {
    int gone = 0;
    for (uint32_t k = 0; k < count; ++k) gone |= ids[k] == m->ids[i];
    if (!gone) m->ids[kept++] = m->ids[i];
  }
  m->count = kept;
}

static pbf_status drop(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  (void)twin;
  return pbf_remove_particles(solver, r->count, r->ids);
}

void call_remove_particles(actor *a) {
  rows *r = rows_of(a);
  model *m = &a->subject->model;
  int how = 0;
  r->count = dice_below(&a->dice, (m->count < 30 ? m->count : 30) + 1);
  const uint32_t start = dice_below(&a->dice, m->count + 1);
  for (uint32_t i = 0; i < r->count; ++i) r->ids[i] = m->ids[(start + i) % m->count];
  if (r->count && dice_one_in(&a->dice, 8)) {
    r->ids[dice_below(&a->dice, r->count)] = (uint32_t)m->next_id + dice_below(&a->dice, 100);
    how = CALL_WRONG;
  } else if (r->count > 1 && dice_one_in(&a->dice, 8)) {
    r->ids[1] = r->ids[0];
    how = CALL_WRONG;
  }
  if (call_both(a, drop, r, how) != PBF_OK) return;
  forget(m, r->ids, r->count);
  check_subject(a);
}

static pbf_status drop_box(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  return pbf_remove_in_box(solver, r->lower, r->upper, &r->found[twin]);
}

static pbf_status find_box(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  return pbf_find_in_box(solver, r->lower, r->upper, r->count, (uint32_t *)(void *)r->out[twin],
                         &r->found[twin]);
}

static pbf_status get_positions(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  return pbf_get_positions(solver, r->first, r->count, r->out[twin]);
}

static void draw_box(actor *a, rows *r) {
  for (int axis = 0; axis < 3; ++axis) {
    r->lower[axis] = dice_one_in(&a->dice, 6) ? -INFINITY : dice_in(&a->dice, 0, 0.9);
    r->upper[axis] = dice_one_in(&a->dice, 6) ? INFINITY : dice_in(&a->dice, 0, 1.2);
    if (dice_one_in(&a->dice, 40)) r->lower[axis] = NAN;
  }
}

/* The ids in the box, by the positions; the wrong box of none has no meaning. */
static uint32_t ids_in_box(actor *a, rows *r) {
  const subject *s = a->subject;
  uint32_t inside = 0;
  r->first = 0;
  r->count = s->model.count;
  if (call_both(a, get_positions, r, CALL_READS) != PBF_OK) return UINT32_MAX;
  for (uint32_t i = 0; i < s->model.count; ++i) {
    int in = 1;
    for (uint32_t k = 0; k < s->dimension; ++k) {
      const double x = value_at(a->subject, r->out[0], i * s->dimension + k);
      in &= x >= r->lower[k] && x <= r->upper[k];
    }
    if (in) r->ids[inside++] = s->model.ids[i];
  }
  return inside;
}

void call_remove_in_box(actor *a) {
  rows *r = rows_of(a);
  draw_box(a, r);
  const uint32_t inside = ids_in_box(a, r);
  if (inside == UINT32_MAX || call_both(a, drop_box, r, 0) != PBF_OK) return;
  insist(a, r->found[0] == inside && r->found[1] == inside);
  forget(&a->subject->model, r->ids, inside);
  check_subject(a);
}

void call_find_in_box(actor *a) {
  rows *r = rows_of(a);
  draw_box(a, r);
  const uint32_t inside = ids_in_box(a, r);
  r->count = dice_below(&a->dice, MOST_PARTICLES);
  if (inside == UINT32_MAX || call_both(a, find_box, r, CALL_READS) != PBF_OK) return;
  const uint32_t given = inside < r->count ? inside : r->count;
  insist(a, r->found[0] == inside && r->found[1] == inside);
  insist(a, memcmp(r->out[0], r->ids, given * sizeof *r->ids) == 0);
}

/* ---- Rows ---- */

static pbf_status get_velocities(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  return pbf_get_velocities(solver, r->first, r->count, r->out[twin]);
}

static pbf_status get_ids(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  return pbf_get_ids(solver, r->first, r->count, (uint32_t *)(void *)r->out[twin]);
}

static pbf_status get_densities(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  return pbf_get_densities(solver, r->first, r->count, r->out[twin]);
}

static pbf_status get_pressures(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  return pbf_get_pressures(solver, r->first, r->count, r->out[twin]);
}

/* Both give the same bits, and nothing beyond. */
static pbf_status get_rows(actor *a, rows *r, action act, uint32_t bytes) {
  draw_rows(a, r);
  memset(a->numbers, GUARD, sizeof a->numbers);
  pbf_status status = call_both(a, act, r, CALL_READS);
  insist(a, memcmp(a->numbers[0], a->numbers[1], sizeof a->numbers[0]) == 0);
  for (size_t i = status == PBF_OK ? (size_t)r->count * bytes : 0; i < sizeof a->numbers[0]; ++i)
    if (a->numbers[0][i] != GUARD) found(a->number, "%s: writes byte %zu", a->function, i);
  return status;
}

static void insist_finite(actor *a, const rows *r, uint32_t components) {
  for (uint32_t i = 0; i < r->count * components; ++i)
    insist(a, isfinite(value_at(a->subject, r->out[0], i)));
}

static void get_numbers(actor *a, action act, uint32_t components) {
  rows *r = rows_of(a);
  if (get_rows(a, r, act, components * a->subject->precision) == PBF_OK)
    insist_finite(a, r, components);
}

void call_get_positions(actor *a) { get_numbers(a, get_positions, a->subject->dimension); }
void call_get_velocities(actor *a) { get_numbers(a, get_velocities, a->subject->dimension); }
void call_get_densities(actor *a) { get_numbers(a, get_densities, 1); }
void call_get_pressures(actor *a) { get_numbers(a, get_pressures, 1); }

void call_get_ids(actor *a) {
  rows *r = rows_of(a);
  if (get_rows(a, r, get_ids, 4) == PBF_OK)
    insist(a, memcmp(r->out[0], a->subject->model.ids + r->first, 4 * (size_t)r->count) == 0);
}

static pbf_status get_share(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  return pbf_get_share(solver, r->field, MOST_PARTICLES, &r->found[twin], r->ids, r->out[twin]);
}

/* Without ranks all of them. */
void call_get_share(actor *a) {
  const model *m = &a->subject->model;
  rows *r = rows_of(a);
  r->field = dice_one_in(&a->dice, 2) ? PBF_FIELD_POSITION : PBF_FIELD_VELOCITY;
  memset(a->numbers, GUARD, sizeof a->numbers);
  if (call_both(a, get_share, r, CALL_READS) != PBF_OK) return;
  insist(a, r->found[0] == m->count && r->found[1] == m->count);
  insist(a, memcmp(r->ids, m->ids, m->count * sizeof *r->ids) == 0);
  insist(a, memcmp(a->numbers[0], a->numbers[1], sizeof a->numbers[0]) == 0);
}

static pbf_status set_positions(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  (void)twin;
  return pbf_set_positions(solver, r->first, r->count, r->x);
}

static pbf_status set_velocities(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  (void)twin;
  return pbf_set_velocities(solver, r->first, r->count, r->v);
}

/* What is set is what is read. */
static void set_rows(actor *a, action set, action get, const void *values(const rows *)) {
  rows *r = rows_of(a);
  draw_rows(a, r);
  draw_places(a, r);
  if (call_both(a, set, r, 0) != PBF_OK) return;
  check_subject(a);
  if (call_both(a, get, r, CALL_READS) != PBF_OK) return;
  const size_t bytes = (size_t)r->count * a->subject->dimension * a->subject->precision;
  insist(a, memcmp(r->out[0], values(r), bytes) == 0);
}

static const void *places(const rows *r) { return r->x; }
static const void *speeds(const rows *r) { return r->v; }

void call_set_positions(actor *a) { set_rows(a, set_positions, get_positions, places); }

static pbf_status set_accelerations(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  (void)twin;
  return pbf_set_accelerations(solver, r->first, r->count, r->v);
}

static pbf_status clear_accelerations(pbf_solver *solver, int twin, void *context) {
  (void)twin;
  (void)context;
  return pbf_set_accelerations(solver, 0, 0, NULL);
}

void call_set_accelerations(actor *a) {
  rows *r = rows_of(a);
  draw_rows(a, r);
  draw_places(a, r);
  call_both(a, dice_one_in(&a->dice, 3) ? clear_accelerations : set_accelerations, r, 0);
}

void call_set_velocities(actor *a) { set_rows(a, set_velocities, get_velocities, speeds); }

/* Rows of four numbers in float64 or of their own, the rest of them NaN, which is not looked at. */
static pbf_status write_rows(pbf_solver *solver, rows *r, uint32_t field, const void *values) {
  static _Thread_local double wide[MOST_PARTICLES][4];
  pbf_info info = {.struct_size = sizeof info};
  pbf_write_desc write = {.struct_size = sizeof write,
                          .field = field,
                          .first = r->first,
                          .count = r->count,
                          .data = values};
  if (r->count % 2 == 0 || r->count > MOST_PARTICLES || pbf_get_info(solver, &info) != PBF_OK)
    return pbf_write(solver, &write);
  for (uint32_t i = 0; i < r->count; ++i)
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t place = i * info.dimension + k;
      wide[i][k] = k >= info.dimension             ? NAN
                   : info.precision == PBF_FLOAT32 ? (double)((const float *)values)[place]
                                                   : ((const double *)values)[place];
    }
  write.element_type = PBF_TYPE_FLOAT64;
  write.components = 4;
  write.data = wide;
  return pbf_write(solver, &write);
}

static pbf_status write_velocities(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  (void)twin;
  return write_rows(solver, r, PBF_FIELD_VELOCITY, r->v);
}

static pbf_status write_positions(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  (void)twin;
  return write_rows(solver, r, PBF_FIELD_POSITION, r->x);
}

void call_write(actor *a) {
  if (dice_one_in(&a->dice, 2))
    set_rows(a, write_velocities, get_velocities, speeds);
  else
    set_rows(a, write_positions, get_positions, places);
}

/* ---- Into another layout ---- */

static pbf_status read_fields(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  pbf_read_desc read = r->read;
  read.data = r->out[twin];
  return pbf_read(solver, &read);
}

static void draw_read(actor *a, rows *r) {
  dice *d = &a->dice;
  draw_rows(a, r);
  const uint32_t types[] = {0, PBF_TYPE_FLOAT32, PBF_TYPE_FLOAT64, PBF_TYPE_UINT32};
  r->read = (pbf_read_desc){.struct_size = sizeof r->read,
                            .field = 1 + dice_below(d, 5),
                            .first = r->first,
                            .count = r->count,
                            .element_type = types[dice_below(d, 4)],
                            .components = dice_below(d, 6),
                            .w = dice_below(d, 5),
                            .order = dice_one_in(d, 4),
                            .stride = dice_one_in(d, 2) ? 0 : 8 * (uint64_t)dice_below(d, 9)};
  if (r->read.order) r->read.first = 0, r->read.count = a->subject->model.count;
  if (dice_one_in(d, 3)) r->read.behind = dice_in(d, -0.1, 1.1);
  if (dice_one_in(d, 16)) r->read.behind = NAN;
  if (dice_one_in(d, 16)) r->read.struct_size = dice_below(d, sizeof r->read);
  r->read.w_value = dice_in(d, -1, 1);
}

/* The same bits of both, whose order in memory is the same, too. */
void call_read(actor *a) {
  rows *r = rows_of(a);
  draw_read(a, r);
  memset(a->numbers, GUARD, sizeof a->numbers);
  pbf_status status = call_both(a, read_fields, r, CALL_READS);
  insist(a, memcmp(a->numbers[0], a->numbers[1], sizeof a->numbers[0]) == 0);
  for (size_t i = 0; i < sizeof a->numbers[0] && status != PBF_OK; ++i)
    insist(a, a->numbers[0][i] == GUARD);
}

/* ---- For renderers ---- */

static pbf_status get_anisotropies(pbf_solver *solver, int twin, void *context) {
  rows *r = context;
  pbf_anisotropy_desc wanted = r->wanted;
  wanted.stretches = r->out[twin];
  if (r->with_positions) wanted.positions = (char *)r->out[twin] + r->with_positions;
  return pbf_get_anisotropies(solver, &wanted);
}

/* The same bits of both; positions go behind the matrices. */
void call_get_anisotropies(actor *a) {
  rows *r = rows_of(a);
  dice *d = &a->dice;
  const uint32_t dimension = a->subject->dimension, precision = a->subject->precision;
  draw_rows(a, r);
  r->wanted = (pbf_anisotropy_desc){.struct_size = sizeof r->wanted,
                                    .first = r->first,
                                    .count = r->count,
                                    .min_neighbors = dice_below(d, 30),
                                    .smoothing = dice_in(d, -0.1, 1.1)};
  if (dice_one_in(d, 3)) r->wanted.radius = dice_in(d, 0, 0.5);
  if (dice_one_in(d, 3)) r->wanted.max_ratio = dice_in(d, 0.9, 9);
  if (dice_one_in(d, 8)) r->wanted.lone_scale = dice_in(d, -0.1, 1.1);
  if (dice_one_in(d, 16)) r->wanted.struct_size = dice_below(d, sizeof r->wanted);
  r->with_positions = dice_one_in(d, 2) ? r->count * dimension * dimension * precision : 0;
  memset(a->numbers, GUARD, sizeof a->numbers);
  pbf_status status = call_both(a, get_anisotropies, r, CALL_READS);
  insist(a, memcmp(a->numbers[0], a->numbers[1], sizeof a->numbers[0]) == 0);
  const size_t written =
      (size_t)r->count * dimension * precision * (dimension + (r->with_positions > 0));
  for (size_t i = status == PBF_OK ? written : 0; i < sizeof a->numbers[0]; ++i)
    insist(a, a->numbers[0][i] == GUARD);
}

static pbf_status keep_previous(pbf_solver *solver, int twin, void *context) {
  (void)twin;
  return pbf_keep_previous(solver, ((rows *)context)->count);
}

void call_keep_previous(actor *a) {
  rows *r = rows_of(a);
  r->count = dice_below(&a->dice, 3);
  call_both(a, keep_previous, r, CALL_READS);
}
