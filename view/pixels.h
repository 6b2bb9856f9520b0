/* What has been drawn, as bytes. */
#ifndef PBF_VIEW_PIXELS_H
#define PBF_VIEW_PIXELS_H

#include <vector>

namespace view {

// Of the frame buffer that is read from: rows from above, three bytes a pixel.
std::vector<unsigned char> read_pixels(int width, int height);

}  // namespace view

#endif
