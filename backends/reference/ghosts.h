/* Part of driver.h. What ghosts in the domain's walls add to a particle's sums: physics/ghosts.h.
 */
#ifndef PBF_REFERENCE_GHOSTS_H
#define PBF_REFERENCE_GHOSTS_H

#include "physics/ghosts.h"
#include "reference/solver.h"

/* Walks over the ghosts nearer than h to particle i, at positions x: those of its neighbours, and
 * its own, which is the first. */
typedef struct ghost {
  neighbor n;     /* j, x_ij and r2 are of the ghost, … */
  pbf_vec direct; /* … and this is x_ij of the particle that it stands for */
  pbf_ghost_walls walls;
  int next;
  pbf_real doubled[2][PBF_DIM];
} ghost;

static inline ghost ghosts_of(const solver *s, const pbf_obstacles *o, const pbf_vec *x,
                              uint32_t i) {
  ghost m = {.n = neighbors_of(&s->grid, i)};
  if (!(PBF_BUILT & PBF_FEATURE_WALL_DENSITY) || !(o->domain.ghost_reach > 0)) return m;
  m.n.j = i;
  m.walls = pbf_ghost_walls_near(&o->domain, x[i], x[i]);
  for (int k = 0; k < PBF_DIM; ++k) {
    m.doubled[0][k] = 2 * (x[i].c[k] - o->domain.lower.c[k]);
    m.doubled[1][k] = 2 * (x[i].c[k] - o->domain.upper.c[k]);
  }
  return m;
}

static inline int next_ghost(const solver *s, const pbf_vec *x, ghost *m) {
  do {
    if (m->next == m->walls.count) {
      if (m->walls.count == 0 || !next_neighbor(&s->grid, x, s->constants.h2, &m->n)) return 0;
      m->direct = m->n.x_ij;
      m->next = 0;
    }
    lane_vector<pbf_real> x_ij;
    m->n.r2 = ghost_in(m->walls.walls[m->next++], m->doubled, lanes_of(m->direct), &x_ij);
    m->n.x_ij = vec_of(x_ij);
  } while (!(m->n.r2 < s->constants.h2));
  return 1;
}

#endif
