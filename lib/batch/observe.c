#include "observe.h"

#include <inttypes.h>
#include <string.h>

#include "check.h"
#include "error.h"
#include "handles.h"
#include "particles/values.h"
#include "structs.h"
#include "worlds.h"

static pbf_status get_count(pbf_batch *batch, uint32_t world, void *context) {
  return pbf_get_count(batch->worlds[world].solver, (uint32_t *)context + world);
}

pbf_status pbf_batch_get_counts(pbf_batch *batch, uint32_t *counts) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  status = pbf_check_pointer("counts", counts, sizeof *counts);
  if (status == PBF_OK)
    status = pbf_batch_for_worlds(batch, NULL, PBF_BY_CALLER, get_count, counts);
  return pbf_batch_leave(batch, status);
}

static pbf_status note_most(pbf_batch *batch, uint32_t world, void *context) {
  uint32_t count, *most = context;
  pbf_status status = pbf_get_count(batch->worlds[world].solver, &count);
  if (status == PBF_OK && count > *most) *most = count;
  return status;
}

pbf_status pbf_batch_max_count(pbf_batch *batch, uint32_t *count) {
  *count = 0;
  return pbf_batch_for_worlds(batch, NULL, PBF_BY_CALLER, note_most, count);
}

/* ---- Reading -------------------------------------------------------------------------------- */

typedef struct reading {
  pbf_read_desc desc; /* with strides */
  uint64_t world_stride;
  uint64_t row_bytes; /* what is written of a row */
} reading;

static uint32_t element_bytes(const pbf_batch *batch, const pbf_read_desc *read) {
  if (read->field == PBF_FIELD_ID) return sizeof(uint32_t);
  const uint32_t type = read->element_type ? read->element_type : batch->kind.precision;
  return type == PBF_TYPE_FLOAT64 ? 8 : 4;
}

static uint32_t components_of(const pbf_batch *batch, const pbf_read_desc *read) {
  if (read->components) return read->components;
  const int is_vector = read->field == PBF_FIELD_POSITION || read->field == PBF_FIELD_VELOCITY;
  return is_vector ? batch->kind.dimension : 1;
}

static void clear_rows(const reading *r, char *data, uint32_t first) {
  for (uint32_t i = first; i < r->desc.count; ++i)
    memset(data + i * r->desc.stride, 0, r->row_bytes);
}

/* A world's particles as far as there are any; then zeros. */
static pbf_status read_world(pbf_batch *batch, uint32_t world, void *context) {
  const reading *r = context;
  pbf_solver *solver = batch->worlds[world].solver;
  pbf_read_desc own = r->desc;
  uint32_t count = 0;
  own.data = (char *)own.data + world * r->world_stride;
  pbf_status status = pbf_get_count(solver, &count);
  if (status != PBF_OK) return status;
  const uint32_t there = count > own.first ? count - own.first : 0;
  if (there < own.count) own.count = there;
  if (own.count == 0) own.first = 0;
  status = pbf_read(solver, &own);
  if (status == PBF_OK) clear_rows(r, own.data, own.count);
  return status;
}

/* What would reach from one world's rows into the next one's, or farther than memory does. */
static pbf_status check_world_stride(const reading *r, uint32_t element) {
  static const uint64_t most = UINT64_C(1) << 48;
  const uint64_t least =
      r->desc.count == 0 ? 0 : (r->desc.count - 1) * r->desc.stride + r->row_bytes;
  if (r->world_stride >= least && r->world_stride % element == 0 && r->world_stride <= most)
    return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "world_stride is %" PRIu64 "; it must be a multiple of %u from %" PRIu64
                  " up to %" PRIu64 ", or 0 for no gap",
                  r->world_stride, element, least, most);
}

/* Before the worlds', for rows that these lack are written, too. */
static pbf_status check_layout(const reading *r, uint32_t element) {
  if (r->desc.count == 0) return PBF_OK;
  return pbf_values_check_layout("read", r->desc.data, r->desc.stride, r->row_bytes, element);
}

pbf_status pbf_batch_observe(pbf_batch *batch, const uint8_t *mask, const pbf_read_desc *theirs,
                             uint64_t world_stride) {
  reading r = {.world_stride = world_stride};
  if (!theirs) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "read is null; it says what to read");
  pbf_status status = pbf_struct_in(&pbf_kind_read_desc, theirs, &r.desc);
  if (status != PBF_OK) return status;
  if (r.desc.device_type > PBF_DEVICE_CPU)
    return pbf_fail(PBF_ERROR_UNSUPPORTED,
                    "read.device_type is %u; worlds are read into host memory, 0 or 1: on a device "
                    "pbf_batch_export_dlpack has them",
                    r.desc.device_type);
  const uint32_t element = element_bytes(batch, &r.desc);
  if (r.desc.count > PBF_MAX_CAPACITY)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "read.count is %u; it must be at most %u",
                    r.desc.count, PBF_MAX_CAPACITY);
  if (r.desc.components > 4)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "read.components is %u; it must be at most 4",
                    r.desc.components);
  r.row_bytes = (uint64_t)components_of(batch, &r.desc) * element;
  status = check_layout(&r, element);
  if (status != PBF_OK) return status;
  if (!r.desc.stride) r.desc.stride = r.row_bytes;
  if (!r.world_stride) r.world_stride = r.desc.count * r.desc.stride;
  status = check_world_stride(&r, element);
  if (status != PBF_OK) return status;
  return pbf_batch_for_worlds(batch, mask, PBF_BY_THREADS, read_world, &r);
}

pbf_status pbf_batch_read(pbf_batch *batch, const uint8_t *mask, const pbf_read_desc *read,
                          uint64_t world_stride) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  return pbf_batch_leave(batch, pbf_batch_observe(batch, mask, read, world_stride));
}
