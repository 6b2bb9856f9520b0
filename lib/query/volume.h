/* Boxes, spheres and capsules that are asked about. */
#ifndef PBF_LIB_QUERY_VOLUME_H
#define PBF_LIB_QUERY_VOLUME_H

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

/* Checks the caller's array of structs; `label` is what messages call it. */
pbf_status pbf_volumes_check(pbf_check_kind kind, const char *label, uint32_t count,
                             const pbf_volume *theirs);

/* One of ours by itself; messages call it `label`. */
pbf_status pbf_volume_check(const pbf_volume *volume, const char *label, uint32_t dimension);

/* One of an array that was checked. */
pbf_volume pbf_volumes_get(const pbf_volume *theirs, uint32_t index);

pbf_volume_frame pbf_volume_frame_of(const pbf_volume *volume, uint32_t dimension);

/* Whether a point, from the centre and in the frame of the volume, is inside. */
int pbf_volume_has_local(const pbf_volume_frame *frame, const double *local);

/* The same of a point of the world. */
int pbf_volume_has(const pbf_volume_frame *frame, const double *point);

double pbf_volume_size(const pbf_volume_frame *frame);

#endif
