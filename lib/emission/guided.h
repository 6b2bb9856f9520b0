/* Particles that have just left their opening go on along a line of their own, wherever the opening
 * is by then. */
#ifndef PBF_LIB_EMISSION_GUIDED_H
#define PBF_LIB_EMISSION_GUIDED_H

#include "emission.h"

double pbf_guided_speed(const pbf_guided *guided);

/* Where it is to be, `ahead` of where it has left. */
void pbf_guided_place(const pbf_guided *guided, double place[3]);

/* Streams end at solids. Of `count` particles, `ahead` says how far each is to go on along its
 * line: it is changed where the line meets a collider or a wall before that. */
typedef enum pbf_guided_end {
  PBF_GUIDED_STOPS,    /* ahead becomes the way up to the solid */
  PBF_GUIDED_IS_LET_GO /* ahead becomes infinite: the stream moves the particle no more */
} pbf_guided_end;
void pbf_guided_meet_solids(const pbf_solver *solver, pbf_guided *guided, uint32_t count,
                            pbf_guided_end end);

/* Positions that are set move lines along, so that a world's origin may float: the first call,
 * before rows are written, keeps where they were; the second, after it, moves the lines. */
pbf_status pbf_guided_keep(pbf_solver *solver, uint32_t first, uint32_t count);
void pbf_guided_move(pbf_solver *solver, uint32_t first, uint32_t count, const void *positions);

#endif
