/* Parameters, colliders and coordinates drawn from a fuzzer's bytes: mostly values of which a fluid
 * could be made, now and then any value there is. */
#ifndef PBF_TESTS_FUZZ_DRAW_H
#define PBF_TESTS_FUZZ_DRAW_H

#include <pbf/pbf.h>

#include "input.h"

/* Changes up to four fields; 1 when one of them got any value there is. */
int draw_params(input *in, pbf_params *params);

/* A collider in or around the unit box; 1 as above. */
int draw_collider(input *in, pbf_collider *collider);

/* NaN, infinities, denormals, huge and tiny numbers, or eight bytes as they come. */
double draw_wild(input *in);

#endif
