/* The plugin ABI: what a backend gives to libpbf. Users of the library need only pbf.h.
 *
 * A backend is a shared object with one exported function, PBF_BACKEND_ENTRY, of type
 * pbf_backend_negotiate_fn. The host has validated everything that it passes: pointers are not
 * null, numbers are finite and in range, counts fit, structs are complete in the size of
 * their struct_size. Calls for one solver never overlap.
 *
 * On failure a function returns a status other than PBF_OK and has called host->set_error with a
 * sentence, pbf_backend_desc.host of the solver; the solver is then as it was before the call.
 */
#ifndef PBF_PBF_BACKEND_H
#define PBF_PBF_BACKEND_H

#include <pbf/pbf.h>
#include <pbf/phases.h>
#include <pbf/ranks.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PBF_BACKEND_ABI_VERSION 3u
#define PBF_BACKEND_ENTRY "pbf_backend_negotiate"

/* What the host offers, valid for the life of the process. */
typedef struct pbf_backend_host {
  uint32_t struct_size;
  uint32_t abi_min; /* versions of this header that the host speaks */
  uint32_t abi_max;
  uint32_t reserved;
  void (*set_error)(const char *sentence); /* for pbf_last_error of this thread; copied */
  /* For a plugin in a file, while it negotiates: the file of that name beside it, or else beside
   * the file that it is a link to, is loaded once it has passed what plugins' files have to, and
   * gives what its function PBF_BACKEND_PART does. Null after set_error: the plugin then answers
   * PBF_ERROR_UNAVAILABLE. A host with a struct_size that ends before has none. */
  const void *(*load_part)(const char *file);
} pbf_backend_host;

/* A part of plugins: a file that several of them share. Which build it is of they have to ask it.
 */
#define PBF_BACKEND_PART "pbf_backend_part"
typedef const void *(*pbf_backend_part_fn)(void);

/* The kind of solver that probe is asked about. */
typedef struct pbf_workload {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t precision;
  uint32_t capacity;
  int32_t device;
  uint32_t threads;
  const char *isa;    /* null: the best; a backend without that choice refuses others */
  uint32_t has_tasks; /* 1: the description has a task system */
  uint32_t reserved;
} pbf_workload;

/* 0: can't serve, `reason` says why. Otherwise, the higher the faster: the scale is millions of
 * particle-iterations a second in the 5-iteration benchmark at this size on this machine. */
typedef struct pbf_probe_result {
  uint32_t struct_size;
  int32_t score;
  uint32_t device_type;
  uint32_t reserved;
  char device_name[96];
  char reason[256];
} pbf_probe_result;

typedef struct pbf_backend_desc {
  uint32_t struct_size;
  uint32_t dimension;
  uint32_t precision;
  uint32_t capacity;
  int32_t device;
  uint32_t threads; /* 0: the backend's choice */
  void *stream;
  pbf_allocator allocator; /* complete: never null functions */
  pbf_log_fn log;          /* never null */
  void *log_user;
  const pbf_backend_host *host; /* whose solver this is: a process may have several libpbf, and they
                                   share the plugin's file, and so what it keeps of negotiations */
  const char *isa;              /* as in pbf_workload; valid during the call */
  pbf_enqueue_task_fn enqueue_task; /* both or neither */
  pbf_finish_task_fn finish_task;
  void *task_user;
  /* Of a batch (pbf/batch.h), of which this solver is one: they are alike, and a device's steps
   * come world after world before it is waited for, to run at once. 0: it is alone. Changes no bit.
   */
  uint32_t worlds;
  uint32_t determinism;   /* as in pbf_desc */
  const pbf_ranks *ranks; /* complete, valid during the call; null: alone. Only given to backends
                             with the extension PBF_BACKEND_RANKS */
} pbf_backend_desc;

/* The extension of a backend that works on ranks. It is given all particles, as all ranks are, and
 * gives all. A uint32_t: 1, or 2 where phases that differ may be among them. */
#define PBF_BACKEND_RANKS "pbf.ranks/1"

/* The extension of a backend that takes more than 64 colliders: a uint32_t, how many at most. */
#define PBF_BACKEND_COLLIDERS "pbf.colliders/1"

/* New particles. Their ids ascend and are above all ids that the solver has held. */
typedef struct pbf_particles {
  uint32_t struct_size;
  uint32_t count;
  const uint32_t *ids;
  const void *positions;  /* (count, dimension), element type of the solver */
  const void *velocities; /* (count, dimension); null: at rest */
  uint32_t phase;         /* of all, below pbf_phase_table.count, or 0 */
  uint32_t wakes_all;     /* 1: what sleeps wakes, not only around them */
} pbf_particles;

/* Rows first … first + count - 1 of the solver's particles in ascending order of id. `ids` has all
 * the solver's ids in that order; null: the ids are 0 … N - 1, so that row and id are the same. */
typedef struct pbf_rows {
  uint32_t struct_size;
  uint32_t first;
  uint32_t count;
  uint32_t total; /* particles that the solver holds */
  const uint32_t *ids;
} pbf_rows;

/* Where particles are looked for: lower[k] <= x[k] <= upper[k] along each axis k that there is. */
typedef struct pbf_backend_box {
  double lower[3], upper[3];
} pbf_backend_box;

/* Particles that were looked for, in an order that equal particles in equal places always have. */
typedef struct pbf_backend_found {
  uint32_t struct_size;
  uint32_t room;     /* of the arrays: particles */
  uint32_t count;    /* of all that were found; the first `room` of them are in the arrays */
  uint32_t reserved; /* 0 */
  uint32_t *ids;
  void *positions, *velocities; /* (room, dimension), element type of the solver */
} pbf_backend_found;

/* What pbf_collider.geometry points to: as long as a solver has a collider of it, it stays where it
 * is and does not change. */
struct pbf_shape {
  uint32_t struct_size;
  uint32_t dimension;
  uint64_t id;       /* no other one in the process has or had it */
  uint32_t nodes[3]; /* nodes along each axis; in 2D the third is 1 */
  uint32_t reserved; /* 0 */
  double origin[3], cell;
  double lower[3], upper[3]; /* of a box around the inside */
  double bound;              /* nothing of the inside is farther from 0 */
  double volume, area;
  double
      steepest; /* the interpolated distance changes by no more than so many times the way, >= 1 */
  const float *values;
  uint64_t hash; /* pbf_shape_info.hash: the same in other processes */
};

/* What pbf_backend_api.describe reports; pbf_info and pbf_plan without what the host knows. */
typedef struct pbf_backend_state {
  uint32_t struct_size;
  uint32_t threads;
  uint32_t device_type;
  uint32_t reserved;
  char device_name[96];
} pbf_backend_state;

/* Memory that outlives the solver by which it was taken. */
typedef struct pbf_backend_array {
  uint32_t struct_size;
  uint32_t device_type; /* PBF_DEVICE_… */
  int32_t device_id;
  uint32_t reserved; /* 0 */
  void *data;
  void *owner; /* the backend's */
} pbf_backend_array;

/* Beside the PBF_FIELD_… of pbf.h: what a backend keeps of a particle while params.sleep_speed is
 * not 0, for saved states. Two numbers of the backend's own, the first -1 while it sleeps. */
enum { PBF_BACKEND_FIELD_REST = 100, PBF_BACKEND_REST_COMPONENTS = 2 };

/* And while it knows of an overlap: what is left of it, a number of each particle. The host writes
 * the second to those that have been set elsewhere since the last step, which are placed as those
 * of pbf_overlap are. */
enum { PBF_BACKEND_FIELD_OVERLAP = 101 };
#define PBF_BACKEND_OVERLAP_PLACED 1e30

/* Of a backend with this extension, a uint32_t of 1, while params.solver is PBF_SOLVER_CHEBYSHEV:
 * the pressure of the last step, of which the next one takes over a part. A number of each
 * particle, 0 of new ones. */
#define PBF_BACKEND_LAST_PRESSURE "pbf.last_pressure/1"
enum { PBF_BACKEND_FIELD_LAST_PRESSURE = 103 };

/* To be written between set_phases with a table and without: its phase, a uint8_t a particle. */
enum { PBF_BACKEND_FIELD_PHASE = 102 };

/* To be written between set_accelerations with 1 and with 0: a particle's acceleration beside
 * gravity, a vector. 0 of new ones. */
enum { PBF_BACKEND_FIELD_ACCELERATION = 104 };

/* Of phases that differ. */
typedef struct pbf_phase_table {
  uint32_t struct_size;
  uint32_t count;
  double mobility[PBF_MAX_PHASES];  /* 1 / pbf_phase.rest_density */
  double viscosity[PBF_MAX_PHASES]; /* as pbf_phase; … */
  double thickness[PBF_MAX_PHASES]; /* … and dynamic, over the thickest phase's, 0 … 1 */
  double thickest;                  /* viscosity * rest_density of that */
  double heaviest;                  /* rest_density, or 1 */
  uint32_t used;                    /* those that there are particles of, or may come, a bit each;
                                       0: all */
  uint32_t reserved;                /* 0 */
} pbf_phase_table;

/* Particles that enter by an emitter's opening: those of the range of ids of which a part is still
 * outside. What each has of that, 0 … 1, the host writes to its PBF_BACKEND_FIELD_OVERLAP between
 * set_overlap and the step. */
typedef struct pbf_entering {
  uint32_t struct_size;
  uint32_t alone; /* 1: there is no other overlap to be found */
  uint32_t first_id, last_id;
  double kept;               /* of what was allowed for before, near one that enters */
  double lower[3], upper[3]; /* a box around all that is within h of one */
  uint32_t stream_first_id;  /* from here to last_id they are the streams' own, also those that are
                                let go of and still within h of one that is near one that enters */
  uint32_t reserved;
} pbf_entering;

/* What lies in other fluid, or in a solid, where no step has moved it: found there, an overlap. */
typedef struct pbf_overlap {
  uint32_t struct_size;
  uint32_t walls;                 /* 1: walls have jumped into the fluid */
  uint32_t first_id, last_id;     /* particles placed; none: first_id > last_id */
  uint64_t colliders;             /* placed, a bit each of the first 64, … */
  double part;                    /* of what all fluid is too dense by beyond what is
                                     allowed for: so much more is, or less where it is below 0; at
                                     most 1 */
  const uint64_t *more_colliders; /* … and of each 64 after them; null where there are no more, and
                                     valid during the call */
  double reference;             /* the error under all fluid at rest that there is, as far as steps
                                   have left it, … */
  double before, now;           /* … and the parts of it that steps left so far, and leave now;
                                   where steps are as before `part` is 0, and these say nothing */
  double least;                 /* what is allowed for may be so far below 0; the error that steps
                                   leave under all of the fluid */
  const pbf_entering *entering; /* null: none do; valid during the call */
} pbf_overlap;

typedef struct pbf_backend_solver pbf_backend_solver;

/* The extension of a backend on ranks that tells them what one knows. All ranks call `any` alike,
 * between the steps of a call: *any becomes 1 where `mine` is 1 on a rank, else 0. Without it a
 * call that is cancelled on ranks goes on to its end. `note` gives a number of what the library has
 * been told and keeps itself, as emitters, which ranks must have in common like parameters; without
 * it ranks that differ there are told when particles do. */
#define PBF_BACKEND_RANKS_TELL "pbf.ranks_tell/1"
typedef struct pbf_backend_ranks_tell {
  uint32_t struct_size;
  uint32_t reserved;
  pbf_status (*any)(pbf_backend_solver *solver, uint32_t mine, uint32_t *any);
  void (*note)(pbf_backend_solver *solver, uint64_t settings); /* or missing: struct_size */
  /* Of the particles of this rank's share, in any order, how many there are and, unless it is null,
   * their ids; and positions or velocities of some of them, by their ids, rows->ids. They ask no
   * other rank. Both or neither: struct_size */
  pbf_status (*own_ids)(pbf_backend_solver *solver, uint32_t *count, uint32_t *ids);
  pbf_status (*read_own)(pbf_backend_solver *solver, uint32_t field, const pbf_rows *rows,
                         void *out);
} pbf_backend_ranks_tell;

/* The extension of a backend that steps the worlds of a batch together. Between put_off(world, 1)
 * and put_off(world, 0) `step` may say that steps are done which it has only noted: they are done
 * once `run` has been called with the world, or any other call of it, which does them first. `run`
 * takes worlds of one batch, the same first one each time; those with nothing noted stay as they
 * are. A world has the same bits in any company. */
#define PBF_BACKEND_WORLDS "pbf.worlds/1"
typedef struct pbf_backend_worlds {
  uint32_t struct_size;
  uint32_t reserved;
  void (*put_off)(pbf_backend_solver *world, uint32_t on);
  pbf_status (*run)(pbf_backend_solver *const *worlds, uint32_t count);
} pbf_backend_worlds;

/* Rows in the caller's memory on the device, as pbf_read_desc and pbf_write_desc describe them. */
typedef struct pbf_device_rows {
  uint32_t struct_size;
  uint32_t field;        /* PBF_FIELD_… */
  const pbf_rows *rows;  /* at least one */
  uint32_t element_type; /* PBF_TYPE_FLOAT32 or _FLOAT64, of ids _UINT32 */
  uint32_t components;   /* of a vector, dimension … 4; else 1 */
  uint32_t w;            /* PBF_W_… */
  uint32_t order;        /* PBF_ORDER_… */
  uint64_t stride;       /* bytes */
  void *data;
  void *stream; /* the caller's; null: the solver's own */
  double w_value;
  double most;      /* that a number may have in size, where they are written */
  const char *name; /* of `data`, for sentences */
} pbf_device_rows;

/* The extension of a backend with solvers that read and write such rows. What it does comes after
 * what `stream` has been given before the call, and before what it is given after. `data` that is
 * not memory of the device, or too little of it, is PBF_ERROR_INVALID_ARGUMENT. */
#define PBF_BACKEND_DEVICE_ROWS "pbf.device_rows/1"
typedef struct pbf_backend_device_rows {
  uint32_t struct_size;
  uint32_t reserved;
  pbf_status (*read)(pbf_backend_solver *solver, const pbf_device_rows *to);
  /* PBF_FIELD_VELOCITY. Where numbers are not finite, or larger than `most`, none is written, and
   * `step` or `synchronize` returns PBF_ERROR_INVALID_ARGUMENT once the device has found them.
   * Wakes all. */
  pbf_status (*write)(pbf_backend_solver *solver, const pbf_device_rows *from);
  /* To the host's memory, without gaps; waits for it. */
  pbf_status (*fetch)(pbf_backend_solver *solver, const pbf_device_rows *from, void *to);
} pbf_backend_device_rows;

typedef struct pbf_backend_api pbf_backend_api;

/* All members must be set, except those marked optional. */
struct pbf_backend_api {
  uint32_t struct_size;
  uint32_t reserved;

  /* Any thread, any time; must not fail nor touch devices' state. */
  void (*probe)(const pbf_workload *workload, pbf_probe_result *result);

  /* *api gets the table for this solver's other calls: this one, or that of a variant (dimension,
   * precision, …), static storage too. The host checks it as it checked this one. */
  pbf_status (*create)(const pbf_backend_desc *desc, const pbf_params *params,
                       pbf_backend_solver **solver, const pbf_backend_api **api);
  void (*destroy)(pbf_backend_solver *solver);

  pbf_status (*set_params)(pbf_backend_solver *solver, const pbf_params *params);

  /* `time` is when the poses hold. The array has `count` structs of this header's size. */
  pbf_status (*set_colliders)(pbf_backend_solver *solver, uint32_t count,
                              const pbf_collider *colliders, double time);

  /* Runs `steps` steps; the walls and colliders of step k (from 1) stand where they are at
   * time + (before + k) * time_step, computed so, that the bits are those of any other way to
   * divide steps into calls. *done counts the steps completed, also on failure. With 0 steps the
   * backend only notes the time: where walls and colliders stand for densities and statistics. */
  pbf_status (*step)(pbf_backend_solver *solver, double time, uint64_t before, uint32_t steps,
                     uint32_t *done);

  pbf_status (*synchronize)(pbf_backend_solver *solver);

  /* `create` has taken the memory for `capacity` particles, so that adding and removing can fail
   * only with the device. `ids` ascend and are all present. */
  pbf_status (*add_particles)(pbf_backend_solver *solver, const pbf_particles *particles);
  pbf_status (*remove_particles)(pbf_backend_solver *solver, uint32_t count, const uint32_t *ids);
  pbf_status (*remove_all)(pbf_backend_solver *solver);

  /* Copies a field (PBF_FIELD_POSITION, _VELOCITY, _DENSITY), rows ascending by id. Only of a
   * solver that accepted a sleep_speed: PBF_BACKEND_FIELD_REST, here and in `write`; only between
   * set_overlap with an overlap and without: PBF_BACKEND_FIELD_OVERLAP; and with its extension
   * PBF_BACKEND_FIELD_LAST_PRESSURE. */
  pbf_status (*read)(pbf_backend_solver *solver, uint32_t field, const pbf_rows *rows, void *out);

  /* Overwrites PBF_FIELD_POSITION or PBF_FIELD_VELOCITY, which wakes all. */
  pbf_status (*write)(pbf_backend_solver *solver, uint32_t field, const pbf_rows *rows,
                      const void *in);

  /* Fills a view of PBF_FIELD_POSITION, _VELOCITY or _ID; generation is the host's. The view
   * holds until the particles change: the host sees to that. */
  pbf_status (*map)(pbf_backend_solver *solver, uint32_t field, pbf_view *view);

  /* The host has zeroed the struct and set struct_size. */
  pbf_status (*get_stats)(pbf_backend_solver *solver, pbf_stats *stats);
  pbf_status (*get_plan)(pbf_backend_solver *solver, pbf_plan *plan);
  pbf_status (*describe)(pbf_backend_solver *solver, pbf_backend_state *state);

  /* Optional, both or neither: per-stage times. */
  pbf_status (*set_timing)(pbf_backend_solver *solver, uint32_t enabled);
  pbf_status (*get_timings)(pbf_backend_solver *solver, pbf_timings *timings);

  /* Optional: extensions by name and revision, "pbf.example/1"; null for unknown ones. */
  const void *(*get_extension)(const char *name);

  /* Optional, both or neither: p/rho0 of the last step (pbf_get_pressures), read by rows ascending
   * by id, and as a view. Not called while params.solver is PBF_SOLVER_JACOBI. */
  pbf_status (*read_pressures)(pbf_backend_solver *solver, const pbf_rows *rows, void *out);
  pbf_status (*map_pressures)(pbf_backend_solver *solver, pbf_view *view);

  /* Optional: moves the particles towards rest density by `iterations` of the density solve,
   * between walls and colliders as they stand at `time`. Velocities stay; wakes all. Called before
   * `step`, while params.solver is PBF_SOLVER_CHEBYSHEV. */
  pbf_status (*project)(pbf_backend_solver *solver, double time, uint32_t iterations);

  /* Optional: the density that this overlap adds is not pushed apart in the next step, but from
   * step to step (physics/depenetration.h). Null: nothing overlaps any more, as also before
   * `project`. Called before `step`, while params.solver is PBF_SOLVER_CHEBYSHEV. */
  pbf_status (*set_overlap)(pbf_backend_solver *solver, const pbf_overlap *overlap);

  /* Optional: the number of particles by which the backend chooses what runs, and how finely, where
   * parameters leave it the choice (pressure_grid -1); 0 until it is called. At most a third more
   * than `capacity`, and 3; the memory for it has been taken before. */
  pbf_status (*plan_for)(pbf_backend_solver *solver, uint32_t count);

  /* Optional: the speed of the fastest particle, pbf_stats.speed_max without the rest. */
  pbf_status (*max_speed)(pbf_backend_solver *solver, double *speed);

  /* Optional, all or none: fields that stay on the device. `take_array` fills *array, whose
   * struct_size is set, with memory there; `release_array` gives it back, in any thread, after
   * `destroy`, too. `read_array` writes into such memory what `read` of PBF_FIELD_POSITION or
   * PBF_FIELD_VELOCITY gives, and zeros behind that, up to row `room`: ready after `synchronize`.
   */
  pbf_status (*take_array)(pbf_backend_solver *solver, uint64_t bytes, pbf_backend_array *array);
  void (*release_array)(const pbf_backend_array *array);
  pbf_status (*read_array)(pbf_backend_solver *solver, uint32_t field, const pbf_rows *rows,
                           uint32_t room, void *data);

  /* Optional: loads of solids first … first + count - 1, the six walls before the colliders; begins
   * their sums anew. Called while params.loads is 1. `struct_size` is the host's to set. */
  pbf_status (*get_loads)(pbf_backend_solver *solver, uint32_t first, uint32_t count,
                          pbf_collider_load *loads);

  /* Optional: particles differ in mass, by their phase in this table; all are of phase 0 until
   * PBF_BACKEND_FIELD_PHASE is written. Null: they are alike. Wakes all, but
   * for a call that fails, which changes nothing. While there is a table, parameters are without
   * what phases.h says is refused; params.pressure_grid may be -1 where a grid would carry nothing
   * of such phases, and none is to be had. */
  pbf_status (*set_phases)(pbf_backend_solver *solver, const pbf_phase_table *table);

  /* Optional, both or none: the most that steps so far have left of an error for each layer of
   * fluid at rest (physics/steps_leave.h), by which the backend chooses what runs, too; 0 until it
   * is called. And what steps that leave so much for each layer leave under all of the fluid, after
   * those that have left `most`; below 0 where it is not known: nothing has weight, or phases
   * differ. */
  pbf_status (*plan_steps)(pbf_backend_solver *solver, double most);
  double (*steps_leave)(pbf_backend_solver *solver, double error, double most);

  /* Optional: particles have accelerations beside gravity, PBF_BACKEND_FIELD_ACCELERATION, which
   * act in each step and are 0 until they are written; or, with 0, none any more. */
  pbf_status (*set_accelerations)(pbf_backend_solver *solver, uint32_t on);

  /* Optional, for backends with memory that the host can't read: the particles in any of `count`
   * boxes, 1 at least. Fills *found, but for its room. */
  pbf_status (*find_in_boxes)(pbf_backend_solver *solver, uint32_t count,
                              const pbf_backend_box *boxes, pbf_backend_found *found);
};

/* What the plugin answers. */
typedef struct pbf_backend_answer {
  uint32_t struct_size;
  uint32_t abi_version; /* the one it chose, abi_min … abi_max */
  char name[PBF_NAME_SIZE];
  char build_id[96];
  const pbf_backend_api *api; /* static storage */
} pbf_backend_answer;

/* The host has zeroed *answer and set its struct_size. PBF_ERROR_UNSUPPORTED when no common
 * version exists, PBF_ERROR_UNAVAILABLE, with a sentence, when something that it needs is missing.
 */
typedef pbf_status (*pbf_backend_negotiate_fn)(const pbf_backend_host *host,
                                               pbf_backend_answer *answer);

#ifdef __cplusplus
}
#endif

#endif
