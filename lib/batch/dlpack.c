/* Observations as DLPack tensors. */
#include <dlpack/dlpack.h>

#include "error.h"
#include "handles.h"
#include "memory.h"
#include "observe.h"
#include "solver/backend_call.h"
#include "solver/handles.h"
#include "solver/ids.h"
#include "worlds.h"

/* The numbers are in `array`, of a backend, or follow in memory. */
typedef struct exported {
  DLManagedTensor tensor;
  int64_t shape[3];
  pbf_allocator allocator;
  uint64_t bytes;
  pbf_backend_array array;
  void (*release_array)(const pbf_backend_array *array); /* null: there is none */
} exported;

enum { ALIGNMENT = 64 };

static uint64_t header_bytes(void) {
  return (sizeof(exported) + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* Any thread, at any time, also after pbf_batch_destroy. */
static void delete_tensor(DLManagedTensor *tensor) {
  exported *own = tensor->manager_ctx;
  const pbf_allocator allocator = own->allocator;
  if (own->release_array) own->release_array(&own->array);
  pbf_memory_free(&allocator, own, own->bytes);
}

static DLDataType type_of(const pbf_batch *batch, uint32_t field) {
  if (field == PBF_FIELD_ID) return (DLDataType){kDLUInt, 32, 1};
  return (DLDataType){kDLFloat, (uint8_t)(8 * batch->kind.precision), 1};
}

static int is_vector(uint32_t field) {
  return field == PBF_FIELD_POSITION || field == PBF_FIELD_VELOCITY;
}

/* Of a world's rows. */
static uint64_t world_bytes(const pbf_batch *batch, uint32_t field, uint32_t rows) {
  const uint64_t components = is_vector(field) ? batch->kind.dimension : 1;
  return rows * components * (type_of(batch, field).bits / 8);
}

/* With room for so many bytes behind it. */
static pbf_status take(const pbf_batch *batch, uint32_t field, uint32_t rows, uint64_t bytes,
                       exported **own) {
  void *memory;
  pbf_status status =
      pbf_memory_allocate(&batch->allocator, header_bytes() + bytes, "a tensor", &memory);
  if (status != PBF_OK) return status;
  *own = memory;
  **own =
      (exported){.shape = {batch->world_count, rows, is_vector(field) ? batch->kind.dimension : 1},
                 .allocator = batch->allocator,
                 .bytes = header_bytes() + bytes};
  (*own)->tensor = (DLManagedTensor){
      .dl_tensor = {.data = (char *)memory + header_bytes(),
                    .device = {kDLCPU, 0},
                    .ndim = 3,
                    .dtype = type_of(batch, field),
                    .shape = (*own)->shape},
      .manager_ctx = memory,
      .deleter = delete_tensor,
  };
  return PBF_OK;
}

/* ---- By way of host memory ------------------------------------------------------------------ */

static pbf_status export_copy(pbf_batch *batch, uint32_t field, uint32_t rows, exported **own) {
  pbf_status status =
      take(batch, field, rows, batch->world_count * world_bytes(batch, field, rows), own);
  if (status != PBF_OK) return status;
  const pbf_read_desc read = {.struct_size = sizeof read,
                              .field = field,
                              .count = rows,
                              .data = (*own)->tensor.dl_tensor.data};
  status = pbf_batch_observe(batch, NULL, &read, 0);
  if (status != PBF_OK) delete_tensor(&(*own)->tensor);
  return status;
}

/* ---- On the device -------------------------------------------------------------------------- */

typedef struct transfer {
  uint32_t field, rows;
  uint64_t bytes; /* of a world's rows */
  exported *own;
} transfer;

static int stays_there(const pbf_batch *batch, uint32_t field, uint32_t rows) {
  return is_vector(field) && rows > 0 && batch->worlds[0].solver->api.take_array;
}

static pbf_status take_array(pbf_solver *solver, uint64_t bytes, exported *own) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  own->array = (pbf_backend_array){.struct_size = sizeof own->array};
  status = solver->api.take_array(solver->backend, bytes, &own->array);
  status = pbf_backend_result(solver, status, "take_array");
  if (status == PBF_OK) own->release_array = solver->api.release_array;
  return pbf_leave(solver, status);
}

static pbf_status read_there(pbf_batch *batch, uint32_t world, void *context) {
  const transfer *t = context;
  pbf_solver *solver = batch->worlds[world].solver;
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  const uint32_t count = solver->count < t->rows ? solver->count : t->rows;
  const pbf_rows rows = pbf_ids_rows(solver, 0, count);
  status = solver->api.read_array(solver->backend, t->field, &rows, t->rows,
                                  (char *)t->own->array.data + world * t->bytes);
  return pbf_leave(solver, pbf_backend_result(solver, status, "read_array"));
}

static pbf_status wait_there(pbf_batch *batch, uint32_t world, void *context) {
  (void)context;
  return pbf_synchronize(batch->worlds[world].solver);
}

static pbf_status export_there(pbf_batch *batch, uint32_t field, uint32_t rows, exported **own) {
  transfer t = {field, rows, world_bytes(batch, field, rows), NULL};
  pbf_status status = take(batch, field, rows, 0, own);
  if (status != PBF_OK) return status;
  t.own = *own;
  status = take_array(batch->worlds[0].solver, batch->world_count * t.bytes, *own);
  if (status == PBF_OK) status = pbf_batch_for_worlds(batch, NULL, PBF_BY_CALLER, read_there, &t);
  if (status == PBF_OK) status = pbf_batch_for_worlds(batch, NULL, PBF_BY_CALLER, wait_there, NULL);
  if (status != PBF_OK) {
    delete_tensor(&(*own)->tensor);
    return status;
  }
  DLTensor *tensor = &(*own)->tensor.dl_tensor;
  tensor->data = (*own)->array.data;
  tensor->device = (DLDevice){(DLDeviceType)(*own)->array.device_type, (*own)->array.device_id};
  return PBF_OK;
}

/* ---- Either --------------------------------------------------------------------------------- */

static pbf_status export(pbf_batch *batch, uint32_t field, uint32_t rows,
                         DLManagedTensor **tensor) {
  exported *own;
  uint32_t most = rows;
  if (!tensor) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "tensor is null");
  if (rows > PBF_MAX_CAPACITY)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "rows is %u; it must be at most %u", rows,
                    PBF_MAX_CAPACITY);
  pbf_status status = rows > 0 ? PBF_OK : pbf_batch_max_count(batch, &most);
  if (status != PBF_OK) return status;
  status = stays_there(batch, field, most) ? export_there(batch, field, most, &own)
                                           : export_copy(batch, field, most, &own);
  if (status == PBF_OK) *tensor = &own->tensor;
  return status;
}

pbf_status pbf_batch_export_dlpack(pbf_batch *batch, uint32_t field, uint32_t rows,
                                   struct DLManagedTensor **tensor) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  return pbf_batch_leave(batch, export(batch, field, rows, tensor));
}
