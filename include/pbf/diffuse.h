/* pbf/diffuse.h: spray, foam and air bubbles, for looks.
 *
 * Diffuse particles show the air that moving water takes in, finer than the fluid's own particles
 * can: Ihmsen, Akinci, Akinci & Teschner, "Unified spray, foam and air bubbles for particle-based
 * fluids", The Visual Computer 28, 2012. They come from the fluid and go with it, and do not act on
 * it: it has the same bits with them and without.
 *
 * At the end of a step, on the host, by the fluid's positions and velocities of then:
 *   kinds     by n, the particles of the fluid within h: spray where n < foam_neighbors, a bubble
 *             where n > bubble_neighbors, foam between.
 *   spray     dv/dt = g - spray_drag v, solved exactly: a parabola where spray_drag is 0.
 *   foam      moves with the fluid: v is the fluid's, at x the straight line that fits those of its
 *             particles within h best by the weights W below.
 *   bubbles   dv/dt = -buoyancy g + bubble_drag (v_fluid - v), solved exactly: in fluid at rest
 *             they come to rise at buoyancy |g| / bubble_drag.
 *   solids    the domain's walls, where they are, and colliders push them out, and take what of
 *             their velocity leads in; periodic axes lead to the other side.
 *   birth     each particle i of the fluid makes, per unit of time,
 *               I_k (trapped_air_rate I_ta + wave_crest_rate I_wc),
 *             each I rising from 0 at the member …_min to 1 at …_max, a straight line between:
 *               I_k   of |v|²/2
 *               I_ta  of sum_j (|v_ij| - v_ij·x_ij/|x_ij|) W_ij / W0, a speed: what comes together
 *               I_wc  of sum_j (1 - n_i·n_j) W_ij / W0 over neighbours j behind the tangent plane,
 *                     where n_i·v_i >= 0.6 |v_i|: crests that go ahead
 *             with W = 1 - |x_ij|/h, W0 its sum around a particle in the lattice at rest, and
 *             normals n from the weighted mean of neighbours to the particle, at surfaces alone.
 *             So many are made to one after any number of steps. They begin in the cylinder that
 *             the particle, half a spacing wide, passes through in that time, with its velocity.
 *   death     after lifetime_min … lifetime_max, as I_k times the larger of the others is 0 … 1; or
 *             when there is no room for a new one, and it is the oldest.
 *
 * So the memory is bounded, and taken when they are set: 80 bytes for each of `capacity`, beside
 * what queries keep (query.h) and, with a wave_crest_rate, 16 bytes for each particle of the fluid.
 * A step without room for the latter fails and leaves all as it was. The same bits on a backend
 * with any number of threads and however steps are divided into calls, since random numbers follow
 * from `seed` and a particle's number alone. Part of saved states, not of pbf_hash: copies of a
 * scene that are shown with more of them and less have the same hash.
 *
 * A solver without them has no memory and no time for them; with them steps are made `interval` at
 * a time at most, each followed by one look at the fluid, from a device by way of a copy. Where
 * nothing is as fast as energy_min asks, and none are left, that is a look at the velocities. The
 * rules of pbf.h hold here, too.
 */
#ifndef PBF_DIFFUSE_H
#define PBF_DIFFUSE_H

#include <pbf/pbf.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Spray, foam and bubbles ---------------------------------------------------------------- */

/* Kinds of diffuse particles. */
enum { PBF_DIFFUSE_SPRAY = 0, PBF_DIFFUSE_FOAM = 1, PBF_DIFFUSE_BUBBLE = 2 };

/* How many there may be, and what makes, moves and ends them: the equations are above. */
typedef struct pbf_diffuse_desc {
  uint32_t struct_size;
  uint32_t capacity;         /* at most so many at once, 1 … PBF_MAX_DIFFUSE */
  uint32_t seed;             /* of where in their cylinders they begin */
  uint32_t interval;         /* they move after every so many steps, 1 … 1000 */
  uint32_t foam_neighbors;   /* fewer: spray */
  uint32_t bubble_neighbors; /* more: a bubble; at least foam_neighbors */
  double trapped_air_min;    /* a speed, >= 0 */
  double trapped_air_max;    /* above trapped_air_min, and so for all pairs but lifetimes */
  double wave_crest_min;     /* without a unit, >= 0 */
  double wave_crest_max;
  double energy_min; /* of |v|²/2, >= 0 */
  double energy_max;
  double trapped_air_rate; /* particles a unit of time that one of the fluid makes, >= 0 */
  double wave_crest_rate;
  double lifetime_min; /* times, >= 0 */
  double lifetime_max; /* at least lifetime_min */
  double buoyancy;     /* of bubbles, in gravities, >= 0 */
  double bubble_drag;  /* by the fluid, 1/time, >= 0 */
  double spray_drag;   /* by air at rest, 1/time, >= 0 */
  double scatter; /* >= 0: velocities begin so far off the fluid's, across it, at the cylinder's
                     side: as a part of its speed */
} pbf_diffuse_desc;

/* Diffuse particles of a solver. */
#define PBF_MAX_DIFFUSE 0x3fffffu

/* Fills *desc with what suits the solver's dimension, smoothing_radius, spacing and gravity as they
 * are now; docs/looks.md says how. */
PBF_API pbf_status pbf_diffuse_init(pbf_solver *solver, pbf_diffuse_desc *desc,
                                    uint32_t struct_size);

/* Has the solver make and move them from now on; those that there are stay, the youngest where
 * there is room for fewer. With null there are none, and their memory is given back.
 * On ranks each has all of them, and reads all of the fluid when they move. */
PBF_API pbf_status pbf_set_diffuse(pbf_solver *solver, const pbf_diffuse_desc *desc);

/* desc->struct_size must be set. PBF_ERROR_STATE where there are none. */
PBF_API pbf_status pbf_get_diffuse(pbf_solver *solver, pbf_diffuse_desc *desc);

/* How many there are, and what became of others since they were set. */
typedef struct pbf_diffuse_info {
  uint32_t struct_size;
  uint32_t capacity; /* 0: the solver has none; then all is 0 */
  uint32_t count;    /* now: the sum of the next three */
  uint32_t spray;
  uint32_t foam;
  uint32_t bubbles;
  double time;        /* as of which they are: of the last of `interval` steps */
  uint64_t generated; /* by the fluid, ever */
  uint64_t expired;   /* their lifetime was over */
  uint64_t recycled;  /* made way for younger ones */
} pbf_diffuse_info;

/* info->struct_size must be set. */
PBF_API pbf_status pbf_get_diffuse_info(pbf_solver *solver, pbf_diffuse_info *info);

/* Which of them, and where they go; null: that is not asked for. Of those numbered first …
 * first + count - 1, the oldest being 0, number c of the i-th goes to
 * array + i * stride + c * (bytes of its element): an array of the caller's structs, say. */
typedef struct pbf_diffuse_read {
  uint32_t struct_size;
  uint32_t first;
  uint32_t count;
  uint32_t element_type; /* of what is a void *: PBF_TYPE_FLOAT32, PBF_TYPE_FLOAT64; 0: the solver's
                            own */
  uint32_t components;   /* of positions and velocities: 2, 3, in 2D with 0 as the third; 0: as many
                            as there are dimensions */
  uint32_t reserved;     /* 0 */
  uint64_t stride;       /* bytes from one to the next in all arrays; 0: each without gaps */
  void *positions;
  void *velocities;
  void *ages;
  void *lives;     /* times that are left to them, > 0 */
  uint32_t *kinds; /* PBF_DIFFUSE_…, by which they have moved last */
  uint64_t *ids;   /* ascending, never given again */
} pbf_diffuse_read;

/* Writes what is asked for of those that there are. */
PBF_API pbf_status pbf_read_diffuse(pbf_solver *solver, const pbf_diffuse_read *read);

/* Adds `count` of the caller's own, as the youngest: positions and velocities of shape (count,
 * dimension) and lives (> 0) of shape (count), in the solver's element type; velocities may be
 * null: 0. What is outside the domain is moved in. Where there is no room the oldest make way;
 * count is at most the capacity. PBF_ERROR_STATE before pbf_set_diffuse. */
PBF_API pbf_status pbf_add_diffuse(pbf_solver *solver, uint32_t count, const void *positions,
                                   const void *velocities, const void *lives);

/* Moves all of them by way[dimension], as where the origin of the world is moved. */
PBF_API pbf_status pbf_shift_diffuse(pbf_solver *solver, const double *way);

#ifdef __cplusplus
}
#endif

#endif
