/* How many spray, foam and bubbles the fluid makes, where they begin and when they end, against
 * sums over all pairs of its particles. */
#include "diffuse_scene.h"

/* ---- Birth and death ------------------------------------------------------------------------- */

static double weights_at_rest(uint32_t dimension) { /* h is two spacings */
  double sum = 0;
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      for (int k = -2; k <= 2; ++k) {
        const double q = sqrt(i * i + j * j + k * k) / 2;
        if (q > 0 && q < 1 && (dimension == 3 || k == 0)) sum += 1 - q;
      }
  return sum;
}

static const double half_speed = 0.5; /* of each of two that meet */

static double meeting(const double x[3], int component) {
  return component == 0 ? (x[0] < 2 ? half_speed : -half_speed) : 0;
}

/* Two particles that come together: both make the same, which has a closed form at each step. */
static void check_rate(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = box_of(dimension, precision, 0, 4);
  pbf_diffuse_desc desc = desc_of(s);
  const double r0 = 1.8 * d;
  for (int i = 0; i < 2; ++i)
    add_block(s, dimension, precision, (double[3]){2 + (i - 0.5) * r0, 2, 2}, (int[3]){1, 1, 1},
              meeting);
  desc.energy_min = 0.0625;
  desc.energy_max = 0.3125; /* I_k is (0.125 - 0.0625) / 0.25 = 1/4 */
  desc.trapped_air_min = 0.0078125;
  desc.trapped_air_max = 0.5;
  desc.trapped_air_rate = 50000;
  desc.wave_crest_rate = 0;
  desc.lifetime_min = 10;
  desc.lifetime_max = 50;
  assert_ok(pbf_set_diffuse(s, &desc));
  double right = 0, last = 0;
  for (int step = 1; step <= 8; ++step) {
    assert_ok(pbf_step(s, 1));
    const double q = (r0 - 2 * half_speed * step * dt) / (2 * d);
    const double closing = 2 * 2 * half_speed * (1 - q) / weights_at_rest(dimension);
    last = (closing - desc.trapped_air_min) / (desc.trapped_air_max - desc.trapped_air_min);
    assert_true(last > 0 && last < 1);
    right += 2 * 0.25 * desc.trapped_air_rate * last * dt;
    assert_near((double)info_of(s).generated, right, 1 + 1e-4 * right, "their number");
  }
  static one all[20000];
  const uint32_t count = read_all(s, all, 20000);
  assert_true(count > 100);
  assert_near(all[count - 1].life, 10 + 40 * 0.25 * last, 1e-4, "the youngest's lifetime");
  assert_near(all[count - 1].age, 0, 0, "its age");
  pbf_destroy(s);
}

static void the_rate_is_that_of_what_comes_together(void **state) {
  (void)state;
  test_for_each_kind(check_rate);
}

/* What does not come together, has no crest and is slow makes none. */
static void check_none(uint32_t dimension, uint32_t precision) {
  for (int i = 0; i < 3; ++i) {
    const int is_basin = i == 2; /* full to the walls */
    const double middle = is_basin ? 4.5 * d : 2;
    pbf_solver *s = box_of(dimension, precision, is_basin ? 9.81 : 0, 2 * middle);
    pbf_diffuse_desc desc = desc_of(s);
    add_block(s, dimension, precision, (double[3]){middle, middle, middle}, (int[3]){9, 9, 9},
              i == 0 ? shifting : still);
    desc.energy_min = is_basin ? 0.02 : 0;
    desc.trapped_air_rate = 1e6;
    desc.wave_crest_rate = i == 0 ? 0 : 1e6;
    assert_ok(pbf_set_diffuse(s, &desc));
    assert_ok(pbf_step(s, 20));
    const pbf_diffuse_info info = info_of(s);
    if (info.generated > 0) fail_msg("%d: %g were made", i, (double)info.generated);
    assert_near(info.time, 20 * dt, 1e-12, "their time");
    pbf_destroy(s);
  }
}

static void quiet_and_rigid_fluid_makes_none(void **state) {
  (void)state;
  test_for_each_kind(check_none);
}

/* ---- Against sums over all pairs ------------------------------------------------------------- */

typedef struct fluid {
  uint32_t count, dimension;
  double x[3 * CAPACITY], v[3 * CAPACITY], normal[3 * CAPACITY];
} fluid;

static fluid around; /* too large for a stack */

static double dot_of(const double *a, const double *b, uint32_t n) {
  double sum = 0;
  for (uint32_t k = 0; k < n; ++k) sum += a[k] * b[k];
  return sum;
}

/* x_i - x_j in units of h, and W. */
static double pair_of(const fluid *f, uint32_t i, uint32_t j, double way[3]) {
  const uint32_t n = f->dimension;
  for (uint32_t k = 0; k < n; ++k) way[k] = (f->x[i * n + k] - f->x[j * n + k]) / (2 * d);
  const double q = sqrt(dot_of(way, way, n));
  return q < 1 && i != j ? 1 - q : 0;
}

static void find_normals(fluid *f) {
  const uint32_t n = f->dimension;
  double way[3];
  for (uint32_t i = 0; i < f->count; ++i) {
    double weight = 0, *normal = &f->normal[i * n];
    for (uint32_t k = 0; k < n; ++k) normal[k] = 0;
    for (uint32_t j = 0; j < f->count; ++j) {
      const double w = pair_of(f, i, j, way);
      weight += w;
      for (uint32_t k = 0; k < n; ++k) normal[k] += w * way[k];
    }
    const double length = sqrt(dot_of(normal, normal, n));
    for (uint32_t k = 0; k < n; ++k) normal[k] = length > 0.12 * weight ? normal[k] / length : 0;
  }
}

static double share(double x, double min, double max) {
  return fmin(fmax((x - min) / (max - min), 0), 1);
}

/* What diffuse.h says that they make in a unit of time. */
static double rate_of(const fluid *f, const pbf_diffuse_desc *desc, double parts[2]) {
  const uint32_t n = f->dimension;
  const double rest = weights_at_rest(n);
  double sum = 0, way[3];
  for (uint32_t i = 0; i < f->count; ++i) {
    const double *v = &f->v[i * n], *normal = &f->normal[i * n];
    const double speed2 = dot_of(v, v, n), ahead = dot_of(v, normal, n);
    const double energy = share(0.5 * speed2, desc->energy_min, desc->energy_max);
    double closing = 0, crest = 0;
    if (!(energy > 0)) continue;
    for (uint32_t j = 0; j < f->count; ++j) {
      const double w = pair_of(f, i, j, way), r = sqrt(dot_of(way, way, n));
      double u[3];
      if (!(w > 0)) continue;
      for (uint32_t k = 0; k < n; ++k) u[k] = v[k] - f->v[j * n + k];
      closing += w * (sqrt(dot_of(u, u, n)) - dot_of(u, way, n) / r);
      const double *other = &f->normal[j * n];
      if (ahead >= 0.6 * sqrt(speed2) && dot_of(way, normal, n) > 0 && dot_of(other, other, n) > 0)
        crest += w * (1 - dot_of(normal, other, n));
    }
    const double trapped = share(closing / rest, desc->trapped_air_min, desc->trapped_air_max);
    const double crests = share(crest / rest, desc->wave_crest_min, desc->wave_crest_max);
    parts[0] += energy * desc->trapped_air_rate * trapped;
    parts[1] += energy * desc->wave_crest_rate * crests;
    sum += energy * (desc->trapped_air_rate * trapped + desc->wave_crest_rate * crests);
  }
  return sum;
}

/* A ball of fluid that flies into a block. */
static double colliding(const double x[3], int component) {
  return x[1] > 2 ? (component == 0 ? 1 : component == 1 ? -3 : 0.5) : 0;
}

static void check_births(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = box_of(dimension, precision, 2, 4);
  pbf_diffuse_desc desc = desc_of(s);
  fluid *f = &around;
  double right = 0, parts[2] = {0, 0};
  f->dimension = dimension;
  f->count = add_block(s, dimension, precision, (double[3]){2, 2 - 2.5 * d, 2}, (int[3]){13, 5, 9},
                       colliding);
  f->count += add_block(s, dimension, precision, (double[3]){2.01, 2 + 3.2 * d, 2.02},
                        (int[3]){6, 6, 6}, colliding);
  desc.energy_min = 0.1;
  desc.energy_max = 4;
  desc.wave_crest_rate *= 10;
  assert_ok(pbf_set_diffuse(s, &desc));
  for (int step = 0; step < 12; ++step) {
    assert_ok(pbf_step(s, 1));
    test_read(s, dimension, precision, f->count, f->x, f->v);
    find_normals(f);
    right += rate_of(f, &desc, parts) * dt;
    assert_near((double)info_of(s).generated, right, 1 + 0.002 * right, "their number");
  }
  assert_true(right > 50 && parts[0] * dt > 10 && parts[1] * dt > 10); /* both have a part */
  pbf_destroy(s);
}

static void births_are_those_of_the_potentials(void **state) {
  (void)state;
  test_for_long_kinds(check_births);
}

/* They begin in the cylinder before their particle, and across it by `scatter`. */
static void check_places(uint32_t dimension, uint32_t precision) {
  static one all[20000];
  pbf_solver *s = box_of(dimension, precision, 0, 4);
  pbf_diffuse_desc desc = desc_of(s);
  for (int i = 0; i < 2; ++i)
    add_block(s, dimension, precision, (double[3]){2 + (i - 0.5) * 1.8 * d, 2, 2},
              (int[3]){1, 1, 1}, meeting);
  desc.energy_min = 0;
  desc.energy_max = 0.01;
  desc.trapped_air_min = 0;
  desc.trapped_air_max = 0.001;
  desc.trapped_air_rate = 5000 / dt;
  desc.wave_crest_rate = 0;
  desc.scatter = 0.2;
  assert_ok(pbf_set_diffuse(s, &desc));
  assert_ok(pbf_step(s, 1));
  const uint32_t count = read_all(s, all, 20000);
  assert_near(count, 10000, 1, "their number");
  double way = 0, across2 = 0, farthest = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const double sign = all[i].v[0] > 0 ? 1 : -1;
    const double begin = 2 - sign * (0.9 * d - half_speed * dt);
    const double ahead = sign * (all[i].x[0] - begin), y = all[i].x[1] - 2, z = all[i].x[2] - 2;
    const double off2 = y * y + (dimension == 3 ? z * z : 0);
    assert_true(ahead > -1e-6 && ahead < half_speed * dt + 1e-6 && off2 < 0.2501 * d * d);
    assert_near(all[i].v[0], sign * half_speed, 1e-6, "the velocity along");
    assert_near(all[i].v[1], 0.2 * half_speed * y / (0.5 * d), 1e-5, "the velocity across");
    way += ahead;
    across2 += off2;
    farthest = fmax(farthest, off2);
  }
  /* Even along the way, and over the disc (3D) or the line (2D): mean squares of 1/2 and 1/3. */
  assert_near(way / count, 0.5 * half_speed * dt, 0.02 * half_speed * dt, "the mean way");
  assert_near(across2 / count / (0.25 * d * d), dimension == 3 ? 0.5 : 1 / 3.0, 0.01,
              "the mean square across");
  assert_true(farthest > 0.24 * d * d);
  pbf_destroy(s);
}

static void they_begin_in_the_cylinder(void **state) {
  (void)state;
  test_for_each_kind(check_places);
}

/* To the step, whatever it rounds. */
static void check_lifetime(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = box_of(dimension, precision, 0, 4);
  pbf_params params = params_of(0, 4);
  params.time_step = 0.001;
  assert_ok(pbf_set_params(s, &params));
  const pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_SPRAY);
  assert_ok(pbf_set_diffuse(s, &desc));
  assert_ok(pbf_step(s, 7));
  for (int life = 1; life <= 30; ++life)
    add_one(s, dimension, precision, start, (double[3]){0, 0, 0}, life * 0.001);
  one all[30];
  for (int step = 1; step <= 30; ++step) {
    assert_ok(pbf_step(s, 1));
    const uint32_t count = read_all(s, all, 30);
    assert_int_equal(count, 30 - step);
    assert_int_equal(info_of(s).expired, step);
    for (uint32_t i = 0; i < count; ++i) {
      assert_near(all[i].age, step * 0.001, 1e-9, "an age");
      assert_near(all[i].life, (1 + i) * 0.001, 1e-8, "a life");
      assert_int_equal(all[i].id, step + i);
    }
  }
  pbf_destroy(s);
}

static void lifetimes_are_exact(void **state) {
  (void)state;
  test_for_each_kind(check_lifetime);
}

/* Never more than the capacity; the oldest make way. */
static void check_budget(uint32_t dimension, uint32_t precision) {
  static one all[500];
  pbf_solver *s = box_of(dimension, precision, 2, 4);
  pbf_diffuse_desc desc = desc_of(s);
  add_block(s, dimension, precision, (double[3]){2, 2 - 2.5 * d, 2}, (int[3]){13, 5, 9}, colliding);
  add_block(s, dimension, precision, (double[3]){2, 2 + 3.2 * d, 2}, (int[3]){6, 6, 6}, colliding);
  desc.energy_min = 0.1;
  desc.capacity = 97;
  desc.trapped_air_rate *= 20;
  desc.lifetime_min = 3 * dt;
  desc.lifetime_max = 9 * dt;
  assert_ok(pbf_set_diffuse(s, &desc));
  for (int step = 0; step < 20; ++step) {
    assert_ok(pbf_step(s, 1));
    const pbf_diffuse_info info = info_of(s);
    assert_true(info.capacity == 97 && info.count <= 97);
    assert_int_equal(info.generated, info.count + info.expired + info.recycled);
    const uint32_t count = read_all(s, all, 97);
    for (uint32_t i = 1; i < count; ++i) assert_true(all[i].id > all[i - 1].id);
    if (count == 97) assert_int_equal(all[96].id, info.generated - 1);
  }
  const pbf_diffuse_info before = info_of(s);
  assert_true(before.recycled > 97);
  desc.capacity = 10; /* the youngest ten stay */
  assert_true(read_all(s, all, 97) > 10);
  const uint64_t youngest = all[before.count - 1].id;
  assert_ok(pbf_set_diffuse(s, &desc));
  assert_int_equal(read_all(s, all, 10), 10);
  assert_int_equal(all[9].id, youngest);
  assert_int_equal(info_of(s).recycled, before.recycled + before.count - 10);
  const uint64_t fourth = all[3].id; /* three more take the place of those before it */
  for (int i = 0; i < 3; ++i) add_one(s, dimension, precision, start, throw, 1);
  assert_int_equal(read_all(s, all, 10), 10);
  assert_int_equal(all[0].id, fourth);
  assert_ok(pbf_set_diffuse(s, NULL));
  assert_int_equal(info_of(s).capacity, 0);
  pbf_destroy(s);
}

static void there_are_never_more_than_the_capacity(void **state) {
  (void)state;
  test_for_long_kinds(check_budget);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_rate_is_that_of_what_comes_together),
      cmocka_unit_test(quiet_and_rigid_fluid_makes_none),
      cmocka_unit_test(births_are_those_of_the_potentials),
      cmocka_unit_test(they_begin_in_the_cylinder),
      cmocka_unit_test(lifetimes_are_exact),
      cmocka_unit_test(there_are_never_more_than_the_capacity),
  };
  return TEST_RUN(tests);
}
