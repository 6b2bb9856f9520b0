/* lambda and the position change: against finite differences of the constraint, and momentum. */
#include "support.h"

#include "physics/passes/smooth_pressure.h"

typedef struct sums {
  double density, slope2;
  pbf_vec gradient;
} sums;

static sums sums_at(int features, const pbf_constants *c, const pbf_vec *x, int i) {
  sums s = {c->value_scale, 0, {{0}}};
  for (int j = 0; j < CLOUD; ++j) {
    if (j == i) continue;
    pbf_vec d = pbf_sub(x[i], x[j]);
    pbf_real r2 = pbf_dot(d, d), value, slope;
    kernel_and_slope(features, c, r2, &value, &slope);
    s.density += value;
    s.slope2 += slope * slope * r2;
    s.gradient = pbf_add_scaled(s.gradient, slope, d);
  }
  return s;
}

/* With one kernel for both, the denominator of eq. 11 is sum over all k of |grad_k C_i|². */
static void lambda_against_finite_differences(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  pbf_constants c = pbf_constants_of(&p);
  pbf_vec x[CLOUD];
  fill_cloud(x, 1.2);
  double e = 1e-6;
  for (int i = 0; i < 5; ++i) {
    double constraint = brute_density(0, &c, x, i) - 1, gradient2 = 0;
    for (int k = 0; k < CLOUD; ++k)
      for (int a = 0; a < PBF_DIM; ++a) {
        pbf_vec keep = x[k];
        x[k].c[a] = keep.c[a] + e;
        double up = brute_density(0, &c, x, i);
        x[k].c[a] = keep.c[a] - e;
        double down = brute_density(0, &c, x, i);
        x[k] = keep;
        gradient2 += pow((up - down) / (2 * e), 2);
      }
    double expected = -constraint / (gradient2 + p.cfm / pow(p.smoothing_radius, 2));
    sums s = sums_at(0, &c, x, i);
    assert_near(pbf_lambda(&c, 0, s.density, s.slope2, s.gradient), expected,
                1e-6 * fabs(expected));
  }
}

/* Without cfm, one constraint projected alone is solved to first order: half the change halves
 * the error. */
static void one_constraint_projects_to_its_surface(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.cfm = 0;
  pbf_constants c = pbf_constants_of(&p);
  pbf_vec x[CLOUD];
  fill_cloud(x, 2.0);
  int i = 3;
  double before = brute_density(0, &c, x, i) - 1;
  sums s = sums_at(0, &c, x, i);
  double lambda = pbf_lambda(&c, 0, s.density, s.slope2, s.gradient), fraction = 1e-4;
  pbf_vec moved[CLOUD];
  memcpy(moved, x, sizeof x);
  moved[i] = pbf_add_scaled(x[i], fraction * lambda, s.gradient);
  for (int j = 0; j < CLOUD; ++j) {
    if (j == i) continue;
    pbf_vec d = pbf_sub(x[i], x[j]);
    pbf_real value, slope;
    kernel_and_slope(0, &c, pbf_dot(d, d), &value, &slope);
    moved[j] = pbf_add_scaled(x[j], -fraction * lambda * slope, d);
  }
  double after = brute_density(0, &c, moved, i) - 1;
  assert_near((after - before) / (fraction * before), -1, 2e-3);
}

static void position_changes_keep_the_centre_of_mass(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_POLY6_SPIKY);
  pbf_constants c = pbf_constants_of(&p);
  pbf_vec x[CLOUD], total = {{0}};
  double lambda[CLOUD], size = 0;
  fill_cloud(x, 1.0);
  for (int i = 0; i < CLOUD; ++i) {
    sums s = sums_at(PBF_FEATURE_POLY6, &c, x, i);
    lambda[i] = pbf_lambda(&c, 0, s.density, s.slope2, s.gradient);
  }
  for (int i = 0; i < CLOUD; ++i) {
    pbf_vec sum = {{0}};
    for (int j = 0; j < CLOUD; ++j) {
      if (j == i) continue;
      pbf_vec d = pbf_sub(x[i], x[j]);
      pbf_real value, slope;
      kernel_and_slope(PBF_FEATURE_POLY6, &c, pbf_dot(d, d), &value, &slope);
      sum = pbf_add_scaled(
          sum, (lambda[i] + lambda[j] + artificial_pressure<pbf_real>(&c, value)) * slope, d);
    }
    total = pbf_add_scaled(total, 1, pbf_sub(pbf_move(&c, x[i], sum), x[i]));
    size += sqrt(pbf_dot(sum, sum));
  }
  assert_true(size > 0.01);
  for (int k = 0; k < PBF_DIM; ++k) assert_near(total.c[k], 0, 1e-13 * size);
}

/* The largest eigenvalue of the undamped Jacobi matrix of a periodic lattice, by power iteration on
 * the operators themselves. */
enum { SIDE = PBF_DIM == 3 ? 12 : 16, SITES = PBF_DIM == 3 ? SIDE * SIDE * SIDE : SIDE * SIDE };

static void apply_jacobi(double h, const double *in, double *out) {
  static pbf_vec shift[SITES];
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.smoothing_radius = h;
  p.spacing = 1;
  pbf_constants c = pbf_constants_of(&p);
  int n = (int)ceil(h), nz = PBF_DIM == 3 ? n : 0;
  for (int pass = 0; pass < 2; ++pass)
    for (int site = 0; site < SITES; ++site) {
      int at[3] = {site % SIDE, site / SIDE % SIDE, site / (SIDE * SIDE)};
      double constraint = 0, diagonal = 0;
      pbf_vec sum = {{0}};
      for (int a = -n; a <= n; ++a)
        for (int b = -n; b <= n; ++b)
          for (int e = -nz; e <= nz; ++e) {
            int other = (at[0] + a + SIDE) % SIDE + SIDE * ((at[1] + b + SIDE) % SIDE);
            if (PBF_DIM == 3) other += SIDE * SIDE * ((at[2] + e + SIDE) % SIDE);
            double full[3] = {-1.0 * a, -1.0 * b, -1.0 * e};
            pbf_vec d;
            for (int k = 0; k < PBF_DIM; ++k) d.c[k] = full[k];
            pbf_real r2 = pbf_dot(d, d), value, slope;
            if (r2 == 0 || r2 >= h * h) continue;
            kernel_and_slope(0, &c, r2, &value, &slope);
            diagonal += slope * slope * r2;
            sum = pbf_add_scaled(sum, (in[site] + in[other]) * slope, d);
            constraint += slope * pbf_dot(d, pbf_sub(shift[site], shift[other]));
          }
      if (pass == 0)
        shift[site] = sum;
      else
        out[site] = constraint / diagonal;
    }
}

static void relaxation_is_below_the_stability_limit(void **state) {
  (void)state;
  double h = 2, a[SITES], b[SITES], growth = 0;
  uint32_t random = 7;
  for (int i = 0; i < SITES; ++i) a[i] = next_random(&random) - 0.5;
  for (int n = 0; n < 150; ++n) {
    double size = 0;
    apply_jacobi(h, a, b);
    for (int i = 0; i < SITES; ++i) size += b[i] * b[i];
    growth = sqrt(size);
    for (int i = 0; i < SITES; ++i) a[i] = b[i] / growth;
  }
  double predicted = pbf_lattice_lambda_max(PBF_KERNEL_WENDLAND_C2, PBF_DIM, h, 1);
  assert_near(growth, predicted, 0.03 * predicted);
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.smoothing_radius = h;
  p.spacing = 1;
  p.over_relaxation = 0;
  double omega = pbf_derive(&p, PBF_DIM).omega;
  assert_true(omega * growth < 2 && omega * growth > 1);
}

/* On independent constraints of stiffness k (in units of the diagonal) the error after n iterations
 * is the Chebyshev polynomial of the interval: at most 0.3 inside it. Signs are kept. */
static void chebyshev_reaches_its_rest(void **state) {
  (void)state;
  for (uint32_t iterations = 1; iterations <= 7; iterations += 2) {
    pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
    p.solver = PBF_SOLVER_CHEBYSHEV;
    p.cohesion = 0;
    p.over_relaxation = 0.7;
    p.iterations = iterations;
    pbf_constants c = pbf_constants_of(&p);
    double largest = 1 / (c.step_size / (1 + c.contraction)),
           smallest = largest * (1 - c.contraction) / (1 + c.contraction);
    assert_true(largest > 1.5 / 0.7);
    for (double k = smallest; k <= largest; k += (largest - smallest) / 64) {
      /* So small that no iteration's change is bounded. */
      double start = 1e-3 * c.max_change, error = 1, total = 0, change = 0;
      for (uint32_t n = 0; n < iterations; ++n) {
        pbf_set_iteration(&c, n);
        pbf_accelerate(&c, 1, -start * error, &total, &change);
        error = 1 + k * total / start;
      }
      assert_true(fabs(error) < 0.3001);
    }
    double total = 0, change = 0; /* a density below rest: no pull */
    pbf_set_iteration(&c, 0);
    pbf_accelerate(&c, 1, 0.3, &total, &change);
    assert_near(total, 0, 0);
    assert_near(change, 0, 0);
  }
}

static void cohesion_scales_the_pull(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.cfm = 0;
  pbf_vec none = {{0}};
  p.cohesion = 0.25;
  pbf_constants c = pbf_constants_of(&p);
  assert_near(pbf_lambda(&c, 0, 0.8, 2, none), 0.25 * 0.2 / 2, 1e-15);
  assert_near(pbf_lambda(&c, 0, 1.2, 2, none), -0.2 / 2, 1e-15);
  p.min_diagonal = 3;
  c = pbf_constants_of(&p);
  double least = 3 * pbf_derive(&p, PBF_DIM).diagonal;
  assert_near(pbf_lambda(&c, 0, 1.2, 1e-9, none), -0.2 / least, 1e-12);
}

/* What adds up pulls inside, in short steps with the weight of 8 h, in long ones as far as the
 * lattice's stiffness allows; not where the surface of a lattice begins; and nowhere without
 * gravity or where the fluid parts freely. */
static double pull(double density, double cohesion, double time_step, double gravity) {
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.solver = PBF_SOLVER_CHEBYSHEV;
  p.cohesion = cohesion;
  p.time_step = time_step;
  p.gravity[0] = gravity;
  p.gravity[1] = p.gravity[2] = 0;
  pbf_constants c = pbf_constants_of(&p);
  double total = 0, change = 0;
  for (uint32_t k = 0; k < 1000; ++k)
    pbf_accelerate(&c, (pbf_real)density, 1 * c.max_change, &total, &change);
  return total;
}

static void fluid_inside_pulls_with_a_weight(void **state) {
  (void)state;
  const double dt = 1e-4, g = 7;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.solver = PBF_SOLVER_CHEBYSHEV;
  pbf_derived d = pbf_derive(&p, PBF_DIM);
  double weight = 8 * d.h * g * dt * dt / d.pressure;
  assert_near(pull(0.999, 1, dt, g), weight, 1e-12 * weight);
  assert_near(pull(0.999, 0.25, dt, g), 0.25 * weight, 1e-12 * weight);
  assert_near(pull(0.999, 1, 100, g), 1 / d.stiffness, 1e-12 / d.stiffness);
  assert_near(pull(1 - 0.2 * d.surface_lacks, 1, dt, g), 0, 0);
  assert_near(pull(0.999, 1, dt, 0), 0, 0);
  assert_near(pull(0.999, 0, dt, g), 0, 0);
}

/* Lambda after a step, in parts of it, where it was `before` times as much in a step that was
 * `longer` times as long; the change goes along. */
static double smoothed(double before, double now, double longer) {
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2), q = p;
  p.solver = q.solver = PBF_SOLVER_CHEBYSHEV;
  q.time_step = longer * p.time_step;
  const pbf_constants c = pbf_constants_of(&p), last = pbf_constants_of(&q);
  const double unit = 1e-3;
  double total = now * unit, change = 0.25 * unit;
  pbf_smooth_pressure(&c, pbf_pressure_to_keep(&last, before * unit), &total, &change);
  assert_near(change - 0.25 * unit, total - now * unit, 1e-15);
  return total / unit;
}

/* A twentieth of the last pressure; what has more than trebled counts as three times, what has come
 * to less than a third as a third, and what pulls as nothing. */
static void the_last_pressure_counts(void **state) {
  (void)state;
  const double tiny = 1e-12;
  assert_near(smoothed(-1, -1, 1), -1, tiny);
  assert_near(smoothed(-2, -1, 1), -1.05, tiny);
  assert_near(smoothed(-1, -2, 1), -1.95, tiny);
  assert_near(smoothed(-1, -3, 1), -2.9, tiny);
  assert_near(smoothed(-1, -4, 1), -3.9, tiny);
  assert_near(smoothed(-3, -1, 1), -1.1, tiny);
  assert_near(smoothed(-4, -1, 1), -1.1, tiny);
  assert_near(smoothed(0, -1, 1), -1, tiny);
  assert_near(smoothed(-1, 0, 1), 0, tiny);
  assert_near(smoothed(0.5, -1, 1), -1, tiny);
  assert_near(smoothed(-1, 0.5, 1), 0.5, tiny);
  /* Pressure is lambda over the square of the step. */
  assert_near(smoothed(-4, -1, 2), -1, tiny);
  assert_near(smoothed(-1, -1, 0.8), -1 - 0.05 * (1 / 0.64 - 1), tiny);
}

/* Without a length, or where its square is no number, there is none. */
static void steps_of_no_time_keep_no_pressure(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.solver = PBF_SOLVER_CHEBYSHEV;
  const double lengths[] = {0, 1e-200, 1e200};
  for (double time_step : lengths) {
    p.time_step = time_step;
    const pbf_constants c = pbf_constants_of(&p);
    assert_near(pbf_pressure_to_keep(&c, -1), 0, 0);
    double total = -1, change = -1;
    pbf_smooth_pressure(&c, 1, &total, &change);
    assert_near(total, -1, 0);
    assert_near(change, -1, 0);
  }
}

/* A crowd of a density pushes by as many lambdas: less of it the denser it is, and it would draw in
 * what is around it. Nor may it push more than its own eigenvalue allows. */
static void crowds_push_no_less_the_denser_they_are(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.solver = PBF_SOLVER_CHEBYSHEV;
  pbf_constants c = pbf_constants_of(&p);
  double diagonal = pbf_derive(&p, PBF_DIM).diagonal, before = 0;
  pbf_vec none = {{0}};
  for (double density = 1.5; density < 1000; density *= 1.5) {
    double push = -density * pbf_lambda(&c, 0, density, density * diagonal, none) * diagonal;
    assert_true(push > before && push <= 1);
    before = push;
  }
}

static void prediction_is_symplectic_euler(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.time_step = 0.1;
  p.gravity[0] = 1;
  p.gravity[1] = -2;
  pbf_vec x = {{0}}, v = {{0}};
  x.c[0] = 3;
  v.c[1] = 5;
  pbf_forces f = pbf_forces_of(&p, 0);
  pbf_vec y = pbf_predict(&f, x, v);
  assert_near(y.c[0], 3 + 0.1 * (0.1 * 1), 1e-15);
  assert_near(y.c[1], 0.1 * (5 - 0.2), 1e-15);
  p.attraction = 4;
  p.attraction_center[0] = 1;
  f = pbf_forces_of(&p, 0);
  y = pbf_predict(&f, x, v);
  assert_near(y.c[0], 3 + 0.1 * (0.1 * (1 - 4 * 2)), 1e-15);
  pbf_vec w = pbf_predicted_velocity(&f, x, v, y, y);
  assert_near(w.c[0], 0.1 * (1 - 8), 1e-13);
  x = y; /* out of an obstacle, then by the solve */
  x.c[1] += 0.02;
  w = pbf_predicted_velocity(&f, (pbf_vec){{3}}, v, y, x);
  assert_near(w.c[1], 5 - 0.2 + 0.2, 1e-13);
  pbf_vec after = x;
  after.c[0] += 0.03;
  assert_near(pbf_velocity(10, w, x, after).c[0], w.c[0] + 0.3, 1e-13);
}

/* Walls stop what would cross the domain in less than a step, and what rounding leaves of such a
 * speed has no square; nor has what is no number. */
static void no_speed_is_beyond_the_domain(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.time_step = 0.1;
  for (int k = 0; k < 3; ++k) p.domain_max[k] = 10;
  const pbf_forces f = pbf_forces_of(&p, 0);
  const double speeds[] = {99, 1e30, -1e200, INFINITY, NAN};
  for (int i = 0; i < 5; ++i) {
    pbf_vec x = {{0}}, v = {{0}}, after = {{0}};
    v.c[0] = speeds[i];
    after.c[0] = i == 0 ? 9.9 : 10;
    pbf_vec w = pbf_predicted_velocity(&f, x, v, pbf_predict(&f, x, v), after);
    assert_true(fabs(w.c[0]) <= PBF_DIM * 10 / 0.1 * (1 + 1e-15));
    if (i == 0) assert_near(w.c[0], 99, 1e-12);
  }
}

/* A particle that nothing moves keeps its velocity to the last bit, however small the time step. */
static void rest_of_the_velocity_is_not_rounded(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.time_step = 1e-9;
  pbf_forces f = pbf_forces_of(&p, 0);
  pbf_vec x = {{0}}, v = {{0}};
  x.c[0] = 1000;
  v.c[0] = 0.1234567890123;
  pbf_vec y = pbf_predict(&f, x, v), w = pbf_predicted_velocity(&f, x, v, y, y);
  w = pbf_velocity(f.inv_time_step, w, y, y);
  assert_true(w.c[0] == v.c[0]);
}

/* However far an equation is from holding, an iteration adds to lambda what a pressed lattice
 * bears: a few parts of 1 / stiffness; and the sum of what iterations added is lambda. */
static void an_iteration_adds_what_a_lattice_bears(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.solver = PBF_SOLVER_CHEBYSHEV;
  p.iterations = 6;
  pbf_constants c = pbf_constants_of(&p);
  double most = (PBF_DIM == 2 ? 1.5 : 3) / pbf_derive(&p, PBF_DIM).stiffness;
  double lambda = 0, change = 0, sum = 0;
  for (uint32_t n = 0; n < p.iterations; ++n) {
    pbf_set_iteration(&c, n);
    pbf_accelerate(&c, 1, n < 4 ? -1e6 * most : 1e6 * most, &lambda, &change);
    assert_near(change, n < 4 ? -most : most, 1e-12 * most);
    sum += change;
    assert_near(lambda, sum, 1e-12 * most);
  }
}

/* In a crowd forces add up, and so each is to be the smaller; with few neighbours likewise. */
static void crowds_and_few_neighbors_add_less(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.solver = PBF_SOLVER_CHEBYSHEV;
  const double spacings[] = {1.2, 1.4, 1.7, 2, 3}, parts[] = {0.5, 1, 2, 3, 3};
  const double densities[] = {0.2, 1.5, 3, 15}, shares[] = {1, 1, 0.5, 0.1};
  for (int k = 0; k < 5; ++k) {
    p.spacing = p.smoothing_radius / spacings[k];
    pbf_constants c = pbf_constants_of(&p);
    double part = fmin(parts[k], PBF_DIM == 2 ? 1.5 : 3);
    double most = part / pbf_derive(&p, PBF_DIM).stiffness;
    for (int j = 0; j < 4; ++j) {
      double lambda = 0, change = 0;
      pbf_set_iteration(&c, 0);
      pbf_accelerate(&c, densities[j], -1e6 * most, &lambda, &change);
      assert_near(change, -most * shares[j], 1e-9 * most);
    }
  }
}

/* Steps short for gravity undo their share of the error that they start from, yet so much of it at
 * most that fluid spreads at the speed of a fall; long ones all of it. */
static void short_steps_undo_little(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.solver = PBF_SOLVER_CHEBYSHEV;
  p.gravity[1] = -10;
  double fall = sqrt(p.smoothing_radius / 10);
  p.time_step = 0.005 * fall; /* a quarter of what is not short */
  pbf_constants c = pbf_constants_of(&p);
  assert_near(pbf_residual_density(&c, 0.9), 0, 0);
  assert_near(pbf_residual_density(&c, 1.0004), 0.75 * 0.0004, 1e-12);
  assert_near(pbf_residual_density(&c, 1.2), 0.2 * (1 - 0.1 / 16) - 0.1 * 0.005 / 0.75, 1e-12);
  p.time_step = 0.021 * fall;
  c = pbf_constants_of(&p);
  assert_near(pbf_residual_density(&c, 1.2), 0, 0);
}

/* A move goes into the velocity undivided: far from the origin a place would round it away. */
static void moves_push(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.solver = PBF_SOLVER_JACOBI;
  p.over_relaxation = 0.5;
  pbf_constants c = pbf_constants_of(&p);
  pbf_vec x = {{1e18}}, v = {{3}}, sum = {{0.25}};
  assert_near(pbf_move(&c, x, sum).c[0], x.c[0], 0);
  assert_near(pbf_push(&c, 100, v, sum).c[0], 3 + 100 * 0.5 * 0.25, 1e-12);
  p.solver = PBF_SOLVER_CHEBYSHEV; /* its step is in lambda */
  c = pbf_constants_of(&p);
  assert_near(pbf_push(&c, 100, v, sum).c[0], 3 + 100 * 0.25, 1e-12);
}

/* The stiffness of a pressed lattice against finite differences of its forces. */
static void stiffness_of_a_lattice(void **state) {
  (void)state;
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.solver = PBF_SOLVER_CHEBYSHEV;
  p.smoothing_radius = 2;
  p.spacing = 1;
  pbf_constants c = pbf_constants_of(&p);
  double stiffness = pbf_derive(&p, PBF_DIM).stiffness, largest = 0, e = 1e-5, sum = 0;
  enum { N = 3 };
  for (int i = -N; i <= N; ++i)
    for (int j = -N; j <= N; ++j)
      for (int k = PBF_DIM == 3 ? -N : 0; k <= (PBF_DIM == 3 ? N : 0); ++k) {
        pbf_vec d = {{-1.0 * i, -1.0 * j}};
        if (PBF_DIM == 3) d.c[PBF_DIM - 1] = -k;
        if (!i && !j && !k) continue;
        if (i % 2 != 0) d.c[0] += 2 * e; /* planes across x, moved in turn to either side */
        pbf_real value, slope;
        kernel_and_slope(0, &c, pbf_dot(d, d), &value, &slope);
        sum += -2 * slope * d.c[0];
      }
  largest = -sum / e; /* the force of lambda = -1 against a displacement e */
  assert_true(largest > 0);
  assert_true(stiffness >= 0.999 * largest);
  assert_true(stiffness < 4 * largest);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lambda_against_finite_differences),
      cmocka_unit_test(one_constraint_projects_to_its_surface),
      cmocka_unit_test(position_changes_keep_the_centre_of_mass),
      cmocka_unit_test(relaxation_is_below_the_stability_limit),
      cmocka_unit_test(chebyshev_reaches_its_rest),
      cmocka_unit_test(cohesion_scales_the_pull),
      cmocka_unit_test(fluid_inside_pulls_with_a_weight),
      cmocka_unit_test(crowds_push_no_less_the_denser_they_are),
      cmocka_unit_test(prediction_is_symplectic_euler),
      cmocka_unit_test(no_speed_is_beyond_the_domain),
      cmocka_unit_test(rest_of_the_velocity_is_not_rounded),
      cmocka_unit_test(an_iteration_adds_what_a_lattice_bears),
      cmocka_unit_test(crowds_and_few_neighbors_add_less),
      cmocka_unit_test(short_steps_undo_little),
      cmocka_unit_test(moves_push),
      cmocka_unit_test(the_last_pressure_counts),
      cmocka_unit_test(steps_of_no_time_keep_no_pressure),
      cmocka_unit_test(stiffness_of_a_lattice),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
