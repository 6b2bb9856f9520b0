#include "report/png.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

namespace bench {
namespace {

void append(void *context, void *bytes, int size) {
  static_cast<std::string *>(context)->append(static_cast<char *>(bytes),
                                              static_cast<size_t>(size));
}

}  // namespace

std::string encode_png(int width, int height, const unsigned char *rgb) {
  std::string png;
  stbi_write_png_to_func(append, &png, width, height, 3, rgb, 3 * width);
  return png;
}

}  // namespace bench
