/* Spray, foam and bubbles against closed forms, and what they make of the fluid against sums over
 * all pairs of its particles. */
#include <pbf/diffuse.h>
#include <pbf/query.h>

#include <float.h>
#include <stdio.h>

#include "support.h"

static const double d = 0.05; /* the spacing */
static const double dt = 1.0 / 128;

enum { CAPACITY = 4000, MANY = 100000 };

/* ---- Scenes ---------------------------------------------------------------------------------- */

static pbf_params params_of(double gravity, double upper) {
  pbf_params params = test_params();
  for (int k = 0; k < 3; ++k) {
    params.gravity[k] = 0;
    params.domain_min[k] = 0;
    params.domain_max[k] = upper;
  }
  params.gravity[1] = -gravity;
  params.time_step = dt;
  params.vorticity = params.viscosity = 0;
  return params;
}

static pbf_solver *box_of(uint32_t dimension, uint32_t precision, double gravity, double upper) {
  const pbf_desc desc = test_desc(dimension, precision, CAPACITY);
  const pbf_params params = params_of(gravity, upper);
  return test_create(&desc, &params);
}

typedef double (*field)(const double x[3], int component);

/* A lattice around a place, so many particles wide, with a velocity field. Returns how many. */
static uint32_t add_block(pbf_solver *s, uint32_t dimension, uint32_t precision,
                          const double middle[3], const int wide[3], field velocity) {
  static double x[3 * CAPACITY], v[3 * CAPACITY];
  uint32_t count = 0;
  for (int i = 0; i < wide[0]; ++i)
    for (int j = 0; j < wide[1]; ++j)
      for (int k = 0; k < (dimension == 3 ? wide[2] : 1); ++k, ++count) {
        const int at[3] = {i, j, k};
        double place[3];
        for (int c = 0; c < 3; ++c) place[c] = middle[c] + (at[c] - 0.5 * (wide[c] - 1)) * d;
        for (uint32_t c = 0; c < dimension; ++c) {
          test_put(x, (uint64_t)count * dimension + c, precision, place[c]);
          test_put(v, (uint64_t)count * dimension + c, precision,
                   velocity ? velocity(place, (int)c) : 0);
        }
      }
  assert_ok(pbf_add_particles(s, count, x, v, NULL));
  return count;
}

static pbf_diffuse_desc desc_of(pbf_solver *s) {
  pbf_diffuse_desc desc;
  assert_ok(pbf_diffuse_init(s, &desc, sizeof desc));
  desc.capacity = 20000;
  return desc;
}

/* All of one kind, and none made. */
static pbf_diffuse_desc desc_of_kind(pbf_solver *s, uint32_t kind) {
  pbf_diffuse_desc desc = desc_of(s);
  desc.trapped_air_rate = desc.wave_crest_rate = 0;
  desc.foam_neighbors = kind == PBF_DIFFUSE_SPRAY ? MANY : 0;
  desc.bubble_neighbors = kind == PBF_DIFFUSE_BUBBLE ? 0 : MANY;
  return desc;
}

static void add_one(pbf_solver *s, uint32_t dimension, uint32_t precision, const double x[3],
                    const double v[3], double life) {
  double raw[7];
  double velocity[3], lives[1];
  for (uint32_t k = 0; k < dimension; ++k) {
    test_put(raw, k, precision, x[k]);
    test_put(velocity, k, precision, v[k]);
  }
  test_put(lives, 0, precision, life);
  assert_ok(pbf_add_diffuse(s, 1, raw, velocity, lives));
}

static pbf_diffuse_info info_of(pbf_solver *s) {
  pbf_diffuse_info info = {.struct_size = sizeof info};
  assert_ok(pbf_get_diffuse_info(s, &info));
  return info;
}

/* As float64 with three numbers, whatever the solver has. */
typedef struct one {
  double x[3], v[3], age, life;
  uint32_t kind, reserved;
  uint64_t id;
} one;

static uint32_t read_all(pbf_solver *s, one *to, uint32_t room) {
  const uint32_t count = info_of(s).count;
  assert_true(count <= room);
  memset(to, 0, room * sizeof *to);
  const pbf_diffuse_read read = {.struct_size = sizeof read,
                                 .count = count,
                                 .element_type = PBF_TYPE_FLOAT64,
                                 .components = 3,
                                 .stride = sizeof *to,
                                 .positions = to->x,
                                 .velocities = to->v,
                                 .ages = &to->age,
                                 .lives = &to->life,
                                 .kinds = &to->kind,
                                 .ids = &to->id};
  assert_ok(pbf_read_diffuse(s, &read));
  return count;
}

static one read_one(pbf_solver *s) {
  one only;
  assert_int_equal(read_all(s, &only, 1), 1);
  return only;
}

static void assert_near(double found, double right, double most, const char *what) {
  if (!(fabs(found - right) <= most))
    fail_msg("%s is %.12g, not %.12g: off by %.3g", what, found, right, found - right);
}

static double rounding_of(uint32_t precision) {
  return precision == PBF_FLOAT32 ? FLT_EPSILON : DBL_EPSILON;
}

/* ---- Motion ---------------------------------------------------------------------------------- */

static const double start[3] = {1.3, 1.7, 1.1}, throw[3] = {0.5, 2.5, -0.25};

/* The parabola, and with drag what it tends to. */
static void check_spray(uint32_t dimension, uint32_t precision) {
  const double drags[] = {0, 0.0625, 3};
  const double g[3] = {0.5, -8, 0.25};
  for (int i = 0; i < 3; ++i) {
    pbf_solver *s = box_of(dimension, precision, 0, 4);
    pbf_params params = params_of(0, 4);
    memcpy(params.gravity, g, sizeof g);
    assert_ok(pbf_set_params(s, &params));
    pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_SPRAY);
    desc.spray_drag = drags[i];
    assert_ok(pbf_set_diffuse(s, &desc));
    const double x0[3] = {1.25, 1.75, 1.125};
    add_one(s, dimension, precision, x0, throw, 100);
    assert_ok(pbf_step(s, 64));
    const one p = read_one(s);
    const double t = 64 * dt, k = drags[i], e = exp(-k * t);
    assert_int_equal(p.kind, PBF_DIFFUSE_SPRAY);
    for (uint32_t c = 0; c < dimension; ++c) {
      const double end = k > 0 ? g[c] / k : 0;
      const double v = k > 0 ? end + (throw[c] - end) * e : throw[c] + g[c] * t;
      const double x = k > 0 ? x0[c] + end * t + (throw[c] - end) * (1 - e) / k
                             : x0[c] + throw[c] * t + 0.5 * g[c] * t * t;
      assert_near(p.x[c], x, 1e-11, "a place");
      assert_near(p.v[c], v, 1e-11, "a velocity");
    }
    pbf_destroy(s);
  }
}

static void spray_flies_ballistically(void **state) {
  (void)state;
  test_for_each_kind(check_spray);
}

/* A basin in which each particle is held against gravity: fluid at rest to the last bit. */
static pbf_solver *held_basin(uint32_t dimension, uint32_t precision, double gravity) {
  static double a[3 * CAPACITY];
  pbf_solver *s = box_of(dimension, precision, gravity, 3);
  const uint32_t count =
      add_block(s, dimension, precision, (double[3]){1.5, 1.5, 1.5}, (int[3]){9, 40, 9}, NULL);
  for (uint32_t i = 0; i < count * dimension; ++i)
    test_put(a, i, precision, i % dimension == 1 ? gravity : 0);
  assert_ok(pbf_set_accelerations(s, 0, count, a));
  return s;
}

/* Rises at buoyancy g / drag in the end, by the exponential on the way. */
static void check_bubble(uint32_t dimension, uint32_t precision) {
  const double g = 8, buoyancy = 1.5, drag = 20;
  pbf_solver *s = held_basin(dimension, precision, g);
  pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_BUBBLE);
  desc.buoyancy = buoyancy;
  desc.bubble_drag = drag;
  assert_ok(pbf_set_diffuse(s, &desc));
  const double x0[3] = {1.5, 0.75, 1.5};
  add_one(s, dimension, precision, x0, (double[3]){0, 0, 0}, 100);
  const double end = buoyancy * g / drag;
  for (int steps = 16; steps <= 128; steps += 16) {
    assert_ok(pbf_step(s, 16));
    const one p = read_one(s);
    const double t = steps * dt, e = exp(-drag * t);
    assert_int_equal(p.kind, PBF_DIFFUSE_BUBBLE);
    assert_near(p.v[1], end * (1 - e), 1e-9 + 64 * rounding_of(precision), "its speed");
    assert_near(p.x[1], x0[1] + end * (t - (1 - e) / drag), 1e-9 + 64 * rounding_of(precision),
                "its height");
    assert_near(p.x[0], 1.5, 1e-9 + 64 * rounding_of(precision), "its place");
  }
  assert_near(read_one(s).v[1], 0.6, 1e-8 + 64 * rounding_of(precision), "its speed in the end");
  pbf_destroy(s);
}

static void bubbles_rise_to_their_speed(void **state) {
  (void)state;
  test_for_each_kind(check_bubble);
}

/* A bubble without drag has the acceleration of buoyancy alone. */
static void check_free_bubble(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = held_basin(dimension, precision, 1);
  pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_BUBBLE);
  desc.buoyancy = 2;
  desc.bubble_drag = 0;
  assert_ok(pbf_set_diffuse(s, &desc));
  add_one(s, dimension, precision, (double[3]){1.5, 0.75, 1.5}, (double[3]){0, 0, 0}, 100);
  assert_ok(pbf_step(s, 32));
  const one p = read_one(s);
  assert_near(p.v[1], 2 * 32 * dt, 1e-12, "its speed");
  assert_near(p.x[1], 0.75 + pow(32 * dt, 2), 1e-12, "its height");
  pbf_destroy(s);
}

static void bubbles_without_drag_fall_upwards(void **state) {
  (void)state;
  test_for_each_kind(check_free_bubble);
}

static double still(const double x[3], int component) { return 0 * x[component]; }
static double shifting(const double x[3], int component) {
  return 0 * x[component] + (component == 0 ? 1.25 : component == 1 ? -0.5 : 0.25);
}

/* On fluid that goes all alike it goes as the fluid does, on fluid at rest it stays. */
static void check_foam(uint32_t dimension, uint32_t precision) {
  for (int moving = 0; moving < 2; ++moving) {
    pbf_solver *s = box_of(dimension, precision, 0, 4);
    add_block(s, dimension, precision, (double[3]){2, 2, 2}, (int[3]){9, 9, 9},
              moving ? shifting : still);
    const pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_FOAM);
    assert_ok(pbf_set_diffuse(s, &desc));
    const double x0[3] = {2.03, 2 + 4.4 * d, 1.98};
    add_one(s, dimension, precision, x0, throw, 100);
    assert_ok(pbf_step(s, 40));
    const one p = read_one(s);
    assert_int_equal(p.kind, PBF_DIFFUSE_FOAM);
    for (uint32_t k = 0; k < dimension; ++k) {
      const double v = moving ? shifting(x0, (int)k) : 0;
      assert_near(p.x[k], test_value(&(float){(float)x0[k]}, 0, PBF_FLOAT32) + v * 40 * dt, 2e-5,
                  "a place");
      assert_near(p.v[k], v, 2e-5, "a velocity");
    }
    pbf_destroy(s);
  }
}

static void foam_goes_with_the_fluid(void **state) {
  (void)state;
  test_for_each_kind(check_foam);
}

static const double omega = 2.5;
static double turning(const double x[3], int component) {
  return component == 0 ? -omega * (x[1] - 2) : component == 1 ? omega * (x[0] - 2) : 0;
}

/* A block that is turned about (2, 2), and goes round. */
static void set_turned(pbf_solver *s, uint32_t dimension, uint32_t precision, uint32_t count,
                       const double *x0, double angle) {
  static double x[3 * CAPACITY], v[3 * CAPACITY];
  for (uint32_t i = 0; i < count; ++i) {
    const double *from = &x0[i * dimension], a = from[0] - 2, b = from[1] - 2;
    double at[3] = {2 + cos(angle) * a - sin(angle) * b, 2 + sin(angle) * a + cos(angle) * b, 2};
    if (dimension == 3) at[2] = from[2];
    for (uint32_t k = 0; k < dimension; ++k) {
      test_put(x, (uint64_t)i * dimension + k, precision, at[k]);
      test_put(v, (uint64_t)i * dimension + k, precision, turning(at, (int)k));
    }
  }
  assert_ok(pbf_set_positions(s, 0, count, x));
  assert_ok(pbf_set_velocities(s, 0, count, v));
}

/* Fluid that is set to turn before each step, and goes straight in it: its velocity is then A x,
 * and foam is carried by I + dt A + dt² A² / 2, be it outside of all particles or between them. */
static void check_turning_foam(uint32_t dimension, uint32_t precision) {
  static double x0[3 * CAPACITY], v0[3 * CAPACITY];
  pbf_solver *s = box_of(dimension, precision, 0, 4);
  const uint32_t count =
      add_block(s, dimension, precision, (double[3]){2, 2, 2}, (int[3]){13, 13, 7}, turning);
  const pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_FOAM);
  assert_ok(pbf_set_diffuse(s, &desc));
  const double from[2] = {4 * d, -6.4 * d};
  double a[2] = {from[0], from[1]};
  add_one(s, dimension, precision, (double[3]){2 + from[0], 2 + from[1], 2}, throw, 100);
  test_read(s, dimension, precision, count, x0, v0);
  const double scale = omega / (1 + omega * omega * dt * dt);
  for (int step = 0; step < 48; ++step) {
    set_turned(s, dimension, precision, count, x0, omega * step * dt);
    assert_ok(pbf_step(s, 1));
    const double u[2] = {scale * (omega * dt * a[0] - a[1]), scale * (a[0] + omega * dt * a[1])};
    const double w[2] = {scale * (omega * dt * u[0] - u[1]), scale * (u[0] + omega * dt * u[1])};
    for (int k = 0; k < 2; ++k) a[k] += dt * u[k] + 0.5 * dt * dt * w[k];
  }
  const one p = read_one(s);
  for (int k = 0; k < 2; ++k) assert_near(p.x[k], 2 + a[k], 3e-5, "a place");
  /* The angle by which it has gone round: what turns it turns as the fluid. */
  const double turned = atan2(p.x[1] - 2, p.x[0] - 2) - atan2(from[1], from[0]);
  assert_near(turned, omega * 48 * dt, 2e-3, "its angle");
  pbf_destroy(s);
}

static void foam_turns_with_the_fluid(void **state) {
  (void)state;
  test_for_each_kind(check_turning_foam);
}

/* By how many particles are within h: one alone, a lattice's corner, its inside. */
static void check_kinds(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = box_of(dimension, precision, 0, 4);
  add_block(s, dimension, precision, (double[3]){2, 2, 2}, (int[3]){9, 9, 9}, NULL);
  pbf_diffuse_desc desc = desc_of(s);
  assert_int_equal(desc.foam_neighbors, dimension == 3 ? 7 : 3);
  assert_int_equal(desc.bubble_neighbors, dimension == 3 ? 21 : 8);
  desc.trapped_air_rate = desc.wave_crest_rate = desc.buoyancy = 0;
  assert_ok(pbf_set_diffuse(s, &desc));
  one all[3];
  const double places[3][3] = {{2, 2, 2}, {2.01, 2 + 4.1 * d, 2.01}, {2, 2 + 5.8 * d, 2}};
  for (int i = 0; i < 3; ++i)
    add_one(s, dimension, precision, places[i], (double[3]){0, 0, 0}, 100);
  assert_ok(pbf_step(s, 1));
  assert_int_equal(read_all(s, all, 3), 3);
  assert_int_equal(all[0].kind, PBF_DIFFUSE_BUBBLE);
  assert_int_equal(all[1].kind, PBF_DIFFUSE_FOAM);
  assert_int_equal(all[2].kind, PBF_DIFFUSE_SPRAY);
  const pbf_diffuse_info info = info_of(s);
  assert_true(info.bubbles == 1 && info.foam == 1 && info.spray == 1 && info.count == 3);
  pbf_destroy(s);
}

static void kinds_go_by_neighbours(void **state) {
  (void)state;
  test_for_each_kind(check_kinds);
}

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

/* ---- Solids ---------------------------------------------------------------------------------- */

static pbf_collider collider_of(uint32_t shape, int inverted) {
  pbf_collider c;
  assert_ok(pbf_collider_init(&c, sizeof c, shape));
  for (int k = 0; k < 3; ++k) c.position[k] = 2;
  c.inverted = (uint32_t)inverted;
  c.radius = 0.5;
  c.half_length = 0.25;
  c.axis[0] = 0, c.axis[1] = 1, c.axis[2] = 0;
  c.half_extents[0] = 0.5, c.half_extents[1] = 0.25, c.half_extents[2] = 0.5;
  return c;
}

/* From `from` out to `to`, without the velocity (1, 1, 0) that leads in. */
typedef struct push {
  uint32_t shape;
  int inverted;
  double from[2], to[2], v[2];
} push;

static void check_pushes(uint32_t dimension, uint32_t precision) {
  static const push pushes[] = {
      {PBF_COLLIDER_SPHERE, 0, {-0.25, 0}, {-0.5, 0}, {0, 1}},
      {PBF_COLLIDER_SPHERE, 0, {0, -0.375}, {0, -0.5}, {1, 0}},
      {PBF_COLLIDER_SPHERE, 0, {0, 0.375}, {0, 0.5}, {1, 1}},
      {PBF_COLLIDER_SPHERE, 0, {0, 0.625}, {0, 0.625}, {1, 1}},
      {PBF_COLLIDER_SPHERE, 1, {0, 0.75}, {0, 0.5}, {1, 0}},
      {PBF_COLLIDER_BOX, 0, {0.25, -0.1875}, {0.25, -0.25}, {1, 0}},
      {PBF_COLLIDER_BOX, 0, {-0.4375, 0.125}, {-0.5, 0.125}, {0, 1}},
      {PBF_COLLIDER_BOX, 1, {0.75, 0.125}, {0.5, 0.125}, {0, 1}},
      {PBF_COLLIDER_CAPSULE, 0, {-0.25, 0.125}, {-0.5, 0.125}, {0, 1}},
      {PBF_COLLIDER_CAPSULE, 0, {0, -0.5}, {0, -0.75}, {1, 0}},
      {PBF_COLLIDER_PLANE, 0, {0.25, -0.5}, {0.25, 0}, {1, 1}},
      {PBF_COLLIDER_PLANE, 1, {0.25, 0.5}, {0.25, 0}, {1, 0}},
  };
  for (size_t i = 0; i < sizeof pushes / sizeof pushes[0]; ++i) {
    pbf_solver *s = box_of(dimension, precision, 0, 4);
    const pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_SPRAY);
    const pbf_collider c = collider_of(pushes[i].shape, pushes[i].inverted);
    assert_ok(pbf_set_colliders(s, 1, &c));
    assert_ok(pbf_set_diffuse(s, &desc));
    const double v[3] = {1, 1, 0};
    double x[3] = {2, 2, 2};
    for (int k = 0; k < 2; ++k) x[k] += pushes[i].from[k] - dt * v[k];
    add_one(s, dimension, precision, x, v, 100);
    assert_ok(pbf_step(s, 1));
    const one p = read_one(s);
    for (int k = 0; k < 2; ++k) {
      if (!(fabs(p.x[k] - 2 - pushes[i].to[k]) < 1e-6)) fail_msg("%zu: at %.9g", i, p.x[k] - 2);
      if (!(fabs(p.v[k] - pushes[i].v[k]) < 1e-6)) fail_msg("%zu: goes by %.9g", i, p.v[k]);
    }
    pbf_destroy(s);
  }
}

static void colliders_push_them_out(void **state) {
  (void)state;
  test_for_long_kinds(check_pushes);
}

/* What moves takes along what is before it, as a wall does; a turned box is out by its own frame.
 */
static void check_moving(uint32_t dimension, uint32_t precision) {
  pbf_solver *s = box_of(dimension, precision, 0, 4);
  const pbf_diffuse_desc desc = desc_of_kind(s, PBF_DIFFUSE_SPRAY);
  pbf_collider c[2] = {collider_of(PBF_COLLIDER_BOX, 0), collider_of(PBF_COLLIDER_BOX, 0)};
  one all[3];
  c[0].velocity[0] = 2;
  c[1].position[1] = 3;
  c[1].orientation[2] = c[1].orientation[3] = sqrt(0.5); /* a quarter turn: 0.25 wide now */
  pbf_params params = params_of(0, 4);
  params.wall_velocity[PBF_WALL_X_MIN] = 1;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_set_colliders(s, 2, c));
  assert_ok(pbf_set_diffuse(s, &desc));
  add_one(s, dimension, precision, (double[3]){2.5, 2, 2}, (double[3]){0, 0.5, 0}, 100);
  add_one(s, dimension, precision, (double[3]){0.0, 2, 2}, (double[3]){-3, 0.5, 0}, 100);
  add_one(s, dimension, precision, (double[3]){2.125, 3.0, 2}, (double[3]){0, 0, 0}, 100);
  assert_ok(pbf_step(s, 32));
  assert_int_equal(read_all(s, all, 3), 3);
  assert_near(all[0].x[0], 2.5 + 2 * 32 * dt, 1e-9, "the place before the box");
  assert_near(all[0].v[0], 2, 1e-9, "its velocity");
  assert_near(all[0].v[1], 0.5, 1e-9, "its velocity along");
  assert_near(all[1].x[0], 32 * dt, 1e-9, "the place at the wall");
  assert_near(all[1].v[0], 1, 1e-9, "its velocity there");
  assert_near(all[2].x[0], 2.25, 1e-9, "the place beside the turned box");
  pbf_destroy(s);
}

static void what_moves_takes_them_along(void **state) {
  (void)state;
  test_for_each_kind(check_moving);
}

/* Through one face and in at the other; fluid beyond a face is near. */
static void check_periodic(uint32_t dimension, uint32_t precision) {
  const pbf_desc desc_here = test_desc(dimension, precision, CAPACITY);
  pbf_params params = params_of(0, 2);
  params.periodic = PBF_PERIODIC_X;
  pbf_solver *s = test_create(&desc_here, &params);
  add_block(s, dimension, precision, (double[3]){0.5 * d, 1, 1}, (int[3]){1, 5, 5}, NULL);
  add_block(s, dimension, precision, (double[3]){2 - 0.5 * d, 1, 1}, (int[3]){1, 5, 5}, NULL);
  pbf_diffuse_desc desc = desc_of(s);
  desc.trapped_air_rate = desc.wave_crest_rate = desc.buoyancy = 0;
  desc.foam_neighbors = 1;
  desc.bubble_neighbors = dimension == 3 ? 12 : 4; /* one side alone has fewer */
  assert_ok(pbf_set_diffuse(s, &desc));
  one all[2];
  add_one(s, dimension, precision, (double[3]){1.75, 0.5, 1}, (double[3]){2, 0, 0}, 100);
  add_one(s, dimension, precision, (double[3]){0, 1, 1}, (double[3]){0, 0, 0}, 100);
  assert_ok(pbf_step(s, 32));
  assert_int_equal(read_all(s, all, 2), 2);
  assert_near(all[0].x[0], 0.25, 1e-9, "its place");
  assert_int_equal(all[1].kind, PBF_DIFFUSE_BUBBLE);
  pbf_destroy(s);
}

static void periodic_axes_lead_to_the_other_side(void **state) {
  (void)state;
  test_for_each_kind(check_periodic);
}

/* ---- The same bits --------------------------------------------------------------------------- */

static pbf_solver *splash(uint32_t dimension, uint32_t precision, int is_on) {
  pbf_solver *s = box_of(dimension, precision, 9.81, 1.5);
  add_block(s, dimension, precision, (double[3]){0.4, 0.4, 0.4}, (int[3]){12, 14, 12}, NULL);
  pbf_diffuse_desc desc = desc_of(s);
  desc.energy_min = 0.05;
  desc.capacity = 300;
  desc.seed = 7;
  if (is_on) assert_ok(pbf_set_diffuse(s, &desc));
  return s;
}

static void assert_alike(pbf_solver *a, pbf_solver *b) {
  static one all[2][300];
  const uint32_t count = read_all(a, all[0], 300);
  assert_int_equal(read_all(b, all[1], 300), count);
  assert_memory_equal(all[0], all[1], sizeof all[0]);
  const pbf_diffuse_info left = info_of(a), right = info_of(b);
  assert_memory_equal(&left, &right, sizeof left);
}

/* Steps in one call and in many, a save and a load between them: not a bit is another one, of them
 * or of the fluid, which is that of a solver without. */
static void check_bits(uint32_t dimension, uint32_t precision) {
  pbf_solver *at_once = splash(dimension, precision, 1),
             *in_parts = splash(dimension, precision, 1);
  pbf_solver *without = splash(dimension, precision, 0), *loaded = splash(dimension, precision, 0);
  uint64_t size;
  assert_ok(pbf_step(at_once, 90));
  assert_ok(pbf_step(without, 90));
  for (int i = 0; i < 60; ++i) assert_ok(pbf_step(in_parts, 1));
  void *saved = test_save(in_parts, &size);
  assert_ok(pbf_step(in_parts, 13));
  assert_ok(pbf_begin_step(in_parts, 17));
  assert_ok(pbf_end_step(in_parts));
  assert_ok(pbf_load(loaded, saved, size));
  assert_ok(pbf_step(loaded, 30));
  const pbf_diffuse_info info = info_of(at_once);
  /* There is something to compare; the stub's particles do not meet. */
  assert_true(test_is_stub() || (info.recycled > 100 && info.count == 300));
  assert_alike(at_once, in_parts);
  assert_alike(at_once, loaded);
  assert_int_equal(test_hash(at_once), test_hash(without));
  assert_int_equal(test_hash(loaded), test_hash(without));
  free(saved);
  pbf_destroy(at_once);
  pbf_destroy(in_parts);
  pbf_destroy(without);
  pbf_destroy(loaded);
}

static void bits_do_not_depend_on_calls(void **state) {
  (void)state;
  test_for_long_kinds(check_bits);
}

/* Every fourth step has a quarter of the looks, and goes by the time that has passed. */
static void check_interval(uint32_t dimension, uint32_t precision) {
  pbf_solver *s[2];
  for (int i = 0; i < 2; ++i) {
    s[i] = splash(dimension, precision, 1);
    pbf_diffuse_desc desc = {.struct_size = sizeof desc};
    assert_ok(pbf_get_diffuse(s[i], &desc));
    desc.interval = 4;
    assert_ok(pbf_set_diffuse(s[i], &desc));
  }
  assert_ok(pbf_step(s[0], 90));
  for (int i = 0; i < 90; i += 3) assert_ok(pbf_step(s[1], 3));
  assert_alike(s[0], s[1]);
  assert_near(info_of(s[0]).time, 88 * dt, 1e-12, "their time");
  add_one(s[0], dimension, precision, (double[3]){0.75, 1.25, 0.75}, (double[3]){0, 1, 0}, 9);
  static one all[300];
  assert_ok(pbf_step(s[0], 2)); /* to 92: one of four steps, since their time */
  const uint32_t count = read_all(s[0], all, 300);
  for (uint32_t i = 0; i < count; ++i)
    if (all[i].life > 8.5)
      assert_near(all[i].x[1], 1.25 + 4 * dt - 0.5 * 9.81 * pow(4 * dt, 2), 1e-9, "its place");
  pbf_destroy(s[0]);
  pbf_destroy(s[1]);
}

static void an_interval_goes_by_time(void **state) {
  (void)state;
  test_for_long_kinds(check_interval);
}

static void threads_change_nothing(void **state) {
  (void)state;
  pbf_solver *s[2];
  for (uint32_t i = 0; i < 2; ++i) {
    pbf_desc desc = test_desc(3, PBF_FLOAT32, CAPACITY);
    const pbf_params params = params_of(9.81, 1.5);
    desc.threads = 1 + 2 * i;
    s[i] = test_create(&desc, &params);
    add_block(s[i], 3, PBF_FLOAT32, (double[3]){0.4, 0.4, 0.4}, (int[3]){12, 14, 12}, NULL);
    pbf_diffuse_desc wanted = desc_of(s[i]);
    wanted.energy_min = 0.05;
    wanted.capacity = 300;
    assert_ok(pbf_set_diffuse(s[i], &wanted));
    assert_ok(pbf_step(s[i], 60));
  }
  assert_true(test_is_stub() || info_of(s[0]).generated > 300);
  assert_alike(s[0], s[1]);
  pbf_destroy(s[0]);
  pbf_destroy(s[1]);
}

/* ---- Memory ---------------------------------------------------------------------------------- */

/* Where an allocation fails, a step is not done, and then goes on as if it had not. */
static void no_memory_leaves_all_as_it_was(void **state) {
  (void)state;
  pbf_solver *right = splash(3, PBF_FLOAT32, 1);
  assert_ok(pbf_step(right, 40));
  for (uint64_t n = 1, failed = 1; failed; ++n) {
    pbf_solver *s = splash(3, PBF_FLOAT32, 1);
    uint64_t size, size_after;
    assert_ok(pbf_step(s, 30));
    assert_ok(pbf_end_queries(s)); /* so that a step wants memory */
    void *before = test_save(s, &size);
    test_count.failing_call = test_count.calls + n;
    const pbf_status status = pbf_step(s, 1);
    failed = test_count.calls >= test_count.failing_call;
    test_count.failing_call = 0;
    assert_int_equal(status, failed ? PBF_ERROR_OUT_OF_MEMORY : PBF_OK);
    if (failed) {
      void *after = test_save(s, &size_after);
      assert_int_equal(size_after, size);
      assert_memory_equal(before, after, size);
      free(after);
    }
    assert_true(n > 1 || failed);
    assert_ok(pbf_step(s, failed ? 10 : 9));
    assert_alike(s, right);
    free(before);
    pbf_destroy(s);
  }
  pbf_destroy(right);
  assert_int_equal(test_count.live_blocks, 0);
}

static void setting_fails_whole(void **state) {
  (void)state;
  for (uint64_t n = 1, failed = 1; failed; ++n) {
    pbf_solver *s = splash(3, PBF_FLOAT32, n % 2 == 0);
    uint64_t size, size_after;
    pbf_diffuse_desc desc = desc_of(s);
    void *before = test_save(s, &size);
    test_count.failing_call = test_count.calls + (n + 1) / 2;
    const pbf_status status = pbf_set_diffuse(s, &desc);
    failed = test_count.calls >= test_count.failing_call;
    test_count.failing_call = 0;
    assert_int_equal(status, failed ? PBF_ERROR_OUT_OF_MEMORY : PBF_OK);
    void *after = test_save(s, &size_after);
    if (failed) assert_int_equal(size_after, size);
    if (failed) assert_memory_equal(before, after, size);
    free(before);
    free(after);
    pbf_destroy(s);
  }
  assert_int_equal(test_count.live_blocks, 0);
}

/* ---- What is refused ------------------------------------------------------------------------- */

typedef struct fault {
  size_t offset;
  double value;
  const char *words;
} fault;

#define FAULT(member, value, words) \
  { offsetof(pbf_diffuse_desc, member), value, words }

static void bad_descs_are_refused(void **state) {
  (void)state;
  static const fault faults[] = {
      FAULT(trapped_air_min, NAN, "desc.trapped_air_min is"),
      FAULT(trapped_air_max, 0, "desc.trapped_air_max is 0; it must be above trapped_air_min"),
      FAULT(wave_crest_min, -1, "desc.wave_crest_min is"),
      FAULT(wave_crest_max, 0.01, "must be above wave_crest_min"),
      FAULT(energy_min, 1e30, "must be above energy_min"),
      FAULT(energy_max, INFINITY, "desc.energy_max is"),
      FAULT(trapped_air_rate, -1, "desc.trapped_air_rate is -1"),
      FAULT(wave_crest_rate, NAN, "desc.wave_crest_rate is"),
      FAULT(lifetime_min, 1e30, "must be at least lifetime_min"),
      FAULT(lifetime_max, -1, "desc.lifetime_max is -1"),
      FAULT(buoyancy, -0.5, "desc.buoyancy is -0.5"),
      FAULT(bubble_drag, NAN, "desc.bubble_drag is"),
      FAULT(spray_drag, -2, "desc.spray_drag is -2"),
      FAULT(scatter, -1, "desc.scatter is -1"),
  };
  pbf_solver *s = splash(3, PBF_FLOAT32, 0);
  const pbf_diffuse_desc good = desc_of(s);
  pbf_diffuse_desc bad;
  for (size_t i = 0; i < sizeof faults / sizeof faults[0]; ++i) {
    bad = good;
    memcpy((char *)&bad + faults[i].offset, &faults[i].value, sizeof faults[i].value);
    assert_fails(pbf_set_diffuse(s, &bad), PBF_ERROR_INVALID_ARGUMENT, faults[i].words);
  }
  bad = good, bad.capacity = 0;
  assert_fails(pbf_set_diffuse(s, &bad), PBF_ERROR_INVALID_ARGUMENT, "desc.capacity is 0");
  bad = good, bad.capacity = PBF_MAX_DIFFUSE + 1;
  assert_fails(pbf_set_diffuse(s, &bad), PBF_ERROR_INVALID_ARGUMENT, "desc.capacity is 4194304");
  bad = good, bad.interval = 0;
  assert_fails(pbf_set_diffuse(s, &bad), PBF_ERROR_INVALID_ARGUMENT, "desc.interval is 0");
  bad = good, bad.bubble_neighbors = 3;
  assert_fails(pbf_set_diffuse(s, &bad), PBF_ERROR_INVALID_ARGUMENT,
               "desc.bubble_neighbors is 3; it must be at least foam_neighbors, 7");
  bad = good, bad.struct_size = 7;
  assert_fails(pbf_set_diffuse(s, &bad), PBF_ERROR_STRUCT_SIZE, "pbf_diffuse_desc.struct_size");
  assert_fails(pbf_diffuse_init(s, NULL, sizeof good), PBF_ERROR_INVALID_ARGUMENT, "desc is null");
  assert_fails(pbf_diffuse_init(s, &bad, 12), PBF_ERROR_STRUCT_SIZE, "struct_size is 12");
  assert_int_equal(info_of(s).capacity, 0); /* none of them has begun anything */
  pbf_destroy(s);
}

static void bad_calls_are_refused(void **state) {
  (void)state;
  pbf_solver *s = splash(3, PBF_FLOAT32, 0);
  pbf_diffuse_desc desc = {.struct_size = sizeof desc};
  const float x[6] = {1, 1, 1, 1, 1, 1}, nan[3] = {1, NAN, 1}, lives[2] = {1, 0};
  float to[6];
  assert_fails(pbf_get_diffuse(s, &desc), PBF_ERROR_STATE, "pbf_set_diffuse");
  assert_fails(pbf_add_diffuse(s, 1, x, NULL, lives), PBF_ERROR_STATE, "pbf_set_diffuse");
  desc = desc_of(s);
  desc.capacity = 2;
  assert_ok(pbf_set_diffuse(s, &desc));
  assert_fails(pbf_add_diffuse(s, 3, x, NULL, lives), PBF_ERROR_CAPACITY, "count is 3");
  assert_fails(pbf_add_diffuse(s, 1, NULL, NULL, lives), PBF_ERROR_INVALID_ARGUMENT, "positions");
  assert_fails(pbf_add_diffuse(s, 1, nan, NULL, lives), PBF_ERROR_INVALID_ARGUMENT,
               "positions[0][1]");
  assert_fails(pbf_add_diffuse(s, 1, x, nan, lives), PBF_ERROR_INVALID_ARGUMENT,
               "velocities[0][1]");
  assert_fails(pbf_add_diffuse(s, 2, x, NULL, lives), PBF_ERROR_INVALID_ARGUMENT,
               "lives[1] is 0; it must be above 0");
  assert_fails(pbf_add_diffuse(s, 1, x, NULL, NULL), PBF_ERROR_INVALID_ARGUMENT, "lives");
  assert_int_equal(info_of(s).count, 0);
  assert_ok(pbf_add_diffuse(s, 1, x, NULL, lives));
  pbf_diffuse_read read = {.struct_size = sizeof read, .count = 2, .positions = to};
  assert_fails(pbf_read_diffuse(s, &read), PBF_ERROR_NOT_FOUND, "there are 1 diffuse particles");
  read.count = 1, read.components = 2;
  assert_fails(pbf_read_diffuse(s, &read), PBF_ERROR_INVALID_ARGUMENT, "read.components is 2");
  read.components = 0, read.element_type = 5;
  assert_fails(pbf_read_diffuse(s, &read), PBF_ERROR_INVALID_ARGUMENT, "read.element_type is 5");
  read.element_type = 0, read.stride = 8;
  assert_fails(pbf_read_diffuse(s, &read), PBF_ERROR_INVALID_ARGUMENT, "read.stride is 8");
  read.stride = 0, read.positions = NULL;
  assert_fails(pbf_read_diffuse(s, &read), PBF_ERROR_INVALID_ARGUMENT, "are null");
  assert_fails(pbf_read_diffuse(s, NULL), PBF_ERROR_INVALID_ARGUMENT, "read is null");
  assert_fails(pbf_shift_diffuse(s, NULL), PBF_ERROR_INVALID_ARGUMENT, "way is null");
  assert_fails(pbf_shift_diffuse(s, (double[3]){0, NAN, 0}), PBF_ERROR_INVALID_ARGUMENT, "way[1]");
  assert_ok(pbf_shift_diffuse(s, (double[3]){0.25, -0.5, 0}));
  const one p = read_one(s);
  assert_true(p.x[0] == 1.25 && p.x[1] == 0.5 && p.x[2] == 1);
  pbf_destroy(s);
}

/* A forged state is none that pbf_save wrote. */
static void forged_states_are_refused(void **state) {
  (void)state;
  pbf_solver *s = splash(3, PBF_FLOAT32, 1), *other = splash(3, PBF_FLOAT32, 0);
  uint64_t size, without;
  assert_ok(pbf_step(s, 40));
  assert_ok(pbf_step(other, 40));
  for (int i = 0; i < 20; ++i) add_one(s, 3, PBF_FLOAT32, start, throw, 1);
  free(test_save(other, &without));
  unsigned char *saved = test_save(s, &size);
  const uint64_t begin = without - 8; /* where there is a checksum without them */
  assert_true(size > without + 1000);
  uint32_t refused = 0;
  for (uint64_t at = begin; at + 8 < size; at += 4) {
    const uint64_t hash = test_hash(other);
    unsigned char kept[4];
    memcpy(kept, saved + at, 4);
    memset(saved + at, 0xff, 4); /* NaN, or a huge count */
    test_seal(saved, size);
    const pbf_status status = pbf_load(other, saved, size);
    assert_true(status == PBF_OK || status == PBF_ERROR_DATA);
    if (status != PBF_OK) assert_int_equal(test_hash(other), hash);
    refused += status != PBF_OK;
    memcpy(saved + at, kept, 4);
  }
  assert_true(refused > (size - begin) / 4 / 4);
  free(saved);
  pbf_destroy(s);
  pbf_destroy(other);
}

int main(void) {
  const struct CMUnitTest diffuse[] = {
      cmocka_unit_test(spray_flies_ballistically),
      cmocka_unit_test(bubbles_rise_to_their_speed),
      cmocka_unit_test(bubbles_without_drag_fall_upwards),
      cmocka_unit_test(foam_goes_with_the_fluid),
      cmocka_unit_test(foam_turns_with_the_fluid),
      cmocka_unit_test(kinds_go_by_neighbours),
      cmocka_unit_test(the_rate_is_that_of_what_comes_together),
      cmocka_unit_test(quiet_and_rigid_fluid_makes_none),
      cmocka_unit_test(births_are_those_of_the_potentials),
      cmocka_unit_test(they_begin_in_the_cylinder),
      cmocka_unit_test(lifetimes_are_exact),
      cmocka_unit_test(there_are_never_more_than_the_capacity),
      cmocka_unit_test(colliders_push_them_out),
      cmocka_unit_test(what_moves_takes_them_along),
      cmocka_unit_test(periodic_axes_lead_to_the_other_side),
      cmocka_unit_test(bits_do_not_depend_on_calls),
      cmocka_unit_test(an_interval_goes_by_time),
      cmocka_unit_test(threads_change_nothing),
      cmocka_unit_test(no_memory_leaves_all_as_it_was),
      cmocka_unit_test(setting_fails_whole),
      cmocka_unit_test(bad_descs_are_refused),
      cmocka_unit_test(bad_calls_are_refused),
      cmocka_unit_test(forged_states_are_refused),
  };
  return TEST_RUN(diffuse);
}
