/* Overlap: fluid that a step finds where no step has moved it: placed in other fluid, pressed by a
 * solid that was placed in it, by walls that have jumped, or left by a step that was much longer.
 * What the solve corrects of a density error becomes velocity, error times h / dt: overlap would be
 * thrown apart, the faster the shorter the step. So the density that it adds is allowed for, as it
 * was found, and ever less of it from step to step, which moves particles no faster than
 * depenetration.h tells. Pressure is what exceeds the allowance, as elsewhere what exceeds 1. */
#ifndef PBF_PHYSICS_PASSES_OVERLAP_H
#define PBF_PHYSICS_PASSES_OVERLAP_H

#include "physics/boundary.h"
#include "physics/passes/pass.h"

namespace {

/* The density that placed neighbours contribute, or the parts of them that are placed; and that of
 * a stream's own particles. What their ghosts do is not counted. */
template <class Features>
struct placed_density_pass {
  enum { NUMBER = 1 /* pbf_placed_number */, VECTOR = 0 };
  const pbf_constants *c;
  Features features;

  template <class L>
  struct own {};
  template <class L>
  struct sums {
    L density, stream;
  };

  template <class L>
  PBF_IN sums<L> begin() const {
    return {ops<L>::set(0), ops<L>::set(0)};
  }

  template <class L>
  PBF_IN void pair(sums<L> *s, const own<L> &, const neighbor_of<L> &j) const {
    const L none = ops<L>::set(0), value = kernel_value(features, c, j.r2);
    const L of_stream = ops<L>::max(none - j.number, none);
    const L outside = ops<L>::max(of_stream - ops<L>::set(1), none);
    s->density = ops<L>::multiply_add(value, ops<L>::max(j.number, none) + outside, s->density);
    s->stream = ops<L>::multiply_add(value, of_stream - outside, s->stream);
  }

  template <class L>
  PBF_IN void end(sums<L> *) const {}
};

/* Calls visit(surface, number) for placed ones, or `all`. */
template <class Surfaces>
struct each_placed_surface {
  Surfaces surfaces;
  int count, before;
  bool all;
  uint64_t placed;
  const uint64_t *more;

  template <class Visit>
  PBF_IN void operator()(Visit visit) const {
    for (int k = 0; k < count; ++k)
      if (all || pbf_set_has(placed, more, pbf_surface_number(surfaces, k)))
        visit(before ? pbf_surface_before(&surfaces[k]) : surfaces[k], k);
  }
};

/* The density that placed surfaces contribute at x, or `all`, as they stood `before` the step or
 * after it; `more` is for those that have no bit in `found`. */
template <class Obstacles>
PBF_FN_HOST_NOINLINE pbf_real placed_boundary(const pbf_constants *c, const Obstacles &o,
                                              const pbf_overlap &found, const uint64_t *more,
                                              pbf_vec x, int before, bool all) {
  pbf_boundary boundary = {0, 0, 0, {{0}}, {{0}}};
  if (found.walls || all) boundary = pbf_boundary_of_domain(c, &o.domain, x);
  const each_placed_surface<decltype(o.surfaces)> placed = {
      o.surfaces, pbf_surface_count(o), before, all, found.colliders, more};
  pbf_accumulate_surfaces(c, &o.domain, x, placed, &boundary);
  return boundary.overlapping + boundary.additive;
}

}  // namespace

/* One that has been set elsewhere has a mark in place of what is left of its overlap. */
PBF_FN bool pbf_is_set_elsewhere(pbf_real overlap) {
  return overlap >= (pbf_real)PBF_BACKEND_OVERLAP_PLACED;
}

PBF_FN bool pbf_is_placed(const pbf_overlap &found, uint32_t id, pbf_real overlap) {
  return (id >= found.first_id && id <= found.last_id) || pbf_is_set_elsewhere(overlap);
}

/* ---- Particles that enter -------------------------------------------------------------------- */

/* A particle that leaves an emitter's opening, where other fluid stands, would be all there at
 * once, half a spacing from what it meets. It enters within the way of a spacing instead, on which
 * its stream moves it: what is still outside does not count in the densities of all that it is
 * near, itself included. So what is in its way has time to give way, at the stream's speed. Near it
 * no other allowance lasts any longer.
 *
 * A stream with jitter, or from an opening that turns, is denser in places while it is moved. What
 * its own particles make of their densities is allowed for as well, until they have parted:
 * otherwise they would part within a step or two of being moved no more, at error times h / dt. */
static inline pbf_entering pbf_entering_of(const pbf_overlap *overlap) {
  if (overlap->entering) return *overlap->entering;
  return {0, 0, 1, 0, 0, {0}, {0}, 1, 0};
}

PBF_FN bool pbf_enters(const pbf_entering &entering, uint32_t id) {
  return id >= entering.first_id && id <= entering.last_id;
}

/* Also what has been let go of just now. */
PBF_FN bool pbf_is_of_stream(const pbf_entering &entering, uint32_t id) {
  return id >= entering.stream_first_id && id <= entering.last_id;
}

/* Whether anything can be found there. */
PBF_FN bool pbf_overlap_reaches(const pbf_entering &entering, pbf_vec x) {
  bool in_box = true;
  for (int k = 0; k < PBF_DIM; ++k)
    in_box = in_box && x.c[k] >= entering.lower[k] && x.c[k] <= entering.upper[k];
  return in_box || !entering.alone;
}

/* What is allowed for of a particle that enters, or is near one: the largest of the density of what
 * is not yet there, of what a stream's own particles make, and of what is left of before. */
PBF_FN pbf_real pbf_overlap_entering(const pbf_entering &entering, pbf_real error, pbf_real outside,
                                     pbf_real of_stream, pbf_real before) {
  const pbf_real now = pbf_real_max(outside, of_stream);
  return pbf_real_min(error, pbf_real_max(now, before * (pbf_real)entering.kept));
}

/* The part of a particle that is placed: all, or none; of a stream's -1 less the part that is still
 * outside. Of what is not let go of that is never nothing, so that all which is near it is told. */
PBF_FN pbf_real pbf_placed_number(const pbf_overlap &found, const pbf_entering &entering,
                                  uint32_t id, pbf_real overlap) {
  constexpr pbf_real LEAST = (pbf_real)0x1p-16;
  if (pbf_is_placed(found, id, overlap)) return 1;
  if (pbf_enters(entering, id)) return -1 - pbf_real_min(pbf_real_max(overlap, LEAST), 1);
  return pbf_is_of_stream(entering, id) ? (pbf_real)-1 : 0;
}

/* ---- Allowances ------------------------------------------------------------------------------ */

/* What is allowed for where steps leave another error than before, such that pressure stays what it
 * is, and fluid at rest has no reason to move. Where they leave more it is below 0: what is to come
 * is borne before it is there. Two things tell what is not to be allowed for: the pressure so far,
 * and the error that there is. By the first alone what moves between steps that go by turns long
 * and short would add up; by the second alone waves would be pressure. What had been allowed for
 * beyond what steps leave is an overlap, and is kept. */
PBF_FN pbf_real pbf_overlap_shifted(const pbf_overlap &found, pbf_real error, pbf_real allowed) {
  const pbf_real before = (pbf_real)found.before, pressed = pbf_real_max(error - allowed, 0);
  pbf_real kept = before > 0 ? pbf_real_min(error - pressed / before, allowed) : 0;
  if (!(kept > (pbf_real)found.reference)) kept = 0;
  const pbf_real by_error = (error - kept) * (pbf_real)found.now;
  const pbf_real by_pressure = before > 0 ? pressed * (pbf_real)(1 - found.part) : by_error;
  const pbf_real shifted = error - (by_error + by_pressure) / 2;
  return pbf_real_max(shifted, (pbf_real)-found.least);
}

/* What is allowed for of a particle's density, of which `placed_density` is contributed by what has
 * been placed, and `stream_density` by a stream's particles; `before`: already, to which that adds.
 * Of a particle that was itself placed it is all of its error; of one that was set elsewhere, maybe
 * with its vessel and all of the water there, all but what weight presses it by. */
PBF_FN pbf_real pbf_overlap_found(const pbf_constants *c, const pbf_overlap &found,
                                  const pbf_entering &entering, uint32_t id, pbf_real density,
                                  pbf_real placed_density, pbf_real stream_density,
                                  pbf_real before) {
  const pbf_real error = pbf_real_max(density - c->target, 0);
  if (pbf_is_set_elsewhere(before)) return pbf_real_max(error - (pbf_real)found.least, 0);
  if (pbf_is_placed(found, id, before)) return pbf_real_max(before, error);
  const pbf_real of_stream =
      pbf_is_of_stream(entering, id) ? stream_density + c->value_scale - c->target : 0;
  if (pbf_enters(entering, id))
    return pbf_overlap_entering(entering, error, placed_density + before * c->value_scale,
                                of_stream, 0);
  if (placed_density > 0 && entering.struct_size)
    return pbf_overlap_entering(entering, error, placed_density, pbf_real_min(of_stream, before),
                                before);
  const pbf_real shifted =
      found.part < 0 || found.part > 0 ? pbf_overlap_shifted(found, error, before) : before;
  if (!(placed_density > 0)) return shifted;
  return pbf_real_max(shifted, pbf_real_min(error, before + placed_density));
}

/* What is allowed for of a particle that is still inside a solid, and has an overlap: whatever its
 * density comes to be, for it is the solid's push that takes it out, at a speed of its own. Where a
 * wall stands in the way of that push, pressure would find another, and drive what gathers between
 * the two out at many times that speed. */
constexpr pbf_real PBF_OVERLAP_IN_SOLID = 64;

template <class Obstacles>
PBF_FN bool pbf_is_in_solid(const Obstacles &o, pbf_vec x) {
  for (int k = 0; k < pbf_surface_count(o); ++k) {
    pbf_vec normal;
    if (!pbf_surface_is_beyond(&o.surfaces[k], x, 0) &&
        pbf_surface_distance(&o.surfaces[k], x, &normal) < -4 * o.surfaces[k].rounding)
      return true;
  }
  return false;
}

template <class Obstacles>
PBF_FN pbf_real pbf_overlap_at(const Obstacles &o, pbf_vec x, pbf_real overlap) {
  return overlap > 0 && pbf_is_in_solid(o, x) ? PBF_OVERLAP_IN_SOLID : overlap;
}

/* An allowance is for an error that there is: at most twice it, so that what has parted faster than
 * its allowance falls does not come together again without pressure, nor what has left a solid. The
 * last fifth is left alone, which is as small as errors of waves are. */
PBF_FN pbf_real pbf_overlap_of_error(pbf_real overlap, pbf_real error) {
  return pbf_real_min(overlap, pbf_real_max(2 * error, (pbf_real)0.2));
}

/* What is left of an allowance a step later, `decay` being pbf_constants.overlap_decay: from 1 to a
 * fifth it falls evenly, and what exceeds 1, or is less, exponentially. What exceeds 1 is gathered
 * in few places, as where a solid has closed upon fluid: it may part ten times as fast and be slow.
 * What is small is small over all of a tank's height, as after a change of the step, and there the
 * ways of all layers add up to the surface's. */
PBF_FN pbf_real pbf_overlap_left(pbf_real decay, pbf_real overlap) {
  if (pbf_is_set_elsewhere(overlap)) return overlap;
  const pbf_real goes = pbf_real_min(1, 5 * overlap) + 10 * pbf_real_max(overlap - 1, 0);
  const pbf_real left = overlap - decay * goes;
  return overlap > 0 ? pbf_real_max(left, 0) : pbf_real_min(left, 0);
}

#endif
