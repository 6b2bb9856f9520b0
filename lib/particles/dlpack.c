/* Views as DLPack tensors. */
#include <dlpack/dlpack.h>

#include "error.h"
#include "memory.h"
#include "solver/callbacks.h"
#include "solver/handles.h"
#include "views.h"

typedef struct exported {
  DLManagedTensor tensor;
  int64_t shape[2];
  int64_t strides[2];
  pbf_solver *solver;
} exported;

/* Any thread, at any time, also after pbf_destroy. */
static void delete_tensor(DLManagedTensor *tensor) {
  exported *own = tensor->manager_ctx;
  pbf_solver *solver = own->solver;
  pbf_memory_free(&solver->callbacks.allocator, own, sizeof *own);
  pbf_solver_drop_export(solver);
}

static DLDataType type_of(uint32_t element_type) {
  if (element_type == PBF_TYPE_UINT32) return (DLDataType){kDLUInt, 32, 1};
  return (DLDataType){kDLFloat, (uint8_t)(element_type == PBF_TYPE_FLOAT32 ? 32 : 64), 1};
}

static int64_t size_of(uint32_t element_type) { return element_type == PBF_TYPE_FLOAT64 ? 8 : 4; }

/* DLPack counts strides in elements. */
static pbf_status check_strides(const pbf_solver *solver, const pbf_view *view) {
  int64_t size = size_of(view->element_type);
  if (view->particle_stride % size == 0 && view->component_stride % size == 0) return PBF_OK;
  return pbf_fail(PBF_ERROR_UNSUPPORTED,
                  "the backend \"%s\" keeps field %u with strides that are no multiple of its "
                  "elements, which DLPack can't say; pbf_map can",
                  solver->plugin->name, view->field);
}

static void fill(exported *own, pbf_solver *solver, const pbf_view *view) {
  int64_t size = size_of(view->element_type);
  *own = (exported){
      .shape = {view->count, view->components},
      .strides = {view->particle_stride / size, view->component_stride / size},
      .solver = solver,
  };
  own->tensor.dl_tensor = (DLTensor){
      .data = (void *)(uintptr_t)view->data,
      .device = {(DLDeviceType)view->device_type, view->device_id},
      .ndim = 2,
      .dtype = type_of(view->element_type),
      .shape = own->shape,
      .strides = own->strides,
  };
  own->tensor.manager_ctx = own;
  own->tensor.deleter = delete_tensor;
}

static pbf_status export(pbf_solver *solver, uint32_t field, DLManagedTensor **tensor) {
  pbf_view view;
  void *memory;
  if (!tensor) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "tensor is null");
  pbf_status status = pbf_view_of(solver, field, &view);
  if (status == PBF_OK) status = check_strides(solver, &view);
  if (status == PBF_OK)
    status = pbf_memory_allocate(&solver->allocator, sizeof(exported), "a tensor", &memory);
  if (status != PBF_OK) return status;
  fill(memory, solver, &view);
  pbf_callbacks_forget(solver, memory);
  pbf_solver_add_export(solver);
  *tensor = &((exported *)memory)->tensor;
  return PBF_OK;
}

pbf_status pbf_export_dlpack(pbf_solver *solver, uint32_t field, struct DLManagedTensor **tensor) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, export(solver, field, tensor));
}
