/* Parameters as callers give them, checked, and as backends get them. */
#ifndef PBF_LIB_PARAMS_H
#define PBF_LIB_PARAMS_H

#include "check.h"

/* A caller's parameters, of whatever size. What an older caller does not know has its default. */
pbf_status pbf_params_in(const pbf_params *theirs, pbf_params *params);

/* Fails with a sentence unless these parameters can run at time `time`. */
pbf_status pbf_params_check(const pbf_params *params, pbf_check_kind kind, double time);

/* As a backend gets them: what the dimension ignores is zero. */
pbf_params pbf_params_for_backend(const pbf_params *params, uint32_t dimension);

/* The box between the walls at a time. */
typedef struct pbf_box {
  double lower[3];
  double upper[3];
} pbf_box;

pbf_box pbf_params_box(const pbf_params *params, uint32_t dimension, double time);

int pbf_params_walls_move(const pbf_params *params, uint32_t dimension);

/* The first axis along which the box has no inside, or `dimension` when it has one everywhere. */
uint32_t pbf_box_closed_axis(const pbf_box *box, uint32_t dimension);

#endif
