/* One wrong value at a time, in every field: refused with the field's name, nothing changed. */
#include <float.h>
#include <stdio.h>

#include "param_table.h"
#include "support.h"

typedef struct real_case {
  const char *words; /* the sentence has them */
  size_t offset;
  double value;
} real_case;

typedef struct count_case {
  const char *words;
  size_t offset;
  uint32_t value;
} count_case;

#define P(member) offsetof(pbf_params, member)
#define C(member) offsetof(pbf_collider, member)
#define LENGTH(array) (sizeof(array) / sizeof((array)[0]))

static const real_case params_reals[] = {
    {"smoothing_radius is 0; it must be above 0", P(smoothing_radius), 0},
    {"smoothing_radius is -1", P(smoothing_radius), -1},
    {"spacing is -1", P(spacing), -1},
    {"spacing is 0.1; it must be below smoothing_radius", P(spacing), 0.1},
    {"spacing is 0.001", P(spacing), 0.001},
    {"particle_volume is -1", P(particle_volume), -1},
    {"particle_volume is 1e-10; it must be 0, or 1e-6", P(particle_volume), 1e-10},
    {"particle_volume is 2; it must be 0, or 1e-6", P(particle_volume), 2},
    {"time_step is 0", P(time_step), 0},
    {"time_step is -0.1", P(time_step), -0.1},
    {"over_relaxation is -1", P(over_relaxation), -1},
    {"cfm is -1", P(cfm), -1},
    {"cohesion is -0.5", P(cohesion), -0.5},
    {"cohesion is 1.5", P(cohesion), 1.5},
    {"min_diagonal is -1", P(min_diagonal), -1},
    {"wall_density is -0.5", P(wall_density), -0.5},
    {"wall_density is 1.5", P(wall_density), 1.5},
    {"scorr_k is -1", P(scorr_k), -1},
    {"vorticity is -1", P(vorticity), -1},
    {"viscosity is -1", P(viscosity), -1},
    {"search_cell_width is 0.09; it must be at least smoothing_radius", P(search_cell_width), 0.09},
    {"search_cell_width is -1", P(search_cell_width), -1},
    {"sleep_speed is -1", P(sleep_speed), -1},
    {"sleep_time is -1", P(sleep_time), -1},
    {"tolerance is -0.001; it must be", P(tolerance), -0.001},
    {"prestabilization is -1", P(prestabilization), -1},
    {"damping_compensation is -1", P(damping_compensation), -1},
    {"damping_compensation is 1.5", P(damping_compensation), 1.5},
    {"angular_momentum_correction is -0.5", P(angular_momentum_correction), -0.5},
    {"angular_momentum_correction is 1.5", P(angular_momentum_correction), 1.5},
    {"pressure_grid is -2; it must be", P(pressure_grid), -2},
    {"pressure_grid is 0.5; it must be 1", P(pressure_grid), 0.5},
    {"pressure_grid is 2000; it must be 1", P(pressure_grid), 2000},
    {"sleep_time is 0; with a sleep_speed (0.1) it must be above 0", P(sleep_speed), 0.1},
    {"domain_max[0] is 0; it must be above domain_min[0] (0)", P(domain_max[0]), 0},
    {"domain_max[1] is -1", P(domain_max[1]), -1},
    {"domain_max[2] is 1; it must be above domain_min[2] (2)", P(domain_min[2]), 2},
    {"the walls of axis 0 stand at 0 and -0.5", P(wall_amplitude[1]), -1.5},
};

static const count_case params_counts[] = {
    {"kernel is 2; it must be 0 … 1", P(kernel), 2},
    {"iterations is 0; it must be at least 1", P(iterations), 0},
    {"collide is 0; it must be 1 … 7", P(collide), 0},
    {"collide is 8", P(collide), 8},
    {"solver is 2; it must be 0 … 1", P(solver), 2},
};

static void put_real(void *object, size_t offset, double value) {
  memcpy((char *)object + offset, &value, sizeof value);
}

static void put_count(void *object, size_t offset, uint32_t value) {
  memcpy((char *)object + offset, &value, sizeof value);
}

static pbf_params steady_phase(void) {
  pbf_params params = test_params();
  params.wall_phase[1] = 1.5707963267948966; /* so that an amplitude moves the wall at time 0 */
  return params;
}

static void refuse_params(pbf_solver *solver, const pbf_params *params, const char *words) {
  pbf_params before = {.struct_size = sizeof before}, after = {.struct_size = sizeof after};
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 10);
  pbf_solver *none = NULL;
  assert_ok(pbf_get_params(solver, &before));
  assert_fails(pbf_set_params(solver, params), PBF_ERROR_INVALID_ARGUMENT, words);
  assert_ok(pbf_get_params(solver, &after));
  assert_memory_equal(&before, &after, sizeof before);
  assert_fails(pbf_create(&desc, params, &none), PBF_ERROR_INVALID_ARGUMENT, words);
  assert_null(none);
}

static void params_by_table(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 10);
  for (size_t i = 0; i < LENGTH(params_reals); ++i) {
    pbf_params params = steady_phase();
    put_real(&params, params_reals[i].offset, params_reals[i].value);
    refuse_params(s, &params, params_reals[i].words);
  }
  for (size_t i = 0; i < LENGTH(params_counts); ++i) {
    pbf_params params = test_params();
    put_count(&params, params_counts[i].offset, params_counts[i].value);
    refuse_params(s, &params, params_counts[i].words);
  }
  pbf_destroy(s);
}

static void nothing_that_is_not_a_number(void **state) {
  (void)state;
  const double values[] = {NAN, INFINITY, -INFINITY, 1e39};
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 10);
  for (int f = 0; f < TABLE_PARAMS; ++f) {
    const table_param *param = &table_params[f];
    for (uint32_t c = 0; c < param->components && !param->conditional; ++c) {
      for (size_t v = 0; v < LENGTH(values); ++v) {
        pbf_params params = test_params();
        table_put(&params, param, c, values[v]);
        char words[64];
        if (param->components == 1) {
          snprintf(words, sizeof words, "params.%s is ", param->name);
        } else {
          snprintf(words, sizeof words, "params.%s[%u] is ", param->name, c);
        }
        refuse_params(s, &params, words);
      }
    }
  }
  pbf_destroy(s);
}

static void scorr_only_when_it_is_used(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 10);
  pbf_params params = test_params();
  params.scorr_dq = 0;
  params.scorr_n = 0;
  assert_ok(pbf_set_params(s, &params));
  params.scorr_k = 0.1;
  refuse_params(s, &params, "scorr_n is 0; it must be 1 … 8");
  params.scorr_n = 9;
  refuse_params(s, &params, "scorr_n is 9");
  params.scorr_n = 8;
  refuse_params(s, &params, "scorr_dq is 0; it must be above 0");
  params.scorr_dq = 1;
  refuse_params(s, &params, "scorr_dq is 1; it must be below 1");
  params.scorr_dq = NAN;
  refuse_params(s, &params, "scorr_dq is");
  params.scorr_dq = 0.999;
  assert_ok(pbf_set_params(s, &params));
  pbf_destroy(s);
}

static void undamping_only_where_pushes_are_known(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 10);
  pbf_params params = test_params();
  params.damping_compensation = 0.5;
  params.solver = PBF_SOLVER_JACOBI;
  refuse_params(s, &params,
                "params.damping_compensation is 0.5; it must be 0 with PBF_SOLVER_JACOBI");
  params.damping_compensation = 0;
  assert_ok(pbf_set_params(s, &params));
  params.angular_momentum_correction = 1;
  refuse_params(s, &params,
                "params.angular_momentum_correction is 1; it must be 0 with PBF_SOLVER_JACOBI");
  params.damping_compensation = 0.5;
  params.solver = PBF_SOLVER_CHEBYSHEV;
  assert_ok(pbf_set_params(s, &params));
  pbf_destroy(s);
}

/* In float64 most of this is fine. */
static void float32_has_its_limits(void **state) {
  (void)state;
  pbf_solver *single = test_solver(3, PBF_FLOAT32, 10);
  pbf_solver *wide = test_solver(3, PBF_FLOAT64, 10);
  pbf_params params = test_params();
  params.time_step = 1e-39;
  refuse_params(single, &params, "a normal number in float32");
  assert_ok(pbf_set_params(wide, &params));
  params.time_step = 5e-324; /* its inverse is infinite */
  refuse_params(wide, &params, "a normal number");
  params = test_params();
  params.domain_min[1] = 1e6;
  params.domain_max[1] = 1e6 + 1;
  refuse_params(single, &params, "where float32 resolves 0.12; it must be a 4000th of the spacing");
  assert_ok(pbf_set_params(wide, &params));
  /* The farthest that 0.05 / 4000 allows is 0.0000125 * 2^23 = 104.9, */
  params.domain_min[1] = 103;
  params.domain_max[1] = 104;
  assert_ok(pbf_set_params(single, &params));
  params.wall_amplitude[PBF_WALL_Y_MAX] = 1;
  refuse_params(single, &params, "domain_max[1] is 104");
  params.wall_amplitude[PBF_WALL_Y_MAX] = 0;
  params.domain_max[1] = 105;
  refuse_params(single, &params, "domain_max[1] is 105");
  params.domain_min[1] = -105;
  params.domain_max[1] = -104;
  refuse_params(single, &params, "domain_min[1] is -105");
  /* … and that 0.05 / 50 does, where the domain is as long, 8388.6. */
  params.domain_min[1] = 0;
  params.domain_max[1] = 8388;
  assert_ok(pbf_set_params(single, &params));
  params.wall_amplitude[PBF_WALL_Y_MAX] = 1;
  refuse_params(single, &params, "must be a 50th of the spacing");
  /* A way that is too long for its numbers is not the domain's fault. */
  params.domain_max[1] = 2;
  params.wall_amplitude[PBF_WALL_Y_MAX] = 1e8;
  refuse_params(single, &params, "params.wall_amplitude[3] is 100000000, where float32 resolves");
  /* In float64 2^29 times as far. */
  params = test_params();
  params.domain_max[2] = 4.5e12;
  assert_ok(pbf_set_params(wide, &params));
  params.domain_max[2] = 4.6e12;
  assert_fails(pbf_set_params(wide, &params), PBF_ERROR_INVALID_ARGUMENT,
               "where float64 resolves 0.001; it must be a 50th of the spacing");
  pbf_destroy(single);
  pbf_destroy(wide);
}

/* NaN in every third component, and more. */
static void two_dimensions_ignore_the_third(void **state) {
  (void)state;
  pbf_solver *s = test_solver(2, PBF_FLOAT32, 10);
  pbf_params params = test_params(), back = {.struct_size = sizeof back};
  params.gravity[2] = params.attraction_center[2] = NAN;
  params.domain_min[2] = INFINITY;
  params.domain_max[2] = -1;
  for (int wall = PBF_WALL_Z_MIN; wall <= PBF_WALL_Z_MAX; ++wall)
    params.wall_velocity[wall] = params.wall_amplitude[wall] = params.wall_phase[wall] =
        params.wall_frequency[wall] = NAN;
  assert_ok(pbf_set_params(s, &params));
  assert_ok(pbf_get_params(s, &back));
  assert_memory_equal(&params, &back, sizeof back);
  pbf_collider collider;
  assert_ok(pbf_collider_init(&collider, sizeof collider, PBF_COLLIDER_BOX));
  collider.position[2] = collider.velocity[2] = collider.axis[2] = NAN;
  collider.half_extents[2] = -1;
  collider.angular_velocity[0] = NAN;
  assert_ok(pbf_set_colliders(s, 1, &collider));
  collider.orientation[0] = 1;
  collider.orientation[3] = 0;
  assert_fails(pbf_set_colliders(s, 1, &collider), PBF_ERROR_INVALID_ARGUMENT, "in 2D x and y");
  float x[] = {0.5f, 0.5f};
  assert_ok(pbf_add_particles(s, 1, x, NULL, NULL));
  assert_ok(pbf_step(s, 3));
  pbf_destroy(s);
}

static const real_case collider_reals[] = {
    {"colliders[1].position[1] is NaN", C(position[1]), NAN},
    {"colliders[1].velocity[0] is inf", C(velocity[0]), INFINITY},
    {"colliders[1].angular_velocity[2] is NaN;", C(angular_velocity[2]), -NAN},
    {"colliders[1].radius is 0; it must be above 0", C(radius), 0},
    {"colliders[1].radius is -1", C(radius), -1},
    {"colliders[1].half_length is -1", C(half_length), -1},
    {"of norm 1.00001", C(orientation[3]), 1.00001},
    {"of norm 0;", C(orientation[3]), 0},
    {"colliders[1].orientation is (NaN, 0, 0, 1), of norm NaN;", C(orientation[0]), -NAN},
    {"colliders[1].radius is 1e-39; it must be a normal number", C(radius), 1e-39},
    {"colliders[1].duration is -1; it must be at least 0", C(duration), -1},
    {"colliders[1].friction is -1; it must be at least 0", C(friction), -1},
    {"colliders[1].static_friction is -1", C(static_friction), -1},
    {"colliders[1].no_slip is 1.5; it must be from 0 to 1", C(no_slip), 1.5},
    {"colliders[1].no_slip is -0.1", C(no_slip), -0.1},
    {"colliders[1].adhesion is 1.5", C(adhesion), 1.5},
    {"colliders[1].adhesion is -0.1", C(adhesion), -0.1},
    {"colliders[1].axis has length 0", C(axis[1]), 0},
    {"colliders[1].axis[1] is", C(axis[1]), NAN},
};

static void colliders_by_table(void **state) {
  (void)state;
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 10);
  for (size_t i = 0; i < LENGTH(collider_reals); ++i) {
    pbf_collider two[2];
    for (int k = 0; k < 2; ++k)
      assert_ok(pbf_collider_init(&two[k], sizeof two[k], PBF_COLLIDER_CAPSULE));
    put_real(&two[1], collider_reals[i].offset, collider_reals[i].value);
    assert_fails(pbf_set_colliders(s, 2, two), PBF_ERROR_INVALID_ARGUMENT, collider_reals[i].words);
  }
  pbf_collider box;
  assert_ok(pbf_collider_init(&box, sizeof box, PBF_COLLIDER_BOX));
  box.half_extents[2] = 0;
  assert_fails(pbf_set_colliders(s, 1, &box), PBF_ERROR_INVALID_ARGUMENT, "half_extents[2] is 0");
  box.half_extents[2] = 1;
  box.radius = 0; /* not a box's business */
  assert_ok(pbf_set_colliders(s, 1, &box));
  const count_case counts[] = {{"colliders[0].shape is 5", C(shape), 5},
                               {"colliders[0].inverted is 2", C(inverted), 2},
                               {"colliders[0].path is 3", C(path), 3}};
  for (size_t i = 0; i < LENGTH(counts); ++i) {
    pbf_collider bad = box;
    put_count(&bad, counts[i].offset, counts[i].value);
    assert_fails(pbf_set_colliders(s, 1, &bad), PBF_ERROR_INVALID_ARGUMENT, counts[i].words);
  }
  assert_fails(pbf_set_colliders(s, PBF_MAX_COLLIDERS + 1, &box), PBF_ERROR_INVALID_ARGUMENT,
               "count is 4097; it must be at most 4096");
  assert_fails(pbf_collider_init(&box, sizeof box, 5), PBF_ERROR_INVALID_ARGUMENT, "shape is 5");
  uint32_t count = 0;
  assert_ok(pbf_get_collider_count(s, &count));
  assert_int_equal(count, 1);
  pbf_destroy(s);
}

/* Each number of a collider alone, of the second one of two. */
static void nothing_in_colliders_that_is_not_a_number(void **state) {
  (void)state;
  static const struct {
    const char *name;
    size_t offset;
    int components;
  } fields[] = {{"position", C(position), 3},
                {"orientation", C(orientation), 4},
                {"velocity", C(velocity), 3},
                {"angular_velocity", C(angular_velocity), 3},
                {"axis", C(axis), 3},
                {"half_extents", C(half_extents), 3},
                {"radius", C(radius), 1},
                {"half_length", C(half_length), 1},
                {"half_extents_rate", C(half_extents_rate), 3},
                {"radius_rate", C(radius_rate), 1},
                {"half_length_rate", C(half_length_rate), 1},
                {"duration", C(duration), 1},
                {"scale", C(scale), 1},
                {"scale_rate", C(scale_rate), 1},
                {"friction", C(friction), 1},
                {"static_friction", C(static_friction), 1},
                {"no_slip", C(no_slip), 1},
                {"adhesion", C(adhesion), 1}};
  const double values[] = {NAN, INFINITY, -INFINITY, 1e39};
  pbf_solver *s = test_solver(3, PBF_FLOAT32, 10);
  for (size_t f = 0; f < LENGTH(fields); ++f) {
    for (int c = 0; c < fields[f].components; ++c) {
      for (size_t v = 0; v < LENGTH(values); ++v) {
        pbf_collider two[2];
        uint32_t count = 9;
        char words[64];
        for (int k = 0; k < 2; ++k)
          assert_ok(pbf_collider_init(&two[k], sizeof two[k], PBF_COLLIDER_CAPSULE));
        put_real(&two[1], fields[f].offset + (size_t)c * sizeof(double), values[v]);
        snprintf(words, sizeof words, "colliders[1].%s", fields[f].name);
        assert_fails(pbf_set_colliders(s, 2, two), PBF_ERROR_INVALID_ARGUMENT, words);
        assert_ok(pbf_get_collider_count(s, &count));
        assert_int_equal(count, 0);
      }
    }
  }
  pbf_destroy(s);
}

static void descriptions_by_table(void **state) {
  (void)state;
#define D(member) offsetof(pbf_desc, member)
  static const count_case cases[] = {
      {"api_version is 0", D(api_version), 0},
      {"api_version is 1", D(api_version), 1}, /* whose parameters mean other things */
      {"api_version is 3", D(api_version), 3},
      {"dimension is 1; it must be 2 … 3", D(dimension), 1},
      {"dimension is 4", D(dimension), 4},
      {"precision is 2; it must be 4 (PBF_FLOAT32)", D(precision), 2},
      {"capacity is 0", D(capacity), 0},
      {"capacity is 1073741824", D(capacity), 0x40000000u},
      {"strict is 2", D(strict), 2},
      {"device is -1", D(device), UINT32_MAX},
      {"threads is 4294967295", D(threads), UINT32_MAX},
  };
  pbf_solver *none = NULL;
  for (size_t i = 0; i < LENGTH(cases); ++i) {
    pbf_desc desc = test_desc(3, PBF_FLOAT32, 10);
    put_count(&desc, cases[i].offset, cases[i].value);
    assert_fails(pbf_create(&desc, NULL, &none), PBF_ERROR_INVALID_ARGUMENT, cases[i].words);
  }
  pbf_desc desc = test_desc(3, PBF_FLOAT32, 10);
  desc.backend = "";
  assert_fails(pbf_create(&desc, NULL, &none), PBF_ERROR_INVALID_ARGUMENT, "desc.backend is \"\"");
  desc.backend = "a name that is longer than any name may be";
  assert_fails(pbf_create(&desc, NULL, &none), PBF_ERROR_INVALID_ARGUMENT, "1 … 31 characters");
  assert_null(none);
}

int main(void) {
  const struct CMUnitTest validation[] = {
      cmocka_unit_test(params_by_table),
      cmocka_unit_test(nothing_that_is_not_a_number),
      cmocka_unit_test(scorr_only_when_it_is_used),
      cmocka_unit_test(undamping_only_where_pushes_are_known),
      cmocka_unit_test(float32_has_its_limits),
      cmocka_unit_test(two_dimensions_ignore_the_third),
      cmocka_unit_test(colliders_by_table),
      cmocka_unit_test(nothing_in_colliders_that_is_not_a_number),
      cmocka_unit_test(descriptions_by_table),
  };
  return TEST_RUN(validation);
}
