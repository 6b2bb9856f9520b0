/* pbf/colliders.h: solids that the fluid meets, how they stand and move. Bodies do not react by
 * themselves: loads.h tells what the fluid does to them.
 *
 * The rules of pbf.h hold here, too.
 */
#ifndef PBF_COLLIDERS_H
#define PBF_COLLIDERS_H

#include <pbf/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Colliders ------------------------------------------------------------------------------- */

/* A solid of any form, for PBF_COLLIDER_SHAPE: shapes.h makes them. */
typedef struct pbf_shape pbf_shape;

/* Shapes of a collider: which of its sizes it has. */
enum {
  PBF_COLLIDER_PLANE = 0,
  PBF_COLLIDER_SPHERE = 1,
  PBF_COLLIDER_CAPSULE = 2,
  PBF_COLLIDER_BOX = 3,
  PBF_COLLIDER_SHAPE = 4 /* that of `geometry` */
};

/* How a collider that turns goes from where it is set. */
enum {
  PBF_PATH_AUTO = 0, /* the one of the others by which the velocities that it was set with before
                        have led nearer to where it is set now; at first straight */
  PBF_PATH_STRAIGHT = 1, /* `velocity` stays what it is in space, as that of a body that flies, or
                            of a chord: (next position - position) / time between */
  PBF_PATH_SCREW = 2     /* `velocity` turns with the collider, as w x r, that of a body that turns
                            about a pivot; parts of a rigid body stay together */
};

/* The fluid stays outside (plane: on the side of its normal), or, inverted, inside. Particle
 * centres are kept out of the surface, 0.001 h before that of a shape with an end; with
 * `wall_density` 1 fluid comes to rest half a spacing off it, with 0 there. A collider moves by its
 * velocities through every step, without being set again. */
typedef struct pbf_collider {
  uint32_t struct_size;
  uint32_t shape;             /* PBF_COLLIDER_… */
  uint32_t inverted;          /* 1: a container */
  uint32_t path;              /* PBF_PATH_… */
  double position[3];         /* centre; of a plane: any point of it */
  double orientation[4];      /* unit quaternion x, y, z, w; 2D: a turn about z */
  double velocity[3];         /* of `position` */
  double angular_velocity[3]; /* radians a time unit, about `position`; 2D: z only */
  double axis[3];             /* plane: normal, capsule: direction; before `orientation` turns it */
  double half_extents[3];     /* box */
  double radius;              /* sphere, capsule */
  double half_length;         /* capsule: from the centre to either end of its segment */
  double half_extents_rate[3]; /* length/time: how sizes grow, … */
  double radius_rate;
  double half_length_rate; /* … or shrink, down to 0 */
  double duration; /* time, >= 0: so long it moves and grows, and then stands still; 0: for ever */
  pbf_shape
      *geometry;     /* PBF_COLLIDER_SHAPE; others: null. The solver takes references of its own */
  double scale;      /* > 0: how many times as large as `geometry` it is */
  double scale_rate; /* 1/time */
  double friction, static_friction, no_slip; /* as pbf_params.wall_friction, _static_friction and
                                                _no_slip, against the collider's own motion */
  double adhesion;                           /* as pbf_params.wall_adhesion */
  /* Told, and not looked at where it is set: the velocities with which it has come to where it was
   * set, those of one that was not there before. What changes them presses on deep water at once.
   */
  double last_velocity[3];
  double last_angular_velocity[3];
} pbf_collider;

/* Of a solver. What a step takes goes by how many are near the fluid, and memory by how many there
 * are, about 2 KB each; of more than 64 on a GPU up to 2.6 KB on the device and 4 KB on the host.
 */
#define PBF_MAX_COLLIDERS 4096u

/* Fills *collider: the shape at rest at the origin, axis +y, sizes and scale 1, half_length 1. */
PBF_API pbf_status pbf_collider_init(pbf_collider *collider, uint32_t struct_size, uint32_t shape);

/* Replaces all colliders. `colliders` is an array of `count` structs, each of the size in
 * colliders[0].struct_size. Poses hold at the solver's present time. One that is set anew step by
 * step wants the velocities that it moves with: where a collider jumps, what it then presses
 * together counts as found, and steps shorter than a fiftieth of a fall by h, which undo their
 * share only, hardly push it away. PBF_ERROR_INVALID_ARGUMENT: more than PBF_MAX_COLLIDERS.
 * PBF_ERROR_UNSUPPORTED: more than the backend takes. */
PBF_API pbf_status pbf_set_colliders(pbf_solver *solver, uint32_t count,
                                     const pbf_collider *colliders);

/* Moves the colliders that there are to these poses and sizes, as engines move kinematic bodies:
 * each reaches targets[i] exactly `duration` (time, > 0; that of a frame) from now, on the screw
 * from where it stands now that turns by less than half a turn, and stands still from then on
 * unless it is moved on. `targets` is an array of `count` structs, as for pbf_set_colliders; shape,
 * inverted and, of planes and capsules, axis are those of the collider, velocities, rates, path and
 * duration are not looked at. The colliders of a rigid body keep their distances on the way, and so
 * a vessel of them its water. PBF_ERROR_INVALID_ARGUMENT: count is not that of
 * pbf_get_collider_count, a target is of another kind, or duration is not above 0 and finite.
 * Threads, as for all of a solver's calls: one at a time. */
PBF_API pbf_status pbf_move_colliders(pbf_solver *solver, uint32_t count,
                                      const pbf_collider *targets, double duration);

/* How many pbf_set_colliders has set. */
PBF_API pbf_status pbf_get_collider_count(pbf_solver *solver, uint32_t *count);

/* Collider `index` as it stands and moves now; of a motion with an end, `duration` is what is left
 * of it. collider->struct_size must be set. */
PBF_API pbf_status pbf_get_collider(pbf_solver *solver, uint32_t index, pbf_collider *collider);

#ifdef __cplusplus
}
#endif

#endif
