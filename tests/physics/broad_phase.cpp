/* Colliders that a group of particles is said not to meet leave each of them as it is, to the bit,
 * and lend it nothing. */
#include "support.h"

#include "cpu/broad_phase.h"
#include "support/random.h"

enum { SCENES = 20000, PARTICLES = 6 };

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
  for (int scene = 0; scene < SCENES; ++scene) {
    static pbf_obstacles o;
    o.domain = domain;
    o.count = 1;
    o.surfaces[0] = random_surface(&random);
    group g = random_group(&random);
    for (int with_obstacle_motion = 0; with_obstacle_motion < 2; ++with_obstacle_motion) {
      static pbf_obstacles near;
      ++all[with_obstacle_motion];
      if (collision_candidates(&o, &g.around, with_obstacle_motion, &near)) {
        ++met[with_obstacle_motion];
        continue;
      }
      for (int i = 0; i < PARTICLES; ++i) {
        pbf_vec after = pbf_resolve_collisions(o, with_obstacle_motion, g.from[i], g.x[i]);
        if (memcmp(&after, &g.x[i], sizeof after) != 0)
          fail_msg("scene %d: a shape %d that is not met moves a particle", scene,
                   o.surfaces[0].shape);
      }
    }
  }
  for (int with_obstacle_motion = 0; with_obstacle_motion < 2; ++with_obstacle_motion)
    if (!(met[with_obstacle_motion] > all[with_obstacle_motion] / 20 &&
          met[with_obstacle_motion] < all[with_obstacle_motion] * 19 / 20))
      fail_msg("%d of %d are met", met[with_obstacle_motion], all[with_obstacle_motion]);
}

/* Pushes of every size, skins, and a domain whose walls have moved in. */
static pbf_obstacles random_obstacles(uint64_t *state) {
  static const pbf_real pushes[] = {0, (pbf_real)0.1, (pbf_real)0.5, (pbf_real)INFINITY};
  pbf_obstacles o;
  o.count = 1 + (int)random_in(state, 0, 6);
  o.domain.bounce_depth = (pbf_real)0.1;
  for (int k = 0; k < PBF_DIM; ++k) {
    o.domain.lower.c[k] = (pbf_real)random_in(state, -2, 0);
    o.domain.upper.c[k] = (pbf_real)random_in(state, 0.2, 2);
  }
  for (int k = 0; k < o.count; ++k) {
    o.surfaces[k] = random_surface(state);
    o.surfaces[k].prediction_push = pushes[(int)random_in(state, 0, 4)];
    o.surfaces[k].iteration_push = pushes[(int)random_in(state, 0, 4)];
  }
  return o;
}

/* One may push a particle into another, and that into a third. */
static void the_surfaces_left_out_change_nothing(void **state) {
  (void)state;
  uint64_t random = 3;
  int left_out = 0;
  for (int scene = 0; scene < SCENES; ++scene) {
    const pbf_obstacles all = random_obstacles(&random);
    const group g = random_group(&random);
    for (int with_obstacle_motion = 0; with_obstacle_motion < 2; ++with_obstacle_motion) {
      static pbf_obstacles near;
      collision_candidates(&all, &g.around, with_obstacle_motion, &near);
      left_out += near.count < all.count;
      for (int i = 0; i < PARTICLES; ++i) {
        const pbf_vec by_all = pbf_resolve_collisions(all, with_obstacle_motion, g.from[i], g.x[i]);
        const pbf_vec by_near =
            pbf_resolve_collisions(near, with_obstacle_motion, g.from[i], g.x[i]);
        if (memcmp(&by_all, &by_near, sizeof by_all) != 0)
          fail_msg("scene %d: %d of %d surfaces move a particle elsewhere", scene, near.count,
                   all.count);
      }
    }
  }
  assert_true(left_out > SCENES / 20);
}

static void what_is_not_near_lends_nothing(void **state) {
  (void)state;
  uint64_t random = 2;
  const pbf_real reach = (pbf_real)0.3;
  int found = 0;
  for (int scene = 0; scene < SCENES; ++scene) {
    static pbf_obstacles o, near;
    pbf_vec normal;
    o.count = 1;
    o.surfaces[0] = random_surface(&random);
    group g = random_group(&random);
    found += obstacles_within(&o, &g.around, reach, &near);
    if (near.count) continue;
    for (int i = 0; i < PARTICLES; ++i)
      if (!(pbf_surface_distance(&o.surfaces[0], g.x[i], &normal) >= reach))
        fail_msg("scene %d: a shape %d is nearer than that", scene, o.surfaces[0].shape);
  }
  if (!(found > SCENES / 20 && found < SCENES * 19 / 20)) fail_msg("%d are near", found);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_not_met_does_nothing),
      cmocka_unit_test(the_surfaces_left_out_change_nothing),
      cmocka_unit_test(what_is_not_near_lends_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
