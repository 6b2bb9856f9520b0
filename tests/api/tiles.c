/* A solid of many flush boxes, hulls or meshes is the solid of one box: the same density next to
 * it, the same loads, the same friction with what sticks to it; and water rests in a pool of them.
 * So is one of many round ones that reach into each other; and boxes flush with the domain's walls
 * are these walls. */
#include "load_scene.h"
#include "meshes.h"

enum { MOST = 64 };

/* What tiles are of, one after the other. */
enum { BOXES = 0, HULLS, MESHES, HULLS_AND_BOXES, ROUND };

/* The wall below x = 0 of a tank 8 spacings wide, `thick` and 12 high, at least as long as both. */
typedef struct wall {
  uint32_t dimension;
  double tile, thick, high, turned; /* about z, the tank with it */
  double overlap;                   /* so far boxes reach into each other */
  int of;
  double cell;
  double shift; /* of the wall along itself: seams are straight before particles */
} wall;

static uint32_t tiles_along(double length, double tile) {
  return tile > 0 ? (uint32_t)lround(length / tile) : 1;
}

static void turn(double angle, const double x[3], double to[3]) {
  to[0] = cos(angle) * x[0] - sin(angle) * x[1];
  to[1] = sin(angle) * x[0] + cos(angle) * x[1];
  to[2] = x[2];
}

static pbf_collider turned_box(const wall *w, const double lower[3], const double upper[3]) {
  double center[3], place[3];
  for (int k = 0; k < 3; ++k) center[k] = (lower[k] + upper[k]) / 2;
  turn(w->turned, center, place);
  pbf_collider box = load_collider(PBF_COLLIDER_BOX, place[0], place[1], place[2]);
  for (int k = 0; k < 3; ++k) box.half_extents[k] = (upper[k] - lower[k]) / 2 + w->overlap / 2;
  box.half_extents[0] = (upper[0] - lower[0]) / 2;
  box.orientation[2] = sin(w->turned / 2);
  box.orientation[3] = cos(w->turned / 2);
  return box;
}

static pbf_shape *hull_of_box(uint32_t dimension, const double half[3], double cell) {
  double points[24];
  for (uint32_t i = 0; i < 1u << dimension; ++i)
    for (uint32_t k = 0; k < dimension; ++k)
      points[i * dimension + k] = i >> k & 1 ? half[k] : -half[k];
  const pbf_hull_desc desc = {.struct_size = sizeof desc,
                              .dimension = dimension,
                              .point_count = 1u << dimension,
                              .points = points,
                              .cell = cell};
  pbf_shape *shape = NULL;
  assert_ok(pbf_shape_from_points(&desc, &shape));
  return shape;
}

static pbf_shape *mesh_of_box(uint32_t dimension, const double half[3], double cell) {
  mesh m = box_mesh(dimension, half);
  pbf_shape *shape = baked(&m, cell, 0);
  mesh_free(&m);
  return shape;
}

/* Makes a field of the box, for which its solver is to have the only reference. */
static void make_field(const wall *w, pbf_collider *box, int is_mesh) {
  const double *half = box->half_extents;
  pbf_shape *shape = (is_mesh ? mesh_of_box : hull_of_box)(w->dimension, half, w->cell);
  pbf_collider field = load_collider(PBF_COLLIDER_SHAPE, 0, 0, 0);
  field.geometry = shape;
  for (int k = 0; k < 3; ++k) field.position[k] = box->position[k];
  for (int k = 0; k < 4; ++k) field.orientation[k] = box->orientation[k];
  if (w->dimension == 2) field.position[2] = 0;
  *box = field;
}

static void release_fields(uint32_t count, const pbf_collider *of) {
  for (uint32_t k = 0; k < count; ++k)
    if (of[k].shape == PBF_COLLIDER_SHAPE) pbf_release_shape(of[k].geometry);
}

/* Logs upon each other, that reach into each other for the most part; in 2D discs. */
static uint32_t bank_of(const wall *w, pbf_collider *to) {
  const double radius = w->thick, low = -4 * load_spacing;
  const uint32_t count = tiles_along(w->high + 4 * load_spacing, w->tile);
  assert_true(count <= MOST);
  for (uint32_t k = 0; k < count; ++k) {
    const double place[3] = {-radius, low + k * w->tile, 4 * load_spacing};
    to[k] = load_collider(w->dimension == 3 ? PBF_COLLIDER_CAPSULE : PBF_COLLIDER_SPHERE, 0, 0, 0);
    turn(w->turned, place, to[k].position);
    if (w->dimension == 2) to[k].position[2] = 0;
    to[k].radius = radius;
    to[k].half_length = 8 * load_spacing;
    for (int a = 0; a < 3; ++a) to[k].axis[a] = a == 2;
  }
  return count;
}

static uint32_t wall_of(const wall *w, pbf_collider *to) {
  if (w->of == ROUND) return bank_of(w, to);
  const double low = -2 * load_spacing - w->shift, from[3] = {-w->thick, low, low};
  const double size[3] = {w->thick, w->high + 4 * load_spacing, 12 * load_spacing};
  uint32_t n[3], count = 0;
  for (uint32_t k = 0; k < 3; ++k) n[k] = k < w->dimension ? tiles_along(size[k], w->tile) : 1;
  assert_true(n[0] * n[1] * n[2] <= MOST);
  for (uint32_t x = 0; x < n[0]; ++x)
    for (uint32_t y = 0; y < n[1]; ++y)
      for (uint32_t z = 0; z < n[2]; ++z) {
        const uint32_t at[3] = {x, y, z};
        double lower[3], upper[3];
        for (int k = 0; k < 3; ++k) {
          lower[k] = from[k] + size[k] * at[k] / n[k];
          upper[k] = from[k] + size[k] * (at[k] + 1) / n[k];
        }
        to[count] = turned_box(w, lower, upper);
        if (w->of == HULLS || w->of == MESHES || (w->of == HULLS_AND_BOXES && (x + y + z) % 2))
          make_field(w, &to[count], w->of == MESHES);
        ++count;
      }
  return count;
}

static uint32_t planes(const wall *w) { return w->dimension == 3 ? 4 : 2; }

/* Floor and the other walls are planes, so that nothing but the wall's boxes changes. */
static uint32_t tank_of(const wall *w, pbf_collider *to) {
  const double normals[4][3] = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}};
  const double places[4][3] = {
      {0, 0, 0}, {8 * load_spacing, 0, 0}, {0, 0, 0}, {0, 0, 8 * load_spacing}};
  uint32_t count = wall_of(w, to);
  for (uint32_t k = 0; k < planes(w); ++k) {
    double place[3], normal[3];
    turn(w->turned, places[k], place);
    turn(w->turned, normals[k], normal);
    to[count] = load_collider(PBF_COLLIDER_PLANE, place[0], place[1], place[2]);
    for (int i = 0; i < 3; ++i) to[count].axis[i] = normal[i];
    ++count;
  }
  return count;
}

static load_scene water_at(const wall *w, uint32_t precision, double support, double no_slip) {
  const double size[3] = {8 * load_spacing, 8 * load_spacing, 8 * load_spacing};
  const double gravity[3] = {0, -load_gravity, 0}, none[3] = {0};
  pbf_collider colliders[MOST + 4];
  pbf_params params = load_params(w->dimension, none);
  params.smoothing_radius = support * load_spacing;
  params.viscosity = no_slip > 0 ? 0.01 : 0;
  turn(w->turned, gravity, params.gravity);
  for (int k = 0; k < 3; ++k) params.domain_min[k] = -(params.domain_max[k] = 4);
  const uint32_t count = tank_of(w, colliders);
  for (uint32_t k = 0; k < count - planes(w); ++k) colliders[k].no_slip = no_slip;
  load_scene s = load_scene_of(w->dimension, precision, &params, size, load_everywhere, 0, NULL);
  for (uint32_t i = 0; i < s.count; ++i) {
    double x[3] = {0}, to[3];
    for (uint32_t k = 0; k < w->dimension; ++k)
      x[k] = test_value(s.values, (uint64_t)i * w->dimension + k, precision);
    turn(w->turned, x, to);
    for (uint32_t k = 0; k < w->dimension; ++k)
      test_put(s.values, (uint64_t)i * w->dimension + k, precision, to[k]);
  }
  assert_ok(pbf_set_positions(s.solver, 0, s.count, s.values));
  assert_ok(pbf_set_colliders(s.solver, count, colliders));
  release_fields(count, colliders);
  return s;
}

/* The largest difference of two scenes' densities. */
static double parted(load_scene *a, load_scene *b) {
  char *other = calloc(b->count, b->precision);
  double most = 0;
  assert_ok(pbf_get_densities(a->solver, 0, a->count, a->values));
  assert_ok(pbf_get_densities(b->solver, 0, b->count, other));
  for (uint32_t i = 0; i < a->count; ++i)
    most = fmax(most,
                fabs(test_value(a->values, i, a->precision) - test_value(other, i, b->precision)));
  free(other);
  return most;
}

/* What the wall takes of the fluid's momentum, and the torque about the origin, in all. */
static void load_of_wall(load_scene *s, const wall *w, double sums[6]) {
  pbf_collider_load loads[MOST + 4];
  pbf_collider colliders[MOST + 4];
  const uint32_t boxes = wall_of(w, colliders), all = boxes + planes(w);
  load_colliders(s, all, loads);
  for (int k = 0; k < 6; ++k) sums[k] = 0;
  release_fields(boxes, colliders);
  for (uint32_t i = 0; i < boxes; ++i)
    for (int k = 0; k < 3; ++k) sums[k] += loads[i].impulse[k];
}

static void check(const wall *tiles, uint32_t precision, double support, double no_slip) {
  wall whole = *tiles;
  double right[6], of_tiles[6], size = 0;
  whole.tile = whole.overlap = whole.of = 0;
  load_scene one = water_at(&whole, precision, support, no_slip);
  load_scene many = water_at(tiles, precision, support, no_slip);
  const double exact = precision == PBF_FLOAT64 ? 1e-9 : 2e-5;
  /* Straight before where seams cross a little is left. */
  const double of_fields = tiles->dimension == 3 ? 0.01 : 0.004;
  const double bar = tiles->of == ROUND ? 0.008 : tiles->of ? of_fields : exact;
  /* A field of two cells has an exact plane before its middle alone, and logs have many. */
  const double of_field = tiles->of != ROUND && tiles->tile > 3 * tiles->cell ? 0.02 : 0.05;
  const double of_load = tiles->of ? of_field : 50 * exact;
  for (int step = 0; step < 4; ++step) {
    const double apart = parted(&one, &many);
    if (!(apart < bar))
      fail_msg(
          "%uD, float%u, tiles %d of %g turned by %g, h = %g d, step %d: densities differ by %g",
          tiles->dimension, 8 * precision, tiles->of, tiles->tile / load_spacing, tiles->turned,
          support, step, apart);
    assert_ok(pbf_step(one.solver, 1));
    assert_ok(pbf_step(many.solver, 1));
  }
  load_of_wall(&one, &whole, right);
  load_of_wall(&many, tiles, of_tiles);
  for (int k = 0; k < 3; ++k) size = fmax(size, fabs(right[k]));
  assert_true(size > 0);
  for (int k = 0; k < 3; ++k)
    if (!(fabs(right[k] - of_tiles[k]) < of_load * size))
      fail_msg("%uD, tiles of %g, h = %g d: along axis %d they take %g, one box %g",
               tiles->dimension, tiles->tile / load_spacing, support, k, of_tiles[k], right[k]);
  load_end(&one);
  load_end(&many);
}

static void with_kinds(void (*with)(uint32_t dimension, uint32_t precision)) {
  int tried = 0;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension)
    for (uint32_t precision = 4; precision <= 8; precision += 4)
      if (test_has_kind(dimension, precision)) with(dimension, precision), ++tried;
  if (!tried) test_skip("not in this build");
}

static void check_supports(uint32_t dimension, uint32_t precision) {
  const double d = load_spacing, supports[] = {2, 2.5, 3};
  for (int k = 0; k < 3; ++k) {
    const wall flat = {dimension, dimension == 3 ? 4 * d : 2 * d, 4 * d, 12 * d, 0, 0, BOXES, 0, 0};
    check(&flat, precision, supports[k], 0);
  }
  const wall thin = {
      dimension, dimension == 3 ? 4 * d : d, dimension == 3 ? 4 * d : 2 * d, 12 * d, 0, 0, BOXES, 0,
      0};
  check(&thin, precision, 3, 0);
}

static void flush_boxes_are_one_solid(void **state) {
  (void)state;
  with_kinds(check_supports);
}

static void check_turned(uint32_t dimension, uint32_t precision) {
  const double d = load_spacing;
  const wall turned = {dimension, dimension == 3 ? 4 * d : 2 * d, 4 * d, 12 * d, 0.4, 0, BOXES, 0,
                       0};
  const wall overlapping = {
      dimension, dimension == 3 ? 4 * d : 2 * d, 4 * d, 12 * d, 0.4, d, BOXES, 0, 0};
  check(&turned, precision, 3, 0);
  check(&overlapping, precision, 3, 0);
}

static void aslant_and_where_they_overlap(void **state) {
  (void)state;
  with_kinds(check_turned);
}

/* Logs of 4 spacings, 0.4 apart: what is between two of them is 0.005 spacings deep. */
static void check_round(uint32_t dimension, uint32_t precision) {
  const double d = load_spacing;
  const wall upright = {dimension, 0.4 * d, 4 * d, 12 * d, 0, 0, ROUND, 0, 0};
  const wall turned = {dimension, 0.4 * d, 4 * d, 12 * d, 0.4, 0, ROUND, 0, 0};
  check(&upright, precision, 2, 0);
  check(&turned, precision, 3, 0);
}

static void round_ones_in_each_other_are_one_solid(void **state) {
  (void)state;
  with_kinds(check_round);
}

/* Water in a corner of the domain, with boxes flush with its walls, or without. */
static load_scene water_in_domain(uint32_t dimension, uint32_t precision, double support,
                                  uint32_t boxes) {
  const double side = 6 * load_spacing, size[3] = {side, side, side}, tank[3] = {side, 1, side};
  pbf_collider beyond[3];
  pbf_params params = load_params(dimension, tank);
  params.smoothing_radius = support * load_spacing;
  for (uint32_t k = 0; k < boxes; ++k) {
    beyond[k] = load_collider(PBF_COLLIDER_BOX, 0, 0, 0);
    for (int a = 0; a < 3; ++a) beyond[k].half_extents[a] = a == (int)k ? 0.25 : 2;
    beyond[k].position[k] = -0.25;
  }
  return load_scene_of(dimension, precision, &params, size, load_everywhere, boxes, beyond);
}

static void check_flush_with_domain(uint32_t dimension, uint32_t precision) {
  for (double support = 2; support < 3.5; support += 1) {
    load_scene walls = water_in_domain(dimension, precision, support, 0);
    load_scene boxes = water_in_domain(dimension, precision, support, dimension);
    for (int step = 0; step < 4; ++step) {
      assert_ok(pbf_get_positions(walls.solver, 0, walls.count, walls.values));
      assert_ok(pbf_set_positions(boxes.solver, 0, walls.count, walls.values));
      const double apart = parted(&walls, &boxes);
      if (!(apart < 2e-5))
        fail_msg("%uD, float%u, h = %g d, step %d: densities differ by %g", dimension,
                 8 * precision, support, step, apart);
      assert_ok(pbf_step(walls.solver, 1));
    }
    load_end(&walls);
    load_end(&boxes);
  }
}

static void flush_with_the_domain_they_are_its_walls(void **state) {
  (void)state;
  with_kinds(check_flush_with_domain);
}

static void check_sticky(uint32_t dimension, uint32_t precision) {
  const double d = load_spacing;
  const wall flat = {dimension, dimension == 3 ? 4 * d : 2 * d, 4 * d, 12 * d, 0, 0, BOXES, 0, 0};
  check(&flat, precision, 2, 1);
}

static void fluid_sticks_to_them_as_to_one(void **state) {
  (void)state;
  with_kinds(check_sticky);
}

/* As flush boxes are, but for what fields round off. */
static void check_fields(uint32_t dimension, uint32_t precision) {
  const double d = load_spacing, tile = dimension == 3 ? 4 * d : 2 * d;
  for (int of = HULLS; of <= HULLS_AND_BOXES; ++of) {
    const wall flat = {dimension, tile, 4 * d, 12 * d, 0, 0, of, 0.5 * d, 0.48 * d};
    const wall turned = {dimension, tile, 4 * d, 12 * d, 0.4, 0, of, 0.25 * d, 0.48 * d};
    check(&flat, precision, of == HULLS ? 3 : 2, 0);
    if (of == HULLS) check(&turned, precision, 2.5, 0);
    if (of == HULLS) check(&flat, precision, 2, 1);
  }
  const wall small = {2, d, 2 * d, 12 * d, 0, 0, HULLS, 0.5 * d, 0.48 * d};
  if (dimension == 2) check(&small, precision, 3, 0);
}

static void flush_fields_are_one_solid(void **state) {
  (void)state;
  with_kinds(check_fields);
}

/* RMS over the last half second of two, over √(g d). */
static double speed_at_rest(const wall *w, uint32_t precision, double support) {
  load_scene s = water_at(w, precision, support, 0);
  const int steps = (int)lround(2 / s.params.time_step);
  double sum = 0, all = 0;
  for (int step = 0; step < steps; ++step) {
    assert_ok(pbf_step(s.solver, 1));
    if (step < 3 * steps / 4) continue;
    assert_ok(pbf_get_velocities(s.solver, 0, s.count, s.values));
    for (uint64_t i = 0; i < (uint64_t)s.count * w->dimension; ++i)
      sum += pow(test_value(s.values, i, precision), 2);
    all += s.count;
  }
  load_end(&s);
  return sqrt(sum / all / (load_gravity * load_spacing));
}

/* As in front of one box, where water is not quite at rest. With h = 3 d it moves on by 0.1 and
 * more before either, and by how much is chance. */
static void check_rest(uint32_t dimension, uint32_t precision) {
  const double d = load_spacing;
  if (dimension == 3) return;
  wall w = {dimension, 0, 2 * d, 12 * d, 0, 0, BOXES, 0.5 * d, 0};
  const double right = speed_at_rest(&w, precision, 2.5);
  for (w.of = HULLS; w.of <= HULLS_AND_BOXES; ++w.of)
    for (w.tile = d; w.tile < 3 * d; w.tile += d) {
      const double speed = speed_at_rest(&w, precision, 2.5);
      if (!(speed < 1.5 * right + 0.01))
        fail_msg("float%u, tiles %d of %g: water moves at %g √(g d), before one box at %g",
                 8 * precision, w.of, w.tile / d, speed, right);
    }
}

static void water_rests_before_their_seams(void **state) {
  (void)state;
  if (TEST_INSTRUMENTED) test_skip("nothing comes to rest in so little time");
  with_kinds(check_rest);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(flush_boxes_are_one_solid),
      cmocka_unit_test(aslant_and_where_they_overlap),
      cmocka_unit_test(round_ones_in_each_other_are_one_solid),
      cmocka_unit_test(flush_with_the_domain_they_are_its_walls),
      cmocka_unit_test(fluid_sticks_to_them_as_to_one),
      cmocka_unit_test(flush_fields_are_one_solid),
      cmocka_unit_test(water_rests_before_their_seams),
  };
  if (test_is_stub()) return TEST_SKIPPED;
  return TEST_RUN(tests);
}
