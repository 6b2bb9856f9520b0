/* How deep water can stand between solids, by where they are: the answers are those of a drawing.
 */
#include "support.h"

#include "physics/separate_solids.h"
#include "physics/groups.h"

namespace {

/* A domain of 10 in each direction, of gravity along y, and water that passes gaps of 0.2. */
pbf_params params_of() {
  pbf_params params;
  memset(&params, 0, sizeof params);
  for (int k = 0; k < 3; ++k) params.domain_max[k] = 10;
  params.gravity[1] = -1;
  params.smoothing_radius = 0.1;
  return params;
}

pbf_collider ball(double x, double y, double radius) {
  pbf_collider c;
  memset(&c, 0, sizeof c);
  c.shape = PBF_COLLIDER_SPHERE;
  c.orientation[3] = 1;
  c.position[0] = x;
  c.position[1] = y;
  c.position[2] = 5;
  c.radius = radius;
  return c;
}

/* From the lower corner to the upper one. */
pbf_collider box(double x0, double y0, double z0, double x1, double y1, double z1) {
  const double lower[3] = {x0, y0, z0}, upper[3] = {x1, y1, z1};
  pbf_collider c = ball(0, 0, 0);
  c.shape = PBF_COLLIDER_BOX;
  for (int k = 0; k < 3; ++k) {
    c.position[k] = (lower[k] + upper[k]) / 2;
    c.half_extents[k] = (upper[k] - lower[k]) / 2;
  }
  return c;
}

pbf_collider floor_at(double y, double aslant) {
  pbf_collider c = ball(5, y, 0);
  c.shape = PBF_COLLIDER_PLANE;
  c.axis[0] = aslant;
  c.axis[1] = 1;
  return c;
}

template <uint32_t N>
double deepest(const pbf_collider (&colliders)[N]) {
  const pbf_params params = params_of();
  pbf_surface surfaces[N];
  for (uint32_t k = 0; k < N; ++k) surfaces[k] = pbf_surface_at(&colliders[k], 0, 0);
  static pbf_group groups[PBF_FEW_COLLIDERS];
  static uint16_t numbers[PBF_FEW_COLLIDERS];
  const double depth = pbf_groups_deepest(&params, N, colliders, surfaces, 1, groups, numbers);
  assert_false(pbf_solids_are_apart(&params, N, colliders, 1) && depth > 0);
  return depth;
}

void expect(double found, double right) {
  if (!(fabs(found - right) < 1e-6 * right || found == right))
    fail_msg("%g instead of %g", found, right);
}

void what_encloses_nothing(void **) {
  expect(deepest({ball(5, 5, 1)}), 0);
  expect(deepest({ball(5, 1, 1)}), 0); /* on the floor */
  expect(deepest({ball(2, 5, 1), ball(5, 5, 1), ball(8, 5, 1)}), 0);
  expect(deepest({ball(3, 5, 1), ball(5.3, 5, 1)}), 0); /* apart by more than 0.2 */
  expect(deepest({box(4, 0, 4, 6, 9, 6)}), 0);
}

/* Where it is known without their poses it is right, and it is known of most that are apart. */
void what_is_surely_apart(void **) {
  enum { SOLIDS = 6, DRAWS = 20000 };
  int apart = 0, known = 0;
  uint32_t draw = 1;
  const auto next = [&](double from, double to) {
    draw = draw * 1664525u + 1013904223u; /* Knuth and Lewis */
    return from + (to - from) * (draw / 4294967296.0);
  };
  for (int k = 0; k < DRAWS; ++k) {
    pbf_collider all[SOLIDS];
    for (pbf_collider &c : all) {
      const double x = next(0, 10), y = next(0, 10), z = next(0, 10), r = next(0.05, 0.5);
      c = ball(x, y, r);
      if (next(0, 1) < 0.5) c = box(x - r, y - r / 2, z - r / 3, x + r, y + r / 2, z + r / 3);
      c.position[2] = z;
      c.orientation[2] = next(-1, 1);
      c.orientation[3] = sqrt(1 - c.orientation[2] * c.orientation[2]);
    }
    const pbf_params params = params_of();
    apart += !(deepest({all[0], all[1], all[2], all[3], all[4], all[5]}) > 0);
    known += pbf_solids_are_apart(&params, SOLIDS, all, 1);
  }
  assert_true(apart > DRAWS / 4 && known > apart / 2 && known <= apart);
}

/* As high as its bounds, and the gap on both sides. */
void what_lies_within_its_bounds(void **) {
  expect(deepest({ball(3, 3, 1), ball(5.1, 4, 1)}), 3.2);
  expect(deepest({ball(1, 1, 1)}), 2.2); /* in a corner */
  expect(deepest({ball(3, 3, 1), ball(8, 5, 1), box(3.5, 3, 4, 7.5, 4, 6)}), 4.2);
  expect(deepest({ball(3, 3, 1), ball(5.1, 4, 1), ball(8, 8, 1), ball(8, 6.1, 1)}), 4.1);
}

/* A gate in 2D is a bridge in 3D. */
void what_parts_the_domain(void **) {
  expect(deepest({box(0, 4, 4, 10, 6, 6)}), PBF_DIM == 2 ? HUGE_VAL : 2.2);
  expect(deepest({box(4, 0, 0, 6, 10, 10)}), HUGE_VAL);
  expect(deepest({box(0, 4, 0, 5, 6, 10), box(5.1, 4, 0, 10, 6, 10)}), HUGE_VAL);
}

/* What stands on the floor, and leaves three quarters of it or less. */
void what_takes_room(void **) {
  expect(deepest({box(4, 0, 0.5, 7, 9, 9.5)}), HUGE_VAL); /* 3 by 9 of 10 by 10 */
  expect(deepest({box(4, 0, 0.5, 6.4, 9, 9.5)}), 0);
  expect(deepest({box(4, 1, 0.5, 7, 9, 9.5)}), 0); /* hangs */
  expect(deepest({ball(2, 1, 1), ball(8, 1, 1)}), PBF_DIM == 2 ? HUGE_VAL : 0);
  expect(deepest({box(4, 3, 0.5, 7, 9, 9.5), floor_at(3.05, 0)}), HUGE_VAL);
}

void before_planes(void **) {
  expect(deepest({ball(5, 5, 1), floor_at(4, 0)}), 0);
  expect(deepest({ball(1, 5, 1), floor_at(4, 0)}), 2.2);
  expect(deepest({box(4, 2, 0, 6, 10, 10), floor_at(2.05, 0)}), HUGE_VAL);
  expect(deepest({ball(5, 8, 1), floor_at(4, 0.1)}), 0);
  expect(deepest({ball(5, 5, 1), floor_at(4, 0.1)}), HUGE_VAL); /* beside an oblique one */
}

void in_containers(void **) {
  pbf_collider around = box(1, 1, 1, 9, 9, 9);
  around.inverted = 1;
  expect(deepest({ball(5, 5, 1), around}), 0);
  expect(deepest({ball(2, 5, 1), around}), HUGE_VAL);
}

}  // namespace

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_encloses_nothing),
      cmocka_unit_test(what_is_surely_apart),
      cmocka_unit_test(what_lies_within_its_bounds),
      cmocka_unit_test(what_parts_the_domain),
      cmocka_unit_test(what_takes_room),
      cmocka_unit_test(before_planes),
      cmocka_unit_test(in_containers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
