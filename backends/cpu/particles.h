/* Part of backend.cpp: particles in and out, by row: the order of adding. */
#ifndef PBF_CPU_PARTICLES_H
#define PBF_CPU_PARTICLES_H

#include "common/rows.h"
#include "cpu/worker.h"
#include "physics/passes/lambda.h"

static void append(solver *s, const pbf_particles *p) {
  const pbf_real *x = (const pbf_real *)p->positions, *v = (const pbf_real *)p->velocities;
  for (int k = 0; k < PBF_DIM; ++k)
    for (uint32_t i = 0; i < p->count; ++i) {
      s->buffers.x.c[k][s->count + i] = x[(uint64_t)i * PBF_DIM + (uint32_t)k];
      s->buffers.v.c[k][s->count + i] = v ? v[(uint64_t)i * PBF_DIM + (uint32_t)k] : 0;
    }
  memcpy(s->buffers.ids + s->count, p->ids, p->count * sizeof *p->ids);
  memset(s->lambda + s->count, 0, p->count * sizeof *s->lambda);
  if (s->buffers.last_pressure)
    memset(s->buffers.last_pressure + s->count, 0, p->count * sizeof(pbf_real));
  if (s->buffers.overlap) memset(s->buffers.overlap + s->count, 0, p->count * sizeof(pbf_real));
  if (s->buffers.phase) memset(s->buffers.phase + s->count, (int)p->phase, p->count);
  s->count += p->count;
}

static void remove_by_id(solver *s, uint32_t count, const uint32_t *ids) {
  buffers *b = &s->buffers;
  uint32_t kept = 0;
  for (uint32_t i = 0; i < s->count; ++i) {
    if (pbf_find_id(ids, count, b->ids[i]) < count) continue;
    field_set(&b->x, kept, field_at(&b->x, i));
    field_set(&b->v, kept, field_at(&b->v, i));
    s->lambda[kept] = s->lambda[i];
    if (b->activity) b->activity[kept] = b->activity[i];
    if (b->last_pressure) b->last_pressure[kept] = b->last_pressure[i];
    if (b->overlap) b->overlap[kept] = b->overlap[i];
    if (b->phase) b->phase[kept] = b->phase[i];
    b->ids[kept++] = b->ids[i];
  }
  s->count = kept;
}

/* Row of particle i among those asked for, or rows->count. */
static uint32_t wanted_row(const pbf_rows *rows, uint32_t id) {
  uint32_t row = pbf_row_of(rows, id) - rows->first;
  return row < rows->count ? row : rows->count;
}

static void read_vectors(const solver *s, const field *f, const pbf_rows *rows, pbf_real *out) {
  for (uint32_t i = 0; i < s->count; ++i) {
    uint64_t row = wanted_row(rows, s->buffers.ids[i]);
    if (row == rows->count) continue;
    for (uint32_t k = 0; k < PBF_DIM; ++k) out[row * PBF_DIM + k] = f->c[k][i];
  }
}

static void write_vectors(solver *s, const field *f, const pbf_rows *rows, const pbf_real *in) {
  for (uint32_t i = 0; i < s->count; ++i) {
    uint64_t row = wanted_row(rows, s->buffers.ids[i]);
    if (row == rows->count) continue;
    for (uint32_t k = 0; k < PBF_DIM; ++k) f->c[k][i] = in[row * PBF_DIM + k];
  }
}

/* Of those that may sleep: the activity and the lambda of each. */
static void read_rest(const solver *s, const pbf_rows *rows, pbf_real *out) {
  for (uint32_t i = 0; i < s->count && s->buffers.activity; ++i) {
    uint64_t row = wanted_row(rows, s->buffers.ids[i]);
    if (row == rows->count) continue;
    out[row * 2] = s->buffers.activity[i];
    out[row * 2 + 1] = s->buffers.sleeping_lambda[i];
  }
}

static void write_rest(solver *s, const pbf_rows *rows, const pbf_real *in) {
  s->asleep = 0;
  for (uint32_t i = 0; i < s->count && s->buffers.activity; ++i) {
    uint64_t row = wanted_row(rows, s->buffers.ids[i]);
    if (row < rows->count) {
      s->buffers.activity[i] = in[row * 2];
      s->buffers.sleeping_lambda[i] = s->lambda[i] = in[row * 2 + 1];
    }
    s->asleep += (uint32_t)pbf_is_asleep(s->buffers.activity[i]);
  }
}

static void read_reals(const solver *s, const pbf_real *of, const pbf_rows *rows, pbf_real *out) {
  for (uint32_t i = 0; i < s->count; ++i) {
    const uint32_t row = wanted_row(rows, s->buffers.ids[i]);
    if (row < rows->count) out[row] = of[i];
  }
}

static void write_reals(const solver *s, pbf_real *to, const pbf_rows *rows, const pbf_real *in) {
  for (uint32_t i = 0; i < s->count; ++i) {
    const uint32_t row = wanted_row(rows, s->buffers.ids[i]);
    if (row < rows->count) to[i] = in[row];
  }
}

static void write_phases(solver *s, const pbf_rows *rows, const uint8_t *in) {
  for (uint32_t i = 0; i < s->count; ++i) {
    const uint32_t row = wanted_row(rows, s->buffers.ids[i]);
    if (row < rows->count) s->buffers.phase[i] = in[row];
  }
}

/* After diagnose. */
static void read_densities(const solver *s, const pbf_rows *rows, pbf_real *out) {
  const range own = own_places(s);
  for (uint32_t k = own.first; k < own.last; ++k) {
    uint32_t row = wanted_row(rows, s->buffers.sorted_ids[k]);
    if (row < rows->count) out[row] = diagnosed_densities(s)[k];
  }
}

static void read_pressure_rows(const solver *s, const pbf_rows *rows, pbf_real *out) {
  const range own = own_places(s);
  for (uint32_t k = own.first; k < own.last; ++k) {
    uint32_t row = wanted_row(rows, s->buffers.sorted_ids[k]);
    if (row < rows->count)
      out[row] = pbf_pressure(s->pressure_scale, s->buffers.fitted_lambda()[k]);
  }
}

#endif
