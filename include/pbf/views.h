/* pbf/views.h: the particles where they lie, on a device, too, without a copy.
 *
 * The rules of pbf.h hold here, too.
 */
#ifndef PBF_VIEWS_H
#define PBF_VIEWS_H

#include <pbf/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Views without a copy -------------------------------------------------------------------- */

/* Element (i, c) of a view is at data + i * particle_stride + c * component_stride bytes. The
 * order is the backend's own; ids (in the same memory, tightly packed) tell which element is which
 * particle. */
typedef struct pbf_view {
  uint32_t struct_size;
  uint32_t field;       /* PBF_FIELD_POSITION, _VELOCITY, _ID or _PRESSURE */
  uint32_t device_type; /* PBF_DEVICE_… */
  int32_t device_id;
  uint32_t element_type; /* PBF_TYPE_… */
  uint32_t components;   /* dimension, or 1 */
  uint32_t count;
  uint32_t reserved;        /* 0 */
  int64_t particle_stride;  /* bytes */
  int64_t component_stride; /* bytes */
  uint64_t generation;      /* changes whenever the particles do */
  const void *data;
  const uint32_t *ids;
} pbf_view;

/* Read-only view of one field. While any view is mapped, calls that change the particles return
 * PBF_ERROR_STATE. On a device the data is ready in the solver's stream. Each successful map wants
 * one unmap of the same field, from any thread, also while another one is inside the solver. */
PBF_API pbf_status pbf_map(pbf_solver *solver, uint32_t field, pbf_view *view);
PBF_API pbf_status pbf_unmap(pbf_solver *solver, uint32_t field);

/* The same as a DLPack tensor of shape (count, components), mapped until its deleter runs (also
 * after pbf_destroy). Include <dlpack/dlpack.h> for the type. */
struct DLManagedTensor;
PBF_API pbf_status pbf_export_dlpack(pbf_solver *solver, uint32_t field,
                                     struct DLManagedTensor **tensor);

#ifdef __cplusplus
}
#endif

#endif
