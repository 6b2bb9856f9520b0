#include "saved.h"

#include <math.h>
#include <string.h>

#include "emitter.h"
#include "error.h"
#include "guided.h"
#include "memory.h"
#include "query/volume.h"
#include "reservoir.h"
#include "structs.h"

/* As it is stored: structs have the sizes of the build that has written them. */
typedef struct stored_head {
  pbf_emission_head head;
  uint32_t emitter_size, volume_size;
} stored_head;

typedef struct stored_source { /* before its emitter */
  double due;
  uint64_t number;
} stored_source;

static uint64_t size_of(const stored_head *stored) {
  const pbf_emission_head *head = &stored->head;
  return sizeof *stored +
         (uint64_t)head->source_count * (sizeof(stored_source) + stored->emitter_size) +
         (uint64_t)head->drain_count * stored->volume_size +
         (uint64_t)head->births_count * sizeof(pbf_births) +
         (uint64_t)head->guided_count * sizeof(pbf_guided);
}

/* Reservoirs come last, each of the size that it says: states of before have none. */
static int has_right_size(const stored_head *stored, uint64_t size) {
  const uint64_t count = stored->head.reservoir_count, rest = size_of(stored);
  if (count == 0) return rest == size;
  return rest < size && (size - rest) % count == 0;
}

static stored_head head_of(const pbf_emission *e) {
  return (stored_head){e->head, sizeof(pbf_emitter), sizeof(pbf_volume)};
}

uint64_t pbf_emission_saved_size(const pbf_solver *solver) {
  static const pbf_in_out none;
  const pbf_emission *e = solver->emission;
  if (!e) return 0;
  if (!pbf_emission_is_active(solver) && memcmp(&e->head.in_out, &none, sizeof none) == 0) return 0;
  const stored_head stored = head_of(e);
  return size_of(&stored) + e->head.reservoir_count * sizeof *e->reservoirs;
}

static unsigned char *put(unsigned char *at, const void *data, uint64_t size) {
  if (size > 0) memcpy(at, data, size);
  return at + size;
}

/* Where the structs are cleaned for a dimension; 0: they are as they were set. */
static void put_all(const pbf_emission *e, uint32_t dimension, void *buffer) {
  const stored_head stored = head_of(e);
  unsigned char *at = put(buffer, &stored, sizeof stored);
  for (uint32_t i = 0; i < e->head.source_count; ++i) {
    const stored_source source = {e->sources[i].due, e->sources[i].number};
    pbf_emitter emitter = e->sources[i].emitter;
    if (dimension) pbf_emitter_clean(&emitter, dimension);
    at = put(at, &source, sizeof source);
    at = put(at, &emitter, sizeof emitter);
  }
  for (uint32_t i = 0; i < e->head.drain_count; ++i) {
    pbf_volume drain = e->drains[i];
    if (dimension) pbf_volume_clean(&drain, dimension);
    at = put(at, &drain, sizeof drain);
  }
  at = put(at, e->births, e->head.births_count * sizeof *e->births);
  at = put(at, e->guided, e->head.guided_count * sizeof *e->guided);
  for (uint32_t i = 0; i < e->head.reservoir_count; ++i) {
    pbf_reservoir reservoir = e->reservoirs[i];
    if (dimension) pbf_reservoir_clean(&reservoir, dimension);
    at = put(at, &reservoir, sizeof reservoir);
  }
}

void pbf_emission_save(const pbf_solver *solver, void *buffer) {
  put_all(solver->emission, 0, buffer);
}

void pbf_emission_put_clean(const pbf_solver *solver, void *buffer) {
  put_all(solver->emission, solver->kind.dimension, buffer);
}

/* ---- Reading --------------------------------------------------------------------------------- */

static pbf_status reject(const char *what) {
  return pbf_fail(PBF_ERROR_DATA, "the saved state %s; pbf_load takes what pbf_save wrote", what);
}

static pbf_status check_head(const stored_head *stored, uint64_t size) {
  const pbf_emission_head *head = &stored->head;
  if (head->source_count > PBF_MAX_EMITTERS || head->drain_count > PBF_MAX_DRAINS ||
      head->reservoir_count > PBF_MAX_RESERVOIRS ||
      head->stage > head->source_count + 2 * head->reservoir_count + 1 ||
      !has_right_size(stored, size))
    return reject("contradicts itself in its emitters");
  return PBF_OK;
}

static pbf_status read_sources(const pbf_solver *solver, const stored_head *stored,
                               const unsigned char **at, pbf_emission *e) {
  for (uint32_t i = 0; i < stored->head.source_count; ++i) {
    pbf_source *source = &e->sources[i];
    stored_source now;
    memcpy(&now, *at, sizeof now);
    pbf_status status = pbf_struct_in_stored(&pbf_kind_emitter, *at + sizeof now,
                                             stored->emitter_size, &source->emitter);
    if (status == PBF_OK) status = pbf_emitter_check(&source->emitter, i, solver->kind);
    if (status != PBF_OK) return status;
    if (!(now.due >= 0 && now.due < 1)) return reject("has an emitter that is due never");
    source->due = now.due;
    source->number = now.number;
    *at += sizeof now + stored->emitter_size;
  }
  return PBF_OK;
}

static pbf_status read_drains(const pbf_solver *solver, const stored_head *stored,
                              const unsigned char **at, pbf_emission *e) {
  for (uint32_t i = 0; i < stored->head.drain_count; ++i) {
    pbf_status status =
        pbf_struct_in_stored(&pbf_kind_volume, *at, stored->volume_size, &e->drains[i]);
    if (status == PBF_OK)
      status = pbf_volume_check(&e->drains[i], "drains", solver->kind.dimension);
    if (status != PBF_OK) return status;
    *at += stored->volume_size;
  }
  return PBF_OK;
}

static pbf_status read_births(const stored_head *stored, const unsigned char *at, uint64_t next_id,
                              pbf_emission *e) {
  uint64_t end = 0;
  const uint64_t bytes = stored->head.births_count * sizeof *e->births;
  if (bytes > 0) memcpy(e->births, at, bytes);
  for (uint32_t i = 0; i < stored->head.births_count; ++i) {
    const pbf_births *b = &e->births[i];
    if (b->first_id < end || b->count == 0 || b->first_id + (uint64_t)b->count > next_id ||
        !isfinite(b->death))
      return reject("contradicts itself in lifetimes");
    end = b->first_id + (uint64_t)b->count;
  }
  return PBF_OK;
}

static int is_a_way(const pbf_guided *g) {
  const double speed = pbf_guided_speed(g);
  int is_one = isfinite(g->ahead) && speed > 0 && isfinite(speed);
  for (int k = 0; k < 3; ++k) is_one = is_one && isfinite(g->from[k]);
  return is_one;
}

static pbf_status read_guided(const stored_head *stored, const unsigned char *at, pbf_emission *e) {
  const uint64_t bytes = stored->head.guided_count * sizeof *e->guided;
  if (bytes > 0) memcpy(e->guided, at, bytes);
  for (uint32_t i = 0; i < stored->head.guided_count; ++i)
    if (e->guided[i].source >= stored->head.source_count || !is_a_way(&e->guided[i]))
      return reject("contradicts itself in what leaves an emitter");
  return PBF_OK;
}

static pbf_status read_reservoirs(const pbf_solver *solver, const stored_head *stored,
                                  const unsigned char *at, uint64_t bytes, pbf_emission *e) {
  const uint32_t count = stored->head.reservoir_count;
  for (uint32_t i = 0; i < count; ++i, at += bytes / count) {
    pbf_status status =
        pbf_struct_in_stored(&pbf_kind_reservoir, at, (uint32_t)(bytes / count), &e->reservoirs[i]);
    if (status == PBF_OK) status = pbf_reservoir_check(&e->reservoirs[i], i, solver->kind);
    if (status != PBF_OK) return status;
  }
  return PBF_OK;
}

static pbf_status allocate(pbf_solver *solver, const stored_head *stored, pbf_emission **made) {
  const pbf_allocator *allocator = &solver->allocator;
  const uint64_t births = stored->head.births_count * sizeof(pbf_births);
  const uint64_t guided = stored->head.guided_count * sizeof(pbf_guided);
  void *memory;
  pbf_status status = pbf_memory_allocate(allocator, sizeof **made, "loading emitters", &memory);
  if (status != PBF_OK) return status;
  memset(memory, 0, sizeof **made);
  *made = memory;
  (*made)->work = &pbf_emission_in_steps;
  (*made)->head = stored->head;
  if (births > 0) {
    status = pbf_memory_allocate(allocator, births, "loading lifetimes", &memory);
    if (status != PBF_OK) return status;
    (*made)->births = memory;
    (*made)->births_capacity = stored->head.births_count;
  }
  if (guided == 0) return PBF_OK;
  status = pbf_memory_allocate(allocator, guided, "loading what leaves an emitter", &memory);
  if (status != PBF_OK) return status;
  (*made)->guided = memory;
  (*made)->guided_capacity = stored->head.guided_count;
  return PBF_OK;
}

pbf_status pbf_emission_read(pbf_solver *solver, const void *buffer, uint64_t size,
                             uint64_t next_id, pbf_emission **emission) {
  const unsigned char *at = (const unsigned char *)buffer + sizeof(stored_head);
  pbf_emission *e = NULL;
  stored_head stored;
  *emission = NULL;
  if (size == 0) return PBF_OK;
  if (size < sizeof stored) return reject("is cut short in its emitters");
  memcpy(&stored, buffer, sizeof stored);
  pbf_status status = check_head(&stored, size);
  if (status == PBF_OK) status = allocate(solver, &stored, &e);
  if (status == PBF_OK) status = read_sources(solver, &stored, &at, e);
  if (status == PBF_OK) status = read_drains(solver, &stored, &at, e);
  if (status == PBF_OK) status = read_births(&stored, at, next_id, e);
  if (status == PBF_OK)
    status = read_guided(&stored, at + stored.head.births_count * sizeof(pbf_births), e);
  if (status == PBF_OK) {
    const uint64_t before = size_of(&stored);
    status =
        read_reservoirs(solver, &stored, (const unsigned char *)buffer + before, size - before, e);
  }
  if (status == PBF_OK)
    *emission = e;
  else
    pbf_emission_free(solver, e);
  return status;
}
