#include "pixels.h"

#include <epoxy/gl.h>

#include <algorithm>

namespace view {

std::vector<unsigned char> read_pixels(int width, int height) {
  const auto row = std::ptrdiff_t{3} * width;
  std::vector<unsigned char> pixels(static_cast<size_t>(row * height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
  for (int j = 0; j < height / 2; ++j)  // OpenGL's rows are from below
    std::swap_ranges(pixels.begin() + j * row, pixels.begin() + (j + 1) * row,
                     pixels.begin() + (height - 1 - j) * row);
  return pixels;
}

}  // namespace view
