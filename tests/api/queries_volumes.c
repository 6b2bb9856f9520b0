/* Boxes, spheres and capsules: how much of them is under water, and which particles they hold. */
#include "query_scene.h"

/* Half sunk: half of it, with the centre of half a disc or ball, and the stream's velocity. */
static void check_sunk(uint32_t dimension, uint32_t precision) {
  const pool p = pool_of(dimension, precision, still, 1);
  const double pi = acos(-1.0), r = 3.3 * d, half = dimension == 3 ? 3 * r / 8 : 4 * r / (3 * pi);
  pbf_volume ball = volume_of(PBF_VOLUME_SPHERE), box = volume_of(PBF_VOLUME_BOX);
  ball.radius = r;
  pbf_volume_flow found = measure(&p, &ball);
  assert_near(found.fraction, 0.5, 0.01, "the fraction of a ball");
  assert_near(found.volume, dimension == 3 ? 4 * pi * r * r * r / 3 : pi * r * r, 1e-12, "volume");
  assert_near(found.centre[0], ball.position[0], 0.05 * d, "its centre's x");
  assert_near(found.centre[1], level - half, 0.05 * d, "its centre's y");
  for (uint32_t k = 0; k < dimension; ++k)
    assert_near(found.velocity[k], flow[k], 1e-6, "velocity");
  /* Turned by an eighth about z, a third of its height above the surface: known by triangles. */
  box.half_extents[0] = box.half_extents[1] = r / sqrt(2);
  box.half_extents[2] = 2 * d;
  box.orientation[2] = sin(pi / 8);
  box.orientation[3] = cos(pi / 8);
  box.position[1] = level - 0.5 * r; /* above is a triangle half as high as the upper half */
  assert_near(measure(&p, &box).fraction, 1 - 0.25 / 2, 0.01, "the fraction of a box");
  ball.position[1] = level + r + d;
  found = measure(&p, &ball);
  assert_near(found.fraction, 0, 0, "the fraction in air");
  assert_near(found.centre[1], ball.position[1], 0, "the centre of nothing");
  ball.position[1] = level / 2;
  assert_near(measure(&p, &ball).fraction, 1, 0, "the fraction under water");
  pbf_destroy(p.solver);
}

static void half_sunk(void **state) {
  (void)state;
  test_for_each_kind(check_sunk);
}

/* A capsule that lies half in the water, whichever way it is turned within the surface. */
static void check_capsule(uint32_t dimension, uint32_t precision) {
  const pool p = pool_of(dimension, precision, still, 1);
  pbf_volume capsule = volume_of(PBF_VOLUME_CAPSULE);
  capsule.radius = 1.5 * d;
  capsule.half_length = 3 * d;
  capsule.axis[0] = 2;
  capsule.axis[1] = 0;
  assert_near(measure(&p, &capsule).fraction, 0.5, 0.01, "the fraction of a capsule");
  capsule.axis[0] = 0;
  capsule.axis[1] = 2;
  capsule.orientation[2] = capsule.orientation[3] = sqrt(0.5); /* y to -x */
  assert_near(measure(&p, &capsule).fraction, 0.5, 0.01, "the fraction of a turned capsule");
  capsule.orientation[2] = 0;
  capsule.orientation[3] = 1; /* upright, its lower end 4.5 spacings deep */
  capsule.position[1] += 1.5 * d;
  const double pi = acos(-1.0), r = 1.5 * d, l = 6 * d; /* the lower half-ball and 1.5 of the rod */
  const double ball = dimension == 3 ? 4 * pi * r * r * r / 3 : pi * r * r;
  const double area = dimension == 3 ? pi * r * r : 2 * r;
  assert_near(measure(&p, &capsule).fraction, (ball / 2 + 1.5 * d * area) / (ball + l * area), 0.01,
              "the fraction of an upright capsule");
  pbf_destroy(p.solver);
}

static void capsules(void **state) {
  (void)state;
  test_for_each_kind(check_capsule);
}

/* Whether a place is inside, by the definition of each shape; orientations turn about z. */
static int is_inside(const pbf_volume *v, const double *x, uint32_t dimension) {
  const double angle = 2 * atan2(v->orientation[2], v->orientation[3]);
  const double way[3] = {x[0] - v->position[0], x[1] - v->position[1],
                         dimension == 3 ? x[2] - v->position[2] : 0};
  const double r[3] = {cos(angle) * way[0] + sin(angle) * way[1],
                       cos(angle) * way[1] - sin(angle) * way[0], way[2]};
  const double y = fmin(fmax(r[1], -v->half_length), v->half_length); /* on the segment */
  const double axial = v->shape == PBF_VOLUME_CAPSULE ? r[1] - y : r[1];
  if (v->shape != PBF_VOLUME_BOX)
    return r[0] * r[0] + axial * axial + r[2] * r[2] <= v->radius * v->radius;
  return fabs(r[0]) <= v->half_extents[0] && fabs(r[1]) <= v->half_extents[1] &&
         fabs(r[2]) <= v->half_extents[2];
}

static void check_found(uint32_t dimension, uint32_t precision) {
  const pool p = pool_of(dimension, precision, slope, 5);
  static double x[MOST * 3];
  static uint32_t ids[MOST + 8], right[MOST + 8];
  assert_ok(pbf_step(p.solver, 2));
  assert_ok(pbf_remove_particles(p.solver, 3, (const uint32_t[]){2, 50, 98}));
  assert_ok(pbf_get_positions(p.solver, 0, p.count - 3, x));
  for (uint32_t shape = PBF_VOLUME_BOX; shape <= PBF_VOLUME_CAPSULE; ++shape) {
    pbf_volume v = volume_of(shape);
    v.position[1] = 0.3;
    v.half_extents[0] = 0.21, v.half_extents[1] = 0.1, v.half_extents[2] = 0.12;
    v.radius = 0.13, v.half_length = 0.1;
    v.orientation[2] = sin(0.4), v.orientation[3] = cos(0.4);
    uint32_t found = 0, count = 77;
    assert_ok(pbf_get_ids(p.solver, 0, p.count - 3, ids));
    for (uint32_t row = 0; row < p.count - 3; ++row) {
      double at[3] = {0};
      for (uint32_t k = 0; k < dimension; ++k)
        at[k] = test_value(x, (uint64_t)row * dimension + k, precision);
      if (is_inside(&v, at, dimension)) right[found++] = ids[row];
    }
    assert_true(found > 10);
    memset(ids, 0xff, sizeof ids);
    assert_ok(pbf_find_in_volume(p.solver, &v, MOST, ids, &count));
    assert_int_equal(count, found);
    assert_memory_equal(ids, right, found * sizeof *ids);
    memset(ids, 0xff, sizeof ids);
    assert_ok(pbf_find_in_volume(p.solver, &v, 4, ids, &count));
    assert_int_equal(count, found);
    assert_memory_equal(ids, right, 4 * sizeof *ids);
    assert_int_equal(ids[4], UINT32_MAX);
  }
  pbf_destroy(p.solver);
}

static void found_in_volumes(void **state) {
  (void)state;
  test_for_each_kind(check_found);
}

/* Sizes that are accepted each, of which a volume is no number: in 3D their product overflows. */
static void volumes_are_numbers(void **state) {
  (void)state;
  for (uint32_t dimension = 2; dimension <= 3; ++dimension) {
    if (!test_has_kind(dimension, PBF_FLOAT64)) continue;
    pbf_solver *s = test_filled(dimension, PBF_FLOAT64, 8, 8);
    for (uint32_t shape = PBF_VOLUME_BOX; shape <= PBF_VOLUME_CAPSULE; ++shape) {
      pbf_volume_flow result = {.struct_size = sizeof result, .volume = 77};
      pbf_volume v = volume_of(shape);
      v.half_extents[0] = v.half_extents[1] = v.half_extents[2] = v.radius = 1e120;
      if (dimension == 2) {
        assert_ok(pbf_measure_volumes(s, 1, &v, &result));
        assert_true(isfinite(result.volume) && result.volume > 1e239);
      } else {
        assert_fails(pbf_measure_volumes(s, 1, &v, &result), PBF_ERROR_INVALID_ARGUMENT,
                     "volumes[0] is so large");
        assert_true(result.volume == 77);
      }
    }
    pbf_destroy(s);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(half_sunk),
      cmocka_unit_test(capsules),
      cmocka_unit_test(found_in_volumes),
      cmocka_unit_test(volumes_are_numbers),
  };
  return TEST_RUN(tests);
}
