/* Sines, powers and logarithms against values of 400 bits that were rounded once (mpmath 1.3). Of
 * each function three are such that glibc 2.36 rounds them the other way. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "physics/elementary.h"

/* A value and what is made of it. */
typedef struct row {
  double x, value;
} row;

static const struct {
  const char *name;
  double (*of)(double);
  row rows[5];
} functions[] = {
    {"pbf_sin",
     pbf_sin,
     {{-0x1.3410ad3cd340cp+4, -0x1.9304eae463723p-2},
      {0x1.6ba4b4e4d02c0p+1, 0x1.2f3a48c917153p-2},
      {0x1.85c87805e8280p+2, -0x1.8876571b93a29p-3},
      {-0x1.9a760ee572744p+4, -0x1.fdc41f0351ca8p-2},
      {0x1.1392e41a5d660p+1, 0x1.abac05a232b17p-1}}},
    {"pbf_cos",
     pbf_cos,
     {{0x1.d995c0fb32c5cp+4, -0x1.f2e1223d9260bp-3},
      {-0x1.6f79491931158p+3, 0x1.e018873568e1fp-2},
      {0x1.e8f44398cd4e0p+2, 0x1.b31497a3a58e5p-3},
      {-0x1.bc011125afb38p+4, -0x1.bb48908f70f4ap-1},
      {-0x1.fd99e4ee8e030p+1, -0x1.55de3ff15ec7ep-1}}},
    {"pbf_exp",
     pbf_exp,
     {{-0x1.2d028e7eefb72p+5, 0x1.a4be67a3f56d0p-55},
      {0x1.0a08bd1fc8afep+4, 0x1.fbb7c1aced59cp+23},
      {0x1.2929a2c343f70p+5, 0x1.812db1e0968f5p+53},
      {0x1.a25ee77a78fbcp+4, 0x1.a6cd119d80201p+37},
      {-0x1.e18892c86875ep+4, 0x1.7ee9f865556ecp-44}}},
    {"pbf_log",
     pbf_log,
     {{0x1.7de8067fa2b18p+2, 0x1.c94a745be4241p+0},
      {0x1.51a7e76407381p+3, 0x1.2d9af47ab6990p+1},
      {0x1.ceafad4bf7747p+1, 0x1.48f6ff7651699p+0},
      {0x1.71588c0ed7e36p+3, 0x1.391673960547cp+1},
      {0x1.fbc04207ef2d9p+2, 0x1.091a11fd1945ap+1}}},
    {"pbf_cosh",
     pbf_cosh,
     {{0x1.6db69bdd9149bp+1, 0x1.17810fc647d71p+3},
      {0x1.8cfb8220da788p-1, 0x1.50e246bb4126ep+0},
      {0x1.f9b107081b10cp+0, 0x1.d6441ffc4da20p+1},
      {0x1.288f5635a6592p+0, 0x1.bfdce1a287739p+0},
      {0x1.276f358a6a63cp-1, 0x1.2bd047d10c3adp+0}}},
    {"pbf_acosh",
     pbf_acosh,
     {{0x1.12d7f75a3b130p+4, 0x1.c498c72036091p+1},
      {0x1.fc2d19afec7a7p+3, 0x1.ba870f15a2f46p+1},
      {0x1.96bee8280d6eap+4, 0x1.f6d47d18fcea3p+1},
      {0x1.94abe83b06c74p+2, 0x1.43f8b2e234b78p+1},
      {0x1.1e882ba037327p+4, 0x1.c9efb65f5f355p+1}}},
    {"pbf_cube_root",
     pbf_cube_root,
     {{0x1.3308822562af6p+3, 0x1.0ffdc9b1fc587p+1},
      {0x1.5d09333201fb2p+4, 0x1.65a6c73ea69f1p+1},
      {0x1.83247e546df1ep+4, 0x1.7238686180377p+1},
      {0x1.910f51d08d4fap+4, 0x1.769ac30be6e7ap+1},
      {0x1.5b780fb903c5bp+1, 0x1.651d8f31cd58fp+0}}},
};

static const double powers[][3] = {
    {0x1.eaaf7fd2091e4p+0, -0x1.1aa62f8349f30p-2, 0x1.abd5914f848d1p-1},
    {0x1.a4aaf1a45cd58p+0, -0x1.afa14f05b3798p+1, 0x1.7fade20d25f51p-3},
    {0x1.6e3088db663c8p-3, -0x1.f0bee5e125b9cp+0, 0x1.c3aaf580a87ddp+4},
    {0x1.054609f985c74p+1, 0x1.1a8b92e2da530p-2, 0x1.37b49ec0eee70p+0},
    {0x1.e287b19965434p-1, 0x1.db09d2a780518p+0, 0x1.caaa56326df74p-1},
};

/* Such that products of float64 are rounded the other way; exact fractions. */
static const struct {
  double x;
  int n;
  double value;
} whole_powers[] = {
    {0x1.eb40d03bd118ap-1, 2, 0x1.d758d7971daf2p-1},
    {0x1.35b6cb76be5b1p+1, 3, 0x1.c5515a5d87147p+3},
    {0x1.e2e7ecce59fedp+0, 3, 0x1.ad956b93beec2p+2},
    {0x1.ac7a437ec4b96p+1, 3, 0x1.2c15c8b5a28d5p+5},
};

/* y, x and the angle. */
static const double angles[][3] = {
    {0x1.cc712defb2a9bp-1, 0x1.5c0bac82b63f8p+0, 0x1.2b35d033b1c0ap-1},
    {0x1.0c69f2e56e8bep+1, 0x1.310aae38a0f94p+1, 0x1.717735ece33ddp-1},
    {0x1.b9284bfcd2ec2p+0, 0x1.76eea74fb7564p-1, 0x1.2b41f5020f7c8p+0},
    {0x1.500d84307ca11p+1, 0x1.9359d58f87facp+0, 0x1.07c07f9ac7c2ep+0},
};

static void expect(const char *name, double x, double got, double wanted) {
  if (got == wanted) return;
  fail_msg("%s(%a) is %a instead of %a", name, x, got, wanted);
}

static void values_are_rounded_once(void **state) {
  (void)state;
  for (size_t f = 0; f < sizeof functions / sizeof functions[0]; ++f)
    for (int k = 0; k < 5; ++k)
      expect(functions[f].name, functions[f].rows[k].x, functions[f].of(functions[f].rows[k].x),
             functions[f].rows[k].value);
  for (size_t k = 0; k < sizeof powers / sizeof powers[0]; ++k)
    expect("pbf_pow", powers[k][0], pbf_pow(powers[k][0], powers[k][1]), powers[k][2]);
  for (size_t k = 0; k < sizeof whole_powers / sizeof whole_powers[0]; ++k)
    expect("pbf_whole_power", whole_powers[k].x,
           pbf_whole_power(whole_powers[k].x, whole_powers[k].n), whole_powers[k].value);
  for (size_t k = 0; k < sizeof angles / sizeof angles[0]; ++k)
    expect("pbf_angle", angles[k][0], pbf_angle(angles[k][0], angles[k][1]), angles[k][2]);
}

static void ends_are_exact(void **state) {
  (void)state;
  expect("pbf_sin", 0, pbf_sin(0), 0);
  expect("pbf_cos", 0, pbf_cos(0), 1);
  expect("pbf_exp", 0, pbf_exp(0), 1);
  expect("pbf_log", 1, pbf_log(1), 0);
  expect("pbf_pow", 0, pbf_pow(0, 4), 0);
  expect("pbf_pow", 3, pbf_pow(3, 0), 1);
  expect("pbf_pow", 2, pbf_pow(2, 3), 8);
  expect("pbf_whole_power", 3, pbf_whole_power(3, 0), 1);
  expect("pbf_whole_power", 0, pbf_whole_power(0, 3), 0);
  expect("pbf_whole_power", 1e305, pbf_whole_power(1e305, 1), 1e305);
  expect("pbf_whole_power", 1e305, pbf_whole_power(1e305, 3), HUGE_VAL);
  expect("pbf_cube_root", 0, pbf_cube_root(0), 0);
  expect("pbf_cube_root", 1e9, pbf_cube_root(1e9), 1000);
  expect("pbf_cube_root", 0x1p-1002, pbf_cube_root(0x1p-1002), 0x1p-334);
  expect("pbf_cube_root", 0x1p-1074, pbf_cube_root(0x1p-1074), 0x1p-358);
  expect("pbf_cube_root", 0x1p1023, pbf_cube_root(0x1p1023), 0x1p341);
  expect("pbf_angle", 0, pbf_angle(0, 1), 0);
  expect("pbf_angle", 0, pbf_angle(0, 0), 0);
}

static void large_angles_are_turned_back(void **state) {
  (void)state;
  expect("pbf_sin", 1e6, pbf_sin(1e6), -0x1.6664b2568d867p-2);
  expect("pbf_cos", 1e6, pbf_cos(1e6), 0x1.df9df9906d32cp-1);
  expect("pbf_sin", 1e15, pbf_sin(1e15), 0x1.b76f88136cebap-1);
  expect("pbf_cos", 1e15, pbf_cos(1e15), -0x1.06c154609d33fp-1);
  expect("pbf_sin", 1e300, pbf_sin(1e300), 0); /* known to no part of a turn */
  expect("pbf_cos", -1e300, pbf_cos(-1e300), 1);
}

/* Such that some 60 bits round them the other way; of 113 bits (libquadmath, GCC 12). */
static void small_angles_are_rounded_once(void **state) {
  (void)state;
  static const double sines[][2] = {{0x1.e03d141b079a4p-4, 0x1.df239a3b9b8dfp-4},
                                    {0x1.d157df60c9b0fp-4, 0x1.d057c5e51ecefp-4},
                                    {0x1.e271703396a79p-4, 0x1.e15411e2c26ddp-4},
                                    {0x1.8a9e930f24bdp-4, 0x1.8a025dde06601p-4}};
  static const double cosines[][2] = {{0x1.7009047ddd198p-4, 0x1.fdef412d81439p-1},
                                      {0x1.3371411d52d66p-4, 0x1.fe8ef389ff101p-1},
                                      {0x1.f5aff9458cd46p-4, 0x1.fc2a104038edfp-1},
                                      {0x1.08f6aaca136bdp-4, 0x1.feeddacc8a059p-1}};
  static const double of_tangents[][3] = {
      {0x1.c8de4b7100d92p-5, 0x1.24aa56203d3a2p-1, 0x1.8e5ee03e42e8fp-4},
      {0x1.3e11cac2ee927p-4, 0x1.440cab8973984p-1, 0x1.f40d682ed8a9bp-4},
      {0x1.ec45075cc4eecp-5, 0x1.bec31f767f994p-1, 0x1.19a1b3742a901p-4},
      {0x1.27b352a167415p-4, 0x1.6f765fe248317p-1, 0x1.9aa14a95e2273p-4}};
  for (int k = 0; k < 4; ++k) {
    expect("pbf_sin", sines[k][0], pbf_sin(sines[k][0]), sines[k][1]);
    expect("pbf_cos", cosines[k][0], pbf_cos(cosines[k][0]), cosines[k][1]);
    expect("pbf_angle", of_tangents[k][0], pbf_angle(of_tangents[k][0], of_tangents[k][1]),
           of_tangents[k][2]);
  }
}

/* What is tried first has the bits of pairs, where it says that it knows. */
static void small_angles_are_known(void **state) {
  (void)state;
  enum { DRAWS = 300000 };
  uint64_t draw = 1;
  int known = 0;
  for (int k = 0; k < DRAWS; ++k) {
    draw = draw * 6364136223846793005u + 1442695040888963407u; /* Knuth */
    const double part = (double)(draw >> 11) * 0x1p-53;
    const double x = (k & 1 ? 1 : -1) * (1 + part) * (PBF_SMALL_ANGLE / (double)(2u << k % 24));
    double found;
    const int sine = pbf_small_sine(x, &found);
    if (sine) expect("sine", x, found, pbf_pair_sine_ahead(x, 0).high);
    const int cosine = pbf_small_cosine(x, &found);
    if (cosine) expect("cosine", x, found, pbf_pair_sine_ahead(x, 1).high);
    const double right = 0.5 + part, up = fabs(x) * right;
    const int angle = pbf_small_angle(up, right, &found);
    if (angle) expect("angle", x, found, pbf_angle_by_newton(up, right));
    known += sine + cosine + angle;
  }
  assert_true(known > 0.97 * 3 * DRAWS);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(values_are_rounded_once), cmocka_unit_test(ends_are_exact),
      cmocka_unit_test(large_angles_are_turned_back),
      cmocka_unit_test(small_angles_are_rounded_once), cmocka_unit_test(small_angles_are_known)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
