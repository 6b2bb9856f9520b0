/* What images in the domain's walls add to a particle's sums: physics/mirrors.h. */
#ifndef PBF_REFERENCE_MIRRORS_H
#define PBF_REFERENCE_MIRRORS_H

#include "physics/passes/ghost.h"
#include "reference/solver.h"

/* Walks over the images nearer than h to particle i, at positions x: those of its neighbours, and
 * its own, which is the first. */
typedef struct image {
  neighbor n;     /* j, x_ij and r2 are of the image, … */
  pbf_vec direct; /* … and this is x_ij of whom it is the image of */
  pbf_mirrors mirrors;
  int next;
  pbf_real twice[2][PBF_DIM];
} image;

static inline image images_of(const solver *s, const pbf_obstacles *o, const pbf_vec *x,
                              uint32_t i) {
  image m = {.n = neighbors_of(&s->grid, i)};
  if (!(PBF_BUILT & PBF_FEATURE_WALL_DENSITY) || !(o->walls.reach > 0)) return m;
  m.n.j = i;
  m.mirrors = pbf_mirrors_near(&o->walls, x[i], x[i]);
  for (int k = 0; k < PBF_DIM; ++k) {
    m.twice[0][k] = 2 * (x[i].c[k] - o->walls.lower.c[k]);
    m.twice[1][k] = 2 * (x[i].c[k] - o->walls.upper.c[k]);
  }
  return m;
}

static inline int next_image(const solver *s, const pbf_vec *x, image *m) {
  do {
    if (m->next == m->mirrors.count) {
      if (m->mirrors.count == 0 || !next_neighbor(&s->grid, x, s->constants.h2, &m->n)) return 0;
      m->direct = m->n.x_ij;
      m->next = 0;
    }
    lane_vector<pbf_real> ghost;
    m->n.r2 = ghost_in(m->mirrors.walls[m->next++], m->twice, lanes_of(m->direct), &ghost);
    m->n.x_ij = vec_of(ghost);
  } while (!(m->n.r2 < s->constants.h2));
  return 1;
}

#endif
