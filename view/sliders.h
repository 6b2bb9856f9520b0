/* A slider, or what fits its kind, for each parameter. */
#ifndef PBF_VIEW_SLIDERS_H
#define PBF_VIEW_SLIDERS_H

#include <pbf/pbf.h>

namespace view {

// True: one has been moved. What a slider can't reach may be typed: Ctrl and a click.
bool draw_sliders(pbf_params &params, unsigned dimension);

}  // namespace view

#endif
