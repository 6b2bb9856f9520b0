/* How a grid is run. */
#ifndef EMULATED_GRID_H
#define EMULATED_GRID_H

namespace emulated {

/* Whether a kernel has failed, after which nothing runs any more. */
bool device_is_lost();

}  // namespace emulated

#endif
