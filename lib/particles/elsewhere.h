/* Particles that are set elsewhere: they are where no step has moved them, as those that are added.
 */
#ifndef PBF_LIB_PARTICLES_ELSEWHERE_H
#define PBF_LIB_PARTICLES_ELSEWHERE_H

#include "solver/solver.h"

/* Positions that are about to be written to these rows; `shift` is what all particles go along
 * with, 0 where they do not. What is pushed in by no more than a solid may push out in a step moves
 * by that, as what a caller's own constraint pushes. */
typedef struct pbf_set_rows {
  uint32_t first, count;
  const void *before, *positions;
  double shift[3];
} pbf_set_rows;

/* Has the next step take those that go elsewhere for placed. */
pbf_status pbf_elsewhere_note(pbf_solver *solver, const pbf_set_rows *rows);

#endif
