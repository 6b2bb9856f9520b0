/* Overlap: what has been placed in fluid that steps have moved, and what the backend is told of it.
 */
#ifndef PBF_LIB_SOLVER_OVERLAP_H
#define PBF_LIB_SOLVER_OVERLAP_H

#include "colliders.h"

/* The particles of these rows are where no step has moved them. */
void pbf_overlap_note_particles(pbf_solver *solver, uint32_t first_id, uint32_t last_id);

/* Whatever all particles are too dense by, no step has made it. */
void pbf_overlap_note_all(pbf_solver *solver);

/* The backend keeps what overlaps, for the host to write to: the next step looks for it. */
pbf_status pbf_overlap_expect(pbf_solver *solver);

/* These of its colliders are where nothing has moved them. */
void pbf_overlap_note_colliders(pbf_solver *solver, const pbf_collider_set *colliders);

/* Walls have jumped into the fluid. */
void pbf_overlap_note_walls(pbf_solver *solver);

/* The next step has this length: those before may have been much longer. */
void pbf_overlap_note_step(pbf_solver *solver, double time_step);

/* A pressure grid comes or goes by what the caller says: steps left so much before. */
double pbf_overlap_steps_leave(pbf_solver *solver);
void pbf_overlap_note_grid(pbf_solver *solver, double before);

/* Nothing overlaps any more. */
pbf_status pbf_overlap_forget(pbf_solver *solver);

/* Has the backend keep as much as a state that is loaded had. */
pbf_status pbf_overlap_restore(pbf_solver *solver, const pbf_overlap_state *overlap);

/* Whether steps look for any. */
int pbf_overlap_can_be_found(const pbf_solver *solver);

/* Tells the backend before steps, `entering` (null: none), too, of which it sets `alone`; *steps
 * becomes the number of those, the same or fewer, for which that holds. */
pbf_status pbf_overlap_to_backend(pbf_solver *solver, pbf_entering *entering, uint32_t *steps);

#endif
