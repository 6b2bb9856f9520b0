/* pbf/read.h: particles in the layout that the caller has, as a vertex buffer has it, in host
 * memory or a GPU's; and where they were between two steps.
 *
 * The rules of pbf.h hold here, too.
 */
#ifndef PBF_READ_H
#define PBF_READ_H

#include <pbf/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Reading into the caller's own layout ---------------------------------------------------- */

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
  uint32_t device_type; /* of `data`: PBF_DEVICE_CPU or 0: host memory; PBF_DEVICE_CUDA: memory of
                           the GPU that the solver runs on, be it allocated by CUDA or a buffer of
                           Vulkan, Direct3D or OpenGL that CUDA has mapped */
  uint32_t reserved;    /* 0 */
  void *stream; /* of that memory, a cudaStream_t: `data` is written after what it has been given so
                   far, and before what it is given next; null: pbf_desc.stream */
} pbf_read_desc;

/* Writes nothing but what it is asked for, at about the speed of memory: to memory of a GPU by a
 * kernel, for which the host does not wait; from a GPU to host memory by a copy. Looks for
 * neighbours only where densities or pressures are read. Memory of a GPU is PBF_ERROR_UNSUPPORTED
 * of a solver on a CPU or on ranks, and with `behind`. */
PBF_API pbf_status pbf_read(pbf_solver *solver, const pbf_read_desc *read);

/* ---- Writing from the caller's own layout ---------------------------------------------------- */

/* Which numbers of which particles, and where they come from, as pbf_read_desc has it. */
typedef struct pbf_write_desc {
  uint32_t struct_size;
  uint32_t field; /* PBF_FIELD_POSITION or _VELOCITY */
  uint32_t first; /* rows, as for pbf_set_positions */
  uint32_t count;
  uint32_t element_type; /* PBF_TYPE_FLOAT32 or _FLOAT64; 0: the solver's own */
  uint32_t components;   /* numbers of a particle in `data`, of which those of the dimension count:
                            up to 4; 0: as many as these */
  uint64_t stride;       /* bytes from a particle to the next; 0: no gap */
  const void *data;
  uint32_t device_type; /* as in pbf_read_desc */
  uint32_t reserved;    /* 0 */
  void *stream;         /* as there: what it has been given so far makes `data` */
} pbf_write_desc;

/* As pbf_set_positions and pbf_set_velocities. Velocities in memory of a GPU are written there, and
 * the host does not wait: where some are not finite none is written, and the first pbf_step or
 * pbf_synchronize after the GPU has found that returns PBF_ERROR_INVALID_ARGUMENT with their row.
 * Positions there are copied to the host first, which has to see them. */
PBF_API pbf_status pbf_write(pbf_solver *solver, const pbf_write_desc *write);

/* 1: from now on pbf_step keeps the positions from before its last step, for pbf_read_desc.behind,
 * in host memory that is taken now, a position for each particle of capacity. That costs a reading
 * of the positions each pbf_step, and no bit. 0: gives the memory back. They can't be had from
 * velocities, which say less and more than where a particle came from: collisions, what overlaps
 * and artificial pressure move without, vorticity, XSPH and drag act on velocities alone.
 * A particle that is added, or given a position, has been where it is; so have all after a
 * load, or a step that fails or is cancelled. */
PBF_API pbf_status pbf_keep_previous(pbf_solver *solver, uint32_t enabled);

#ifdef __cplusplus
}
#endif

#endif
