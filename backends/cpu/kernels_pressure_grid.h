/* Part of kernels.cpp: loops of the pressure grid (physics/pressure_grid/grid.h): over particles,
 * and over nodes along the first axis. They are left to the compiler's vectoriser. */
#ifndef PBF_CPU_KERNELS_PRESSURE_GRID_H
#define PBF_CPU_KERNELS_PRESSURE_GRID_H

#include "cpu/clear_lanes.h"
#include "cpu/kernels_collide.h"

/* Particles of which the cells are found before anything else is done with them. */
enum { PRESSURE_GRID_CHUNK = 64 };

typedef struct pressure_grid_places {
  uint32_t cells[PRESSURE_GRID_CHUNK];
  double at[PBF_DIM][PRESSURE_GRID_CHUNK]; /* in the cell */
} pressure_grid_places;

/* Of the particles from `first` on. */
PBF_FN void find_places(const pbf_pressure_grid *c, const field *x, uint32_t first, uint32_t count,
                        pressure_grid_places *places) {
  memset(places->cells, 0, sizeof places->cells);
  for (int k = PBF_DIM - 1; k >= 0; --k) {
    const pbf_real *from = x->c[k] + first;
    double *at = places->at[k];
    for (uint32_t l = 0; l < count; ++l) at[l] = pbf_pressure_grid_before(c, k, from[l]);
    for (uint32_t l = 0; l < count; ++l) {
      uint32_t along = pbf_pressure_grid_index(c, k, at[l], &at[l]);
      places->cells[l] = places->cells[l] * c->size[k] + along;
    }
  }
}

/* Of particle first + l. */
PBF_FN void find_compartment(const pbf_pressure_grid_storage *storage, const field *x,
                             uint32_t first, uint32_t l, pressure_grid_places *places) {
  const pbf_pressure_grid_topology *t = &storage->topology;
  if (!pbf_cell_is_cut(t, places->cells[l])) return;
  double at[PBF_DIM]; /* stays as it is where there is no compartment */
  for (int k = 0; k < PBF_DIM; ++k) at[k] = places->at[k][l];
  places->cells[l] =
      pbf_compartment_of(&storage->grid, t, places->cells[l], field_at(x, first + l), at);
  for (int k = 0; k < PBF_DIM; ++k) places->at[k][l] = at[k];
}

/* What of them are between thin solids is in compartments. */
static __attribute__((noinline)) void find_compartments(const pbf_pressure_grid_storage *storage,
                                                        const field *x, uint32_t first,
                                                        uint32_t count,
                                                        pressure_grid_places *places) {
  for (uint32_t l = 0; l < count; ++l) find_compartment(storage, x, first, l, places);
}

/* Keeps the cells of particles and compartments, for as long as they stay where they are. */
PBF_FN void keep_cells(const uint32_t *cells, uint32_t count, pbf_real *kept) {
  for (uint32_t l = 0; l < count; ++l) memcpy(&kept[l], &cells[l], sizeof cells[l]);
}

/* Those that have been kept. */
static __attribute__((noinline)) void fetch_compartments(const pbf_pressure_grid_storage *storage,
                                                         const pbf_real *kept, const field *x,
                                                         uint32_t first, uint32_t count,
                                                         pressure_grid_places *places) {
  const pbf_pressure_grid_topology *t = &storage->topology;
  for (uint32_t l = 0; l < count; ++l) {
    double at[PBF_DIM];
    if (!pbf_cell_is_cut(t, places->cells[l])) continue;
    memcpy(&places->cells[l], &kept[first + l], sizeof places->cells[l]);
    if (places->cells[l] == PBF_NO_INDEX) continue;
    pbf_place_in_compartment(&storage->grid, t, places->cells[l], field_at(x, first + l), at);
    for (int k = 0; k < PBF_DIM; ++k) places->at[k][l] = at[k];
  }
}

PBF_FN uint32_t pressure_grid_chunk(uint32_t first, uint32_t last) {
  return last - first < PRESSURE_GRID_CHUNK ? last - first : (uint32_t)PRESSURE_GRID_CHUNK;
}

/* Sorted particles come cell by cell: others are told of a cell once. */
PBF_FN void add_entries(const pbf_pressure_grid_storage *storage, const uint32_t *cells,
                        const int64_t *entries, const int64_t *within, uint32_t count) {
  for (uint32_t l = 0; l < count;) {
    uint32_t cell = cells[l];
    int64_t sum = 0, places = 0;
    for (; l < count && cells[l] == cell; ++l) {
      sum += entries[l];
      places += within[l];
    }
    if (cell == PBF_NO_INDEX) continue;
    __atomic_fetch_add(&storage->sums[cell], sum, __ATOMIC_RELAXED);
    __atomic_fetch_add(&storage->places[cell], places, __ATOMIC_RELAXED);
  }
}

/* Leaves the cells of particles in place of their densities. */
static void deposit(const pbf_pressure_grid_storage *storage, pbf_real target, field x,
                    pbf_real *densities, const pbf_real *overlaps, uint32_t first, uint32_t last) {
  const pbf_pressure_grid c = storage->grid;
  for (uint32_t count; first < last; first += count) {
    pressure_grid_places places;
    int64_t entries[PRESSURE_GRID_CHUNK], within[PRESSURE_GRID_CHUNK];
    count = pressure_grid_chunk(first, last);
    find_places(&c, &x, first, count, &places);
    if (storage->topology.surface_count) find_compartments(storage, &x, first, count, &places);
    for (uint32_t l = 0; l < count; ++l)
      entries[l] =
          pbf_pressure_grid_entry(target, densities[first + l], overlaps ? overlaps[first + l] : 0);
    for (uint32_t l = 0; l < count; ++l) {
      double at[PBF_DIM];
      for (int k = 0; k < PBF_DIM; ++k) at[k] = places.at[k][l];
      within[l] = pbf_pressure_grid_place_entry(at);
    }
    add_entries(storage, places.cells, entries, within, count);
    if (!BUILT_FOR_SIZE && storage->topology.surface_count)
      keep_cells(places.cells, count, densities + first);
  }
}

/* `acceleration` without arrays: particles have none. */
static void deposit_moves(const pbf_pressure_grid_storage *storage, field x, field v,
                          field acceleration, uint32_t first, uint32_t last) {
  const pbf_pressure_grid c = storage->grid;
  for (uint32_t count; first < last; first += count) {
    pressure_grid_places places;
    count = pressure_grid_chunk(first, last);
    find_places(&c, &x, first, count, &places);
    if (storage->topology.surface_count) find_compartments(storage, &x, first, count, &places);
    for (uint32_t l = 0; l < count;) {
      const uint32_t cell = places.cells[l];
      int64_t moves[PBF_DIM] = {0};
      for (; l < count && places.cells[l] == cell; ++l)
        for (int k = 0; k < PBF_DIM; ++k)
          moves[k] += pbf_cell_move_entry(&c, v.c[k][first + l],
                                          acceleration.c[k] ? acceleration.c[k][first + l] : 0);
      if (cell == PBF_NO_INDEX) continue;
      int64_t *sums = storage->cell_moves + (uint64_t)PBF_DIM * cell;
      for (int k = 0; k < PBF_DIM; ++k) __atomic_fetch_add(&sums[k], moves[k], __ATOMIC_RELAXED);
    }
  }
}

/* Lambda at the corners of the particles' cells. */
typedef struct pressure_grid_corners {
  double lambda[PBF_CORNERS][PRESSURE_GRID_CHUNK];
} pressure_grid_corners;

PBF_FN void fetch_corners(const pbf_pressure_grid_storage *storage, const uint32_t *cells,
                          uint32_t count, pressure_grid_corners *corners) {
  for (uint32_t l = 0; l < count; ++l) {
    double values[PBF_CORNERS] = {0};
    if (cells[l] != PBF_NO_INDEX)
      pbf_pressure_grid_corners(&storage->grid, &storage->topology, storage->lambda, cells[l],
                                values);
    for (int a = 0; a < PBF_CORNERS; ++a) corners->lambda[a][l] = values[a];
  }
}

/* What is left of a move from x. */
static __attribute__((noinline)) pbf_vec move_past_obstacles(const pbf_obstacles *o, pbf_vec x,
                                                             pbf_vec move) {
  if (!BUILT_FOR_SIZE) {
    const pbf_vec kept = pbf_keep_in_domain(&o->domain, pbf_add_scaled(x, 1, move));
    if (is_clear_way(o, x, kept)) return pbf_sub(kept, x);
  }
  if (!o->grid) return pbf_move_past_obstacles(*o, x, move);
  pbf_obstacles candidates;
  const group_bounds alone = bounds_of_way(x, pbf_add_scaled(x, 1, move));
  collision_candidates(o, &alone, 0, &candidates);
  return pbf_move_past_obstacles(candidates, x, move);
}

typedef struct pressure_grid_moves {
  pbf_real along[PBF_DIM][PRESSURE_GRID_CHUNK];
} pressure_grid_moves;

/* What is asked of one particle after another is no part of this loop, so that the compiler makes
 * vectors of it. */
static __attribute__((noinline)) void find_moves(const pbf_pressure_grid *of,
                                                 const pressure_grid_corners *corners,
                                                 const pressure_grid_places *places, uint32_t count,
                                                 pressure_grid_moves *restrict moves) {
  const pbf_pressure_grid c = *of;
  for (uint32_t l = 0; l < count; ++l) {
    double values[PBF_CORNERS], place[PBF_DIM];
    for (int a = 0; a < PBF_CORNERS; ++a) values[a] = corners->lambda[a][l];
    for (int k = 0; k < PBF_DIM; ++k) place[k] = places->at[k][l];
    const pbf_vec u = pbf_pressure_grid_correction_from(&c, values, place);
    for (int k = 0; k < PBF_DIM; ++k) moves->along[k][l] = u.c[k];
  }
}

/* What is left of the moves of a group's particles from x. */
static __attribute__((noinline)) void keep_group(const pbf_obstacles *obstacles,
                                                 const lane_values *x, uint32_t lanes,
                                                 lane_values *moves) {
  lane_values ends, kept;
  lane_marks clear;
  for (int k = 0; k < PBF_DIM; ++k)
    for (uint32_t l = 0; l < WIDTH; ++l) ends.c[k][l] = x->c[k][l] + moves->c[k][l];
  kept = ends;
  clamp_group(obstacles, &kept);
  const bool known = find_clear_lanes(obstacles, 0, x, &ends, &kept, &clear);
  for (uint32_t l = 0; l < lanes; ++l) {
    const pbf_vec from = lane_value(x, l);
    set_lane(moves, l,
             known && clear.is[l] > 0 ? pbf_sub(lane_value(&kept, l), from)
                                      : move_past_obstacles(obstacles, from, lane_value(moves, l)));
  }
}

/* … of all. */
PBF_FN void keep_moves(const pbf_obstacles *obstacles, const field *x, uint32_t first,
                       uint32_t count, pressure_grid_moves *moves) {
  for (uint32_t l = 0; l < count && BUILT_FOR_SIZE; ++l) {
    pbf_vec u;
    for (int k = 0; k < PBF_DIM; ++k) u.c[k] = moves->along[k][l];
    u = move_past_obstacles(obstacles, field_at(x, first + l), u);
    for (int k = 0; k < PBF_DIM; ++k) moves->along[k][l] = u.c[k];
  }
  for (uint32_t begin = 0; begin < count && !BUILT_FOR_SIZE; begin += WIDTH) {
    const uint32_t left = count - begin, lanes = left < WIDTH ? left : (uint32_t)WIDTH;
    const lane_values from = load_some_lanes(x, first + begin, lanes);
    lane_values of;
    memset(&of, 0, sizeof of);
    for (int k = 0; k < PBF_DIM; ++k)
      memcpy(of.c[k], moves->along[k] + begin, lanes * sizeof(pbf_real));
    keep_group(obstacles, &from, lanes, &of);
    for (int k = 0; k < PBF_DIM; ++k)
      memcpy(moves->along[k] + begin, of.c[k], lanes * sizeof(pbf_real));
  }
}

/* Past these obstacles, unless null; by mobilities where phases differ. */
static void apply_correction(const pbf_pressure_grid_storage *storage,
                             const pbf_obstacles *obstacles, const pbf_real *mobility,
                             const pbf_real *cells, pbf_real inv_time_step, field x, field v,
                             uint32_t first, uint32_t last) {
  const pbf_pressure_grid c = storage->grid;
  const pbf_real carried = (pbf_real)storage->carried;
  for (uint32_t count; first < last; first += count) {
    pressure_grid_places places;
    pressure_grid_corners corners;
    pressure_grid_moves moves;
    count = pressure_grid_chunk(first, last);
    find_places(&c, &x, first, count, &places);
    if (BUILT_FOR_SIZE && storage->topology.surface_count)
      find_compartments(storage, &x, first, count, &places);
    else if (storage->topology.surface_count)
      fetch_compartments(storage, cells, &x, first, count, &places);
    fetch_corners(storage, places.cells, count, &corners);
    find_moves(&c, &corners, &places, count, &moves);
    for (int k = 0; k < PBF_DIM && mobility; ++k)
      for (uint32_t l = 0; l < count; ++l) moves.along[k][l] *= carried * mobility[first + l];
    if (obstacles) keep_moves(obstacles, &x, first, count, &moves);
    for (int k = 0; k < PBF_DIM; ++k) {
      pbf_real *to = x.c[k] + first, *velocity = v.c[k] + first;
      for (uint32_t l = 0; l < count; ++l) to[l] += moves.along[k][l];
      for (uint32_t l = 0; l < count; ++l) velocity[l] += inv_time_step * moves.along[k][l];
    }
  }
}

/* Of the nodes from (i[0], i[1], i[2]) along the first axis up to `last`; `row` is the index of
 * (0, i[1], i[2]). */
static __attribute__((noinline)) void write_equations(
    const pbf_pressure_grid_storage *storage, const pbf_pressure_grid_source_scale *source_scale,
    const int i[PBF_DIM], int last, uint32_t row, double *restrict right,
    double *restrict inverse) {
  const pbf_pressure_grid c = storage->grid;
  const pbf_pressure_grid_source_scale d = *source_scale;
  const double *free_volumes = storage->free_volumes, *depths = storage->depths;
  const int64_t *sums = storage->sums, *cell_places = storage->places;
  for (int x = i[0]; x <= last; ++x) {
    int node[PBF_DIM];
    for (int k = 0; k < PBF_DIM; ++k) node[k] = k ? i[k] : x;
    pbf_pressure_grid_equation_at(&c, &d, sums, cell_places, free_volumes, depths[row + x],
                                  (int64_t)row + x, node, &right[x], &inverse[x]);
  }
}

static void equations(const pbf_pressure_grid_storage *storage,
                      const pbf_pressure_grid_source_scale *source_scale, const int i[PBF_DIM],
                      int last, uint32_t row) {
  write_equations(storage, source_scale, i, last, row, storage->right + row,
                  storage->inverse + row);
}

/* 1 when a node was missing more than enough. */
static __attribute__((noinline)) int relax_run(const pbf_pressure_grid_storage *storage,
                                               const pbf_pressure_grid_solve *solve, uint32_t first,
                                               uint32_t count, double *restrict before) {
  const pbf_pressure_grid c = storage->grid;
  const pbf_pressure_grid_solve s = *solve;
  const double *free_volumes = storage->free_volumes + first, *now = storage->lambda + first;
  const double *right = storage->right + first, *inverse = storage->inverse + first;
  int64_t lacking = 0;
  for (uint32_t k = 0; k < count; ++k) {
    double around[PBF_CORNERS];
    pbf_pressure_grid_around(&c, free_volumes, k, around);
    double surface = pbf_pressure_grid_surface_of(around, inverse[k]);
    double residual = pbf_pressure_grid_residual(&c, around, now, right[k], surface, k);
    double miss = inverse[k] > 0 ? pbf_pressure_grid_miss(residual, now[k]) : 0;
    lacking |= miss > s.enough ? 1 : 0;
    before[k] = pbf_pressure_grid_next(&s, residual, inverse[k], now[k], before[k]);
  }
  return lacking != 0;
}

/* An iteration for the nodes of a run, a multiple of PRESSURE_GRID_LANES: 1 when one of them was
 * missing more than enough before it. What is in the open stays 0. */
static int relax(const pbf_pressure_grid_storage *storage, const pbf_pressure_grid_solve *solve,
                 uint32_t first, uint32_t last) {
  uint32_t count = (last - first) / PRESSURE_GRID_LANES * PRESSURE_GRID_LANES;
  return relax_run(storage, solve, first, count, storage->before + first);
}

#endif
