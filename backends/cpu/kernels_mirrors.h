/* Sums over the pairs of a group near walls that mirror: physics/mirrors.h. A loop of its own, so
 * that those of groups without images stay as they are. */
#ifndef PBF_CPU_KERNELS_MIRRORS_H
#define PBF_CPU_KERNELS_MIRRORS_H

#include "cpu/kernels_walls.h"
#include "cpu/neighbors.h"

/* Where the particles of a group have images. */
typedef struct lane_mirrors {
  pbf_mirrors near;
  lane twice[2][PBF_DIM];
} lane_mirrors;

PBF_FN int has_mirrors(const pair_pass *p) {
  return (PBF_BUILT & PBF_FEATURE_WALL_DENSITY) && p->walls && p->walls->walls.reach > 0;
}

/* Of a pass that has mirrors; returns whether there are any near the group. */
PBF_FN int find_mirrors(const pair_pass *p, uint32_t g, lane_mirrors *m) {
  const pbf_walls *walls = &p->walls->walls;
  const lane_vec x = lane_vec_load(&p->x, g * WIDTH);
  const lane_values xs = lane_vec_values(&x);
  pbf_real distances[WIDTH];
  if (!(wall_distances(p->walls, &xs, distances) < walls->reach)) return 0;
  pbf_vec lower = lane_value(&xs, 0), upper = lower;
  for (uint32_t l = 1; l < WIDTH && g * WIDTH + l < p->lists.count; ++l)
    for (int k = 0; k < PBF_DIM; ++k) {
      lower.c[k] = pbf_real_min(lower.c[k], xs.c[k][l]);
      upper.c[k] = pbf_real_max(upper.c[k], xs.c[k][l]);
    }
  m->near = pbf_mirrors_near(walls, lower, upper);
  for (int k = 0; k < PBF_DIM; ++k) {
    m->twice[0][k] = lane_set(2) * (x.c[k] - lane_set(walls->lower.c[k]));
    m->twice[1][k] = lane_set(2) * (x.c[k] - lane_set(walls->upper.c[k]));
  }
  return m->near.count > 0;
}

/* Sums over pairs: of a density constraint, or of a move. */
typedef struct pair_sums {
  lane density, slope2;
  lane_vec sum; /* of gradients, or of moves */
} pair_sums;

/* In units of the kernel's scales; `factor`: on the slope in `sum`. */
PBF_FN void add_pair(const int features, const pbf_constants *c, const lane_vec *x, lane r2,
                     lane factor, pair_sums *sums) {
  const lane value_scale = lane_set(features & PBF_FEATURE_SCORR ? c->value_scale : 1);
  lane value, slope;
  lanes_scaled(features, c, value_scale, lane_set(1), r2, &value, &slope);
  if (features & PBF_FEATURE_SCORR) factor = factor + lanes_scorr(c, value);
  sums->density = sums->density + value;
  sums->slope2 = lane_fma(slope * r2, slope, sums->slope2);
  lane_vec_add_scaled(&sums->sum, factor * slope, x);
}

/* Adds the images of j. */
PBF_FN void add_images(const int features, const pbf_constants *c, lane_mirrors *m,
                       const lane_vec *x_ij, lane factor, pair_sums *sums) {
  for (int k = 0, out = 0; k < m->near.count; ++k) {
    const int walls = m->near.walls[k];
    lane_vec image;
    if (walls & out) continue;
    lane r2 = lanes_image(walls, m->twice, x_ij->c, image.c);
    if (lane_any_below(r2, lane_set(c->h2)))
      add_pair(features, c, &image, r2, factor, sums);
    else
      out |= walls & (walls - 1) ? 0 : walls;
  }
}

/* Images count by the walls' weight. */
PBF_FN void add_weighed(const pbf_constants *c, lane scale, const pair_sums *images,
                        pair_sums *sums) {
  const lane weight = lane_set(c->wall_weight);
  sums->density = lane_fma(weight, images->density, sums->density) * lane_set(c->value_scale);
  sums->slope2 = lane_fma(weight, images->slope2, sums->slope2) * scale * scale;
  lane_vec_add_scaled(&sums->sum, weight, &images->sum);
  lane_vec_scale(&sums->sum, scale);
}

PBF_FN void walk_mirrored(const int features, const pair_pass *p, const pbf_real *lambda,
                          uint32_t g, lane_mirrors *m, pair_sums *sums) {
  const pbf_constants c = *p->constants;
  const lane_vec x = lane_vec_load(&p->x, g * WIDTH), own = lane_vec_zero();
  const lane lambda_i = lambda ? lane_load(lambda + g * WIDTH) : lane_set((pbf_real)0.5);
  pair_sums images = *sums;
  uint8_t space[MOST_ROUNDS * WIDTH];
  sums->density = lane_set(1);
  add_images(features, &c, m, &own, lambda_i + lambda_i, &images);
  for (walk w = walk_group(&p->lists, g); w.left;) {
    const block *b = walk_block(&w);
    const neighbor_table around = neighbors_in(b, p, lambda);
    const uint8_t *list = walk_on(&w, space), *end = list + b->rounds * WIDTH;
    for (; list < end; list += WIDTH) {
      const pair_lanes pair = pairs_listed(b, list, &x, &around);
      const lane lambdas = lambda_i + (lambda ? number_of(&around, &pair) : lambda_i);
      add_pair(features, &c, &pair.x_ij, pair.r2, lambdas, sums);
      add_images(features, &c, m, &pair.x_ij, lambdas, &images);
    }
  }
  add_weighed(&c, lane_set(pbf_slope_scale(features, &c)), &images, sums);
}

/* All sums of a group, without or with lambdas, in a pass that has mirrors; returns whether there
 * are any near it, and does nothing otherwise. Few scenes need it: one loop for all kernels but the
 * default one. */
static __attribute__((noinline)) int sum_mirrored(const pair_pass *p, const pbf_real *lambda,
                                                  uint32_t g, pair_sums *sums) {
  const int scorr = lambda ? PBF_FEATURE_SCORR : 0;
  const int features = p->features & PBF_BUILT & (PBF_FEATURE_POLY6 | scorr);
  lane_mirrors m;
  if (!find_mirrors(p, g, &m)) return 0;
  memset(sums, 0, sizeof *sums);
  if (BUILT_FOR_SIZE || features)
    walk_mirrored(features, p, lambda, g, &m, sums);
  else
    walk_mirrored(0, p, lambda, g, &m, sums);
  return 1;
}

#endif
