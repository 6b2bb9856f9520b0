/* How far colliders are set from where the motion of others has led. */
#ifndef PBF_LIB_SOLVER_COLLIDER_WAY_H
#define PBF_LIB_SOLVER_COLLIDER_WAY_H

#include <pbf/pbf.h>

/* What has gone on since colliders were set, and what tells one that is set anew from another. */
typedef struct pbf_collider_change {
  double elapsed;     /* since those before were set */
  double near;        /* so far one may be set from where its motion has led: h */
  double most_growth; /* and so much larger, by that */
  uint32_t dimension;
} pbf_collider_change;

/* The path on which a collider goes on that was one before: a velocity may be meant as a chord to
 * the next pose, or as what it is at the time. Whichever has foretold better where it is set now.
 */
uint32_t pbf_collider_path_after(const pbf_collider *before, double elapsed,
                                 const pbf_collider *now);

/* Whether it is sure, without sines, that one which was set before is less than `near` from where
 * it is set now: no point of it has gone farther, on its way and from where it was to where it is
 * now, than all that is added up here. */
int pbf_collider_is_surely_near(const pbf_collider_change *change, const pbf_collider *before,
                                const pbf_collider *next);

/* How far it is set from where the motion of one before (null: none) has led to; returns how far
 * its surface has turned, without end if that is none of its kind and size. */
double pbf_collider_find_way(const pbf_collider_change *change, const pbf_collider *before,
                             const pbf_collider *next, double way[3]);

#endif
