/* Part of backend.cpp: particles in and out, by row: the order of adding. */
#ifndef PBF_CPU_PARTICLES_H
#define PBF_CPU_PARTICLES_H

#include "common/id_rows.h"
#include "cpu/worker.h"
#include "physics/passes/lambda.h"

static void append_vectors(const field *to, uint32_t first, const pbf_real *from, uint32_t count) {
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0; k < PBF_DIM; ++k) to->c[k][first + i] = from[(uint64_t)i * PBF_DIM + k];
}

static void append(solver *s, const pbf_particles *p) {
  const pbf_real *x = (const pbf_real *)p->positions, *v = (const pbf_real *)p->velocities;
  append_vectors(&s->buffers.x, s->count, x, p->count);
  if (v)
    append_vectors(&s->buffers.v, s->count, v, p->count);
  else
    for (int k = 0; k < PBF_DIM; ++k)
      memset(s->buffers.v.c[k] + s->count, 0, p->count * sizeof(pbf_real));
  memcpy(s->buffers.ids + s->count, p->ids, p->count * sizeof *p->ids);
  memset(s->lambda + s->count, 0, p->count * sizeof *s->lambda);
  if (s->last_pressure) memset(s->last_pressure + s->count, 0, p->count * sizeof(pbf_real));
  if (s->buffers.overlap) memset(s->buffers.overlap + s->count, 0, p->count * sizeof(pbf_real));
  for (int k = 0; k < PBF_DIM && s->buffers.acceleration.c[0]; ++k)
    memset(s->buffers.acceleration.c[k] + s->count, 0, p->count * sizeof(pbf_real));
  if (s->buffers.phase) memset(s->buffers.phase + s->count, (int)p->phase, p->count);
  s->count += p->count;
}

static void remove_by_id(solver *s, uint32_t count, const uint32_t *ids) {
  buffers *b = &s->buffers;
  uint32_t kept = 0, pending = 0;
  pbf_id_rows removed;
  pbf_id_rows_begin(&removed, ids, count);
  for (uint32_t i = 0; i < s->count; ++i) {
    if (i == s->grid_pressure_pending) pending = kept;
    if (pbf_id_row(&removed, b->ids[i]) < count) continue;
    if (kept == i) { /* before the first that is removed */
      ++kept;
      continue;
    }
    field_set(&b->x, kept, field_at(&b->x, i));
    field_set(&b->v, kept, field_at(&b->v, i));
    s->lambda[kept] = s->lambda[i];
    if (b->activity) {
      b->activity[kept] = b->activity[i];
      b->sleeping_lambda[kept] = b->sleeping_lambda[i];
    }
    if (s->last_pressure) s->last_pressure[kept] = s->last_pressure[i];
    if (b->overlap) b->overlap[kept] = b->overlap[i];
    if (b->acceleration.c[0]) field_set(&b->acceleration, kept, field_at(&b->acceleration, i));
    if (b->phase) b->phase[kept] = b->phase[i];
    b->ids[kept++] = b->ids[i];
  }
  s->grid_pressure_pending = s->grid_pressure_pending < s->count ? pending : kept;
  s->count = kept;
}

/* What is asked for, to be looked up for all particles. */
typedef struct wanted_rows {
  uint32_t first, count;
  pbf_id_rows all;
} wanted_rows;

static wanted_rows find_wanted(const pbf_rows *rows) {
  wanted_rows wanted;
  wanted.first = rows->first;
  wanted.count = rows->count;
  pbf_id_rows_begin(&wanted.all, rows->ids, rows->total);
  return wanted;
}

/* Row of a particle among those asked for, or wanted.count. */
static uint32_t wanted_row(const wanted_rows &wanted, uint32_t id) {
  uint32_t row = pbf_id_row(&wanted.all, id) - wanted.first;
  return row < wanted.count ? row : wanted.count;
}

static void read_vectors(const solver *s, const field *f, const pbf_rows *rows, pbf_real *out) {
  const wanted_rows wanted = find_wanted(rows);
  for (uint32_t i = 0; i < s->count; ++i) {
    uint64_t row = wanted_row(wanted, s->buffers.ids[i]);
    if (row == wanted.count) continue;
    for (uint32_t k = 0; k < PBF_DIM; ++k) out[row * PBF_DIM + k] = f->c[k][i];
  }
}

static void write_vectors(solver *s, const field *f, const pbf_rows *rows, const pbf_real *in) {
  const wanted_rows wanted = find_wanted(rows);
  for (uint32_t i = 0; i < s->count; ++i) {
    uint64_t row = wanted_row(wanted, s->buffers.ids[i]);
    if (row == wanted.count) continue;
    for (uint32_t k = 0; k < PBF_DIM; ++k) f->c[k][i] = in[row * PBF_DIM + k];
  }
}

/* Of those that may sleep: the activity and the lambda of each. */
static void read_rest(const solver *s, const pbf_rows *rows, pbf_real *out) {
  const wanted_rows wanted = find_wanted(rows);
  for (uint32_t i = 0; i < s->count && s->buffers.activity; ++i) {
    uint64_t row = wanted_row(wanted, s->buffers.ids[i]);
    if (row == wanted.count) continue;
    out[row * 2] = s->buffers.activity[i];
    out[row * 2 + 1] = s->buffers.sleeping_lambda[i];
  }
}

static void write_rest(solver *s, const pbf_rows *rows, const pbf_real *in) {
  const wanted_rows wanted = find_wanted(rows);
  s->asleep = s->wakes_ranks = 0;
  for (uint32_t i = 0; i < s->count && s->buffers.activity; ++i) {
    uint64_t row = wanted_row(wanted, s->buffers.ids[i]);
    if (row < wanted.count) {
      s->buffers.activity[i] = in[row * 2];
      s->buffers.sleeping_lambda[i] = s->lambda[i] = in[row * 2 + 1];
    }
    s->asleep += (uint32_t)pbf_is_asleep(s->buffers.activity[i]);
  }
}

static void read_reals(const solver *s, const pbf_real *of, const pbf_rows *rows, pbf_real *out) {
  const wanted_rows wanted = find_wanted(rows);
  for (uint32_t i = 0; i < s->count; ++i) {
    const uint32_t row = wanted_row(wanted, s->buffers.ids[i]);
    if (row < wanted.count) out[row] = of[i];
  }
}

static void write_reals(const solver *s, pbf_real *to, const pbf_rows *rows, const pbf_real *in) {
  const wanted_rows wanted = find_wanted(rows);
  for (uint32_t i = 0; i < s->count; ++i) {
    const uint32_t row = wanted_row(wanted, s->buffers.ids[i]);
    if (row < wanted.count) to[i] = in[row];
  }
}

static void write_phases(solver *s, const pbf_rows *rows, const uint8_t *in) {
  const wanted_rows wanted = find_wanted(rows);
  for (uint32_t i = 0; i < s->count; ++i) {
    const uint32_t row = wanted_row(wanted, s->buffers.ids[i]);
    if (row < wanted.count) s->buffers.phase[i] = in[row];
  }
}

/* After diagnose. */
static void read_densities(const solver *s, const pbf_rows *rows, pbf_real *out) {
  const wanted_rows wanted = find_wanted(rows);
  const range own = own_places(s);
  for (uint32_t k = own.first; k < own.last; ++k) {
    uint32_t row = wanted_row(wanted, s->buffers.sorted_ids[k]);
    if (row < wanted.count) out[row] = diagnosed_densities(s)[k];
  }
}

static void read_pressure_rows(const solver *s, const pbf_rows *rows, pbf_real *out) {
  const wanted_rows wanted = find_wanted(rows);
  const range own = own_places(s);
  for (uint32_t k = own.first; k < own.last; ++k) {
    uint32_t row = wanted_row(wanted, s->buffers.sorted_ids[k]);
    if (row < wanted.count)
      out[row] = pbf_pressure(s->pressure_scale, s->buffers.fitted_lambda()[k]);
  }
}

#endif
