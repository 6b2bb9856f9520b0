/* The loops over particles and pairs that are built once for each instruction set, and what they
 * work on. A loop's result for a particle never depends on the range it was called with. */
#ifndef PBF_CPU_KERNELS_H
#define PBF_CPU_KERNELS_H

#include "common/pressure_grid.h"
#include "cpu/grid.h"
#include "physics/grid_loads.h"
#include "physics/load_parts.h"
#include "physics/no_slip.h"
#include "physics/passes/predict.h"
#include "physics/passes/shear_stress.h"
#include "physics/sleep.h"

/* Where the neighbours of a group, as many consecutive sorted particles as the vectors have lanes,
 * are listed: blocks.h. */
typedef struct group {
  uint32_t begin; /* in units of LIST_UNIT bytes */
  uint32_t blocks;
} group;

enum { LIST_UNIT = 16 };

typedef struct lists {
  const group *groups;
  const uint8_t *data;
  pbf_real far;   /* an x out of reach of all particles */
  uint32_t count; /* particles */
} lists;

/* Memory for lists: the units next … end - 1, and a function that provides more when these are
 * used up: it sets both, or returns 0. */
typedef struct list_arena {
  uint64_t next, end;
  int (*more)(void *context, struct list_arena *space);
  void *context;
} list_arena;

/* What the lists of some groups take, whether or not there was room. */
typedef struct list_size {
  uint64_t units;
  uint32_t largest; /* of a group */
  uint32_t lacking; /* 1: there was not */
} list_size;

/* Candidates in one row that are still to be tested, with an image of the particles. */
typedef struct candidate_range {
  uint32_t next, end, image;
} candidate_range;

/* In each row around. */
typedef struct row_candidates {
  candidate_range in[GRID_ROWS_AROUND];
} row_candidates;

/* Cells of a row in which the particles are. */
typedef struct reached_cells {
  uint32_t row, first, last;
} reached_cells;

/* Where along the rows: beyond a face that is periodic there are more. */
enum { BETWEEN_FACES, BEYOND_LOWER, BEYOND_UPPER };

/* What the search reads and where it writes. */
typedef struct search search;
struct search {
  const struct grid *grid;
  const pbf_vec *images; /* where they are, IMAGES of them */
  pbf_real h2;
  field x;                  /* sorted */
  const uint32_t *cells;    /* of the sorted particles */
  const uint32_t *cell_end; /* cell_end[c - 1] … cell_end[c] - 1 are the particles in cell c */
  uint32_t count;
  group *groups;
  uint8_t *data;
  /* Candidates around particles. */
  void (*candidates)(const search *s, const reached_cells *from, int where, row_candidates *found);
};

/* What pbf_boundary_correction needs, of particles in groups near walls. */
typedef struct boundary_cache {
  field gradient;
  pbf_real *rest;
} boundary_cache;

/* How far particles may go in the iterations of a step until a collider can be met. */
typedef struct clear_ways {
  pbf_real *of;    /* as far as clear_reach; 0: some may be there already; null: nothing is known */
  int first;       /* iteration, in which lambda finds them */
  field predicted; /* where particles were then */
} clear_ways;

/* What a pass over pairs needs beside the lists and its own arrays. */
typedef struct pair_pass {
  const pbf_constants *constants;
  int features;
  struct lists lists;
  const pbf_vec *images;             /* where they are */
  field x;                           /* sorted */
  const pbf_real *quads;             /* as pack makes them, of x and what move looks up */
  const pbf_real *vectors;           /* and of what else a pass looks up */
  const pbf_obstacles *contributing; /* density; null: none do */
  const pbf_real *residual_density;  /* null: none */
  pbf_real *overlap;                 /* null: none; lambda bounds it */
  int64_t *error_units;              /* lambda adds the density error to it; null: none is wanted */
  const pbf_real *activity;          /* null: nothing sleeps */
  const pbf_real *mobility;          /* null: phases do not differ; lambda alone asks for it, … */
  const pbf_real *last_pressure;     /* … and for this, by order; null: nothing is smoothed */
  const uint32_t *order;
  clear_ways clear;
  boundary_cache boundary; /* lambda leaves it for move, at the same places */
} pair_pass;

/* What an iteration moves particles by, and to. */
typedef struct move_pass {
  const pbf_real *lambda;
  const uint32_t *ids;
  const pbf_real *overlap; /* null: none */
  const pbf_obstacles *obstacles;
  int collide; /* with these */
  pbf_real inv_time_step;
  field predicted, to;
  field velocity;           /* goes along */
  const field *push;        /* of solids, to which what they do here is added; null: it is not */
  const pbf_real *mobility; /* null: phases do not differ */
} move_pass;

/* What the compensation of damping works on. */
typedef struct damping_pass damping_pass;
struct damping_pass {
  const pbf_real *lambda;
  pbf_real inv_time_step;
  field flow, velocity;
  const field *torque;      /* that is made up for; null: none is */
  const pbf_real *mobility; /* null: phases do not differ */
  /* What a particle's sums make between obstacles: the same for all instruction sets. */
  pbf_vec (*between)(const pair_pass *p, const damping_pass *u, uint32_t i, pbf_vec end,
                     pbf_vec start);
};

/* What torque.h and angular_momentum.h work on: a field's first PBF_CURL_DIM arrays are a torque,
 * or a rate. */
typedef struct momentum_pass {
  const pbf_real *lambda; /* what an iteration moves by */
  field start;            /* of the step: where particles were */
  field torque, rate, velocity;
  const pbf_real *mobility; /* null: phases do not differ */
} momentum_pass;

/* What shear_stress.h works on. */
typedef struct shear_pass shear_pass;
struct shear_pass {
  const pbf_real *lambda;
  field deviator;    /* times lambda, … */
  pbf_real *rest[2]; /* … and of its components those that no vector has room for */
  field push;        /* and before that what walls push with; over masses, where these differ */
  field change;      /* of the velocity */
  const pbf_real *mobility, *mass; /* null: phases do not differ */
};

/* What surface_tension.h works on. */
typedef struct tension_pass tension_pass;
struct tension_pass {
  pbf_real *missing;
  field velocity;
  /* The density that solids contribute to particle i: the same for all instruction sets. */
  pbf_real (*solids)(const pair_pass *p, uint32_t i);
};

/* What a stage of viscosity works on. */
typedef struct viscous_pass {
  pbf_viscosity_weights weights;
  const pbf_obstacles *obstacles; /* that fluid sticks to; null: it slides on all */
  const pbf_no_slip *no_slip;     /* and how much */
  const pbf_real *crowding;       /* what is left out of it */
  const uint8_t *phase;           /* null: phases do not differ */
  field v;                        /* of the prediction */
  field force;                    /* which the first stage finds */
  field change, next; /* after the last one; and after the one before it, and then after this one */
} viscous_pass;

/* The sums of a solid, and what they are told in. */
typedef struct load_slot {
  pbf_load_sums *sums;
  const pbf_load_measure *measure;
} load_slot;

/* What becomes a part of loads: physics/loads.h. `recent` has the sums. */
typedef struct load_pass {
  const pbf_constants *constants;
  const pbf_obstacles *obstacles;
  const pbf_load_scales *scales;
  load_slot (*slot_of)(void *recent, int solid);
  void *recent;
  field x, v, push;
  const pbf_real *lambda;
  const pbf_real *mobility; /* null: phases do not differ */
} load_pass;

/* What the pressure grid does to solids. */
typedef struct grid_load_pass {
  const pbf_pressure_grid_storage *storage;
  const pbf_obstacles *obstacles;
  const pbf_load_scales *scales;
  load_slot (*slot_of)(void *recent, int solid);
  void *recent;
  pbf_grid_load_cubes cubes;
} grid_load_pass;

/* Sorted particles of which one byte says whether any of them can be awakened. */
enum { ACTIVITY_CHUNK = 32 };

/* No place in any order. */
#define AWAKENED UINT32_MAX

/* Nodes of the pressure grid that are done at once, at most. */
enum { PRESSURE_GRID_LANES = 8 };

/* Null: built without the feature. */
typedef struct kernels {
  uint32_t width; /* particles in a group */

  /* Particles first … last - 1, in any order. */
  void (*predict)(const pbf_forces *forces, const pbf_obstacles *obstacles, int collide, field x,
                  field v, field predicted, field velocity, uint32_t first, uint32_t last);
  void (*backtrack)(pbf_real time_step, field predicted, field velocity, field before,
                    uint32_t first, uint32_t last);
  void (*bounds)(field x, uint32_t first, uint32_t last, pbf_vec *lower, pbf_vec *upper);
  void (*cells)(const grid *grid, field x, uint32_t first, uint32_t last, uint32_t *cells,
                uint32_t *lowest, uint32_t *highest);
  void (*collide)(const pbf_obstacles *obstacles, pbf_real inv_time_step, field predicted, field x,
                  field velocity, uint32_t first, uint32_t last);

  /* x of each particle and, unless null, a number of it: the quads of neighbors.h. Null: loops over
   * pairs read no quads. */
  void (*pack)(field x, const pbf_real *number, pbf_real *quads, uint32_t first, uint32_t last);

  /* Groups first … last - 1 of sorted particles. */
  list_size (*search)(const search *s, uint32_t first, uint32_t last, list_arena *space);
  void (*lambda)(const pair_pass *p, pbf_real *lambda, pbf_real *added, uint32_t first,
                 uint32_t last);
  void (*move)(const pair_pass *p, const move_pass *m, uint32_t first, uint32_t last);
  void (*curl)(const pair_pass *p, field v, pbf_real *const curl[PBF_CURL_DIM], pbf_real *size,
               uint32_t first, uint32_t last);
  void (*confine)(const pair_pass *p, pbf_real *const curl[PBF_CURL_DIM], const pbf_real *size,
                  field v, uint32_t first, uint32_t last);
  void (*missing_neighbors)(const pair_pass *p, const tension_pass *t, uint32_t first,
                            uint32_t last);
  void (*surface_tension)(const pair_pass *p, const tension_pass *t, uint32_t first, uint32_t last);
  void (*compensate_damping)(const pair_pass *p, const damping_pass *u, uint32_t first,
                             uint32_t last);
  /* Adds the torque of the move that is next, … */
  void (*torque)(const pair_pass *p, const momentum_pass *t, uint32_t first, uint32_t last);
  /* … and at the end finds rates, and turns with them. */
  void (*angular_rate)(const pair_pass *p, const momentum_pass *t, uint32_t first, uint32_t last);
  void (*turn)(const pair_pass *p, const momentum_pass *t, uint32_t first, uint32_t last);
  /* Deviators and what walls push with, what pushes make up for, and velocities by these. */
  void (*deviator)(const pair_pass *p, const shear_pass *s, uint32_t first, uint32_t last);
  void (*shear_push)(const pair_pass *p, const shear_pass *s, uint32_t first, uint32_t last);
  void (*shear_stress)(const pair_pass *p, const shear_pass *s, uint32_t first, uint32_t last);
  /* Particles with a source within h, `is_source` above 0, are AWAKENED. */
  void (*wake_neighbors)(const pair_pass *p, const pbf_real *is_source, const uint8_t *has_sleepers,
                         uint32_t *awakened, uint32_t first, uint32_t last);
  void (*viscosity)(const pair_pass *p, field v, field smoothed, uint32_t first, uint32_t last);
  /* What crowding leaves out of viscosity, and a stage of that. */
  void (*crowding)(const pair_pass *p, pbf_real *left_out, uint32_t first, uint32_t last);
  void (*viscous_stress)(const pair_pass *p, const viscous_pass *s, uint32_t first, uint32_t last);
  /* `neighbors` null: they are not counted. */
  void (*density)(const pair_pass *p, pbf_real *density, uint32_t *neighbors, uint32_t first,
                  uint32_t last);
  /* What passes/pressure_fit.h makes of numbers that the particles have. */
  void (*fit)(const pair_pass *p, const pbf_real *numbers, pbf_real *fitted, uint32_t first,
              uint32_t last);
  /* The sums of passes/overlap.h, by the numbers that the particles have. */
  void (*placed_density)(const pair_pass *p, const pbf_real *numbers, pbf_real *placed,
                         pbf_real *stream, uint32_t first, uint32_t last);
  /* Whether one of the places where a group's neighbours are looked for has a number but 0. */
  int (*any_number_around)(const pair_pass *p, const pbf_real *numbers, uint32_t group);
  void (*residual_density)(const pbf_constants *constants, pbf_real *density, uint32_t first,
                           uint32_t last);

  /* What pushes particles beside forces, at the beginning of loads: kernels_loads.h. */
  void (*note_pushes)(double units, field v, field push, const pbf_real *mobility, uint32_t first,
                      uint32_t last, pbf_wide_sum change[PBF_DIM]);
  /* Adds up what the velocities of at most 32 particles that are awake are, and what walls and some
   * colliders do to them; `near` null: none is near. Returns, a bit each, those of which it is not
   * done. Null: built for size. */
  uint32_t (*loads)(const load_pass *p, const uint16_t *near, int count, uint32_t first,
                    uint32_t last, pbf_wide_sum change[PBF_DIM]);

  /* Adds what the grid's pressure around points, at most as many as a group has particles, does to
   * walls and to those of `count` colliders that are near them. 0: it is not done, since there are
   * too many of these. Null: built for size. */
  int (*grid_loads)(const grid_load_pass *p, const uint16_t *near, int count, field x,
                    uint32_t points);

  /* The pressure grid's, over particles … */
  void (*deposit)(const pbf_pressure_grid_storage *storage, pbf_real target, field x,
                  pbf_real *densities, const pbf_real *overlaps, uint32_t first,
                  uint32_t last); /* has the particles' cells in place of densities then */
  void (*deposit_moves)(const pbf_pressure_grid_storage *storage, field x, field v,
                        field acceleration, uint32_t first,
                        uint32_t last); /* where forces differ from particle to particle */
  void (*apply_correction)(const pbf_pressure_grid_storage *storage, const pbf_obstacles *obstacles,
                           const pbf_real *mobility, const pbf_real *cells, pbf_real inv_time_step,
                           field x, field v, uint32_t first, uint32_t last);
  /* … and over nodes: kernels_pressure_grid.h. */
  void (*equations)(const pbf_pressure_grid_storage *storage,
                    const pbf_pressure_grid_source_scale *source_scale, const int i[PBF_DIM],
                    int last, uint32_t row);
  int (*relax)(const pbf_pressure_grid_storage *storage, const pbf_pressure_grid_solve *solve,
               uint32_t first, uint32_t last);
} kernels;

/* Those of them in which most of a step's time goes, with fused multiply-add: with bits of their
 * own, the same for all sets that have it. */
typedef struct fused_kernels {
  void (*lambda)(const pair_pass *p, pbf_real *lambda, pbf_real *added, uint32_t first,
                 uint32_t last);
  void (*move)(const pair_pass *p, const move_pass *m, uint32_t first, uint32_t last);
} fused_kernels;

#endif
