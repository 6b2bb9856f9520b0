/* Part of kernels_solve.h. The loop over pairs for groups near walls with ghosts: neighbours, and
 * their ghosts (physics/ghosts.h). It is not driver.h's, so that that stays as it is. */
#ifndef PBF_CPU_DRIVER_GHOSTS_H
#define PBF_CPU_DRIVER_GHOSTS_H

#include "cpu/driver.h"
#include "cpu/boundary.h"
#include "physics/ghosts.h"

namespace {

/* The walls in which the particles of a group have ghosts. */
typedef struct lane_ghost_walls {
  pbf_ghost_walls near;
  lane doubled[2][PBF_DIM];
} lane_ghost_walls;

PBF_FN int has_ghosts(const pair_pass *p) {
  return (PBF_BUILT & PBF_FEATURE_WALL_DENSITY) && p->contributing &&
         p->contributing->domain.ghost_reach > 0;
}

/* Of a pass that has ghosts; returns whether there are any near the group. */
PBF_FN int find_ghost_walls(const pair_pass *p, uint32_t g, lane_ghost_walls *m) {
  const pbf_domain *domain = &p->contributing->domain;
  const lane_vector<lane> x = load_vector(p->x, g * WIDTH);
  const lane_values xs = values_of(x);
  pbf_real distances[WIDTH];
  if (!(domain_distances(p->contributing, &xs, distances) < domain->ghost_reach)) return 0;
  pbf_vec lower = lane_value(&xs, 0), upper = lower;
  for (uint32_t l = 1; l < WIDTH && g * WIDTH + l < p->lists.count; ++l)
    for (int k = 0; k < PBF_DIM; ++k) {
      lower.c[k] = pbf_real_min(lower.c[k], xs.c[k][l]);
      upper.c[k] = pbf_real_max(upper.c[k], xs.c[k][l]);
    }
  m->near = pbf_ghost_walls_near(domain, lower, upper);
  for (int k = 0; k < PBF_DIM; ++k) {
    m->doubled[0][k] = ops<lane>::set(2) * (x.c[k] - ops<lane>::set(domain->lower.c[k]));
    m->doubled[1][k] = ops<lane>::set(2) * (x.c[k] - ops<lane>::set(domain->upper.c[k]));
  }
  return m->near.count > 0;
}

/* Adds the ghosts of a neighbour. */
template <class Pass>
PBF_FN void add_ghosts(const Pass &pass, const lane_ghost_walls &m,
                       const typename Pass::template own<lane> &own, const neighbor_of<lane> &j,
                       typename Pass::template sums<lane> *sums) {
  for (int k = 0, out = 0; k < m.near.count; ++k) {
    const int walls = m.near.walls[k];
    if (walls & out) continue;
    neighbor_of<lane> ghost = j;
    ghost.r2 = ghost_in(walls, m.doubled, j.x_ij, &ghost.x_ij);
    if (lane_any_below(ghost.r2, ops<lane>::set(pass.c->h2)))
      pass.pair(sums, own, ghost, weighted_later{});
    else
      out |= walls & (walls - 1) ? 0 : walls;
  }
}

/* sums += weight * ghosts; sums are of reals alone. */
template <class Sums>
PBF_FN void add_weighted(Sums *sums, lane weight, const Sums &ghosts) {
  lane *to = reinterpret_cast<lane *>(sums);
  const lane *from = reinterpret_cast<const lane *>(&ghosts);
  for (size_t k = 0; k < sizeof(Sums) / sizeof(lane); ++k)
    to[k] = ops<lane>::multiply_add(weight, from[k], to[k]);
}

/* What it knows of its particle a pass looks up of neighbours, too. */
template <class Pass>
PBF_FN typename Pass::template sums<lane> sums_with_ghosts(const Pass &pass, const pair_pass *p,
                                                           const lookups &of, uint32_t g,
                                                           const lane_ghost_walls &m) {
  neighbor_of<lane> itself = {lane_vector<lane>::zero(), ops<lane>::set(0), ops<lane>::set(0), {}};
  typename Pass::template own<lane> own;
  if constexpr (Pass::NUMBER) {
    itself.number = lane_load(of.number + g * WIDTH);
    own = {itself.number};
  }
  auto sums = pass.template begin<lane>();
  typename Pass::template sums<lane> ghosts;
  memset(&ghosts, 0, sizeof ghosts);
  add_ghosts(pass, m, own, itself, &ghosts);
  uint8_t space[MAX_ROUNDS * WIDTH];
  block_places places;
  for (block_cursor w = group_blocks(&p->lists, g); w.left;) {
    const block *b = current_block(&w);
    lane_vector<lane> x = load_vector(p->x, g * WIDTH);
    if (b->image) x = add_image(x, p, b);
    const neighbor_table around = neighbors_in(b, p, Pass::NUMBER ? of.number : NULL, &places);
    const uint8_t *list = next_list(&w, space), *end = list + b->rounds * WIDTH;
    for (pair_lanes next = pairs_listed(b, list, x, &around); list < end;) {
      const pair_lanes pair = next;
      neighbor_of<lane> j;
      for (int k = 0; k < PBF_DIM; ++k) j.x_ij.c[k] = pair.x_ij.c[k];
      j.r2 = pair.r2;
      if (Pass::NUMBER) j.number = number_of(&around, &pair);
      if ((list += WIDTH) < end) next = pairs_listed(b, list, x, &around);
      pass.pair(&sums, own, j);
      add_ghosts(pass, m, own, j, &ghosts);
    }
  }
  add_weighted(&sums, ops<lane>::set(pass.c->boundary_weight), ghosts);
  pass.end(&sums);
  return sums;
}

/* All sums of a group, where there are ghosts near it; does nothing and returns 0 otherwise. Few
 * scenes need it: one loop for all kernels but the default one. */
template <template <class, scaling> class Pass, class Sums>
static __attribute__((noinline)) int sum_with_ghosts(const pair_pass *p, int features,
                                                     const lookups &of, uint32_t g, Sums *sums) {
  const pbf_constants c = *p->constants;
  lane_ghost_walls m;
  if (!find_ghost_walls(p, g, &m)) return 0;
  if (BUILT_FOR_SIZE || features)
    *sums = sums_with_ghosts(Pass<int, SCALED_SUMS>{&c, features}, p, of, g, m);
  else
    *sums = sums_with_ghosts(Pass<fixed<0>, SCALED_SUMS>{&c, {}}, p, of, g, m);
  return 1;
}

}  // namespace

#endif
