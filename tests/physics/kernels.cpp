/* Kernels: unit integral, gradient by finite differences, support, derived constants. */
#include "support.h"

static const uint32_t KERNELS[] = {PBF_KERNEL_WENDLAND_C2, PBF_KERNEL_POLY6_SPIKY};

static int features_for(uint32_t kernel) {
  return kernel == PBF_KERNEL_POLY6_SPIKY ? PBF_FEATURE_POLY6 : 0;
}

/* Integral over the ball of a function of r, by the midpoint rule. */
static double integrate(double h, double (*f)(double r, void *context), void *context) {
  enum { N = 20000 };
  double sum = 0;
  for (int i = 0; i < N; ++i) {
    double r = h * (i + 0.5) / N;
    double shell = PBF_DIM == 2 ? 2 * PBF_PI * r : 4 * PBF_PI * r * r;
    sum += shell * f(r, context) * h / N;
  }
  return sum;
}

typedef struct kernel_case {
  int features;
  pbf_constants c;
} kernel_case;

static double value_at(double r, void *context) {
  const kernel_case *k = static_cast<const kernel_case *>(context);
  return kernel_value<pbf_real>(k->features, &k->c, r * r);
}

static double slope_at(double r, kernel_case *k) {
  pbf_real value, slope;
  kernel_and_slope(k->features, &k->c, r * r, &value, &slope);
  assert_near(value, value_at(r, k), 1e-13 * k->c.value_scale);
  return slope;
}

static kernel_case make_case(uint32_t kernel) {
  pbf_params p = test_params(kernel);
  kernel_case k = {features_for(kernel), pbf_constants_of(&p)};
  return k;
}

static void density_integrates_to_volume(void **state) {
  (void)state;
  for (int n = 0; n < 2; ++n) {
    kernel_case k = make_case(KERNELS[n]);
    pbf_params p = test_params(KERNELS[n]);
    double volume = pbf_derive(&p, PBF_DIM).volume;
    assert_near(integrate(k.c.h, value_at, &k) / volume, 1, 1e-7);
  }
}

/* The gradient of Wendland is that of its value. The spiky kernel (h - r)³ is another function:
 * its own normalised value is 10/(pi h⁵) in 2D, 15/(pi h⁶) in 3D, times (h - r)³. */
static void gradient_is_the_derivative(void **state) {
  (void)state;
  for (int n = 0; n < 2; ++n) {
    kernel_case k = make_case(KERNELS[n]);
    pbf_params p = test_params(KERNELS[n]);
    double h = k.c.h, volume = pbf_derive(&p, PBF_DIM).volume, e = 1e-6 * h;
    double spiky = PBF_DIM == 2 ? 10 / (PBF_PI * pow(h, 5)) : 15 / (PBF_PI * pow(h, 6));
    for (double r = 0.05 * h; r < 0.99 * h; r += 0.07 * h) {
      double derivative = KERNELS[n] == PBF_KERNEL_POLY6_SPIKY
                              ? volume * spiky * (pow(h - r - e, 3) - pow(h - r + e, 3)) / (2 * e)
                              : (value_at(r + e, &k) - value_at(r - e, &k)) / (2 * e);
      assert_near(slope_at(r, &k) * r, derivative, 1e-6 * fabs(derivative));
    }
  }
}

static void spiky_is_normalised_like_a_kernel(void **state) {
  (void)state;
  /* integral of r |grad W| = dimension, by partial integration of a unit kernel */
  for (int n = 0; n < 2; ++n) {
    kernel_case k = make_case(KERNELS[n]);
    pbf_params p = test_params(KERNELS[n]);
    double volume = pbf_derive(&p, PBF_DIM).volume, sum = 0;
    enum { N = 20000 };
    for (int i = 0; i < N; ++i) {
      double r = k.c.h * (i + 0.5) / N;
      double shell = PBF_DIM == 2 ? 2 * PBF_PI * r : 4 * PBF_PI * r * r;
      sum -= shell * r * r * slope_at(r, &k) * k.c.h / N;
    }
    assert_near(sum / volume, PBF_DIM, 1e-6);
  }
}

static void nothing_beyond_the_support(void **state) {
  (void)state;
  for (int n = 0; n < 2; ++n) {
    kernel_case k = make_case(KERNELS[n]);
    for (double q = 1; q < 3; q += 0.25) {
      assert_near(value_at(q * k.c.h * (1 + 1e-15), &k), 0, 0);
      assert_near(slope_at(q * k.c.h * (1 + 1e-15), &k), 0, 0);
    }
  }
}

static void coincident_particles_have_no_direction_but_finite_terms(void **state) {
  (void)state;
  for (int n = 0; n < 2; ++n) {
    kernel_case k = make_case(KERNELS[n]);
    pbf_real value, slope;
    kernel_and_slope(k.features, &k.c, pbf_real{0}, &value, &slope);
    assert_near(value, k.c.value_scale, 1e-12 * k.c.value_scale);
    assert_true(isfinite(slope));
  }
}

static void rest_lattice_has_unit_density(void **state) {
  (void)state;
  for (int n = 0; n < 2; ++n) {
    kernel_case k = make_case(KERNELS[n]);
    double d = test_params(KERNELS[n]).spacing, sum = 0;
    int m = (int)ceil(k.c.h / d), mz = PBF_DIM == 3 ? m : 0;
    for (int a = -m; a <= m; ++a)
      for (int b = -m; b <= m; ++b)
        for (int e = -mz; e <= mz; ++e) sum += value_at(d * sqrt(a * a + b * b + e * e), &k);
    assert_near(sum, 1, 1e-12);
  }
}

/* The report's scene: V = p/(1 + p W0) etc., physics of the 3D constants used in 2D. */
static void report_parameters_give_the_reports_constants(void **state) {
  (void)state;
  if (PBF_DIM != 2) return;
  double h = 1.1, p = 315 / (256 * h), q = 1.5 / h, w0 = 4 / (PBF_PI * h * h);
  pbf_params params = test_params(PBF_KERNEL_POLY6_SPIKY);
  params.smoothing_radius = h;
  params.particle_volume = p / (1 + p * w0);
  params.over_relaxation = (1 + p * w0) * params.particle_volume / q;
  params.cfm = 100 * params.particle_volume * params.particle_volume / (q * q) * h * h;
  pbf_constants c = pbf_constants_of(&params);
  assert_near(params.particle_volume, 0.5138132684248845, 1e-15);
  assert_near(c.omega, 0.8203125, 1e-15);
  assert_near(c.cfm, 14.197552467531091, 1e-12);
}

static void artificial_pressure_is_a_power(void **state) {
  (void)state;
  for (int n = 0; n < 2; ++n)
    for (uint32_t power = 1; power <= 8; ++power) {
      pbf_params p = test_params(KERNELS[n]);
      p.scorr_n = power;
      kernel_case k = {features_for(KERNELS[n]), pbf_constants_of(&p)};
      double at_dq = value_at(p.scorr_dq * k.c.h, &k);
      assert_near(artificial_pressure<pbf_real>(&k.c, at_dq), -p.scorr_k, 1e-13);
      double value = value_at(0.6 * k.c.h, &k);
      assert_near(artificial_pressure<pbf_real>(&k.c, value),
                  -p.scorr_k * pow(value / at_dq, power), 1e-13);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(density_integrates_to_volume),
      cmocka_unit_test(gradient_is_the_derivative),
      cmocka_unit_test(spiky_is_normalised_like_a_kernel),
      cmocka_unit_test(nothing_beyond_the_support),
      cmocka_unit_test(coincident_particles_have_no_direction_but_finite_terms),
      cmocka_unit_test(rest_lattice_has_unit_density),
      cmocka_unit_test(report_parameters_give_the_reports_constants),
      cmocka_unit_test(artificial_pressure_is_a_power),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
