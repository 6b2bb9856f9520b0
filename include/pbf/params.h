/* pbf/params.h: the parameters of a solver, which may change between steps.
 *
 * docs/parameters.md is a table of them, docs/guide.md shows what each does, docs/choosing.md how
 * to choose them. "eq. n" is an equation of Macklin & Müller, see pbf.h; its rules hold here,
 * too.
 */
#ifndef PBF_PARAMS_H
#define PBF_PARAMS_H

#include <pbf/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Parameters ------------------------------------------------------------------------------ */

/* Density kernel with the gradient used for the position change. */
enum {
  PBF_KERNEL_WENDLAND_C2 = 0, /* one kernel for both: a symmetric system, see `over_relaxation` */
  PBF_KERNEL_POLY6_SPIKY = 1  /* poly6 density, spiky gradient: eqs. 2 and 4 with the kernels of
                                 Müller et al. 2003, as in the paper */
};

/* How the density solve iterates. */
enum {
  PBF_SOLVER_JACOBI = 0,   /* Algorithm 1: every iteration starts from nothing */
  PBF_SOLVER_CHEBYSHEV = 1 /* lambda adds up over the iterations of a step, and keeps its sign but
                              for `cohesion`; accelerated by the Chebyshev semi-iteration */
};

/* When the domain's walls and the colliders act within a step (bits, at least one). */
enum {
  PBF_COLLIDE_AFTER_PREDICTION = 1,
  PBF_COLLIDE_IN_ITERATION = 2, /* Algorithm 1, line 14 */
  PBF_COLLIDE_AFTER_SOLVE = 4
};

/* Axes along which the domain is periodic (bits). */
enum { PBF_PERIODIC_X = 1, PBF_PERIODIC_Y = 2, PBF_PERIODIC_Z = 4 };

/* Indices of the six walls in the arrays below: 2 * axis for the lower wall, + 1 for the upper. */
enum {
  PBF_WALL_X_MIN = 0,
  PBF_WALL_X_MAX = 1,
  PBF_WALL_Y_MIN = 2,
  PBF_WALL_Y_MAX = 3,
  PBF_WALL_Z_MIN = 4,
  PBF_WALL_Z_MAX = 5
};

/* In 2D every third component is ignored. Numbers are finite in the solver's precision, in float64
 * at most 1e150 in size. */
typedef struct pbf_params {
  uint32_t struct_size;
  uint32_t kernel; /* PBF_KERNEL_… */

  double smoothing_radius; /* h > 0: the kernels vanish at r >= h. In float32 1e-8 … 1e11, in
                              float64 1e-75 … 1e75 units of length */
  double spacing;          /* rest distance of the particles, 0 < spacing < h; 0: h/2 */
  double particle_volume; /* V, 1e-6 … 1000 h^dimension; 0: such that a square or cubic lattice of
                             `spacing` has density 1 */

  double time_step;    /* > 0; no particle is faster than the sum of domain_max - domain_min in one,
                          which as a speed is at most 1e18, in float64 1e150 */
  uint32_t iterations; /* of the density solve in a step, >= 1 */
  uint32_t collide;    /* PBF_COLLIDE_… bits */

  double gravity[3];
  double attraction; /* a further acceleration -attraction (x - attraction_center), 1/s² */
  double attraction_center[3];

  double
      over_relaxation; /* omega, 0 … 1e6, a factor on the position change (1 in the paper); 0: from
                     the largest eigenvalue of the Jacobi iteration on the lattice, always stable */
  double cfm;          /* constraint force mixing, eq. 11, without a unit: cfm * h² */

  double cohesion; /* 0 … 1, how much the fluid holds together. With JACOBI densities below rest
                      pull with this weight (1: as in the paper, 0: never). With CHEBYSHEV free
                      surfaces never pull; fluid inside, which lacks little density, holds together
                      with this part of the weight of a column of 8 h, or of what its stiffness
                      allows (docs/solver.md); without gravity nothing pulls */
  double min_diagonal; /* minimum of the denominator of eq. 11, in units of that of the rest
                          lattice, >= 0: keeps particles with few or coincident neighbours calm; 0:
                          as in the paper */
  double wall_density; /* 0 … 1: weight of the density that walls and colliders contribute to the
                          fluid before them, as if they were fluid at rest: particles then keep half
                          a spacing off; 0: none, as in the paper: particles pile up on walls. With
                          a smoothing_radius of 2.55 spacings or more the domain's walls, where they
                          are no nearer to each other than that, mirror the fluid instead */

  double scorr_k;   /* artificial pressure, eq. 13: k, an area, at most 1e6 h²; 0: none. With
                       CHEBYSHEV no more of it acts than a step can integrate */
  double scorr_dq;  /* delta q / h, in (0, 1); this and the exponent are not looked at, and may be
                       anything, while scorr_k is 0 */
  uint32_t scorr_n; /* exponent, 1 … 8 */
  uint32_t solver;  /* PBF_SOLVER_… */

  double vorticity; /* vorticity confinement, eq. 16, a speed, at most 1e6 h / time_step; 0: none.
                       With CHEBYSHEV no more of it acts than 0.01 h / time_step, beyond which
                       eddies feed themselves */
  double viscosity; /* kinematic, a length² a time unit: water 1e-6 m²/s, honey 0.005.
                       dv/dt = viscosity laplace v, by the implicit Euler method (Weiler, Koschier,
                       Brand & Bender 2018): acts on shear alone, conserves momentum and angular
                       momentum, and flows that are steady are right at any time step. Acts on the
                       velocities that a step predicts with, before its density is solved. Takes
                       two passes over pairs a step and more, up to 107, the thicker the fluid, the
                       longer the step and the shorter h are; what they are not enough for (some
                       25 h² / time_step) does not act. With
                       PBF_SOLVER_JACOBI XSPH, eq. 17, without a unit, of which 1 is the maximum
                       that acts, and in crowds what makes a velocity the mean of those around it.
                       0: none */

  /* Domain box. A wall stands at  bound + velocity t + amplitude sin(frequency t + phase)  with t
   * the solver's time (pbf_info.time) at the end of the step; frequency in radians a time unit. The
   * sine of an angle of 2^52 and more, which is known to no part of a turn, counts as 0.
   * In float32 a bound farther from the origin than four lengths of the domain must be within 2,097
   * spacings of it, any other within 167,772. Fluid that has too little room in it, or in an
   * inverted collider, takes the density with which it fills that, with PBF_SOLVER_CHEBYSHEV. */
  double domain_min[3];
  double domain_max[3];
  double wall_velocity[6];
  double wall_amplitude[6];
  double wall_frequency[6];
  double wall_phase[6];

  double search_cell_width; /* cell width of the neighbour search, >= h; 0: the backend's choice.
                               Only `reference` obeys it. Never changes which pairs interact. */

  /* Sleep: fluid at rest keeps its place at velocity 0, goes on carrying what lies on it, and costs
   * next to nothing. What counts is the velocity of the fluid around a particle, itself included,
   * as a root mean square over about `sleep_time`: a fluid at rest trembles without flowing. Below
   * `sleep_speed` a particle falls asleep, unless fluid three times as fast is within h of it. Such
   * fluid, or a moving wall or collider, also wakes it, within h. A change of the parameters but
   * time_step, and particles that are set or removed, wake all; so do those that are added, once
   * they are as many as lie in one layer of a cube of the fluid, since the level rises, and a
   * collider that has stood still, with fluid asleep within h of it, as soon as it moves, is set
   * elsewhere or is removed: what it held is held no longer. */
  double sleep_speed; /* a length a time unit, in float32 at most 1e18; 0: nothing sleeps;
                         0.1 sqrt(|g| spacing) will do */
  double sleep_time;  /* > 0 where anything sleeps; half a second will do */

  double tolerance; /* >= 0: the density solve of a step ends with the iteration that finds a mean
                       of max(rho/rho0 - 1, 0) (in very short steps less what they leave for later)
                       of at most this, and after `iterations` in any case; 0: always after these.
                       Of particles asleep only those within h of a particle awake count. */
  double pressure_grid; /* deep water: cell width, in units of h, of a coarse grid on which, before
                           the iterations, the pressure of the fluid's weight is found, so far as
                           it is more than these carry, by about a layer each: 1 … 1000; 0: none.
                           Linear momentum is then kept only about as well as particles fill the
                           cells evenly. -1, the default: 2 with PBF_SOLVER_CHEBYSHEV where the
                           particles would settle so deep, H, in the domain, in an inverted sphere,
                           capsule or box, or between other colliders, that
                           g H dt² > 0.06 iterations spacing² (18 layers of the defaults), or 16
                           layers of as much, that attraction weighs around a solid or in a
                           container; or 6 with shear_stress_correction, 18 where that is -1; or 0.
                           Decided at the begin of each pbf_step by as many particles as there are,
                           or as the last step was for, unless a quarter of these is gone: it would
                           flicker where particles come and go. Solids of up to two cells part the
                           grid where they part the fluid. A domain of too many cells keeps those
                           around the fluid; where these are too many they are wider. */
  double prestabilization; /* >= 0, with PBF_SOLVER_CHEBYSHEV: where the mean of max(rho/rho0 - 1,
                              0) is above this, or the largest above 25 times this, a fluid that
                              has been placed is moved to rest density before its next step,
                              velocities and time kept (Macklin et al. 2014, section 4.4); a step
                              would throw it apart. Placed is a fluid of which no step has moved a
                              particle, or of which all positions have been set at once, unless as
                              one, as with the world's origin; what is added to others moves by its
                              velocities alone. Another smoothing_radius, spacing, particle_volume,
                              kernel or wall_density places all; so does a wall that is set more
                              than h/2 farther into the fluid, and moves back particles that it has
                              passed. 0: never; 0.02, the default */
  double damping_compensation; /* 0 … 1, with PBF_SOLVER_CHEBYSHEV, which it needs: how much of what
                       a step takes from the fluid's motion by pushing along directions at its end
                       is given back. Solid rotation loses rate² * time_step of its angular momentum
                       in a time unit at 0, next to nothing at 1; the motion of single particles,
                       which would be noise, is damped as ever. Two passes over pairs a step. What a
                       pressure grid pushes is not corrected. 0, the default: none */
  double angular_momentum_correction; /* 0 … 1, with PBF_SOLVER_CHEBYSHEV, which it needs: how much
                               of the torque that pushes between particles exert, since they point
                               as pairs stand in an iteration and not as at the step's start, goes
                               back to the pairs around as velocity. At 1 the angular momentum of a
                               fluid that nothing else touches is kept to rounding. A pass over
                               pairs an iteration and two a step, 1.7 times a step without. -1, the
                               default: 1 with PBF_SOLVER_CHEBYSHEV where gravity is 0, and 0 where
                               walls carry the fluid's weight */
  double drag; /* 1/time, >= 0: all particles are dragged towards drag_velocity, as by a wind or a
                  stream around them: dv/dt = -drag (v - drag_velocity), solved exactly over each
                  step. A particle that falls in it ends at gravity / drag, to first order in the
                  time step. 0, the default: none */
  double drag_velocity[3];
  double max_depenetration_speed; /* length/time, >= 0: what overlaps parts no faster: particles out
                       of colliders that are set, jump or grow faster than that where they are, and
                       those that are placed upon others. With PBF_COLLIDE_AFTER_PREDICTION and
                       PBF_SOLVER_CHEBYSHEV, which it needs: PBF_SOLVER_JACOBI throws what
                       overlaps at its way over time_step. 0, the default: sqrt(|gravity| h), the
                       speed of a fall by h/2; without gravity as attraction makes it over the
                       domain, without that too h / 100 a step */
  uint32_t max_substeps; /* up to so many parts, at most 1000, the library divides a step into that
                            is longer than pbf_get_step_limit: as few and equal ones as bring it
                            below that, found anew for each step from the state at its begin alone.
                            pbf_info counts the caller's steps; iterations, tolerance and what
                            depends on time_step is each part's, pbf_stats.iterations the last
                            one's. A step that fails between two parts leaves the time there. Looks
                            at the fastest particle in each step. 0 or 1: never; 0, the default */
  uint32_t loads;        /* 1: each step finds what the fluid does to walls and colliders, for
                            pbf_get_collider_loads and pbf_get_wall_loads. 0, the default: none of it */
  double shear_stress_correction; /* 0 … 1, with PBF_SOLVER_CHEBYSHEV, which it needs: how much of
                       the shear stress that pushes along pairs have under pressure, since sheared
                       arrangements are not isotropic, is taken back as velocity. At 0 pressed fluid
                       resists slow shear like an elastic solid, and slow eddies swing back; at 0.75
                       they turn on, and waves in shallow water, gone after two periods, slosh on
                       with 0.5, which costs a third of a step and more on a CPU, 1 to 5 steps on a
                       GPU. From 0.9 on water at rest boils in short steps, and less than 18 layers
                       of it tremble with 0.75. With it water of 6 layers and more has a pressure
                       grid, unless pressure_grid says otherwise, and it needs one. Three passes
                       over pairs every third step. -1, the default: 0.75, less what
                       smoothing_radius / spacing is above 2, and at least 0.25, with
                       PBF_SOLVER_CHEBYSHEV where particles would settle 18 layers deep under
                       gravity (decided as for pressure_grid) and a pressure grid may be, or where
                       there is surface_tension; without gravity 0.65, less likewise, where walls
                       and containers leave no more room than the fluid takes; or 0 */
  double wall_friction; /* Coulomb friction of the domain's walls, >= 0: so much of what a wall
                           pushes a particle with acts along it against its motion. 0, the default:
                           fluid slides on walls freely */
  double wall_static_friction; /* what is at rest on a wall, >= 0; below wall_friction that */
  double wall_no_slip;    /* 0 … 1, with PBF_SOLVER_CHEBYSHEV and a viscosity: how much of the
                             shear between a wall and the fluid at it acts, as if fluid went on
                             behind the wall with velocities that go through the wall's own at
                             its plane (Morris, Fox & Zhu 1997). 0, the default: fluid slides
                             freely; 1: it sticks. In loads */
  double surface_tension; /* over rest density, a length³ a time unit²: water 7.3e-5 m³/s². Needs
                       PBF_SOLVER_CHEBYSHEV. Particles that lack neighbours are pulled to those that
                       they have, which keeps momentum and angular momentum to rounding (the latter
                       not with shear_stress_correction, which is on unless it is set to 0). What is
                       more than a step can take does not act, 0.02 spacing³ / time_step², in 2D
                       0.05: see pbf_get_step_limit. Made for a smoothing_radius of 2 spacings.
                       Walls and colliders neither pull nor hold, unless wall_adhesion and
                       pbf_collider.adhesion say so: the contact angle is 180 degrees.
                       Two passes over pairs a step, beside that correction. 0: none */
  uint32_t periodic;    /* PBF_PERIODIC_… bits of axes along which the domain's two faces are one:
                           what leaves it by the one comes in by the other, and fluid on both sides
                           are neighbours. There are no walls there, and none may move; the domain
                           is at least 4 smoothing_radius wide. Positions are those inside the
                           domain. Colliders, and attraction, act where they lie, not beyond the
                           faces. Without a pressure grid: pressure_grid is 0, or -1, which then is
                           none. 0, the default: walls on all sides */
  uint32_t reserved;    /* 0 */
  double wall_adhesion; /* 0 … 1: how much fluid with a surface_tension adheres to the domain's
                           walls, (1 + cos angle) / 2 for the contact angle within the fluid: by
                           Young's equation (1805) the part of 2 surface_tension that parting wall
                           and fluid takes an area. 0.25 is 120, 0.5 is 90, 0.75 is 60 degrees; near
                           1 fluid spreads to a layer. Acts along a wall's normal, in loads; needs
                           wall_density 1. 0, the default: 180 degrees, nothing adheres */
} pbf_params;

/* Fills *params with the defaults for a fluid of particle distance 0.05 in a box of side 1. */
PBF_API pbf_status pbf_params_init(pbf_params *params, uint32_t struct_size);

/* Replaces all parameters. They act from the next step on. */
PBF_API pbf_status pbf_set_params(pbf_solver *solver, const pbf_params *params);

/* Gives what was set last; params->struct_size must be set. */
PBF_API pbf_status pbf_get_params(pbf_solver *solver, pbf_params *params);

#ifdef __cplusplus
}
#endif

#endif
