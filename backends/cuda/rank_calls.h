/* Part of backend.cu: calls of a solver that is one of some ranks: refusals, what comes in, which
 * all are given whole, and what goes out, which all get whole. */
#ifndef PBF_CUDA_RANK_CALLS_H
#define PBF_CUDA_RANK_CALLS_H

#include "common/rank_shares.h"
#include "common/rows.h"
#include "cuda/population.h"

/* ---- Refusals ------------------------------------------------------------------------------ */

static inline pbf_status refuse_call_on_ranks(const solver *s, const char *what) {
  char text[160];
  snprintf(text, sizeof text, "on ranks of \"cuda\" %s is not to be had", what);
  s->host->set_error(text);
  return PBF_ERROR_UNSUPPORTED;
}

/* A call that has failed on this rank alone leaves the others without it. */
static inline pbf_status end_call_on_ranks(solver *s, pbf_status status) {
  if (status == PBF_OK || s->ranks.failed) return end_on_ranks(s);
  snprintf(s->ranks.reason, sizeof s->ranks.reason, "a call has failed on this rank alone");
  s->ranks.failed = status;
  s->ranks.lost = s->ranks.told = true;
  return status;
}

/* ---- In ------------------------------------------------------------------------------------ */

/* The state from its arrays' beginning on. Between steps the sort's arrays are free. */
static inline pbf_status settle_state(solver *s) {
  const uint64_t n = s->count;
  const uint32_t first = s->first;
  if (!first) return PBF_OK;
  const struct {
    void *to;
    const void *from;
    uint64_t bytes;
  } copies[] = {
      {s->other, s->points + first, n * sizeof *s->points},
      {s->other_velocities, s->velocities + first, n * sizeof *s->velocities},
      {s->other_ids, s->ids + first, n * sizeof *s->ids},
      {s->other_last_pressure, s->last_pressure ? s->last_pressure + first : nullptr,
       s->last_pressure ? n * sizeof *s->last_pressure : 0},
      {s->other_overlap, s->overlap ? s->overlap + first : nullptr,
       s->overlap ? n * sizeof *s->overlap : 0},
      {s->other_activity, s->activity ? s->activity + first : nullptr,
       s->activity ? n * sizeof *s->activity : 0},
      {s->other_phase, s->phase ? s->phase + first : nullptr, s->phase ? n * sizeof *s->phase : 0},
      {s->other_acceleration, s->acceleration ? s->acceleration + first : nullptr,
       s->acceleration ? n * sizeof *s->acceleration : 0}};
  for (const auto &copy : copies)
    if (copy.bytes)
      if (pbf_status status = pbf_cuda_check(
              cudaMemcpyAsync(copy.to, copy.from, copy.bytes, cudaMemcpyDeviceToDevice, s->stream),
              "cudaMemcpyAsync"))
        return status;
  swap_arrays(&s->points, &s->other);
  swap_arrays(&s->velocities, &s->other_velocities);
  swap_arrays(&s->ids, &s->other_ids);
  swap_arrays(&s->last_pressure, &s->other_last_pressure);
  swap_arrays(&s->overlap, &s->other_overlap);
  swap_arrays(&s->activity, &s->other_activity);
  swap_arrays(&s->phase, &s->other_phase);
  swap_arrays(&s->acceleration, &s->other_acceleration);
  s->first = 0;
  return PBF_OK;
}

static inline pbf_status add_on_ranks(solver *s, const pbf_particles *particles) {
  pbf_particles share = *particles;
  uint32_t counts[RANKS_OF_CUDA];
  if (!share_of_added(s, counts, s->capacity, &share)) return end_on_ranks(s);
  if (pbf_status status = settle_state(s)) return status;
  return population_add(s, &share);
}

/* In parts that there is room for. */
static inline pbf_status remove_on_ranks(solver *s, uint32_t count, const uint32_t *ids) {
  s->ranks.particles = digest(s->ranks.particles, ids, (uint64_t)count * sizeof *ids);
  s->ranks.total -= count;
  if (pbf_status status = settle_state(s)) return status;
  for (uint32_t done = 0, part; done < count; done += part) {
    part = count - done < s->capacity ? count - done : s->capacity;
    if (!s->count) break;
    uint32_t own = 0, *place = static_cast<uint32_t *>(s->list_storage);
    const uint32_t before = s->count;
    if (pbf_status status = population_remove(s, part, ids + done)) return status;
    if (pbf_status status = copy_out(s, &own, place + before, sizeof own)) return status;
    s->count = own;
  }
  return PBF_OK;
}

/* The rows `first` … of these, as rows of their own. */
static inline pbf_rows part_of_rows(const pbf_rows *rows, uint32_t first, uint32_t count) {
  pbf_rows part = *rows;
  part.count = count;
  part.first = rows->first + first;
  if (!rows->ids) return part;
  part.ids = rows->ids + part.first;
  part.first = 0;
  part.total = count;
  return part;
}

/* As in the rows of PBF_BACKEND_FIELD_REST. */
struct rest_of_particle {
  pbf_real activity, lambda;
};

static inline pbf_status write_on_ranks(solver *s, uint32_t field, const pbf_rows *rows,
                                        const void *in) {
  const bool is_vector = field == PBF_FIELD_POSITION || field == PBF_FIELD_VELOCITY ||
                         field == PBF_BACKEND_FIELD_ACCELERATION;
  uint64_t row_bytes = (is_vector ? PBF_DIM : 1) * sizeof(pbf_real);
  if (field == PBF_BACKEND_FIELD_PHASE) row_bytes = 1;
  if (field == PBF_BACKEND_FIELD_REST) row_bytes = sizeof(rest_of_particle);
  const uint32_t what[3] = {field, rows->first, rows->count};
  s->ranks.particles = digest(s->ranks.particles, what, sizeof what);
  s->ranks.particles = digest(s->ranks.particles, in, rows->count * row_bytes);
  if (!s->count) return PBF_OK;
  if (pbf_status status = settle_state(s)) return status;
  for (uint32_t done = 0, part; done < rows->count; done += part) {
    part = rows->count - done < s->capacity ? rows->count - done : s->capacity;
    const pbf_rows some = part_of_rows(rows, done, part);
    if (pbf_status status =
            population_write(s, field, &some, static_cast<const char *>(in) + done * row_bytes))
      return status;
  }
  return PBF_OK;
}

/* ---- Out ----------------------------------------------------------------------------------- */

static __global__ void own_places_kernel(const point *points, uint32_t count, pbf_vec *out) {
  const uint32_t i = thread_index();
  if (i < count) out[i] = position_of(load(points, i));
}

static __global__ void own_rest_kernel(const point *points, const pbf_real *activity,
                                       uint32_t count, rest_of_particle *out) {
  const uint32_t i = thread_index();
  if (i < count) out[i] = {activity[i], points[i].lambda};
}

/* The host's memory for ids and rows of a rank's particles. */
struct rank_rows {
  const pbf_allocator &allocator;
  uint64_t bytes;
  char *memory;

  rank_rows(const pbf_allocator &of, uint64_t size) : allocator(of), bytes(size), memory(nullptr) {
    if (bytes)
      memory = static_cast<char *>(allocator.allocate(allocator.user, bytes, alignof(double)));
  }
  ~rank_rows() {
    if (memory) allocator.release(allocator.user, memory, bytes, alignof(double));
  }
};

static inline void unpack_rows(const pbf_rows *rows, const char *from, uint32_t count,
                               uint64_t row_bytes, void *out) {
  const uint32_t *ids = reinterpret_cast<const uint32_t *>(from + count * row_bytes);
  for (uint32_t k = 0; k < count; ++k) {
    const uint32_t row = pbf_row_of(rows, ids[k]) - rows->first;
    if (row < rows->count)
      memcpy(static_cast<char *>(out) + row * row_bytes, from + k * row_bytes, row_bytes);
  }
}

/* All ranks get what each has of its particles on its device, by their ids. */
static inline pbf_status share_rows(solver *s, const pbf_rows *rows, const uint32_t *ids,
                                    const void *values, uint32_t count, uint64_t row_bytes,
                                    void *out) {
  rank_state *r = &s->ranks;
  const uint64_t each = row_bytes + sizeof(uint32_t);
  uint32_t counts[RANKS_OF_CUDA], most = 0;
  if (!gather_on_ranks(s, &count, counts, sizeof count)) return end_on_ranks(s);
  for (uint32_t k = 0; k < r->count; ++k) most = counts[k] > most ? counts[k] : most;
  rank_rows own(s->allocator, most * each), others(s->allocator, most * each);
  pbf_status status = PBF_OK;
  if (count && own.memory) status = copy_out(s, own.memory, values, count * row_bytes);
  if (count && own.memory && status == PBF_OK)
    status = copy_out(s, own.memory + count * row_bytes, ids, count * sizeof *ids);
  if (!on_all_ranks(s, own.memory && others.memory && status == PBF_OK)) {
    refuse_on_ranks(s, PBF_ERROR_OUT_OF_MEMORY, "a rank has no memory for the others' rows");
    return end_on_ranks(s);
  }
  unpack_rows(rows, own.memory, count, row_bytes, out);
  for (uint32_t k = 0; k < r->count && !r->failed; ++k) {
    pbf_rank_message messages[RANKS_OF_CUDA];
    const bool sends = k == r->rank;
    uint32_t n = 0;
    for (uint32_t other = 0; other < r->count && counts[k]; ++other)
      if (sends ? other != k : other == r->rank)
        messages[n++] = {sends ? other : k, 0, counts[k] * each,
                         sends ? own.memory : others.memory};
    note_communication(
        s, r->link.exchange(r->link.user, sends ? n : 0, messages, sends ? 0 : n, messages));
    if (!sends && !r->failed) unpack_rows(rows, others.memory, counts[k], row_bytes, out);
  }
  return end_on_ranks(s);
}

static inline pbf_status read_state_on_ranks(solver *s, uint32_t field, const pbf_rows *rows,
                                             void *out) {
  if (pbf_status status = settle_state(s)) return status;
  if (field == PBF_BACKEND_FIELD_REST) {
    if (pbf_status status = wake_ranks(s)) return status;
    rest_of_particle *rest = reinterpret_cast<rest_of_particle *>(s->other);
    if (!s->activity) return PBF_OK;
    if (s->count)
      own_rest_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(s->points, s->activity,
                                                                         s->count, rest);
    return share_rows(s, rows, s->ids, rest, s->count, sizeof *rest, out);
  }
  if (field == PBF_BACKEND_FIELD_OVERLAP || field == PBF_BACKEND_FIELD_LAST_PRESSURE) {
    const pbf_real *numbers = field == PBF_BACKEND_FIELD_OVERLAP ? s->overlap : s->last_pressure;
    return numbers ? share_rows(s, rows, s->ids, numbers, s->count, sizeof(pbf_real), out) : PBF_OK;
  }
  const void *values = s->velocities;
  if (field == PBF_FIELD_POSITION) {
    pbf_vec *places = reinterpret_cast<pbf_vec *>(s->other);
    values = places;
    if (s->count)
      own_places_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(s->points, s->count,
                                                                           places);
  }
  return share_rows(s, rows, s->ids, values, s->count, sizeof(pbf_vec), out);
}

static inline pbf_status read_densities_on_ranks(solver *s, const pbf_rows *rows, void *out) {
  iteration_extras extras;
  pbf_status status = present_extras(s, &extras);
  const cell_grid grid = present_grid(s, extras.obstacles.domain);
  pbf_real *densities = reinterpret_cast<pbf_real *>(s->other_velocities);
  if (status == PBF_OK) status = sort_present(s, grid);
  if (status != PBF_OK) return end_call_on_ranks(s, status);
  const neighborhood n = neighborhood_of(s, grid);
  const uint32_t own = n.particles.count - n.particles.first;
  launch_densities(s, n, extras, {densities, nullptr});
  return share_rows(s, rows, s->other_ids + n.particles.first, densities + n.particles.first, own,
                    sizeof(pbf_real), out);
}

static inline pbf_status read_on_ranks(solver *s, uint32_t field, const pbf_rows *rows, void *out) {
  const uint32_t asked[3] = {field, rows->first, rows->count};
  if (!agree_on_call(s, "a reading of particles", asked, sizeof asked)) return end_on_ranks(s);
  if (!rows->count) return PBF_OK;
  if (field == PBF_FIELD_DENSITY) return read_densities_on_ranks(s, rows, out);
  return read_state_on_ranks(s, field, rows, out);
}

static inline pbf_status max_on_ranks(solver *s, double *value) {
  double all[RANKS_OF_CUDA];
  if (gather_on_ranks(s, value, all, sizeof *value))
    for (uint32_t k = 0; k < s->ranks.count; ++k) *value = all[k] > *value ? all[k] : *value;
  return end_on_ranks(s);
}

#endif
