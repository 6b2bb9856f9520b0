/* What solids take of particles and of the pressure around points of a grid, found in the lanes of
 * one instruction set, against each particle and each point by itself: the same integers. Compiled
 * once for each set, and skipped where the machine lacks it. */
#include "cpu/kernels_grid_loads.h"

#include "cpu/solid_scenes.h"

enum { SOLIDS = PBF_WALLS + MOST, RANGE = 16 };

/* Sums of all solids. */
typedef struct all_sums {
  pbf_load_measure measures[SOLIDS];
  pbf_load_sums of[SOLIDS];
  int last; /* solid that the present particle has touched */
} all_sums;

static load_slot slot_of(void *sums, int solid) {
  all_sums *all = static_cast<all_sums *>(sums);
  return {&all->of[solid], &all->measures[solid]};
}

static pbf_load_scales some_scales(void) {
  pbf_load_scales scales;
  memset(&scales, 0, sizeof scales);
  scales.velocity = pbf_units_of_velocity(10);
  scales.spacing = h / 2;
  scales.reach = h;
  scales.by_lambda = 0.7;
  scales.mass = 0.1;
  scales.time_step = 0.01;
  return scales;
}

static void clear_sums(const scene *s, const pbf_load_scales *scales, all_sums *sums) {
  memset(sums, 0, sizeof *sums);
  for (int solid = 0; solid < PBF_WALLS + s->o.count; ++solid)
    sums->measures[solid] = load_measure_of(scales, s->o, solid);
}

/* Returns how many of the sums of colliders are not 0. */
static int assert_same_sums(int which, const all_sums *found, const all_sums *right) {
  int some = 0;
  for (int solid = 0; solid < SOLIDS; ++solid) {
    const pbf_load_sums *a = &found->of[solid], *b = &right->of[solid];
    if (memcmp(a, b, sizeof *a) != 0) fail_msg("scene %d: solid %d has other sums", which, solid);
    for (int k = 0; k < PBF_LOAD_SUMS; ++k)
      some += solid >= PBF_WALLS && (b->of[k].high != 0 || b->of[k].low != 0);
  }
  return some;
}

/* All of a scene's colliders are asked of. */
static void list_all(const scene *s, uint16_t numbers[MOST]) {
  for (int k = 0; k < s->o.count; ++k) numbers[k] = (uint16_t)k;
}

/* ---- Particles ------------------------------------------------------------------------------- */

typedef struct particles {
  alignas(64) pbf_real x[PBF_DIM][2 * RANGE], v[PBF_DIM][2 * RANGE], push[PBF_DIM][2 * RANGE];
  alignas(64) pbf_real lambda[2 * RANGE], mobility[2 * RANGE];
} particles;

/* Some of them are pushed by nothing. */
static void random_particles(uint64_t *random, particles *p) {
  for (int k = 0; k < PBF_DIM; ++k) {
    const double middle = random_in(random, -around, around);
    for (uint32_t i = 0; i < 2 * RANGE; ++i) {
      const bool pushed = random_in(random, 0, 1) < 0.8;
      p->x[k][i] = (pbf_real)(middle + random_in(random, -0.9, 0.9));
      p->v[k][i] = (pbf_real)random_in(random, -1, 1);
      p->push[k][i] = (pbf_real)(pushed ? random_in(random, -1, 1) : 0);
    }
  }
  for (uint32_t i = 0; i < 2 * RANGE; ++i) {
    p->lambda[i] = (pbf_real)random_in(random, -1, 0);
    p->mobility[i] = (pbf_real)random_in(random, 0.5, 2);
  }
}

static field field_of(pbf_real of[PBF_DIM][2 * RANGE]) {
  field f;
  for (int k = 0; k < PBF_DIM; ++k) f.c[k] = of[k];
  return f;
}

static void share_one(const scene *s, const load_pass *p, uint32_t i, all_sums *sums) {
  load_particle of = {field_at(&p->x, i), field_at(&p->v, i), field_at(&p->push, i), p->lambda[i],
                      false};
  if (p->mobility) of = with_mass(of, p->mobility[i]);
  sums->last = -1;
  share_push(
      &s->constants, p->scales, s->o, all_surfaces(), of, [] { return (pbf_real)0; },
      [&](const pbf_load_plane &plane, const load_share &share) {
        const pbf_load_measure &m = sums->measures[plane.solid];
        const load_numbers part = load_numbers_of(p->scales, m, of.x, plane, share);
        add_numbers(&sums->of[plane.solid], m, part, part.touches && plane.solid != sums->last);
        if (part.touches) sums->last = plane.solid;
      });
}

static void solids_take_of_a_range_what_they_take_of_each(void **state) {
  (void)state;
  static scene s;
  static particles all;
  static all_sums found, right;
  uint64_t random = 5;
  uint16_t near[MOST];
  int some = 0, in_lanes = 0;
  for (int k = 0; k < scenes(); ++k) {
    make_scene(&random, k, &s);
    random_particles(&random, &all);
    list_all(&s, near);
    const pbf_load_scales scales = some_scales();
    const load_pass pass = {&s.constants,    &s.o,
                            &scales,         slot_of,
                            &found,          field_of(all.x),
                            field_of(all.v), field_of(all.push),
                            all.lambda,      k % 3 ? NULL : all.mobility};
    const uint32_t last = RANGE + (uint32_t)random_in(&random, 1, RANGE + 1);
    pbf_wide_sum change[PBF_DIM] = {};
    clear_sums(&s, &scales, &found);
    clear_sums(&s, &scales, &right);
    uint32_t left = loads(&pass, near, s.o.count, RANGE, last, change);
    for (uint32_t i = RANGE; i < last; ++i, left >>= 1) {
      share_one(&s, &pass, i, &right);
      if (left & 1) share_one(&s, &pass, i, &found);
      in_lanes += !(left & 1);
    }
    some += assert_same_sums(k, &found, &right);
  }
  assert_true(some > scenes() && in_lanes > 2 * scenes());
}

/* ---- Points of a grid ------------------------------------------------------------------------ */

/* Of which no solid is thin: there are no compartments. */
static void make_grid(const scene *s, uint64_t *random, pbf_pressure_grid_storage *storage) {
  pbf_params p = test_params(PBF_KERNEL_WENDLAND_C2);
  p.smoothing_radius = h;
  p.spacing = h / 2;
  p.pressure_grid = 2;
  for (int k = 0; k < 3; ++k) p.domain_min[k] = -around, p.domain_max[k] = around;
  memset(storage, 0, sizeof *storage);
  storage->grid = pbf_pressure_grid_between(&p, &s->o.domain, 0, 1 << 20);
  storage->carried = 1;
  storage->lambda = static_cast<double *>(calloc(storage->grid.nodes, sizeof(double)));
  assert_non_null(storage->lambda);
  for (uint32_t node = 0; node < storage->grid.nodes; ++node)
    storage->lambda[node] = random_in(random, -1, 0.2);
}

static void press_on_one(const scene *s, const grid_load_pass *p, pbf_vec x, all_sums *sums) {
  share_grid_pressure_around(
      p->scales, p->cubes, s->o, all_surfaces(), x,
      [&](pbf_vec at, double slope[]) {
        return pbf_pressure_grid_pressure(p->storage, p->scales->time_step, at, p->cubes.part,
                                          slope);
      },
      [&](const pbf_load_plane &plane, pbf_vec at, const load_share &share) {
        const pbf_load_measure &m = sums->measures[plane.solid];
        add_numbers(&sums->of[plane.solid], m,
                    without_wet(load_numbers_of(p->scales, m, at, plane, share)), false);
      });
}

static void a_grid_presses_around_points_as_around_each(void **state) {
  (void)state;
  static scene s;
  static all_sums found, right;
  static pbf_pressure_grid_storage storage;
  uint64_t random = 6;
  uint16_t near[MOST];
  int some = 0, in_lanes = 0;
  for (int k = 0; k < scenes(); ++k) {
    make_scene(&random, k, &s);
    list_all(&s, near);
    make_grid(&s, &random, &storage);
    const pbf_load_scales scales = some_scales();
    const grid_load_pass pass = {&storage, &s.o,   &scales,
                                 slot_of,  &found, grid_load_cubes_of(&scales, &storage.grid)};
    lane_values x = random_places(&random);
    const uint32_t count = 1 + (uint32_t)random_in(&random, 0, WIDTH);
    field at;
    for (int a = 0; a < PBF_DIM; ++a) at.c[a] = x.c[a];
    clear_sums(&s, &scales, &found);
    clear_sums(&s, &scales, &right);
    const int done = grid_loads(&pass, near, s.o.count, at, count);
    for (uint32_t l = 0; l < count && done; ++l) press_on_one(&s, &pass, lane_value(&x, l), &right);
    some += assert_same_sums(k, &found, &right);
    in_lanes += done;
    free(storage.lambda);
  }
  assert_true(some > scenes() && in_lanes > scenes() / 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(solids_take_of_a_range_what_they_take_of_each),
      cmocka_unit_test(a_grid_presses_around_points_as_around_each),
  };
  return run_on_this_machine(tests, sizeof tests / sizeof *tests);
}
