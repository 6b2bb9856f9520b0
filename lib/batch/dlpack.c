/* Observations as DLPack tensors. */
#include <dlpack/dlpack.h>

#include "error.h"
#include "handles.h"
#include "memory.h"
#include "observe.h"

/* The numbers follow it in memory. */
typedef struct exported {
  DLManagedTensor tensor;
  int64_t shape[3];
  pbf_allocator allocator;
  uint64_t bytes;
} exported;

enum { ALIGNMENT = 64 };

static uint64_t header_bytes(void) {
  return (sizeof(exported) + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* Any thread, at any time, also after pbf_batch_destroy. */
static void delete_tensor(DLManagedTensor *tensor) {
  exported *own = tensor->manager_ctx;
  const pbf_allocator allocator = own->allocator;
  pbf_memory_free(&allocator, own, own->bytes);
}

static DLDataType type_of(const pbf_batch *batch, uint32_t field) {
  if (field == PBF_FIELD_ID) return (DLDataType){kDLUInt, 32, 1};
  return (DLDataType){kDLFloat, (uint8_t)(8 * batch->kind.precision), 1};
}

static uint32_t components_of(const pbf_batch *batch, uint32_t field) {
  return field == PBF_FIELD_POSITION || field == PBF_FIELD_VELOCITY ? batch->kind.dimension : 1;
}

static pbf_status take(const pbf_batch *batch, uint32_t field, uint32_t rows, exported **own) {
  const DLDataType type = type_of(batch, field);
  const uint32_t components = components_of(batch, field);
  const uint64_t numbers = (uint64_t)batch->world_count * rows * components;
  const uint64_t bytes = header_bytes() + numbers * (type.bits / 8);
  void *memory;
  pbf_status status = pbf_memory_allocate(&batch->allocator, bytes, "a tensor", &memory);
  if (status != PBF_OK) return status;
  *own = memory;
  **own = (exported){.shape = {batch->world_count, rows, components},
                     .allocator = batch->allocator,
                     .bytes = bytes};
  (*own)->tensor = (DLManagedTensor){
      .dl_tensor = {.data = (char *)memory + header_bytes(),
                    .device = {kDLCPU, 0},
                    .ndim = 3,
                    .dtype = type,
                    .shape = (*own)->shape},
      .manager_ctx = memory,
      .deleter = delete_tensor,
  };
  return PBF_OK;
}

static pbf_status export(pbf_batch *batch, uint32_t field, uint32_t rows,
                         DLManagedTensor **tensor) {
  exported *own;
  uint32_t most = rows;
  if (!tensor) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "tensor is null");
  if (rows > PBF_MAX_CAPACITY)
    return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "rows is %u; it must be at most %u", rows,
                    PBF_MAX_CAPACITY);
  pbf_status status = rows > 0 ? PBF_OK : pbf_batch_max_count(batch, &most);
  if (status == PBF_OK) status = take(batch, field, most, &own);
  if (status != PBF_OK) return status;
  const pbf_read_desc read = {.struct_size = sizeof read,
                              .field = field,
                              .count = most,
                              .data = own->tensor.dl_tensor.data};
  status = pbf_batch_observe(batch, NULL, &read, 0);
  if (status != PBF_OK) {
    delete_tensor(&own->tensor);
    return status;
  }
  *tensor = &own->tensor;
  return PBF_OK;
}

pbf_status pbf_batch_export_dlpack(pbf_batch *batch, uint32_t field, uint32_t rows,
                                   struct DLManagedTensor **tensor) {
  pbf_status status = pbf_batch_enter(batch);
  if (status != PBF_OK) return status;
  return pbf_batch_leave(batch, export(batch, field, rows, tensor));
}
