/* Sorts particles by cell and, within a cell, by id: an order that depends on nothing but where
 * particles are and who they are. Each thread sorts a range of cells of its own: it counts, and
 * then places, the particles that belong there, wherever they are now. */
#ifndef PBF_CPU_SORT_H
#define PBF_CPU_SORT_H

#include "cpu/worker.h"

static void find_bounds(worker *w, field x) {
  range r = my_particles(w);
  share *mine = &w->s->shares[w->thread];
  for (int k = 0; k < PBF_DIM; ++k)
    mine->lower.c[k] = (pbf_real)INFINITY, mine->upper.c[k] = (pbf_real)-INFINITY;
  w->s->kernels->bounds(x, r.first, r.last, &mine->lower, &mine->upper);
}

/* The grid's box is that of the particles, as far as it lies in the domain enlarged by its own
 * size: what flies out farther counts to the outermost cells. */
static void make_grid(worker *w) {
  const pbf_params *p = &w->s->params;
  pbf_vec lower = w->s->shares[0].lower, upper = w->s->shares[0].upper;
  for (uint32_t t = 1; t < w->threads; ++t)
    for (int k = 0; k < PBF_DIM; ++k) {
      lower.c[k] = pbf_real_min(lower.c[k], w->s->shares[t].lower.c[k]);
      upper.c[k] = pbf_real_max(upper.c[k], w->s->shares[t].upper.c[k]);
    }
  for (int k = 0; k < PBF_DIM; ++k) {
    double size = p->domain_max[k] - p->domain_min[k];
    lower.c[k] = pbf_real_max(lower.c[k], (pbf_real)(p->domain_min[k] - size));
    upper.c[k] = pbf_real_min(upper.c[k], (pbf_real)(p->domain_max[k] + size));
  }
  w->grid = grid_around(lower, upper, p->smoothing_radius, cell_limit(w->s->capacity));
}

static void find_cells(worker *w, field x) {
  solver *s = w->s;
  range r = my_chunks(w);
  for (uint32_t chunk = r.first; chunk < r.last; ++chunk) {
    uint32_t first = chunk * CHUNK, last = s->count - first < CHUNK ? s->count : first + CHUNK;
    s->kernels->cells(&w->grid, x, first, last, s->cells, &s->chunk_low[chunk],
                      &s->chunk_high[chunk]);
  }
}

/* The cells that this thread sorts, chosen so that all have about as many particles: quantiles of
 * a sample. Particles are nearly sorted from the step before, and so is the sample. */
static range my_cells(const worker *w) {
  enum { MOST = 2048 };
  uint32_t sample[MOST], each = w->threads <= MOST / 16 ? 16 : MOST / w->threads;
  uint32_t samples = each * w->threads;
  if (w->threads == 1) return (range){0, w->grid.total};
  for (uint32_t k = 0; k < samples; ++k) {
    uint32_t cell = w->s->cells[(uint64_t)w->s->count * k / samples], at = k;
    for (; at > 0 && sample[at - 1] > cell; --at) sample[at] = sample[at - 1];
    sample[at] = cell;
  }
  return (range){w->thread == 0 ? 0 : sample[w->thread * each],
                 w->thread == w->threads - 1 ? w->grid.total : sample[(w->thread + 1) * each]};
}

/* Calls visit for each particle, in the present order, whose cell is in the range. */
#define FOR_PARTICLES_IN(s, range, i)                                                    \
  for (uint64_t chunk = 0, chunks = chunks_of((s)->count); chunk < chunks; ++chunk)      \
    if ((s)->chunk_low[chunk] < (range).last && (s)->chunk_high[chunk] >= (range).first) \
      for (uint32_t i = (uint32_t)chunk * CHUNK,                                         \
                    end = (s)->count - i < CHUNK ? (s)->count : i + CHUNK;               \
           i < end; ++i)                                                                 \
        if ((s)->cells[i] - (range).first < (range).last - (range).first)

static void count_cells(worker *w, range cells) {
  solver *s = w->s;
  uint32_t *counts = s->cell_end;
  uint64_t total = 0;
  memset(counts + cells.first, 0, (cells.last - cells.first) * sizeof *counts);
  FOR_PARTICLES_IN(s, cells, i) {
    ++counts[s->cells[i]];
    ++total;
  }
  s->shares[w->thread].particles = total;
}

/* Where the thread's particles begin among the sorted ones. */
static range my_places(const worker *w) {
  range r = {0, 0};
  for (uint32_t t = 0; t < w->thread; ++t) r.first += (uint32_t)w->s->shares[t].particles;
  r.last = r.first + (uint32_t)w->s->shares[w->thread].particles;
  return r;
}

/* Turns counts into ends: afterwards placing a particle moves its cell's entry from the cell's
 * begin to its end. */
static void place_particles(worker *w, range cells, range places, const uint32_t *ids,
                            uint32_t *sorted_ids) {
  solver *s = w->s;
  uint32_t next = places.first;
  for (uint32_t c = cells.first; c < cells.last; ++c) {
    uint32_t count = s->cell_end[c];
    s->cell_end[c] = next;
    next += count;
  }
  FOR_PARTICLES_IN(s, cells, i) {
    uint32_t place = s->cell_end[s->cells[i]]++;
    s->order[place] = i;
    s->sorted_cells[place] = s->cells[i];
    sorted_ids[place] = ids[i];
  }
}

/* Placing kept the order within each cell, nearly that of the ids: insertion. */
static void order_by_id(solver *s, range places, uint32_t *ids) {
  for (uint32_t k = places.first + 1; k < places.last; ++k) {
    uint32_t id = ids[k], cell = s->sorted_cells[k], from = s->order[k], at = k;
    if (ids[k - 1] <= id || s->sorted_cells[k - 1] != cell) continue;
    for (; at > places.first && s->sorted_cells[at - 1] == cell && ids[at - 1] > id; --at) {
      ids[at] = ids[at - 1];
      s->order[at] = s->order[at - 1];
    }
    ids[at] = id;
    s->order[at] = from;
  }
}

static void gather(const uint32_t *order, range places, const field *from, const field *to) {
  for (int k = 0; k < PBF_DIM; ++k) {
    const pbf_real *source = from->c[k];
    pbf_real *sink = to->c[k];
    for (uint32_t i = places.first; i < places.last; ++i) sink[i] = source[order[i]];
  }
}

/* Sorts by the positions `key` into `sorted_key`, and `other`, unless null, along with them. */
static void sort_particles(worker *w, const field *key, const field *sorted_key, const field *other,
                           const field *sorted_other) {
  find_bounds(w, *key);
  team_barrier(w->me);
  make_grid(w);
  find_cells(w, *key);
  team_barrier(w->me);
  range cells = my_cells(w);
  count_cells(w, cells);
  team_barrier(w->me);
  range places = my_places(w);
  place_particles(w, cells, places, w->b.ids, w->b.spare_ids);
  order_by_id(w->s, places, w->b.spare_ids);
  gather(w->s->order, places, key, sorted_key);
  if (other) gather(w->s->order, places, other, sorted_other);
  team_barrier(w->me);
}

#endif
