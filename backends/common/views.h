/* Views of numbers that a CPU backend has put together for them. */
#ifndef PBF_COMMON_VIEWS_H
#define PBF_COMMON_VIEWS_H

#include "physics/real.h"

/* One number for each of `count` particles. */
static inline void pbf_view_numbers(pbf_view *view, uint32_t count, const uint32_t *ids,
                                    const pbf_real *numbers) {
  view->device_type = PBF_DEVICE_CPU;
  view->element_type = view->particle_stride = view->component_stride = sizeof(pbf_real);
  view->components = 1;
  view->count = count;
  view->ids = ids;
  view->data = numbers;
}

#endif
