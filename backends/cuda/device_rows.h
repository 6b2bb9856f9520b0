/* Part of deferred_steps.h: particles into and out of the caller's memory on the device, in its
 * layout and in the order of its stream. The host waits for none of it. */
#ifndef PBF_CUDA_DEVICE_ROWS_H
#define PBF_CUDA_DEVICE_ROWS_H

#include "cuda/device_memory.h"
#include "cuda/population.h"

/* Where numbers of the caller lie. */
struct device_layout {
  char *data;
  uint64_t stride;
  uint32_t type; /* PBF_TYPE_FLOAT32 or _FLOAT64 */
  uint32_t components;
  bool stored; /* a particle's place is that in the solver's memory, not its row's */

  __device__ char *row(uint32_t place) const { return data + place * stride; }
  __device__ void put(char *at, uint32_t k, double value) const {
    if (type == PBF_TYPE_FLOAT32)
      reinterpret_cast<float *>(at)[k] = (float)value;
    else
      reinterpret_cast<double *>(at)[k] = value;
  }
  __device__ double get(const char *at, uint32_t k) const {
    return type == PBF_TYPE_FLOAT32 ? (double)reinterpret_cast<const float *>(at)[k]
                                    : reinterpret_cast<const double *>(at)[k];
  }
};

/* What is read of a particle. */
struct device_fields {
  const char *vectors; /* by particle, so many bytes apart; null: `numbers` are the field */
  uint32_t vector_stride;
  uint32_t w;                /* PBF_W_…, of the fourth */
  const pbf_vec *velocities; /* for speeds */
  const pbf_real *numbers;   /* by row of the range: densities or pressures */
  double w_value;
};

static __device__ double fourth_of(const device_fields &f, uint32_t i, uint32_t row) {
  if (f.w == PBF_W_CONSTANT) return f.w_value;
  if (f.w != PBF_W_SPEED) return (double)f.numbers[row];
  double sum = 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const double v = (double)f.velocities[i].c[k];
    sum += v * v;
  }
  return sqrt(sum);
}

static __global__ void read_rows_kernel(device_fields f, const uint32_t *ids, uint32_t count,
                                        row_range rows, device_layout to) {
  const uint32_t i = thread_index();
  if (i >= count) return;
  const uint32_t row = row_in_range(rows, ids[i]);
  if (row >= rows.count) return;
  char *at = to.row(to.stored ? i : row);
  if (!f.vectors) return to.put(at, 0, (double)f.numbers[row]);
  const pbf_real *x = reinterpret_cast<const pbf_real *>(f.vectors + (size_t)i * f.vector_stride);
  for (int k = 0; k < PBF_DIM; ++k) to.put(at, (uint32_t)k, (double)x[k]);
  for (uint32_t k = PBF_DIM; k < to.components && k < 3; ++k) to.put(at, k, 0);
  if (to.components == 4) to.put(at, 3, fourth_of(f, i, row));
}

static __global__ void read_ids_kernel(const uint32_t *ids, uint32_t count, row_range rows,
                                       device_layout to) {
  const uint32_t i = thread_index();
  if (i >= count) return;
  const uint32_t row = row_in_range(rows, ids[i]);
  if (row < rows.count) *reinterpret_cast<uint32_t *>(to.row(to.stored ? i : row)) = ids[i];
}

/* No row is refused. */
enum : uint32_t { NO_ROW = ~0u };

/* The first row with a number that no velocity may be. */
static __global__ void check_rows_kernel(device_layout from, uint32_t count, double most,
                                         uint32_t *refused) {
  const uint32_t row = thread_index();
  if (row >= count) return;
  bool sound = true;
  for (uint32_t k = 0; k < PBF_DIM; ++k)
    sound = sound && fabs(from.get(from.row(row), k)) <= most; /* NaN is not */
  if (!sound) atomicMin(refused, row);
}

/* All of them or, if one is refused, none, which the host is told. */
static __global__ void write_rows_kernel(pbf_vec *velocities, const uint32_t *ids, uint32_t count,
                                         row_range rows, device_layout from,
                                         const uint32_t *refused, uint32_t *told) {
  const uint32_t i = thread_index(), bad = *refused;
  if (bad != NO_ROW) {
    if (i == 0) *told = rows.first + bad;
    return;
  }
  if (i >= count) return;
  const uint32_t row = row_in_range(rows, ids[i]);
  if (row >= rows.count) return;
  pbf_vec v;
  for (int k = 0; k < PBF_DIM; ++k) v.c[k] = (pbf_real)from.get(from.row(row), (uint32_t)k);
  velocities[i] = v;
}

/* ---- The host's part ------------------------------------------------------------------------- */

static inline device_layout layout_of(const pbf_device_rows *rows) {
  return {static_cast<char *>(rows->data), rows->stride, rows->element_type, rows->components,
          rows->order == PBF_ORDER_STORED};
}

static inline uint64_t row_bytes_of(const pbf_device_rows *rows) {
  return (uint64_t)rows->components * (rows->element_type == PBF_TYPE_FLOAT64 ? 8 : 4);
}

static inline pbf_status check_rows_memory(const solver *s, const pbf_device_rows *rows) {
  const uint64_t bytes = (rows->rows->count - 1) * rows->stride + row_bytes_of(rows);
  return pbf_cuda_check_memory(rows->name, rows->data, bytes, s->device);
}

/* What the solver's stream does next comes after what the caller's has been given so far … */
static inline pbf_status follow(solver *s, void *stream) {
  if (!s->handed)
    if (pbf_status status =
            pbf_cuda_check(cudaEventCreateWithFlags(&s->handed, cudaEventDisableTiming),
                           "cudaEventCreateWithFlags"))
      return status;
  if (!stream || stream == s->stream) return PBF_OK;
  if (pbf_status status = pbf_cuda_check(
          cudaEventRecord(s->handed, static_cast<cudaStream_t>(stream)), "cudaEventRecord"))
    return status;
  return pbf_cuda_check(cudaStreamWaitEvent(s->stream, s->handed, 0), "cudaStreamWaitEvent");
}

/* … and what the caller's is given next after that. */
static inline pbf_status hand_on(solver *s, void *stream) {
  if (!stream || stream == s->stream) return PBF_OK;
  if (pbf_status status = pbf_cuda_check(cudaEventRecord(s->handed, s->stream), "cudaEventRecord"))
    return status;
  return pbf_cuda_check(cudaStreamWaitEvent(static_cast<cudaStream_t>(stream), s->handed, 0),
                        "cudaStreamWaitEvent");
}

/* Densities or pressures of these rows, on the device. */
static inline pbf_status find_numbers(solver *s, bool densities, const pbf_rows *rows,
                                      const pbf_real **numbers) {
  *numbers = static_cast<const pbf_real *>(s->list_storage);
  return densities ? stage_densities(s, rows) : stage_pressures(s, rows);
}

static inline pbf_status launch_read_rows(solver *s, const pbf_device_rows *to) {
  const device_layout layout = layout_of(to);
  const bool fourth = layout.components == 4;
  device_fields f = {nullptr, sizeof(pbf_vec), to->w, s->velocities, nullptr, to->w_value};
  const bool densities = to->field == PBF_FIELD_DENSITY || (fourth && to->w == PBF_W_DENSITY);
  const bool pressures = to->field == PBF_FIELD_PRESSURE || (fourth && to->w == PBF_W_PRESSURE);
  if (densities || pressures)
    if (pbf_status status = find_numbers(s, densities, to->rows, &f.numbers)) return status;
  if (to->field == PBF_FIELD_POSITION)
    f.vectors = reinterpret_cast<const char *>(s->points), f.vector_stride = sizeof(point);
  if (to->field == PBF_FIELD_VELOCITY) f.vectors = reinterpret_cast<const char *>(s->velocities);
  row_range range;
  if (pbf_status status = upload_rows(s, to->rows, &range)) return status;
  if (to->field == PBF_FIELD_ID)
    read_ids_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(s->ids, s->count, range,
                                                                       layout);
  else
    read_rows_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(f, s->ids, s->count, range,
                                                                        layout);
  return pbf_cuda_check_launch("read_rows_kernel");
}

static inline pbf_status read_device_rows(solver *s, const pbf_device_rows *to) {
  if (pbf_status status = check_rows_memory(s, to)) return status;
  if (pbf_status status = follow(s, to->stream)) return status;
  if (pbf_status status = launch_read_rows(s, to)) return status;
  return hand_on(s, to->stream);
}

/* Words of what a writing finds: on the device, and in the host's memory. */
static inline pbf_status take_refusals(solver *s) {
  void *told;
  if (!s->refused)
    if (pbf_status status = pbf_cuda_take(&s->memory, "refused row", sizeof *s->refused,
                                          reinterpret_cast<void **>(&s->refused)))
      return status;
  if (s->told) return PBF_OK;
  if (pbf_status status = pbf_cuda_check(cudaHostAlloc(&told, sizeof *s->told, cudaHostAllocMapped),
                                         "cudaHostAlloc"))
    return status;
  s->told = static_cast<uint32_t *>(told);
  *s->told = NO_ROW;
  return PBF_OK;
}

static inline void free_refusals(solver *s) {
  if (s->told && cudaFreeHost(s->told) != cudaSuccess) cudaGetLastError();
  if (s->handed && cudaEventDestroy(s->handed) != cudaSuccess) cudaGetLastError();
  s->told = nullptr;
  s->handed = nullptr;
}

static inline pbf_status launch_write_rows(solver *s, const pbf_device_rows *from) {
  const device_layout layout = layout_of(from);
  row_range range;
  if (pbf_status status = wake_all(s)) return status;
  if (pbf_status status = upload_rows(s, from->rows, &range)) return status;
  if (pbf_status status = pbf_cuda_check(
          cudaMemsetAsync(s->refused, 0xff, sizeof *s->refused, s->stream), "cudaMemsetAsync"))
    return status;
  check_rows_kernel<<<blocks_for(range.count), PBF_BLOCK, 0, s->stream>>>(layout, range.count,
                                                                          from->most, s->refused);
  write_rows_kernel<<<blocks_for(s->count), PBF_BLOCK, 0, s->stream>>>(
      s->velocities, s->ids, s->count, range, layout, s->refused, s->told);
  return pbf_cuda_check_launch("write_rows_kernel");
}

static inline pbf_status write_device_rows(solver *s, const pbf_device_rows *from) {
  if (pbf_status status = check_rows_memory(s, from)) return status;
  if (pbf_status status = take_refusals(s)) return status;
  if (pbf_status status = follow(s, from->stream)) return status;
  if (pbf_status status = launch_write_rows(s, from)) return status;
  return hand_on(s, from->stream);
}

/* What a writing has found, once the device has come to it. */
static inline pbf_status tell_refusal(solver *s) {
  if (!s->told) return PBF_OK;
  const uint32_t row = *static_cast<const volatile uint32_t *>(s->told);
  if (row == NO_ROW) return PBF_OK;
  *s->told = NO_ROW;
  char sentence[160];
  snprintf(sentence, sizeof sentence,
           "velocities of a pbf_write before are not finite, the first in row %u; none of them was "
           "written",
           row);
  pbf_cuda_host->set_error(sentence);
  return PBF_ERROR_INVALID_ARGUMENT;
}

/* To the host, without gaps; it waits. */
static inline pbf_status fetch_device_rows(solver *s, const pbf_device_rows *from, void *to) {
  const uint64_t width = row_bytes_of(from);
  if (pbf_status status = check_rows_memory(s, from)) return status;
  if (pbf_status status = follow(s, from->stream)) return status;
  if (pbf_status status =
          pbf_cuda_check(cudaMemcpy2DAsync(to, width, from->data, from->stride, width,
                                           from->rows->count, cudaMemcpyDeviceToHost, s->stream),
                         "cudaMemcpy2DAsync to the host"))
    return status;
  return pbf_cuda_check(cudaStreamSynchronize(s->stream), "cudaStreamSynchronize");
}

#endif
