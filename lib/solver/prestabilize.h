/* Pre-stabilization: particles that were placed too densely are moved apart before their first
 * step. Outside of a placement the way of a particle is the sum of its velocities, so what comes to
 * a fluid that has been stepped is no placement, nor is a shift of the world's origin. */
#ifndef PBF_LIB_SOLVER_PRESTABILIZE_H
#define PBF_LIB_SOLVER_PRESTABILIZE_H

#include "colliders.h"

/* Whether it matters how all positions at once are set now. */
int pbf_setting_matters(const pbf_solver *solver);

/* They have been: it does not matter how; all farther by the same, or to other places. */
void pbf_note_set(pbf_solver *solver);
void pbf_note_shift(pbf_solver *solver, const double shift[3]);
void pbf_note_set_anew(pbf_solver *solver);

/* Particles are added to those that there are; of the new ones some were at one point. */
void pbf_note_added(pbf_solver *solver, int were_parted);

/* These of its colliders have been set elsewhere, all farther by the same. */
void pbf_note_collider_shift(pbf_solver *solver, const pbf_collider_set *colliders,
                             const double shift[3]);

/* The parameters change to these: densities may change with them, or walls jump over particles. */
void pbf_note_params(pbf_solver *solver, const pbf_params *params);

/* What a step that fails after it puts back: rows' positions, null where none was moved. */
typedef struct pbf_before_projection {
  void *positions;
  pbf_placement placement;
} pbf_before_projection;

/* Before steps. Acts only on a placement, and where params.prestabilization asks for it. One of the
 * two below follows, whatever it returns. */
pbf_status pbf_prestabilize(pbf_solver *solver, pbf_before_projection *before);

/* The step has not been done: as all was before. */
void pbf_prestabilize_undo(pbf_solver *solver, pbf_before_projection *before);

/* It has. */
void pbf_prestabilize_accept(pbf_solver *solver, pbf_before_projection *before);

#endif
