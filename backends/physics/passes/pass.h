/* What a pass over pairs is: a struct of a few functions, written once, that each backend's own
 * loop over neighbours calls (reference/driver.h, cpu/driver.h, cuda/driver.h). A lane type L is
 * pbf_real or a vector of them. A pass P has
 *
 *   NUMBER, VECTOR             what it looks up of a neighbour beside its place: how many numbers,
 *                              0 … 2, the second with a vector alone; how many vectors, 0 or 1
 *   template own<L>            what it knows of its particle
 *   template sums<L>           what it sums up
 *   begin<L>()                 sums of no neighbour
 *   pair(sums, own, j, w = {}) adds a neighbour, or with a weight w a ghost
 *   end(sums)                  once all are added
 *   finish(…)                  what the particle makes of them; its arguments are the pass's own
 *
 * Features are an int, or fixed<…> where a loop is built for them.
 *
 * A pass over particles alone has of(params), the pass of a step with these parameters, and
 * finish(v), the velocity that a particle has after it: drag.h is one. */
#ifndef PBF_PHYSICS_PASSES_PASS_H
#define PBF_PHYSICS_PASSES_PASS_H

#include "physics/kernels.h"

/* Internal linkage: units built for other instruction sets have others of the same names. */
namespace {

template <int F>
struct fixed {
  PBF_IN constexpr operator int() const { return F; }
};

/* A neighbour: where it is, and what the pass looks up. */
template <class L>
struct neighbor_of {
  lane_vector<L> x_ij;
  L r2, number;
  lane_vector<L> vector;
  L second = {}; /* number */
};

/* Takes what a pass knows of its particle along to an image of it: where the step began, if it is
 * that, and else nothing. */
template <class Own, class L>
PBF_FN auto move_own(Own *own, const lane_vector<L> &by, int) -> decltype((void)own->start) {
  own->start.add_scaled(ops<L>::set(1), by);
}
template <class Own, class L>
PBF_FN void move_own(Own *, const lane_vector<L> &, long) {}

/* The weight of what counts in full. */
struct unweighted {};
template <class L>
PBF_FN L operator*(unweighted, L a) {
  return a;
}

/* Whether a weight is of ghosts, also where it is multiplied with later, in their sums. */
struct weighted_later {};
template <class L>
PBF_FN L operator*(weighted_later, L a) {
  return a;
}
template <class Weight>
struct is_of_ghosts {
  static constexpr bool value = true;
};
template <>
struct is_of_ghosts<unweighted> {
  static constexpr bool value = false;
};

}  // namespace

#endif
