/* Boxes, spheres and capsules that are asked about. */
#ifndef PBF_LIB_QUERY_VOLUME_H
#define PBF_LIB_QUERY_VOLUME_H

#include <pbf/pbf_backend.h>
#include <pbf/query.h>

#include "check.h"

/* A volume as its points are asked for. */
typedef struct pbf_volume_frame {
  uint32_t shape, dimension;
  double position[3];
  double axes[3][3]; /* of the volume's own frame: row k is its axis k; a capsule's is axis 0 */
  double half[3];    /* of the box around it in that frame */
  double radius, half_length; /* 0 where the shape has none */
} pbf_volume_frame;

/* Copies the caller's array of structs, which messages call `name`, and checks the copies. */
pbf_status pbf_volumes_in(pbf_check_kind kind, const char *name, uint32_t count,
                          const pbf_volume *theirs, pbf_volume *ours);

/* The same of one of an array whose first has this size. */
pbf_status pbf_volume_in(pbf_check_kind kind, const char *name, const pbf_volume *theirs,
                         uint32_t first, uint32_t index, pbf_volume *ours);

/* One of ours by itself; messages call it `label`. */
pbf_status pbf_volume_check(const pbf_volume *volume, const char *label, uint32_t dimension);

/* What its shape and the dimension ignore becomes as pbf_volume_init gives it. */
void pbf_volume_clean(pbf_volume *volume, uint32_t dimension);

pbf_volume_frame pbf_volume_frame_of(const pbf_volume *volume, uint32_t dimension);

/* Whether a point, from the centre and in the frame of the volume, is inside. */
int pbf_volume_has_local(const pbf_volume_frame *frame, const double *local);

/* The same of a point of the world. */
int pbf_volume_has(const pbf_volume_frame *frame, const double *point);

/* A box around what is within `margin` of it and, for rounding, a hair more. */
pbf_backend_box pbf_volume_box(const pbf_volume_frame *frame, double margin);

double pbf_volume_size(const pbf_volume_frame *frame);

#endif
