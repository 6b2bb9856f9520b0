/* Scenes on ranks, each compared with what one solver makes of it: bits of particles and whatever
 * else is asked for. */
#ifndef PBF_TESTS_RANKS_SCENES_H
#define PBF_TESTS_RANKS_SCENES_H

#include "support.h"

#include "shares.h"

enum { SCENE_COUNT = 3000, SCENE_STEPS = 12, SCENE_COLLIDERS = 2, SCENE_SOLIDS = 6 + 4 };

/* A scene, and what one solver makes of it. */
typedef struct scene {
  uint32_t dimension, precision, count;
  pbf_params params;
  uint32_t colliders;
  void (*set_up)(const struct scene *c, pbf_solver *s); /* before there are particles; null: no */
  void (*change)(const struct scene *c, pbf_solver *s); /* after half of the steps */
  uint32_t phases; /* particles are of by turns, once they are set; 0: there are none */
  int asks;        /* a velocity, a level, particles in a ball */
  const char *isa; /* null: the best */
  uint64_t hash;   /* after the steps */
  pbf_stats stats; /* and what else is asked for */
  void *densities, *pressures;
  double asked[4];
  uint32_t solids; /* that loads are of */
  pbf_collider_load loads[SCENE_SOLIDS];
  uint64_t hashes_seen[MAX_THREAD_RANKS];
  shared_ids seen; /* in the shares of the ranks */
} scene;

/* A block in a box of side 3 x 1 x 1, in 2D 6 x 5. */
scene scene_plain(uint32_t dimension, uint32_t precision);

/* A block at the left, in which no particle lies on a lattice. */
void scene_fill(const scene *c, pbf_solver *s, uint32_t count, double shift);

/* A sphere on its way, and a box that turns, to change and to set. */
void scene_colliders(pbf_collider list[SCENE_COLLIDERS]);

/* Every other particle of the first half gets one, by where it is. */
void scene_accelerate(const scene *c, pbf_solver *s);

/* Runs it by one solver, and keeps what that gives, which is to be freed. */
void scene_run_alone(scene *c);
void scene_free(scene *c);

/* Then on so many ranks, which have these shares, or null: as long as they need; fails where any
 * bit is another. */
void scene_expect_same(const char *what, scene *c, uint32_t ranks, const double *shares);

/* All of these: on 1, 2, 3 and 8 ranks. */
void scene_check(const char *what, scene *c);

#endif
