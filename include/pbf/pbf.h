/* pbf: position based fluids behind a stable C ABI.
 *
 * The method is that of Macklin & Müller, "Position Based Fluids", ACM TOG 32(4), 2013; "eq. n"
 * below is their equation n. Particles have unit rest density: what enters is the rest volume of
 * a particle V = m/rho0 alone, so that every density here is rho/rho0.
 *
 * Rules that hold for every declaration:
 *   structs   start with `struct_size` = sizeof the struct the caller was compiled with, grow only
 *             at the end, and a new field's zero means the old behaviour. Parameters that an
 *             older caller's pbf_params has not have their defaults, as when it is compiled anew.
 *             Non-zero bytes beyond what the library knows are PBF_ERROR_STRUCT_SIZE, never
 *             ignored.
 *   errors    a call that can fail returns a pbf_status; pbf_last_error() then has a sentence that
 *             names the argument, its value and what would do. Out-parameters stay untouched, the
 *             solver stays as it was. The library never prints, aborts, exits or throws; OpenMP's
 *             runtime, which comes with `openmp`, may (docs/limits.md).
 *   threads   functions without a solver may be called from any thread at any time. A solver
 *             belongs to one thread at a time; different solvers may run in different threads at
 *             once. A call that meets another one inside the same solver returns PBF_ERROR_BUSY,
 *             but for pbf_cancel, pbf_acquire_snapshot and pbf_release_snapshot.
 *   stack     a call takes up to 64 KiB of it, on `cuda` what its driver takes.
 *   signals   so does a call in a signal handler, where its thread has been interrupted at a point
 *             at which it would wait for itself; pbf_destroy then does nothing. What allocates
 *             memory is no more to be called there than malloc. The library's own threads take no
 *             signals; OpenMP's take those that the program lets them.
 *   callbacks (the allocator's, the log) should return. One that is left by a C++ exception or a
 *             longjmp leaves its call halfway: from then on the solver's calls in that thread
 *             return PBF_ERROR_STATE, and pbf_destroy frees all that it has. pbf_create has set
 *             *solver when it logs; what the allocator has given is lost when it is left in there.
 *             A thread that leaves one so keeps the floating-point environment of the call, see
 *             rounding: fesetenv gives it its own back.
 *             So on Linux, on the stack that the thread was made with, and for exceptions where C
 *             has unwind tables (as compilers make them on x86-64 and AArch64, not in a MinSizeRel
 *             build); elsewhere the solver is busy for good.
 *   pthread_cancel ends no call halfway, but the thread after it (on `cuda` unless it is
 *             asynchronous). One that has left a callback as above is not cancelled until it
 *             allows that (pthread_setcancelstate).
 *   fork      in the child solvers go on from where they are, on `openmp` with one thread: those of
 *             OpenMP do not come along. One in which another thread was returns PBF_ERROR_STATE
 *             and can be destroyed. A device is the parent's.
 *   rounding  every call computes with rounding to nearest, subnormal numbers and exceptions
 *             masked, whatever the calling thread has set, and gives that back as it was, flags
 *             included. Callbacks run in between.
 *   arrays    hold the solver's element type (pbf_desc.precision), row-major, shape
 *             (count, dimension), in the order in which the particles were added.
 *   units     any consistent set; lengths, times and accelerations are the caller's own. In units
 *             that are larger or smaller by powers of two the numbers are the same to the last bit
 *             (seen on CPUs so far).
 */
#ifndef PBF_PBF_H
#define PBF_PBF_H

#include <stdint.h>

#if defined(_WIN32) && defined(PBF_STATIC_LIBRARY) /* part of the program */
#define PBF_API
#elif defined(_WIN32) && defined(PBF_BUILDS_LIBRARY)
#define PBF_API __declspec(dllexport)
#elif defined(_WIN32)
#define PBF_API __declspec(dllimport)
#else
#define PBF_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Versions ------------------------------------------------------------------------------ */

#define PBF_VERSION_MAJOR 0
#define PBF_VERSION_MINOR 2
#define PBF_VERSION_PATCH 0

/* What pbf_desc.api_version must hold: the header that the caller was compiled with. */
#define PBF_API_VERSION 2u

/* Version of the library at run time, as MAJOR * 1000000 + MINOR * 1000 + PATCH. */
PBF_API uint32_t pbf_version(void);

/* ---- Status codes -------------------------------------------------------------------------- */

typedef int32_t pbf_status;

enum {
  PBF_OK = 0,
  PBF_ERROR_INVALID_ARGUMENT = -1, /* a null pointer, a value out of range, NaN or infinity */
  PBF_ERROR_STRUCT_SIZE = -2,      /* struct_size is wrong, or unknown bytes are not zero */
  PBF_ERROR_OUT_OF_MEMORY = -3,    /* host or device */
  PBF_ERROR_CAPACITY = -4,         /* more particles than pbf_desc.capacity */
  PBF_ERROR_NOT_FOUND = -5,        /* no particle, backend or item of that name or number */
  PBF_ERROR_UNAVAILABLE = -6,      /* no backend can serve this solver; the sentence says why */
  PBF_ERROR_UNSUPPORTED = -7,      /* this build or backend does not have it */
  PBF_ERROR_BUSY = -8,             /* another call is inside this solver */
  PBF_ERROR_STATE = -9,            /* not now: a view is mapped, for example */
  PBF_ERROR_DEVICE = -10,          /* a device call failed; the sentence names the call */
  PBF_ERROR_PLUGIN = -11,          /* a backend broke the plugin rules */
  PBF_ERROR_DATA = -12,            /* a saved state is truncated, damaged or of another kind */
  PBF_ERROR_CANCELLED = -13        /* pbf_cancel has ended the call; what it has done stands */
};

/* The code's name, "PBF_ERROR_CAPACITY"; never null, static storage. */
PBF_API const char *pbf_status_string(pbf_status status);

/* The sentence for the last failure in this thread; never null, empty before the first one.
 * Valid until this thread's next call that fails. */
PBF_API const char *pbf_last_error(void);

/* ---- Solver description: what cannot change ------------------------------------------------ */

typedef struct pbf_solver pbf_solver;

enum { PBF_FLOAT32 = 4, PBF_FLOAT64 = 8 };

enum { PBF_LOG_INFO = 1, PBF_LOG_WARNING = 2 };

/* Called with a complete sentence, without a newline, from whichever thread is in the library. */
typedef void (*pbf_log_fn)(void *user, int32_t level, const char *message);

/* Every allocation of host memory that a solver makes goes through these two. `allocate` returns
 * memory aligned to `alignment` (a power of two) or null; `release` gets the same size back.
 * Both may be called from any thread that calls into the solver. */
typedef struct pbf_allocator {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */
  void *user;
  void *(*allocate)(void *user, uint64_t size, uint64_t alignment);
  void (*release)(void *user, void *memory, uint64_t size, uint64_t alignment);
} pbf_allocator;

/* A task system of the caller's, as engines have one. A solver of `threads` that has it starts no
 * threads but that of pbf_begin_step: each of its steps, or of some of them at once, is one task of
 * `items` items.
 *
 * `enqueue_task` has run(task, first, last) called such that each item 0 … items - 1 is in one of
 * the ranges first … last - 1: in any threads, at once or one after another, as late as it likes,
 * or all before it returns. A range has at least `min_range` items, but for the last one. It
 * returns a handle for `finish_task`, or null when all items have been run.
 * `finish_task` returns when all items have been run, and may run some itself. It is called once
 * for each handle, by the thread that enqueued the task, before that thread's call into pbf ends.
 *
 * The calling thread works, too, and no item waits for one that has not begun: what others have not
 * begun, it does itself. So nothing hangs where all workers are busy, or the caller is the only
 * one. An item that has begun may be waited for, and must not be suspended (by a fiber) for other
 * work: it calls nothing of the caller's. Neither function may call into the same solver. Bits do
 * not depend on which thread runs what, nor on its floating-point environment. */
typedef void (*pbf_task_fn)(void *task, uint32_t first, uint32_t last);
typedef void *(*pbf_enqueue_task_fn)(void *user, pbf_task_fn run, void *task, uint32_t items,
                                     uint32_t min_range);
typedef void (*pbf_finish_task_fn)(void *user, void *handle);

typedef struct pbf_desc {
  uint32_t struct_size;
  uint32_t api_version; /* PBF_API_VERSION */
  uint32_t dimension;   /* 2 or 3 */
  uint32_t precision;   /* PBF_FLOAT32 or PBF_FLOAT64 */
  uint32_t capacity;    /* maximum of particles held at once, 1 … PBF_MAX_CAPACITY */
  uint32_t strict;      /* 1: `backend` or failure; 0: fall back and say so in pbf_info */
  const char *backend;  /* "auto" (also null), "reference", "serial", "threads", "openmp", … */
  int32_t device;       /* which device of that backend; 0 is the first, and a CPU's only one. A
                           backend that serves instead of that one has its first */
  uint32_t threads;     /* CPU threads, the caller's included; 0: as many as there are CPUs, of
                           which "threads" uses those that pay for the particles that there are.
                           A process that can't start so many gets fewer, see pbf_info, and the
                           same bits */
  void *stream;         /* cudaStream_t to work on; null: one of the solver's own; on a CPU null.
                           A backend that serves instead of that one does not get it */
  const pbf_allocator *allocator; /* null: malloc; copied by pbf_create */
  pbf_log_fn log;                 /* null: silence */
  void *log_user;
  const char *isa; /* instruction set of the CPU backends' loops over pairs: "scalar", "simd128"
                      (WebAssembly), "sse2", "neon", "avx2", "avx512"; null: the best one that the
                      processor and the build have. All give the same bits; pbf_info.device_name
                      names the one in use. What the processor, the build or the backend lacks is
                      refused, with "auto", too; copied by pbf_create */
  /* The task system: both functions, or neither. `threads` is then how many of its workers may take
   * part, the caller included; `openmp`, which has threads of its own, refuses. */
  pbf_enqueue_task_fn enqueue_task;
  pbf_finish_task_fn finish_task;
  void *task_user;
} pbf_desc;

#define PBF_MAX_CAPACITY 0x3fffffffu

/* Fills *desc with the defaults: 3D, float32, capacity 100,000, backend "auto". `struct_size` is
 * sizeof(pbf_desc). */
PBF_API pbf_status pbf_desc_init(pbf_desc *desc, uint32_t struct_size);

/* ---- Parameters: what may change between steps --------------------------------------------- */

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
   * fluid, or a moving wall or collider, also wakes it, within h; a change of the parameters but
   * time_step, and particles that are set or removed, wake all. */
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
                           g H dt² > 0.06 iterations spacing² (18 layers of the defaults), or, with
                           shear_stress_correction, 6 layers, where that is -1, the default, 18, or
                           0.
                           Decided at the begin of each pbf_step by as many particles as there are,
                           or as the last step was for, unless a quarter of these is gone: it would
                           flicker where particles come and go. Solids of up to two cells part the
                           grid where they part the fluid. */
  double prestabilization; /* >= 0, with PBF_SOLVER_CHEBYSHEV: where the mean of max(rho/rho0 - 1,
                              0) is above this, or the largest above 25 times this, a fluid that
                              has been placed is moved to rest density before its next step,
                              velocities and time kept (Macklin et al. 2014, section 4.4); a step
                              would throw it apart. Placed is a fluid of which no step has moved a
                              particle, or all of whose positions have been set at once, unless as
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
                       of colliders that are set, jump or grow where they are, and those that are
                       placed upon others. With PBF_COLLIDE_AFTER_PREDICTION, which it needs.
                       0, the default: sqrt(|gravity| h), the speed of a fall by h/2; without
                       gravity as attraction makes it over the domain, without that too h / 100 a
                       step */
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
                       there is surface_tension, or 0 */
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

/* ---- Life of a solver ---------------------------------------------------------------------- */

/* `params` may be null: the defaults. On success *solver is new and holds no particles.
 * PBF_ERROR_UNAVAILABLE: no backend, the sentence lists each one's reason. */
PBF_API pbf_status pbf_create(const pbf_desc *desc, const pbf_params *params, pbf_solver **solver);

/* Null is a no-op. Memory behind exported DLPack tensors lives on until their deleter runs. */
PBF_API void pbf_destroy(pbf_solver *solver);

PBF_API pbf_status pbf_set_params(pbf_solver *solver, const pbf_params *params);

/* Gives what was set last; params->struct_size must be set. */
PBF_API pbf_status pbf_get_params(pbf_solver *solver, pbf_params *params);

/* Runs `steps` time steps. A step that fails leaves particles and time as they were before it;
 * the steps before it stand (pbf_info.step tells). A device works on after the call returns:
 * whatever reads the state waits for it, and pbf_synchronize does just that. */
PBF_API pbf_status pbf_step(pbf_solver *solver, uint32_t steps);

/* The same in two calls, between which the calling thread does other work: pbf_begin_step returns
 * at once, and a thread of the solver's own, which the first of these calls starts, runs the steps
 * with the others of its backend. pbf_end_step, from any thread, waits for them and returns what
 * pbf_step would. In between all other calls return PBF_ERROR_BUSY, but for pbf_cancel,
 * pbf_acquire_snapshot and pbf_release_snapshot; pbf_destroy cancels and waits. Callbacks, and
 * those of a task system, are called by that thread, and may not leave by an exception.
 * PBF_ERROR_STATE: no steps have begun; PBF_ERROR_OUT_OF_MEMORY: the thread can't be started. The
 * bits are those of pbf_step. */
PBF_API pbf_status pbf_begin_step(pbf_solver *solver, uint32_t steps);
PBF_API pbf_status pbf_end_step(pbf_solver *solver);

/* Has the pbf_step, or the begun one, that is inside the solver return PBF_ERROR_CANCELLED, unless
 * it has done its last step by then. From any thread, at any time up to pbf_destroy; does not wait
 * for it. The step that runs is completed, and so are those after it that take some 20 ms together
 * on a CPU; all of them stand (pbf_info.step tells how many), and the solver goes on with the same
 * bits as from as many steps. Where no pbf_step is inside, it does nothing. */
PBF_API pbf_status pbf_cancel(pbf_solver *solver);

/* Waits for the device; reports an error that a step met after pbf_step had returned. */
PBF_API pbf_status pbf_synchronize(pbf_solver *solver);

/* ---- Particles ----------------------------------------------------------------------------- */

PBF_API pbf_status pbf_get_count(pbf_solver *solver, uint32_t *count);

/* Appends particles; `velocities` may be null: at rest. Ids count up from 0 over the solver's life
 * and are never used again; *first_id (may be null) gets the first new one. Positions must be
 * finite and inside the domain, velocities finite and at most 1e150 in size. Those of one call that
 * are at one and the same point are set apart about it, by a quarter of a spacing and more: a fluid
 * could not part them. */
PBF_API pbf_status pbf_add_particles(pbf_solver *solver, uint32_t count, const void *positions,
                                     const void *velocities, uint32_t *first_id);

/* Removes the particles with these ids; the others keep ids and order. Nothing is removed when one
 * id is unknown or stands twice. */
PBF_API pbf_status pbf_remove_particles(pbf_solver *solver, uint32_t count, const uint32_t *ids);

/* Removes the particles in a box along the axes, with its faces: lower[k] <= x[k] <= upper[k]. In
 * 2D the third is not looked at; -INFINITY and INFINITY are no bound. *count (may be null) gets how
 * many they were; none is no error. The others keep ids and order. */
PBF_API pbf_status pbf_remove_in_box(pbf_solver *solver, const double lower[3],
                                     const double upper[3], uint32_t *count);

/* The ids of the particles in such a box, ascending: the first `room` of them go to `ids`, which
 * may be null where room is 0, and *count gets how many there are, be it more than room. */
PBF_API pbf_status pbf_find_in_box(pbf_solver *solver, const double lower[3], const double upper[3],
                                   uint32_t room, uint32_t *ids, uint32_t *count);

/* Particles first … first + count - 1 in the order of adding, those removed left out. Positions and
 * velocities: shape (count, dimension). Ids: increasing. Densities: rho/rho0 at the present
 * positions, the particle itself included, shape (count). */
PBF_API pbf_status pbf_get_positions(pbf_solver *solver, uint32_t first, uint32_t count,
                                     void *positions);
PBF_API pbf_status pbf_set_positions(pbf_solver *solver, uint32_t first, uint32_t count,
                                     const void *positions);
PBF_API pbf_status pbf_get_velocities(pbf_solver *solver, uint32_t first, uint32_t count,
                                      void *velocities);
PBF_API pbf_status pbf_set_velocities(pbf_solver *solver, uint32_t first, uint32_t count,
                                      const void *velocities);
PBF_API pbf_status pbf_get_ids(pbf_solver *solver, uint32_t first, uint32_t count, uint32_t *ids);
PBF_API pbf_status pbf_get_densities(pbf_solver *solver, uint32_t first, uint32_t count,
                                     void *densities);

/* Accelerations of these particles beside gravity, shape (count, dimension): fields of force that
 * the caller computes of positions. They act in each step, on its velocities before the prediction,
 * until they are replaced; particles that were given none have 0. They stay with their particles
 * when others are removed. Null, with first and count 0, takes all away, and with them their
 * memory. Steps are then made one at a time, each by way of a copy of the velocities in host
 * memory, and wake what sleeps. The pressure grid's weight, cohesion and step limits go by gravity
 * alone; a divided step is accelerated as a whole. No part of a saved state: pbf_save returns
 * PBF_ERROR_STATE while there are some, pbf_load takes them away. */
PBF_API pbf_status pbf_set_accelerations(pbf_solver *solver, uint32_t first, uint32_t count,
                                         const void *accelerations);

/* p/rho0 of the last step, length²/time², shape (count): what, held over the step, accelerates the
 * fluid as the density solve has moved it, -grad p / rho. At the present positions, as the straight
 * line through those of a particle and of its neighbours (moving least squares, weighted by a
 * kernel): by itself each trembles about it, which neighbours, whose pressures add up, do not.
 * Looks for neighbours, which takes a third of a step or so. Artificial pressure is not in it. 0
 * before a particle's first step: it is not part of a saved state, and begins anew when `solver`
 * becomes PBF_SOLVER_CHEBYSHEV. PBF_ERROR_UNSUPPORTED with PBF_SOLVER_JACOBI, which keeps no
 * pressure. */
PBF_API pbf_status pbf_get_pressures(pbf_solver *solver, uint32_t first, uint32_t count,
                                     void *pressures);

/* ---- Reading into the caller's own layout -------------------------------------------------- */

enum {
  PBF_FIELD_POSITION = 1,
  PBF_FIELD_VELOCITY = 2,
  PBF_FIELD_ID = 3,
  PBF_FIELD_DENSITY = 4, /* can't be mapped: no backend keeps it */
  PBF_FIELD_PRESSURE = 5 /* as pbf_get_pressures; its memory is taken when it is first mapped */
};

enum { PBF_TYPE_FLOAT32 = 4, PBF_TYPE_FLOAT64 = 8, PBF_TYPE_UINT32 = 12 };

/* What the fourth of four numbers is. */
enum {
  PBF_W_CONSTANT = 0, /* pbf_read_desc.w_value */
  PBF_W_SPEED = 1,    /* |v|, a length a time unit */
  PBF_W_DENSITY = 2,  /* rho/rho0, as pbf_get_densities */
  PBF_W_PRESSURE = 3  /* as pbf_get_pressures */
};

/* Where a particle is written. */
enum {
  PBF_ORDER_ADDED = 0, /* at its row less `first`, in the order of adding */
  PBF_ORDER_STORED = 1 /* in the order in which they lie in memory, which is read fastest, with
                          neighbours near each other; the same for all fields until the particles
                          change, as PBF_FIELD_ID tells it. Of all particles only */
};

/* Which numbers of which particles, and where they go: number c of particle i to
 * data + i * stride + c * (bytes of element_type). What lies between stays as it is. A struct that
 * is 0 but for its size, field, count and data is what pbf_get_positions and its like do. */
typedef struct pbf_read_desc {
  uint32_t struct_size;
  uint32_t field; /* PBF_FIELD_POSITION, _VELOCITY, _ID, _DENSITY or _PRESSURE */
  uint32_t first; /* rows, as for pbf_get_positions */
  uint32_t count;
  uint32_t element_type; /* PBF_TYPE_FLOAT32 or _FLOAT64, of ids _UINT32; 0: the solver's own */
  uint32_t components; /* numbers of a particle; 0: as many as the field has, and more for vectors:
                          up to 3, with 0 where 2D has no third, or 4, of which the last is w */
  uint32_t w;          /* PBF_W_… */
  uint32_t order;      /* PBF_ORDER_… */
  uint64_t stride; /* bytes from a particle to the next, a multiple of the element's; 0: no gap */
  void *data;
  double behind; /* positions: how far back between the last two steps, in steps: 0: as they are,
                    1: as they were before the last step, and between these along a straight line;
                    0 … 1. Above 0 it needs pbf_keep_previous */
  double w_value;
} pbf_read_desc;

/* Writes nothing but what it is asked for, at about the speed of memory, from a device by way of
 * host memory. Looks for neighbours only where densities or pressures are read. */
PBF_API pbf_status pbf_read(pbf_solver *solver, const pbf_read_desc *read);

/* 1: from now on pbf_step keeps the positions from before its last step, for pbf_read_desc.behind,
 * in host memory that is taken now, a position for each particle of capacity. That costs a reading
 * of the positions each pbf_step, and no bit. 0: gives the memory back. They can't be had from
 * velocities, which say less and more than where a particle came from: collisions, what overlaps
 * and artificial pressure move without, vorticity, XSPH and drag act on velocities alone.
 * A particle that is added, or whose position is set, has been where it is; so have all after a
 * load, or a step that fails or is cancelled. */
PBF_API pbf_status pbf_keep_previous(pbf_solver *solver, uint32_t enabled);

/* ---- Smoothed positions and anisotropies for renderers -------------------------------------- */

/* What Yu & Turk, "Reconstructing surfaces of particle-based fluids using anisotropic kernels", ACM
 * TOG 32(1), 2013 draw in place of balls: eq. n is theirs here. A struct that is 0 but for its
 * size, count and a place to write to takes the numbers of the paper, and positions as they are. */
typedef struct pbf_anisotropy_desc {
  uint32_t struct_size;
  uint32_t first; /* rows, as for pbf_get_positions */
  uint32_t count;
  uint32_t min_neighbors; /* a particle with fewer is a ball, eq. 15's N; 0: 25 in 3D, 9 in 2D */
  double radius;     /* of the weights of eq. 11, a length above the spacing, at most 4 h; 0: 2 h */
  double smoothing;  /* lambda of eq. 6, 0 … 1: so much nearer to the weighted mean of the
                        neighbours; 0: positions as they are; 0.9 in the paper */
  double max_ratio;  /* k_r of eq. 15, >= 1: the longest axis over any other; 0: 4 */
  double lone_scale; /* k_n of eq. 15, in (0, 1]: the radius of a particle with few neighbours, in
                        that of one inside; 0: 0.5 */
  void *positions;   /* shape (count, dimension), lengths; or null */
  void *stretches;   /* shape (count, dimension, dimension), no unit, symmetric: A; or null */
} pbf_anisotropy_desc;

/* Writes smoothed positions x and, for each, a matrix A: the particle is the ellipsoid x + r A u,
 * |u| <= 1, with r half the spacing, or the kernel W(|A⁻¹ (y - x)|) / det A about x. The axes of A
 * are those of the weighted covariance of the neighbours' places, eq. 9, and as long as its
 * eigenvalues, in units of that of a cubic or square lattice of the spacing: A is the identity
 * inside a fluid at rest, flat in a sheet, long in a thread. Neither walls nor colliders count as
 * neighbours. Computed on the host in float64, from positions that are read back, in a fixed order:
 * the same positions give the same bits on all backends. One thread, some 5 microseconds a particle
 * in 3D with h of 2 spacings, and 92 bytes a particle while it runs, which is all that it costs.
 * Threads and views as for pbf_get_positions. */
PBF_API pbf_status pbf_get_anisotropies(pbf_solver *solver, const pbf_anisotropy_desc *anisotropy);

/* ---- Colliders ----------------------------------------------------------------------------- */

/* A solid of any form, for PBF_COLLIDER_SHAPE: shapes.h makes them. */
typedef struct pbf_shape pbf_shape;

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

PBF_API pbf_status pbf_get_collider_count(pbf_solver *solver, uint32_t *count);

/* Collider `index` as it stands and moves now; of a motion with an end, `duration` is what is left
 * of it. collider->struct_size must be set. */
PBF_API pbf_status pbf_get_collider(pbf_solver *solver, uint32_t index, pbf_collider *collider);

/* What the fluid does to a solid. Impulses are over rest density, so those in kg m/s are these
 * times 1000 kg/m³ for water; over time_step they are the mean force in a step. A particle's mass
 * is particle_volume, or spacing^dimension where that is 0. All impulses of one step, on walls and
 * colliders, sum up to the momentum that the fluid has lost to them: its momentum before the step,
 * with what gravity and attraction gave it, less that after it, without the parameters vorticity,
 * XSPH's viscosity and drag, which act on it in between. Pressure pushes by the same path as
 * velocities, with lambda, collisions and a pressure grid, and by that is shared out; fluid that
 * sticks to solids pulls them along.
 */
typedef struct pbf_collider_load {
  uint32_t struct_size;
  uint32_t contacts;             /* particles nearer than a spacing */
  double impulse[3];             /* of the last step; of a divided one, of its last part */
  double angular_impulse[3];     /* about the collider's position; of a wall, the origin; 2D: z */
  double impulse_sum[3];         /* since these sums were last read, … */
  double angular_impulse_sum[3]; /* … or params.loads was set, or the collider came */
  double time_sum;               /* for which they are sums */
  double penetration;            /* of the deepest particle centre behind the surface; 0: none is */
  double wetted_area;            /* in 2D a length; good to a few parts of a hundred on a face */
} pbf_collider_load;

/* Loads of all colliders, as many as pbf_get_collider_count tells, in their order. `loads` is an
 * array of `count` structs, each of the size in loads[0].struct_size. Begins the sums of those that
 * it gives anew. A collider keeps its sums where pbf_set_colliders replaces it by one of the same
 * number. Not part of a saved state. The same bits with any number of threads.
 * Fluid asleep presses with the pressure with which it fell asleep, and does not adhere.
 * PBF_ERROR_STATE: params.loads is 0. PBF_ERROR_UNSUPPORTED: the backend has none. */
PBF_API pbf_status pbf_get_collider_loads(pbf_solver *solver, uint32_t count,
                                          pbf_collider_load *loads);

/* The same of the domain's walls, by PBF_WALL_…: `count` is 2 * dimension. */
PBF_API pbf_status pbf_get_wall_loads(pbf_solver *solver, uint32_t count, pbf_collider_load *loads);

/* ---- Views without a copy ------------------------------------------------------------------ */

enum { PBF_DEVICE_CPU = 1, PBF_DEVICE_CUDA = 2 }; /* DLPack's numbers */

/* Element (i, c) of a view is at data + i * particle_stride + c * component_stride bytes. The
 * order is the backend's own; ids (in the same memory, tightly packed) tell which element is which
 * particle. */
typedef struct pbf_view {
  uint32_t struct_size;
  uint32_t field;       /* PBF_FIELD_POSITION, _VELOCITY, _ID or _PRESSURE */
  uint32_t device_type; /* PBF_DEVICE_… */
  int32_t device_id;
  uint32_t element_type; /* PBF_TYPE_… */
  uint32_t components;   /* dimension, or 1 */
  uint32_t count;
  uint32_t reserved;        /* 0 */
  int64_t particle_stride;  /* bytes */
  int64_t component_stride; /* bytes */
  uint64_t generation;      /* changes whenever the particles do */
  const void *data;
  const uint32_t *ids;
} pbf_view;

/* Read-only view of one field. While any view is mapped, calls that change the particles return
 * PBF_ERROR_STATE. On a device the data is ready in the solver's stream. Each successful map wants
 * one unmap of the same field. */
PBF_API pbf_status pbf_map(pbf_solver *solver, uint32_t field, pbf_view *view);
PBF_API pbf_status pbf_unmap(pbf_solver *solver, uint32_t field);

/* The same as a DLPack tensor of shape (count, components), mapped until its deleter runs (also
 * after pbf_destroy). Include <dlpack/dlpack.h> for the type. */
struct DLManagedTensor;
PBF_API pbf_status pbf_export_dlpack(pbf_solver *solver, uint32_t field,
                                     struct DLManagedTensor **tensor);

/* ---- Snapshots for other threads: on request only ------------------------------------------- */

/* The state at the end of a pbf_step, in host memory that does not change while it is held. */
typedef struct pbf_snapshot {
  uint32_t struct_size;
  uint32_t count;
  uint32_t dimension;
  uint32_t element_type; /* PBF_TYPE_… */
  uint64_t step;         /* pbf_info.step and time of then */
  double time;
  const void *positions; /* shape (count, dimension), in the order of adding */
  const void *velocities;
  const uint32_t *ids; /* shape (count), increasing */
  void *owner;         /* the library's; null: nothing is held */
} pbf_snapshot;

#define PBF_MAX_SNAPSHOTS 16u

/* Keeps room for so many snapshots of `capacity` particles, and makes one of the present state;
 * from then on each pbf_step that succeeds, or is cancelled, ends with one. It goes where the
 * latest one is not, nor one that is held; where there is no such room, none is made and the latest
 * one stays, so that a step never waits. With n readers that hold one each, n + 2 are enough.
 * `snapshots` is 2 … PBF_MAX_SNAPSHOTS, or 0: gives the memory back. Costs a reading of positions
 * and velocities a call of pbf_step, on a device a wait for it, and no bit. PBF_ERROR_STATE while
 * one is held. */
PBF_API pbf_status pbf_set_snapshots(pbf_solver *solver, uint32_t snapshots);

/* Holds the latest snapshot. From any thread, at any time up to pbf_destroy, also while a call is
 * inside the solver, for which it never waits; other threads may hold the same one.
 * snapshot->struct_size must be set, and owner null. What is held outlives pbf_destroy. */
PBF_API pbf_status pbf_acquire_snapshot(pbf_solver *solver, pbf_snapshot *snapshot);

/* Ends that, from any thread, once for each success of pbf_acquire_snapshot. What `snapshot` points
 * to is then no more to be read, and its members are 0. */
PBF_API pbf_status pbf_release_snapshot(pbf_snapshot *snapshot);

/* ---- What happened: on request only -------------------------------------------------------- */

/* Sums over all particles in their present state, particles of unit mass, in float64. */
typedef struct pbf_stats {
  uint32_t struct_size;
  uint32_t count;
  uint32_t iterations;    /* of the last step; params.iterations unless it ended before */
  uint32_t neighbors_max; /* within h, the particle itself not counted */
  double neighbors_mean;
  double center_of_mass[3];
  double position_min[3];
  double position_max[3];
  double momentum[3];    /* a particle's mean: sum of v / count */
  double kinetic_energy; /* a particle's mean: sum of |v|²/2 / count */
  double speed_max;
  double density_error_mean; /* mean of max(rho/rho0 - 1, 0): a free surface is no error */
  double density_error_max;  /* largest rho/rho0 - 1, at least 0 */
  double density_mean;       /* mean of rho/rho0 */
  uint32_t asleep;           /* particles, see pbf_params.sleep_speed */
  uint32_t squeezed;   /* particles inside a collider, and at another one or a wall: what closes on
                          fluid leaves them no room, and they stay where they are until there is */
  double step_limit;   /* as pbf_get_step_limit gives it */
  uint32_t limited_by; /* PBF_LIMIT_…: what that is for */
  uint32_t substeps;   /* parts that the last step had, see pbf_params.max_substeps; 0 before the
                          first and after a load */
} pbf_stats;

PBF_API pbf_status pbf_get_stats(pbf_solver *solver, pbf_stats *stats);

/* What a step can be too long for. */
enum {
  PBF_LIMIT_NONE = 0,
  PBF_LIMIT_GRAVITY = 1,    /* g dt² <= 0.5 spacing */
  PBF_LIMIT_ATTRACTION = 2, /* the same with the largest acceleration at the surface of the fluid
                               once it has gathered, or of a repulsion in the domain */
  PBF_LIMIT_PARTICLES = 3,  /* v dt <= spacing: the fastest particle, */
  PBF_LIMIT_WALLS = 4,      /* wall, */
  PBF_LIMIT_COLLIDERS = 5,  /* collider, its turn included */
  PBF_LIMIT_TENSION = 6     /* surface_tension dt² <= 0.02 spacing³, in 2D 0.05: of more, only so
                               much acts */
};

/* The longest time_step that the present parameters, colliders and velocities stand, undivided;
 * infinite where nothing moves or falls. Beyond it water at rest lies down or boils, and what moves
 * squeezes it: up to 1 spacing a step by less than a tenth, at 3 by three quarters (measured at 4
 * iterations). The bound on speed is that of Courant, Friedrichs and Lewy (Mathematische Annalen
 * 100, 1928). Drag is solved exactly and limits nothing. pbf_desc.log is told of longer steps: once
 * for each cause, and again only after it has ended; when steps are made, of particles when
 * pbf_get_stats or max_substeps looks at them. Looks at all particles. */
PBF_API pbf_status pbf_get_step_limit(pbf_solver *solver, double *limit);

#define PBF_NAME_SIZE 32
#define PBF_MAX_STAGES 24
#define PBF_MAX_ARRAYS 40

typedef struct pbf_stage_time {
  char name[PBF_NAME_SIZE];
  double milliseconds; /* since timing was switched on */
  uint64_t runs;
} pbf_stage_time;

typedef struct pbf_timings {
  uint32_t struct_size;
  uint32_t stage_count;
  pbf_stage_time stages[PBF_MAX_STAGES];
} pbf_timings;

/* Per-stage times; off at first. Switching on clears them; while on, a device is synchronised
 * after every stage, so the sum is more than an untimed step takes. Where the plan has one launch
 * for all stages (small scenes on cuda), its time is that of the first. Changes no bit. */
PBF_API pbf_status pbf_set_timing(pbf_solver *solver, uint32_t enabled);
PBF_API pbf_status pbf_get_timings(pbf_solver *solver, pbf_timings *timings);

/* What this solver runs and holds with its present parameters, and nothing else exists. */
typedef struct pbf_plan_stage {
  char name[PBF_NAME_SIZE];
  uint32_t runs_per_step;
  uint32_t launches_per_step; /* device launches; 0 on a CPU */
} pbf_plan_stage;

typedef struct pbf_plan_array {
  char name[PBF_NAME_SIZE];
  double bytes_per_particle; /* of capacity */
  uint64_t bytes;            /* allocated now */
} pbf_plan_array;

typedef struct pbf_plan {
  uint32_t struct_size;
  uint32_t stage_count;
  uint32_t array_count;
  uint32_t reserved;               /* 0 */
  char variant[PBF_NAME_SIZE * 2]; /* "3d-f32-wendland", with what the hot loop was built for */
  double bytes_per_particle;       /* sum over the arrays */
  uint64_t bytes;                  /* everything allocated now, small tables included */
  pbf_plan_stage stages[PBF_MAX_STAGES];
  pbf_plan_array arrays[PBF_MAX_ARRAYS];
} pbf_plan;

PBF_API pbf_status pbf_get_plan(pbf_solver *solver, pbf_plan *plan);

typedef struct pbf_info {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t precision;
  uint32_t capacity;
  uint32_t threads; /* CPU threads in use; 0 on a device */
  int32_t device;
  uint32_t device_type; /* PBF_DEVICE_… */
  uint32_t fell_back;   /* 1: not the backend that was asked for */
  uint64_t step;        /* steps done */
  double time;          /* sum of their time steps */
  char backend[PBF_NAME_SIZE];
  char device_name[96];      /* "AMD EPYC … (avx512)", "NVIDIA H200" */
  char build_id[96];         /* version, compiler and target of the backend's build */
  char path[256];            /* file that the backend came from; empty when linked in */
  char fallback_reason[256]; /* why the backend that was asked for does not serve */
} pbf_info;

PBF_API pbf_status pbf_get_info(pbf_solver *solver, pbf_info *info);

/* ---- State --------------------------------------------------------------------------------- */

/* Writes parameters, colliders, emitters, drains, time and particles, portable between backends.
 * With `buffer` null, *size gets the bytes needed; else *size is the room there is, and gets the
 * bytes written. On the same backend and build, a loaded solver continues with the same bits. */
PBF_API pbf_status pbf_save(pbf_solver *solver, void *buffer, uint64_t *size);

/* Replaces the solver's whole state. PBF_ERROR_DATA for anything that pbf_save did not write, of
 * another dimension or precision; the solver is then unchanged. */
PBF_API pbf_status pbf_load(pbf_solver *solver, const void *buffer, uint64_t size);

/* FNV-1a, 64 bit, over step, count and, in the order of adding, ids, positions and velocities; with
 * emitters and drains (emit.h) over these, too. */
PBF_API pbf_status pbf_hash(pbf_solver *solver, uint64_t *hash);

/* ---- Backends ------------------------------------------------------------------------------ */

typedef struct pbf_backend_info {
  uint32_t struct_size;
  uint32_t available;   /* 1: can serve the solver that was asked about */
  int32_t score;        /* "auto" takes the highest; 0: can't serve */
  uint32_t device_type; /* PBF_DEVICE_… */
  char name[PBF_NAME_SIZE];
  char device_name[96];
  char build_id[96];
  char path[256];
  char reason[256]; /* why it can't serve: the probe's or the dynamic loader's words */
} pbf_backend_info;

/* Number of entries: every backend found, and every candidate that failed to load. */
PBF_API pbf_status pbf_get_backend_count(uint32_t *count);

/* Entry `index`, judged for a solver like `desc` (null: the defaults). info->struct_size must be
 * set. */
PBF_API pbf_status pbf_get_backend_info(const pbf_desc *desc, uint32_t index,
                                        pbf_backend_info *info);

/* Loads a plugin from an absolute path, for the life of the process. The backends that come with
 * the library need no call: they are found when first wanted, in the folders of
 * PBF_BACKEND_PATH (absolute, with colons between them, on Windows semicolons; ignored under
 * elevated privileges), beside libpbf, in pbf/backends/ beside libpbf. Paths are UTF-8. A file that
 * is cut short, or for another machine, is refused, and so is, on Linux, one with a wrong bit in
 * its headers, or in its tables for the dynamic loader; what is in its code and data is trusted,
 * and must not be written to while it is loaded: a new one is put in its place by renaming. */
PBF_API pbf_status pbf_load_backend(const char *path);

#ifdef __cplusplus
}
#endif

#endif
