/* Part of worker.h in builds with PBF_TRACE_STAGES: writes what each stage leaves of each particle
 * to the file that PBF_TRACE_FILE in the environment names, in steps PBF_TRACE_FIRST to
 * PBF_TRACE_LAST of the process, 1 being the first. tools/parting.py compares two such files. One
 * solver, one thread.
 *
 * A record: "stage   ", the step and the array's bits as 64-bit integers, names of stage and array
 * in 24 bytes each, the count, the ids of particles as 32-bit integers, and their values. */
#ifndef PBF_CPU_TRACE_H
#define PBF_CPU_TRACE_H

#include <stdio.h>
#include <stdlib.h>

typedef struct trace {
  FILE *file;
  uint64_t step, first, last;
} trace;
static trace running_trace;

static uint64_t trace_limit(const char *name, uint64_t otherwise) {
  const char *value = pbf_environment(name);
  return value ? strtoull(value, NULL, 10) : otherwise;
}

static void trace_begin(trace *t) {
  const char *path = pbf_environment("PBF_TRACE_FILE");
  if (path) t->file = fopen(path, "wb");
  t->first = trace_limit("PBF_TRACE_FIRST", 1);
  t->last = trace_limit("PBF_TRACE_LAST", UINT64_MAX);
}

static const char *traced_stage_name(pbf_stage stage) {
  static const char *const names[] = {
#define PBF_STAGE(id, name, feature, times, launches) name,
#include "physics/stages.def"
  };
  return names[stage];
}

typedef struct traced_stage {
  trace *to;
  pbf_stage stage;
  const uint32_t *ids;
  uint64_t count;
} traced_stage;

static void trace_array(const traced_stage *t, const char *name, const pbf_real *values) {
  const uint64_t numbers[3] = {t->to->step, 8 * sizeof *values, t->count};
  char names[2][24] = {};
  if (!values) return;
  snprintf(names[0], sizeof names[0], "%s", traced_stage_name(t->stage));
  snprintf(names[1], sizeof names[1], "%s", name);
  fwrite("stage   ", 1, 8, t->to->file);
  fwrite(numbers, sizeof numbers, 1, t->to->file);
  fwrite(names, sizeof names, 1, t->to->file);
  fwrite(t->ids, sizeof *t->ids, t->count, t->to->file);
  fwrite(values, sizeof *values, t->count, t->to->file);
}

static void trace_field(const traced_stage *t, const char *name, const field &values) {
  for (int k = 0; k < PBF_DIM; ++k) {
    char of[24];
    snprintf(of, sizeof of, "%s %c", name, "xyz"[k]);
    trace_array(t, of, values.c[k]);
  }
}

static void trace_arrays(const worker *w, traced_stage *t) {
  if (t->stage == PBF_STAGE_PREDICT) {
    t->ids = w->b.ids;
    trace_field(t, "position", w->b.predicted());
    trace_field(t, "velocity", w->b.predicted_velocity());
  } else if (t->stage == PBF_STAGE_VISCOSITY && w->s->schedule.accelerated) {
    trace_field(t, "change", w->b.viscous_change());
  } else if (t->stage == PBF_STAGE_LAMBDA) {
    trace_array(t, "lambda", w->s->lambda);
  } else if (t->stage == PBF_STAGE_MOVE) {
    trace_field(t, "position", w->b.x_star(w->iteration + 1));
    trace_field(t, "velocity", w->b.sorted_velocity);
  } else if (t->stage == PBF_STAGE_OVERLAP) {
    trace_array(t, "overlap", w->b.sorted_overlap);
  } else if (t->stage == PBF_STAGE_RESIDUAL_DENSITY) {
    trace_array(t, "residual density", w->s->residual_density);
  } else if (t->stage < PBF_STAGE_VELOCITY) {
    trace_field(t, "position", w->b.sorted_predicted);
    trace_field(t, "velocity", w->b.sorted_velocity);
  } else {
    t->ids = w->b.ids;
    trace_field(t, "position", w->b.x);
    trace_field(t, "velocity", w->b.v);
  }
}

static void trace_stage(const worker *w, pbf_stage stage) {
  trace *to = &running_trace;
  if (w->self->thread != 0) return;
  if (stage == PBF_STAGE_PREDICT && to->step++ == 0) trace_begin(to);
  if (!to->file || to->step < to->first || to->step > to->last) return;
  traced_stage t = {to, stage, w->b.sorted_ids, w->s->count};
  trace_arrays(w, &t);
  fflush(to->file);
}

#endif
