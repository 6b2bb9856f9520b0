/* Spray, foam and bubbles: what a solver has of them, and their part in a step. */
#ifndef PBF_LIB_DIFFUSE_DIFFUSE_H
#define PBF_LIB_DIFFUSE_DIFFUSE_H

#include <math.h>

#include <pbf/diffuse.h>

#include "solver/solver.h"

typedef struct pbf_diffuse_particle {
  double position[3], velocity[3];
  double born, dies; /* times */
  uint64_t id;
  uint32_t kind;     /* PBF_DIFFUSE_… */
  uint32_t reserved; /* 0 */
} pbf_diffuse_particle;

/* What is saved of them beside the particles. */
typedef struct pbf_diffuse_head {
  uint32_t count;
  uint32_t reserved; /* 0 */
  double time;       /* as of which they are */
  double due;        /* of the next that the fluid makes, the part that is there, 0 … 1 */
  uint64_t next_id;
  uint64_t generated, expired, recycled;
} pbf_diffuse_head;

/* The normal of a particle of the fluid, while generate.c works. */
typedef struct pbf_fluid_normal {
  float direction[3];
  uint32_t is_known; /* 1; its direction may be 0: it is at no surface */
} pbf_fluid_normal;

/* Their part in a step. */
typedef struct pbf_diffuse_work {
  /* Before steps: how many of them can be made until particles move next, and room for that. */
  pbf_status (*prepare)(pbf_solver *solver, uint32_t *steps);
  pbf_status (*advance)(pbf_solver *solver); /* after them */
} pbf_diffuse_work;

typedef struct pbf_diffuse {
  const pbf_diffuse_work *work; /* so that programs that link libpbf and have none leave it out */
  pbf_diffuse_desc desc;
  pbf_diffuse_head head;
  uint32_t first; /* the oldest particle's place: those after it follow, round the end */
  uint32_t normal_capacity;
  pbf_fluid_normal *normals;       /* of the fluid's particles; null: no room has been needed */
  pbf_diffuse_particle *particles; /* desc.capacity of them, ascending by id */
} pbf_diffuse;

/* The n-th, from the oldest on. */
static inline pbf_diffuse_particle *pbf_diffuse_at(const pbf_diffuse *d, uint32_t n) {
  const uint32_t place = d->first + n, capacity = d->desc.capacity;
  return &d->particles[place < capacity ? place : place - capacity];
}

/* When a life ends, which is left of it > 0 also where it is nothing beside the time. */
static inline double pbf_diffuse_end(double time, double life) {
  const double end = time + life;
  return end > time ? end : nextafter(time, INFINITY);
}

/* Room for a new, youngest one, with its id; the oldest makes way where there is none. */
pbf_diffuse_particle *pbf_diffuse_push(pbf_diffuse *d);

/* One without particles, of a checked desc; its work is to be set. */
pbf_status pbf_diffuse_allocate(const pbf_solver *solver, const pbf_diffuse_desc *desc,
                                pbf_diffuse **made);
uint64_t pbf_diffuse_bytes(const pbf_diffuse *diffuse);
void pbf_diffuse_free(const pbf_solver *solver, pbf_diffuse *diffuse);

/* Fails with a sentence unless they can be made by this. */
pbf_status pbf_diffuse_check(const pbf_diffuse_desc *desc, pbf_check_kind kind);

extern const pbf_diffuse_work pbf_diffuse_in_steps;

/* In a saved state: 0 bytes where there are none. */
uint64_t pbf_diffuse_saved_size(const pbf_solver *solver);
void pbf_diffuse_save(const pbf_solver *solver, void *buffer);
pbf_status pbf_diffuse_restore(const pbf_solver *solver, const void *buffer, uint64_t size,
                               pbf_diffuse **diffuse);

#endif
