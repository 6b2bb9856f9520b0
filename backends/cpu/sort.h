/* Sorts particles by cell and, within a cell, by id: an order that depends on nothing but where
 * particles are and which they are. A task of the work is a range of cells: the thread that sorts
 * it counts, and then places, the particles that belong there, wherever they are now. */
#ifndef PBF_CPU_SORT_H
#define PBF_CPU_SORT_H

#include "cpu/halo.h"
#include "cpu/sleepers.h"
#include "physics/passes/overlap.h"

static void find_bounds(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  range r = task_particles(w, task);
  box b;
  for (int k = 0; k < PBF_DIM; ++k)
    b.lower.c[k] = (pbf_real)INFINITY, b.upper.c[k] = (pbf_real)-INFINITY;
  w->s->kernels->bounds(*w->sort_positions, r.first, r.last, &b.lower, &b.upper);
  w->s->boxes[task] = b;
}

/* What all ranks' particles are in. */
static box box_of_ranks(solver *s, box around) {
  const rank_summary mine = {around, s->ranks.busy, s->count};
  rank_summary *summaries = static_cast<rank_summary *>(s->ranks.gathered);
  if (!gather_on_ranks(s, &mine, summaries, sizeof mine)) return around;
  for (uint32_t r = 0; r < s->ranks.count; ++r)
    for (int k = 0; k < PBF_DIM; ++k) {
      around.lower.c[k] = pbf_real_min(around.lower.c[k], summaries[r].around.lower.c[k]);
      around.upper.c[k] = pbf_real_max(around.upper.c[k], summaries[r].around.upper.c[k]);
    }
  balance(s, summaries);
  s->ranks.busy = 0;
  return around;
}

static void place_images(solver *s, const pbf_periods *periods) {
  for (uint32_t image = 0; image < IMAGES; ++image)
    for (uint32_t k = 0, left = image; k < PBF_DIM; ++k, left /= 3)
      s->images[image].c[k] = left % 3 == 1   ? periods->length.c[k]
                              : left % 3 == 2 ? -periods->length.c[k]
                                              : 0;
}

/* The grid's box is that of the particles, as far as it lies in the domain, wherever its walls have
 * moved to, enlarged by its own size: what flies out farther counts to the outermost cells. Along a
 * periodic axis it is the domain. */
static void make_grid(void *context) {
  worker *w = static_cast<worker *>(context);
  const pbf_domain *domain = &w->obstacles.domain;
  box all = w->s->boxes[0];
  for (uint32_t task = 1; task < particle_task_count(w); ++task)
    for (int k = 0; k < PBF_DIM; ++k) {
      all.lower.c[k] = pbf_real_min(all.lower.c[k], w->s->boxes[task].lower.c[k]);
      all.upper.c[k] = pbf_real_max(all.upper.c[k], w->s->boxes[task].upper.c[k]);
    }
  if (has_ranks(w->s)) all = box_of_ranks(w->s, all);
  w->s->around = {all.lower, all.upper};
  const pbf_periods periods = pbf_periods_of(&w->s->params);
  double size[PBF_DIM];
  int axis[PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k) {
    const bool periodic = periods.length.c[k] > 0;
    const pbf_vec lower = periodic ? periods.lower : domain->lower;
    const pbf_vec upper = periodic ? periods.upper : domain->upper;
    const double low = (double)lower.c[k], high = (double)upper.c[k];
    if (periodic) all.lower.c[k] = (pbf_real)low, all.upper.c[k] = (pbf_real)high;
    size[k] = high - low;
    all.lower.c[k] = pbf_real_max(all.lower.c[k], (pbf_real)(low - size[k]));
    all.upper.c[k] = pbf_real_min(all.upper.c[k], (pbf_real)(high + size[k]));
  }
  grid_axes(size, axis);
  w->s->grid = grid_around(axis, all.lower, all.upper, w->s->params.smoothing_radius,
                           cell_limit(particles_of_all(w->s)), &periods);
  place_images(w->s, &periods);
  for (int k = 0; k < 2 && w->s->packed[k]; ++k) w->s->packed[k][-4] = w->s->grid.far;
  if (!has_ranks(w->s)) w->s->cell_end[-1] = 0; /* the begin of cell 0 */
}

static uint32_t range_tasks(const worker *w) {
  return tasks_of(w, w->s->count, CHUNK, RANGE_PIECES);
}

/* Particles are nearly sorted from the step before, and so is this sample of them. */
static void take_sample(const worker *w, range particles) {
  solver *s = w->s;
  uint64_t samples = (uint64_t)range_tasks(w) * SAMPLES_A_RANGE;
  if (!s->count) return; /* on some rank */
  uint64_t k = (particles.first * samples + s->count - 1) / s->count, i;
  for (; k < samples && (i = s->count * k / samples) < particles.last; ++k)
    s->sample[k] = s->cells[i];
}

static void find_cells(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range r = task_chunks(w, task);
  const field x = grid_field(s->grid.axis, *w->sort_positions);
  for (uint32_t chunk = r.first; chunk < r.last; ++chunk) {
    uint32_t first = chunk * CHUNK, last = s->count - first < CHUNK ? s->count : first + CHUNK;
    s->kernels->cells(&s->grid, x, first, last, s->cells, &s->chunk_low[chunk],
                      &s->chunk_high[chunk]);
  }
  take_sample(w, task_particles(w, task));
}

/* The cells of the particles that are held here: without ranks all. */
static range held_cells(const solver *s) {
  if (!has_ranks(s)) return (range){0, s->grid.total};
  const rank_share *share = &s->ranks.shares[s->ranks.rank];
  return (range){share->cell_first, share->cell_last};
}

/* Ranges of cells such that all have about as many particles: quantiles of the sample. */
static void divide_cells(void *context) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  uint32_t ranges = range_tasks(w), *sample = s->sample;
  for (uint32_t k = 1; k < ranges * SAMPLES_A_RANGE; ++k) {
    uint32_t cell = sample[k], at = k;
    for (; at > 0 && sample[at - 1] > cell; --at) sample[at] = sample[at - 1];
    sample[at] = cell;
  }
  for (uint32_t k = 1; k < ranges; ++k) s->first_cell[k] = sample[k * SAMPLES_A_RANGE];
  const range cells = held_cells(s);
  s->first_cell[0] = cells.first;
  s->first_cell[ranges] = cells.last;
}

static range task_cells(const worker *w, uint32_t task) {
  return (range){w->s->first_cell[task], w->s->first_cell[task + 1]};
}

/* Calls visit for each particle with a cell in the range, in the present order. */
#define FOR_PARTICLES_IN(s, range, i)                                                    \
  for (uint64_t chunk = 0, chunks = chunks_of((s)->count); chunk < chunks; ++chunk)      \
    if ((s)->chunk_low[chunk] < (range).last && (s)->chunk_high[chunk] >= (range).first) \
      for (uint32_t i = (uint32_t)chunk * CHUNK,                                         \
                    end = (s)->count - i < CHUNK ? (s)->count : i + CHUNK;               \
           i < end; ++i)                                                                 \
        if ((s)->cells[i] - (range).first < (range).last - (range).first)

static void count_cells(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range cells = task_cells(w, task);
  uint32_t *counts = s->cell_end, total = 0;
  memset(counts + cells.first, 0, (cells.last - cells.first) * sizeof *counts);
  FOR_PARTICLES_IN(s, cells, i) {
    ++counts[s->cells[i]];
    ++total;
  }
  s->first_place[task] = total;
}

/* Turns numbers of particles into where they begin. */
static void divide_places(void *context) {
  worker *w = static_cast<worker *>(context);
  uint32_t next = w->s->ranks.pad;
  for (uint32_t task = 0; task < range_tasks(w); ++task) {
    uint32_t count = w->s->first_place[task];
    w->s->first_place[task] = next;
    next += count;
  }
  w->s->first_place[range_tasks(w)] = next;
}

/* Turns counts into ends: afterwards placing a particle moves its cell's entry from the cell's
 * begin to its end. */
static void place_particles(solver *s, range cells, range places, const uint32_t *ids,
                            uint32_t *sorted_ids) {
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

static void gather_reals(const uint32_t *order, range places, const pbf_real *source,
                         pbf_real *sink) {
  for (uint32_t i = places.first; i < places.last; ++i) sink[i] = source[order[i]];
}

static void gather(const uint32_t *order, range places, const field *from, const field *to) {
  for (int k = 0; k < PBF_DIM; ++k) gather_reals(order, places, from->c[k], to->c[k]);
}

/* And what they make of particles. */
static void gather_phases(const worker *w, range places) {
  const solver *s = w->s;
  for (uint32_t i = places.first; i < places.last; ++i) {
    w->b.sorted_phase[i] = w->sort_phase[s->order[i]];
    s->mobility[i] = w->constants.phases.mobility[w->b.sorted_phase[i]];
  }
}

static void sort_range(void *context, uint32_t task) {
  worker *w = static_cast<worker *>(context);
  solver *s = w->s;
  range places = {s->first_place[task], s->first_place[task + 1]};
  place_particles(s, task_cells(w, task), places, w->sort_ids, w->b.sorted_ids);
  order_by_id(s, places, w->b.sorted_ids);
  gather(s->order, places, w->sort_positions, w->sorted_positions);
  if (w->sort_payload) gather(s->order, places, w->sort_payload, w->sorted_payload);
  if (w->sort_push) gather(s->order, places, w->sort_push, &s->push);
  if (w->sort_acceleration && w->sort_payload)
    gather(s->order, places, w->sort_acceleration, &w->b.sorted_acceleration);
  if (w->b.phase) gather_phases(w, places);
  fill_packed(s, packed_positions(s), w->sorted_positions, s->mobility, places);
  if (sleep_is_on(w)) {
    gather_reals(s->order, places, w->activity, w->b.sorted_activity);
    gather_reals(s->order, places, w->sleeping_lambda, w->b.sorted_sleeping_lambda);
  }
  if (w->sort_overlap && w->sort_payload)
    for (uint32_t i = places.first; i < places.last; ++i)
      w->b.sorted_overlap[i] =
          pbf_overlap_left(w->constants.overlap_decay, w->sort_overlap[s->order[i]]);
  mark_sleepers(w, places);
}

/* Takes what this rank is to hold, with its ids and these arrays, which from then on are those that
 * are sorted. */
static bool hold_to_sort(worker *w, const field *x, const field *to, const field *payload,
                         const field *payload_to) {
  solver *s = w->s;
  carried what[MAX_CARRIED];
  int arrays = 0;
  for (int k = 0; k < PBF_DIM; ++k) what[arrays++] = {x->c[k], to->c[k], sizeof(pbf_real)};
  for (int k = 0; k < PBF_DIM && payload; ++k)
    what[arrays++] = {payload->c[k], payload_to->c[k], sizeof(pbf_real)};
  for (int k = 0; k < PBF_DIM && w->sort_push; ++k)
    what[arrays++] = {w->sort_push->c[k], s->held_push.c[k], sizeof(pbf_real)};
  for (int k = 0; k < PBF_DIM && has_accelerations(w); ++k)
    what[arrays++] = {w->b.acceleration.c[k], s->held_acceleration.c[k], sizeof(pbf_real)};
  if (s->last_pressure)
    what[arrays++] = {s->last_pressure, s->held_last_pressure, sizeof(pbf_real)};
  if (w->b.overlap) what[arrays++] = {w->b.overlap, s->held_overlap, sizeof(pbf_real)};
  if (sleep_is_on(w)) {
    what[arrays++] = {w->activity, s->held_activity, sizeof(pbf_real)};
    what[arrays++] = {w->sleeping_lambda, s->held_sleeping_lambda, sizeof(pbf_real)};
  }
  what[arrays++] = {w->b.ids, s->ranks.ids, sizeof(uint32_t)};
  if (w->b.phase) what[arrays++] = {w->b.phase, s->held_phase, sizeof(uint8_t)};
  if (!hold_share(s, what, arrays)) return false;
  w->sort_positions = to;
  w->sort_payload = payload ? payload_to : NULL;
  w->sort_ids = s->ranks.ids;
  if (w->b.overlap) w->sort_overlap = s->held_overlap;
  if (sleep_is_on(w)) w->activity = s->held_activity, w->sleeping_lambda = s->held_sleeping_lambda;
  if (has_accelerations(w)) w->sort_acceleration = &s->held_acceleration;
  if (w->b.phase) w->sort_phase = s->held_phase;
  if (w->sort_push) w->sort_push = &s->held_push;
  parallel_for(w->self, particle_task_count(w), find_cells, NULL, w);
  /* No sorted place is awakened yet. */
  memset(s->cells + s->count, 0, s->ranks.pad * sizeof *s->cells);
  return true;
}

/* Sorts by the positions that the grid has been made around. False where ranks have failed. */
static bool sort_particles(worker *w, const field *to, const field *payload_to) {
  parallel_for(w->self, particle_task_count(w), find_cells, has_ranks(w->s) ? NULL : divide_cells,
               w);
  if (has_ranks(w->s)) {
    if (!hold_to_sort(w, w->sort_positions, to, w->sort_payload, payload_to)) return false;
    divide_cells(w);
  }
  parallel_for(w->self, range_tasks(w), count_cells, divide_places, w);
  parallel_for(w->self, range_tasks(w), sort_range, NULL, w);
  return true;
}

#endif
