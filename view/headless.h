/* Pictures without a display. */
#ifndef PBF_VIEW_HEADLESS_H
#define PBF_VIEW_HEADLESS_H

#include "options.h"

namespace view {

// Runs the steps and writes what is asked for: a picture, a recording, a line of times.
void run_headless(const Options &options);

}  // namespace view

#endif
