/* Room inside deep water, in steps of 1/60 s: below the roof of a cave, behind pegs, in the middle
 * of an eddy. A pressure grid carries most of the weight, and has to bring water in there: pairs
 * have nothing left to push it with. */
#include <math.h>

#include "support.h"

static const double d = 0.05, gravity = 9.81;

enum { DEEP = 6 }; /* in 3D, in spacings */

typedef int (*shape_fn)(double x, double y); /* in spacings: whether fluid begins there */

typedef struct water {
  pbf_solver *solver;
  uint32_t dimension, precision, count;
  double *x, *v; /* read back */
} water;

static uint32_t fill(const water *w, const uint32_t size[2], shape_fn has_fluid, void *x) {
  const uint32_t deep = w->dimension == 3 ? DEEP : 1;
  uint32_t count = 0;
  for (uint32_t i = 0; i < size[0] * size[1] * deep; ++i) {
    const double at[3] = {i % size[0] + 0.5, i / size[0] % size[1] + 0.5,
                          i / size[0] / size[1] + 0.5};
    if (!has_fluid(at[0], at[1])) continue;
    for (uint32_t k = 0; k < w->dimension; ++k)
      test_put(x, (uint64_t)count * w->dimension + k, w->precision, d * at[k]);
    ++count;
  }
  return count;
}

/* A tank so many spacings wide, with room for twice as many layers. */
static water begin(uint32_t dimension, uint32_t precision, uint32_t wide, uint32_t layers,
                   shape_fn has_fluid) {
  water w = {.dimension = dimension, .precision = precision};
  const uint32_t size[2] = {wide, layers}, most = wide * layers * (dimension == 3 ? DEEP : 1);
  const pbf_desc desc = test_desc(dimension, precision, most);
  pbf_params params = test_params();
  params.time_step = 1.0 / 60;
  for (int k = 0; k < 3; ++k) params.domain_min[k] = 0;
  params.domain_max[0] = wide * d;
  params.domain_max[1] = 2 * layers * d;
  params.domain_max[2] = DEEP * d;
  void *x = calloc(3 * (size_t)most, precision);
  w.x = calloc(3 * (size_t)most, sizeof *w.x);
  w.v = calloc(3 * (size_t)most, sizeof *w.v);
  assert_true(x && w.x && w.v);
  w.solver = test_create(&desc, &params);
  w.count = fill(&w, size, has_fluid, x);
  assert_ok(pbf_add_particles(w.solver, w.count, x, NULL, NULL));
  free(x);
  return w;
}

static void end(water *w) {
  pbf_destroy(w->solver);
  free(w->x);
  free(w->v);
}

static void go_on(water *w, uint32_t steps) {
  assert_ok(pbf_step(w->solver, steps));
  test_read(w->solver, w->dimension, w->precision, w->count, w->x, w->v);
}

static double height_of(const water *w, uint32_t i) { return w->x[i * w->dimension + 1] / d; }

/* ---- A cave below a lake --------------------------------------------------------------------- */

enum { CAVE = 8, LAKE = 16, LAKE_TOP = 24, CAVE_WIDE = 40, SHAFT = 18, SHAFT_END = 22 };

static int lake_shaft_and_cave(double x, double y) {
  return y < CAVE || y > LAKE || (x > SHAFT && x < SHAFT_END);
}

static pbf_collider rock(double from, double to) {
  pbf_collider box;
  assert_ok(pbf_collider_init(&box, sizeof box, PBF_COLLIDER_BOX));
  box.position[0] = d * (from + to) / 2;
  box.position[1] = d * (CAVE + LAKE) / 2;
  box.half_extents[0] = d * (to - from) / 2;
  box.half_extents[1] = d * (LAKE - CAVE) / 2;
  box.half_extents[2] = 2 * DEEP * d;
  return box;
}

/* It stays full: what is not in it would stand in the lake. */
static void check_cave(uint32_t dimension, uint32_t precision) {
  water w = begin(dimension, precision, CAVE_WIDE, LAKE_TOP, lake_shaft_and_cave);
  const pbf_collider rocks[2] = {rock(-2, SHAFT), rock(SHAFT_END, CAVE_WIDE + 2)};
  uint32_t above = 0;
  assert_ok(pbf_set_colliders(w.solver, 2, rocks));
  go_on(&w, 420);
  for (uint32_t i = 0; i < w.count; ++i) above += height_of(&w, i) > LAKE;
  const double level = (double)above / (CAVE_WIDE * (dimension == 3 ? DEEP : 1));
  if (!(fabs(level - (LAKE_TOP - LAKE)) < 0.2))
    fail_msg("%uD: the lake is %g layers deep, not %d", dimension, level, LAKE_TOP - LAKE);
  end(&w);
}

static void caves_stay_full(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_cave);
}

/* ---- Pegs ------------------------------------------------------------------------------------ */

enum { PEG_LAYERS = 35, PEG_ROWS = 3, PEGS = 5, PEG_WIDE = 22 };

static const double peg_radius = 1.6, peg_apart = 4.4;

static void place_of_peg(int row, int k, double *x, double *y) {
  *x = peg_apart * (k + (row % 2 ? 1 : 0.5));
  *y = 8.0 * (row + 1);
}

static int beside_pegs(double x, double y) {
  for (int n = 0; n < PEG_ROWS * PEGS; ++n) {
    double px, py;
    place_of_peg(n / PEGS, n % PEGS, &px, &py);
    if (hypot(x - px, y - py) < peg_radius + 0.4) return 0;
  }
  return 1;
}

/* Upright across the tank in 3D; discs in 2D. */
static void set_pegs(const water *w) {
  pbf_collider pegs[PEG_ROWS * PEGS];
  for (int n = 0; n < PEG_ROWS * PEGS; ++n) {
    double px, py;
    place_of_peg(n / PEGS, n % PEGS, &px, &py);
    assert_ok(pbf_collider_init(&pegs[n], sizeof pegs[n],
                                w->dimension == 3 ? PBF_COLLIDER_CAPSULE : PBF_COLLIDER_SPHERE));
    pegs[n].position[0] = px * d;
    pegs[n].position[1] = py * d;
    pegs[n].position[2] = w->dimension == 3 ? DEEP * d / 2 : 0;
    pegs[n].axis[0] = pegs[n].axis[1] = 0;
    pegs[n].axis[2] = 1;
    pegs[n].radius = peg_radius * d;
    pegs[n].half_length = DEEP * d;
  }
  assert_ok(pbf_set_colliders(w->solver, PEG_ROWS * PEGS, pegs));
}

/* The centre of mass of so much fluid that stands still between them; of half of the outermost pegs
 * of every second row the tank has none. */
static double centre_beside_pegs(double area) {
  const double pi = 3.14159265358979323846, peg = pi * peg_radius * peg_radius;
  double taken = 0, moment = 0;
  for (int n = 0; n < PEG_ROWS * PEGS; ++n) {
    double px, py;
    place_of_peg(n / PEGS, n % PEGS, &px, &py);
    const double part = px > PEG_WIDE - 0.1 ? 0.5 : 1;
    taken += part * peg;
    moment += part * peg * py;
  }
  const double level = (area + taken) / PEG_WIDE;
  return (PEG_WIDE * level * level / 2 - moment) / area;
}

static void check_pegs(uint32_t dimension, uint32_t precision) {
  water w = begin(dimension, precision, PEG_WIDE, PEG_LAYERS, beside_pegs);
  double centre = 0;
  set_pegs(&w);
  go_on(&w, 360);
  for (uint32_t i = 0; i < w.count; ++i) centre += height_of(&w, i) / w.count;
  const double right = centre_beside_pegs((double)w.count / (dimension == 3 ? DEEP : 1));
  if (!(fabs(centre / right - 1) < 0.025))
    fail_msg("%uD: the centre of mass is at %g of its height", dimension, centre / right);
  end(&w);
}

static void pegs_lift_nothing(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_pegs);
}

/* ---- An eddy --------------------------------------------------------------------------------- */

enum { EDDY_WIDE = 40, EDDY_LAYERS = 20, RIM = 4 }; /* spacings from its middle: 1 m/s there */

static int everywhere(double x, double y) {
  (void)x;
  (void)y;
  return 1;
}

static double energy(const water *w) {
  double sum = 0;
  for (uint32_t i = 0; i < w->count; ++i) {
    sum += gravity * height_of(w, i) * d;
    for (uint32_t k = 0; k < w->dimension; ++k)
      sum += 0.5 * w->v[i * w->dimension + k] * w->v[i * w->dimension + k];
  }
  return sum;
}

static void set_eddy(water *w) {
  void *v = calloc((size_t)w->count * w->dimension, w->precision);
  assert_non_null(v);
  for (uint32_t i = 0; i < w->count; ++i) {
    const double x = w->x[i * w->dimension] / d - 0.5 * EDDY_WIDE,
                 y = height_of(w, i) - 0.5 * EDDY_LAYERS;
    if (!(hypot(x, y) < RIM)) continue;
    w->v[i * w->dimension] = -y / RIM;
    w->v[i * w->dimension + 1] = x / RIM;
  }
  for (uint32_t i = 0; i < w->count * w->dimension; ++i) test_put(v, i, w->precision, w->v[i]);
  assert_ok(pbf_set_velocities(w->solver, 0, w->count, v));
  free(v);
}

/* Water has no more energy than it was given; three times that is what limits.md tells of. */
static void check_eddy(uint32_t dimension, uint32_t precision) {
  water w = begin(dimension, precision, EDDY_WIDE, EDDY_LAYERS, everywhere);
  go_on(&w, 120);
  const double before = energy(&w);
  set_eddy(&w);
  const double given = energy(&w) - before;
  for (int look = 0; look < 12; ++look) {
    go_on(&w, 5);
    const double now = (energy(&w) - before) / given;
    if (!(now < 3)) fail_msg("%uD: %g times the energy of the eddy", dimension, now);
  }
  end(&w);
}

static void eddies_stay_full(void **state) {
  (void)state;
  test_skip_if_watched();
  test_for_long_kinds(check_eddy);
}

/* The stub solves nothing. */
int main(void) {
  if (test_is_stub()) return TEST_SKIPPED;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(caves_stay_full),
      cmocka_unit_test(pegs_lift_nothing),
      cmocka_unit_test(eddies_stay_full),
  };
  return TEST_RUN(tests);
}
