/* The one loop over pairs: a particle in each lane, its neighbours one after another. What a pass
 * does with them is in physics/passes/. */
#ifndef PBF_CPU_DRIVER_H
#define PBF_CPU_DRIVER_H

#include "cpu/neighbors.h"
#include "physics/passes/pass.h"

namespace {

/* What passes look up of neighbours; null: nothing. */
struct lookups {
  const pbf_real *number;
  const field *vector;
  const pbf_real *second = NULL; /* number */
};

/* From a group's places to those of the image from which a block's windows are there. */
PBF_FN lane_vector<lane> add_image(lane_vector<lane> x, const pair_pass *p, const block *b) {
  const pbf_vec *at = &p->images[b->image];
  for (int k = 0; k < PBF_DIM; ++k) x.c[k] = x.c[k] + ops<lane>::set(at->c[k]);
  return x;
}

/* What a pass knows of its particle: of one that begins at another place, at that of the image. */
template <class Own>
PBF_FN auto own_of_image(Own own, const pair_pass *p, const block *b, int)
    -> decltype((void)own.start, Own()) {
  if (b->image) own.start = add_image(own.start, p, b);
  return own;
}
template <class Own>
PBF_FN const Own &own_of_image(const Own &own, const pair_pass *, const block *, long) {
  return own;
}

/* What a loop over pairs is built for. */
enum pair_loop { FOR_SPEED, FOR_SIZE };

/* A loop in which the next round's distances are begun before the present one's terms: their
 * latency is the longest. */
template <pair_loop LOOP = FOR_SPEED, class Pass>
PBF_FN void add_neighbors(const Pass &pass, const pair_pass *p, const lookups &of,
                          const typename Pass::template own<lane> &own, uint32_t g,
                          typename Pass::template sums<lane> *sums) {
  uint8_t space[MAX_ROUNDS * WIDTH];
  block_places places;
  for (block_cursor w = group_blocks(&p->lists, g); w.left;) {
    const block *b = current_block(&w);
    lane_vector<lane> x = load_vector(p->x, g * WIDTH);
    if (b->image) x = add_image(x, p, b);
    const auto &seen = own_of_image(own, p, b, 0);
    const neighbor_table around = neighbors_in(b, p, Pass::NUMBER > 0 ? of.number : NULL, &places);
    vector_table vectors;
    if (Pass::VECTOR)
      vectors = vectors_in(b, p, of.vector, Pass::NUMBER > 1 ? of.second : NULL, &places);
    const uint8_t *list = next_list(&w, space), *end = list + b->rounds * WIDTH;
    const auto add = [&](const pair_lanes &now) __attribute__((always_inline)) {
      neighbor_of<lane> j;
      for (int k = 0; k < PBF_DIM; ++k) j.x_ij.c[k] = now.x_ij.c[k];
      j.r2 = now.r2;
      if (Pass::NUMBER > 0) j.number = number_of(&around, &now);
      if (Pass::VECTOR) j.vector = vector_of(&vectors, now.j, Pass::NUMBER > 1 ? &j.second : NULL);
      pass.pair(sums, seen, j);
    };
    if (BUILT_FOR_SIZE || LOOP == FOR_SIZE) {
      for (; list < end; list += WIDTH) add(pairs_listed(b, list, x, &around));
      continue;
    }
    pair_lanes now = pairs_listed(b, list, x, &around);
    while ((list += WIDTH) < end) {
      const pair_lanes next = pairs_listed(b, list, x, &around);
      add(now);
      now = next;
    }
    add(now);
  }
}

template <pair_loop LOOP = FOR_SPEED, class Pass>
PBF_FN typename Pass::template sums<lane> sums_of_group(
    const Pass &pass, const pair_pass *p, const lookups &of,
    const typename Pass::template own<lane> &own, uint32_t g) {
  auto sums = pass.template begin<lane>();
  add_neighbors<LOOP>(pass, p, of, own, g, &sums);
  pass.end(&sums);
  return sums;
}

/* One lane's of any sums, which are of reals alone in both forms. */
template <template <class> class Sums>
struct lane_sums {
  enum { COUNT = sizeof(Sums<pbf_real>) / sizeof(pbf_real) };
  alignas(64) pbf_real values[COUNT][WIDTH];

  /* Vector by vector: what is copied in smaller parts is waited for. */
  PBF_IN explicit lane_sums(const Sums<lane> &sums) {
    static_assert(sizeof values == sizeof sums, "sums are of reals alone");
    const lane *of = reinterpret_cast<const lane *>(&sums);
    for (int k = 0; k < COUNT; ++k) lane_store(values[k], of[k]);
  }
  /* Not by memcpy, which the compiler would not make vectors of. */
  PBF_IN Sums<pbf_real> operator[](uint32_t l) const {
    Sums<pbf_real> one;
    pbf_real *of = reinterpret_cast<pbf_real *>(&one);
    for (int k = 0; k < COUNT; ++k) of[k] = values[k][l];
    return one;
  }
};

}  // namespace

#endif
