/* What a surface's shape is: a struct of a few functions in a file of its own, and a name in the
 * list of surface.h. A shape has
 *
 *   ID                       its PBF_COLLIDER_…
 *   HAS_AXIS                 its frame is its axis and perpendiculars to it, not its own axes
 *   FACES                    planes that its inside contributes density by; 0: the nearest alone
 *   bound(collider)          nothing of it is farther from its center
 *   volume(collider, beyond) of its inside and what is up to `beyond` out of it, in 2D an area
 *   extent(surface, axis)    how far it reaches from its center along an axis
 *   distance(surface, p, *normal)
 *                            of p, which counts from the center: negative inside; *normal points
 *                            out
 *   width(surface)           the distance of the closest two parallel planes that it fits between
 *   blocks(surface, p, way)  whether the straight way from p, which counts from the center and is
 *                            outside, to p + way meets it
 *   face(surface, k, p, *normal)
 *                            where there are FACES: the distance from the k-th of them, of what is
 *                            inside, where *normal points
 *
 * What is infinite is INFINITY. */
#ifndef PBF_PHYSICS_SURFACES_SHAPE_H
#define PBF_PHYSICS_SURFACES_SHAPE_H

#include <pbf/pbf_backend.h>

#include "physics/real.h"

/* A collider at the end of a step, and where it was at its start; prepared once a step in float64
 * for use in the particles' precision. Rows of `frame` are directions in space. */
typedef struct pbf_surface {
  int shape;
  pbf_real sign; /* 1: the fluid stays outside, -1: inside */
  pbf_vec center;
  pbf_vec frame[PBF_DIM];
  pbf_vec half_extents;
  pbf_real radius, half_length;
  pbf_real bound;                             /* nothing of it is farther from the centre */
  pbf_vec start_center, start_frame[PBF_DIM]; /* longer by what it has grown along them */
  pbf_real step, turn; /* way of the centre in the step; of any other point, over its distance from
                          there, at most */
  pbf_real skin;       /* how far before it particles stay, and */
  pbf_real rounding;   /* what rounding may take from distances: see pbf_set_margins */
  pbf_real prediction_push, iteration_push; /* the way by which one of these takes out of it, at
                                               most, what it finds inside: see pbf_set_push */
  pbf_vec gain;          /* what its centre moves more in the step than in the one before, … */
  pbf_real turn_gain[3]; /* … and what it turns more; all 0: it goes on evenly */
  int gains;
  pbf_real steepest;      /* its distance changes by so many times the way, at most */
  pbf_real scale;         /* of what its distances are interpolated in: field.h; */
  const pbf_shape *field; /* null: it has a closed form */
  uint64_t field_id;      /* which tells one apart from a later one in the same place */
} pbf_surface;

/* One that is known to have a closed form. Code for these alone has none for fields, for which a
 * GPU's kernels would need registers whether or not there are any. */
struct pbf_closed_surface : pbf_surface {};

#endif
