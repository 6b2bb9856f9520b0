/* Particles sorted by cells, for queries: built by the first query after a change, kept until the
 * next one. */
#ifndef PBF_LIB_QUERY_INDEX_H
#define PBF_LIB_QUERY_INDEX_H

#include "solver/solver.h"

/* So many cells lie within the radius: of two, fewer points beyond it are looked at than of one. */
enum { PBF_QUERY_REACH = 2, PBF_QUERY_LINES = 2 * PBF_QUERY_REACH + 1 };
enum { PBF_QUERY_RUNS = PBF_QUERY_LINES * PBF_QUERY_LINES };

/* A particle while it is sorted: the key of its cell, and its place in the backend's order. */
typedef struct pbf_query_key {
  uint64_t key;
  uint32_t element, id;
} pbf_query_key;

/* By cell and, within a cell, by id. Cells without particles are not stored. */
typedef struct pbf_query_index {
  uint64_t generation; /* of the particles that it is of: pbf_view.generation */
  uint32_t is_built, has_velocities, has_pressures;
  uint32_t dimension, precision;
  uint32_t count, capacity; /* particles that there are, and that the memory is for */
  double radius, spacing;
  double scale;              /* spacing^dimension times the norm of the kernel */
  double lower[3], upper[3]; /* of the particles' positions */
  double face[3],
      period[3]; /* of periodic axes, else 0: the lower face, and how far the other is */
  double cell;   /* width */
  uint32_t cells[3], bits[3]; /* along each axis, empty ones around all included */
  uint32_t shift, entries;    /* of the directory: entry e is of keys from e << shift on */
  uint64_t bytes;
  uint64_t *keys;                /* ascending */
  pbf_query_key *sorted, *spare; /* while particles are sorted; then velocities lie there */
  void *points;                  /* (count, dimension), of the precision, and so … */
  void *velocities;              /* … (count, dimension) */
  void *pressures;               /* … (count) */
  void *copy;           /* of a field, (count, dimension); null: fields are read in place */
  uint32_t *elements;   /* places in the backend's order */
  uint32_t *first;      /* the directory: the first particle of an entry's keys, or of later ones */
  pbf_query_key *order; /* of points that are asked for */
  uint32_t order_capacity;
} pbf_query_index;

/* Number `k` of an array of the index. */
static inline double pbf_query_number(const void *array, uint64_t k, uint32_t precision) {
  return precision == PBF_FLOAT32 ? (double)((const float *)array)[k] : ((const double *)array)[k];
}

/* What a query needs beside positions. */
enum { PBF_QUERY_VELOCITIES = 1, PBF_QUERY_PRESSURES = 2 };

/* The index of the present particles, with these fields. */
pbf_status pbf_query_index_get(pbf_solver *solver, uint32_t fields, const pbf_query_index **index);
/* Its memory for as many particles as there are: an index of them that is found needs no more. */
pbf_status pbf_query_index_reserve(pbf_solver *solver);

void pbf_query_index_free(pbf_solver *solver);

/* Of its order. */
uint64_t pbf_query_order_bytes(const pbf_query_index *index);

/* Particles begin … end - 1 of the index. */
typedef struct pbf_query_run {
  uint32_t begin, end;
} pbf_query_run;

/* All particles within the radius of points in one cell, and others. Points that follow each other
 * are often in the same cell: its runs are found once. */
typedef struct pbf_query_place {
  const pbf_query_index *index;
  uint32_t cell[3];
  uint32_t last[3];       /* of pbf_query_go_within: cells from `cell` to this one */
  uint32_t is_set, count; /* of runs */
  pbf_query_run runs[PBF_QUERY_RUNS];
} pbf_query_place;

/* Goes to the cell of a point; count is 0 where nothing is near. */
void pbf_query_go(pbf_query_place *place, const double *point);

/* The same with the cells that what is within `reach`, at most the radius, of the point lies in. A
 * place is used by one of the two alone. */
void pbf_query_go_within(pbf_query_place *place, const double *point, double reach);

/* Where a point, and images of it beyond periodic faces, can be near particles: `images` gets them,
 * the first the one inside the domain. Returns how many. */
enum { PBF_QUERY_IMAGES = 8 };
uint32_t pbf_query_images(const pbf_query_index *index, const double *point,
                          double images[PBF_QUERY_IMAGES][3]);

/* At most so many points are ordered at once. */
enum { PBF_QUERY_ORDERED = 8192 };

/* Numbers of `count` points, at most PBF_QUERY_ORDERED, ascending by cell: what is near them is
 * then in the cache more often. */
pbf_status pbf_query_order(pbf_solver *solver, uint32_t count, const double *points,
                           const pbf_query_key **order);

#endif
