/* How much the fluid holds together: `cohesion`, without and with which a block that flies apart, s
 * in a time unit of each length, stretches or holds together inside. */
#include "support.h"

#include <math.h>

static const double spacing = 0.05, time_step = 0.01, stretch = 0.2; /* s dt: 0.2 % a step */

static pbf_params params_of(double cohesion) {
  pbf_params p = test_params();
  p.spacing = spacing;
  p.smoothing_radius = 2 * spacing;
  p.time_step = time_step;
  p.iterations = 16;
  p.pressure_grid = 0;
  p.cohesion = cohesion;
  p.prestabilization = 0;
  for (int k = 0; k < 3; ++k) {
    p.gravity[k] = k == 1 ? -10 : 0;
    p.domain_min[k] = -4;
    p.domain_max[k] = 4;
  }
  return p;
}

/* A block of `size` particles, in the middle of everything. */
typedef struct block {
  uint32_t dimension, precision, count, size[3];
  pbf_solver *solver;
  void *x, *v;
} block;

static double place(const block *b, uint32_t i, uint32_t k) {
  for (uint32_t a = 0; a < k; ++a) i /= b->size[a];
  return spacing * (i % b->size[k] - 0.5 * (b->size[k] - 1));
}

static block block_of(uint32_t dimension, uint32_t precision, const uint32_t size[3],
                      double cohesion) {
  block b = {dimension, precision, 1, {size[0], size[1], size[2]}, NULL, NULL, NULL};
  for (uint32_t k = 0; k < dimension; ++k) b.count *= size[k];
  const pbf_params params = params_of(cohesion);
  const pbf_desc desc = test_desc(dimension, precision, b.count);
  b.solver = test_create(&desc, &params);
  b.x = calloc((size_t)b.count * dimension, precision);
  b.v = calloc((size_t)b.count * dimension, precision);
  for (uint32_t i = 0; i < b.count; ++i)
    for (uint32_t k = 0; k < dimension; ++k) {
      test_put(b.x, (uint64_t)i * dimension + k, precision, place(&b, i, k));
      test_put(b.v, (uint64_t)i * dimension + k, precision, stretch * place(&b, i, k));
    }
  assert_ok(pbf_add_particles(b.solver, b.count, b.x, b.v, NULL));
  return b;
}

static void destroy(block *b) {
  pbf_destroy(b->solver);
  free(b->x);
  free(b->v);
}

/* How much longer all within `reach` of the middle have become, in a step, by least squares over
 * their places about the block's own fall; *off is how far the one farthest from that is from it.
 */
static double stretched(block *b, double reach, double *off) {
  assert_ok(pbf_step(b->solver, 1));
  assert_ok(pbf_get_positions(b->solver, 0, b->count, b->x));
  double moved = 0, square = 0, fall = params_of(1).gravity[1] * time_step * time_step;
  *off = 0;
  for (int pass = 0; pass < 2; ++pass)
    for (uint32_t i = 0; i < b->count; ++i) {
      double r2 = 0;
      for (uint32_t k = 0; k < b->dimension; ++k) r2 += place(b, i, k) * place(b, i, k);
      for (uint32_t k = 0; k < b->dimension && r2 < reach * reach; ++k) {
        double at = place(b, i, k);
        double way = test_value(b->x, (uint64_t)i * b->dimension + k, b->precision) - at;
        if (k == 1) way -= fall;
        if (pass == 0) moved += way * at, square += at * at;
        if (pass == 1) *off = fmax(*off, fabs(way - moved / square * at));
      }
    }
  return moved / square;
}

static void check_inside(uint32_t dimension, uint32_t precision) {
  const uint32_t size[3] = {16, 16, 16};
  double kept[2], off, part = stretch * time_step;
  for (int cohesion = 0; cohesion < 2; ++cohesion) {
    block b = block_of(dimension, precision, size, cohesion);
    kept[cohesion] = stretched(&b, 4 * spacing, &off);
    destroy(&b);
  }
  if (!(fabs(kept[0] - part) < 1e-3 * part && fabs(kept[1]) < 0.25 * part))
    fail_msg("%uD: stretched by %g (%g in free flight), held together by %g", dimension, kept[0],
             part, kept[1]);
}

/* Two layers are all surface, and fly on, with full cohesion, too. */
static void check_film(uint32_t dimension, uint32_t precision) {
  const uint32_t size[3] = {2, 12, 12};
  const double rounding = precision == PBF_FLOAT32 ? 1e-6 : 1e-13, part = stretch * time_step;
  double off;
  block b = block_of(dimension, precision, size, 1);
  double parted = stretched(&b, 100, &off);
  destroy(&b);
  if (!(fabs(parted - part) < rounding / spacing && off < rounding))
    fail_msg("%uD: a film parts by %g instead of %g, unevenly by %g", dimension, parted, part, off);
}

static void fluid_inside_holds_together(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub has no pairs");
  test_for_long_kinds(check_inside);
}

static void films_part_freely(void **state) {
  (void)state;
  if (test_is_stub()) test_skip("the stub has no pairs");
  test_for_long_kinds(check_film);
}

int main(void) {
  const struct CMUnitTest parting[] = {
      cmocka_unit_test(fluid_inside_holds_together),
      cmocka_unit_test(films_part_freely),
  };
  return TEST_RUN(parting);
}
