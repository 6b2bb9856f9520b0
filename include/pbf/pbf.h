/* pbf: position based fluids behind a stable C ABI.
 *
 * A program includes this one. Solvers, particles and states are declared here, the rest in headers
 * that come with it:
 *
 *   base.h        status codes and the sentence of an error, the handle, numbers of types
 *   desc.h        what a solver is made by
 *   params.h      its parameters
 *   colliders.h   solids, and how they move
 *   loads.h       forces of the fluid on solids
 *   read.h        particles in the caller's layout
 *   views.h       particles without a copy
 *   snapshots.h   particles for other threads
 *   anisotropy.h  ellipsoids for renderers
 *   stats.h       sums over particles, the longest time step
 *   plan.h        stages, their times, memory
 *   backends.h    which backends there are
 *
 * and, where a program includes them, or all.h for all: shapes.h (solids of any form), query.h
 * (questions by place), emit.h (emitters, drains, reservoirs), phases.h (several fluids), diffuse.h
 * (spray, foam and bubbles), batch.h (many solvers in one call), ranks.h (one solver on many
 * processes).
 *
 * The method is that of Macklin & Müller, "Position Based Fluids", ACM TOG 32(4), 2013; "eq. n"
 * is their equation n. Particles have unit rest density: what enters is the rest volume of
 * a particle V = m/rho0 alone, so that every density here is rho/rho0.
 *
 * Rules that hold for every declaration:
 *   structs   start with `struct_size` = sizeof the struct the caller was compiled with, grow only
 *             at the end, and a new field's zero means the old behaviour. Parameters that an
 *             older caller's pbf_params has not have their defaults, as when it is compiled anew.
 *             Non-zero bytes beyond what the library knows are PBF_ERROR_STRUCT_SIZE, never
 *             ignored.
 *   errors    a call that can fail returns a pbf_status; pbf_last_error() then has a sentence, a
 *             line of UTF-8, that names the argument, its value and what would do. Out-parameters
 *             stay untouched, the solver stays as it was. The library never prints, aborts, exits
 *             or throws; OpenMP's runtime, which comes with `openmp`, may (docs/limits.md).
 *   threads   functions without a solver may be called from any thread at any time. A solver
 *             belongs to one thread at a time; different solvers may run in different threads at
 *             once. A call that meets another one inside the same solver returns PBF_ERROR_BUSY,
 *             but for pbf_cancel, pbf_unmap, pbf_acquire_snapshot and pbf_release_snapshot.
 *   stack     a call takes up to 64 KiB of it, on `cuda` what its driver takes.
 *   signals   so does a call in a signal handler, where its thread has been interrupted at a point
 *             at which it would wait for itself; pbf_destroy then does nothing. What allocates
 *             memory is no more to be called there than malloc. The library's own threads take no
 *             signals but those of faults in them; those in which callbacks run also SIGPWR,
 *             SIGXCPU and real-time ones, by which garbage collectors stop threads, where the
 *             thread that starts them does. OpenMP's take those that the program lets them.
 *   callbacks (the allocator's, the log) should return. One that is left by a C++ exception or a
 *             longjmp leaves its call halfway: from then on the solver's calls in that thread
 *             return PBF_ERROR_STATE, and pbf_destroy frees all that it has. One that ends its
 *             thread (pthread_exit) does so for all threads. pbf_create has set
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
 *             and can be destroyed. A device is the parent's: in the child solvers on it return
 *             PBF_ERROR_DEVICE, can be destroyed, and new ones get PBF_ERROR_UNAVAILABLE, or a
 *             backend of the CPU where desc.strict is 0.
 *   rounding  every call computes with rounding to nearest, subnormal numbers and exceptions
 *             masked, whatever the calling thread has set, and gives that back as it was, flags
 *             included. Callbacks run in between; what they set of it ends with them.
 *   arrays    hold the solver's element type (pbf_desc.precision), row-major, shape
 *             (count, dimension), in the order in which the particles were added.
 *   units     any consistent set; lengths, times and accelerations are the caller's own. In units
 *             that are larger or smaller by powers of two the numbers are the same to the last bit
 *             (seen on CPUs so far).
 */
#ifndef PBF_PBF_H
#define PBF_PBF_H

#include <pbf/base.h>
#include <pbf/desc.h>
#include <pbf/params.h>
#include <pbf/colliders.h>
#include <pbf/loads.h>
#include <pbf/read.h>
#include <pbf/views.h>
#include <pbf/snapshots.h>
#include <pbf/anisotropy.h>
#include <pbf/stats.h>
#include <pbf/plan.h>
#include <pbf/backends.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Versions -------------------------------------------------------------------------------- */

/* Of these headers. */
#define PBF_VERSION_MAJOR 0
#define PBF_VERSION_MINOR 2
#define PBF_VERSION_PATCH 0

/* What pbf_desc.api_version must hold: the header that the caller was compiled with. */
#define PBF_API_VERSION 2u

/* Version of the library at run time, as MAJOR * 1000000 + MINOR * 1000 + PATCH. */
PBF_API uint32_t pbf_version(void);

/* ---- Life of a solver ------------------------------------------------------------------------ */

/* `params` may be null: the defaults. On success *solver is new and holds no particles.
 * PBF_ERROR_UNAVAILABLE: no backend, the sentence lists each one's reason. */
PBF_API pbf_status pbf_create(const pbf_desc *desc, const pbf_params *params, pbf_solver **solver);

/* Null is a no-op. Memory behind exported DLPack tensors lives on until their deleter runs. In a
 * callback the call goes on to its end, begun steps to the end of the present one, without a log;
 * then the solver is freed. */
PBF_API void pbf_destroy(pbf_solver *solver);

/* Runs `steps` time steps. A step that fails leaves particles and time as they were before it;
 * the steps before it stand (pbf_info.step tells). A device works on after the call returns:
 * whatever reads the state waits for it, and pbf_synchronize does just that. */
PBF_API pbf_status pbf_step(pbf_solver *solver, uint32_t steps);

/* The same in two calls, between which the calling thread does other work: pbf_begin_step returns
 * at once, and a thread of the solver's own, which the first of these calls starts, runs the steps
 * with the others of its backend. pbf_end_step, from any thread, waits for them and returns what
 * pbf_step would. In between all other calls return PBF_ERROR_BUSY, but for pbf_cancel,
 * pbf_acquire_snapshot and pbf_release_snapshot; pbf_destroy cancels and waits, but for one in a
 * callback of theirs. Callbacks, and those of a task system, are called by that thread, and may not
 * leave by an exception.
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

/* ---- What serves a solver -------------------------------------------------------------------- */

/* The backend and device that serve a solver, and how far it has come. */
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

/* info->struct_size must be set. */
PBF_API pbf_status pbf_get_info(pbf_solver *solver, pbf_info *info);

/* ---- Particles ------------------------------------------------------------------------------- */

/* How many particles there are. */
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
 * memory. Each call wakes what sleeps. The pressure grid carries them as it carries weight; whether
 * there is one, and cohesion, go by gravity alone. Part of a saved state. PBF_ERROR_UNSUPPORTED
 * from a backend without them. */
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

/* ---- State ----------------------------------------------------------------------------------- */

/* Writes parameters, colliders, emitters, drains, time, particles and their accelerations, portable
 * between backends. With `buffer` null, *size gets the bytes needed; else *size is the room there
 * is, and gets the bytes written. On the same backend and build, a loaded solver continues with the
 * same bits. */
PBF_API pbf_status pbf_save(pbf_solver *solver, void *buffer, uint64_t *size);

/* Replaces the solver's whole state. PBF_ERROR_DATA for anything that pbf_save did not write, of
 * another dimension or precision; the solver is then unchanged. */
PBF_API pbf_status pbf_load(pbf_solver *solver, const void *buffer, uint64_t size);

/* FNV-1a, 64 bit, over step, count and, in the order of adding, ids, positions and velocities; with
 * emitters and drains (emit.h) over these, too. */
PBF_API pbf_status pbf_hash(pbf_solver *solver, uint64_t *hash);

#ifdef __cplusplus
}
#endif

#endif
