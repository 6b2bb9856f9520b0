/* What is checked and timed. Scenes are made, not read: a machine that has a GPU and little else
 * runs this. */
#ifndef PBF_BENCH_GPU_CHECK_SCENES_H
#define PBF_BENCH_GPU_CHECK_SCENES_H

#include <stdint.h>

#include <pbf/pbf.h>

enum { SCENE_COLLIDERS = 1000 }; /* at most */

typedef struct scene {
  const char *name;
  uint32_t dimension;
  pbf_params params;
  uint32_t counts[3];
  double first[3], spacing;
  uint32_t collider_count;
  pbf_collider colliders[SCENE_COLLIDERS];
  double jitter;     /* of the lattice, in spacings */
  const char *extra; /* what is timed beside the defaults */
  const char *flow;  /* what comes and goes (flow.h), or null */
  int all_pairs;     /* no neighbour comes or goes in a step's iterations, or no lists are there */
} scene;

uint32_t scene_count(const scene *s);
double scene_coordinate(const scene *s, uint32_t particle, uint32_t axis);

scene report_30k(void);
scene shallow_dam_break(uint32_t particles, double support);
scene small_scene(uint32_t dimension);

/* Pressed a little from the start, with all that differs from iteration to iteration; so slow that
 * neighbours stay neighbours. With `brief` steps a part of the density error is left. */
scene accelerated_scene(uint32_t dimension, int brief);

/* Makes the scene's kernel so wide that walls mirror the fluid, and puts walls around it. */
void add_mirrors(scene *s);

/* 0 … 3: bit 0 is the kernel, bit 1 whether there is artificial pressure. */
void set_kernel(scene *s, int combination);

/* Turns on the optional parameter of that name, by params.def with its usual value, or those that
 * are off where `name` is null; 0 where there is none. */
int add_optional(scene *s, const char *name);

void add_colliders(scene *s);
void add_turning_floor(scene *s);
void add_many_colliders(scene *s);

/* As many as there may be, of which as many as before are in and around the fluid. */
void add_thousand_colliders(scene *s);
void add_container(scene *s, uint32_t shape);

#endif
