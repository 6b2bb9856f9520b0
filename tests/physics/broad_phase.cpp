/* Colliders that a group of particles is said not to meet leave each of them as it is, to the bit,
 * and lend it nothing. */
#include "support.h"

#include "cpu/kernels_collide.h"
#include "physics/listed_surfaces.h"
#include "support/amount.h"
#include "support/random.h"

enum { PARTICLES = 6, MOST = 100 };

/* Drawn at random: more of them find what is rarer. */
static int scenes() { return test_is_long() ? 20000 : TEST_INSTRUMENTED ? 1000 : 4000; }
static int scenes_of_many() { return scenes() / (test_is_long() ? 10 : 20); }

/* Some surfaces, and room for what is asked of them. */
typedef struct crowd {
  pbf_surface surfaces[MOST];
  pbf_obstacles o;
  pbf_surface_grid grid;
  pbf_surface_box boxes[MOST];
  uint32_t starts[PBF_CELLS_A_SURFACE * MOST + 65];
  uint16_t entries[PBF_ENTRIES_A_SURFACE * MOST], room[PBF_OBSTACLE_LISTS * MOST];
} crowd;

static void begin_crowd(crowd *s, int count) {
  s->o.count = count;
  s->o.surfaces = {s->surfaces, NULL};
  s->o.grid = NULL;
  s->o.room = s->room;
}

/* Lets its grid tell which are near, within that reach. */
static void add_grid(crowd *s, pbf_real reach) {
  s->grid.boxes = s->boxes;
  s->grid.starts = s->starts;
  s->grid.entries = s->entries;
  s->grid.room = MOST;
  for (int k = 0; k < s->o.count; ++k) s->boxes[k] = pbf_surface_box_of(&s->surfaces[k]);
  pbf_grid_build(&s->grid, (uint32_t)s->o.count, &s->o.domain, (double)reach);
  s->o.grid = &s->grid;
}

static pbf_vec random_vec(uint64_t *state, double size) {
  pbf_vec a;
  for (int k = 0; k < PBF_DIM; ++k) a.c[k] = (pbf_real)random_in(state, -size, size);
  return a;
}

/* Of the size of the group's way and distance, so that every other one is met. */
static pbf_surface random_surface(uint64_t *state) {
  pbf_collider c;
  double norm2 = 0;
  memset(&c, 0, sizeof c);
  c.shape = (uint32_t)random_in(state, 0, 4);
  c.inverted = random_in(state, 0, 1) < 0.3;
  c.radius = random_in(state, 0.05, 1.5);
  c.half_length = random_in(state, 0.05, 1);
  c.axis[1] = 1;
  for (int k = 0; k < PBF_DIM; ++k) {
    c.half_extents[k] = random_in(state, 0.01, 1.5);
    c.position[k] = random_in(state, -2, 2);
    c.velocity[k] = random_in(state, 0, 1) < 0.5 ? random_in(state, -2, 2) : 0;
  }
  for (int k = PBF_DIM == 3 ? 0 : 2; k < 4; ++k) {
    c.orientation[k] = random_in(state, -1, 1);
    norm2 += c.orientation[k] * c.orientation[k];
  }
  for (int k = 0; k < 4; ++k) c.orientation[k] /= sqrt(norm2);
  if (random_in(state, 0, 1) < 0.5) c.angular_velocity[2] = random_in(state, -3, 3);
  pbf_surface s = pbf_surface_at(&c, 0, 1);
  s.skin = pbf_surface_is_unbounded(&s) ? 0 : (pbf_real)0.02;
  return s;
}

typedef struct group {
  pbf_vec from[PARTICLES], x[PARTICLES];
  group_bounds around;
} group;

static group random_group(uint64_t *state) {
  group g;
  double spread = random_in(state, 0, 0.5), speed = random_in(state, 0, 1);
  pbf_vec way = random_vec(state, speed), lower, upper;
  pbf_real longest2 = 0;
  for (int i = 0; i < PARTICLES; ++i) {
    g.from[i] = random_vec(state, spread);
    g.x[i] = pbf_add_scaled(pbf_add_scaled(g.from[i], 1, way), 1, random_vec(state, 0.1 * speed));
    pbf_vec move = pbf_sub(g.x[i], g.from[i]);
    longest2 = pbf_real_max(longest2, pbf_dot(move, move));
    for (int k = 0; k < PBF_DIM; ++k) {
      if (i == 0) lower.c[k] = upper.c[k] = g.x[0].c[k];
      lower.c[k] = pbf_real_min(lower.c[k], pbf_real_min(g.x[i].c[k], g.from[i].c[k]));
      upper.c[k] = pbf_real_max(upper.c[k], pbf_real_max(g.x[i].c[k], g.from[i].c[k]));
    }
  }
  g.around = bounds_between(lower, upper, pbf_real_sqrt(longest2));
  return g;
}

static void what_is_not_met_does_nothing(void **state) {
  (void)state;
  uint64_t random = 1;
  pbf_domain domain;
  int met[2] = {0, 0}, all[2] = {0, 0};
  for (int k = 0; k < PBF_DIM; ++k) domain.lower.c[k] = -100, domain.upper.c[k] = 100;
  domain.bounce_depth = (pbf_real)0.1;
  for (int scene = 0; scene < scenes(); ++scene) {
    static crowd c;
    const pbf_obstacles &o = c.o;
    begin_crowd(&c, 1);
    c.o.domain = domain;
    c.surfaces[0] = random_surface(&random);
    if (scene % 2) add_grid(&c, (pbf_real)0.1);
    group g = random_group(&random);
    for (int with_obstacle_motion = 0; with_obstacle_motion < 2; ++with_obstacle_motion) {
      pbf_obstacles near;
      ++all[with_obstacle_motion];
      if (collision_candidates(&o, &g.around, with_obstacle_motion, &near)) {
        ++met[with_obstacle_motion];
        continue;
      }
      for (int i = 0; i < PARTICLES; ++i) {
        pbf_vec after = pbf_resolve_collisions(o, with_obstacle_motion, g.from[i], g.x[i]);
        if (memcmp(&after, &g.x[i], sizeof after) != 0)
          fail_msg("scene %d: a shape %d that is not met moves a particle", scene,
                   c.surfaces[0].shape);
      }
    }
  }
  for (int with_obstacle_motion = 0; with_obstacle_motion < 2; ++with_obstacle_motion)
    if (!(met[with_obstacle_motion] > all[with_obstacle_motion] / 20 &&
          met[with_obstacle_motion] < all[with_obstacle_motion] * 19 / 20))
      fail_msg("%d of %d are met", met[with_obstacle_motion], all[with_obstacle_motion]);
}

/* Pushes of every size, skins, and a domain whose walls have moved in. */
static void make_crowd(uint64_t *state, int count, crowd *s) {
  static const pbf_real pushes[] = {0, (pbf_real)0.1, (pbf_real)0.5, (pbf_real)INFINITY};
  begin_crowd(s, count);
  s->o.domain.bounce_depth = (pbf_real)0.1;
  for (int k = 0; k < PBF_DIM; ++k) {
    s->o.domain.lower.c[k] = (pbf_real)random_in(state, -2, 0);
    s->o.domain.upper.c[k] = (pbf_real)random_in(state, 0.2, 2);
  }
  for (int k = 0; k < count; ++k) {
    s->surfaces[k] = random_surface(state);
    s->surfaces[k].prediction_push = pushes[(int)random_in(state, 0, 4)];
    s->surfaces[k].iteration_push = pushes[(int)random_in(state, 0, 4)];
  }
}

/* Many small ones, which push little, and now and then one without an end. */
static void make_small_crowd(uint64_t *state, crowd *s) {
  make_crowd(state, MOST, s);
  for (int k = 0; k < MOST; ++k) {
    while (!((double)s->surfaces[k].bound < 0.4) && random_in(state, 0, 1) < 0.999)
      s->surfaces[k] = random_surface(state);
    s->surfaces[k].prediction_push = k % 4 ? 0 : (pbf_real)0.05;
    s->surfaces[k].iteration_push = k % 3 ? 0 : (pbf_real)0.05;
  }
}

/* The number that are left out. */
static int check_resolved(const crowd *s, const group *g, int with_obstacle_motion, int which) {
  pbf_obstacles near;
  collision_candidates(&s->o, &g->around, with_obstacle_motion, &near);
  for (int i = 0; i < PARTICLES; ++i) {
    const pbf_vec by_all = pbf_resolve_collisions(s->o, with_obstacle_motion, g->from[i], g->x[i]);
    const pbf_vec by_near = pbf_resolve_collisions(near, with_obstacle_motion, g->from[i], g->x[i]);
    if (memcmp(&by_all, &by_near, sizeof by_all) != 0)
      fail_msg("scene %d: %d of %d surfaces move a particle elsewhere", which, near.count,
               s->o.count);
  }
  return s->o.count - near.count;
}

/* One may push a particle into another, and that into a third. */
static void the_surfaces_left_out_change_nothing(void **state) {
  (void)state;
  static crowd s;
  uint64_t random = 3;
  int left_out = 0;
  for (int scene = 0; scene < scenes(); ++scene) {
    make_crowd(&random, 1 + (int)random_in(&random, 0, 6), &s);
    const group g = random_group(&random);
    for (int with_obstacle_motion = 0; with_obstacle_motion < 2; ++with_obstacle_motion)
      left_out += check_resolved(&s, &g, with_obstacle_motion, scene) > 0;
  }
  assert_true(left_out > scenes() / 20);
}

/* Of many, what a grid leaves out before. Some turn, some have no end. */
static void a_grid_leaves_out_no_more(void **state) {
  (void)state;
  static crowd s;
  uint64_t random = 5;
  int64_t left_out = 0, all = 0, cells = 0;
  for (int scene = 0; scene < scenes_of_many(); ++scene) {
    make_small_crowd(&random, &s);
    add_grid(&s, (pbf_real)0.1);
    for (int k = 0, more = 1; k < PBF_DIM; ++k) cells += (more *= s.grid.cells[k]) > 1;
    const group g = random_group(&random);
    for (int with_obstacle_motion = 0; with_obstacle_motion < 2; ++with_obstacle_motion) {
      left_out += check_resolved(&s, &g, with_obstacle_motion, scene);
      all += MOST;
    }
  }
  assert_true(cells > scenes_of_many() / 2);
  if (!(left_out > all / 20)) fail_msg("%d of %d are left out", (int)left_out, (int)all);
}

/* Particles that look for themselves, as on a GPU; how many of them something has moved. */
static int check_listed(const crowd *s, const group *g, int with_obstacle_motion, int which) {
  int moved = 0;
  for (int i = 0; i < PARTICLES; ++i) {
    const pbf_vec from = g->from[i], x = g->x[i], kept = pbf_keep_in_domain(&s->o.domain, x);
    const pbf_vec by_all = pbf_resolve_collisions(s->o, with_obstacle_motion, from, x);
    const pbf_vec by_listed =
        resolve_among_listed(&s->o.domain, s->surfaces, &s->grid, with_obstacle_motion, from, x);
    if (memcmp(&by_all, &by_listed, sizeof by_all) != 0)
      fail_msg("scene %d: those of a list move particle %d elsewhere", which, i);
    moved += memcmp(&by_all, &kept, sizeof by_all) != 0;
  }
  return moved;
}

/* And on a CPU, where it asks first for those that it may be the first to meet. */
static void those_that_are_met_first_are_enough(void **state) {
  (void)state;
  static crowd s;
  uint64_t random = 11;
  int moved = 0;
  for (int scene = 0; scene < 10 * scenes_of_many(); ++scene) {
    make_small_crowd(&random, &s);
    add_grid(&s, (pbf_real)0.1);
    const group g = random_group(&random);
    for (int i = 0; i < PARTICLES; ++i) {
      const pbf_vec from = g.from[i], x = g.x[i], kept = pbf_keep_in_domain(&s.o.domain, x);
      const pbf_vec by_all = pbf_resolve_collisions(s.o, scene % 2, from, x);
      const pbf_vec alone = resolve_alone(&s.o, scene % 2, from, x);
      if (memcmp(&by_all, &alone, sizeof by_all) != 0)
        fail_msg("scene %d: those met first move particle %d elsewhere", scene, i);
      moved += memcmp(&by_all, &kept, sizeof by_all) != 0;
    }
  }
  assert_true(moved > scenes_of_many());
}

static pbf_surface placed_surface(uint32_t shape, double radius, double y) {
  pbf_collider c;
  memset(&c, 0, sizeof c);
  c.shape = shape;
  c.radius = radius;
  c.axis[1] = c.orientation[3] = 1;
  c.position[1] = y;
  return pbf_surface_at(&c, 0, 1);
}

/* What has been found 0.3 behind a plane is given back half of that before it, at 0.15, where there
 * is a ball of 0.05: 0.4 from where it began. */
static void what_a_plane_gives_back_meets_a_ball(void **state) {
  (void)state;
  static crowd s;
  begin_crowd(&s, MOST);
  for (int k = 0; k < PBF_DIM; ++k) s.o.domain.lower.c[k] = -3, s.o.domain.upper.c[k] = 3;
  s.o.domain.bounce_depth = (pbf_real)0.5;
  for (int k = 0; k < MOST; ++k)
    s.surfaces[k] = placed_surface(PBF_COLLIDER_SPHERE, 0.05, k ? 2.5 : 0.15);
  s.surfaces[1] = placed_surface(PBF_COLLIDER_PLANE, 0, 0);
  for (int k = 0; k < MOST; ++k) s.surfaces[k].prediction_push = (pbf_real)INFINITY;
  add_grid(&s, (pbf_real)0.02);
  pbf_vec x = {{0}}, normal;
  x.c[1] = (pbf_real)-0.3;
  const pbf_vec end = resolve_alone(&s.o, 1, x, x);
  assert_true(end.c[1] > 0);
  if (!(pbf_surface_distance(&s.surfaces[0], end, &normal) > -1e-6))
    fail_msg("it is left at %g, in the ball", (double)end.c[1]);
}

/* Of narrow cells and wide ones, on ways through one cell and through many. */
static void one_by_one_it_leaves_out_no_more(void **state) {
  (void)state;
  static crowd s;
  uint64_t random = 7;
  int moved = 0, all = 0;
  for (int scene = 0; scene < scenes_of_many(); ++scene) {
    make_small_crowd(&random, &s);
    add_grid(&s, (pbf_real)(scene % 2 ? 0.02 : 0.3));
    const group g = random_group(&random);
    for (int with_obstacle_motion = 0; with_obstacle_motion < 2; ++with_obstacle_motion) {
      moved += check_listed(&s, &g, with_obstacle_motion, scene);
      all += PARTICLES;
    }
  }
  if (!(moved > all / 20 && moved < all * 19 / 20)) fail_msg("%d of %d are moved", moved, all);
}

/* Those that a place is not told of are farther away than it asks about. */
static void a_place_is_told_of_all_that_are_near(void **state) {
  (void)state;
  static crowd s;
  const pbf_real reach = (pbf_real)0.1;
  uint64_t random = 6;
  for (int scene = 0; scene < scenes_of_many(); ++scene) {
    make_small_crowd(&random, &s);
    add_grid(&s, reach);
    const pbf_vec x = random_vec(&random, 2.5);
    const pbf_obstacles near = pbf_obstacles_near(s.o, x, reach);
    for (int k = 0, next = 0; k < MOST; ++k) {
      pbf_vec normal;
      if (next < near.count && near.surfaces.number(next) == k) {
        ++next;
        continue;
      }
      const pbf_surface before = pbf_surface_before(&s.surfaces[k]);
      if (!(pbf_surface_distance(&s.surfaces[k], x, &normal) > reach) ||
          !(pbf_surface_distance(&before, x, &normal) > reach))
        fail_msg("scene %d: surface %d is near, and not told of", scene, k);
    }
    assert_true(near.count <= MOST);
  }
}

static void what_is_not_near_lends_nothing(void **state) {
  (void)state;
  static crowd s;
  uint64_t random = 2;
  const pbf_real reach = (pbf_real)0.3;
  int found = 0;
  for (int scene = 0; scene < scenes(); ++scene) {
    pbf_obstacles near;
    pbf_vec normal;
    begin_crowd(&s, 1);
    for (int k = 0; k < PBF_DIM; ++k) s.o.domain.lower.c[k] = -3, s.o.domain.upper.c[k] = 3;
    s.surfaces[0] = random_surface(&random);
    if (scene % 2) add_grid(&s, reach / 2);
    group g = random_group(&random);
    found += obstacles_within(&s.o, &g.around, reach, &near);
    if (near.count) continue;
    for (int i = 0; i < PARTICLES; ++i)
      if (!(pbf_surface_distance(&s.surfaces[0], g.x[i], &normal) >= reach))
        fail_msg("scene %d: a shape %d is nearer than that", scene, s.surfaces[0].shape);
  }
  if (!(found > scenes() / 20 && found < scenes() * 19 / 20)) fail_msg("%d are near", found);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_not_met_does_nothing),
      cmocka_unit_test(the_surfaces_left_out_change_nothing),
      cmocka_unit_test(a_grid_leaves_out_no_more),
      cmocka_unit_test(one_by_one_it_leaves_out_no_more),
      cmocka_unit_test(those_that_are_met_first_are_enough),
      cmocka_unit_test(what_a_plane_gives_back_meets_a_ball),
      cmocka_unit_test(a_place_is_told_of_all_that_are_near),
      cmocka_unit_test(what_is_not_near_lends_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
