/* pbf/emit.h: in and out. Emitters add particles in each step, drains and lifetimes remove them,
 * reservoirs do both.
 *
 * Each step begins with it: particles at the end of their lifetime, those in drains and those that
 * a reservoir has too many of go, then each emitter in turn adds what has left its opening by then,
 * and each reservoir what it lacks. So results do not depend on how
 * steps are divided into calls, and are the same bits again. It is part of saved states, and of
 * pbf_hash where there is any. A step that fails afterwards is not given the same particles twice.
 *
 * A particle stands for the volume spacing^dimension. The rules of pbf.h hold here, too. A solver
 * without any of them has no memory and no time for them; with drains each step looks at all
 * positions, with reservoirs it does so twice, on a device by a copy of them. What removes
 * particles wakes those asleep, what adds some wakes as pbf_params.sleep_speed says.
 */
#ifndef PBF_EMIT_H
#define PBF_EMIT_H

#include <pbf/query.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Emitters and drains -------------------------------------------------------------------- */

/* In 2D both are a line. */
enum { PBF_EMITTER_RECTANGLE = 0, PBF_EMITTER_DISC = 1 };

/* An opening across a stream. Particles leave it in columns, a spacing apart, and one after
 * another, in a lattice that moves with the stream: so many a time unit as the rate is particles,
 * to one after any number of steps. Until a particle is h away it goes on by the stream's velocity
 * alone, whatever it meets: what is in its way gives way, and so an opening may lie under water. On
 * the first spacing of that way it comes to count as a particle. */
typedef struct pbf_emitter {
  uint32_t struct_size;
  uint32_t shape;     /* PBF_EMITTER_… */
  uint32_t recycle;   /* where the solver is full: 1: the oldest particles of it, those with the
                         lowest ids, make way; 0: what does not fit is lost */
  uint32_t seed;      /* of the jitter */
  double position[3]; /* the middle of the opening, in the domain with all of its columns */
  double velocity[3]; /* of the stream, not 0; the opening is across it */
  double across[3];  /* in 3D: where the first side of a rectangle, or the rows of a disc's columns,
                        points, less what of it goes along the stream */
  double half_width; /* rectangle: half of its first side, > 0; in 2D the only one */
  double half_height; /* half of the other, > 0 */
  double radius;      /* disc, > 0 */
  double rate;        /* volume a time unit, >= 0; 0: as much as columns of particles a spacing
                         apart carry at this velocity, which is the most that may be */
  double jitter;      /* 0 … 1, in spacings: so far columns waver along the opening */
  double lifetime;    /* of its particles, >= 0; 0: for ever */
  uint32_t phase;     /* of its particles (phases.h), below pbf_get_phase_count, or 0 */
  uint32_t reserved;  /* 0 */
} pbf_emitter;

/* Emitters and drains of a solver. */
#define PBF_MAX_EMITTERS 64u
#define PBF_MAX_DRAINS 64u

/* Fills *emitter: at the origin, velocity 1 along -y, sizes 1, all else 0; across is x. */
PBF_API pbf_status pbf_emitter_init(pbf_emitter *emitter, uint32_t struct_size, uint32_t shape);

/* Replaces all emitters. `emitters` is an array of `count` structs, each of the size of the first.
 * Each goes on where one before was: the same one, whatever its number; or else the nearest of its
 * shape and phase within smoothing_radius, that of its number first; or else that of its number. So
 * a tap can be turned and a hose be swung step by step, and others come and go in the list: what
 * has left an emitter goes straight on, at the speed that the stream has now. What has a lifetime
 * keeps it. */
PBF_API pbf_status pbf_set_emitters(pbf_solver *solver, uint32_t count,
                                    const pbf_emitter *emitters);

/* emitter->struct_size must be set. */
PBF_API pbf_status pbf_get_emitter(pbf_solver *solver, uint32_t index, pbf_emitter *emitter);

/* Replaces all drains: what is in one of these volumes when a step begins is removed. */
PBF_API pbf_status pbf_set_drains(pbf_solver *solver, uint32_t count, const pbf_volume *drains);

/* drain->struct_size must be set. */
PBF_API pbf_status pbf_get_drain(pbf_solver *solver, uint32_t index, pbf_volume *drain);

/* ---- Reservoirs ------------------------------------------------------------------------------ */

/* An open boundary of given level or pressure: a box in which the fluid always stands as deep as it
 * says, as in a tank that is large. Before each step as many particles go, the highest ones first,
 * or come, upon the fluid where that is lowest and with its velocity there, as there are too many
 * or too few for that volume. So it lets in what flows out of it into the rest of the domain, and
 * out what comes. Walls and colliders around it are yours; for a channel that goes on, it is the
 * end of it. */
typedef struct pbf_reservoir {
  uint32_t struct_size;
  uint32_t phase;         /* of what comes (phases.h), below pbf_get_phase_count, or 0 */
  double position[3];     /* the middle of the box, which is in the domain */
  double orientation[4];  /* unit quaternion x, y, z, w; 2D: a turn about z */
  double half_extents[3]; /* > 0; fluid stands along the box's own y axis */
  double depth;     /* how deep, from the box's lower side; above 0, up to 2 half_extents[1] */
  double pressure;  /* >= 0, p/rho0 at the lower side beside what gravity makes: all in the
                       box is pushed towards it by pressure / depth, an acceleration. 0: none */
  uint64_t added;   /* given by pbf_get_reservoir, not looked at when set: particles that … */
  uint64_t removed; /* … came and went since there was a reservoir of this number */
} pbf_reservoir;

/* Reservoirs of a solver. */
#define PBF_MAX_RESERVOIRS 64u

/* Fills *reservoir: at the origin, not turned, half_extents and depth 1, all else 0. */
PBF_API pbf_status pbf_reservoir_init(pbf_reservoir *reservoir, uint32_t struct_size);

/* Replaces all reservoirs. `reservoirs` is an array of `count` structs, each of the size of the
 * first. Where the solver is full, nothing comes, nor where a spacing that has been made smaller
 * since would have it hold more than desc.capacity. */
PBF_API pbf_status pbf_set_reservoirs(pbf_solver *solver, uint32_t count,
                                      const pbf_reservoir *reservoirs);

/* How many there are. */
PBF_API pbf_status pbf_get_reservoir_count(pbf_solver *solver, uint32_t *count);

/* reservoir->struct_size must be set. */
PBF_API pbf_status pbf_get_reservoir(pbf_solver *solver, uint32_t index, pbf_reservoir *reservoir);

/* ---- In and out ------------------------------------------------------------------------------ */

/* What came and went, in particles, since emitters or drains were first set. */
typedef struct pbf_in_out {
  uint32_t struct_size;
  uint32_t emitters; /* that there are */
  uint32_t drains;
  uint32_t reserved; /* 0 */
  uint64_t emitted;  /* by reservoirs, too */
  uint64_t refused;  /* lost: the solver was full, or their place was outside the domain */
  uint64_t recycled; /* made way for others */
  uint64_t drained;  /* by reservoirs, too */
  uint64_t expired;  /* their lifetime was over */
} pbf_in_out;

/* in_out->struct_size must be set. */
PBF_API pbf_status pbf_get_in_out(pbf_solver *solver, pbf_in_out *in_out);

#ifdef __cplusplus
}
#endif

#endif
