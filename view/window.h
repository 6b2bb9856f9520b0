/* The live viewer. */
#ifndef PBF_VIEW_WINDOW_H
#define PBF_VIEW_WINDOW_H

#include "options.h"

namespace view {

// Until its window is closed. Throws bench::Error where there is no display.
void run_window(const Options &options);

}  // namespace view

#endif
