/* What solids contribute to the particles of a group, and which of them meet none on their ways,
 * found in the lanes of one instruction set, against each particle by itself, to the bit. Compiled
 * once for each set, and skipped where the machine lacks it. */
#include "cpu/solid_scenes.h"

static bool are_same(pbf_real a, pbf_real b) { return a == b; }

/* Returns how many some surface contributes to. */
static int check_boundary(const scene *s, int which, const lane_values *x,
                          const lanes_asked *asked) {
  lane_boundary found;
  int beside = 0;
  boundary_of_group(&s->constants, &s->o, x, asked, &found);
  for (uint32_t l = 0; l < WIDTH; ++l) {
    pbf_real density = 0;
    pbf_vec gradient = {{0}};
    const pbf_boundary right = pbf_boundary_at(&s->constants, s->o, lane_value(x, l));
    pbf_add_boundary(&right, &density, &gradient);
    bool same = are_same(found.density[l], density) && are_same(found.rest[l], right.rest);
    for (int a = 0; a < PBF_DIM; ++a)
      same = same && are_same(found.gradient.c[a][l], gradient.c[a]);
    if (!same)
      fail_msg("scene %d: lane %u has a density of %.9g, not %.9g", which, l,
               (double)found.density[l], (double)density);
    beside += density > 0;
  }
  return beside;
}

static void a_group_has_what_each_particle_has(void **state) {
  (void)state;
  static scene s;
  uint64_t random = 1;
  int beside = 0;
  for (int k = 0; k < scenes(); ++k) {
    make_scene(&random, k, &s);
    const lane_values x = random_places(&random);
    beside += check_boundary(&s, k, &x, NULL);
  }
  assert_true(beside > scenes() / 4);
}

/* Some way on, those that were clear of all solids and have not gone far are not asked. */
static void those_that_stay_clear_need_not_be_asked(void **state) {
  (void)state;
  static scene s;
  uint64_t random = 3;
  int all = 0, some = 0;
  for (int k = 0; k < scenes(); ++k) {
    alignas(64) pbf_real ways[WIDTH];
    make_scene(&random, k, &s);
    const lane_values from = random_places(&random);
    lane_values x = from;
    find_clear(&s.constants, &s.o, &from, ways);
    for (uint32_t l = 0; l < WIDTH; ++l) {
      if (ways[l] < clear_reach(&s.constants)) ways[l] = 0;
      for (int a = 0; a < PBF_DIM; ++a) x.c[a][l] += (pbf_real)random_in(&random, -0.06, 0.06);
      ways[l] = pbf_real_min(ways[l], clear_way(&s.constants));
    }
    const lanes_asked asked = lanes_beyond(ways, &from, &x);
    check_boundary(&s, k, &x, &asked);
    for (uint32_t l = 0; l < WIDTH; ++l) ++all, some += !asked.is[l];
  }
  assert_true(some > all / 20 && some < all);
}

static void what_is_clear_goes_where_the_domain_keeps_it(void **state) {
  (void)state;
  static scene s;
  uint64_t random = 2;
  int clear_ones = 0, met = 0;
  for (int k = 0; k < scenes(); ++k) {
    lane_marks clear;
    make_scene(&random, k, &s);
    const lane_values from = random_places(&random);
    lane_values x = from;
    for (int a = 0; a < PBF_DIM; ++a)
      for (uint32_t l = 0; l < WIDTH; ++l) x.c[a][l] += (pbf_real)random_in(&random, -0.2, 0.2);
    lane_values kept = x;
    clamp_group(&s.o, &kept);
    const int moves = k % 2;
    if (!find_clear_lanes(&s.o, moves, &from, &x, &kept, &clear)) continue;
    for (uint32_t l = 0; l < WIDTH; ++l) {
      const pbf_vec end =
          pbf_resolve_collisions(s.o, moves, lane_value(&from, l), lane_value(&x, l));
      const pbf_vec right = lane_value(&kept, l);
      const bool stays = memcmp(&end, &right, sizeof end) == 0;
      if (clear.is[l] > 0 && !stays) fail_msg("scene %d: lane %u is not clear", k, l);
      clear_ones += clear.is[l] > 0;
      met += !stays;
    }
  }
  assert_true(clear_ones > scenes() / 4 && met > scenes() / 100);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_group_has_what_each_particle_has),
      cmocka_unit_test(those_that_stay_clear_need_not_be_asked),
      cmocka_unit_test(what_is_clear_goes_where_the_domain_keeps_it),
  };
  return run_on_this_machine(tests, sizeof tests / sizeof *tests);
}
