/* A vessel made of colliders holds water: no particle is in its walls at the end of a step, nor
 * beyond them. What is right follows from walls being solid, whatever else the fluid does. */
#include "support.h"

#include <math.h>

#include "random.h"

static const double spacing = 0.05, wall = 0.1;

/* ---- Rotations ------------------------------------------------------------------------------ */

typedef struct rotation {
  double q[4], rows[3][3]; /* the quaternion, and the matrix */
} rotation;

static rotation rotation_about(const double axis[3], double angle) {
  rotation r;
  const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  const double c = cos(angle), s = sin(angle);
  r.q[3] = cos(0.5 * angle);
  for (int k = 0; k < 3; ++k) r.q[k] = axis[k] / length * sin(0.5 * angle);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int third = 3 - i - j;
      const double u = axis[i] / length, v = axis[j] / length;
      r.rows[i][j] = u * v * (1 - c) + (i == j ? c : 0);
      if (i != j) r.rows[i][j] += ((j - i + 3) % 3 == 1 ? -s : s) * axis[third] / length;
    }
  return r;
}

static void rotate(const rotation *r, const double v[3], double out[3]) {
  for (int i = 0; i < 3; ++i)
    out[i] = r->rows[i][0] * v[0] + r->rows[i][1] * v[1] + r->rows[i][2] * v[2];
}

static void rotate_back(const rotation *r, const double v[3], double out[3]) {
  for (int i = 0; i < 3; ++i)
    out[i] = r->rows[0][i] * v[0] + r->rows[1][i] * v[1] + r->rows[2][i] * v[2];
}

/* ---- A closed box of six flush walls -------------------------------------------------------- */

enum { WALLS = 6 };

/* Its room is 2 half[k] long about the pivot of its motion. */
typedef struct vessel {
  double half[3], thickness;
  double offsets[WALLS][3], half_extents[WALLS][3];
} vessel;

/* Floor and lid cover the others, and two of these the last two. */
static vessel vessel_of(uint32_t dimension, const double half[3], double thickness) {
  vessel v = {{half[0], half[1], half[2]}, thickness, {{0}}, {{0}}};
  const int order[3] = {1, 0, 2};
  for (int place = 0; place < (int)dimension; ++place)
    for (int side = 0; side < 2; ++side) {
      const int axis = order[place], k = 2 * place + side;
      v.offsets[k][axis] = (side ? 1 : -1) * (half[axis] + 0.5 * thickness);
      for (int a = 0; a < 3; ++a) v.half_extents[k][a] = half[a] + thickness;
      for (int done = 0; done < place; ++done) v.half_extents[k][order[done]] = half[order[done]];
      v.half_extents[k][axis] = 0.5 * thickness;
    }
  return v;
}

static void place_vessel(const vessel *v, uint32_t walls, const double at[3], const rotation *r,
                         pbf_collider *colliders) {
  for (uint32_t k = 0; k < walls; ++k) {
    double offset[3];
    assert_ok(pbf_collider_init(&colliders[k], sizeof colliders[k], PBF_COLLIDER_BOX));
    rotate(r, v->offsets[k], offset);
    for (int a = 0; a < 3; ++a) colliders[k].position[a] = at[a] + offset[a];
    memcpy(colliders[k].half_extents, v->half_extents[k], sizeof v->half_extents[k]);
    memcpy(colliders[k].orientation, r->q, sizeof r->q);
  }
}

/* ---- Water ---------------------------------------------------------------------------------- */

typedef struct water {
  uint32_t dimension, precision, count;
  pbf_solver *solver;
  void *x;
} water;

static const double center[3] = {3, 3, 3};

static pbf_params params_of(double time_step) {
  pbf_params params = test_params();
  assert_ok(pbf_params_init(&params, sizeof params));
  params.spacing = spacing;
  params.smoothing_radius = 2 * spacing;
  params.time_step = time_step;
  for (int k = 0; k < 3; ++k) params.domain_max[k] = 6;
  return params;
}

/* Half full. */
static water fill(uint32_t dimension, uint32_t precision, const vessel *v, const double at[3],
                  const rotation *r, const pbf_params *params) {
  uint32_t n[3] = {1, 1, 1}, count = 1;
  for (uint32_t k = 0; k < dimension; ++k) {
    n[k] = (uint32_t)((k == 1 ? 1 : 2) * v->half[k] / spacing + 0.5);
    count *= n[k];
  }
  const pbf_desc desc = test_desc(dimension, precision, count);
  water w = {dimension, precision, count, test_create(&desc, params),
             calloc((size_t)count * dimension, precision)};
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t place[3] = {i % n[0], i / n[0] % n[1], i / n[0] / n[1]};
    double own[3] = {0}, x[3];
    for (uint32_t k = 0; k < dimension; ++k) own[k] = spacing * (place[k] + 0.5) - v->half[k];
    rotate(r, own, x);
    for (uint32_t k = 0; k < dimension; ++k)
      test_put(w.x, (uint64_t)i * dimension + k, precision, at[k] + x[k]);
  }
  assert_ok(pbf_add_particles(w.solver, count, w.x, NULL, NULL));
  return w;
}

static void destroy(water *w) {
  pbf_destroy(w->solver);
  free(w->x);
}

/* How many are outside the vessel's room, which is where `at` and the rotation say. */
static uint32_t count_outside(water *w, const vessel *v, const double at[3], const rotation *r) {
  const double rounding = 1e-5;
  uint32_t outside = 0;
  assert_ok(pbf_get_positions(w->solver, 0, w->count, w->x));
  for (uint32_t i = 0; i < w->count; ++i) {
    double from[3] = {0}, own[3];
    int is_inside = 1;
    for (uint32_t k = 0; k < w->dimension; ++k)
      from[k] = test_value(w->x, (uint64_t)i * w->dimension + k, w->precision) - at[k];
    rotate_back(r, from, own);
    for (uint32_t k = 0; k < w->dimension; ++k)
      is_inside = is_inside && fabs(own[k]) < v->half[k] + rounding;
    outside += !is_inside;
  }
  return outside;
}

/* ---- Vessels that stand --------------------------------------------------------------------- */

/* However it lies, and whatever wall comes first; one step in a thirtieth of a second is a long one
 * for this spacing, in which fluid is pressed hard. */
static void check_seams(uint32_t dimension, uint32_t precision) {
  const double half[3] = {5 * spacing, 5 * spacing, 5 * spacing};
  const vessel v = vessel_of(dimension, half, wall);
  const pbf_params params = params_of(1.0 / 30);
  uint64_t random = dimension + precision;
  for (int lie = 0; lie < (dimension == 2 ? 3 : 2); ++lie) {
    const double tilt = dimension == 2 ? 0 : 1;
    const double axis[3] = {tilt * random_in(&random, -1, 1), tilt * random_in(&random, -1, 1), 1};
    const rotation r = rotation_about(axis, random_in(&random, 0, 6));
    pbf_collider colliders[WALLS], shuffled[WALLS];
    water w = fill(dimension, precision, &v, center, &r, &params);
    place_vessel(&v, 2 * dimension, center, &r, colliders);
    for (uint32_t k = 0; k < 2 * dimension; ++k)
      shuffled[k] = colliders[(5 * k + 2 + lie) % (2 * dimension)];
    assert_ok(pbf_set_colliders(w.solver, 2 * dimension, lie % 2 ? shuffled : colliders));
    assert_ok(pbf_step(w.solver, 30));
    const uint32_t outside = count_outside(&w, &v, center, &r);
    if (outside > 0) fail_msg("%uD: %u of %u leak through seams", dimension, outside, w.count);
    destroy(&w);
  }
}

static void seams_are_tight(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_seams);
}

/* Two slabs that lean on each other, between the domain's walls: below the edge of an acute trough
 * one face after the other would come to no end. */
static void check_trough(uint32_t dimension, uint32_t precision) {
  const double half_angle = 0.26, length = 2, z[3] = {0, 0, 1};
  pbf_params params = params_of(1.0 / 30);
  params.domain_max[2] = 6 * spacing;
  pbf_collider slabs[2];
  double x[3 * 2048];
  uint32_t count = 0;
  for (int k = 0; k < 2; ++k) {
    const double side = k ? 1 : -1;
    const rotation lean = rotation_about(z, -side * half_angle);
    const double own[3] = {side * 0.5 * wall, 0.5 * length, 0};
    double at[3];
    assert_ok(pbf_collider_init(&slabs[k], sizeof slabs[k], PBF_COLLIDER_BOX));
    rotate(&lean, own, at);
    for (int a = 0; a < 3; ++a) slabs[k].position[a] = at[a] + (a == 0 ? 3 : a == 1 ? 1 : 0);
    memcpy(slabs[k].orientation, lean.q, sizeof lean.q);
    const double half[3] = {0.5 * wall, 0.5 * length + 0.05, 2};
    memcpy(slabs[k].half_extents, half, sizeof half);
  }
  for (double y = 0.3; y < 0.9; y += spacing)
    for (double wide = tan(half_angle) * y - 0.6 * spacing, u = -wide; u <= wide; u += spacing)
      for (double w = 0.5 * spacing; w < (dimension == 3 ? 6 : 1) * spacing; w += spacing) {
        x[dimension * count] = 3 + u;
        x[dimension * count + 1] = 1 + y;
        if (dimension == 3) x[dimension * count + 2] = w;
        ++count;
      }
  const pbf_desc desc = test_desc(dimension, precision, count);
  water w = {dimension, precision, count, test_create(&desc, &params),
             calloc((size_t)count * dimension, precision)};
  for (uint32_t k = 0; k < count * dimension; ++k) test_put(w.x, k, precision, x[k]);
  assert_ok(pbf_set_colliders(w.solver, 2, slabs));
  assert_ok(pbf_add_particles(w.solver, count, w.x, NULL, NULL));
  assert_ok(pbf_step(w.solver, 45));
  assert_ok(pbf_get_positions(w.solver, 0, count, w.x));
  for (uint32_t i = 0; i < count; ++i) {
    const double side = fabs(test_value(w.x, (uint64_t)i * dimension, precision) - 3);
    const double up = test_value(w.x, (uint64_t)i * dimension + 1, precision) - 1;
    if (up < 1.9 && cos(half_angle) * side - sin(half_angle) * up > 1e-5)
      fail_msg("%uD: a particle is in a side of the trough", dimension);
  }
  destroy(&w);
}

static void troughs_are_tight(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_trough);
}

/* ---- Vessels that move ---------------------------------------------------------------------- */

/* A bucket swung over the head about a pivot: who tells its poses to pbf_move_colliders, or with
 * them the velocities that it has then, or those of chords, keeps the water. */
typedef enum telling { MOVED, WITH_VELOCITIES, WITH_CHORDS } telling;

enum { FRAMES = 30, STEPS_A_FRAME = 4 };

static const double frame = 1.0 / 30, swing = 7, arm[3] = {0, -1.5, 0}, along_z[3] = {0, 0, 1};

/* From rest to `swing` in half a second. */
static double angle_at(double time) {
  return time < 0.5 ? swing * time * time : swing * (time - 0.25);
}

static rotation swung_to(double time, double at[3]) {
  const rotation r = rotation_about(along_z, angle_at(time));
  rotate(&r, arm, at);
  for (int k = 0; k < 3; ++k) at[k] += center[k];
  return r;
}

static void tell(pbf_solver *solver, const vessel *v, uint32_t walls, telling how, double time) {
  double at[3];
  pbf_collider now[WALLS], next[WALLS];
  const double rate = swing * fmin(2 * time, 1);
  rotation r = swung_to(time, at);
  place_vessel(v, walls, at, &r, now);
  r = swung_to(time + frame, at);
  place_vessel(v, walls, at, &r, next);
  if (how == MOVED) {
    assert_ok(pbf_move_colliders(solver, walls, next, frame));
    return;
  }
  for (uint32_t k = 0; k < walls; ++k) {
    pbf_collider *c = &now[k];
    if (how == WITH_VELOCITIES) {
      c->velocity[0] = -rate * (c->position[1] - center[1]);
      c->velocity[1] = rate * (c->position[0] - center[0]);
      c->angular_velocity[2] = rate;
      continue;
    }
    for (int a = 0; a < 3; ++a) c->velocity[a] = (next[k].position[a] - c->position[a]) / frame;
    c->angular_velocity[2] = (angle_at(time + frame) - angle_at(time)) / frame;
  }
  assert_ok(pbf_set_colliders(solver, walls, now));
}

static void check_swing_told(uint32_t dimension, uint32_t precision, telling how) {
  static const char *const names[] = {"moved", "with its velocities", "with chords"};
  const double half[3] = {4 * spacing, 6 * spacing, 4 * spacing};
  const vessel v = vessel_of(dimension, half, 0.5 * wall);
  const pbf_params params = params_of(frame / STEPS_A_FRAME);
  const uint32_t walls = 2 * dimension;
  double at[3];
  rotation r = swung_to(0, at);
  pbf_collider colliders[WALLS];
  water w = fill(dimension, precision, &v, at, &r, &params);
  place_vessel(&v, walls, at, &r, colliders);
  assert_ok(pbf_set_colliders(w.solver, walls, colliders));
  for (int k = 0; k < FRAMES; ++k) {
    tell(w.solver, &v, walls, how, k * frame);
    assert_ok(pbf_step(w.solver, STEPS_A_FRAME));
  }
  for (uint32_t k = 0; k < walls; ++k) { /* where it says it is, whatever that is */
    colliders[k].struct_size = sizeof colliders[k];
    assert_ok(pbf_get_collider(w.solver, k, &colliders[k]));
  }
  r = swung_to(FRAMES * frame, at);
  if (how == WITH_VELOCITIES) /* exact ones lead elsewhere only while it gains speed */
    for (int a = 0; a < 3; ++a)
      if (!(fabs(colliders[0].position[a] - at[a]) < 2 * half[1]))
        fail_msg("the bucket is not on its circle");
  const uint32_t outside = count_outside(&w, &v, at, &r);
  if (outside > 0)
    fail_msg("%uD: a bucket swung, %s, loses %u of %u", dimension, names[how], outside, w.count);
  destroy(&w);
}

static void check_swing(uint32_t dimension, uint32_t precision) {
  for (int how = MOVED; how <= WITH_CHORDS; ++how)
    check_swing_told(dimension, precision, (telling)how);
}

static void buckets_can_be_swung(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_swing);
}

/* ---- Walls that close on the water ---------------------------------------------------------- */

/* Two opposite walls come together until they overlap, and open again: who finds no room is
 * counted, stays, and is there again in the end. */
static void check_squeeze(uint32_t dimension, uint32_t precision) {
  enum { CLOSING = 60 };
  const double half[3] = {2 * spacing, 4 * spacing, 2 * spacing}, closed = half[0] + 0.1 * wall;
  const rotation upright = rotation_about(along_z, 0);
  const vessel v = vessel_of(dimension, half, wall);
  const pbf_params params = params_of(1.0 / 120);
  const uint32_t walls = 2 * dimension;
  pbf_collider colliders[WALLS];
  pbf_stats stats = {.struct_size = sizeof stats};
  water w = fill(dimension, precision, &v, center, &upright, &params);
  place_vessel(&v, walls, center, &upright, colliders);
  assert_ok(pbf_set_colliders(w.solver, walls, colliders));
  for (int way = 0; way < 2; ++way) {
    for (uint32_t k = 2; k < 4; ++k) /* those at the ends of x */
      colliders[k].position[0] += (k == 2 ? 1 : -1) * (way ? -1 : 1) * closed;
    assert_ok(pbf_move_colliders(w.solver, walls, colliders, CLOSING / 120.0));
    assert_ok(pbf_step(w.solver, CLOSING + 10));
    assert_ok(pbf_get_stats(w.solver, &stats));
    if (way == 0 && stats.squeezed < w.count / 2)
      fail_msg("%uD: %u of %u are squeezed", dimension, stats.squeezed, w.count);
  }
  assert_ok(pbf_step(w.solver, 30));
  assert_ok(pbf_get_stats(w.solver, &stats));
  const uint32_t outside = count_outside(&w, &v, center, &upright);
  if (stats.squeezed > 0 || outside > 0)
    fail_msg("%uD: %u of %u are outside, %u squeezed", dimension, outside, w.count, stats.squeezed);
  destroy(&w);
}

static void what_is_squeezed_stays(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub solves nothing");
  test_for_long_kinds(check_squeeze);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(seams_are_tight),
      cmocka_unit_test(troughs_are_tight),
      cmocka_unit_test(buckets_can_be_swung),
      cmocka_unit_test(what_is_squeezed_stays),
  };
  return TEST_RUN(tests);
}
