/* Bodies of fluid that several cases start from, at the library's default spacing. */
#ifndef PBF_BENCH_STABILITY_FLUID_H
#define PBF_BENCH_STABILITY_FLUID_H

#include "stability/trial.h"

namespace bench::stability {

constexpr double support = 0.1;   // h of pbf_params_init
constexpr double spacing = 0.05;  // and the rest distance that follows from it

// A lattice in the middles of cells of side `apart`, from `low` to `high`.
Particles box(const Vector &low, const Vector &high, double apart = spacing,
              unsigned dimension = 3);
Particles ball(const Vector &center, double radius, const Vector &velocity = {});

// `count` particles at random between the corners: the same ones in every run.
Particles random_box(const Vector &low, const Vector &high, uint64_t count, unsigned seed);
void jitter(Particles &particles, double distance, unsigned seed);

void append(Particles &to, const Particles &more);
Particles at(std::initializer_list<Vector> positions);

// A box of this size from the origin, with fluid from there to `fluid`.
Start tank(const Vector &size, const Vector &fluid);

// Steps after which a tank is judged to be at rest.
constexpr uint32_t settling_steps = 360;

// A column of water that falls over: what most systems are tried with first.
Start dam_break(bool small);

}  // namespace bench::stability

#endif
