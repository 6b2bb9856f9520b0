/* What comes and goes between two steps. */
#include <math.h>
#include <string.h>

#include "emission.h"
#include "emitter.h"
#include "entering.h"
#include "guided.h"
#include "memory.h"
#include "new_particles.h"
#include "opening.h"
#include "particles/inside.h"
#include "particles/particles.h"
#include "particles/population.h"
#include "physics/spacing.h"
#include "query/volume.h"
#include "reservoir.h"
#include "solver/backend_call.h"
#include "solver/ids.h"
#include "solver/solver_time.h"

/* ---- Out ------------------------------------------------------------------------------------- */

/* The rows of births that are over, which go from the list when their particles have gone. */
static void mark_expired(const pbf_solver *solver, const pbf_emission *e, double now,
                         pbf_row_set *out) {
  for (uint32_t i = 0; i < e->head.births_count; ++i) {
    const pbf_births *b = &e->births[i];
    uint32_t row;
    if (b->death > now) continue;
    pbf_ids_find(solver, b->first_id, &row);
    for (; row < solver->count && pbf_ids_of_row(solver, row) - b->first_id < b->count; ++row)
      pbf_row_set_add(out, row);
  }
}

static void forget_expired(pbf_emission *e, double now) {
  uint32_t kept = 0;
  for (uint32_t i = 0; i < e->head.births_count; ++i)
    if (e->births[i].death > now) e->births[kept++] = e->births[i];
  e->head.births_count = kept;
}

typedef struct drain_frames {
  uint32_t count;
  pbf_volume_frame of[PBF_MAX_DRAINS];
} drain_frames;

static int is_drained(const void *what, const double point[3]) {
  const drain_frames *frames = what;
  for (uint32_t i = 0; i < frames->count; ++i)
    if (pbf_volume_has(&frames->of[i], point)) return 1;
  return 0;
}

static pbf_status mark_drained(pbf_solver *solver, const pbf_emission *e, pbf_row_set *out) {
  drain_frames frames = {.count = e->head.drain_count};
  pbf_backend_box boxes[PBF_MAX_DRAINS];
  for (uint32_t i = 0; i < frames.count; ++i) {
    frames.of[i] = pbf_volume_frame_of(&e->drains[i], solver->kind.dimension);
    boxes[i] = pbf_volume_box(&frames.of[i], 0);
  }
  return pbf_row_set_add_inside(solver, frames.count, boxes, is_drained, &frames, out);
}

/* What drains and reservoirs remove. */
static pbf_status mark_by_place(pbf_solver *solver, const pbf_emission *e, pbf_row_set *out,
                                uint64_t removed[PBF_MAX_RESERVOIRS]) {
  pbf_status status = mark_drained(solver, e, out);
  for (uint32_t i = 0; i < e->head.reservoir_count && status == PBF_OK; ++i)
    status = pbf_reservoir_mark(solver, &e->reservoirs[i], out, &removed[i]);
  return status;
}

static pbf_status remove_some(pbf_solver *solver, pbf_emission *e) {
  const double now = pbf_solver_time(solver);
  pbf_row_set out;
  uint64_t removed[PBF_MAX_RESERVOIRS] = {0};
  if (solver->count == 0 ||
      e->head.drain_count + e->head.births_count + e->head.reservoir_count == 0)
    return PBF_OK;
  pbf_status status = pbf_row_set_allocate(solver, &out);
  if (status != PBF_OK) return status;
  mark_expired(solver, e, now, &out);
  const uint32_t expired = out.count;
  status = mark_by_place(solver, e, &out, removed);
  const uint32_t drained = out.count - expired;
  if (status == PBF_OK) status = pbf_row_set_remove(solver, &out);
  pbf_row_set_free(solver, &out);
  if (status != PBF_OK) return status;
  e->head.in_out.expired += expired;
  e->head.in_out.drained += drained;
  for (uint32_t i = 0; i < e->head.reservoir_count; ++i) e->reservoirs[i].removed += removed[i];
  forget_expired(e, now);
  return PBF_OK;
}

/* The oldest: ids ascend. */
static pbf_status recycle(pbf_solver *solver, pbf_emission *e, uint32_t count) {
  pbf_row_set out;
  pbf_status status = pbf_row_set_allocate(solver, &out);
  if (status != PBF_OK) return status;
  for (uint32_t row = 0; row < count; ++row) pbf_row_set_add(&out, row);
  status = pbf_row_set_remove(solver, &out);
  pbf_row_set_free(solver, &out);
  if (status == PBF_OK) e->head.in_out.recycled += count;
  return status;
}

/* ---- In -------------------------------------------------------------------------------------- */

/* What an emitter adds before a step. */
typedef struct batch {
  pbf_opening opening;
  double way;     /* of the stream in a step */
  double due;     /* before it, and … */
  double a_step;  /* … in it, particles */
  uint64_t count; /* that have left */
} batch;

static batch batch_of(const pbf_solver *solver, const pbf_source *source) {
  const double most = 4294967296; /* as many as there are ids */
  const double d = pbf_derive_spacing(&solver->params);
  batch b = {.opening = pbf_opening_of(&source->emitter, solver->kind.dimension, d),
             .due = source->due};
  b.way = b.opening.speed * pbf_part_time_step(solver);
  b.a_step = b.opening.rate * pbf_part_time_step(solver) /
             (solver->kind.dimension == 3 ? d * d * d : d * d);
  b.count = (uint64_t)floor(fmin(b.due + b.a_step, most));
  return b;
}

static pbf_status reserve_births(pbf_solver *solver, pbf_emission *e) {
  void *memory;
  if (e->head.births_count < e->births_capacity) return PBF_OK;
  const uint32_t capacity = 2 * e->births_capacity + 64;
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, (uint64_t)capacity * sizeof *e->births,
                          "lifetimes of particles", &memory);
  if (status != PBF_OK) return status;
  if (e->births_capacity > 0)
    memcpy(memory, e->births, (uint64_t)e->births_capacity * sizeof *e->births);
  pbf_memory_free(&solver->allocator, e->births, (uint64_t)e->births_capacity * sizeof *e->births);
  e->births = memory;
  e->births_capacity = capacity;
  return PBF_OK;
}

/* Emitters of one opening, as of fluids that it mixes, take turns: particles leave it as those of
 * one stream would that has all of their rates. They would else leave at the same times, and lie
 * upon each other. */
typedef struct turns {
  double due, a_step; /* as a batch's */
  uint64_t number;    /* of the next particle */
  double late;        /* so much later than its turn a particle may be, along the stream */
} turns;

static turns turns_of(const pbf_solver *solver, const pbf_emission *e, const batch *own,
                      uint32_t source) {
  const double spacing = pbf_derive_spacing(&solver->params);
  turns t = {own->due, own->a_step, e->sources[source].number, 0};
  for (uint32_t i = 0; i < e->head.source_count; ++i) {
    const pbf_source *other = &e->sources[i];
    if (i == source ||
        !pbf_emitters_share(&other->emitter, &e->sources[source].emitter, solver->kind.dimension))
      continue;
    const batch b = batch_of(solver, other);
    t.due += i < source ? b.due - b.a_step : b.due; /* those before have had this step's */
    t.a_step += b.a_step;
    t.number += other->number;
    t.late += spacing;
  }
  return t;
}

/* Particle j of the batch left when so much of the step was over as the due number says, and has
 * gone on since, unless it met a solid. */
static void begin_batch(const pbf_solver *solver, const batch *b, const turns *t, uint32_t source,
                        uint64_t count, pbf_guided *guided) {
  const uint32_t n = solver->kind.dimension;
  for (uint64_t j = 0; j < count; ++j) {
    const double own = b->way * (1 - ((double)(j + 1) - b->due) / b->a_step);
    const double in_turn = b->way * (1 - ((double)(j + 1) - t->due) / t->a_step);
    double place[3];
    pbf_opening_place(&b->opening, t->number + j, place);
    guided[j] = (pbf_guided){.source = source, .ahead = fmin(in_turn, own + t->late)};
    memcpy(guided[j].from, place, n * sizeof *place);
    memcpy(guided[j].velocity, b->opening.emitter->velocity, n * sizeof *place);
  }
  pbf_guided_meet_solids(solver, guided, (uint32_t)count, PBF_GUIDED_STOPS);
}

/* Those outside of the domain are left out; returns how many are left. */
static uint32_t write_batch(const pbf_solver *solver, const pbf_emission *e, uint64_t count,
                            pbf_guided *guided) {
  const uint32_t n = solver->kind.dimension;
  void *velocities = (char *)e->particles + count * pbf_point_bytes(solver);
  uint32_t written = 0;
  for (uint64_t j = 0; j < count; ++j) {
    double place[3];
    pbf_guided_place(&guided[j], place);
    if (!pbf_emission_is_inside(solver, place)) continue;
    guided[written] = guided[j];
    guided[written].id = (uint32_t)solver->next_id + written;
    for (uint32_t k = 0; k < n; ++k) {
      pbf_emission_put(solver, e->particles, (uint64_t)written * n + k, place[k]);
      pbf_emission_put(solver, velocities, (uint64_t)written * n + k, guided[j].velocity[k]);
    }
    ++written;
  }
  return written;
}

static pbf_status add_batch(pbf_solver *solver, pbf_emission *e, const pbf_source *source,
                            uint32_t count, const void *velocities) {
  const uint32_t first = (uint32_t)solver->next_id;
  pbf_status status = PBF_OK;
  if (source->emitter.lifetime > 0) status = reserve_births(solver, e);
  if (status == PBF_OK && count > 0)
    status =
        pbf_population_append(solver, count, e->particles, velocities, 0, source->emitter.phase);
  if (status != PBF_OK || count == 0 || !(source->emitter.lifetime > 0)) return status;
  e->births[e->head.births_count++] =
      (pbf_births){first, count, pbf_solver_time(solver) + source->emitter.lifetime};
  return PBF_OK;
}

/* ---- On the way ------------------------------------------------------------------------------ */

static pbf_status reserve_guided(pbf_solver *solver, pbf_emission *e, uint32_t count) {
  void *memory;
  if (e->guided_capacity - e->head.guided_count >= count) return PBF_OK;
  const uint32_t capacity = 2 * e->guided_capacity + count + 64;
  pbf_status status =
      pbf_memory_allocate(&solver->allocator, (uint64_t)capacity * sizeof *e->guided,
                          "particles that leave an emitter", &memory);
  if (status != PBF_OK) return status;
  if (e->head.guided_count > 0)
    memcpy(memory, e->guided, (uint64_t)e->head.guided_count * sizeof *e->guided);
  pbf_memory_free(&solver->allocator, e->guided, (uint64_t)e->guided_capacity * sizeof *e->guided);
  e->guided = memory;
  e->guided_capacity = capacity;
  return PBF_OK;
}

/* Whether none of these rows is another particle's, nor of one that its stream would carry out of
 * the domain and that is left alone. */
static int all_are_set(const pbf_solver *solver, const pbf_emission *e, uint32_t rows) {
  if (rows != e->head.guided_count) return 0;
  for (uint32_t i = 0; i < rows; ++i) {
    double to[3];
    pbf_guided_place(&e->guided[i], to);
    if (!pbf_emission_is_inside(solver, to)) return 0;
  }
  return 1;
}

static void put_on_way(const pbf_solver *solver, const pbf_emission *e, const batch *stream,
                       const pbf_guided *g, uint32_t place, uint32_t places) {
  const double faster = stream->opening.speed / pbf_guided_speed(g);
  const uint32_t n = solver->kind.dimension;
  void *velocities = (char *)e->particles + places * pbf_point_bytes(solver);
  double to[3];
  pbf_guided_place(g, to);
  if (!pbf_emission_is_inside(solver, to)) return;
  for (uint32_t k = 0; k < n; ++k) {
    pbf_emission_put(solver, e->particles, (uint64_t)place * n + k, to[k]);
    pbf_emission_put(solver, velocities, (uint64_t)place * n + k, faster * g->velocity[k]);
  }
}

/* The rows from the first to the last of them. */
static pbf_status write_guided(pbf_solver *solver, pbf_emission *e, const batch *streams,
                               uint32_t first, uint32_t count) {
  const pbf_rows rows = pbf_ids_rows(solver, first, count);
  pbf_status status = pbf_emission_reserve(solver, e, count);
  if (status != PBF_OK) return status;
  void *velocities = (char *)e->particles + count * pbf_point_bytes(solver);
  if (!all_are_set(solver, e, count)) {
    status = pbf_read_rows(solver, PBF_FIELD_POSITION, first, count, e->particles);
    if (status == PBF_OK)
      status = pbf_read_rows(solver, PBF_FIELD_VELOCITY, first, count, velocities);
    if (status != PBF_OK) return status;
  }
  for (uint32_t i = 0; i < e->head.guided_count; ++i) {
    uint32_t row;
    pbf_ids_find(solver, e->guided[i].id, &row);
    put_on_way(solver, e, &streams[e->guided[i].source], &e->guided[i], row - first, count);
  }
  status = solver->api.write(solver->backend, PBF_FIELD_POSITION, &rows, e->particles);
  if (status == PBF_OK)
    status = solver->api.write(solver->backend, PBF_FIELD_VELOCITY, &rows, velocities);
  ++solver->generation;
  return pbf_backend_result(solver, status, "write");
}

/* Sets those that have left an opening to where their stream has them after the last step. */
static pbf_status guide(pbf_solver *solver, pbf_emission *e) {
  batch streams[PBF_MAX_EMITTERS];
  uint32_t kept = 0, first = UINT32_MAX, last = 0;
  const double since = solver->part > 0 ? pbf_part_time_step(solver) : solver->params.time_step;
  for (uint32_t i = 0; i < e->head.source_count; ++i) streams[i] = batch_of(solver, &e->sources[i]);
  for (uint32_t i = 0; i < e->head.guided_count && !e->is_advanced; ++i)
    e->guided[i].ahead += streams[e->guided[i].source].opening.speed * since;
  pbf_guided_meet_solids(solver, e->guided, e->head.guided_count, PBF_GUIDED_IS_LET_GO);
  for (uint32_t i = 0; i < e->head.guided_count; ++i) {
    const pbf_guided g = e->guided[i];
    uint32_t row;
    if (g.ahead > solver->params.smoothing_radius || !pbf_ids_find(solver, g.id, &row)) continue;
    first = row < first ? row : first;
    last = row > last ? row : last;
    e->guided[kept++] = g;
  }
  e->head.guided_count = kept;
  e->is_advanced = 1;
  return kept > 0 ? write_guided(solver, e, streams, first, last - first + 1) : PBF_OK;
}

/* How many of a batch fit, once the oldest have made way. */
static pbf_status fit_batch(pbf_solver *solver, pbf_emission *e, const pbf_source *source,
                            uint64_t *count) {
  const uint64_t ids = (UINT64_C(1) << 32) - solver->next_id;
  uint32_t left = solver->capacity - solver->count;
  pbf_status status = PBF_OK;
  if (*count > ids) *count = ids;
  if (*count > solver->capacity) *count = solver->capacity;
  if (*count > left && source->emitter.recycle)
    status = recycle(solver, e, (uint32_t)*count - left);
  left = solver->capacity - solver->count;
  if (*count > left) *count = left;
  return status;
}

static pbf_status emit(pbf_solver *solver, pbf_emission *e, pbf_source *source) {
  const batch b = batch_of(solver, source);
  uint64_t count = b.count;
  uint32_t written = 0;
  pbf_status status = fit_batch(solver, e, source, &count);
  if (status == PBF_OK) status = pbf_emission_reserve(solver, e, count);
  if (status == PBF_OK) status = reserve_guided(solver, e, (uint32_t)count);
  if (status == PBF_OK && count > 0) {
    pbf_guided *guided = e->guided + e->head.guided_count;
    const uint32_t number = (uint32_t)(source - e->sources);
    const turns t = turns_of(solver, e, &b, number);
    begin_batch(solver, &b, &t, number, count, guided);
    written = write_batch(solver, e, count, guided);
    status = add_batch(solver, e, source, written,
                       (char *)e->particles + count * pbf_point_bytes(solver));
  }
  if (status != PBF_OK) return status;
  e->head.guided_count += written;
  e->head.in_out.emitted += written;
  e->head.in_out.refused += b.count - written;
  source->number += b.count;
  source->due = fmin(b.due + b.a_step - (double)b.count, 1 - 0x1p-53);
  return PBF_OK;
}

/* ---- A step ---------------------------------------------------------------------------------- */

/* The next step takes it that they have gone on for a whole one since they were set to their
 * places, and it was a part. */
static void end_parts(pbf_solver *solver) {
  pbf_emission *e = solver->emission;
  const double d = pbf_derive_spacing(&solver->params);
  for (uint32_t i = 0; i < e->head.guided_count; ++i) {
    const pbf_emitter *emitter = &e->sources[e->guided[i].source].emitter;
    const double speed = pbf_opening_of(emitter, solver->kind.dimension, d).speed;
    e->guided[i].ahead += speed * (pbf_part_time_step(solver) - solver->params.time_step);
  }
}

static double speed(const pbf_solver *solver) {
  const pbf_emission *e = solver->emission;
  const double d = pbf_derive_spacing(&solver->params);
  double fastest = 0;
  for (uint32_t i = 0; i < e->head.source_count; ++i)
    fastest =
        fmax(fastest, pbf_opening_of(&e->sources[i].emitter, solver->kind.dimension, d).speed);
  return fastest;
}

static pbf_status prepare(pbf_solver *solver) {
  pbf_emission *e = solver->emission;
  pbf_status status = PBF_OK;
  if (!pbf_emission_is_active(solver)) return PBF_OK;
  if (e->head.step != solver->step) e->head.stage = e->is_advanced = 0;
  e->head.step = solver->step;
  if (e->head.stage == 0) status = remove_some(solver, e);
  if (status == PBF_OK && e->head.stage == 0) status = guide(solver, e);
  if (status == PBF_OK && e->head.stage == 0) e->head.stage = 1;
  while (status == PBF_OK && e->head.stage <= e->head.source_count) {
    status = emit(solver, e, &e->sources[e->head.stage - 1]);
    e->head.stage += status == PBF_OK;
  }
  while (status == PBF_OK && e->head.stage <= e->head.source_count + 2 * e->head.reservoir_count) {
    status = pbf_reservoir_stage(solver, e, e->head.stage - e->head.source_count - 1);
    e->head.stage += status == PBF_OK;
  }
  return status;
}

const pbf_emission_work pbf_emission_in_steps = {.prepare = prepare,
                                                 .end_parts = end_parts,
                                                 .speed = speed,
                                                 .find_entering = pbf_emission_find_entering,
                                                 .tell_entering = pbf_emission_tell_entering,
                                                 .keep = pbf_guided_keep,
                                                 .move = pbf_guided_move};
