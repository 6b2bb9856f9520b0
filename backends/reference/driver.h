/* The one loop over pairs of this backend: a particle, and its neighbours one after another. What a
 * pass does with them is in physics/passes/. */
#ifndef PBF_REFERENCE_DRIVER_H
#define PBF_REFERENCE_DRIVER_H

#include "physics/passes/curl.h"
#include "physics/passes/shear_stress.h"
#include "reference/ghosts.h"

namespace {

/* What passes look up of neighbours; null: nothing. */
struct lookups {
  const pbf_real *number;
  const pbf_vec *vector;
};

PBF_FN neighbor_of<pbf_real> looked_up(const neighbor &n, const pbf_deviator *of) {
  neighbor_of<pbf_real> j = {lanes_of(n.x_ij), n.r2, 0, {}};
  for (int k = 0; k < PBF_DIM; ++k) j.vector.c[k] = of[n.j].c[k];
  if (PBF_DIM == 3) {
    j.number = of[n.j].c[PBF_DEVIATOR_DIM - 2];
    j.second = of[n.j].c[PBF_DEVIATOR_DIM - 1];
  }
  return j;
}

PBF_FN neighbor_of<pbf_real> looked_up(const neighbor &n, const lookups &of) {
  neighbor_of<pbf_real> j = {lanes_of(n.x_ij), n.r2, 0, {}};
  if (of.number) j.number = of.number[n.j];
  if (of.vector) j.vector = lanes_of(of.vector[n.j]);
  return j;
}

/* The size of each particle's curl. */
struct curl_sizes {
  const pbf_curl *curl;
};

PBF_FN neighbor_of<pbf_real> looked_up(const neighbor &n, const curl_sizes &of) {
  return {lanes_of(n.x_ij), n.r2, pbf_curl_size(of.curl[n.j]), {}};
}

/* Adds the neighbours of particle i among particles at x, which s->grid was built from; counts
 * them, too, unless null. */
template <class Pass, class Lookups = lookups>
static inline void add_neighbors(const solver *s, const Pass &pass, const pbf_vec *x,
                                 const Lookups &of,
                                 const typename Pass::template own<pbf_real> &own, uint32_t i,
                                 typename Pass::template sums<pbf_real> *sums,
                                 uint32_t *neighbors = NULL) {
  neighbor n = neighbors_of(&s->grid, i);
  while (next_neighbor(&s->grid, x, s->constants.h2, &n)) {
    typename Pass::template own<pbf_real> image = own;
    if (s->grid.periods.any) move_own(&image, lanes_of(n.image), 0);
    pass.pair(sums, image, looked_up(n, of));
    if (neighbors) ++*neighbors;
  }
}

template <class Pass, class Lookups = lookups>
static inline typename Pass::template sums<pbf_real> sums_around(
    const solver *s, const Pass &pass, const pbf_vec *x, const Lookups &of,
    const typename Pass::template own<pbf_real> &own, uint32_t i, uint32_t *neighbors = NULL) {
  auto sums = pass.template begin<pbf_real>();
  add_neighbors(s, pass, x, of, own, i, &sums, neighbors);
  pass.end(&sums);
  return sums;
}

/* Adds the ghosts in walls that have them. */
template <class Pass>
static inline void add_ghosts(const solver *s, const Pass &pass, const pbf_obstacles *o,
                              const pbf_vec *x, const lookups &of,
                              const typename Pass::template own<pbf_real> &own, uint32_t i,
                              typename Pass::template sums<pbf_real> *sums) {
  ghost m = ghosts_of(s, o, x, i);
  while (next_ghost(s, x, &m))
    pass.pair(sums, own, looked_up(m.n, of), s->constants.boundary_weight);
}

}  // namespace

#endif
